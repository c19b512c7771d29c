//! The parts a factory is made of, and how many triangles each gets.

use std::collections::BTreeMap;

use glam::Vec3;

use super::super::super::Scene;
use super::super::shapes::{self, CUBOID_TRIANGLES, LEAST_CYLINDER};

/// Shape of a part. Lengths in metres; a part stands on its origin.
#[derive(Clone, Copy)]
pub(super) enum Shape {
    /// Sizes along x, y and z.
    Box(Vec3),
    /// Radius and height of a coarse cylinder.
    Round(f32, f32),
    /// Radius and height of a cylinder with [`FINE`] times the triangles of a coarse one.
    Fine(f32, f32),
}

/// How many times the triangles of a coarse cylinder a fine one gets.
const FINE: u32 = 4;

/// Parts placed so far: the meshes are made when all are known, since the triangles are shared out then.
#[derive(Default)]
pub(super) struct Parts {
    placed: Vec<(u32, &'static str, Shape)>,
}

impl Parts {
    /// Notes that a node shows a part. Parts of one name must be of one shape.
    pub(super) fn place(&mut self, node: u32, name: &'static str, shape: Shape) {
        self.placed.push((node, name, shape));
    }

    /// Makes the meshes, `triangles` in all, and hangs them on their nodes. Boxes have as many as boxes
    /// have; cylinders share the rest by weight, and what the division leaves over goes, two by two,
    /// to the fine ones.
    pub(super) fn finish(&self, scene: &mut Scene, triangles: u32) {
        let count = |wanted: fn(&Shape) -> bool| {
            self.placed.iter().filter(|(_, _, shape)| wanted(shape)).count() as u32
        };
        let boxes = count(|shape| matches!(shape, Shape::Box(_)));
        let fine = count(|shape| matches!(shape, Shape::Fine(..)));
        let weight = count(|shape| matches!(shape, Shape::Round(..))) + FINE * fine;
        let pairs = (triangles - boxes * CUBOID_TRIANGLES) / 2;
        let (coarse, left) = (pairs / weight, pairs % weight);
        assert!(2 * coarse >= LEAST_CYLINDER, "too few triangles for that many cylinders");
        let mut meshes: BTreeMap<(&str, u32), u32> = BTreeMap::new();
        let mut fine_done = 0;
        for (node, name, shape) in &self.placed {
            let count = match shape {
                Shape::Box(_) => CUBOID_TRIANGLES,
                Shape::Round(..) => 2 * coarse,
                Shape::Fine(..) => {
                    let extra = left / fine + u32::from(fine_done < left % fine);
                    fine_done += 1;
                    2 * (FINE * coarse + extra)
                }
            };
            let mesh = *meshes.entry((name, count)).or_insert_with(|| {
                scene.add_mesh(match *shape {
                    Shape::Box(size) => shapes::cuboid(name, size),
                    Shape::Round(radius, height) | Shape::Fine(radius, height) => {
                        shapes::cylinder(name, radius, height, count)
                    }
                })
            });
            scene.nodes[*node as usize].mesh = Some(mesh);
        }
    }
}
