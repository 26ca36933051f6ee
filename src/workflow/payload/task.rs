//! Inputs of `payload`.

use crate::job::{Job, Payload};

/// A job's payload section with what it needs: counted in report units from here on (force, length).
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
    /// Reactions of the structure's own weight, by wheel; empty where unknown.
    pub empty: Vec<f64>,
    /// Names of the wheels.
    pub wheels: Vec<String>,
}
