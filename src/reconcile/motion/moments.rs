//! When a body's mass changed: what a step at every moment of a record would take of a residual, all moments in one pass.
//!
//! The band turns a step into a wave whose phase must fit: between moments a few hundredths of a second apart the residual rises and falls,
//! and a coarse grid of moments misses the one that explains.

use super::columns::{parameter_column, slices};
use super::design::{Bins, Design};
use super::fit::held;
use super::floor::even;
use super::frame::MotionFrame;
use super::gls::{Basis, PriorColumn, solved};
use crate::series::window::Windowed;
use crate::vehicle::layout::MassStep;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Share of the record at either end where nothing is looked for: [`super::limits::plausible`] asks for as much.
const END: f64 = 0.1;
/// Of the samples of the thinned record, every so many is a moment: at three samples to a wave of the upper band edge, a tenth of that wave
/// is lost at most, which the fit of the moment finds.
const EVERY: usize = 2;

/// A step with the fall of the squared residual that it brings.
type Fall = (MassStep, f64);

/// The step of a body's mass that explains most of what its vehicle leaves of a record, with its weight and without it, the better one first.
///
/// Equations weigh alike, as at the start of every fit: the moment needs no parameter that was found without the step, and those may be
/// far from any vehicle.
pub fn best_steps(frame: &MotionFrame, d: &Design, body: usize) -> Vec<MassStep> {
    let fixed: Vec<Option<f64>> = held(frame, &d.vehicle, d);
    let whitener = even(d);
    let columns: Vec<PriorColumn> = (0..fixed.len())
        .filter(|&i| fixed[i].is_none() && d.has(i))
        .map(|i| PriorColumn {
            rows: whitener.rows(&parameter_column(d, i)),
            prior: None,
        })
        .collect();
    let values: Vec<f64> = fixed.iter().map(|v| v.unwrap_or(0.0)).collect();
    let target: Vec<Bins> = d
        .residual(&values)
        .into_iter()
        .map(|r| r.into_iter().map(|v| -v).collect())
        .collect();
    let residual = solved(&columns, &whitener.rows(&slices(&target))).residual;
    let Some(equation) = (d.equations.iter()).position(|e| e.body == body && e.motion == 0) else {
        return vec![];
    };
    // What one in a bin of the body's equation makes in the rows.
    let one: Vec<Bins> = (0..d.equations.len())
        .map(|i| vec![Complex64::new(f64::from(u8::from(i == equation)), 0.0); d.f_hz.len()])
        .collect();
    let look = Look {
        design: d,
        body,
        unit: whitener.rows(&slices(&one)),
        rows: std::iter::once(residual.as_slice())
            .chain(Basis::of(&columns).columns().iter().map(Vec::as_slice))
            .map(<[f64]>::to_vec)
            .collect(),
    };
    let mut best: Vec<Fall> = look
        .falls([frame.gravity, 0.0])
        .into_iter()
        .flatten()
        .collect();
    best.sort_by(|a, b| b.1.total_cmp(&a.1));
    best.into_iter().map(|(step, _)| step).collect()
}

/// What a step is looked for in.
struct Look<'a> {
    design: &'a Design,
    body: usize,
    /// Whitened rows of one in every bin of the body's equation.
    unit: Vec<f64>,
    /// The whitened residual, then an orthonormal basis of what the vehicle explains.
    rows: Vec<Vec<f64>>,
}

