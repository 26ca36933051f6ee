//! How large the disagreement is: residual of the equations over what was measured, in the band.

use super::change::Change;
use super::course::{Course, course};
use super::design::{Bins, Design, design, size};
use super::fit::{MotionFit, adjustments, held, parameter_column, slices};
use super::frame::MotionFrame;
use super::gls::{PriorColumn, solved};
use super::noise::{BANDS, Background, Whitener, band_of, covariance};
use super::response::responses;
use crate::series::channels::Channels;
use crate::vehicle::layout::Vehicle;
use crate::vehicle::stretch::slow_stretches;
use rustfft::num_complex::Complex64;

/// The gap of one equation.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationGap {
    /// Such as `body b`.
    pub name: String,
    /// Residual over measured quantity.
    pub gap: f64,
    /// What sensor noise and tolerances leave.
    pub floor: f64,
    /// The same by band of frequency: upper edge in Hz, gap.
    pub by_band: Vec<[f64; 2]>,
    /// Over time and amplitude.
    pub course: Course,
}

/// The gap of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordGap {
    /// Root mean square over equations.
    pub gap: f64,
    /// Of floors.
    pub floor: f64,
    /// Equations.
    pub equations: Vec<EquationGap>,
    /// Parameters of the vehicle that was compared.
    pub values: Vec<f64>,
    /// The vehicle that was compared.
    pub vehicle: Vehicle,
}

/// Size of the measured quantity of an equation.
pub fn reference(design: &Design, equation: usize, values: &[f64]) -> f64 {
    size(&measured(design, equation, values))
}

