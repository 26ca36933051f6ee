//! Moment at which the mass of a body changed. The reduction of the residual by a step of mass is computed for all moments of a record in one pass.
//!
//! The band filter turns a step into a wave whose phase must fit. The residual therefore varies between moments that are a few hundredths of a second
//! apart. A coarse grid of moments would miss the right one.

use super::columns::{parameter_column, slices};
use super::design::{Bins, Design};
use super::fit::held_parameters;
use super::frame::MotionFrame;
use super::limits::END;
use crate::estimate::columns::{Basis, PriorColumn};
use crate::series::plans::{forward, inverse};
use crate::series::window::WindowedTransform;
use crate::vehicle::layout::MassStep;
use rustfft::num_complex::Complex64;

/// Returns, for each body, the steps of its mass that explain most of the vehicle's residual. One step includes its weight and one does not. The
/// better one is first.
///
/// Equations and bins have equal weights, as at the start of every fit. The moment then depends on no parameter that was fitted without the step.
/// Such parameters may be implausible for a vehicle.
pub fn best_steps(frame: &MotionFrame, d: &Design, bodies: &[usize]) -> Vec<Vec<MassStep>> {
    let fixed: Vec<Option<f64>> = held_parameters(frame, &d.vehicle, d);
    let bins = d.f_hz.len();
    let columns: Vec<PriorColumn> = (0..fixed.len())
        .filter(|&i| fixed[i].is_none() && d.has(i))
        .map(|i| PriorColumn {
            rows: rows(&parameter_column(d, i), bins),
            prior: None,
        })
        .collect();
    let basis = Basis::from_columns(&columns);
    let values: Vec<f64> = fixed.iter().map(|v| v.unwrap_or(0.0)).collect();
    let mut left = rows(&slices(&d.residual(&values)), bins);
    for q in basis.columns() {
        let share: f64 = q.iter().zip(&left).map(|(q, r)| q * r).sum();
        left.iter_mut().zip(q).for_each(|(r, q)| *r -= share * q);
    }
    let all: Vec<&[f64]> = std::iter::once(left.as_slice())
        .chain(basis.columns().iter().map(Vec::as_slice))
        .collect();
    let of_body = |&body: &usize| -> Vec<MassStep> {
        let equation = d
            .equations
            .iter()
            .position(|e| e.body == body && e.motion == 0);
        let acceleration = d.motion.bodies.get(body).and_then(|b| b.first());
        let (Some(equation), Some(acceleration)) = (equation, acceleration) else {
            return vec![];
        };
        let own = 2 * bins * equation..2 * bins * (equation + 1);
        let own: Vec<Bins> = all
            .iter()
            .map(|r| complex_from_rows(&r[own.clone()]))
            .collect();
        let m = &d.motion;
        let window = WindowedTransform::new(m.n_samples(), m.rate_hz, d.band);
        let gain: Vec<f64> = d.f_hz.iter().map(|f| d.band.gain(*f)).collect();
        let look = Look::new(window.taper(), acceleration, &gain, window.first_bin());
        let mut best: Vec<(MassStep, f64)> = [frame.gravity, 0.0]
            .into_iter()
            .filter_map(|gravity| {
                let (i, fall) = look.find_best_step(&own, gravity)?;
                let step = MassStep {
                    body,
                    at_s: m.start_s + i as f64 / m.rate_hz,
                    over_s: 0.0,
                    gravity,
                };
                Some((step, fall))
            })
            .collect();
        best.sort_by(|a, b| b.1.total_cmp(&a.1));
        best.into_iter().map(|(step, _)| step).collect()
    };
    bodies.iter().map(of_body).collect()
}

/// Returns real and imaginary parts by equation and bin; zeros for an equation without values.
fn rows(column: &[&[Complex64]], bins: usize) -> Vec<f64> {
    let mut out = Vec::with_capacity(2 * bins * column.len());
    for equation in column {
        let cells = equation.iter().flat_map(|c| [c.re, c.im]);
        out.extend(cells.chain(std::iter::repeat(0.0)).take(2 * bins));
    }
    out
}

fn complex_from_rows(rows: &[f64]) -> Bins {
    let pairs = rows.chunks_exact(2);
    pairs.map(|p| Complex64::new(p[0], p[1])).collect()
}

