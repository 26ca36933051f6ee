//! Measured against predicted strain.

use super::chart::Figure;
use super::packed_numbers::{round_number, round_numbers};
use serde_json::{Value, json};

/// Gauges that can be looked at one by one; all of them are in the first picture.
const MOST_CHOICES: usize = 200;
const COLOURS: [&str; 2] = ["#1f618d", "#d35400"];
const SYMBOLS: [&str; 2] = ["circle", "diamond-open"];

/// One gauge: (predicted, measured) of each run or sample, microstrain, in up to two kinds (used and held out).
#[derive(Clone, Debug, PartialEq, Default)]
pub struct GaugePoints {
    /// Name.
    pub name: String,
    /// Residual, microstrain rms.
    pub residual: f64,
    /// Points of each kind.
    pub points: [Vec<(f64, f64)>; 2],
}

/// Draws measured (up) against predicted (right) strain about the line of equality: all gauges, then each gauge, the largest residual first. `kinds`
/// names the two kinds of points, `runs` the points of each kind.
pub fn agreement(gauges: &[GaugePoints], kinds: [&str; 2], runs: [&[String]; 2]) -> Figure {
    let mut order: Vec<&GaugePoints> = gauges.iter().collect();
    order.sort_by(|a, b| b.residual.total_cmp(&a.residual));
    let mut choices = vec![("all gauges".to_owned(), picture(&order, kinds, runs))];
    if order.len() > 1 {
        choices.extend(order.iter().take(MOST_CHOICES).map(|g| {
            let residual = crate::report::page::number(g.residual);
            (
                format!("{}, residual {residual} µε", g.name),
                picture(&[g], kinds, runs),
            )
        }));
    }
    Figure {
        label: "measured against predicted strain".into(),
        caption: "Each point is a gauge in one run or sample. Points nearer to the grey line of equality are better.".into(),
        choices,
        layout: json!({
            "xaxis": { "title": { "text": "predicted, µε" } },
            "yaxis": { "title": { "text": "measured, µε" } },
            "equal": true,
        }),
        height: 460,
        on_paper: 1,
    }
}

fn picture(gauges: &[&GaugePoints], kinds: [&str; 2], runs: [&[String]; 2]) -> Vec<Value> {
    let known = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    let mut out = Vec::new();
    for k in 0..2 {
        let (mut x, mut y, mut text) = (Vec::new(), Vec::new(), Vec::new());
        for g in gauges {
            for (i, p) in g.points[k].iter().enumerate().filter(|(_, p)| known(p)) {
                x.push(round_number(p.0));
                y.push(round_number(p.1));
                let run = runs[k].get(i).map_or("", String::as_str);
                text.push(format!("{} {run}", g.name));
                ends = [ends[0].min(p.0).min(p.1), ends[1].max(p.0).max(p.1)];
            }
        }
        if !x.is_empty() {
            out.push(json!({
                "type": "scatter", "mode": "markers", "name": kinds[k], "x": x, "y": y, "text": text,
                "marker": { "size": 6, "opacity": 0.75, "color": COLOURS[k], "symbol": SYMBOLS[k] },
                "hovertemplate": "%{text}<br>predicted %{x:.4}, measured %{y:.4} µε<extra></extra>",
            }));
        }
    }
    if ends[0] <= ends[1] {
        out.insert(
            0,
            json!({
                "type": "scatter", "mode": "lines", "name": "equal", "x": round_numbers(ends), "y": round_numbers(ends),
                "line": { "color": "#9aa7b5", "width": 1 }, "hoverinfo": "skip",
            }),
        );
    }
    out
}
