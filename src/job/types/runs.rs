//! `[runs]`, and recorded loads of `[compare]`, which are read like the loads of `[runs]`.

use super::named_file::NamedFile;
use crate::reconcile::strain::WheelForces;
use crate::units::{Quantity, ReportUnits};
use std::collections::BTreeMap;

/// `[runs]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Runs {
    /// The file.
    pub file: NamedFile,
    /// Section of the job that names the file: `runs`, `compare` or `respond`.
    pub section: &'static str,
    /// Column of each load, and of `payload_force`, `payload_mass`, `payload_x`, `payload_y`.
    pub columns: BTreeMap<String, String>,
    /// Units of the file. The default is the report units.
    pub units: ReportUnits,
    /// Quantities whose unit the job states.
    pub stated_units: Vec<Quantity>,
    /// 1 sd by quantity, in the file's units.
    pub noise: RunNoise,
    /// Whether wheel forces were measured or computed.
    pub wheel_forces: WheelForces,
    /// Usual change of a computed wheel force by ground that is not flat, 1 sd, in the file's unit of force.
    pub ground: Option<f64>,
    /// Line of the job.
    pub line: u32,
}

impl Runs {
    /// Returns a file of loads in report units, with columns named after the loads.
    pub fn in_report_units(file: NamedFile, section: &'static str, units: ReportUnits) -> Self {
        Self {
            line: file.line,
            file,
            section,
            columns: BTreeMap::new(),
            units,
            stated_units: Vec::new(),
            noise: RunNoise::default(),
            wheel_forces: WheelForces::Measured,
            ground: None,
        }
    }
}

/// Noise of the runs file, 1 sd, in its units; `None` where not stated.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct RunNoise {
    pub force: Option<f64>,
    pub moment: Option<f64>,
    pub mass: Option<f64>,
    pub length: Option<f64>,
}
