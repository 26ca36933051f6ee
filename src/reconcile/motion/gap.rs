//! Gap of a vehicle model: residual of the equations over the measured quantity, within the frequency band.

use super::corrections::{adjustments, lines};
use super::design::{Bins, Design, design, measured_quantity, size};
use super::fit::held_parameters;
use super::floor::{Floor, fit_without_nuisance, floors};
use super::frame::MotionFrame;
use super::gap_profile::{GapProfile, gap_profile};
use super::motion_fit::MotionFit;
use super::noise::{BANDS, band_of};
use crate::reconcile::checks::Fall;
use crate::series::channels::Channels;
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::layout::Vehicle;
use crate::vehicle::stretch::slow_stretches;
use serde::Serialize;

/// Gap of one equation.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationGap {
    /// Name of the equation, such as `body b`.
    pub name: String,
    /// Residual over measured quantity.
    pub gap: f64,
    /// Expected residual from sensor noise and tolerances, over the measured quantity.
    pub floor: f64,
    /// Gap by frequency band: upper edge in Hz, gap.
    pub by_band: Vec<[f64; 2]>,
    /// Gap over time and amplitude.
    pub profile: GapProfile,
}

/// Gap of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordGap {
    /// Root mean square gap over equations.
    pub gap: f64,
    /// Squared expected residual of a complete model, mean over equations.
    pub floor: Floor,
    /// Effective number of frequencies in the squared residual: `(sum p)^2 / sum p^2` over frequencies and equations, half of them for white noise.
    pub frequencies: f64,
    /// Gap by equation.
    pub equations: Vec<EquationGap>,
    /// Parameters of the compared vehicle.
    pub values: Vec<f64>,
    /// Compared vehicle.
    pub vehicle: Vehicle,
}

impl RecordGap {
    /// Returns the reduction of the squared gap, from the gap `without` an effect to this gap.
    ///
    /// White noise of gap g leaves `s^2 = g^2 / (2 N)` in each part, real or imaginary, of N frequencies.
    /// A fall d has the standard error `2 s sqrt(d)`. If an effect removes only noise, d is about 2 s^2. With the effective number n of frequencies
    /// of the residual, N = 2 n.
    pub(super) fn fall_from(&self, without: &Self) -> Fall {
        let by = without.gap.powi(2) - self.gap.powi(2);
        let part = self.gap.powi(2) / (4.0 * self.frequencies.max(1.0));
        Fall {
            by,
            error: 2.0 * (part * by.max(part)).sqrt(),
        }
    }
}

/// Data that a gap is computed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Proof {
    /// A record that no parameter was fitted to.
    HeldOut,
    /// Segments of the fitted record, each with the parameters fitted to the other segments.
    CrossValidated,
    /// Fitted record itself, which is too short to be cut in two.
    Fitted,
}

impl Proof {
    /// Returns the text for reports, as in "gap on ..".
    pub fn words(self) -> &'static str {
        match self {
            Self::HeldOut => "held-out data",
            Self::CrossValidated => {
                "segments of the record, each with parameters from the other segments (cross-validated)"
            }
            Self::Fitted => "the fitted record itself",
        }
    }
}

/// Largest number of segments of a cross-validation.
const SEGMENTS: usize = 5;
/// Smallest number of periods of the lower band edge in a segment.
const PERIODS: f64 = 8.0;

/// Returns the kind of data that the gaps of a frame are computed on.
pub fn proof(frame: &MotionFrame, fit: &MotionFit) -> Proof {
    match (frame.hold_out.is_some(), n_segments(frame, fit)) {
        (true, _) => Proof::HeldOut,
        (false, 2..) => Proof::CrossValidated,
        _ => Proof::Fitted,
    }
}

fn n_segments(frame: &MotionFrame, fit: &MotionFit) -> usize {
    let m = &fit.design.motion;
    let seconds = m.n_samples() as f64 / m.rate_hz;
    let n = (seconds * frame.band.low_hz.max(0.1) / PERIODS) as usize;
    n.min(SEGMENTS)
}

