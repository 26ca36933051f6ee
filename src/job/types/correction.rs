//! `[[correction]]`.

/// `[[correction]]`: all known faults of a strain channel. The channel reads `sign * gain * strain + offset`.
/// [`crate::reconcile::effect::Correction`] is a single fault from a hypothesis.
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
    /// Channel that is exchanged with this channel.
    pub exchanged_with: Option<String>,
    /// Rotation of the gauge from its stated angle, degrees.
    pub angle_deg: Option<f64>,
    /// Whether the channel is ignored.
    pub ignore: bool,
    /// Leg of a rosette whose correction the job states for the rosette as a whole.
    pub of_rosette: bool,
    /// Line of the job.
    pub line: u32,
}
