//! The museum (P3-04): a room with a piece of art in its middle that no structure for rays outlives a frame of.

use std::f64::consts::PI;

use glam::{Affine3A, Vec3};

use super::super::room::parts::{VASE, carpet, lathe, sheet};
use super::super::{cuboid, place::turned_y};
use super::art::art;
use super::pictures::{marble, painting};
use super::{Aisles, Generator, Stage, flight, pennant};
use crate::geometry::hit::Cone;
use crate::scene::{Material, PointLight, Primitive, Scene, Shape};

/// "10,143 polygons ... without the animated art", all triangles here.
const POLYGONS: usize = 10_143;
/// Half of the room's width (x), its height, half of its length (z), in metres.
const HALF: Vec3 = Vec3::new(6.0, 5.0, 9.0);

macro_rules! level {
    ($const:ident, $k:literal, $triangles:literal) => {
        pub(in crate::scene::generate) const $const: Generator = Generator {
            name: concat!("bart-museum-", $k),
            about: concat!(
                "BART's museum, level ",
                $k,
                ": 10,143 triangles, 8 cones, ",
                $triangles,
                " that fly; 6 s (stand-in: Paper III, Museum)"
            ),
            generate: || museum(concat!("bart-museum-", $k), $k),
            aisles: || Aisles::NONE,
        };
    };
}
level!(K3, 3, "64");
level!(K4, 4, "256");
level!(K5, 5, "1,024");
level!(K6, 6, "4,096");
level!(K7, 7, "16,384");
level!(K8, 8, "65,536");

fn museum(name: &str, k: u32) -> Scene {
    let mut stage = Stage::new(name);
    let gold = Material::metal("gold", Vec3::new(0.85, 0.63, 0.3), 50);
    let gold = stage.material(Material { diffuse: Vec3::new(0.2, 0.14, 0.06), ..gold });
    // The first mesh, as its bend says.
    let (mesh, bend) = art(k);
    stage.set(mesh, gold, Vec3::ZERO);
    stage.scene.animation.bends.push(bend);
    hall(&mut stage);
    paintings(&mut stage);
    furniture(&mut stage);
    let dark = stage.material(Material::matt("wool", Vec3::new(0.3, 0.06, 0.08)));
    let red = stage.material(Material::matt("pennant", Vec3::new(0.7, 0.1, 0.1)));
    let corners = [Vec3::new(-0.6, 4.6, 0.0), Vec3::new(0.0, 3.2, 0.0), Vec3::new(0.6, 4.6, 0.0)];
    stage.set(pennant("pennant", corners), red, Vec3::Z * (0.05 - HALF.z));
    // Whatever is left over is in the carpet.
    let left = POLYGONS + (1 << (2 * k)) - stage.scene.instances().1;
    stage.set(carpet(7.0, 5.0, left), dark, Vec3::ZERO);
    let light = |x: f32| PointLight { position: Vec3::new(x, 4.7, 0.0), colour: Vec3::splat(0.55) };
    stage.scene.lights = vec![light(-4.0), light(4.0)];
    let animation = &mut stage.scene.animation;
    (animation.start, animation.end, animation.frames) = (-1.0, 5.0, 300);
    let art = Vec3::new(0.0, 2.0, 0.0);
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    stage.fly(
        flight(&[
            (-2.0, at(0.0, 1.9, -8.6), art),
            (-1.0, at(0.5, 1.8, -8.2), art),
            (0.0, at(3.2, 1.7, -4.6), art),
            (1.0, at(4.3, 2.2, 0.4), art),
            (2.0, at(1.6, 2.8, 3.9), art),
            (3.0, at(-2.6, 2.1, 2.8), art),
            (4.0, at(-3.1, 1.6, -1.6), art),
            (4.5, at(-2.0, 1.5, -3.2), art),
            (5.0, at(-0.4, 1.6, -4.2), art),
            (6.0, at(2.0, 1.7, -4.4), art),
        ]),
        0.9,
    );
    stage.scene
}

