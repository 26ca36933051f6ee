//! A matrix as colours.

use super::chart::Figure;
use super::packed_numbers::round_number;
use serde_json::{Value, json};

/// Draws a table in which each field has the colour of its share of the largest value in its column: blue negative, red positive. The value is shown
/// on pointing.
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
        "z": table(&|r, c| round_number((share(r, c) * 1e4).round() / 1e4)),
        "customdata": table(&|r, c| round_number(value(r, c))),
        "hovertemplate": format!("%{{y}}, %{{x}}<br>%{{customdata:.4}} {unit}<extra></extra>"),
    });
    Figure {
        label: "sensitivity as a heat map".into(),
        caption: "Colour shows the strain of each gauge as a share of the largest in the load's column. Columns with different patterns are better: the gauges cannot separate loads with like columns.".into(),
        choices: vec![(String::new(), vec![trace])],
        layout: json!({
            "xaxis": { "type": "category", "side": "top" },
            "yaxis": { "type": "category" },
        }),
        height: 130 + 18 * rows.len(),
        on_paper: 1,
    }
}
