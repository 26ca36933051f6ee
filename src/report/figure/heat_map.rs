//! A matrix as colours.

use super::chart::Figure;
use super::packed::short;
use serde_json::{Value, json};

/// Rows and columns coloured by their share of the largest in their column: blue negative, red positive; the value itself on pointing.
pub fn heat_map(
    rows: &[String],
    columns: &[String],
    unit: &str,
    value: impl Fn(usize, usize) -> f64,
) -> Figure {
    let largest: Vec<f64> = (0..columns.len())
        .map(|c| {
            (0..rows.len())
                .map(|r| value(r, c).abs())
                .fold(0.0, f64::max)
        })
        .collect();
    let share = |r: usize, c: usize| {
        if largest[c] > 0.0 {
            value(r, c) / largest[c]
        } else {
            0.0
        }
    };
    let table = |of: &dyn Fn(usize, usize) -> Value| -> Vec<Vec<Value>> {
        (0..rows.len())
            .map(|r| (0..columns.len()).map(|c| of(r, c)).collect())
            .collect()
    };
    let trace = json!({
        "type": "heatmap",
        "x": columns,
        "y": rows,
        "z": table(&|r, c| short((share(r, c) * 1e4).round() / 1e4)),
        "customdata": table(&|r, c| short(value(r, c))),
        "hovertemplate": format!("%{{y}}, %{{x}}<br>%{{customdata:.4~g}} {unit}<extra></extra>"),
        "zmin": -1, "zmax": 1, "xgap": 1, "ygap": 1,
        "colorscale": [[0, "#1f4e8c"], [0.25, "#86b1d8"], [0.5, "#f6f7f8"], [0.75, "#ee9d72"], [1, "#b2182b"]],
        "colorbar": { "title": { "text": "share of largest", "side": "right" }, "thickness": 12, "len": 1 },
    });
    Figure {
        label: "sensitivity as a heat map".into(),
        choices: vec![(String::new(), vec![trace])],
        layout: json!({
            "xaxis": { "type": "category", "side": "top", "tickangle": -40, "automargin": true, "fixedrange": true },
            "yaxis": { "type": "category", "autorange": "reversed", "automargin": true, "fixedrange": true, "dtick": 1 },
        }),
        height: 130 + 18 * rows.len(),
        on_paper: 1,
    }
}
