//! Possible further measurements.

use crate::reconcile::motion::design::Design;
use crate::reconcile::motion::frame::MotionFrame;
use crate::reconcile::motion::motion_fit::MotionFit;
use crate::series::spectrum::Band;
use crate::vehicle::layout::{Measures, Point};

/// Roughness of other roads, as multiples of the present one: a rougher track and a walking pace.
const ROADS: [f64; 2] = [2.0, 0.5];
/// Length of a longer record on the same road, as a multiple of the present one.
const LONGER: f64 = 4.0;
/// Parts of the band, even in its logarithm, that a shaker or a row of sleepers can put its power into.
const PARTS: usize = 3;
/// A known mass as a share of the body's own: sacks on a truck, a block on a rig.
const MASS_SHARE: f64 = 0.2;

/// Further measurement.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Measurement {
    /// Present drive with every motion times a factor.
    Road(f64),
    /// Present power within a part of the band. `level` multiplies every motion in this part.
    Part {
        /// The part.
        part: Band,
        /// The factor.
        level: f64,
    },
    /// Present drive, this many times as long.
    Longer(f64),
    /// Present drive with these outside forces measured too.
    Forces(Vec<String>),
    /// Present drive with one more accelerometer.
    Beside(Point),
    /// Present drive with a known mass on a body.
    KnownMass {
        /// The body.
        body: usize,
        /// The mass, in the unit of the job.
        mass: f64,
    },
    /// Accelerometers at rest, upright and turned over.
    TurnOver,
    /// All accelerometers struck at once at the beginning and the end of a record.
    Strike,
}

impl Measurement {
    /// Returns the measurement as an instruction.
    pub(super) fn words(&self, frame: &MotionFrame) -> String {
        let body = |b: usize| frame.vehicle.bodies.get(b).map_or("", |b| b.name.as_str());
        match self {
            Self::Road(times) if *times > 1.0 => {
                format!("drive a road {times:.0} times as rough")
            }
            Self::Road(times) => format!("drive a road {times} times as rough"),
            Self::Part { part, .. } => format!(
                "drive (or shake) with the power between {:.2} and {:.2} Hz and accelerations as large as now",
                part.low_hz, part.high_hz
            ),
            Self::Longer(times) => format!("drive the same road {times:.0} times as long"),
            Self::Forces(list) => {
                let names: Vec<String> = list.iter().map(|c| format!("`{c}`")).collect();
                format!("measure {} as well", names.join(", "))
            }
            Self::Beside(at) => format!(
                "put a second accelerometer on body {} and drive again",
                body(at.body)
            ),
            Self::KnownMass { body: b, mass } => format!(
                "drive the same road with an additional weighed mass of {mass} {} on body {}",
                frame.units.mass,
                body(*b)
            ),
            Self::TurnOver => {
                "turn every accelerometer over at rest (plus and minus 1 g) to check its gain and its zero"
                    .into()
            }
            Self::Strike => {
                "strike all accelerometers at the same time, at the beginning and at the end of a record, to check their timing"
                    .into()
            }
        }
    }

    /// Returns the factor on every motion of the record at a frequency, Hz.
    pub(super) fn gain(&self, f_hz: f64) -> f64 {
        match self {
            Self::Road(times) => *times,
            Self::Part { part, level } => level * part.gain(f_hz),
            Self::Longer(_)
            | Self::Forces(_)
            | Self::Beside(_)
            | Self::KnownMass { .. }
            | Self::TurnOver
            | Self::Strike => 1.0,
        }
    }

    /// Returns the number of records of the present length in the measurement.
    pub(super) fn repeats(&self) -> f64 {
        match self {
            Self::Longer(times) => *times,
            _ => 1.0,
        }
    }
}

/// Returns the further measurements that are possible with this frame, least effort first.
pub(super) fn measurements(frame: &MotionFrame, best: &MotionFit) -> Vec<Measurement> {
    let sensors = || {
        let own = frame.vehicle.sensors.iter();
        own.filter(|s| s.measures == Measures::Acceleration && frame.bodies.contains(&s.at.body))
    };
    let mut out = Vec::new();
    if sensors().next().is_some() {
        out.extend([Measurement::TurnOver, Measurement::Strike]);
    }
    out.push(Measurement::Longer(LONGER));
    out.extend(ROADS.iter().map(|s| Measurement::Road(*s)));
    out.extend(parts(frame, &best.design));
    let missing: Vec<String> = (frame.vehicle.wheels.iter())
        .filter(|w| frame.bodies.contains(&w.at.body) && !frame.data.has(&w.channel))
        .map(|w| w.channel.clone())
        .collect();
    if !missing.is_empty() {
        out.push(Measurement::Forces(missing));
    }
    for &body in frame
        .bodies
        .iter()
        .filter(|&&b| !frame.vehicle.is_witness(b))
    {
        let own: Vec<Point> = sensors()
            .filter(|s| s.at.body == body)
            .map(|s| s.at)
            .collect();
        let n = own.len() as f64;
        if n > 0.0 {
            // The place is the centre of the existing sensors, so that each of them contributes.
            out.push(Measurement::Beside(Point {
                body,
                x: own.iter().map(|p| p.x).sum::<f64>() / n,
                y: own.iter().map(|p| p.y).sum::<f64>() / n,
            }));
        }
        let mass = best.values.get(frame.vehicle.inertia_index(body, 0, 0));
        let sprung = frame.vehicle.bodies.get(body).is_some_and(|b| b.sprung);
        if let (true, true, Some(&mass)) = (sprung, is_driven(&best.design), mass)
            && mass > 0.0
        {
            out.push(Measurement::KnownMass {
                body,
                mass: one_digit(MASS_SHARE * mass),
            });
        }
    }
    out
}

/// Returns whether an outside force sets the scale of masses and springs.
pub(super) fn is_driven(design: &Design) -> bool {
    let mut targets = design.equations.iter().flat_map(|e| &e.target);
    targets.any(|t| t.norm_sqr() > 0.0)
}

/// Parts of the band with the factor that keeps the accelerations as large as they are.
fn parts(frame: &MotionFrame, design: &Design) -> Vec<Measurement> {
    /// No shaker brings out a part of the band by more than this.
    const LOUDEST: f64 = 10.0;
    let low = frame.band.low_hz.max(1e-3 * frame.band.high_hz);
    let edge = |k: usize| low * (frame.band.high_hz / low).powf(k as f64 / PARTS as f64);
    let power = |gain: &dyn Fn(f64) -> f64| -> f64 {
        let of = |bins: &[rustfft::num_complex::Complex64]| -> f64 {
            (bins.iter().zip(&design.f_hz))
                .map(|(b, f)| b.norm_sqr() * gain(*f).powi(2))
                .sum()
        };
        let own = |c: &str| frame.is_sensor(c);
        let channels = design.channels.iter().filter(|c| own(&c.name));
        channels.map(|c| of(&c.bins)).sum()
    };
    let whole = power(&|_| 1.0);
    (0..PARTS)
        .filter_map(|k| {
            let part = Band {
                low_hz: edge(k),
                high_hz: edge(k + 1),
            };
            let level = (whole / power(&|f| part.gain(f))).sqrt();
            (level.is_finite() && level > 0.0).then_some(Measurement::Part {
                part,
                level: level.min(LOUDEST),
            })
        })
        .collect()
}

/// Returns a mass rounded to one digit, as it is applied in practice.
fn one_digit(x: f64) -> f64 {
    let unit = 10f64.powf(x.log10().floor());
    (x / unit).round() * unit
}
