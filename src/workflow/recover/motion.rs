//! Vibration that was removed from a record, as the result states it.

use serde::Serialize;

/// Vibration that was removed from a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Motion {
    /// Highest frequency of the recovered loads.
    pub up_to_hz: f64,
    /// Frequencies of the modes used; the intervals contain the effect of further modes.
    pub modes_hz: Vec<f64>,
    /// Modes of `modes_hz`, with their damping and intervals.
    pub modes: Vec<ModeInUse>,
    /// Time without known loads at either end of the record and of every gap.
    pub blank_s: f64,
    /// Error of each load without the correction, rms, as a share of the rms of the load about its mean.
    pub change_rel: Vec<Option<f64>>,
}

/// Mode that was removed from a record. `low` and `high` are the ends of 95 % intervals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModeInUse {
    /// Frequency of the model, Hz.
    pub model_hz: f64,
    /// Frequency with which the vibration was removed, Hz.
    pub hz: f64,
    /// Low end of the frequency, Hz.
    pub hz_low: f64,
    /// High end of the frequency, Hz.
    pub hz_high: f64,
    /// Damping with which the vibration was removed, share of critical.
    pub damping: f64,
    /// Low end of the damping.
    pub damping_low: f64,
    /// High end of the damping.
    pub damping_high: f64,
    /// Whether the record changed the stated values.
    pub estimated: bool,
}
