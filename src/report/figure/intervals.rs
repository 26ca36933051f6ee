//! Values with their intervals.

use super::chart::Figure;
use super::packed_numbers::round_numbers;
use serde_json::{Value, json};

/// Ratio of two values above which one linear axis does not show the smaller one.
pub const MOST_RATIO: f64 = 20.0;

/// A row: name, then low, value, high.
pub type IntervalRow = (String, [f64; 3]);

/// Meaning of the two ends of a row, which are drawn differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// 95 % interval of the value: a thin line with caps.
    Interval,
    /// Smallest and largest value, or zero and the value: a wide bar without caps.
    Span,
}

impl Ends {
    fn words(self) -> &'static str {
        match self {
            Self::Interval => "intervals",
            Self::Span => "ranges",
        }
    }
}

/// Draws values with the ends of their intervals, one group (a run) at a time.
pub fn intervals(
    groups: &[(String, Vec<IntervalRow>)],
    unit: &str,
    ends: Ends,
    caption: &str,
) -> Figure {
    let most = groups.iter().map(|g| g.1.len()).max().unwrap_or(0);
    let drawn = groups
        .iter()
        .map(|g| (g.0.clone(), vec![interval_trace(&g.1, unit, ends)]));
    Figure {
        label: format!("values with {}, {unit}", ends.words()),
        caption: caption.to_owned(),
        choices: drawn.collect(),
        layout: json!({
            "xaxis": { "title": { "text": unit } },
            "yaxis": { "type": "category" },
        }),
        height: 90 + 24 * most,
        on_paper: 4,
    }
}

/// Returns rows as one trace.
pub fn interval_trace(rows: &[IntervalRow], unit: &str, ends: Ends) -> Value {
    let names: Vec<&String> = rows.iter().map(|r| &r.0).collect();
    json!({
        "type": "scatter",
        "mode": "markers",
        "x": round_numbers(rows.iter().map(|r| r.1[1])),
        "y": names,
        "customdata": rows.iter().map(|r| round_numbers([r.1[0], r.1[2]])).collect::<Vec<_>>(),
        "error_x": {
            "array": round_numbers(rows.iter().map(|r| r.1[2] - r.1[1])),
            "arrayminus": round_numbers(rows.iter().map(|r| r.1[1] - r.1[0])),
            "span": ends == Ends::Span,
        },
        "marker": { "size": 9, "color": "#1f618d" },
        "hovertemplate": format!("%{{y}}: %{{x:.5}} {unit}<br>%{{customdata[0]:.5}} to %{{customdata[1]:.5}}<extra></extra>"),
    })
}
