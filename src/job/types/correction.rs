//! `[[correction]]`.

/// `[[correction]]`: all that is known to be wrong with a strain channel ([`crate::reconcile::effect::Correction`] is one step of what a
/// hypothesis finds). It reads `sign gain strain + offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainCorrection {
    /// Channel.
    pub gauge: String,
    /// 1, or -1 where it is wired backwards.
    pub sign: f64,
    /// What it reads of the strain.
    pub gain: f64,
    /// What it reads without strain, microstrain.
    pub offset_microstrain: f64,
    /// The channel with which it is exchanged.
    pub exchanged_with: Option<String>,
    /// What the gauge is turned by, degrees, beyond its stated angle.
    pub angle_deg: Option<f64>,
    /// The channel is taken for silent.
    pub ignore: bool,
    /// Leg of a rosette whose correction the job states for the rosette as a whole.
    pub of_rosette: bool,
    /// Line of the job.
    pub line: u32,
}
