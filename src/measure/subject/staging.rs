//! How a scene is put on: the settings `scene.copies` and `scene.spacing`, any scene many times over (BU-10),
//! and `scene.view`, from within (`inside`) or all of it at once (`whole`, BU-F05).

use super::{Cell, MeasureError, Options};
use crate::geometry::{Camera, Lens};
use crate::measure::Value;
use crate::scene::{CameraPath, Scene};
use glam::Vec3;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;

/// More would take longer to walk through than anyone waits.
const COPIES: RangeInclusive<f64> = 1.0..=10_000.0;
/// From all in one place to a thousand widths apart.
const SPACING: RangeInclusive<f64> = 0.0..=1000.0;

/// The scene a cell names, as many times and as far apart as it says; one copy, two widths from middle to
/// middle, where it says nothing.
pub(super) fn scene(cell: &Cell) -> Result<Scene, MeasureError> {
    let copies = number(cell, "scene.copies", COPIES, 1.0)?;
    if copies.fract() != 0.0 {
        return Err(MeasureError::Setting(format!(
            "setting `scene.copies` is `{copies}`, expected a whole number"
        )));
    }
    let spacing = number(cell, "scene.spacing", SPACING, 2.0)?;
    let scene = super::scene(&cell.scene)?.repeated(copies as u32, spacing as f32);
    scene.validate().map_err(super::failed)?;
    Ok(scene)
}

/// The cameras of a cell where no recorded path is given.
pub(super) fn path(cell: &Cell, scene: &Scene, options: &Options) -> Result<CameraPath, MeasureError> {
    let frames = options.frames as usize;
    match cell.settings.get("scene.view").map(Value::to_string).as_deref() {
        None | Some("inside") => Ok(CameraPath::for_scene(scene, frames, options.seed)),
        Some("whole") => Ok(around(scene, frames)),
        Some(value) => Err(MeasureError::Setting(format!(
            "setting `scene.view` is `{value}`, expected one of: inside, whole"
        ))),
    }
}

/// Once around the scene with all of it in view. No frames where there is nothing to see.
fn around(scene: &Scene, frames: usize) -> CameraPath {
    let bounds = scene.bounds();
    let (centre, radius) = (bounds.centre(), bounds.half_diagonal().max(f32::MIN_POSITIVE));
    // A sphere fills a lens of 60 degrees at twice its radius; a tenth more leaves room for rounding.
    let (distance, reach) = (2.2 * radius, 1.1 * radius);
    let lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_3, aspect: 4.0 / 3.0 };
    let camera = |frame: usize| {
        let (sin, cos) = (TAU * frame as f64 / frames as f64).sin_cos();
        let eye = centre + Vec3::new(cos as f32, 0.3, sin as f32).normalize() * distance;
        Camera::look_at(eye, centre, Vec3::Y, lens, distance - reach, distance + reach).ok()
    };
    CameraPath { frames: (0..frames).filter(|_| !bounds.is_empty()).filter_map(camera).collect() }
}

fn number(cell: &Cell, key: &str, range: RangeInclusive<f64>, absent: f64) -> Result<f64, MeasureError> {
    let Some(value) = cell.settings.get(key) else { return Ok(absent) };
    value.number().filter(|number| range.contains(number)).ok_or_else(|| {
        let (least, most) = (range.start(), range.end());
        MeasureError::Setting(format!(
            "setting `{key}` is `{value}`, expected a number from {least} to {most}"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::oracle::Hexahedron;
    use crate::scene::by_name;

    #[test]
    fn the_whole_scene_is_in_view_all_around() {
        for scene in [by_name("dragons-split").unwrap(), by_name("far-outlier").unwrap()] {
            let path = around(&scene, 12);
            assert_eq!(path.frames.len(), 12);
            for camera in &path.frames {
                assert!(Hexahedron::new(camera).contains(&scene.bounds()));
            }
        }
        assert!(around(&Scene::new("nothing"), 12).frames.is_empty());
    }
}
