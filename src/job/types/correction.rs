//! `[[correction]]`.

/// `[[correction]]`: all that is known to be wrong with a strain channel ([`crate::reconcile::effect::Correction`] is one step of what a
/// hypothesis finds). It reads `sign gain strain + offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainCorrection {
    /// Channel.
    pub gauge: String,
    /// 1, or -1 if the gauge has reversed polarity.
    pub sign: f64,
    /// Reading divided by strain.
    pub gain: f64,
    /// Reading without strain, microstrain.
    pub offset_microstrain: f64,
    /// The channel with which it is exchanged.
    pub exchanged_with: Option<String>,
    /// Rotation of the gauge from its stated angle, degrees.
    pub angle_deg: Option<f64>,
    /// The channel is taken for silent.
    pub ignore: bool,
    /// Leg of a rosette whose correction the job states for the rosette as a whole.
    pub of_rosette: bool,
    /// Line of the job.
    pub line: u32,
}
