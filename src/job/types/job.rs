//! The whole job, section by section.

use super::ballast::Ballast;
use super::calibration::CalibrationKeys;
use super::candidates::Candidates;
use super::compare::Compare;
use super::conditioning::ReadingConditioning;
use super::correction::StrainCorrection;
use super::dynamic::Dynamic;
use super::fleet::Fleet;
use super::gauge::JobGauge;
use super::load::{Combination, JobLoad};
use super::measured::Measured;
use super::model::ModelFiles;
use super::named_file::NamedFile;
use super::payload::Payload;
use super::placement::Placement;
use super::reconcile::Reconcile;
use super::recover::Recover;
use super::respond::Respond;
use super::runs::Runs;
use super::section::RecordSection;
use super::sensitivity::GivenSensitivity;
use super::study::Study;
use super::vehicle::Vehicle;
use crate::host::file_read::FileRead;
use crate::job::quantity::quantity_of_name;
use crate::units::{Quantity, ReportUnits, UnitSystem};
use std::path::PathBuf;

/// Settings of every command, read from `job.toml` and checked. Defaults are filled in, and commands read the tables of strain and runs.
///
/// # Example
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::units::UnitSystem;
/// use strainbridge::Job;
///
/// const JOB: &str = r#"
/// units = "mm-t-s"
/// model = { deck = "frame.bdf" }
/// load = [{ name = "LF.FZ", grid = 71, component = "FZ" }]
/// "#;
/// let job = Job::read("job.toml", &InMemory::default().with_file("job.toml", JOB))?;
/// assert_eq!(job.units, UnitSystem::MmTS);
/// assert_eq!(job.loads[0].name, "LF.FZ");
/// // Standard gravity is 9.80665 m/s^2, and the unit of length is the millimetre.
/// assert_eq!(job.gravity(), 9806.65);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
#[derive(Clone, Debug)]
pub struct Job {
    /// The job file as given on the command line.
    pub file: String,
    /// Folder of the job: paths in the job are relative to it.
    pub folder: PathBuf,
    /// Files from which the job was read: the job file first, then tables read with it.
    pub read: Vec<FileRead>,
    /// Title; the file's name if the job has no title.
    pub title: String,
    /// Unit system of the model.
    pub units: UnitSystem,
    /// Units of reports.
    pub report_units: ReportUnits,
    /// `[model]`.
    pub model: Option<ModelFiles>,
    /// `[[load]]`, in job order.
    pub loads: Vec<JobLoad>,
    /// `[calibration]`; the default where absent.
    pub calibration: CalibrationKeys,
    /// `[[combination]]`, in job order.
    pub combinations: Vec<Combination>,
    /// `[[correction]]`, in job order.
    pub corrections: Vec<StrainCorrection>,
    /// Gauges of `[[gauge]]`, then gauges of `[gauges] file`.
    pub gauges: Vec<JobGauge>,
    /// Names of the readings of gauges that were left out of this job ([`Job::without_validation_gauges`]).
    pub reserved: Vec<String>,
    /// `[gauges] file`.
    pub gauge_file: Option<NamedFile>,
    /// `[candidates]`; the default where absent.
    pub candidates: Candidates,
    /// `[placement]`; the default where absent.
    pub placement: Placement,
    /// `[measured]`.
    pub measured: Option<Measured>,
    /// `[runs]`.
    pub runs: Option<Runs>,
    /// `[compare]`.
    pub compare: Option<Compare>,
    /// `[[section]]`, in job order.
    pub sections: Vec<RecordSection>,
    /// `[ballast]`.
    pub ballast: Option<Ballast>,
    /// `[payload]`.
    pub payload: Option<Payload>,
    /// `[conditioning]`.
    pub conditioning: Option<ReadingConditioning>,
    /// `[dynamic]`.
    pub dynamic: Option<Dynamic>,
    /// `[recover]`; the default where absent.
    pub recover: Recover,
    /// `[respond]`; the default where absent.
    pub respond: Respond,
    /// `[study]`.
    pub study: Option<Study>,
    /// `[vehicle]`.
    pub vehicle: Option<Vehicle>,
    /// `[reconcile]`.
    pub reconcile: Option<Reconcile>,
    /// `[sensitivity]`: S and signatures computed elsewhere.
    pub sensitivity: Option<GivenSensitivity>,
    /// `[fleet]`.
    pub fleet: Option<Fleet>,
}

impl Job {
    /// Returns what a load measures: by its `[[load]]`, else by its name; `None` for a load set of the deck.
    pub fn quantity_of_load(&self, name: &str) -> Option<Quantity> {
        match self.loads.iter().find(|l| l.name == name) {
            Some(load) => load.quantity(),
            None => Some(quantity_of_name(name)),
        }
    }
}
