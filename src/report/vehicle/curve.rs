//! Curves of a report.

use crate::report::figure::{Line, Scale, lines};
use crate::report::page::Block;
use serde_json::json;

/// A recovered and a measured signal over one axis. `measured` is empty if the signal was not measured.
pub struct Curve {
    /// Load or link name.
    pub name: String,
    /// Time (s), frequency (Hz) or stretch (job length).
    pub x: Vec<f64>,
    /// Recovered.
    pub recovered: Vec<f64>,
    /// Measured.
    pub measured: Vec<f64>,
}

/// Draws curves one at a time, with the measured curve below the recovered curve. `band` is a shaded and named range of the x axis.
pub(super) fn plots(
    curves: &[Curve],
    [x_label, y_label]: [&str; 2],
    scale: Scale,
    caption: &str,
    band: Option<([f64; 2], String)>,
) -> Block {
    let groups: Vec<(String, Vec<Line>)> = curves
        .iter()
        .map(|c| {
            let line = |name, y| Line { name, x: &c.x, y };
            let mut list = vec![line("recovered", &c.recovered)];
            if !c.measured.is_empty() {
                list.insert(0, line("measured", &c.measured));
            }
            (c.name.clone(), list)
        })
        .collect();
    if groups.is_empty() {
        return Block::Note("None.".into());
    }
    let mut figure = lines(&groups, x_label, y_label, scale, caption);
    if let Some((ends, name)) = band {
        figure.layout["band"] = json!({ "ends": ends, "name": name });
    }
    Block::Figure(figure)
}