/// Returns the gap of a fit on the data that [`proof`] selects.
pub fn proof_gap(frame: &MotionFrame, fit: &MotionFit) -> Option<RecordGap> {
    match (proof(frame, fit), &frame.hold_out) {
        (Proof::HeldOut, Some(record)) => record_gap(frame, fit, record),
        (Proof::CrossValidated, _) => cross_validated_gap(frame, fit),
        _ => fitted_gap(frame, fit),
    }
}

/// Returns the gap on the fitted record.
pub fn fitted_gap(frame: &MotionFrame, fit: &MotionFit) -> Option<RecordGap> {
    let quiet = design_without_lines(fit);
    let d = quiet.as_ref().unwrap_or(&fit.design);
    let values = plain_values(frame, fit, &[d]);
    Some(gap_of(frame, fit, &[d], d, values))
}

/// Returns the design of a fit without its mains lines; `None` if the fit has no mains lines.
fn design_without_lines(fit: &MotionFit) -> Option<Design> {
    let lines = lines(&fit.parts);
    (!lines.is_empty()).then(|| fit.design.without_lines(&lines))
}

/// Returns the gap of a record with the model of a fit. The parameters are estimated again on the fitted record, without nuisance. The gap is then
/// the gap that `identify` would leave.
///
/// If a mass or spring changed during the fitted record, another record has its former or its later value. The value with the smaller gap is used.
pub fn record_gap(frame: &MotionFrame, fit: &MotionFit, record: &Channels) -> Option<RecordGap> {
    let quiet = design_without_lines(fit);
    let learnt = quiet.as_ref().unwrap_or(&fit.design);
    let lines = lines(&fit.parts);
    let values = plain_values(frame, fit, &[learnt]);
    let v = &fit.assembled.vehicle;
    let vehicles: Vec<Vehicle> = if v.changes() {
        [f64::MIN, f64::MAX]
            .into_iter()
            .map(|at_s| {
                let mut v = v.clone();
                v.settle_changes(at_s);
                v
            })
            .collect()
    } else {
        vec![v.clone()]
    };
    vehicles
        .into_iter()
        .filter_map(|v| {
            let adjust = Adjustment::without_slips(&adjustments(frame, &fit.parts));
            let slow = slow_stretches(&v, &values, record, &adjust);
            let mut d = design(frame, &v, record, &adjust, slow).ok()?;
            if !lines.is_empty() {
                d = d.without_lines(&lines);
            }
            Some(gap_of(frame, fit, &[learnt], &d, values.clone()))
        })
        .min_by(|a, b| a.gap.total_cmp(&b.gap))
}

/// Returns the gap of the fitted record cut into segments, each computed with the parameters fitted to the other segments.
fn cross_validated_gap(frame: &MotionFrame, fit: &MotionFit) -> Option<RecordGap> {
    let adjust = adjustments(frame, &fit.parts);
    let n = n_segments(frame, fit);
    let mut segments = fit.design.segments(frame, &adjust, n);
    let lines = lines(&fit.parts);
    if !lines.is_empty() {
        segments
            .iter_mut()
            .for_each(|d| *d = d.without_lines(&lines));
    }
    let gaps: Vec<RecordGap> = (0..segments.len())
        .map(|k| {
            let others: Vec<&Design> = (segments.iter().enumerate())
                .filter(|(i, _)| *i != k)
                .map(|(_, d)| d)
                .collect();
            let values = plain_values(frame, fit, &others);
            gap_of(frame, fit, &others, &segments[k], values)
        })
        .collect();
    combine_gaps(frame, fit, &gaps)
}

