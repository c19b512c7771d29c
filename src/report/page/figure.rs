//! A figure in the page: legend, panels, what to see, the numbers.

use super::tables::numbers;
use crate::report::ReportError;
use crate::report::draw::{Drawn, panel, size};
use crate::report::escape::{anchor, attribute, link};
use crate::report::figure::{Body, Figure, Panel};
use crate::report::run::{files, vega_name};
use std::fmt::Write;

/// Up to so many files are linked one by one.
const LINKS: usize = 4;

pub(super) fn html(section: &str, folder: &str, figure: &Figure) -> Result<String, ReportError> {
    let id = format!("{section}-{}", anchor(&figure.kind));
    let size = size(figure.panels.len());
    let mut html = format!("<figure id=\"{id}\" data-kind=\"{}\">\n", anchor(&figure.kind));
    let _ = writeln!(html, "<h3>{}</h3>", attribute(&figure.title));
    html.push_str(&legend(figure));
    // Headings of many panels take up to three lines; drawings stand level all the same.
    let many = if figure.panels.len() > 6 { " many" } else { "" };
    let _ = writeln!(html, "<div class=\"panels{many}\" style=\"--w:{}px\">", size.0 / 2);
    let mut pair = None;
    for one in &figure.panels {
        if pair != Some(one.pair) {
            html.push_str(if pair.is_some() { "</div><div class=\"pair\">" } else { "<div class=\"pair\">" });
            pair = Some(one.pair);
        }
        html.push_str(&panel_html(figure, one, &panel(one, &figure.legend, size)?));
    }
    html.push_str("</div></div>\n");
    let _ = writeln!(
        html,
        "<figcaption><p>{} <span class=\"how\">{}</span></p><p class=\"files\">{}</p></figcaption>",
        attribute(&figure.says),
        attribute(&figure.how),
        links(folder, figure)
    );
    html.push_str(&numbers(figure));
    Ok(html + "</figure>\n")
}

/// A button a curve, pressed while it is shown; and those of the axes, for the script to bring out.
fn legend(figure: &Figure) -> String {
    let mut html = String::from("<div class=\"legend\" role=\"group\" aria-label=\"Show or hide\">");
    for (number, entry) in figure.legend.iter().enumerate() {
        let look = entry.look.class();
        let key = if figure.panels.iter().all(|panel| matches!(panel.body, Body::Plot(_))) {
            format!(
                "<svg viewBox=\"0 0 76 24\" aria-hidden=\"true\"><polyline class=\"c {look} key\" points=\"2,12 74,12\"/>\
                 <polyline class=\"s {look}\" points=\"38,12 38,12\"/></svg>"
            )
        } else {
            format!(
                "<svg class=\"swatch\" viewBox=\"-12 -12 24 24\" aria-hidden=\"true\"><path class=\"f{}\" d=\"{}\"/></svg>",
                entry.look.colour,
                entry.look.outline()
            )
        };
        let _ = write!(
            html,
            "<button type=\"button\" aria-pressed=\"true\" data-c=\"{number}\">{key}{}</button>",
            attribute(&entry.label)
        );
    }
    html.push_str("</div>\n");
    if figure.panels.iter().any(|panel| matches!(panel.body, Body::Plot(_))) {
        html.push_str(
            "<div class=\"tools\" role=\"group\" aria-label=\"Axes and zoom\" hidden>\
             <button type=\"button\" aria-pressed=\"false\" data-axis=\"x\">log x</button>\
             <button type=\"button\" aria-pressed=\"false\" data-axis=\"y\">log y</button>\
             <button type=\"button\" data-zoom=\"in\" aria-label=\"zoom in\">+</button>\
             <button type=\"button\" data-zoom=\"out\" aria-label=\"zoom out\">−</button>\
             <button type=\"button\" data-zoom=\"all\">whole</button></div>\n",
        );
    }
    html
}

fn panel_html(figure: &Figure, panel: &Panel, drawn: &Drawn) -> String {
    let (width, height) = drawn.size;
    let heading = attribute(&panel.heading);
    let note = if panel.note.is_empty() {
        String::new()
    } else {
        format!("<p class=\"note\">{}</p>", attribute(&panel.note))
    };
    format!(
        "<div class=\"panel\"><h4>{heading}</h4><svg class=\"chart\" role=\"img\" tabindex=\"0\" aria-label=\"{}: \
         {heading}. The numbers are in the table below.\" viewBox=\"0 0 {width} {height}\" style=\"width:{}px\"{}>{}\
         </svg>{note}</div>\n",
        attribute(&figure.title),
        width / 2,
        drawn.data,
        drawn.inside
    )
}

/// The files beside the rows that show the same.
fn links(folder: &str, figure: &Figure) -> String {
    let drawings = files(figure);
    let mut words = vec![format!("<a href=\"{}\">rows</a>", link(&format!("{folder}/rows.csv")))];
    if drawings.len() <= LINKS {
        let each = drawings.iter().map(|(name, _)| {
            format!("<a href=\"{}\">{}</a>", link(&format!("{folder}/{name}")), attribute(name))
        });
        words.extend(each);
    }
    if !matches!(figure.panels[0].body, Body::Bars(_)) {
        let name = vega_name(figure);
        words.push(format!("<a href=\"{}\">Vega-Lite</a>", link(&format!("{folder}/{name}"))));
    }
    words.join(" · ")
}
