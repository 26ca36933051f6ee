//! Input of the dynamic search.

use crate::reconcile::rules::MotionRules;
use crate::series::channels::Channels;
use crate::series::spectrum::Band;
use crate::stop::Stop;
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::layout::Vehicle;
use crate::vehicle::term::UnitNames;
use std::collections::BTreeMap;

/// The analyst's vehicle, the records, and the declared quality of the records. All quantities are in job units.
#[derive(Clone, Debug)]
pub struct MotionFrame {
    /// Model of the analyst. Bodies that are not compared serve as witnesses (the other side of an axle).
    pub vehicle: Vehicle,
    /// Bodies whose equations are compared.
    pub bodies: Vec<usize>,
    /// Compared bodies whose equations are left out because a dead channel enters them.
    pub not_compared: Vec<usize>,
    /// Parameters measured elsewhere.
    pub known: BTreeMap<String, f64>,
    /// The record that is fitted.
    pub data: Channels,
    /// Held-out record that tests the result; `None` if the fitted record tests it.
    pub hold_out: Option<Channels>,
    /// The band of every comparison.
    pub band: Band,
    /// Acceleration of gravity.
    pub gravity: f64,
    /// Noise of accelerometers, one sd of a sample, if declared.
    pub noise_acc: Option<f64>,
    /// Noise of force channels, one sd of a sample, if declared.
    pub noise_force: Option<f64>,
    /// Gain tolerance of every channel, one sd, a share.
    pub gain_tolerance: f64,
    /// Synchronisation tolerance of every channel, one sd, s.
    pub sync_tolerance_s: f64,
    /// Faults of channels that the job declares.
    pub corrections: Vec<Adjustment>,
    /// Names of units.
    pub units: UnitNames,
    /// Thresholds for naming effects.
    pub rules: MotionRules,
    /// Request to stop the search early. Its result must then not be used.
    pub stop: Stop,
}

impl MotionFrame {
    /// Returns the channels of the compared bodies: accelerometers, then measured wheel forces.
    pub fn channels(&self) -> Vec<String> {
        let v = &self.vehicle;
        let own = |b: usize| self.bodies.contains(&b);
        v.sensors
            .iter()
            .filter(|s| own(s.at.body))
            .map(|s| s.channel.clone())
            .chain(
                v.wheels
                    .iter()
                    .filter(|w| own(w.at.body) && self.data.has(&w.channel))
                    .map(|w| w.channel.clone()),
            )
            .collect()
    }

    /// Returns whether a channel is an accelerometer (or displacement sensor) of a compared body.
    pub fn is_sensor(&self, channel: &str) -> bool {
        self.vehicle.sensors.iter().any(|s| s.channel == channel)
    }
}
