//! A load over time.

use super::chart::Figure;
use super::packed_numbers::round_numbers;
use serde_json::{Value, json};

/// One load over time, thinned, in the report unit: smallest, mean and largest sample of each span of time.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct LoadTrace {
    /// Name.
    pub name: String,
    /// Report unit; empty for a load set.
    pub unit: String,
    /// First and last time of each span, s.
    pub times: Vec<[f64; 2]>,
    /// Half width of the 95 % interval of a sample.
    pub half: f64,
    /// Smallest, mean and largest value of each span. NaN if nothing was measured.
    pub spans: Vec<[f64; 3]>,
}

/// Draws histories of loads, shown one at a time. Each span of time has a band from smallest to largest sample, the 95 % interval around it, and the
/// mean.
pub fn history(traces: &[LoadTrace]) -> Figure {
    let ends = traces
        .first()
        .and_then(|t| Some([t.times.first()?[0], t.times.last()?[1]]));
    let ends = ends.unwrap_or([0.0, 1.0]);
    Figure {
        label: "histories of loads".into(),
        caption: "Dark: smallest to largest sample of a span of time. Light: the 95 % interval of a sample around it; a narrower light band is better.".into(),
        choices: traces.iter().map(|t| (t.name.clone(), bands(t))).collect(),
        layout: json!({
            "xaxis": { "title": { "text": "time, s" }, "range": round_numbers(ends) },
            "yaxis": {},
        }),
        height: 380,
        on_paper: 12,
    }
}

fn bands(trace: &LoadTrace) -> Vec<Value> {
    let time = round_numbers(trace.times.iter().map(|[from, to]| (from + to) / 2.0));
    let half = if trace.half.is_finite() {
        trace.half
    } else {
        0.0
    };
    let line = |name: &str, of: &dyn Fn(&[f64; 3]) -> f64, fill: Value| {
        let mut trace = json!({
            "type": "scatter", "mode": "lines", "name": name, "x": time,
            "y": round_numbers(trace.spans.iter().map(of)),
            "line": { "width": 0 }, "showlegend": false, "hoverinfo": "skip",
        });
        if let (Some(t), Some(more)) = (trace.as_object_mut(), fill.as_object()) {
            t.extend(more.clone());
        }
        trace
    };
    let band = |colour: &str| json!({ "fill": "tonexty", "fillcolor": colour, "showlegend": true });
    let unit = &trace.unit;
    let shown = |width: f64, colour: &str| {
        json!({
            "line": { "width": width, "color": colour }, "showlegend": true, "hoverinfo": "all",
            "hovertemplate": format!("%{{y:.5}} {unit}"),
        })
    };
    let axis = match unit.as_str() {
        "" => "times the set",
        unit => unit,
    };
    vec![
        line(
            "below",
            &|s| s[0] - half,
            json!({ "ytitle": format!("{}, {axis}", trace.name) }),
        ),
        line(
            &format!(
                "95 % interval of a sample: ± {} {unit}",
                crate::report::page::number(half)
            ),
            &|s| s[2] + half,
            band("rgba(93,143,184,.30)"),
        ),
        line(
            "smallest",
            &|s| s[0],
            json!({ "hoverinfo": "all", "hovertemplate": format!("%{{y:.5}} {unit}") }),
        ),
        line(
            "smallest to largest of a span",
            &|s| s[2],
            band("rgba(31,97,141,.65)"),
        ),
        line(
            &format!("mean of {}, {unit}", trace.name),
            &|s| s[1],
            shown(1.2, "#1c2530"),
        ),
    ]
}
