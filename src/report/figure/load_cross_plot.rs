//! Recovered against recorded loads.

use super::chart::Figure;
use super::packed_numbers::round_numbers;
use serde_json::json;

/// A load of a cross plot: (recorded, recovered) of each point.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossPlot<'a> {
    /// Load.
    pub name: &'a str,
    /// Unit of both axes.
    pub unit: &'a str,
    /// Points.
    pub points: &'a [[f64; 2]],
}

/// Draws recovered values (vertical) against recorded values (horizontal) of one load at a time. The line of equality spans both axes, which have
/// equal ranges.
pub fn cross_plot(loads: &[CrossPlot]) -> Figure {
    let picture = |load: &CrossPlot| {
        let all = load.points.iter().flatten();
        let ends = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
            [low.min(*v), high.max(*v)]
        });
        let [x, y] = [0, 1].map(|c| round_numbers(load.points.iter().map(|p| p[c])));
        let titles = ["recorded", "recovered"].map(|word| format!("{word}, {}", load.unit));
        vec![
            json!({
                "type": "scatter", "mode": "lines", "name": "equal", "x": round_numbers(ends), "y": round_numbers(ends),
                "xtitle": titles[0], "ytitle": titles[1],
                "line": { "color": "#9aa7b5", "width": 1 }, "hoverinfo": "skip",
            }),
            json!({
                "type": "scatter", "mode": "markers", "name": load.name, "x": x, "y": y,
                "marker": { "size": 4, "opacity": 0.6, "color": "#1f618d" },
                "hovertemplate": "recorded %{x:.4}, recovered %{y:.4}<extra></extra>",
            }),
        ]
    };
    let choices = loads.iter().filter(|l| !l.points.is_empty());
    Figure {
        label: "recovered against recorded loads".into(),
        caption: "Each point is a recorded load and the load recovered at the same time. Points nearer to the grey line of equality are better.".into(),
        choices: choices.map(|l| (l.name.to_owned(), picture(l))).collect(),
        layout: json!({ "equal": true }),
        height: 460,
        on_paper: loads.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_axes_span_the_same_values() {
        let load = CrossPlot {
            name: "A",
            unit: "kN",
            points: &[[1.0, 3.0], [-2.0, 2.5]],
        };
        let figure = cross_plot(&[load]);
        let equal = &figure.choices[0].1[0];
        assert_eq!(equal["x"], equal["y"]);
        assert_eq!(equal["x"], json!([-2.0, 3.0]));
        assert_eq!(equal["xtitle"], "recorded, kN");
    }
}
