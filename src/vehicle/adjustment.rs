//! Known errors of a channel: gain, timing, a slow filter, a mains line.

use crate::series::align::{delay, remove_lateness};
use crate::series::spectrum::Fourier;
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, SQRT_2};

/// Corrections of a channel: reading(t) = gain . filtered truth(t - lateness(t)).
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustment {
    /// Channel.
    pub channel: String,
    /// Gain by which the channel is divided.
    pub gain: f64,
    /// Time by which the channel is advanced, s.
    pub delay_s: f64,
    /// Added delay by second of the record, s/s: the drift of its clock against the clock of the other channels.
    pub clock: f64,
    /// Steps of the delay: samples that a logger lost or wrote twice.
    pub slips: Vec<Slip>,
    /// Low-passes of this channel alone.
    pub lags: Vec<Lag>,
    /// Mains lines in the channel, Hz. These frequencies are removed from every channel of a record, so that equations between them remain valid.
    pub lines_hz: Vec<f64>,
}

/// A step of a channel's delay at a time of one record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// Time of the step, s of the record's time.
    pub at_s: f64,
    /// Added delay after the step, s. It is negative if samples were lost.
    pub by_s: f64,
}

/// A low-pass filter. Order 1 is 1 / (1 + i w T). Order 2 is Butterworth's 1 / (1 + i w T sqrt 2 - w^2 T^2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Order, 1 or 2.
    pub order: u8,
    /// T = 1 / (2 pi cut-off), s.
    pub time_s: f64,
}

impl Lag {
    /// Returns the ratio of the true value to the reading at an angular frequency.
    pub fn inverse_response(&self, w: f64) -> Complex64 {
        let x = w * self.time_s;
        match self.order {
            1 => Complex64::new(1.0, x),
            _ => Complex64::new(1.0 - x * x, SQRT_2 * x),
        }
    }

    /// Returns the delay of slow motion by the low-pass, s.
    pub fn delay_s(&self) -> f64 {
        self.time_s * if self.order == 1 { 1.0 } else { SQRT_2 }
    }
}

impl Adjustment {
    /// Returns an adjustment without any error.
    pub fn none(channel: &str) -> Self {
        Self {
            channel: channel.to_owned(),
            gain: 1.0,
            delay_s: 0.0,
            clock: 0.0,
            slips: vec![],
            lags: vec![],
            lines_hz: vec![],
        }
    }

    /// Adds the corrections of `other` to these corrections.
    pub fn join(&mut self, other: &Self) {
        self.gain *= other.gain;
        self.delay_s += other.delay_s;
        self.clock += other.clock;
        self.slips.extend(&other.slips);
        self.lags.extend(&other.lags);
        self.lines_hz.extend(&other.lines_hz);
    }

    /// Returns all corrections of a channel in one. `None` if there are none.
    pub fn of_channel(list: &[Self], name: &str) -> Option<Self> {
        let mut own = list.iter().filter(|a| a.channel == name);
        let mut out = own.next()?.clone();
        own.for_each(|a| out.join(a));
        Some(out)
    }

    /// Returns the corrections for another record, without slips, which occurred only in the fitted record.
    pub fn without_slips(list: &[Self]) -> Vec<Self> {
        let kept = |a: &Self| Self {
            slips: vec![],
            ..a.clone()
        };
        list.iter().map(kept).collect()
    }

    /// Returns the delay of the channel without `delay_s` (s), at a time of the record that began at `start_s`.
    fn moving_lateness(&self, t_s: f64, start_s: f64) -> f64 {
        let slipped = self.slips.iter().filter(|s| t_s >= s.at_s);
        self.clock * (t_s - start_s) + slipped.map(|s| s.by_s).sum::<f64>()
    }

    /// Returns the delay of the channel for slow motion, s, at a time of the record that began at `start_s`.
    pub fn lateness(&self, t_s: f64, start_s: f64) -> f64 {
        let lags: f64 = self.lags.iter().map(Lag::delay_s).sum();
        self.delay_s + lags + self.moving_lateness(t_s, start_s)
    }

    /// Returns the ratio of the true value to the reading at an angular frequency, without corrections that change with time.
    pub fn inverse_response(&self, w: f64) -> Complex64 {
        let delayed = Complex64::from_polar(1.0 / self.gain.abs(), w * self.delay_s);
        delayed * self.gain.signum() * self.lags_undone(w)
    }

    fn lags_undone(&self, w: f64) -> Complex64 {
        self.lags.iter().map(|l| l.inverse_response(w)).product()
    }

    /// Returns the samples with corrected clock drift and slips. Without these, it returns the given samples.
    pub fn correct_clock(&self, x: &[f64], start_s: f64, rate_hz: f64) -> Option<Vec<f64>> {
        if self.clock == 0.0 && self.slips.is_empty() {
            return None;
        }
        let late = |i: usize| self.moving_lateness(start_s + i as f64 / rate_hz, start_s);
        Some(remove_lateness(x, rate_hz, late))
    }

    /// Returns the corrected samples. Their mean is the mean of the readings, divided by the gain.
    pub fn correct_samples(&self, x: &[f64], start_s: f64, rate_hz: f64) -> Vec<f64> {
        let mut out = self
            .correct_clock(x, start_s, rate_hz)
            .unwrap_or_else(|| x.to_vec());
        if self.delay_s != 0.0 {
            out = delay(&out, rate_hz, -self.delay_s);
        }
        if !self.lags.is_empty() {
            let mean = crate::series::detrend::mean(&out);
            out.iter_mut().for_each(|v| *v -= mean);
            let mut fourier = Fourier::default();
            let s = fourier
                .spectrum(&out, rate_hz)
                .times(|f: f64| self.lags_undone(2.0 * PI * f));
            out = fourier.samples(&s, 1);
            out.iter_mut().for_each(|v| *v += mean);
        }
        out.iter_mut().for_each(|v| *v /= self.gain);
        out
    }
}