impl Look<'_> {
    /// The best moment for each acceleration that a step's weight may have.
    ///
    /// The column of a step at t is A + g B, with A and B the transforms of the body's acceleration and of one after t. Going back in time
    /// a sample adds to both; what a column takes is (r . c)^2 / (c . c - sum (q . c)^2), all of them sums over bins.
    fn falls(&self, gravities: [f64; 2]) -> [Option<Fall>; 2] {
        let d = self.design;
        let m = &d.motion;
        let mut best: [Option<Fall>; 2] = [None; 2];
        let Some(a) = m.bodies.get(self.body).and_then(|b| b.first()) else {
            return best;
        };
        let window = Windowed::of(m.n_samples(), m.rate_hz, d.band);
        let (taper, bins) = (window.taper(), d.f_hz.len());
        let along = self.along();
        let weight = self.weights();
        let turn: Vec<Complex64> = (d.f_hz.iter())
            .map(|f| Complex64::from_polar(1.0, 2.0 * PI * f / m.rate_hz))
            .collect();
        let last = taper.len().saturating_sub(1) as f64;
        let mut phase: Vec<Complex64> = (d.f_hz.iter())
            .map(|f| Complex64::from_polar(d.band.gain(*f), -2.0 * PI * f * last / m.rate_hz))
            .collect();
        let (mut moved, mut pressed) = (
            vec![Complex64::default(); bins],
            vec![Complex64::default(); bins],
        );
        let margin = (END * taper.len() as f64) as usize;
        for i in (0..taper.len()).rev() {
            let (w, wa) = (taper[i], taper[i] * a[i]);
            for k in 0..bins {
                moved[k] += phase[k] * wa;
                pressed[k] += phase[k] * w;
                phase[k] *= turn[k];
            }
            if i < margin || i + margin > taper.len() || !i.is_multiple_of(EVERY) {
                continue;
            }
            let dots: Vec<[f64; 2]> = (along.iter())
                .map(|p| [dot(p, &moved), dot(p, &pressed)])
                .collect();
            let norms = norms(&weight, &moved, &pressed);
            for (best, gravity) in best.iter_mut().zip(gravities) {
                let of = |d: &[f64; 2]| d[0] + gravity * d[1];
                let whole = norms[0] + gravity * (2.0 * norms[1] + gravity * norms[2]);
                let known: f64 = dots.iter().skip(1).map(|d| of(d).powi(2)).sum();
                // A column that the vehicle's own explain but for a thousandth says nothing.
                if whole - known < 1e-3 * whole {
                    continue;
                }
                let fall = dots.first().map_or(0.0, |d| of(d).powi(2)) / (whole - known);
                if best.is_none_or(|b| fall > b.1) {
                    let step = MassStep {
                        body: self.body,
                        at_s: m.start_s + i as f64 / m.rate_hz,
                        over_s: 0.0,
                        gravity,
                    };
                    *best = Some((step, fall));
                }
            }
        }
        best
    }

    /// For each of the rows the bins p of which its dot product with the rows of a column c of the body's equation is the sum of Re(p c).
    fn along(&self) -> Vec<Bins> {
        let n = self.design.equations.len();
        let at = |rows: &[f64], i: usize| Complex64::new(rows[i], rows[i + 1]);
        let one = |rows: &Vec<f64>| -> Bins {
            (0..self.design.f_hz.len())
                .map(|k| {
                    let own = (0..n).map(|i| 2 * (k * n + i));
                    own.map(|i| at(rows, i).conj() * at(&self.unit, i)).sum()
                })
                .collect()
        };
        self.rows.iter().map(one).collect()
    }

    /// Squared norm of the rows of one in each bin.
    fn weights(&self) -> Vec<f64> {
        let n = 2 * self.design.equations.len();
        let norm = |rows: &[f64]| rows.iter().map(|v| v * v).sum();
        self.unit.chunks_exact(n).map(norm).collect()
    }
}

fn dot(p: &[Complex64], c: &[Complex64]) -> f64 {
    p.iter()
        .zip(c)
        .map(|(p, c)| p.re * c.re - p.im * c.im)
        .sum()
}

/// Weighted a . a, a . b and b . b.
fn norms(weight: &[f64], a: &[Complex64], b: &[Complex64]) -> [f64; 3] {
    let mut out = [0.0; 3];
    for ((w, a), b) in weight.iter().zip(a).zip(b) {
        out[0] += w * a.norm_sqr();
        out[1] += w * (a.re * b.re + a.im * b.im);
        out[2] += w * b.norm_sqr();
    }
    out
}
