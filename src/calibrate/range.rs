//! Range of the runs of a calibration.

use super::types::{CalibratedRange, Task};
use super::unknown_directions::known_of;

impl CalibratedRange {
    /// Returns the range of the runs with these numbers, with strain minus the zero of each gauge. A run without a known value of a load does not
    /// count for the range of this load.
    pub(super) fn from_runs(task: &Task, used: &[usize], zero: &[f64]) -> Self {
        let over = |value: &dyn Fn(usize) -> Option<f64>| {
            let values = used.iter().filter_map(|r| value(*r));
            let values = values.filter(|v| v.is_finite());
            values.fold([f64::NAN; 2], |[low, high], v| [low.min(v), high.max(v)])
        };
        Self {
            loads: (0..task.loads.len())
                .map(|l| over(&|r| known_of(task, r, &[(l, 1.0)])))
                .collect(),
            strain: (0..task.gauges.len())
                .map(|g| over(&|r| Some(task.runs.get(r)?.strain.get(g)? - zero.get(g)?)))
                .collect(),
        }
    }

    /// Returns the largest size of load `l`; 0 if no run has it.
    pub fn largest_load(&self, l: usize) -> f64 {
        let [low, high] = self.loads.get(l).copied().unwrap_or([0.0; 2]);
        low.abs().max(high.abs())
    }
}
