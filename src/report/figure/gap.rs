//! The gap by channel.

use super::chart::Figure;
use super::packed_numbers::round_numbers;
use serde_json::json;

/// Draws the gap of each channel before and after, with its noise floor if known, on the held-out data. The unit of names and numbers is `unit`.
pub fn gap_by_channel(channels: &[(String, [f64; 3])], unit: &str) -> Figure {
    let names: Vec<&String> = channels.iter().map(|c| &c.0).collect();
    let of = |k: usize| round_numbers(channels.iter().map(|c| c.1[k]));
    let bar = |name: &str, k: usize, colour: &str| {
        json!({
            "type": "bar", "name": name, "x": names, "y": of(k), "marker": { "color": colour },
            "hovertemplate": format!("%{{x}}: %{{y:.4}} {unit} {name}<extra></extra>"),
        })
    };
    let floor = json!({
        "type": "scatter", "mode": "markers", "name": "floor", "x": names, "y": of(2),
        "marker": { "symbol": "line-ew-open", "size": 16, "color": "#1c2530" },
        "hovertemplate": format!("%{{x}}: floor %{{y:.4}} {unit}<extra></extra>"),
    });
    let mut traces = vec![bar("before", 0, "#d68910"), bar("after", 1, "#1f618d")];
    let mut caption =
        "Bars show the difference from the measurement before and after the change: shorter is better.".to_owned();
    if channels.iter().any(|c| c.1[2].is_finite()) {
        traces.push(floor);
        caption.push_str(" A bar no longer than its black stroke is noise alone.");
    }
    Figure {
        label: "gap before and after".into(),
        caption,
        choices: vec![(String::new(), traces)],
        layout: json!({
            "xaxis": { "type": "category" },
            "yaxis": { "title": { "text": unit }, "rangemode": "tozero" },
        }),
        height: 380,
        on_paper: 1,
    }
}
