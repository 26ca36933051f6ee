//! Curves of a report.

use crate::report::figure::{Line, Scale, lines};
use crate::report::page::Block;

/// A signal recovered and measured over one axis; `measured` is empty where it was not measured.
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

/// Curves one at a time, what was measured below what was recovered.
pub(super) fn plots(curves: &[Curve], x_label: &str, y_label: &str, scale: Scale) -> Block {
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
    Block::Figure(lines(&groups, x_label, y_label, scale))
}
