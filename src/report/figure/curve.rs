//! Figure of efficiency and load sigmas against the number of gauges.

use super::chart::Figure;
use super::packed_numbers::{round_number, round_numbers};
use serde_json::{Value, json};

/// Results with one number of gauges.
#[derive(Clone, Debug, PartialEq)]
pub struct CountPoint {
    /// Number of gauges.
    pub gauges: usize,
    /// Certified efficiency, 0..1.
    pub efficiency: f64,
    /// Efficiency after the worst loss of a gauge, 0..1.
    pub after_loss: f64,
    /// One standard deviation of each load.
    pub sigma: Vec<f64>,
}

const EFFICIENCY: &str = "efficiency, %";

/// Draws sigma of every load, by its unit, and the efficiency against the number of gauges.
pub fn curve(points: &[CountPoint], loads: &[(String, String)]) -> Figure {
    let counts: Vec<usize> = points.iter().map(|p| p.gauges).collect();
    let mut units: Vec<&str> = loads.iter().map(|l| l.1.as_str()).collect();
    units.sort_unstable();
    units.dedup();
    let line = |name: &str, y: Vec<Value>, shown: &str, axis: &str| {
        json!({
            "type": "scatter", "mode": "lines+markers", "name": name, "x": counts, "y": y, "ytitle": axis,
            "hovertemplate": format!("%{{x}} gauges: {shown}<extra>{name}</extra>"),
        })
    };
    let mut choices: Vec<(String, Vec<Value>)> = units
        .iter()
        .map(|unit| {
            let name = if unit.is_empty() {
                "times the set"
            } else {
                unit
            };
            let axis = format!("sigma of the loads, {name}");
            let of_unit = (0..loads.len()).filter(|l| loads[*l].1 == *unit);
            let traces = of_unit.map(|l| {
                let y = points.iter().map(|p| round_number(p.sigma[l])).collect();
                line(&loads[l].0, y, &format!("%{{y:.4}} {unit}"), &axis)
            });
            let traces = traces.collect();
            (axis, traces)
        })
        .collect();
    let percent =
        |of: &dyn Fn(&CountPoint) -> f64| round_numbers(points.iter().map(|p| 100.0 * of(p)));
    choices.push((
        EFFICIENCY.into(),
        vec![
            line(
                "certified, of the best possible",
                percent(&|p| p.efficiency),
                "%{y:.4} %",
                EFFICIENCY,
            ),
            line(
                "remaining after the worst loss of a gauge",
                percent(&|p| p.after_loss),
                "%{y:.4} %",
                EFFICIENCY,
            ),
        ],
    ));
    Figure {
        label: "efficiency and sigma against the number of gauges".into(),
        caption: "Each line is a load or an efficiency over the number of gauges. A smaller sigma and a larger efficiency are better.".into(),
        choices,
        layout: json!({
            "xaxis": { "title": { "text": "gauges" }, "tickvals": counts },
            "yaxis": { "rangemode": "tozero" },
        }),
        height: 400,
        on_paper: 8,
    }
}