/// Floor, walls and ceiling, and eight columns, each a cone between two plates.
fn hall(stage: &mut Stage) {
    let slabs = marble("marble", 512, 8.0, [[225.0, 218.0, 205.0], [120.0, 128.0, 135.0]]);
    stage.scene.textures.push(slabs);
    let floor = stage.material(Material { texture: Some(0), ..Material::polished("marble", Vec3::ONE, 1.5) });
    let plaster = stage.material(Material::matt("plaster", Vec3::new(0.72, 0.68, 0.6)));
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * HALF;
    let sides = [
        ("ceiling", [(-1.0, 1.0, -1.0), (1.0, 1.0, -1.0), (1.0, 1.0, 1.0), (-1.0, 1.0, 1.0)]),
        ("back", [(-1.0, 0.0, -1.0), (1.0, 0.0, -1.0), (1.0, 1.0, -1.0), (-1.0, 1.0, -1.0)]),
        ("front", [(1.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (-1.0, 1.0, 1.0), (1.0, 1.0, 1.0)]),
        ("left", [(-1.0, 0.0, 1.0), (-1.0, 0.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, 1.0, 1.0)]),
        ("right", [(1.0, 0.0, -1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, -1.0)]),
    ];
    for (name, corners) in sides {
        stage.set(sheet(name, corners.map(|(x, y, z)| corner(x, y, z)), [1.0; 2]), plaster, Vec3::ZERO);
    }
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| corner(x, 0.0, z));
    stage.set(sheet("floor", corners, [1.0, 1.5]), floor, Vec3::ZERO);
    let stone = stage.material(Material::polished("stone", Vec3::new(0.55, 0.52, 0.48), 1.4));
    let plate = stage.mesh(cuboid("plate", Vec3::new(1.0, 0.3, 1.0)), stone);
    for (x, z) in [-4.6, 4.6].into_iter().flat_map(|x| [-6.6, -2.2, 2.2, 6.6].map(|z| (x, z))) {
        for y in [0.0, HALF.y - 0.3] {
            stage.scene.add_node(None, "plate", Affine3A::from_translation(Vec3::new(x, y, z)), Some(plate));
        }
        let (base, tip) = (Vec3::new(x, 0.3, z), Vec3::new(x, HALF.y - 0.3, z));
        let column = Cone { base, base_radius: 0.42, tip, tip_radius: 0.32 };
        stage.scene.primitives.push(Primitive { shape: Shape::Cone(column), material: Some(stone) });
    }
}

/// Four of them, which are with the floor the five textures of 512 x 512.
fn paintings(stage: &mut Stage) {
    let frame = stage.material(Material::metal("frame", Vec3::new(0.5, 0.38, 0.18), 30));
    let palettes = [
        [[200.0, 60.0, 40.0], [240.0, 210.0, 120.0]],
        [[30.0, 60.0, 140.0], [180.0, 220.0, 230.0]],
        [[40.0, 90.0, 50.0], [230.0, 220.0, 160.0]],
        [[90.0, 40.0, 110.0], [230.0, 150.0, 90.0]],
    ];
    let walls = [
        (-HALF.x + 0.04, 0.0, 0.5),
        (HALF.x - 0.04, 0.0, -0.5),
        (0.0, HALF.z - 0.04, 1.0),
        (2.9, -HALF.z + 0.04, 0.0),
    ];
    for (number, ((x, z, half_turns), palette)) in walls.into_iter().zip(palettes).enumerate() {
        let name = format!("painting {number}");
        stage.scene.textures.push(painting(&name, 10.0 * number as f64, palette));
        let texture = Some(stage.scene.textures.len() as u32 - 1);
        let canvas = stage.material(Material { texture, ..Material::matt(&name, Vec3::ONE) });
        let place = turned_y(Vec3::new(x, 1.4, z), half_turns * PI);
        stage.put(cuboid("frame", Vec3::new(2.2, 2.2, 0.06)), frame, place);
        let corners = [(-1.0, 0.1), (1.0, 0.1), (1.0, 2.1), (-1.0, 2.1)].map(|(x, y)| Vec3::new(x, y, 0.04));
        stage.put(sheet(&name, corners, [1.0; 2]), canvas, place);
    }
}

