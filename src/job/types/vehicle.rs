//! `[vehicle]`.

use super::named_file::NamedFile;
use crate::vehicle::adjustment::{Lag, Slip};
use crate::vehicle::chassis::LeafSeat;
use std::collections::BTreeMap;

/// `[vehicle]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// `front2`, `rear3`, `front_pair`, `half`, `full2`, `full3`.
    pub model: String,
    /// Terms of the analyst's model.
    pub terms: Vec<String>,
    /// Record.
    pub data: NamedFile,
    /// Channels that drive a simulation; `None` if the columns of the record determine them.
    pub input: Option<SimulationInput>,
    /// Held-out record.
    pub hold_out: Option<NamedFile>,
    /// Sampling rate, Hz. `None` means the rate of the time column.
    pub sample_rate: Option<f64>,
    /// Known parameters, units of the job.
    pub known: BTreeMap<String, f64>,
    /// Noise of accelerations, units of the job, 1 sd.
    pub noise_acc: Option<f64>,
    /// Noise of wheel forces, units of the job, 1 sd.
    pub noise_force: Option<f64>,
    /// Declared tolerance of gains, a fraction.
    pub tolerance_gain: Option<f64>,
    /// Declared tolerance of synchronisation, s.
    pub tolerance_sync: Option<f64>,
    /// Band in which to compare, Hz.
    pub band_hz: Option<[f64; 2]>,
    /// Column of each channel, if the file uses another name for the channel.
    pub columns: BTreeMap<String, String>,
    /// Places (x, y) of wheels (`lf`), springs (`spring_lf`) and body accelerometers (`body_lf`), job unit of length.
    pub places: BTreeMap<String, [f64; 2]>,
    /// Limits of parameters, job units; an infinite value is no limit.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// Faults of channels that are known.
    pub corrections: BTreeMap<String, ChannelCorrection>,
    /// A mass that changes during the record.
    pub mass_change: Option<MassChange>,
    /// Leaf springs by link (`s`), whose force is divided between hanger and shackle.
    pub leaf: BTreeMap<String, LeafSeat>,
    /// Line of the job.
    pub line: u32,
}

/// Known faults of a channel of the records, one of each kind; [`crate::vehicle::adjustment::Adjustment`] combines several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelCorrection {
    /// Reading divided by true value.
    pub gain: f64,
    /// Delay of the channel, s.
    pub delay_s: f64,
    /// Increase of the delay in each second of the record, millionths.
    pub clock_ppm: f64,
    /// Samples lost or written twice, in the fitted record.
    pub slip: Option<Slip>,
    /// Low-pass filter in this channel only.
    pub lag: Option<Lag>,
    /// Frequency of a mains line in the channel, Hz.
    pub line_hz: Option<f64>,
}

/// Key `mass_change` of `[vehicle]`, which names the body. [`crate::vehicle::layout::MassStep`] is the corresponding change of a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct MassChange {
    /// Body, such as `b`.
    pub body: String,
    /// Begin of the change, s.
    pub at_s: f64,
    /// Duration of the change, s.
    pub over_s: f64,
    /// Whether the weight of the mass changes too. Otherwise only its inertia changes.
    pub weight: bool,
}

/// Channels that drive a simulation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SimulationInput {
    /// All channels of a kind.
    Kind(InputKind),
    /// Channels by name.
    Channels(Vec<String>),
}

/// Kind of the channels that drive a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// Every wheel force of the model.
    WheelForce,
    /// Height of the road under every wheel.
    Road,
    /// Accelerations in the record.
    Acceleration,
}

impl InputKind {
    /// Words of a job, with their meaning.
    pub const WORDS: [(&'static str, Self); 3] = [
        ("wheel_force", Self::WheelForce),
        ("road", Self::Road),
        ("acceleration", Self::Acceleration),
    ];
}
