//! `[fleet]`.

use super::named_file::NamedFile;

/// `[fleet]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    /// Form of file names, with `{vehicle}` and `{day}`.
    pub file_name: NamedFile,
    /// Range below which the S-N line is flatter, report unit of each load. `None` for a straight line.
    pub knee_range: Option<f64>,
    /// Power below the knee. It is infinite if cycles below the knee cause no damage.
    pub slope_below_knee: f64,
    /// Day whose damage per hour is 1 in comparisons.
    pub reference: Option<ReferenceDay>,
    /// Target damage of each load.
    pub target: Vec<TargetDamage>,
    /// Kinds of days that a mission consists of. Their shares sum to 1.
    pub mission: Vec<MissionKind>,
    /// Hours of the mission.
    pub mission_hours: f64,
    /// Text of the job without comparisons of damage and keys of other commands. The result of a single record depends only on this text.
    pub of_records: String,
}

/// A day of a vehicle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReferenceDay {
    /// The vehicle.
    pub vehicle: String,
    /// Day, as in the file name.
    pub day: String,
    /// Line of the job.
    pub line: u32,
}

/// Target damage of a load.
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
    /// Names of the days, with `*` for any text. An empty list means every day.
    pub days: Vec<String>,
    /// Names of the vehicles, with `*` for any text. An empty list means every vehicle.
    pub vehicles: Vec<String>,
    /// Line of the job.
    pub line: u32,
}
