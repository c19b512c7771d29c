//! Figures as SVG: axes, ticks and the way from numbers to places by `plotters`, the points written so that the
//! page's script finds them again.
//!
//! A panel is drawn in *units*, half a pixel of its natural size, so that whole numbers are fine enough. Nothing in it
//! names a colour: classes do, and the page or the file says which colours those are.

mod bars;
mod field;
mod pen;
mod plot;
mod sheet;
mod ticked;

pub(crate) use sheet::{looks, sheet, style};

use super::ReportError;
use super::escape::attribute;
use super::figure::{Body, Entry, Panel};
use std::fmt::Display;

/// The sizes of panels, units: up to so many are so large.
const SIZES: [(usize, (u32, u32)); 3] = [(2, (880, 580)), (6, (720, 480)), (usize::MAX, (480, 340))];
/// Letters are so high, units.
const LETTER: i32 = 24;

/// A drawn panel: `<svg ATTRIBUTES>inside</svg>`.
pub(crate) struct Drawn {
    /// Width and height, units.
    pub(crate) size: (u32, u32),
    /// What the page's script has to know, as attributes.
    pub(crate) data: String,
    pub(crate) inside: String,
}

/// The size of each panel, of so many.
pub(crate) fn size(panels: usize) -> (u32, u32) {
    SIZES.iter().find(|(most, _)| panels <= *most).map_or((0, 0), |(_, size)| *size)
}

/// Draws a panel.
///
/// # Errors
/// The drawing library refused.
pub(crate) fn panel(panel: &Panel, legend: &[Entry], size: (u32, u32)) -> Result<Drawn, ReportError> {
    let drawn = match &panel.body {
        Body::Plot(plot) => plot::draw(plot, legend, size),
        Body::Field(field) => Ok(field::draw(field, legend, size)),
        Body::Bars(bars) => Ok(bars::draw(bars)),
    };
    drawn.map_err(|message| ReportError::Draw { chart: panel.heading.clone(), message })
}

/// A line of text at its baseline; `class` says how it is anchored.
fn text(x: i32, y: i32, class: &str, words: &str) -> String {
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
    format!("<text x=\"{x}\" y=\"{y}\"{class}>{}</text>", attribute(words))
}

/// The message of another library's error.
fn message(error: impl Display) -> String {
    error.to_string()
}
