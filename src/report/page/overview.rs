//! The top of the page: what it is, the contents, all runs at a glance.

use super::section::Section;
use crate::record::THREADS;
use crate::report::escape::{anchor, attribute};
use crate::report::table::{Line, table as lines};
use std::fmt::Write;

/// What the page holds, in a sentence.
pub(super) fn says(sections: &[Section<'_>]) -> String {
    let rows: usize = sections.iter().map(|section| section.run.rows.len()).sum();
    let panels: usize =
        sections.iter().flat_map(|section| &section.figures).map(|figure| figure.panels.len()).sum();
    let charts: usize = sections.iter().map(|section| section.figures.len()).sum();
    let runs = if sections.len() == 1 { "one run".to_owned() } else { format!("{} runs", sections.len()) };
    format!(
        "Graphics work shared out over processors, real and simulated: {charts} charts in {panels} panels, drawn \
         from the {rows} rows of {runs}. Numbers are medians; a bar through a mark is its 95 % interval. Move over \
         a point, or step through a chart with the arrow keys, to see its row; drag a box to zoom."
    )
}

pub(super) fn contents(sections: &[Section<'_>]) -> String {
    let mut html = String::from("<nav id=\"contents\" aria-label=\"Contents\">\n<h2>Contents</h2>\n<ol>\n");
    for section in sections {
        let (id, title) = (&section.id, attribute(&section.run.question.title));
        let _ = write!(html, "<li><a href=\"#{id}\">{title}</a><br><small>");
        for figure in &section.figures {
            let _ =
                write!(html, "<a href=\"#{id}-{}\">{}</a> ", anchor(&figure.kind), attribute(&figure.title));
        }
        html.push_str("</small>\n");
    }
    html + "</ol>\n</nav>\n"
}

/// A line a run: how fast at best, simulated and measured, and how far from the paper.
pub(super) fn table(sections: &[Section<'_>]) -> String {
    let mut html = String::from(
        "<section id=\"overview\">\n<h2>All runs at a glance</h2>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" \
         aria-label=\"All runs\"><table><thead><tr><th scope=\"col\">Experiment<th scope=\"col\">Highest speedup, \
         simulated<th scope=\"col\">Highest speedup, measured<th scope=\"col\" class=\"n\">Mean error against the paper\
         <tbody>\n",
    );
    for section in sections {
        let table = lines(&section.run.rows, &section.run.question.paper);
        let own = || table.lines.iter().filter(|line| line.figure.is_none());
        let simulated = highest(own().filter(|line| line.machine != THREADS), |line| line.simulated);
        let measured = highest(own(), |line| line.measured);
        let errors: Vec<f64> =
            table.lines.iter().filter_map(|line| line.error_simulated).filter(|e| e.is_finite()).collect();
        let error = if errors.is_empty() {
            "none printed".to_owned()
        } else {
            let mean = errors.iter().map(|error| error.abs()).sum::<f64>() / errors.len() as f64;
            format!("{:.0} % of {}", 100.0 * mean, errors.len())
        };
        let name = attribute(&section.run.meta.experiment);
        let _ = writeln!(
            html,
            "<tr><th scope=\"row\"><a href=\"#{}\">{name}</a><td>{simulated}<td>{measured}<td class=\"n\">{error}",
            section.id
        );
    }
    html + "</table></div>\n</section>\n"
}

fn highest<'a>(lines: impl Iterator<Item = &'a Line>, value: impl Fn(&Line) -> Option<f64>) -> String {
    let parallel = lines.filter(|line| line.scheme != "serial" && line.processors != Some(1));
    let valued = parallel.filter_map(|line| value(line).map(|speedup| (line, speedup)));
    let best = valued.max_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or("not run".to_owned(), |(line, speedup)| {
        let count = line.processors.map_or(String::new(), |count| format!(", P = {count}"));
        format!("<b>{speedup:.2}</b> {}{count}", attribute(&line.scheme))
    })
}
