//! `[fleet]`.

use super::named_file::NamedFile;

/// `[fleet]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    /// Form of file names, with `{vehicle}` and `{day}`.
    pub file_name: NamedFile,
    /// Range below which the S-N line is flatter, report unit of each load; `None`: a straight line.
    pub knee_range: Option<f64>,
    /// Power below the knee; infinite where cycles below do no harm.
    pub slope_below_knee: f64,
    /// Day whose damage an hour is 1.
    pub reference: Option<ReferenceDay>,
    /// Damage that is aimed at, by load.
    pub target: Vec<TargetDamage>,
    /// Kinds of days that a mission is mixed of; their shares sum to 1.
    pub mission: Vec<MissionKind>,
    /// Hours of the mission.
    pub mission_hours: f64,
    /// The job but for what damage is held against and what other commands ask: on so much of it a single record depends.
    pub of_records: String,
}

/// A day of a vehicle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReferenceDay {
    /// The vehicle.
    pub vehicle: String,
    /// The day, as its file name has it.
    pub day: String,
    /// Line of the job.
    pub line: u32,
}

/// The damage that a load is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetDamage {
    /// The load.
    pub load: String,
    /// Report unit to the power of the slope.
    pub damage: f64,
    /// Line of the job.
    pub line: u32,
}

/// A kind of days.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionKind {
    /// Name of the kind of days.
    pub name: String,
    /// Share of the hours.
    pub share: f64,
    /// Names of its days, `*` for any text; none: every day.
    pub days: Vec<String>,
    /// Names of its vehicles likewise.
    pub vehicles: Vec<String>,
    /// Line of the job.
    pub line: u32,
}
