//! Values with their intervals.

use super::chart::Figure;
use super::packed::shorts;
use serde_json::{Value, json};

/// A row: name, then low, value, high.
pub type IntervalRow = (String, [f64; 3]);

/// Values with 95 % bars, one group (a run) at a time.
pub fn intervals(groups: &[(String, Vec<IntervalRow>)], unit: &str) -> Figure {
    let most = groups.iter().map(|g| g.1.len()).max().unwrap_or(0);
    let drawn = groups.iter().map(|g| (g.0.clone(), vec![bars(&g.1, unit)]));
    Figure {
        label: format!("values with intervals, {unit}"),
        choices: drawn.collect(),
        layout: json!({
            "xaxis": { "title": { "text": unit }, "tickformat": ".5~g", "nticks": 8, "zeroline": true, "zerolinecolor": "#9aa7b5" },
            "yaxis": { "type": "category", "autorange": "reversed", "automargin": true, "fixedrange": true, "dtick": 1 },
            "showlegend": false,
        }),
        height: 90 + 24 * most,
        on_paper: 4,
    }
}

fn bars(rows: &[IntervalRow], unit: &str) -> Value {
    let names: Vec<&String> = rows.iter().map(|r| &r.0).collect();
    json!({
        "type": "scatter",
        "mode": "markers",
        "x": shorts(rows.iter().map(|r| r.1[1])),
        "y": names,
        "customdata": rows.iter().map(|r| shorts([r.1[0], r.1[2]])).collect::<Vec<_>>(),
        "error_x": {
            "type": "data", "symmetric": false, "thickness": 2, "width": 5,
            "array": shorts(rows.iter().map(|r| r.1[2] - r.1[1])),
            "arrayminus": shorts(rows.iter().map(|r| r.1[1] - r.1[0])),
        },
        "marker": { "size": 9, "color": "#1f618d" },
        "hovertemplate": format!("%{{y}}: %{{x:.5~g}} {unit}<br>%{{customdata[0]:.5~g}} to %{{customdata[1]:.5~g}}<extra></extra>"),
    })
}
