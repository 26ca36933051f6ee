//! Loads of a payload: its weight, and the moments of the weight about its nominal place.

use super::types::{Component, Job, LoadActs};

/// Names of the payload loads without a model: the weight (downwards), and its moments about x and y.
pub const NAMES: [&str; 3] = ["payload", "payload.MX", "payload.MY"];

/// Coefficients of the weight `W`, of `W dx` and of `W dy` in each of [`NAMES`]: `MX = -W dy`, `MY = W dx`, z upwards.
pub const PARTS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];

/// Returns the coefficients of a load by its name, as in [`PARTS`]; `None` if it is not a payload load. At `[payload] grid`, up is positive.
pub fn part_of(job: &Job, name: &str) -> Option<[f64; 3]> {
    let by_name = || Some(PARTS[NAMES.iter().position(|n| *n == name)?]);
    match job.loads.iter().find(|l| l.name == name).map(|l| l.acts) {
        None | Some(LoadActs::Named) => by_name(),
        Some(LoadActs::Set(_)) => None,
        Some(LoadActs::AtGrid {
            grid,
            component,
            cid,
        }) => {
            if cid != 0 || Some(grid) != job.payload_grid() {
                return None;
            }
            match component {
                Component::FZ => Some(PARTS[0].map(|v| -v)),
                Component::MX => Some(PARTS[1]),
                Component::MY => Some(PARTS[2]),
                _ => None,
            }
        }
    }
}
