//! Equations of motion of a record as transforms within the band: columns by parameter, channels by name.

use super::frame::MotionFrame;
use crate::series::channels::Channels;
use crate::series::spectrum::Band;
use crate::series::window::WindowedTransform;
use crate::vehicle::adjustment::{Adjustment, Lag};
use crate::vehicle::equations::equations;
use crate::vehicle::layout::{Measures, Vehicle};
use crate::vehicle::motion::{Motion, Treatment, VehicleError, motion};
use crate::vehicle::treatment::SlowStretch;
use rustfft::num_complex::Complex64;

/// Transform of a signal within the band, with a value for each bin.
pub type Bins = Vec<Complex64>;

/// One equation of a compared body.
#[derive(Clone, Debug)]
pub struct BinEquation {
    /// Name, such as `body b`.
    pub name: String,
    /// Body.
    pub body: usize,
    /// Motion of the body.
    pub motion: usize,
    /// Parameter index and column.
    pub columns: Vec<(usize, Bins)>,
    /// Measured outside force.
    pub target: Bins,
}

/// A measured channel, corrected as the design asks.
#[derive(Clone, Debug)]
pub struct BinChannel {
    /// Name.
    pub name: String,
    /// Transform of the corrected channel within the band.
    pub bins: Bins,
    /// Noise of one sample of the corrected channel, one sd; `None` if not declared.
    pub noise: Option<f64>,
    /// Gain by which the readings were divided.
    pub gain: f64,
    /// Corrected low-pass filters. Their correction amplifies the noise like the readings.
    pub lags: Vec<Lag>,
}

/// Data of a record for a fit: equations, channels, vehicle and motion.
#[derive(Clone, Debug)]
pub struct Design {
    /// Frequencies, Hz.
    pub f_hz: Vec<f64>,
    /// Equations of the compared bodies.
    pub equations: Vec<BinEquation>,
    /// Channels of the compared bodies.
    pub channels: Vec<BinChannel>,
    /// Factor of thinning: number of samples of the record for each sample of the thinned signals.
    pub thinning: f64,
    /// Time of the record's first sample, s.
    pub record_start_s: f64,
    /// Frequency band of the bins.
    pub band: Band,
    /// The vehicle.
    pub vehicle: Vehicle,
    /// Motion of the vehicle.
    pub motion: Motion,
}

/// Sample rate of the thinned signals, as a multiple of the upper band edge. The aliased share is below 1e-3.
const RATE_SHARE: f64 = 3.0;

/// Returns the design of a vehicle in a record, with corrected channels.
///
/// # Errors
/// The errors of [`motion`].
pub fn design(
    frame: &MotionFrame,
    vehicle: &Vehicle,
    record: &Channels,
    adjust: &[Adjustment],
    slow: Vec<SlowStretch>,
) -> Result<Design, VehicleError> {
    let mut keep = 1;
    while record.rate_hz / (2 * keep) as f64 >= RATE_SHARE * frame.band.high_hz {
        keep *= 2;
    }
    let treatment = Treatment {
        band: frame.band,
        keep_every: keep,
        adjust: adjust.to_vec(),
        slow,
        // All sets use the same length, with or without nonlinear terms.
        settle_s: Some(1.5 * frame.band.settling_s()),
    };
    let motion = motion(vehicle, record, &treatment)?;
    let mut out = of_motion(frame, vehicle, motion, adjust)?;
    out.thinning = keep as f64;
    out.record_start_s = record.start_s;
    Ok(out)
}

/// Returns the design of a stretch of a motion.
fn of_motion(
    frame: &MotionFrame,
    vehicle: &Vehicle,
    motion: Motion,
    adjust: &[Adjustment],
) -> Result<Design, VehicleError> {
    let mut window = WindowedTransform::new(motion.n_samples(), motion.rate_hz, frame.band);
    let mut out = Vec::new();
    for e in equations(vehicle, &motion) {
        let Some((body, index)) = body_of(vehicle, &e.name) else {
            continue;
        };
        if !frame.bodies.contains(&body) || frame.not_compared.contains(&body) {
            continue;
        }
        out.push(BinEquation {
            columns: e
                .columns
                .iter()
                .map(|(i, c)| (*i, window.bins(c)))
                .collect(),
            target: window.bins(&e.target),
            name: e.name,
            body,
            motion: index,
        });
    }
    // The stated noise is the noise of the readings. If a channel is divided by its gain, its noise is divided as well.
    let gain = |channel: &str| -> f64 {
        let own = adjust.iter().filter(|a| a.channel == channel);
        own.map(|a| a.gain.abs()).product()
    };
    let lags = |channel: &str| Adjustment::of_channel(adjust, channel).map_or(vec![], |a| a.lags);
    let mut channels = Vec::new();
    for (s, signal) in vehicle.sensors.iter().zip(&motion.sensors) {
        if frame.bodies.contains(&s.at.body) {
            let gain = gain(&s.channel);
            let noise = frame
                .noise_acc
                .filter(|_| s.measures == Measures::Acceleration);
            channels.push(BinChannel {
                name: s.channel.clone(),
                bins: window.bins(signal),
                noise: noise.map(|n| n / gain),
                gain,
                lags: lags(&s.channel),
            });
        }
    }
    for (w, signal) in vehicle.wheels.iter().zip(&motion.forces) {
        if let (true, Some(signal)) = (frame.bodies.contains(&w.at.body), signal) {
            let gain = gain(&w.channel);
            channels.push(BinChannel {
                name: w.channel.clone(),
                bins: window.bins(signal),
                noise: frame.noise_force.map(|n| n / gain),
                gain,
                lags: lags(&w.channel),
            });
        }
    }
    if out.is_empty() {
        return Err(VehicleError::NoEquation(vehicle.name.clone()));
    }
    Ok(Design {
        f_hz: window.f_hz,
        equations: out,
        channels,
        thinning: 1.0,
        record_start_s: 0.0,
        band: frame.band,
        vehicle: vehicle.clone(),
        motion,
    })
}

