//! What acts along the bars and beams of a load case: PLOAD1 and temperature.

use super::UnitLoad;
use super::element::beam::{Interior, LineLoad};
use super::load_case::LoadCase;
use super::temperature::{Temperatures, beam_expansion};
use crate::model::{Load, Model};
use std::collections::HashMap;

/// Loads along beams, and temperatures, of one case.
#[derive(Debug, Default)]
pub(crate) struct Between<'a> {
    loads: HashMap<usize, Vec<LineLoad>>,
    temperatures: Option<&'a Temperatures>,
}

/// A PLOAD1 without anything else; empty for other loads.
pub(crate) fn alone(load: &Load) -> Interior {
    Interior {
        loads: along(load, 1.0).into_iter().map(|l| l.1).collect(),
        thermal: None,
    }
}

fn along(load: &Load, factor: f64) -> Option<(usize, LineLoad)> {
    let Load::Line {
        beam,
        span,
        force,
        moment,
    } = load
    else {
        return None;
    };
    let line = LineLoad {
        span: *span,
        force: force.map(|f| f * factor),
        moment: moment.map(|m| m * factor),
    };
    Some((beam.us(), line))
}

impl<'a> Between<'a> {
    /// What acts along the beams in a case.
    pub(crate) fn new(
        model: &Model,
        case: &LoadCase,
        temperatures: Option<&'a Temperatures>,
    ) -> Self {
        let mut loads: HashMap<usize, Vec<LineLoad>> = HashMap::new();
        for load in &case.loads {
            let UnitLoad::Set(sid) = load else { continue };
            for set in model.load_sets.iter().filter(|s| s.sid == *sid) {
                for (factor, load) in &set.loads {
                    if let Some((beam, line)) = along(load, *factor) {
                        loads.entry(beam).or_default().push(line);
                    }
                }
            }
        }
        Self {
            loads,
            temperatures,
        }
    }

    /// Returns the loads along beams, by beam.
    pub(crate) fn loads_by_beam(&self) -> HashMap<usize, Vec<LineLoad>> {
        self.loads.clone()
    }

    /// What acts along beam `i`.
    pub(crate) fn of(&self, model: &Model, i: usize) -> Interior {
        Interior {
            loads: self.loads.get(&i).cloned().unwrap_or_default(),
            thermal: self.temperatures.and_then(|t| beam_expansion(model, i, t)),
        }
    }
}
