//! Tables of numbers that are not set against processors, for reading and for the page. What a job tells of its cells
//! beside the speedups is one of them: a file with a function, and its line in [`LISTINGS`].

use super::animation;
use super::text::{blocks, wrap};
use crate::record::{Host, Row};

/// What makes listings of rows; each gives as many as the rows have to tell.
type Make = fn(&[Row]) -> Vec<Listing>;
const LISTINGS: &[Make] = &[animation::listings];

/// The listings of a run.
pub(crate) fn listings(rows: &[Row]) -> Vec<Listing> {
    LISTINGS.iter().flat_map(|listings| listings(rows)).collect()
}

/// A table, column by column.
#[derive(Clone, Debug)]
pub(crate) struct Listing {
    pub(crate) title: String,
    /// Each with its heading; all have as many cells.
    pub(crate) columns: Vec<Column>,
    /// So many of the columns tell what was asked; lines that share those stand together.
    pub(crate) asked: usize,
    /// What it was made on, and other notes, a sentence each.
    pub(crate) notes: Vec<String>,
}

/// A column of a listing.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub(crate) heading: String,
    pub(crate) cells: Vec<String>,
    /// Whether its cells are words and not numbers.
    pub(crate) is_words: bool,
}

impl Listing {
    /// How many lines it has.
    pub(crate) fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.cells.len())
    }

    /// Tells on which computer the lines of `threads` were made.
    pub(crate) fn made_on(&mut self, host: &Host) {
        self.notes.push(format!("threads: {}", host.line()));
    }

    /// As a table for reading: what was asked is told once, above the lines that share it, and so is what all of those
    /// have alike.
    pub(crate) fn text(&self) -> String {
        let (asked, told) = self.columns.split_at(self.asked.min(self.columns.len()));
        let mut parts: Vec<(Vec<&str>, Vec<usize>)> = Vec::new();
        for line in 0..self.len() {
            let key: Vec<&str> = asked.iter().map(|column| &*column.cells[line]).collect();
            match parts.iter_mut().find(|(known, _)| *known == key) {
                Some((_, lines)) => lines.push(line),
                None => parts.push((key, vec![line])),
            }
        }
        let part = |(key, lines): &(Vec<&str>, Vec<usize>)| {
            let is_alike = |column: &&Column| {
                lines.len() > 1 && lines.iter().all(|line| column.cells[*line] == column.cells[lines[0]])
            };
            let (alike, told): (Vec<&Column>, Vec<&Column>) = told.iter().partition(is_alike);
            let alike = alike.into_iter().map(|column| (column, &*column.cells[lines[0]]));
            let pairs = asked.iter().zip(key.iter().copied()).chain(alike);
            let pairs = pairs.filter(|(_, cell)| *cell != "-");
            let pairs = pairs.map(|(column, cell)| match column.heading.split_once(", ") {
                Some((name, unit)) => format!("{name} {cell} {unit}"),
                None => format!("{} {cell}", column.heading),
            });
            let title = format!("{}: {}", self.title, pairs.collect::<Vec<_>>().join(", "));
            let column = |column: &&Column| {
                let cells = lines.iter().map(|line| column.cells[*line].clone());
                std::iter::once(column.heading.clone()).chain(cells).collect::<Vec<_>>()
            };
            wrap(&title, 2) + &blocks(&told.iter().map(column).collect::<Vec<_>>()).join("\n")
        };
        let notes: String = self.notes.iter().map(|note| wrap(note, 2)).collect();
        parts.iter().map(part).collect::<Vec<_>>().join("\n") + &notes
    }
}
