//! How evenly the work is spread.

use super::curves::{against_processors, curves, fit};
use super::words::{Legend, count, number};
use super::{Axis, Entry, Figure, Material, Panel, Scale};

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let says = "Imbalance of the busiest processor over the mean";
    let how = "How much longer the busiest processor worked than the mean of all; 0 is even.";
    share_figure(material, "load_imbalance", ("balance", "Load balance"), ("imbalance", says), how)
}

/// A figure of a share in percent that is better low, against processors.
pub(crate) fn share_figure(
    material: &Material<'_>,
    metric: &str,
    (kind, title): (&str, &str),
    (axis, says_of): (&str, &str),
    how: &str,
) -> Vec<Figure> {
    let legend = Legend::new(&material.groups);
    let y = Axis { name: axis.into(), unit: "%".into(), scale: Scale::Even, low: 0.0, high: 1.0 };
    let mut panels = against_processors(material, &legend, metric, 1.0, &y);
    fit(&mut panels, true);
    vec![Figure {
        kind: kind.into(),
        title: title.into(),
        says: says(&panels, &legend.entries, says_of),
        how: how.into(),
        legend: legend.entries,
        panels,
    }]
}

/// The least and the most, where the most processors ran.
fn says(panels: &[Panel], legend: &[Entry], what: &str) -> String {
    let ends = panels.iter().flat_map(|panel| {
        let last = curves(panel).filter(|(entry, _)| legend[*entry].label != "serial");
        last.filter_map(move |(entry, points)| points.last().map(|point| (panel, entry, point)))
    });
    let ends: Vec<_> = ends.collect();
    let most =
        ends.iter().filter_map(|(.., point): &(&Panel, usize, &super::Point)| point.x).fold(1.0, f64::max);
    let ends: Vec<_> = ends.into_iter().filter(|(.., point)| point.x == Some(most)).collect();
    let least = ends.iter().min_by(|a, b| a.2.y.total_cmp(&b.2.y));
    let worst = ends.iter().max_by(|a, b| a.2.y.total_cmp(&b.2.y));
    let (Some(least), Some(worst)) = (least, worst) else { return String::new() };
    let tell = |end: &(&Panel, usize, &super::Point)| {
        let place = if panels.len() == 1 { String::new() } else { format!(" ({})", end.0.heading) };
        format!("{} % with {}{place}", number(end.2.y), legend[end.1].label)
    };
    format!("{what}, at P = {}: from {} to {}.", count(Some(most)), tell(least), tell(worst))
}
