//! One HTML file for all: readable from disk, without a network, without the script, on paper.
//!
//! What is drawn stands in it as SVG; the script only adds what a still page has not: the row behind a point, hiding
//! curves, logarithmic axes, zoom. Words from rows and files are escaped wherever they stand.

mod figure;
mod overview;
mod section;
mod tables;

use super::draw::{looks, style};
use super::escape::{anchor, attribute};
use super::figure::figures;
use super::marker::COLOURS;
use super::{ReportError, Run};
use section::Section;
use std::fmt::Write;

/// The page of those runs, in their order.
///
/// # Errors
/// There is no run, one has no rows, or the drawing library refused.
pub fn page(runs: &[Run]) -> Result<String, ReportError> {
    if runs.is_empty() {
        return Err(ReportError::Empty { what: "no run was given".to_owned() });
    }
    let mut sections: Vec<Section<'_>> = Vec::new();
    for run in runs {
        if run.rows.is_empty() {
            return Err(ReportError::Empty { what: format!("{} has none", run.link) });
        }
        // Two runs of one experiment stand in the page side by side.
        let name = anchor(&run.meta.experiment);
        let again =
            sections.iter().filter(|section| section.run.meta.experiment == run.meta.experiment).count();
        let id = if again == 0 { name } else { format!("{name}-{}", again + 1) };
        sections.push(Section { id, run, figures: figures(run) });
    }
    let used = sections.iter().flat_map(|section| &section.figures).flat_map(|figure| &figure.legend);
    let (curves, marks) =
        looks(used.map(|entry| entry.look), |number| format!("var(--k{number})"), "var(--ground)");
    let mut html = String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    html.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    // An icon in the page itself: browsers ask the network for one otherwise.
    html.push_str("<link rel=\"icon\" href=\"data:,\">\n<title>apportion: what sharing buys</title>\n");
    let _ = writeln!(
        html,
        "<style>\n{}{}{}{curves}</style>\n</head>\n<body>",
        colours(),
        include_str!("page.css"),
        style()
    );
    let _ = writeln!(
        html,
        "<svg class=\"marks\" aria-hidden=\"true\" width=\"0\" height=\"0\"><defs>{marks}</defs></svg>\n\
         <a class=\"skip\" href=\"#contents\">Skip to the contents</a>\n<header>\n<h1>What sharing buys</h1>\n<p>{}</p>\n</header>",
        attribute(&overview::says(&sections)),
    );
    html.push_str(&overview::contents(&sections));
    html.push_str("<main>\n");
    html.push_str(&overview::table(&sections));
    for section in &sections {
        html.push_str(&section.html()?);
    }
    // One scope for both files, out of the way of whatever a browser adds to the page.
    let _ = write!(
        html,
        "</main>\n<div id=\"tip\" role=\"status\" aria-live=\"polite\" hidden></div>\n<script>\n\"use strict\";\n{{\n{}{}}}\n\
         </script>\n</body>\n</html>\n",
        include_str!("chart.js"),
        include_str!("page.js")
    );
    Ok(html)
}

/// The colours of curves on light and on dark.
fn colours() -> String {
    let list = |ground: usize| {
        let each = COLOURS.iter().enumerate().map(|(number, pair)| format!("--k{number}:{};", pair[ground]));
        each.collect::<String>()
    };
    format!(
        ":root{{{}}}\n@media (prefers-color-scheme:dark){{@media not print{{:root{{{}}}}}}}\n",
        list(0),
        list(1)
    )
}
