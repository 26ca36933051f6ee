//! Units of loads: job units inside, report units outside.

use crate::job::Job;
use crate::job::quantity::quantity_of_name;
use crate::units::factor;
use serde::Serialize;

/// Unit of one load in reports.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadUnits {
    /// Name of the unit; empty for a load set, which counts in multiples of the set.
    pub name: String,
    /// Name in the units of the job.
    pub of_job: String,
    /// Factor from the job value to the report value.
    pub factor: f64,
}

/// One standard deviation of a load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadSigma {
    /// Load.
    pub name: String,
    /// One standard deviation in report units, from noise and model uncertainty, as `recover` states it for loads of their expected size.
    pub sigma: f64,
    /// Standard deviation with the tolerances of the installation and of the gauge factor, if the job states them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_as_glued: Option<f64>,
    /// Report unit.
    pub unit: String,
}

impl LoadSigma {
    /// Returns the standard deviation with installation tolerances if the job states them, otherwise without.
    pub fn sigma(&self) -> f64 {
        self.sigma_as_glued.unwrap_or(self.sigma)
    }
}

/// Returns the units by load, in job order. A load that only a given S names is a moment if its name shows it (`.M`, `_M`, leading `M`).
pub fn load_units(job: &Job, names: &[String]) -> Vec<LoadUnits> {
    names
        .iter()
        .map(|name| match job.loads.iter().find(|l| &l.name == name) {
            Some(l) => match l.report_unit(&job.report_units) {
                Some(u) => LoadUnits {
                    name: u.name.to_owned(),
                    of_job: job.units.unit(u.quantity).name.to_owned(),
                    factor: factor(job.units, u),
                },
                None => LoadUnits {
                    name: String::new(),
                    of_job: String::new(),
                    factor: 1.0,
                },
            },
            None => {
                let unit = job.report_units.unit(quantity_of_name(name));
                LoadUnits {
                    name: unit.name.to_owned(),
                    of_job: job.units.unit(unit.quantity).name.to_owned(),
                    factor: factor(job.units, unit),
                }
            }
        })
        .collect()
}
