//! `[dynamic]`.

/// `[dynamic]`: records of a structure that vibrates in its elastic modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamic {
    /// Loads are wanted up to here, Hz.
    pub up_to_hz: f64,
    /// Damping of every mode, share of critical.
    pub damping: f64,
    /// One standard deviation of the modes' frequencies, share of each.
    pub frequency_uncertainty_rel: f64,
    /// One standard deviation of the damping, share of it.
    pub damping_uncertainty_rel: f64,
    /// Line of the section in the job.
    pub line: u32,
}
