//! The settings `scene.copies` and `scene.spacing`: any scene many times over (BU-10).

use super::{Cell, MeasureError};
use crate::scene::Scene;
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

fn number(cell: &Cell, key: &str, range: RangeInclusive<f64>, absent: f64) -> Result<f64, MeasureError> {
    let Some(value) = cell.settings.get(key) else { return Ok(absent) };
    value.number().filter(|number| range.contains(number)).ok_or_else(|| {
        let (least, most) = (range.start(), range.end());
        MeasureError::Setting(format!(
            "setting `{key}` is `{value}`, expected a number from {least} to {most}"
        ))
    })
}
