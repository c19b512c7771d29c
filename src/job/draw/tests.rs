//! Pictures must not depend on how the triangles are cut into leaves, nor on what culling leaves out.

use std::num::NonZeroUsize;

use super::*;
use crate::geometry::culling::Steps;
use crate::geometry::{Camera, Frustum, Lens, culling};
use crate::job::cull::{CullTree, Frame, History};
use crate::machine::Threads;
use crate::scene::{CameraPath, Mesh, by_name};
use crate::scheme::tree::share;
use crate::structure::midpoint_tree;
use glam::Vec3;

fn leaves(scene: &Scene, most: usize) -> PlacedLeaves {
    PlacedLeaves::new(scene, NonZeroUsize::new(most).unwrap()).unwrap()
}

/// The objects a serial hierarchical culling finds.
fn culled(leaves: &PlacedLeaves, camera: &Camera, steps: Steps) -> Vec<u32> {
    let (tree, _) = midpoint_tree(&leaves.objects);
    let threads = Threads::new(1).unwrap();
    let in_memory = CullTree::new(&threads, &tree, History::Plane);
    let frustum = Frustum::new(camera);
    let frame = Frame::new(&in_memory, 0, &frustum, steps).unwrap();
    let shares = share("serial", &threads, 1, &frame.ranges()).unwrap();
    let nodes = in_memory.visible(shares.iter().map(|share| &share.found));
    nodes.into_iter().map(|node| tree.nodes[node as usize].source).collect()
}

#[test]
fn pictures_are_the_same_culled_or_not_whatever_the_leaves() {
    let knots = by_name("dragon").unwrap().repeated(6, 1.1);
    let mut far = by_name("factory-small").unwrap();
    for node in 0..far.roots.len() {
        let root = far.roots[node] as usize;
        far.nodes[root].transform.translation += glam::Vec3A::splat(1e5);
    }
    far.name = "far".to_owned();
    for (scene, most) in [(&knots, [1000, 20_000]), (&far, [50, 5000])] {
        let mut picture = Picture::new(160, 120).unwrap();
        let whole = leaves(scene, usize::MAX);
        let whole = Drawing::new(scene, &whole);
        let all: Vec<_> = most.iter().map(|most| leaves(scene, *most)).collect();
        let mut covered = 0;
        for camera in CameraPath::for_scene(scene, 6, 1).frames {
            let unculled = whole.draw_all(&camera, &mut picture);
            let (expected, pixels) = (picture.fingerprint(), picture.covered());
            covered += pixels;
            for leaves in &all {
                let drawing = Drawing::new(scene, leaves);
                let off = drawing.draw_all(&camera, &mut picture);
                assert_eq!((picture.fingerprint(), off.draw_calls), (expected, leaves.leaves.len() as u64));
                for words in ["basic", "plane+mask+fields", "plane+octant+fields"] {
                    let visible = culled(leaves, &camera, words.parse().unwrap());
                    let on = drawing.draw(&camera, visible.iter().rev().copied(), &mut picture);
                    assert_eq!(picture.fingerprint(), expected);
                    assert_eq!(on.draw_calls as usize, visible.len());
                    // All that is spared lies outside: what is set up and tested stays the same.
                    assert_eq!((on.set_up, on.pixel_tests), (unculled.set_up, unculled.pixel_tests));
                    assert_eq!(off.triangles - off.outside, on.triangles - on.outside);
                    assert!(on.vertices <= off.vertices && on.triangles <= off.triangles);
                }
            }
        }
        assert!(covered > 10_000, "the path sees something: {covered}");
    }
}

#[test]
fn leaving_out_one_visible_leaf_changes_the_picture() {
    let scene = by_name("dragon").unwrap();
    let leaves = leaves(&scene, 20_000);
    let drawing = Drawing::new(&scene, &leaves);
    let mut picture = Picture::new(160, 120).unwrap();
    let lens = Lens::Symmetric { fov_y: 1.0, aspect: 4.0 / 3.0 };
    let camera = Camera::look_at(Vec3::new(0.0, 22.0, 0.1), Vec3::ZERO, Vec3::Y, lens, 0.1, 60.0).unwrap();
    drawing.draw_all(&camera, &mut picture);
    let whole = picture.fingerprint();
    for missing in 0..leaves.leaves.len() as u32 {
        let rest = (0..leaves.leaves.len() as u32).filter(|leaf| *leaf != missing);
        drawing.draw(&camera, rest, &mut picture);
        assert_ne!(picture.fingerprint(), whole, "leaf {missing}");
    }
}

#[test]
fn counts_of_a_known_picture() {
    // Two triangles of one square before the eye, one behind it, and a vertex nobody uses.
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let square = vec![
        corner(-1.0, -1.0, -2.0),
        corner(1.0, -1.0, -2.0),
        corner(1.0, 1.0, -2.0),
        corner(-1.0, 1.0, -2.0),
        corner(0.0, 0.0, 5.0),
        corner(1.0, 0.0, 5.0),
        corner(9.0, 9.0, 9.0),
    ];
    let mut scene = Scene::new("square");
    let mesh = scene.add_mesh(Mesh::new("square", square, vec![[0, 1, 2], [0, 2, 3], [4, 5, 4]]));
    scene.add_node(None, "square", Affine3A::IDENTITY, Some(mesh));
    // A quarter turn wide: the square, two metres off, is half the picture across and down.
    let lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_2, aspect: 1.0 };
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, lens, 0.5, 10.0).unwrap();
    let leaves = leaves(&scene, usize::MAX);
    let drawing = Drawing::new(&scene, &leaves);
    let mut picture = Picture::new(16, 16).unwrap();
    let counts = drawing.draw_all(&camera, &mut picture);
    let expected = Counts {
        draw_calls: 1,
        vertices: 6,
        triangles: 3,
        outside: 1,
        set_up: 2,
        pixel_tests: 64,
        pixels_passed: 64,
    };
    assert_eq!(counts, expected);
    assert_eq!(picture.covered(), 64);
    let seen = |pixel: usize| picture.nearness()[pixel];
    assert!((seen(4 * 16 + 4) - 0.5).abs() < 1e-6 && seen(3 * 16 + 4) == 0.0 && seen(12 * 16 + 4) == 0.0);
    assert!(matches!(
        culling::basic(&leaves.objects[0].bounds, &Frustum::new(&camera)).side,
        culling::Side::Intersecting
    ));
}

#[test]
fn pictures_have_a_size_within_bounds() {
    assert!(Picture::new(0, 5).is_none() && Picture::new(5, 0).is_none());
    assert!(Picture::new(1 << 20, 1 << 20).is_none() && Picture::new(1 << 14, (1 << 14) + 1).is_none());
    let picture = Picture::new(3, 2).unwrap();
    assert_eq!((picture.size(), picture.nearness().len(), picture.covered()), ([3, 2], 6, 0));
}
