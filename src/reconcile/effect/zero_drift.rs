//! `zero_drift`: a channel's zero has moved since the installation state.

use super::{Extension, Parameter, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{Part, StrainFrame};

/// How the zero moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drift {
    /// By the same amount in all runs.
    Step,
    /// In proportion to the number of the run: it creeps; the size is that of the last run.
    Creep,
}

/// Reading = strain + size (in `Creep` times run number over number of runs).
#[derive(Clone, Debug)]
pub struct ZeroDrift {
    /// Gauge.
    pub gauge: usize,
    /// Its name.
    pub name: String,
    /// How.
    pub drift: Drift,
}

impl ZeroDrift {
    /// Both kinds on every gauge.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        let on = |gauge, drift| Self {
            gauge,
            name: gauge_name(frame, gauge),
            drift,
        };
        (0..frame.n_gauges())
            .flat_map(|g| [on(g, Drift::Step), on(g, Drift::Creep)])
            .collect()
    }
}

impl ZeroDrift {
    fn unit(&self) -> &'static str {
        match self.drift {
            Drift::Step => "microstrain",
            Drift::Creep => "microstrain at the last run",
        }
    }
}

impl StrainEffect for ZeroDrift {
    fn id(&self) -> &'static str {
        "zero_drift"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Reading
    }
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter {
            unit: self.unit(),
            neutral: 0.0,
            prior_sd: 40.0,
            step: 0.5,
            starts: vec![0.0],
            plausible: 1000.0,
        }]
    }
    fn read(
        &self,
        frame: &StrainFrame,
        parameters: &[f64],
        run: usize,
        row: &mut [f64],
        part: Part,
    ) {
        let (Part::Whole, [size, ..]) = (part, parameters) else {
            return;
        };
        let share = match self.drift {
            Drift::Step => 1.0,
            Drift::Creep => (run + 1) as f64 / frame.n_runs().max(1) as f64,
        };
        if let Some(cell) = row.get_mut(self.gauge) {
            *cell += size * share;
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let size = parameters.first().copied().unwrap_or(0.0);
        Extension::Channel {
            id: self.id(),
            gauge: self.name.clone(),
            size,
            unit: self.unit(),
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "read gauge {} in the installation state again (empty, level, reference temperature): a drifted zero stays",
            self.name
        )
    }
    fn gauges(&self) -> Vec<usize> {
        vec![self.gauge]
    }
}
