//! Channels of a response, with their units.

use super::inputs::Simulation;
use crate::series::detrend::rms;
use crate::units::{Quantity, UnitSystem};
use crate::vehicle::layout::Measures;
use crate::vehicle::response::Response;
use serde::Serialize;

/// Kind of wheel forces.
pub const WHEEL: &str = "wheel force";
/// Kind of forces of links.
pub const LINK: &str = "force of springs and dampers";

/// Channel of a response.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name without unit.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Quantity in words, which groups the channels of a figure.
    pub kind: &'static str,
    /// Samples.
    pub values: Vec<f64>,
}

/// Range of a channel over the record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelRange {
    /// Channel.
    pub channel: String,
    /// Unit as text.
    pub unit: String,
    /// Smallest sample.
    pub min: f64,
    /// Largest sample.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
}

impl Column {
    /// Returns the range of the channel.
    pub fn range(&self) -> ChannelRange {
        let values = self.values.iter().copied();
        ChannelRange {
            channel: self.name.clone(),
            unit: self.unit.clone(),
            min: values.clone().fold(f64::INFINITY, f64::min),
            max: values.fold(f64::NEG_INFINITY, f64::max),
            rms: rms(&self.values),
        }
    }
}

/// Returns the channels of a response: sensors of the model, wheel forces, motions of each body, links.
pub(super) fn columns_of(
    simulation: &Simulation,
    found: &Response,
    system: UnitSystem,
) -> Vec<Column> {
    let vehicle = &simulation.vehicle;
    let length = &simulation.units.length;
    let force = &simulation.units.force;
    let acceleration = system.unit(Quantity::Acceleration).name;
    let mut out = Vec::new();
    let mut add = |name: String, unit: &str, kind: &'static str, values: Vec<f64>| {
        out.push(Column {
            name,
            unit: unit.to_owned(),
            kind,
            values,
        });
    };
    for sensor in &vehicle.sensors {
        let (motions, unit, kind) = match sensor.measures {
            Measures::Acceleration => (&found.acceleration, acceleration, "acceleration"),
            Measures::Displacement => (&found.displacement, length.as_str(), "displacement"),
        };
        let functions = vehicle.functions(&sensor.at);
        let motions = &motions[sensor.at.body];
        let sum = |t: usize| functions.iter().zip(motions).map(|(f, q)| f * q[t]).sum();
        let n = motions.first().map_or(0, Vec::len);
        add(
            sensor.channel.clone(),
            unit,
            kind,
            (0..n).map(sum).collect(),
        );
    }
    for (wheel, values) in vehicle.wheels.iter().zip(&found.wheels) {
        if let Some(values) = values {
            add(wheel.channel.clone(), force, WHEEL, values.clone());
        }
    }
    for (b, body) in vehicle.bodies.iter().enumerate() {
        if vehicle.is_witness(b) {
            continue;
        }
        for (j, letter) in body.shape.letters().iter().enumerate() {
            let heave = [
                length.clone(),
                format!("{length}/s"),
                acceleration.to_owned(),
            ];
            let angle = ["rad", "rad/s", "rad/s2"].map(str::to_owned);
            let (names, units, kinds) = match *letter {
                "" => (
                    ["displacement", "velocity", "acceleration"],
                    heave,
                    ["displacement", "velocity", "acceleration"],
                ),
                "x" => (
                    ["pitch", "pitch_rate", "pitch_acceleration"],
                    angle,
                    ["angle"; 3],
                ),
                _ => (
                    ["roll", "roll_rate", "roll_acceleration"],
                    angle,
                    ["angle"; 3],
                ),
            };
            let lists = [&found.displacement, &found.velocity, &found.acceleration];
            for k in 0..3 {
                let name = format!("{}.{}", body.name, names[k]);
                add(name, &units[k], kinds[k], lists[k][b][j].clone());
            }
        }
    }
    for (l, link) in vehicle.links.iter().enumerate() {
        let name = |part: &str| format!("{}.{part}", link.name);
        let pairs = found.spring[l].iter().zip(&found.damper[l]);
        let sum = pairs.map(|(k, c)| k + c).collect();
        add(name("stretch"), length, "stretch", found.stretch[l].clone());
        add(name("spring"), force, "spring", found.spring[l].clone());
        add(name("damper"), force, "damper", found.damper[l].clone());
        add(name("force"), force, LINK, sum);
    }
    out
}