/// The measured quantity of an equation: its outside force, or mass times acceleration where none acts.
fn measured(design: &Design, equation: usize, values: &[f64]) -> Bins {
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

/// Root mean square over equations of what a fit leaves over what was measured, nuisance at its estimate.
pub fn share_left(fit: &MotionFit) -> f64 {
    let d = &fit.design;
    let sum: f64 = fit
        .left
        .iter()
        .enumerate()
        .map(|(i, l)| (size(l) / reference(d, i, &fit.values).max(f64::MIN_POSITIVE)).powi(2))
        .sum();
    (sum / fit.left.len().max(1) as f64).sqrt()
}

/// The share that sensor noise and declared tolerances explain on the fitted record, in the sense of [`share_left`].
pub fn share_floor(frame: &MotionFrame, fit: &MotionFit) -> f64 {
    let f = floors(frame, &fit.design, &fit.values, false);
    let sum: f64 = f
        .iter()
        .enumerate()
        .map(|(i, f)| (f / reference(&fit.design, i, &fit.values).max(f64::MIN_POSITIVE)).powi(2))
        .sum();
    (sum / f.len().max(1) as f64).sqrt()
}

/// Expected size of the residual of each equation from sensor noise and, where asked, declared tolerances.
fn floors(frame: &MotionFrame, d: &Design, values: &[f64], with_tolerances: bool) -> Vec<f64> {
    let h = responses(d, values);
    let s = covariance(frame, d, &h, &Background::default());
    let n = d.equations.len();
    (0..n)
        .map(|i| {
            let noise: f64 = s.iter().map(|s| s[i * n + i].re).sum();
            let mut loose = 0.0;
            if with_tolerances {
                for (c, channel) in d.channels.iter().enumerate() {
                    for (k, b) in channel.bins.iter().enumerate() {
                        let w = 2.0 * std::f64::consts::PI * d.f_hz[k];
                        let size = (h[i][c][k] * b).norm_sqr();
                        loose += size
                            * (frame.gain_tolerance.powi(2) + (frame.sync_tolerance_s * w).powi(2));
                    }
                }
            }
            (noise + loose).sqrt()
        })
        .collect()
}

/// The gap of a record under the model of a fit, its parameters found anew on the fitted record without the help of nuisance: what
/// `identify` would leave.
///
/// A mass that changed during the fitted record is taken as present or absent in another one, whichever fits.
pub fn record_gap(frame: &MotionFrame, fit: &MotionFit, record: &Channels) -> Option<RecordGap> {
    let values = plain_values(frame, fit);
    let stepped = fit.parts.iter().any(|p| matches!(p.shape, Change::Step(_)));
    let own = std::ptr::eq(record, &frame.data);
    if !stepped || own {
        return gap_with(frame, fit, record, &fit.assembled.vehicle, &values);
    }
    [f64::MIN, f64::MAX]
        .into_iter()
        .filter_map(|at_s| {
            let mut v = fit.assembled.vehicle.clone();
            v.steps.iter_mut().for_each(|s| s.at_s = at_s);
            v.steps.iter_mut().for_each(|s| s.over_s = 0.0);
            gap_with(frame, fit, record, &v, &values)
        })
        .min_by(|a, b| a.gap.total_cmp(&b.gap))
}

fn gap_with(
    frame: &MotionFrame,
    fit: &MotionFit,
    record: &Channels,
    vehicle: &Vehicle,
    values: &[f64],
) -> Option<RecordGap> {
    let adjust = adjustments(frame, &fit.parts);
    let slow = slow_stretches(vehicle, values, record, &adjust);
    let d = design(frame, vehicle, record, &adjust, slow).ok()?;
    let left = d.residual(values);
    let floor = floors(frame, &d, values, true);
    let mut equations = Vec::new();
    for (i, l) in left.iter().enumerate() {
        let there = measured(&d, i, values);
        let whole = size(&there).max(f64::MIN_POSITIVE);
        let mut power = vec![0.0; BANDS];
        let mut edge = [0.0; BANDS];
        for (k, v) in l.iter().enumerate() {
            let b = band_of(frame, d.f_hz[k]);
            power[b] += v.norm_sqr();
            edge[b] = d.f_hz[k];
        }
        equations.push(EquationGap {
            name: d.equations[i].name.clone(),
            gap: size(l) / whole,
            floor: floor[i] / whole,
            course: course(l, &there, &d.f_hz, d.motion.rate_hz, d.motion.start_s),
            by_band: edge
                .iter()
                .zip(&power)
                .filter(|(e, _)| **e > 0.0)
                .map(|(e, p)| [*e, p.sqrt() / whole])
                .collect(),
        });
    }
    let mean = |of: &dyn Fn(&EquationGap) -> f64| {
        (equations.iter().map(|e| of(e).powi(2)).sum::<f64>() / equations.len().max(1) as f64)
            .sqrt()
    };
    Some(RecordGap {
        gap: mean(&|e| e.gap),
        floor: mean(&|e| e.floor),
        values: values.to_vec(),
        vehicle: vehicle.clone(),
        equations,
    })
}

/// Parameters of a fit's model by least squares without nuisance, all equations alike: those of the smallest gap.
fn plain_values(frame: &MotionFrame, fit: &MotionFit) -> Vec<f64> {
    let d = &fit.design;
    let n = d.equations.len();
    let held = held(frame, &fit.assembled.vehicle, d);
    let mut s = vec![Complex64::default(); n * n];
    for i in 0..n {
        s[i * n + i] = Complex64::new(1.0, 0.0);
    }
    let whitener = Whitener::of(&vec![s; d.f_hz.len()], n);
    let columns: Vec<PriorColumn> = fit
        .free
        .iter()
        .map(|&i| PriorColumn {
            rows: whitener.rows(&parameter_column(d, i)),
            prior: None,
        })
        .collect();
    let fixed: Vec<f64> = held.iter().map(|v| v.unwrap_or(0.0)).collect();
    let target: Vec<Bins> = d
        .residual(&fixed)
        .into_iter()
        .map(|r| r.into_iter().map(|v| -v).collect())
        .collect();
    let x = solved(&columns, &whitener.rows(&slices(&target))).x;
    let mut out: Vec<f64> = held.iter().map(|h| h.unwrap_or(f64::NAN)).collect();
    fit.free.iter().zip(&x).for_each(|(&i, x)| out[i] = *x);
    if x.iter().all(|x| x.is_finite()) {
        out
    } else {
        fit.values.clone()
    }
}
