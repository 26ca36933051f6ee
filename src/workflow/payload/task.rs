//! Inputs of `payload`.

use crate::job::{Job, Payload};

/// The payload section of a job with its data, in report units of force and length.
pub(super) struct Task<'a> {
    pub job: &'a Job,
    pub payload: &'a Payload,
    /// Gravity in report force per report mass.
    pub weight_of_mass: f64,
    /// Report force and length per job unit.
    pub force: f64,
    pub length: f64,
    /// Nominal place of the payload in plan, report length, and the names of the plan axes.
    pub nominal: [f64; 2],
    /// Reactions to the structure's own weight, by wheel. Empty if unknown.
    pub empty: Vec<f64>,
    /// Names of the wheels.
    pub wheels: Vec<String>,
}
