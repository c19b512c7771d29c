//! Once around a scene, all of it in view.

use std::f64::consts::TAU;

use glam::Vec3;

use super::{CameraPath, LENS, PathKind};
use crate::geometry::Camera;
use crate::scene::{Scene, SplitMix64};

/// Where culling can only cost (BU-F05).
pub(super) const WHOLE: PathKind =
    PathKind { name: "whole", about: "once around the scene, all of it in view", make: around };

/// Begins at a seeded angle. No frames where there is nothing to see.
fn around(scene: &Scene, frames: usize, seed: u64) -> CameraPath {
    let bounds = scene.bounds();
    let centre = bounds.centre();
    // A point is given a size that can be told from its own rounding.
    let radius = bounds.half_diagonal().max(centre.abs().max_element() * 1e-5).max(1e-3);
    let start = SplitMix64::new(seed).between(0.0, TAU);
    // A sphere fills a lens of 60 degrees at twice its radius; a tenth more leaves room for rounding.
    let (distance, reach) = (2.2 * radius, 1.1 * radius);
    let camera = |frame: usize| {
        let (sin, cos) = (start + TAU * frame as f64 / frames as f64).sin_cos();
        let eye = centre + Vec3::new(cos as f32, 0.3, sin as f32).normalize() * distance;
        Camera::look_at(eye, centre, Vec3::Y, LENS, distance - reach, distance + reach).ok()
    };
    CameraPath { frames: (0..frames).filter(|_| !bounds.is_empty()).filter_map(camera).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::oracle::Hexahedron;
    use crate::scene::by_name;

    #[test]
    fn the_whole_scene_is_in_view_all_around() {
        for scene in [by_name("dragons-split").unwrap(), by_name("far-outlier").unwrap()] {
            let path = around(&scene, 12, 1);
            assert_eq!(path.frames.len(), 12);
            for camera in &path.frames {
                assert!(Hexahedron::new(camera).contains(&scene.bounds()));
            }
        }
        assert!(around(&Scene::new("nothing"), 12, 1).frames.is_empty());
    }
}