/// Column of a step of mass at every moment.
///
/// Let u be the tapered acceleration and v the taper. The column of a step at sample t is A + g B in the bins. There,
/// `A_k = G_k sum_{i >= t} u_i exp(-j w_k i)`, and B is computed likewise from v.
///
/// A product with bins p is a sum over the samples from t on: `Re sum_k conj(p_k) A_k = sum_{i >= t} u_i s_i` with
/// `s_i = Re sum_k conj(p_k) G_k exp(-j w_k i)`.
///
/// The product of both parts is `A . B = sum_{i, l >= t} u_i v_l h(i - l)` with `h(m) = sum_k G_k^2 cos(w_k m)`. From one sample to the sample before
/// it, this sum grows by the terms of the added sample with itself and with all later samples.
///
/// Both need only transforms of the length of the record.
struct Look<'a> {
    /// Tapered acceleration, and the taper.
    signals: [Vec<f64>; 2],
    /// Gain of the band in the bins.
    gain: &'a [f64],
    /// Number of the first bin.
    first: usize,
    /// A . A, A . B, B . B by sample.
    products: Vec<[f64; 3]>,
}

impl<'a> Look<'a> {
    fn new(taper: &[f64], acceleration: &[f64], gain: &'a [f64], first: usize) -> Self {
        let u: Vec<f64> = taper.iter().zip(acceleration).map(|(w, a)| w * a).collect();
        let v = taper[..u.len()].to_vec();
        let n = u.len();
        let squares = gain.iter().map(|g| Complex64::new(g * g, 0.0));
        let h = in_time(squares, first, n);
        let [after_u, after_v] = [&u, &v].map(|x| those_after(x, &h));
        let at_once = h.first().copied().unwrap_or(0.0);
        let mut sum = [0.0; 3];
        let mut products = vec![sum; n];
        for i in (0..n).rev() {
            let (u, v, fu, fv) = (u[i], v[i], after_u[i], after_v[i]);
            sum[0] += u * (u * at_once + 2.0 * fu);
            sum[1] += u * v * at_once + u * fv + v * fu;
            sum[2] += v * (v * at_once + 2.0 * fv);
            products[i] = sum;
        }
        Self {
            signals: [u, v],
            gain,
            first,
            products,
        }
    }

    /// Returns the sample at which a step with `gravity` explains most of r, and the explained part. r is the first element of `own`, and the other
    /// elements q are orthonormal columns. The explained part is `(r . c)^2 / (c . c - sum (q . c)^2)`.
    fn find_best_step(&self, own: &[Bins], gravity: f64) -> Option<(usize, f64)> {
        let n = self.products.len();
        let margin = (END * n as f64) as usize;
        let dots: Vec<Vec<f64>> = own.iter().map(|p| self.dots(p, gravity)).collect();
        let (r, known) = dots.split_first()?;
        let mut best: Option<(usize, f64)> = None;
        for i in margin..n.saturating_sub(margin) {
            let [aa, ab, bb] = self.products[i];
            let whole = aa + gravity * (2.0 * ab + gravity * bb);
            let own = whole - known.iter().map(|q| q[i] * q[i]).sum::<f64>();
            // A step is skipped if the columns of the vehicle explain its column to within a thousandth, or if its column is zero.
            if !(own > 1e-3 * whole) {
                continue;
            }
            let fall = r[i] * r[i] / own;
            if best.is_none_or(|b| fall > b.1) {
                best = Some((i, fall));
            }
        }
        best
    }

    /// Returns the product with the bins `p` at every moment.
    fn dots(&self, p: &[Complex64], gravity: f64) -> Vec<f64> {
        let weighed = p.iter().zip(self.gain).map(|(p, g)| p.conj() * g);
        let s = in_time(weighed, self.first, self.products.len());
        let mut sum = 0.0;
        let mut out = vec![0.0; s.len()];
        for i in (0..s.len()).rev() {
            sum += (self.signals[0][i] + gravity * self.signals[1][i]) * s[i];
            out[i] = sum;
        }
        out
    }
}

