//! `[dynamic]`.

/// `[dynamic]`: records of a structure that vibrates in its elastic modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamic {
    /// Highest frequency of the wanted loads, Hz.
    pub up_to_hz: f64,
    /// Damping of the modes.
    pub damping: Damping,
    /// Standard deviation of the frequency of each mode, as a share of the frequency.
    pub frequency_uncertainty_rel: f64,
    /// Standard deviation of the damping, as a share of the damping.
    pub damping_uncertainty_rel: f64,
    /// Line of the section in the job.
    pub line: u32,
}

/// Damping of the modes, share of critical.
#[derive(Clone, Debug, PartialEq)]
pub enum Damping {
    /// One for all modes.
    Uniform(f64),
    /// Upper end of a band, Hz, and damping of the modes in it, bands in ascending order. Modes above the last band have its damping.
    Bands(Vec<[f64; 2]>),
    /// To be estimated from the record.
    Estimate,
}

impl Damping {
    /// Returns the stated damping of a mode of the frequency `hz`; `None` if it is to be estimated.
    pub fn stated_at(&self, hz: f64) -> Option<f64> {
        match self {
            Self::Uniform(damping) => Some(*damping),
            Self::Bands(bands) => {
                let band = bands.iter().find(|[up_to_hz, _]| hz <= *up_to_hz);
                band.or(bands.last()).map(|[_, damping]| *damping)
            }
            Self::Estimate => None,
        }
    }
}