/// Combines the gaps of segments into one gap. Values, bands and profile are computed on the whole record.
fn combine_gaps(frame: &MotionFrame, fit: &MotionFit, gaps: &[RecordGap]) -> Option<RecordGap> {
    let mut whole = fitted_gap(frame, fit)?;
    let rms = |of: &dyn Fn(&RecordGap) -> f64| {
        (gaps.iter().map(|g| of(g).powi(2)).sum::<f64>() / gaps.len().max(1) as f64).sqrt()
    };
    if gaps.is_empty() {
        return None;
    }
    for (i, e) in whole.equations.iter_mut().enumerate() {
        let own = |g: &RecordGap| g.equations.get(i).map_or(0.0, |e| e.gap);
        e.gap = rms(&own);
        e.floor = rms(&|g: &RecordGap| g.equations.get(i).map_or(0.0, |e| e.floor));
    }
    whole.gap = rms(&|g| g.gap);
    whole.frequencies = gaps.iter().map(|g| g.frequencies).sum();
    whole.floor = Floor::mean(&gaps.iter().map(|g| g.floor).collect::<Vec<_>>());
    Some(whole)
}

fn gap_of(
    frame: &MotionFrame,
    fit: &MotionFit,
    learnt: &[&Design],
    d: &Design,
    values: Vec<f64>,
) -> RecordGap {
    let left = d.residual(&values);
    let floor = floors(frame, &fit.parts, learnt, d, &values, &fit.free);
    let equations: Vec<EquationGap> = left
        .iter()
        .enumerate()
        .map(|(i, l)| equation_gap(frame, d, i, l, &values, floor[i].expected_residual()))
        .collect();
    let mean = equations.iter().map(|e| e.gap.powi(2)).sum::<f64>() / equations.len().max(1) as f64;
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, l) in left.iter().enumerate() {
        let whole = size(&measured_quantity(d, i, &values))
            .max(f64::MIN_POSITIVE)
            .powi(2);
        for v in l {
            let power = v.norm_sqr() / whole;
            sum += power;
            squares += power * power;
        }
    }
    RecordGap {
        gap: mean.sqrt(),
        frequencies: if squares > 0.0 {
            sum * sum / squares
        } else {
            1.0
        },
        floor: Floor::mean(&floor),
        values,
        vehicle: d.vehicle.clone(),
        equations,
    }
}

fn equation_gap(
    frame: &MotionFrame,
    d: &Design,
    equation: usize,
    left: &Bins,
    values: &[f64],
    floor: f64,
) -> EquationGap {
    let there = measured_quantity(d, equation, values);
    let whole = size(&there).max(f64::MIN_POSITIVE);
    let mut power = vec![0.0; BANDS];
    let mut edge = [0.0; BANDS];
    for (k, v) in left.iter().enumerate() {
        let b = band_of(frame, d.f_hz[k]);
        power[b] += v.norm_sqr();
        edge[b] = d.f_hz[k];
    }
    EquationGap {
        name: d.equations[equation].name.clone(),
        gap: size(left) / whole,
        floor,
        profile: gap_profile(left, &there, &d.f_hz, d.motion.rate_hz, d.motion.start_s),
        by_band: edge
            .iter()
            .zip(&power)
            .filter(|(e, _)| **e > 0.0)
            .map(|(e, p)| [*e, p.sqrt() / whole])
            .collect(),
    }
}

/// Returns the parameters of a fit's model with the smallest gap. They are from least squares on `designs`, without nuisance columns, with equal
/// weights of all equations.
fn plain_values(frame: &MotionFrame, fit: &MotionFit, designs: &[&Design]) -> Vec<f64> {
    let held = held_parameters(frame, &fit.assembled.vehicle, &fit.design);
    let fixed: Vec<f64> = held.iter().map(|v| v.unwrap_or(0.0)).collect();
    let target: Vec<Vec<Bins>> = designs
        .iter()
        .map(|d| {
            let negative = |r: Bins| r.into_iter().map(|v| -v).collect();
            d.residual(&fixed).into_iter().map(negative).collect()
        })
        .collect();
    let x = fit_without_nuisance(designs, &fit.free, &target);
    let mut out: Vec<f64> = held.iter().map(|h| h.unwrap_or(f64::NAN)).collect();
    fit.free.iter().zip(&x).for_each(|(&i, x)| out[i] = *x);
    if x.iter().all(|x| x.is_finite()) {
        out
    } else {
        fit.values.clone()
    }
}
