//! `[conditioning]`.

/// `[conditioning]`: changes of the readings of a record before anything else, in the order of the fields.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingConditioning {
    /// Whether single samples far off the line through their neighbours are replaced by that line.
    pub spikes: bool,
    /// Strain that follows a temperature channel.
    pub temperature: Option<TemperatureCompensation>,
    /// Whether the least squares line of each channel over the record is subtracted.
    pub linear_drift: bool,
    /// Stretch of the record whose mean is zero, s.
    pub zero_s: Option<[f64; 2]>,
    /// Corner of the low-pass filter, Hz.
    pub low_pass_hz: Option<f64>,
    /// Corner of the high-pass filter, Hz.
    pub high_pass_hz: Option<f64>,
    /// Line of the section in the job.
    pub line: u32,
}

/// Compensation of strain by a measured temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct TemperatureCompensation {
    /// Channel of the record with the temperature, degrees Celsius.
    pub channel: String,
    /// Apparent strain per degree at every gauge, microstrain.
    pub microstrain_per_deg_c: f64,
}
