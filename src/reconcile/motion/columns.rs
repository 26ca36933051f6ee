//! Columns of the least squares: parameters, faults of channels, and quantities with a declared uncertainty.

use super::change::Change;
use super::design::{Bins, Design};
use super::frame::MotionFrame;
use super::part::{ColumnOf, Part};
use crate::series::spectrum::Fourier;
use crate::series::window::WindowedTransform;
use crate::vehicle::adjustment::Lag;
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, SQRT_2};

/// Returns the contribution of a signal in one channel to every equation.
fn apply_responses(
    responses: &[Vec<Vec<Complex64>>],
    channel: usize,
    signal: &[Complex64],
) -> Vec<Bins> {
    let one = |r: &Vec<Vec<Complex64>>| -> Bins {
        r[channel].iter().zip(signal).map(|(h, a)| h * a).collect()
    };
    responses.iter().map(one).collect()
}

/// Returns the column of one channel in every equation, times a function of angular frequency.
fn channel_column(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    channel: usize,
    factor: impl Fn(f64) -> Complex64,
) -> Vec<Bins> {
    let own = &design.channels[channel].bins;
    let signal: Bins = (own.iter().zip(&design.f_hz))
        .map(|(a, f)| a * factor(2.0 * PI * f))
        .collect();
    apply_responses(responses, channel, &signal)
}

/// Returns the column of one channel's rate of change times a function of the record's time, s.
fn rate_column(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    channel: usize,
    share: impl Fn(f64) -> f64,
) -> Option<Vec<Bins>> {
    let x = design.signal(&design.channels[channel].name)?;
    let m = &design.motion;
    let mut fourier = Fourier::default();
    let rate = fourier
        .spectrum(x, m.rate_hz)
        .times(|f| Complex64::new(0.0, 2.0 * PI * f));
    let shared: Vec<f64> = (fourier.samples(&rate, 1).iter().enumerate())
        .map(|(i, v)| v * share(m.start_s + i as f64 / m.rate_hz))
        .collect();
    let mut window = WindowedTransform::new(m.n_samples(), m.rate_hz, design.band);
    Some(apply_responses(responses, channel, &window.bins(&shared)))
}

/// Returns the cosine and sine columns of a line in one channel, with amplitude one in the readings.
fn line_columns(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    channel: usize,
    hz: f64,
) -> Vec<Vec<Bins>> {
    let m = &design.motion;
    let mut window = WindowedTransform::new(m.n_samples(), m.rate_hz, design.band);
    let gain = design.band.gain(hz);
    [0.0, 0.5 * PI]
        .map(|phase| {
            let wave: Vec<f64> = (0..m.n_samples())
                .map(|i| gain * (2.0 * PI * hz * i as f64 / m.rate_hz - phase).cos())
                .collect();
            apply_responses(responses, channel, &window.bins(&wave))
        })
        .into()
}

/// Returns the columns of a channel fault per unit of its parameter (see [`Part::fault`]). A line has two columns. A change that is not such a fault
/// has no column.
pub fn fault_columns(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    shape: &Change,
    fault: f64,
) -> Vec<Vec<Bins>> {
    let Some(c) = shape
        .channel()
        .and_then(|name| design.channels.iter().position(|x| x.name == name))
    else {
        return vec![];
    };
    let by = |factor: &dyn Fn(f64) -> Complex64| channel_column(design, responses, c, factor);
    match shape {
        Change::Gain { .. } => vec![by(&|_| Complex64::new(1.0 / fault, 0.0))],
        Change::Delay { .. } => vec![by(&|w| Complex64::new(0.0, w))],
        Change::Lag { order, .. } => {
            let lag = Lag {
                order: *order,
                time_s: fault,
            };
            vec![by(&|w| {
                let slope = match order {
                    1 => Complex64::new(0.0, w),
                    _ => Complex64::new(-2.0 * w * w * fault, SQRT_2 * w),
                };
                slope / lag.inverse_response(w)
            })]
        }
        Change::Clock { .. } => {
            let begin = design.record_start_s;
            let column = rate_column(design, responses, c, |t| t - begin);
            column.into_iter().collect()
        }
        Change::Slip { at_s, .. } => {
            let after = |t: f64| f64::from(u8::from(t >= *at_s));
            let column = rate_column(design, responses, c, after);
            column.into_iter().collect()
        }
        Change::Line { hz, .. } => line_columns(design, responses, c, *hz),
        _ => vec![],
    }
}

/// Returns the column of a channel that is late by one second between two times.
pub fn late_between(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    channel: &str,
    times_s: [f64; 2],
) -> Option<Vec<Bins>> {
    let c = design.channels.iter().position(|x| x.name == channel)?;
    let [begin, end] = times_s;
    let between = |t: f64| f64::from(u8::from(t >= begin && t < end));
    rate_column(design, responses, c, between)
}

/// Returns the declared uncertainties as columns with priors (one sd).
pub fn nuisance(
    frame: &MotionFrame,
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    parts: &[Part],
) -> Vec<(ColumnOf, Vec<Bins>, f64)> {
    let mut out = Vec::new();
    for (c, channel) in design.channels.iter().enumerate() {
        let faulty = |is_gain: bool| {
            parts.iter().any(|p| match &p.shape {
                Change::Gain { channel: x } => is_gain && *x == channel.name,
                Change::Delay { channel: x } => !is_gain && *x == channel.name,
                _ => false,
            })
        };
        if frame.gain_tolerance > 0.0 && !faulty(true) {
            let one = |_: f64| Complex64::new(1.0, 0.0);
            out.push((
                ColumnOf::Gain(c),
                channel_column(design, responses, c, one),
                frame.gain_tolerance,
            ));
        }
        if frame.sync_tolerance_s > 0.0 && !faulty(false) {
            let late = |w: f64| Complex64::new(0.0, w);
            out.push((
                ColumnOf::Delay(c),
                channel_column(design, responses, c, late),
                frame.sync_tolerance_s,
            ));
        }
    }
    out
}

/// Returns the equations of a list of columns, one slice for each column.
pub fn slices(column: &[Bins]) -> Vec<&[Complex64]> {
    column.iter().map(Vec::as_slice).collect()
}

/// Returns the column of a parameter in every equation.
pub fn parameter_column(design: &Design, parameter: usize) -> Vec<&[Complex64]> {
    design
        .equations
        .iter()
        .map(|e| {
            e.columns
                .iter()
                .find(|c| c.0 == parameter)
                .map_or(&[] as &[Complex64], |c| c.1.as_slice())
        })
        .collect()
}
