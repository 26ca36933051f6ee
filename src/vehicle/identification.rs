//! Inputs and results of an identification.

use super::adjustment::Adjustment;
use super::checks::MassClosure;
use super::layout::Vehicle;
use super::term::UnitNames;
use crate::finding::{Finding, Severity};
use crate::series::spectrum::Band;
use serde::Serialize;
use std::collections::BTreeMap;

/// Inputs of an identification.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifyTask {
    /// The model.
    pub vehicle: Vehicle,
    /// Parameters measured elsewhere.
    pub known: BTreeMap<String, f64>,
    /// Limits of the parameters. Positive parameters always have the lower limit 0.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// The band of every equation.
    pub band: Band,
    /// Acceleration of gravity, job units.
    pub gravity: f64,
    /// Gain tolerance of every channel, 1 sd, as a share.
    pub gain_tolerance: f64,
    /// Synchronisation tolerance of every channel, 1 sd, s.
    pub sync_tolerance_s: f64,
    /// Names of the job's units.
    pub units: UnitNames,
    /// Noise of accelerometers, 1 sd of a sample, if declared.
    pub noise_acc: Option<f64>,
    /// Noise of wheel forces, 1 sd of a sample, if declared.
    pub noise_force: Option<f64>,
    /// Known faults of channels, which are corrected first.
    pub corrections: Vec<Adjustment>,
}

/// One parameter, or a ratio of two.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Name, `k_s` or `k_s/m_b`.
    pub name: String,
    /// Value; `None` if it can't be determined.
    pub value: Option<f64>,
    /// One standard deviation, including coloured residuals and declared tolerances.
    pub sigma: Option<f64>,
    /// Unit as text.
    pub unit: String,
    /// Whether record and model determine the parameter.
    pub identifiable: bool,
    /// 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// Whether the parameter was declared and not estimated.
    pub known: bool,
}

/// Quality of the fit of a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelFit {
    /// Channel.
    pub channel: String,
    /// RMS of measured minus predicted signal, divided by the RMS of the measured signal, in the band.
    pub relative_rms: f64,
    /// RMS of measured minus predicted signal, divided by the RMS of the measured signal, in the band, on the fitted data.
    pub relative_rms_fitted: f64,
    /// Part of `relative_rms` from declared noise and tolerances, over the RMS of measured on its data; `None` if no noise is declared.
    pub floor: Option<f64>,
    /// Data of `relative_rms`: `hold-out` or `fitted`.
    pub on: &'static str,
}

/// Result of an identification.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The vehicle with all constants of its terms.
    pub vehicle: Vehicle,
    /// Values of `vehicle.parameters()`; relative to the reference mass (1) if no force sets the scale; NaN if unknown.
    pub values: Vec<f64>,
    /// Standard deviations, 0 for known parameters.
    pub sigmas: Vec<f64>,
    /// Covariance of `values`, by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Whether each of `values` has the scale of forces.
    pub scaled: Vec<bool>,
    /// Factor on sigma for 95 %.
    pub coverage_factor: f64,
    /// Parameters and ratios as reported.
    pub parameters: Vec<Estimate>,
    /// Messages about parameters that the record does not determine.
    pub unidentifiable: Vec<String>,
    /// Quality of the fit of each channel.
    pub fit: Vec<ChannelFit>,
    /// Masses of the dynamic fit against static masses.
    pub mass_closure: Option<MassClosure>,
    /// Shares of the signals in each wheel force that fit best.
    pub blend: Vec<Vec<f64>>,
    /// RMS of the wheel force error in the band, if measured. It is the larger value of fitted and held-out record.
    pub wheel_force_sigma: Vec<Option<f64>>,
    /// Ratio of smallest to largest singular value, worst component, columns of unit norm.
    pub conditioning: f64,
    /// All findings.
    pub findings: Vec<Finding>,
}

impl Identification {
    /// Returns the value of a parameter by name, if the record determines it with its scale.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.parameters
            .iter()
            .find(|p| p.name == name)
            .and_then(|p| p.value)
    }

    /// Returns the finding on a wrong input of the record.
    pub fn wrong_input(&self) -> Option<Finding> {
        let codes = ["input-sign-reversed", "input-unit", "inputs-exchanged"];
        let mut all = self.findings.iter();
        all.find(|f| codes.contains(&f.code)).cloned()
    }

    /// Returns a finding of error severity if the record determines no parameter.
    pub fn verdict(&self) -> Option<Finding> {
        let mut parameters = self.parameters.iter();
        let determines_any = parameters.any(|p| p.identifiable && !p.known);
        // A wrong input explains the lack of parameters. Without links, the job only asks for the forces of stated masses.
        let is_explained = self.vehicle.links.is_empty()
            || self
                .wrong_input()
                .is_some_and(|f| f.severity == Severity::Error);
        (!determines_any && !is_explained).then(|| {
            let message = "This record determines no parameter.";
            Finding::new(
                Severity::Error,
                "nothing-identifiable",
                &self.vehicle.name,
                message,
                "Add a measurement listed under `unidentifiable`.",
            )
        })
    }
}