/// Returns the body and motion of an equation by its name.
fn body_of(vehicle: &Vehicle, name: &str) -> Option<(usize, usize)> {
    vehicle.bodies.iter().enumerate().find_map(|(b, body)| {
        let letters = body.shape.letters();
        letters.iter().enumerate().find_map(|(j, letter)| {
            let own = format!(
                "body {}{}{letter}",
                body.name,
                if j > 0 { " about " } else { "" }
            );
            (own == name).then_some((b, j))
        })
    })
}

impl Design {
    /// Returns whether a parameter is in any equation.
    pub fn has(&self, parameter: usize) -> bool {
        self.equations
            .iter()
            .any(|e| e.columns.iter().any(|c| c.0 == parameter))
    }

    /// Returns the designs of `n` consecutive stretches of equal length; empty if they are too short for the band.
    pub fn segments(&self, frame: &MotionFrame, adjust: &[Adjustment], n: usize) -> Vec<Self> {
        let length = self.motion.n_samples() / n.max(1);
        let parts = (0..n).map(|k| {
            let motion = self.motion.stretch_of(k * length, length);
            let mut d = of_motion(frame, &self.vehicle, motion, adjust).ok()?;
            d.thinning = self.thinning;
            d.record_start_s = self.record_start_s;
            Some(d)
        });
        parts.collect::<Option<Vec<_>>>().unwrap_or_default()
    }

    /// Returns the design with zeros in all bins within two and a half bins of the lines. A window spreads a line over this width.
    pub fn without_lines(&self, lines_hz: &[f64]) -> Self {
        const BINS: f64 = 2.5;
        let mut out = self.clone();
        let length =
            WindowedTransform::new(self.motion.n_samples(), self.motion.rate_hz, self.band)
                .step_hz();
        let near = |f: f64| lines_hz.iter().any(|l| (f - l).abs() <= BINS * length);
        let quiet: Vec<usize> = (0..out.f_hz.len()).filter(|&k| near(out.f_hz[k])).collect();
        let silence = |bins: &mut Bins| {
            for &k in &quiet {
                if let Some(b) = bins.get_mut(k) {
                    *b = Complex64::default();
                }
            }
        };
        for e in &mut out.equations {
            e.columns.iter_mut().for_each(|c| silence(&mut c.1));
            silence(&mut e.target);
        }
        out.channels.iter_mut().for_each(|c| silence(&mut c.bins));
        out
    }

    /// Returns the samples of a channel within the band.
    pub fn signal(&self, channel: &str) -> Option<&[f64]> {
        self.motion.signal(&self.vehicle, channel)
    }

    /// Returns the mean over the compared stretch of a function of the record's time, s.
    pub fn mean_done(&self, of: impl Fn(f64) -> f64) -> f64 {
        let n = self.motion.n_samples().max(1);
        let at = |i: usize| self.motion.start_s + i as f64 / self.motion.rate_hz;
        (0..n).map(|i| of(at(i))).sum::<f64>() / n as f64
    }

    /// Returns the begin and end of the compared stretch, s of the record's time.
    pub fn span_s(&self) -> [f64; 2] {
        let m = &self.motion;
        [m.start_s, m.start_s + m.n_samples() as f64 / m.rate_hz]
    }

    /// Returns the gain by which the readings of a channel were divided.
    pub fn gain_of(&self, channel: &str) -> f64 {
        let c = self.channels.iter().find(|c| c.name == channel);
        c.map_or(1.0, |c| c.gain)
    }

    /// Returns the residual of every equation: sum of parameter times column, less target.
    pub fn residual(&self, values: &[f64]) -> Vec<Bins> {
        self.equations
            .iter()
            .map(|e| {
                let mut r: Bins = e.target.iter().map(|t| -t).collect();
                for (i, column) in &e.columns {
                    let v = values
                        .get(*i)
                        .copied()
                        .filter(|v| v.is_finite())
                        .unwrap_or(0.0);
                    if v != 0.0 {
                        r.iter_mut().zip(column).for_each(|(r, c)| *r += c * v);
                    }
                }
                r
            })
            .collect()
    }
}

/// Returns the root of the mean power of a transform times its number of bins. It is comparable between signals of one design.
pub fn size(x: &[Complex64]) -> f64 {
    x.iter().map(|v| v.norm_sqr()).sum::<f64>().sqrt()
}

/// Returns the size of the measured quantity of an equation.
pub fn reference(design: &Design, equation: usize, values: &[f64]) -> f64 {
    size(&measured_quantity(design, equation, values))
}

/// Returns the measured quantity of an equation: the external force, or mass times acceleration if no external force acts.
pub fn measured_quantity(design: &Design, equation: usize, values: &[f64]) -> Bins {
    let e = &design.equations[equation];
    if size(&e.target) > 0.0 {
        return e.target.clone();
    }
    let inertias = design.vehicle.term_index(0, 0);
    let mut sum: Bins = vec![Complex64::default(); design.f_hz.len()];
    for (i, c) in e.columns.iter().filter(|c| c.0 < inertias) {
        let v = values[*i];
        if v.is_finite() {
            sum.iter_mut().zip(c).for_each(|(s, c)| *s += c * v);
        }
    }
    sum
}
