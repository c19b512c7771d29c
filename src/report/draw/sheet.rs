//! A figure as a file of its own: panels, headings and legend, in the colours of paper.

use super::{Drawn, panel, size, text};
use crate::report::ReportError;
use crate::report::escape::attribute;
use crate::report::figure::{Body, Figure, Panel};
use crate::report::marker::{COLOURS, Look};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A lone panel's size, units.
const LONE: (u32, u32) = (1400, 1000);
/// Room for the title, units.
const TITLE: i32 = 100;
/// Room above a panel for its heading.
const HEADING: i32 = 44;
/// Between panels.
const GAP: i32 = 40;
/// From one line of the legend to the next.
const LINE: i32 = 44;
/// Some units a letter takes at this size.
const ADVANCE: i32 = 13;
/// The most panels beside one another.
const COLUMNS: usize = 3;
/// The variables of the style sheet, as they are on paper.
const PAPER: [(&str, &str); 4] = [
    ("var(--ink)", "#1a1a1a"),
    ("var(--dim)", "#444"),
    ("var(--axis)", "#6e6e6e"),
    ("var(--grid)", "#e1e1e1"),
];

/// The style sheet of drawings; its colours are the page's variables.
pub(crate) fn style() -> &'static str {
    include_str!("draw.css")
}

/// The styles and the marks of the looks in use, in an order of their own; colours given by their number.
pub(crate) fn looks(
    used: impl IntoIterator<Item = Look>,
    colour: impl Fn(usize) -> String,
    background: &str,
) -> (String, String) {
    let mut used: Vec<Look> = used.into_iter().collect();
    used.sort_unstable();
    used.dedup();
    let (mut css, mut marks) = (String::new(), BTreeMap::new());
    for look in &used {
        css.push_str(&look.css(&colour));
        marks.entry(look.mark_id()).or_insert_with(|| look.marks(&colour, background));
    }
    let mut colours: Vec<usize> = used.iter().map(|look| look.colour).collect();
    colours.dedup();
    for number in colours {
        let _ = writeln!(css, ".k{number}{{stroke:{0}}}.f{number}{{fill:{0}}}", colour(number));
    }
    (css, marks.into_values().collect())
}

/// The figure's panels of those numbers as an SVG file; all its words say what the page says.
///
/// # Errors
/// The drawing library refused.
pub(crate) fn sheet(title: &str, figure: &Figure, panels: &[&Panel]) -> Result<String, ReportError> {
    let lone = panels.len() == 1 && !panels[0].place.is_empty();
    let size = if lone { LONE } else { size(panels.len()) };
    let drawn: Result<Vec<Drawn>, _> = panels.iter().map(|one| panel(one, &figure.legend, size)).collect();
    let drawn = drawn?;
    let columns = panels.len().clamp(1, COLUMNS);
    let wide = drawn.iter().map(|one| one.size.0 as i32).max().unwrap_or(0);
    let mut body = String::new();
    let mut y = TITLE;
    for (headings, line) in panels.chunks(columns).zip(drawn.chunks(columns)) {
        for (number, (one, drawn)) in headings.iter().zip(line).enumerate() {
            let x = GAP / 2 + number as i32 * (wide + GAP);
            let (width, height) = drawn.size;
            let heading = if lone { &one.place } else { &one.heading };
            body.push_str(&text(x, y + 26, "b", heading));
            let _ = write!(
                body,
                "<svg x=\"{x}\" y=\"{}\" width=\"{width}\" height=\"{height}\">{}</svg>",
                y + HEADING,
                drawn.inside
            );
        }
        y += line.iter().map(|one| one.size.1 as i32).max().unwrap_or(0) + HEADING + GAP;
    }
    let used: Vec<usize> = (0..figure.legend.len()).filter(|entry| is_drawn(*entry, panels)).collect();
    let legend_x = GAP + columns as i32 * (wide + GAP);
    let mut lines: Vec<String> = Vec::new();
    for (number, entry) in used.iter().map(|&entry| &figure.legend[entry]).enumerate() {
        let y = TITLE + HEADING + LINE * number as i32;
        let class = entry.look.class();
        let (from, middle, to) = (legend_x, legend_x + 32, legend_x + 64);
        let _ = write!(
            body,
            "<polyline class=\"c {class} key\" points=\"{from},{y} {to},{y}\"/><polyline class=\"s {class}\" \
             points=\"{middle},{y} {middle},{y}\"/>"
        );
        lines.push(entry.label.clone());
    }
    // The notes stand below the legend, split where they would run out of the picture.
    let notes = panels.iter().filter(|one| !one.note.is_empty() && lone);
    lines.extend(notes.flat_map(|one| split(&one.note)));
    lines.extend(split(&figure.how));
    for (number, words) in lines.iter().enumerate() {
        let (x, y) = (legend_x + 84, TITLE + HEADING + LINE * number as i32 + 8);
        body.push_str(&text(if number < used.len() { x } else { legend_x }, y, "", words));
    }
    let letters = lines.iter().map(|words| words.chars().count() as i32).max().unwrap_or(0);
    let width = legend_x + 84 + ADVANCE * letters + GAP;
    let height = y.max(TITLE + HEADING + LINE * lines.len() as i32);
    let colour = |number: usize| COLOURS[number][0].to_owned();
    let (css, marks) = looks(used.iter().map(|&entry| figure.legend[entry].look), colour, "#fff");
    let mut css = format!("{}.key{{marker:none!important}}\n{css}", style());
    for (variable, colour) in PAPER {
        css = css.replace(variable, colour);
    }
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\" aria-label=\"{}\">\n<style>{css}</style>\n<defs>{marks}</defs>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <text x=\"20\" y=\"40\" style=\"font-size:32px;fill:#1a1a1a\">{}</text>{}\n{body}\n</svg>\n",
        width / 2,
        height / 2,
        attribute(&format!("{title}: {}", figure.says)),
        attribute(title),
        text(20, 76, "", &figure.title),
    ))
}

fn is_drawn(entry: usize, panels: &[&Panel]) -> bool {
    panels.iter().any(|panel| match &panel.body {
        Body::Plot(plot) => plot.series.iter().any(|series| series.entry == Some(entry)),
        Body::Field(field) => field.cells.iter().any(|cell| cell.entry == entry),
        Body::Bars(bars) => bars.spans.iter().any(|span| span.activity == entry),
    })
}

/// Words in lines of some fifty letters.
fn split(words: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in words.split_whitespace() {
        let last = lines.len() - 1;
        if lines[last].chars().count() + word.chars().count() > 48 {
            lines.push(word.to_owned());
        } else {
            let space = if lines[last].is_empty() { "" } else { " " };
            lines[last].push_str(space);
            lines[last].push_str(word);
        }
    }
    lines
}
