//! Speedup against processors, as SVG.

use super::ReportError;
use super::group::{Curve, Group, groups};
use super::marker::Look;
use super::text::label;
use crate::record::{PaperFigure, Row, settings_pairs};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::fmt::Display;

/// The plot without its legend, pixels.
const PLOT: (u32, u32) = (760, 560);
/// Room above the plot for the title, pixels.
const TITLE: u32 = 64;
/// From one line of the legend to the next, pixels.
const LEGEND_LINE: i32 = 26;
/// Up to so many processors the axis counts evenly, beyond in powers of two.
const EVEN: u32 = 32;
const GREY: RGBColor = RGBColor(110, 110, 110);

/// A chart: one machine, one scene.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What to call the file: `speedup-e4000-factory-large.svg`.
    pub file_name: String,
    /// The drawing.
    pub svg: String,
}

/// Draws the speedups of a run beside the paper's figures: a chart for each machine, scene and choice of common settings.
///
/// # Errors
/// The drawing library refused.
pub fn speedup_charts(title: &str, rows: &[Row], figures: &[PaperFigure]) -> Result<Vec<Chart>, ReportError> {
    let groups = groups(rows, "speedup");
    let mut schemes: Vec<&str> = Vec::new();
    for curve in groups.iter().flat_map(|group| &group.curves) {
        if !schemes.contains(&curve.scheme.as_str()) {
            schemes.push(&curve.scheme);
        }
    }
    let draw = |group: &Group| {
        let file_name = file_name(group);
        let mut svg = String::new();
        Drawing::new(group, figures, &schemes)
            .draw(title, &mut svg)
            .map_err(|message| ReportError::Draw { chart: file_name.clone(), message })?;
        Ok(Chart { file_name, svg })
    };
    groups.iter().map(draw).collect()
}

/// Machine, scene and settings, with what is awkward in a file's name left out.
fn file_name(group: &Group) -> String {
    let mut name = format!("speedup-{}-{}", group.machine, group.scene);
    for (key, value) in settings_pairs(&group.settings) {
        name.push_str(&format!("-{key}-{value}"));
    }
    name.retain(|letter| letter.is_alphanumeric() || "-_.".contains(letter));
    name + ".svg"
}

/// What a chart shows, worked out before a line is drawn.
struct Drawing<'a> {
    group: &'a Group,
    curves: Vec<(Curve, Look)>,
    /// The paper's figures, each with the look of its curve.
    figures: Vec<(&'a PaperFigure, Look)>,
    most_processors: u32,
    highest: f64,
}

impl<'a> Drawing<'a> {
    fn new(group: &'a Group, figures: &'a [PaperFigure], schemes: &[&str]) -> Self {
        let curves = group.best_curves();
        // A scheme keeps its look from chart to chart, unless its settings are what tells the curves apart.
        let twice = |curve: &Curve| curves.iter().filter(|other| other.scheme == curve.scheme).count() > 1;
        let by_curve = curves.iter().any(twice);
        let look = |number: usize, curve: &Curve| {
            let scheme = schemes.iter().position(|scheme| *scheme == curve.scheme);
            Look::of(if by_curve { number } else { scheme.unwrap_or(number) })
        };
        let curves: Vec<(Curve, Look)> =
            curves.iter().enumerate().map(|(number, curve)| (curve.clone(), look(number, curve))).collect();
        let drawn = |figure: &&PaperFigure| {
            figure.metric == "speedup"
                && figure.machine == group.machine
                && figure.scene.as_ref().is_none_or(|scene| *scene == group.scene)
        };
        let figures = figures.iter().filter(drawn).filter_map(|figure| {
            let fits = |curve: &Curve| {
                let settings = format!("{};{}", group.settings, curve.settings);
                curve.scheme == figure.scheme
                    && settings_pairs(&figure.settings).all(|pair| {
                        pair.0.starts_with(&figure.scheme) || settings_pairs(&settings).any(|own| own == pair)
                    })
            };
            curves.iter().find(|(curve, _)| fits(curve)).map(|(_, look)| (figure, *look))
        });
        let figures: Vec<_> = figures.collect();
        let counts = curves.iter().flat_map(|(curve, _)| curve.points.keys().copied());
        let counts = counts.chain(figures.iter().filter_map(|(figure, _)| figure.processors));
        let values = curves.iter().flat_map(|(curve, _)| curve.points.values().map(|point| point.high));
        let values = values.chain(figures.iter().map(|(figure, _)| figure.value));
        Self {
            most_processors: counts.max().unwrap_or(1),
            highest: values.fold(1.2, f64::max) * 1.1,
            group,
            curves: curves.clone(),
            figures,
        }
    }

    fn draw(&self, title: &str, svg: &mut String) -> Result<(), String> {
        let root =
            SVGBackend::with_string(svg, (PLOT.0 + self.legend_width(), PLOT.1 + TITLE)).into_drawing_area();
        root.fill(&WHITE).map_err(text)?;
        root.draw(&Text::new(title.to_owned(), (20, 14), ("sans-serif", 20).into_font())).map_err(text)?;
        root.draw(&Text::new(self.subtitle(), (20, 40), ("sans-serif", 15).into_font().color(&GREY)))
            .map_err(text)?;
        let (_, below) = root.split_vertically(TITLE);
        let (plot, legend) = below.split_horizontally(PLOT.0);
        self.plot(&plot)?;
        self.legend(&legend)?;
        root.present().map_err(text)
    }

