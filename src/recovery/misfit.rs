//! Misfit of readings and loads for the search for wrong inputs, by stated errors or by the errors of a calibrated S.

use super::calibrated_loads::estimate;
use super::errors::ErrorModel;
use super::run_estimates::solve;
use super::types::{Readings, RunEstimate};
use crate::estimate::{NORMAL_95, student};
use crate::finding::Finding;
use crate::input_faults::{
    AlternativeRows, FaultTreatment, InputFit, Inputs, Misfit, Rules, search_faults,
};
use crate::linalg::Matrix;
use crate::sensitivity::{Sensitivity, Uncertainty};
use rayon::prelude::*;

/// Function that returns the rows of S for gauges that are installed otherwise. It is called if the loads do not explain the readings.
pub type Alternatives<'a> = dyn FnMut() -> Vec<AlternativeRows> + 'a;

/// Largest number of runs to try, spread over all: more runs add no information on a gauge.
const TRIED: usize = 200;
/// Largest number of runs to try with a calibrated S, whose covariance is solved run by run.
const TRIED_CALIBRATED: usize = 50;
/// Probability that a gauge is identified although all are sound.
const FALSE_ALARM: f64 = 0.01;

/// Returns every so many readings, `most` at most.
fn spread_over(readings: &[Readings], most: usize) -> Vec<Readings> {
    let step = readings.len().div_ceil(most).max(1);
    readings.iter().step_by(step).cloned().collect()
}

/// Readings that loads are recovered from.
struct RecoveryInput<'a> {
    s: Sensitivity,
    readings: Vec<Readings>,
    errors: ErrorModel,
    /// Uncertainty of a calibrated S.
    known: Option<&'a Uncertainty>,
}

impl<'a> RecoveryInput<'a> {
    fn new(
        s: &Sensitivity,
        readings: &[Readings],
        errors: ErrorModel,
        known: Option<&'a Uncertainty>,
    ) -> Self {
        let most = if known.is_some() {
            TRIED_CALIBRATED
        } else {
            TRIED
        };
        Self {
            s: with_rows(s, s.values.clone()),
            readings: spread_over(readings, most),
            errors,
            known,
        }
    }
}

/// Returns S with these rows, without its uncertainty.
fn with_rows(s: &Sensitivity, values: Matrix) -> Sensitivity {
    Sensitivity {
        gauges: s.gauges.clone(),
        loads: s.loads.clone(),
        values,
        uncertainty: None,
        noise: s.noise.clone(),
    }
}

impl Misfit for RecoveryInput<'_> {
    fn inputs(&self) -> Inputs {
        Inputs {
            strain: self.readings.iter().map(|r| r.strain.clone()).collect(),
            rows: self.s.values.clone(),
        }
    }

    fn noise(&self) -> f64 {
        self.errors.noise
    }

    fn fit(&self, inputs: &Inputs) -> InputFit {
        let s = with_rows(&self.s, inputs.rows.clone());
        let changed = self.readings.iter().zip(&inputs.strain);
        let readings: Vec<Readings> = changed
            .map(|(r, strain)| Readings {
                strain: strain.clone(),
                ..r.clone()
            })
            .collect();
        let runs: Vec<RunEstimate> = match self.known {
            None => solve(&s, &readings, self.errors).runs,
            Some(known) => (readings.par_iter())
                .map(|r| estimate(&s, r, self.errors, known))
                .collect(),
        };
        let wanted: Vec<usize> = (0..s.loads.len()).filter(|l| s.loads[*l].wanted).collect();
        let loads = |r: &RunEstimate| {
            let each = wanted.iter();
            each.map(|l| [r.estimate.values[*l], NORMAL_95 * r.estimate.sigma(*l)])
                .collect()
        };
        InputFit {
            chi2: runs.iter().map(|r| r.chi2).sum(),
            dof: runs.iter().map(|r| r.dof).sum(),
            loads: runs.iter().map(loads).collect(),
            predicted: runs.into_iter().map(|r| r.predicted).collect(),
        }
    }
}

/// Returns the findings on faults of the gauges by stated errors. The result contains the readings as measured.
pub(super) fn faults_by_stated_errors(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    alternatives: &mut dyn FnMut() -> Vec<AlternativeRows>,
) -> Vec<Finding> {
    let misfit = RecoveryInput::new(s, readings, errors, None);
    let found = search_faults(&misfit, alternatives, &Rules::STATED);
    found
        .iter()
        .map(|f| f.finding(&s.gauges, FaultTreatment::AsMeasured))
        .collect()
}

/// Returns the findings on gauge faults by a calibrated S, and the readings. With [`FaultTreatment::LeftOut`] the readings exclude the faulty gauges.
pub(super) fn faults_by_calibration(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    known: &Uncertainty,
    (handling, alternatives): (FaultTreatment, &mut dyn FnMut() -> Vec<AlternativeRows>),
) -> (Vec<Finding>, Vec<Readings>) {
    let mut readings = readings.to_vec();
    // If S does not separate the loads, strain of an effect outside S is not evidence of a gauge fault.
    let apart = |r: &Readings| estimate(s, r, errors, known).rank == s.loads.len();
    if !readings.iter().any(apart) {
        return (Vec::new(), readings);
    }
    let misfit = RecoveryInput::new(s, &readings, errors, Some(known));
    // Student's t with the degrees of freedom of the scatter, for the largest of all gauges (Bonferroni).
    let share = 0.5 * FALSE_ALARM / s.gauges.len().max(1) as f64;
    let sigmas = match known.dof.is_finite() {
        true => student(1.0 - share, known.dof),
        false => Rules::STATED.named,
    };
    let found = search_faults(&misfit, alternatives, &Rules::of_scatter(sigmas));
    if handling == FaultTreatment::LeftOut {
        for g in found.iter().flat_map(|f| f.fault.gauges()) {
            readings.iter_mut().for_each(|r| r.strain[g] = f64::NAN);
        }
    }
    let found = found.iter().map(|f| f.finding(&s.gauges, handling));
    (found.collect(), readings)
}
