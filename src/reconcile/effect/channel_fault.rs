//! Common base of all channel faults: their gauges and the name of their place. A fault itself defines only its change of a reading.

use super::{Amplitudes, Extension, FaultKind, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{Part, StrainFrame, StrainState};

/// Where a reading is taken: the run, the gauges of the fault (indices into the row), and which part of the fault applies.
#[derive(Clone, Copy)]
pub struct FaultScope<'a> {
    /// The problem.
    pub frame: &'a StrainFrame,
    /// Run.
    pub run: usize,
    /// Gauges of the fault.
    pub gauges: &'a [usize],
    /// Part of the fault that applies: the whole fault with offsets and limits, or only its linear part.
    pub part: Part,
}

/// Effect of a fault on the channels of its gauges.
pub trait ChannelFault: Send + Sync {
    /// Returns the effect id without the place.
    fn id(&self) -> &'static str;
    /// Returns the stage that the fault changes: the reading by default, the structure for a fault of the gauge itself (angle, place).
    fn stage(&self) -> Stage {
        Stage::Reading
    }
    /// Returns the parameters common to all runs.
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    /// Turns strain at all gauges of a run (`row`) into readings.
    fn read(&self, _at: FaultScope<'_>, _parameters: &[f64], _row: &mut [f64]) {}
    /// Returns the change of the influence row of a gauge, for faults of the gauge itself.
    fn influence_change(
        &self,
        _frame: &StrainFrame,
        _gauge: usize,
        _parameters: &[f64],
    ) -> Vec<f64> {
        Vec::new()
    }
    /// Returns the amplitudes that differ from run to run.
    fn amplitudes(&self, _frame: &StrainFrame, _gauges: &[usize]) -> Option<Amplitudes> {
        None
    }
    /// Returns the runs that the fault changes; empty unless it is limited to some runs.
    fn runs(&self) -> Vec<usize> {
        Vec::new()
    }
    /// Returns the kind of fault, which determines whether another fault may be at the same gauge.
    fn kind(&self) -> FaultKind {
        FaultKind::Whole
    }
    /// Returns the extension that corrects the fault in new data; `names` are the channels of the gauges.
    fn extension(&self, names: &[String], parameters: &[f64]) -> Extension;
    /// Returns an instruction that separates the fault from another explanation; `place` names the gauges.
    fn separate_by(&self, place: &str) -> String;
}

/// A fault on its gauges.
#[derive(Clone, Debug)]
pub struct OnGauges<F> {
    /// Gauges, ascending.
    pub gauges: Vec<usize>,
    /// Channels of the gauges.
    pub names: Vec<String>,
    /// `G04`, `G04+G07`, `G04-G07`.
    pub place: String,
    /// Fault of the gauges.
    pub fault: F,
}

impl<F> OnGauges<F> {
    /// Returns `fault` on `gauges`; `place` makes the name of the place from their channel names.
    pub fn new(
        frame: &StrainFrame,
        gauges: Vec<usize>,
        fault: F,
        place: impl Fn(&[String]) -> String,
    ) -> Self {
        let name = |g: &usize| {
            frame
                .gauges
                .get(*g)
                .map(|f| f.name.clone())
                .unwrap_or_default()
        };
        let names: Vec<String> = gauges.iter().map(name).collect();
        Self {
            place: place(&names),
            gauges,
            names,
            fault,
        }
    }

    /// Returns `fault` on one gauge.
    pub fn with_gauge(frame: &StrainFrame, gauge: usize, fault: F) -> Self {
        Self::new(frame, vec![gauge], fault, |names| names.join("+"))
    }
}

impl<F: ChannelFault> StrainEffect for OnGauges<F> {
    fn id(&self) -> &str {
        self.fault.id()
    }
    fn place(&self) -> Option<String> {
        Some(self.place.clone())
    }
    fn stage(&self) -> Stage {
        self.fault.stage()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.fault.parameters()
    }
    fn alter(&self, frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let n_c = state.shape[2];
        for &g in &self.gauges {
            let change = self.fault.influence_change(frame, g, parameters);
            if let Some(row) = state.influence.get_mut(g * n_c..(g + 1) * n_c) {
                row.iter_mut().zip(change).for_each(|(cell, d)| *cell += d);
            }
        }
    }
    fn read(
        &self,
        frame: &StrainFrame,
        parameters: &[f64],
        run: usize,
        row: &mut [f64],
        part: Part,
    ) {
        let at = FaultScope {
            frame,
            run,
            gauges: &self.gauges,
            part,
        };
        self.fault.read(at, parameters, row);
    }
    fn amplitudes(&self, frame: &StrainFrame) -> Option<Amplitudes> {
        self.fault.amplitudes(frame, &self.gauges)
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        self.fault.extension(&self.names, parameters)
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        self.fault.separate_by(&self.place)
    }
    fn gauges(&self) -> Vec<usize> {
        self.gauges.clone()
    }
    fn runs(&self) -> Vec<usize> {
        self.fault.runs()
    }
    fn kind(&self) -> FaultKind {
        self.fault.kind()
    }
}

/// Returns `fault` on each gauge separately.
pub fn on_every_gauge<F: Clone>(frame: &StrainFrame, fault: &F) -> Vec<OnGauges<F>> {
    (0..frame.n_gauges())
        .map(|g| OnGauges::with_gauge(frame, g, fault.clone()))
        .collect()
}