/// Returns `Re sum_k p_k exp(-2 pi j k i / n)` for the samples i of n, of bins from `first` on.
fn in_time(p: impl Iterator<Item = Complex64>, first: usize, n: usize) -> Vec<f64> {
    let plan = inverse(n);
    let mut input = plan.make_input_vec();
    for (cell, p) in input.iter_mut().skip(first).zip(p) {
        *cell = 0.5 * p.conj();
    }
    let mut out = plan.make_output_vec();
    // This cannot fail, since the plan provides the lengths, and all bins are between zero and half the sample rate.
    let done = plan.process(&mut input, &mut out);
    debug_assert!(done.is_ok());
    out
}

/// Returns `sum_{l > i} x_l h(l - i)` for each sample i.
fn those_after(x: &[f64], h: &[f64]) -> Vec<f64> {
    let n = x.len();
    // This length avoids circular overlap, since the padding is zero.
    let length = (2 * n).next_power_of_two();
    let (there, back) = (forward(length), inverse(length));
    let transformed = |values: &mut dyn Iterator<Item = f64>| {
        let mut input = there.make_input_vec();
        input.iter_mut().zip(values).for_each(|(i, v)| *i = v);
        let mut out = there.make_output_vec();
        let done = there.process(&mut input, &mut out);
        debug_assert!(done.is_ok());
        out
    };
    let later = transformed(&mut std::iter::once(0.0).chain(h.iter().skip(1).copied()));
    let mut both = transformed(&mut x.iter().copied());
    for (x, h) in both.iter_mut().zip(&later) {
        *x *= h.conj() / length as f64;
    }
    // The bins at zero and at half the sample rate are real except for rounding.
    for end in [0, length / 2] {
        if let Some(cell) = both.get_mut(end) {
            cell.im = 0.0;
        }
    }
    let mut out = back.make_output_vec();
    let done = back.process(&mut both, &mut out);
    debug_assert!(done.is_ok());
    out.truncate(n);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Tests the fast sums against direct sums: a column from its transform at each moment, and its products bin by bin.
    #[test]
    fn all_moments_at_once_are_each_moment_alone() {
        let (n, first, gravity) = (60_usize, 3_usize, 9.81);
        let wave = |i: usize, s: f64| (s * i as f64).sin() + (0.31 * s * i as f64 + s).cos();
        let taper: Vec<f64> = (0..n).map(|i| 0.2 + wave(i, 0.05).abs()).collect();
        let acceleration: Vec<f64> = (0..n).map(|i| wave(i, 0.7)).collect();
        let gain: Vec<f64> = (0..9).map(|k| 1.0 / (1.0 + f64::from(k))).collect();
        let row = |s: f64| -> Bins {
            let bin = |k: usize| Complex64::new(wave(k, s), wave(k + 9, s));
            (0..gain.len()).map(bin).collect()
        };
        // The second row is small, so it explains only a small part of the column.
        let own: Vec<Bins> = vec![row(0.9), row(1.7).iter().map(|c| c * 1e-2).collect()];
        let look = Look::new(&taper, &acceleration, &gain, first);
        let margin = (END * n as f64) as usize;
        let mut best = (0, f64::NEG_INFINITY);
        for t in margin..n - margin {
            let column: Bins = (0..gain.len())
                .map(|k| {
                    let w = -2.0 * PI * (first + k) as f64 / n as f64;
                    let after = (t..n).map(|i| {
                        taper[i] * (acceleration[i] + gravity) * Complex64::cis(w * i as f64)
                    });
                    gain[k] * after.sum::<Complex64>()
                })
                .collect();
            let dot = |a: &Bins, b: &Bins| -> f64 {
                a.iter().zip(b).map(|(a, b)| (a.conj() * b).re).sum()
            };
            let whole = dot(&column, &column);
            let [aa, ab, bb] = look.products[t];
            let found = aa + gravity * (2.0 * ab + gravity * bb);
            assert!((found - whole).abs() < 1e-9 * whole, "{t}: {found} {whole}");
            for p in &own {
                let (found, alone) = (look.dots(p, gravity)[t], dot(p, &column));
                let size = (whole * dot(p, p)).sqrt();
                assert!((found - alone).abs() < 1e-9 * size, "{t}: {found} {alone}");
            }
            let fall = dot(&own[0], &column).powi(2) / (whole - dot(&own[1], &column).powi(2));
            if fall > best.1 {
                best = (t, fall);
            }
        }
        let (at, fall) = look.find_best_step(&own, gravity).unwrap();
        assert_eq!(at, best.0);
        assert!((fall - best.1).abs() < 1e-9 * best.1);
    }
}
