//! Figures as Vega-Lite specifications, for those who want them otherwise. The points are in them, for they are
//! medians of rows; the rows themselves lie beside in `rows.csv`.

use super::figure::{Axis, Body, Figure, Panel, Plot, Scale, Style};
use super::marker::COLOURS;
use serde_json::{Value, json};

/// The specification, or none of what Vega-Lite has no marks for.
pub(crate) fn specification(title: &str, figure: &Figure) -> Option<String> {
    let (values, layers) = match &figure.panels.first()?.body {
        Body::Plot(plot) => (points(figure), plot_layers(plot)),
        Body::Field(field) => {
            let lines = (&*field.lines.0, &*field.lines.1);
            (cells(figure), field_layers((&field.columns.0, &field.columns.1), lines))
        }
        Body::Bars(_) => return None,
    };
    let used =
        |entry: &&super::figure::Entry| values.iter().any(|value| value["curve"] == entry.label.as_str());
    let entries: Vec<_> = figure.legend.iter().filter(used).collect();
    let labels: Vec<&str> = entries.iter().map(|entry| entry.label.as_str()).collect();
    let colours: Vec<&str> = entries.iter().map(|entry| COLOURS[entry.look.colour][0]).collect();
    let shapes: Vec<&str> = entries.iter().map(|entry| entry.look.vega_shape()).collect();
    let specification = json!({
        "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
        "title": { "text": title, "subtitle": figure.title },
        "description": figure.says,
        "data": { "values": values },
        "facet": { "field": "panel", "type": "nominal", "title": null, "sort": null },
        "columns": 3,
        "spec": {
            "width": 300,
            "height": 200,
            "encoding": {
                "color": {
                    "field": "curve", "type": "nominal", "title": null, "sort": null,
                    "scale": { "domain": labels, "range": colours },
                },
                "shape": {
                    "field": "curve", "type": "nominal", "title": null, "sort": null,
                    "scale": { "domain": labels, "range": shapes },
                },
            },
            "layer": layers,
        },
        "resolve": { "scale": { "y": "independent", "x": "independent" } },
    });
    // A line a value: the file is read and compared by people too.
    let text = serde_json::to_string(&specification).expect("numbers are finite and keys are strings");
    Some(text.replace("},{\"", "},\n{\"") + "\n")
}

fn points(figure: &Figure) -> Vec<Value> {
    let mut values = Vec::new();
    for panel in &figure.panels {
        let Body::Plot(plot) = &panel.body else { continue };
        for series in &plot.series {
            let Some(entry) = series.entry else { continue };
            for (step, point) in series.points.iter().enumerate() {
                let Some(x) = point.x.map(|x| place(&plot.x, x)) else { continue };
                let mut value = json!({
                    "panel": panel.heading, "curve": figure.legend[entry].label, "x": x, "y": point.y,
                });
                // What most points have not is left out: there are many points.
                if series.style == Style::Joined {
                    value["step"] = json!(step);
                }
                if series.style == Style::Paper {
                    value["paper"] = json!(true);
                }
                if point.high > point.low {
                    (value["low"], value["high"]) = (json!(point.low), json!(point.high));
                }
                if !point.note.is_empty() {
                    value["note"] = json!(point.note);
                }
                values.push(value);
            }
        }
    }
    values
}

/// A number on an axis, or the name of the place.
fn place(axis: &Axis, value: f64) -> Value {
    match &axis.scale {
        Scale::Names(names) => json!(names.get(value.round() as usize)),
        _ => json!(value),
    }
}

fn plot_layers(plot: &Plot) -> Vec<Value> {
    let scale = |axis: &Axis| match axis.scale {
        Scale::Names(_) => ("ordinal", json!({})),
        Scale::Even => ("quantitative", json!({ "zero": false })),
        Scale::Doubling => ("quantitative", json!({ "type": "log", "base": 2 })),
    };
    let (kind, x_scale) = scale(&plot.x);
    let x = json!({ "field": "x", "type": kind, "title": plot.x.name, "scale": x_scale, "sort": null });
    let title = if plot.y.unit.is_empty() {
        plot.y.name.clone()
    } else {
        format!("{}, {}", plot.y.name, plot.y.unit)
    };
    let mut y = json!({ "field": "y", "type": "quantitative", "title": title });
    if plot.y.scale == Scale::Doubling {
        y["scale"] = scale(&plot.y).1;
    }
    let ours = json!([{ "filter": "!datum.paper" }]);
    let mut layers = vec![
        json!({
            "transform": [{ "filter": "isValid(datum.low)" }], "mark": "rule",
            "encoding": { "x": x, "y": { "field": "low", "type": "quantitative" }, "y2": { "field": "high" } },
        }),
        json!({ "transform": ours, "mark": { "type": "point", "filled": true }, "encoding": { "x": x, "y": y } }),
        json!({
            "transform": [{ "filter": "datum.paper" }], "mark": { "type": "point", "size": 60 },
            "encoding": { "x": x, "y": y },
        }),
    ];
    if plot.series.iter().any(|series| series.style == Style::Curve) {
        layers.insert(0, json!({ "transform": ours, "mark": "line", "encoding": { "x": x, "y": y } }));
    }
    if plot.series.iter().any(|series| series.style == Style::Joined) {
        let order = json!({ "field": "step", "type": "quantitative" });
        let joined = json!([{ "filter": "isValid(datum.step)" }]);
        let line = json!({ "x": x, "y": y, "order": order });
        layers.insert(0, json!({ "transform": joined, "mark": "line", "encoding": line }));
    }
    layers
}

fn cells(figure: &Figure) -> Vec<Value> {
    let of = |panel: &Panel| {
        let Body::Field(field) = &panel.body else { return Vec::new() };
        let value = |cell: &super::figure::Cell| {
            json!({
                "panel": panel.heading, "curve": figure.legend[cell.entry].label,
                "x": field.columns.1[cell.column], "y": field.lines.1[cell.line], "margin": cell.text,
                "note": cell.note,
            })
        };
        field.cells.iter().map(value).collect()
    };
    figure.panels.iter().flat_map(of).collect()
}

fn field_layers(columns: (&str, &[String]), lines: (&str, &[String])) -> Vec<Value> {
    let x = json!({ "field": "x", "type": "ordinal", "title": columns.0, "sort": columns.1 });
    let y = json!({ "field": "y", "type": "ordinal", "title": lines.0, "sort": lines.1 });
    let text = json!({
        "mark": "text",
        "encoding": {
            "x": x, "y": y, "text": { "field": "margin", "type": "nominal" }, "color": { "value": "black" },
        },
    });
    vec![json!({ "mark": { "type": "rect", "opacity": 0.4 }, "encoding": { "x": x, "y": y } }), text]
}
