//! A plane of winners: cells tinted in the winner's colour, with its mark and the margin in words.

use super::{Drawn, LETTER, text};
use crate::report::escape::attribute;
use crate::report::figure::{Entry, Field};
use std::fmt::Write;

/// Some units a letter takes.
const ADVANCE: usize = 14;

/// A grid needs no axes: names stand beside its lines and below its columns.
pub(super) fn draw(field: &Field, legend: &[Entry], (width, _): (u32, u32)) -> Drawn {
    let longest = |values: &[String]| values.iter().map(|value| value.chars().count()).max().unwrap_or(0);
    let left = (longest(&field.lines.1).max(field.lines.0.chars().count()) * ADVANCE + 16).min(300) as i32;
    let (columns, lines) = (field.columns.1.len().max(1) as i32, field.lines.1.len().max(1) as i32);
    let cell = ((width as i32 - left - 4) / columns).max(60);
    let tall = 74;
    let (bottom, top) = (34 + tall * lines, 34);
    let mut out = String::new();
    out.push_str(&text(left - 12, 22, "e", &field.lines.0));
    for (number, value) in field.lines.1.iter().enumerate() {
        out.push_str(&text(left - 12, top + tall * number as i32 + tall / 2 + 8, "e", value));
    }
    for (number, value) in field.columns.1.iter().enumerate() {
        out.push_str(&text(left + cell * number as i32 + cell / 2, bottom + LETTER, "m", value));
    }
    out.push_str(&text(left + cell * columns / 2, bottom + 2 * LETTER + 6, "m", &field.columns.0));
    out.push_str("<g class=\"d\">");
    for cell_ in &field.cells {
        let look = legend[cell_.entry].look;
        let (x, y) = (left + cell * cell_.column as i32, top + tall * cell_.line as i32);
        let (column, line) = (&field.columns.1[cell_.column], &field.lines.1[cell_.line]);
        let place = format!("{} = {line}, {} = {column}", field.lines.0, field.columns.0);
        let _ = write!(
            out,
            "<g class=\"cell\" data-c=\"{}\" data-t=\"{}\"><rect class=\"f{}\" x=\"{x}\" y=\"{y}\" width=\"{}\" \
             height=\"{}\"/><path class=\"f{}\" transform=\"translate({} {})\" d=\"{}\"/>{}</g>",
            cell_.entry,
            attribute(&format!("{place}: {}", cell_.note)),
            look.colour,
            cell - 4,
            tall - 4,
            look.colour,
            x + cell / 2 - 2,
            y + 22,
            look.outline(),
            text(x + cell / 2 - 2, y + 58, "m t", &cell_.text),
        );
    }
    out.push_str("</g>");
    let size = ((left + cell * columns + 4) as u32, (bottom + 2 * LETTER + 16) as u32);
    Drawn { size, data: String::new(), inside: out }
}
