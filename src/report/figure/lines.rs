//! Curves over a common axis.

use super::chart::Figure;
use super::packed_numbers::round_numbers;
use serde_json::{Value, json};

/// Maximum number of points drawn for one curve. Longer curves are thinned evenly.
const MOST_POINTS: usize = 4000;
const COLOURS: [&str; 3] = ["#9aa7b5", "#1f618d", "#c0392b"];

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Line<'a> {
    /// Name.
    pub name: &'a str,
    /// Values along the horizontal axis.
    pub x: &'a [f64],
    /// Values along the vertical axis.
    pub y: &'a [f64],
}

/// Axes of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Both linear.
    Linear,
    /// y by powers of ten.
    LogY,
}

/// Draws groups of curves, shown one group at a time. In a group, the first curve is drawn first, below the others.
pub fn lines(
    groups: &[(String, Vec<Line>)],
    x: &str,
    y: &str,
    scale: Scale,
    caption: &str,
) -> Figure {
    let trace = |i: usize, l: &Line| -> Value {
        let step = l.x.len().div_ceil(MOST_POINTS).max(1);
        let thin = |v: &[f64]| round_numbers(v.iter().step_by(step).copied());
        json!({
            "type": "scatter", "mode": "lines", "name": l.name, "x": thin(l.x), "y": thin(l.y),
            "line": { "width": 1.4, "color": COLOURS[i % COLOURS.len()] },
        })
    };
    let choices = groups.iter().map(|(name, list)| {
        let traces = list.iter().enumerate().map(|(i, l)| trace(i, l));
        (name.clone(), traces.collect())
    });
    let kind = match scale {
        Scale::Linear => "linear",
        Scale::LogY => "log",
    };
    Figure {
        label: format!("{y} over {x}"),
        caption: caption.to_owned(),
        choices: choices.collect(),
        layout: json!({
            "xaxis": { "title": { "text": x } },
            "yaxis": { "title": { "text": y }, "type": kind },
        }),
        height: 380,
        on_paper: 8,
    }
}