    fn subtitle(&self) -> String {
        let group = self.group;
        let settings = settings_pairs(&group.settings).map(|(key, value)| format!(", {key} = {value}"));
        format!("{} on {}{}", group.scene, group.machine, settings.collect::<String>())
    }

    fn plot(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), String> {
        let even = self.most_processors <= EVEN;
        let x = |processors: f64| if even { processors } else { processors.log2() };
        let step = if even { 1.0 } else { x(2.0) };
        let peaks = self.figures.iter().any(|(figure, _)| figure.processors.is_none());
        let (first, last) = (x(1.0), x(self.most_processors.into()));
        let end = last + if peaks { 1.5 } else { 0.5 } * step;
        let mut chart = ChartBuilder::on(area)
            .margin_left(14)
            .margin_right(16)
            .margin_bottom(10)
            .x_label_area_size(52)
            .y_label_area_size(64)
            .build_cartesian_2d(first - 0.5 * step..end, 0.0..self.highest)
            .map_err(text)?;
        let tick = |&at: &f64| {
            let count = if even { at } else { at.exp2() };
            // Between whole counts, and in the column of the peaks, the axis says nothing.
            if (count - count.round()).abs() > 1e-6 || count < 1.0 || at > last + 0.4 * step {
                return String::new();
            }
            format!("{count:.0}")
        };
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .axis_style(GREY)
            .x_labels((end - first).ceil() as usize + 1)
            .y_labels(10)
            .x_label_formatter(&tick)
            .y_label_formatter(&|value| format!("{value:.1}"))
            .x_desc("processors")
            .y_desc("speedup against serial, x")
            .axis_desc_style(("sans-serif", 17))
            .label_style(("sans-serif", 14))
            .draw()
            .map_err(text)?;
        // In steps, for on a logarithmic axis the ideal is no straight line.
        let most = self.highest.min(self.most_processors.into());
        let ideal = (0..=64).map(|step| 1.0 + (most - 1.0) * f64::from(step) / 64.0).map(|p| (x(p), p));
        chart.draw_series(DashedLineSeries::new(ideal, 6, 5, GREY.stroke_width(1))).map_err(text)?;
        for (curve, look) in &self.curves {
            let points = || curve.points.iter().map(|(&count, point)| (x(count.into()), point));
            let line = points().map(|(at, point)| (at, point.median));
            chart.draw_series(LineSeries::new(line.clone(), look.colour.stroke_width(2))).map_err(text)?;
            let bars = points().filter(|(_, point)| point.high > point.low);
            let bars = bars.map(|(at, point)| {
                PathElement::new(vec![(at, point.low), (at, point.high)], look.colour.stroke_width(1))
            });
            chart.draw_series(bars).map_err(text)?;
            chart.draw_series(line.map(|at| look.marker(at, false))).map_err(text)?;
        }
        let peak_at = last + step;
        for (figure, look) in &self.figures {
            let at = figure.processors.map_or(peak_at, |count| x(count.into()));
            chart.draw_series([look.marker((at, figure.value), true)]).map_err(text)?;
        }
        if peaks {
            let words = Text::new(
                "peak",
                (peak_at - 0.3 * step, self.highest * 0.03),
                ("sans-serif", 14).into_font(),
            );
            chart.draw_series(std::iter::once(words)).map_err(text)?;
        }
        Ok(())
    }

    /// The words beside the plot: a curve a line, then what is dashed and what is hollow.
    fn labels(&self) -> Vec<(String, Option<(Look, bool)>)> {
        let mut labels: Vec<_> =
            self.curves.iter().map(|(curve, look)| (label(curve), Some((*look, false)))).collect();
        labels.push(("ideal".to_owned(), None));
        if let Some((_, look)) = self.figures.first() {
            labels.push(("hollow: the paper's".to_owned(), Some((*look, true))));
        }
        labels
    }

    fn legend_width(&self) -> u32 {
        let letters = self.labels().iter().map(|(words, _)| words.chars().count()).max().unwrap_or(0);
        // Some 8 pixels a letter at this size: without fonts nobody can measure it.
        60 + 8 * letters as u32
    }

    fn legend(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), String> {
        for (line, (words, look)) in self.labels().into_iter().enumerate() {
            let y = 20 + LEGEND_LINE * line as i32;
            match look {
                Some((look, hollow)) => {
                    let stroke = look.colour.stroke_width(if hollow { 0 } else { 2 });
                    area.draw(&PathElement::new(vec![(4, y), (36, y)], stroke)).map_err(text)?;
                    area.draw(&look.marker((20, y), hollow)).map_err(text)?;
                }
                None => {
                    for x in [4, 15, 26] {
                        area.draw(&PathElement::new(vec![(x, y), (x + 6, y)], GREY)).map_err(text)?;
                    }
                }
            }
            area.draw(&Text::new(words, (46, y - 7), ("sans-serif", 15).into_font())).map_err(text)?;
        }
        Ok(())
    }
}

fn text(error: impl Display) -> String {
    error.to_string()
}
