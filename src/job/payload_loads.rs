//! Loads that are a payload's: its weight, and the moments of that about its nominal place.

use super::types::{Component, Job, LoadActs};

/// Names of the loads where no model stands behind them: the weight, downwards, and its moments about x and y.
pub const NAMES: [&str; 3] = ["payload", "payload.MX", "payload.MY"];

/// How much of the weight `W`, of `W dx` and of `W dy` each of [`NAMES`] is: `MX = -W dy`, `MY = W dx`, z upwards.
pub const PARTS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];

/// What the load of this name is of a payload, as [`PARTS`] says; `None` where it is none of its loads. A load at `[payload] grid` counts upwards.
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
