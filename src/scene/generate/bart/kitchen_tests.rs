use super::super::car;
use super::*;
use crate::geometry::Aabb;
use crate::scene::{Pose, describe};

fn scene() -> Scene {
    kitchen("bart-kitchen", 6)
}

#[test]
fn the_counts_are_the_papers_with_any_number_of_lights() {
    let scene = scene();
    scene.validate().unwrap();
    let holds = describe(&scene);
    assert_eq!((holds.instanced_triangles, holds.textures, holds.zero_area), (TRIANGLES, 8, 0));
    assert_eq!((holds.frames, holds.seconds, holds.moving), (800, 20.0, 7));
    for lights in 1..=10 {
        let lit = kitchen("k", lights);
        assert_eq!((lit.lights.len(), lit.instances().1), (lights, TRIANGLES));
        let total: f32 = lit.lights.iter().map(|light| light.colour.x).sum();
        assert!((total - BRIGHTNESS).abs() < 1e-5);
    }
}

/// The nodes of the car, its root first.
fn of_car(scene: &Scene) -> Vec<u32> {
    let root = scene.nodes.iter().position(|node| node.name == "toycar").unwrap() as u32;
    let (mut nodes, mut next) = (vec![root], 0);
    while let Some(node) = nodes.get(next) {
        nodes.extend(&scene.nodes[*node as usize].children.clone());
        next += 1;
    }
    nodes
}

/// The smallest box around all vertices of the car.
fn bounds(scene: &Scene, pose: &Pose) -> Aabb {
    let placed = of_car(scene).into_iter().filter_map(|node| Some((node, scene.nodes[node as usize].mesh?)));
    Aabb::of_points(placed.flat_map(|(node, mesh)| {
        let world = pose.world[node as usize];
        scene.meshes[mesh as usize].positions.iter().map(move |position| world.transform_point3(*position))
    }))
}

#[test]
fn the_car_is_moved_three_levels_deep_and_pressed_together_at_last() {
    let scene = scene();
    let nodes = of_car(&scene);
    let triangles = nodes.iter().filter_map(|node| scene.nodes[*node as usize].mesh);
    assert_eq!(
        triangles.map(|mesh| scene.meshes[mesh as usize].triangles.len()).sum::<usize>(),
        car::TRIANGLES
    );
    let moves = |node: u32| scene.animation.followers.iter().any(|(follower, _)| *follower == node);
    let levels = |node: u32| {
        let above = std::iter::successors(Some(node), |node| scene.nodes[*node as usize].parent);
        above.filter(|node| moves(*node)).count()
    };
    assert_eq!(nodes.iter().map(|node| levels(*node)).max(), Some(3));
    let length = |time: f64| {
        let pose = scene.pose(time);
        pose.world[nodes[0] as usize].matrix3.x_axis.length()
    };
    assert!((length(10.0) - 1.0).abs() < 1e-3 && (length(19.75) - 1.0).abs() < 1e-3);
    assert!((length(20.0) - 0.5).abs() < 1e-3);
}

#[test]
fn the_car_stays_on_the_floor_within_the_walls_and_out_of_the_cupboards() {
    let scene = scene();
    for time in scene.animation.times(200) {
        let car = bounds(&scene, &scene.pose(time));
        assert!(car.min.y > -1e-3 && car.max.y < 0.2, "{time}: {car:?}");
        assert!(
            car.min.cmpge(Vec3::new(0.1, -1e-3, 0.55)).all() && car.max.cmplt(ROOM).all(),
            "{time}: {car:?}"
        );
    }
}

#[test]
fn wheels_roll_as_far_as_the_car_drives() {
    let scene = scene();
    let wheel = of_car(&scene).into_iter().find(|node| scene.nodes[*node as usize].name == "wheel").unwrap();
    let root = of_car(&scene)[0];
    // In a short while on a straight piece, about its axle as much as the way over its radius.
    let (early, late) = (scene.pose(12.0), scene.pose(12.002));
    let place = |pose: &Pose| pose.world[root as usize].translation;
    let way = place(&early).distance(place(&late));
    let spoke = |pose: &Pose| {
        let turned = pose.world[root as usize].inverse() * pose.world[wheel as usize];
        turned.transform_vector3(Vec3::X)
    };
    let (before, after) = (spoke(&early), spoke(&late));
    let angle = before.y.atan2(before.x) - after.y.atan2(after.x);
    assert!((angle * 0.032 / way - 1.0).abs() < 0.1, "{angle} for {way}");
}

#[test]
fn the_tables_edge_hides_all_and_is_gone_soon_after() {
    let scene = scene();
    let edge = TABLE.x - TABLE_HALF.x;
    // All four corners of the picture, 4:3, end at the table's edge.
    let hidden = |time: f64| {
        let view = scene.pose(time).view.unwrap();
        let ahead = (view.look - view.eye).normalize();
        let (half, right) = ((view.fov_y / 2.0).tan(), ahead.cross(view.up));
        [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].iter().all(|(x, y)| {
            let ray = ahead + right * (half * x * 4.0 / 3.0) + view.up * (half * y);
            let met = view.eye + ray * ((edge - view.eye.x) / ray.x);
            ray.x > 0.0
                && view.eye.x < edge
                && (TOP.0..TOP.1).contains(&met.y)
                && (met.z - TABLE.z).abs() < TABLE_HALF.z
        })
    };
    let times: Vec<f64> = scene.animation.times(800).collect();
    let blind: Vec<usize> = (0..800).filter(|frame| hidden(times[*frame])).collect();
    assert!((1..20).contains(&blind.len()), "{blind:?}");
    assert!((16.5..17.3).contains(&times[blind[0]]));
}
