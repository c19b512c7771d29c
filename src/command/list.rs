//! `apportion list`.

use super::print;
use anyhow::Result;
use apportion::measure::{Known, Shelf};
use apportion::report::wrap;
use std::collections::BTreeMap;
use std::path::Path;

/// Where a user's experiments lie, from where the program is started.
pub(crate) const EXPERIMENTS: &str = "experiments";
/// The heading of experiments that reproduce nothing; it comes last.
const OWN: &str = "Questions of our own";

/// Prints the experiments by the study they reproduce, with the figure. A file that is off gets a line that says so,
/// so that one bad file does not hide the others; the run then fails.
pub(crate) fn list() -> Result<()> {
    let (shelf, known) = (Shelf::open(Path::new(EXPERIMENTS))?, Known::here());
    let width = shelf.names().map(str::len).max().unwrap_or(0);
    let mut first_error = None;
    let mut studies: BTreeMap<(bool, String), Vec<String>> = BTreeMap::new();
    for name in shelf.names() {
        let (study, what) = match shelf.load(name, &known) {
            Ok(experiment) if experiment.reproduces.is_empty() => (OWN.to_owned(), experiment.title),
            Ok(experiment) => {
                let (study, figure) = study(&experiment.reproduces);
                let what = match figure {
                    "" => experiment.title,
                    figure => format!("{} ({figure})", experiment.title),
                };
                (study.to_owned(), what)
            }
            Err(error) => {
                first_error = first_error.or(Some(error));
                (OWN.to_owned(), "cannot be read".to_owned())
            }
        };
        let line = wrap(&format!("  {name:width$}  {what}"), width + 4);
        studies.entry((study == OWN, study)).or_default().push(line);
    }
    let text = studies.into_iter().map(|((_, study), lines)| format!("{study}\n{}", lines.concat()));
    print::line(&text.collect::<Vec<_>>().join("\n"))?;
    first_error.map_or(Ok(()), |error| Err(error.into()))
}

/// The study, and the figure or section in it: `Paper II, Fig. 1a` is `Paper II` and `Fig. 1a`.
fn study(reproduces: &str) -> (&str, &str) {
    let ends = [", ", " sec.", " Fig.", " ch.", " Table "].into_iter().filter_map(|end| reproduces.find(end));
    let (study, figure) = reproduces.split_at(ends.min().unwrap_or(reproduces.len()));
    (study, figure.trim_start_matches([',', ' ']))
}

#[cfg(test)]
mod tests {
    use super::study;

    #[test]
    fn a_study_is_what_stands_before_the_figure() {
        assert_eq!(study("Paper II, Fig. 1a and 1e"), ("Paper II", "Fig. 1a and 1e"));
        assert_eq!(study("Paper II sec. 3.3"), ("Paper II", "sec. 3.3"));
        assert_eq!(study("Parker 1999"), ("Parker 1999", ""));
    }
}
