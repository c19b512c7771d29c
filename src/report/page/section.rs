//! One run: what it asked, the paper's table, its figures, where it was made.

use super::figure;
use super::tables::{choices, doubts, listings, paper};
use crate::record::settings_pairs;
use crate::report::escape::{attribute, link};
use crate::report::figure::Figure;
use crate::report::table::table;
use crate::report::{ReportError, Run};
use std::collections::BTreeSet;
use std::fmt::Write;

/// A run with what is drawn of it.
pub(super) struct Section<'a> {
    /// Its anchor.
    pub(super) id: String,
    pub(super) run: &'a Run,
    pub(super) figures: Vec<Figure>,
}

impl Section<'_> {
    pub(super) fn html(&self) -> Result<String, ReportError> {
        let mut html = format!("<section id=\"{}\" class=\"run\">\n", self.id);
        let _ = writeln!(html, "<h2>{}</h2>", attribute(&self.run.question.title));
        html.push_str(&self.introduction());
        let mut table = table(&self.run.rows, &self.run.question.paper);
        table.made_on(&self.run.meta.host);
        html.push_str(&paper(&table));
        html.push_str(&doubts(&table));
        html.push_str(&choices(&table));
        html.push_str(&listings(&table));
        for figure in &self.figures {
            html.push_str(&figure::html(&self.id, &self.run.link, figure)?);
        }
        html.push_str(&self.origin());
        Ok(html + "</section>\n")
    }

    fn introduction(&self) -> String {
        let run = self.run;
        let mut words = vec![format!("<code>{}</code>", attribute(&run.meta.experiment))];
        if !run.question.reproduces.is_empty() {
            words.push(format!("reproduces {}", attribute(&run.question.reproduces)));
        }
        let scenes: BTreeSet<&str> = run.rows.iter().map(|row| row.scene.as_str()).collect();
        words.push(format!("scene {}", attribute(&scenes.into_iter().collect::<Vec<_>>().join(", "))));
        let all: BTreeSet<&str> = run.rows.iter().map(|row| row.settings.as_str()).collect();
        let first = all.iter().next().copied().unwrap_or_default();
        // Settings every cell has are told once, here.
        let everywhere = settings_pairs(first)
            .filter(|pair| all.iter().all(|other| settings_pairs(other).any(|theirs| theirs == *pair)));
        words.extend(everywhere.map(|(key, value)| format!("{} = {}", attribute(key), attribute(value))));
        if run.meta.end.is_none() {
            words.push("<strong>unfinished: cells are missing</strong>".to_owned());
        }
        format!("<p class=\"about\">{}</p>\n", words.join("; "))
    }

    /// Where the rows are from, and where they are.
    fn origin(&self) -> String {
        let Run { meta, link: folder, .. } = self.run;
        let commit = meta.commit.as_deref().unwrap_or("not known");
        let host = &meta.host;
        let rows = format!("{} rows, run {}", self.run.rows.len(), meta.run);
        let time = format!("{} to {}", meta.start, meta.end.as_deref().unwrap_or("(unfinished)"));
        let terms = [
            ("Computer", host.line()),
            ("Caches", host.caches.join(", ")),
            ("Version", format!("apportion {}, commit {commit}", meta.version)),
            ("Seed", meta.seed.to_string()),
            ("Command", meta.command.join(" ")),
            ("Time", time),
            ("Rows", rows),
        ];
        let mut html =
            String::from("<details class=\"origin\" open><summary>Where this is from</summary><dl>\n");
        for (term, words) in terms.iter().filter(|(_, words)| !words.is_empty()) {
            let _ = writeln!(html, "<dt>{term}<dd>{}", attribute(words));
        }
        html.push_str("<dt>Files<dd>");
        for file in ["rows.csv", "rows.jsonl", "meta.json", "experiment.toml"] {
            let _ = write!(html, "<a href=\"{}\">{file}</a> ", link(&format!("{folder}/{file}")));
        }
        html + "</dl></details>\n"
    }
}
