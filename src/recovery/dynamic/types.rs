//! Modes, band, and why there may be no answer.

/// End of the pass band over the highest frequency of the wanted loads. Between both frequencies the filter falls as a cosine.
pub const BAND_END: f64 = 1.5;

/// Elastic mode with its strain at the gauges and the work of the loads.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticMode {
    /// Frequency, Hz.
    pub hz: f64,
    /// Strain at every gauge of S for a generalised coordinate of 1. The shape has unit generalised mass.
    pub strain: Vec<f64>,
    /// Work of a unit of every load of S on the shape.
    pub work: Vec<f64>,
    /// Damping, share of critical.
    pub damping: f64,
    /// One standard deviation of the frequency, as a share of the frequency.
    pub frequency_sd: f64,
    /// One standard deviation of the damping, as a share of the damping.
    pub damping_sd: f64,
}

/// Dynamic properties of the structure, and the frequency range of the loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// Modes with a dynamic response.
    pub modes: Vec<ElasticMode>,
    /// Frequency from which on further modes exist, Hz; their dynamic response is part of the uncertainty. `None` without further modes.
    pub further_hz: Option<f64>,
    /// Damping of the modes from `further_hz` on, as a share of critical damping.
    pub further_damping: f64,
    /// Highest frequency of the wanted loads, Hz.
    pub up_to_hz: f64,
}

/// Reasons why quasi-static readings can't be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// The sample rate of the record is too low for the band.
    #[error("{rate_hz:.4} samples per second do not cover a band up to {end_hz:.4} Hz")]
    Rate {
        /// Sample rate of the record, Hz.
        rate_hz: f64,
        /// End of the band, Hz.
        end_hz: f64,
    },
    /// Loads that the gauges can't separate.
    #[error("at {hz:.4} Hz the gauges do not separate the loads")]
    NotSeparable {
        /// Frequency at which they can't, Hz.
        hz: f64,
    },
    /// A band so narrow that its filter needs longer transforms than are supported.
    #[error(
        "a band that ends at {end_hz} Hz is too narrow for {rate_hz:.4} samples per second: a quasi-static sample would depend on hundreds \
         of thousands of others"
    )]
    Narrow {
        /// Rate of the record.
        rate_hz: f64,
        /// End of the band.
        end_hz: f64,
    },
    /// A filter of more numbers than are kept.
    #[error(
        "the filter of {gauges} gauges, {loads} loads and {modes} modes takes more than 256 MB"
    )]
    Large {
        /// Gauges.
        gauges: usize,
        /// Loads.
        loads: usize,
        /// Modes.
        modes: usize,
    },
    /// The reach of a reading exceeds the supported range.
    #[error(
        "a quasi-static sample would depend on readings over more than {seconds:.4} s around it"
    )]
    Rings {
        /// Time.
        seconds: f64,
    },
}
