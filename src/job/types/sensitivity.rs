//! `[sensitivity]`: S computed elsewhere.

use super::named_file::NamedFile;
use crate::units::ReportUnits;
use std::collections::BTreeMap;

/// `[sensitivity]`.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenSensitivity {
    /// File with a row for each gauge and a column for each load.
    pub file: NamedFile,
    /// Units of load to which the microstrain refers.
    pub per: ReportUnits,
    /// Name and column of each load, in job order. If the list is empty, every column is a load with the name of the column.
    pub columns: Vec<(String, String)>,
    /// Signature files.
    pub signatures: Signatures,
    /// Covariance of S in the format of `calibrate`.
    pub covariance: Option<NamedFile>,
    /// Strain that the gauges read without load, in the format that `calibrate` writes with `terms = "intercept"`.
    pub common_zero: Option<NamedFile>,
    /// Smallest and largest load of the calibration by name, in the units of [`Self::per`].
    pub range: BTreeMap<String, [f64; 2]>,
    /// Smallest and largest reading of the calibration by gauge, microstrain.
    pub strain_range: BTreeMap<String, [f64; 2]>,
    /// Line of the job.
    pub line: u32,
}

/// Signatures of effects, computed elsewhere.
#[derive(Clone, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Signatures {
    pub lateral_wheel_loads: Option<NamedFile>,
    pub thermal: Option<NamedFile>,
    pub payload: Option<NamedFile>,
    pub unaccounted_mass: Option<NamedFile>,
    pub gauge_angle: Option<NamedFile>,
    /// File of each zone.
    pub rail_stiffness: BTreeMap<String, NamedFile>,
}

impl Signatures {
    /// Returns every file that is named.
    pub fn files(&self) -> impl Iterator<Item = &NamedFile> {
        let single = [
            &self.lateral_wheel_loads,
            &self.thermal,
            &self.payload,
            &self.unaccounted_mass,
            &self.gauge_angle,
        ];
        let zones = self.rail_stiffness.values();
        single.into_iter().flatten().chain(zones)
    }
}