/// A pedestal under the art, urns, benches.
fn furniture(stage: &mut Stage) {
    let mirror = Material::metal("chrome", Vec3::splat(0.55), 80);
    let chrome = stage.material(Material { diffuse: Vec3::splat(0.12), ..mirror });
    let outline = [
        (0.0, 0.02),
        (0.9, 0.02),
        (0.9, 0.1),
        (0.7, 0.16),
        (0.62, 0.3),
        (0.68, 0.52),
        (0.74, 0.56),
        (0.0, 0.57),
    ];
    stage.set(lathe("pedestal", &outline, 64, 3), chrome, Vec3::ZERO);
    let glaze = stage.material(Material::polished("glaze", Vec3::new(0.15, 0.28, 0.4), 1.6));
    let urn = stage.mesh(lathe("urn", &VASE, 24, 3), glaze);
    for (x, z) in [(-5.0, -8.0), (5.0, -8.0), (-5.0, 8.0), (5.0, 8.0)] {
        let place = Affine3A::from_scale_rotation_translation(
            Vec3::splat(5.0),
            glam::Quat::IDENTITY,
            Vec3::new(x, 0.01, z),
        );
        stage.scene.add_node(None, "urn", place, Some(urn));
    }
    let oak = stage.material(Material::polished("oak", Vec3::new(0.38, 0.22, 0.1), 1.4));
    let seat = stage.mesh(cuboid("seat", Vec3::new(0.5, 0.08, 2.0)), oak);
    let foot = stage.mesh(cuboid("foot", Vec3::new(0.4, 0.4, 0.1)), oak);
    for x in [-4.6, 4.6] {
        stage.scene.add_node(None, "bench", Affine3A::from_translation(Vec3::new(x, 0.4, 0.0)), Some(seat));
        for z in [-0.8, 0.8] {
            stage.scene.add_node(None, "foot", Affine3A::from_translation(Vec3::new(x, 0.0, z)), Some(foot));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::describe;

    #[test]
    fn the_counts_are_the_papers() {
        for k in 3..=8 {
            let scene = museum("bart-museum", k);
            scene.validate().unwrap();
            let (holds, flying) = (describe(&scene), 1 << (2 * k));
            assert_eq!((holds.instanced_triangles, holds.primitives), (POLYGONS + flying, 8), "{k}");
            assert_eq!((holds.bending, holds.bending_triangles, holds.moving), (1, flying, 0));
            assert_eq!((holds.lights, holds.textures, holds.frames, holds.seconds), (2, 5, 300, 6.0));
            assert_eq!(holds.zero_area, 0, "{k}");
            assert!(scene.textures.iter().all(|texture| (texture.width, texture.height) == (512, 512)));
            assert_eq!(scene.animation.bends[0].keys.len(), 5, "five constellations");
        }
        // Table 1: "10,215 to 75,687" primitives.
        assert_eq!((POLYGONS + 8 + 64, POLYGONS + 8 + 65_536), (10_215, 75_687));
    }

    #[test]
    fn the_camera_stays_in_the_room_and_the_art_off_its_walls() {
        let scene = museum("bart-museum", 4);
        for time in scene.animation.times(scene.animation.frames) {
            let pose = scene.pose(time);
            let (eye, art) = (pose.view.unwrap().eye, pose.bent[0].bounds);
            for point in [eye, art.min, art.max] {
                assert!(
                    point.x.abs() < HALF.x && point.z.abs() < HALF.z && point.y > 0.3 && point.y < HALF.y
                );
            }
        }
    }
}
