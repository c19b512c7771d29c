//! How a scene is put on: the settings `scene.copies` and `scene.spacing`, any scene many times over (BU-10);
//! `scene.path`, the kind of camera path, one of [`PATHS`]; `scene.fov`, the camera's full vertical angle in
//! degrees, and `scene.off_axis`, by how many half-widths its window is moved to the right (P1-F02);
//! `scene.moving`, the share of the tree's leaves that move from each frame to the next, see [`Movers`] (P1-F06).

use super::{Cell, MeasureError, Options};
use crate::geometry::Lens;
use crate::measure::Value;
use crate::record::THREADS;
use crate::scene::{CameraPath, Movers, PATHS, Scene};
use crate::structure::SkipTree;
use std::ops::RangeInclusive;

/// A million is what two levels of hierarchies take in; a walk through so many takes longer than anyone waits.
const COPIES: RangeInclusive<f64> = 1.0..=1_000_000.0;
/// From all in one place to a thousand widths apart.
const SPACING: RangeInclusive<f64> = 0.0..=1000.0;

/// Full vertical angles of a lens, degrees.
const FOV: RangeInclusive<f64> = 0.01..=170.0;
/// A window a half-width to the side just holds the line of sight.
const SHIFT: RangeInclusive<f64> = -10.0..=10.0;
/// The setting of what moves.
const MOVING: &str = "scene.moving";
/// Width over height of the picture.
const ASPECT: f32 = 4.0 / 3.0;

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
    let mut path = match cell.settings.get("scene.path").map(Value::to_string) {
        None => CameraPath::for_scene(scene, frames, options.seed),
        Some(kind) => {
            let known = PATHS.iter().find(|known| known.name == kind).ok_or_else(|| {
                let words = PATHS.iter().map(|known| known.name).collect::<Vec<_>>().join(", ");
                MeasureError::Setting(format!("setting `scene.path` is `{kind}`, expected one of: {words}"))
            })?;
            known.make(scene, frames, options.seed)
        }
    };
    if let Some(lens) = lens(cell)? {
        path.frames.iter_mut().for_each(|camera| camera.lens = lens);
    }
    Ok(path)
}

/// Refuses to move things where that would go unheeded: no other job refits its tree, and simulated machines do not
/// bill it.
pub(super) fn check_moving(cell: &Cell) -> Result<(), MeasureError> {
    if !cell.settings.contains_key(MOVING) || cell.job == "cull" && cell.machine == THREADS {
        return Ok(());
    }
    let (job, machine) = (&cell.job, &cell.machine);
    let message = format!("expected the job `cull` on `{THREADS}`, found `{job}` on `{machine}`");
    Err(MeasureError::Setting(format!("setting `{MOVING}`: {message}")))
}

/// What moves where a cell says so; `None` where it says nothing.
pub(super) fn movers(
    cell: &Cell,
    scene: &Scene,
    tree: &SkipTree,
    options: &Options,
) -> Result<Option<Movers>, MeasureError> {
    if !cell.settings.contains_key(MOVING) {
        return Ok(None);
    }
    let share = number(cell, MOVING, 0.0..=1.0, 0.0)?;
    let leaves = (0..).zip(&tree.nodes).filter(|(index, node)| node.end == index + 1);
    Ok(Some(Movers::new(scene, leaves.map(|(_, leaf)| leaf.source).collect(), share, options.seed)))
}

/// The lens that a cell asks for instead of the path's own.
fn lens(cell: &Cell) -> Result<Option<Lens>, MeasureError> {
    if !["scene.fov", "scene.off_axis"].iter().any(|key| cell.settings.contains_key(*key)) {
        return Ok(None);
    }
    let fov_y = number(cell, "scene.fov", FOV, 60.0)?.to_radians();
    let shift = number(cell, "scene.off_axis", SHIFT, 0.0)? as f32;
    if shift == 0.0 {
        return Ok(Some(Lens::Symmetric { fov_y: fov_y as f32, aspect: ASPECT }));
    }
    let top = (fov_y / 2.0).tan() as f32;
    let right = top * ASPECT;
    Ok(Some(Lens::OffAxis { left: -right + shift * right, right: right + shift * right, bottom: -top, top }))
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
