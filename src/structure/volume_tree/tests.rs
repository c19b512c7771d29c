use super::*;
use crate::geometry::{KDop, Obb, Sphere};
use crate::scene::{self, Mesh, Scene};
use glam::Affine3A;

/// A bent sheet of triangles.
fn sheet(across: u32, at: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let point = |i: u32| {
        let (x, y) = ((i % (across + 1)) as f32, (i / (across + 1)) as f32);
        at + Vec3::new(x, y, (x * 0.3).sin() + (y * 0.2).cos())
    };
    let positions = (0..(across + 1) * (across + 1)).map(point).collect();
    let cell = |i: u32| {
        let corner = i % across + i / across * (across + 1);
        [[corner, corner + 1, corner + across + 1], [corner + 1, corner + across + 2, corner + across + 1]]
    };
    (positions, (0..across * across).flat_map(cell).collect())
}

fn holds<V: Overlap>(positions: &[Vec3], triangles: &[[u32; 3]]) {
    for leaf in [1, 4, 64] {
        let tree = VolumeTree::<V>::over_triangles(positions, triangles, leaf).unwrap();
        tree.validate().unwrap();
        let statistics = tree.statistics();
        assert!(tree.links().iter().all(|link| !link.is_leaf() || link.count() as usize <= leaf));
        assert!(statistics.leaves * leaf >= triangles.len() && statistics.leaves <= statistics.boxes);
    }
}

#[test]
fn every_kind_over_nasty_triangles() {
    let (positions, triangles) = sheet(20, Vec3::ZERO);
    let (far, _) = sheet(20, Vec3::new(1e6, -3e5, 2e4));
    let line: Vec<Vec3> = positions.iter().map(|point| Vec3::X * point.x).collect();
    for positions in [positions.clone(), far, vec![Vec3::ONE; positions.len()], line] {
        holds::<Aabb>(&positions, &triangles);
        holds::<Obb>(&positions, &triangles);
        holds::<Sphere>(&positions, &triangles);
        holds::<KDop<9>>(&positions, &triangles);
    }
    holds::<Obb>(&positions, &triangles[..1]);
    holds::<Obb>(&[Vec3::splat(1e17), Vec3::ZERO, Vec3::splat(-1e17)], &[[0, 1, 2]; 30]);
    let none = VolumeTree::<Obb>::over_triangles(&positions, &[], 4).unwrap();
    assert!(none.is_empty() && none.validate().is_ok() && none.statistics().boxes == 0);
}

#[test]
fn oriented_boxes_are_tighter() {
    let (positions, triangles) = sheet(40, Vec3::ZERO);
    let tightness = |tree: VolumeTreeStatistics| tree.tightness;
    let tight = tightness(VolumeTree::<Obb>::over_triangles(&positions, &triangles, 2).unwrap().statistics());
    let same = tightness(VolumeTree::<Aabb>::over_triangles(&positions, &triangles, 2).unwrap().statistics());
    assert!(tight < 0.8 && (same - 1.0).abs() < 1e-3, "{tight} {same}");
}

#[test]
fn what_cannot_be_built_is_told() {
    let (mut positions, triangles) = sheet(3, Vec3::ZERO);
    let tree = |positions: &[Vec3], triangles: &[[u32; 3]], leaf| {
        VolumeTree::<Obb>::over_triangles(positions, triangles, leaf).unwrap_err()
    };
    assert_eq!(tree(&positions, &triangles, 0), VolumeTreeError::Leaf(0));
    let error = VolumeTreeError::NoCorner { triangle: 0, corner: 99, corners: 16 };
    assert_eq!(tree(&positions, &[[0, 1, 99]], 4), error);
    positions[5].y = f32::NAN;
    assert_eq!(tree(&positions, &triangles, 4), VolumeTreeError::Odd(1));
    assert_eq!(tree(&[Vec3::splat(1e30)], &[[0; 3]], 4), VolumeTreeError::Odd(0));
}

#[test]
fn fitted_anew_it_holds_what_moved() {
    let (mut positions, triangles) = sheet(12, Vec3::ZERO);
    let mut tree = VolumeTree::<Obb>::over_triangles(&positions, &triangles, 3).unwrap();
    let before = tree.links().to_vec();
    for position in &mut positions {
        position.z += (position.x * 0.5).cos() * 4.0;
    }
    tree.refit(&positions).unwrap();
    tree.validate().unwrap();
    assert!(
        tree.links().iter().zip(&before).all(|(new, old)| (new.first, new.count) == (old.first, old.count))
    );
    assert_eq!(
        tree.refit(&positions[..9]),
        Err(VolumeTreeError::Points { got: 9, expected: positions.len() })
    );
    positions[7].x = f32::INFINITY;
    assert!(matches!(tree.refit(&positions), Err(VolumeTreeError::Odd(_))));
    tree.validate().unwrap();
}

#[test]
fn over_nodes_it_has_the_shape_of_the_scene() {
    for name in ["factory-small", "factory-medium"] {
        let scene = scene::by_name(name).unwrap();
        let mut tree = VolumeTree::<Aabb>::over_nodes(&scene);
        tree.validate().unwrap();
        assert_eq!(tree.order().len(), scene.instances().0);
        assert_eq!(tree.refit(&[]), Err(VolumeTreeError::Nodes));
    }
    assert!(VolumeTree::<Aabb>::over_nodes(&Scene::new("nothing")).is_empty());
}

/// A chain of nodes, each with a mesh and the next below it: every point lies in every box above.
#[test]
fn a_chain_is_fitted_and_checked_in_little_more_time_than_it_has_points() {
    let mut scene = Scene::new("chain");
    let corners: Vec<Vec3> = (0..30).map(|i| Vec3::new(i as f32, (i * i) as f32, 1.0)).collect();
    let mesh = scene.add_mesh(Mesh::new("link", corners, vec![[0, 1, 2]]));
    let mut above = None;
    for _ in 0..3000 {
        let place = Affine3A::from_translation(Vec3::new(0.5, 0.25, 0.125));
        above = Some(scene.add_node(above, "link", place, Some(mesh)));
    }
    let mut tree = VolumeTree::<Obb>::over_nodes(&scene);
    assert!(tree.statistics().depth >= 3000);
    tree.validate().unwrap();
    // The root is checked by the box around all: one that leaves some of it out is found.
    tree.volumes[0] = tree.volumes[tree.volumes.len() - 8];
    assert_eq!(tree.validate().unwrap_err().node, 0);
}

/// Four times a thousand million corners, of one mesh in many places.
#[test]
fn corners_that_cannot_be_numbered_are_told() {
    let mut scene = Scene::new("many");
    let mesh = scene.add_mesh(Mesh::new("points", vec![Vec3::ZERO; 1 << 20], vec![[0, 1, 2]]));
    for _ in 0..1 << 12 {
        scene.add_node(None, "copy", Affine3A::IDENTITY, Some(mesh));
    }
    assert_eq!(in_world(&scene).unwrap_err(), VolumeTreeError::TooManyCorners(1 << 32));
    assert!(VolumeTree::<Aabb>::over_scene(&scene, 2).is_err());
}
