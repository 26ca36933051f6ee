//! States of a system at all samples.

use super::cubic;
use super::system::{Moment, System};
use super::types::ResponseError;
use crate::linalg::Matrix;
use crate::linalg::exponential::exponential;

/// No displacement, velocity or acceleration of a vehicle is larger in any system of units.
const LARGEST: f64 = 1e12;

/// Curves of all inputs between samples `i` and `i + 1`.
fn curves(system: &System, rate_hz: f64, i: usize, out: &mut Vec<[f64; 4]>) {
    out.clear();
    let [forces, accelerations, displacements] = &system.samples;
    let all = forces.iter().chain(accelerations).chain(displacements);
    out.extend(all.map(|x| cubic::coefficients(x, i)));
    let of_displacements = out[forces.len() + accelerations.len()..].to_vec();
    out.extend(
        of_displacements
            .into_iter()
            .map(|p| cubic::derivative(p, rate_hz)),
    );
}

/// Inputs at sample `i` of `n`.
pub(super) fn input_at(system: &System, rate_hz: f64, i: usize, out: &mut [f64]) {
    let [forces, accelerations, displacements] = &system.samples;
    let all = forces.iter().chain(accelerations).chain(displacements);
    let rates = displacements.iter().map(|x| rate_hz * cubic::slope(x, i));
    let values = all.map(|x| x[i]).chain(rates);
    out.iter_mut().zip(values).for_each(|(o, v)| *o = v);
}

/// States at all samples, exact for cubic inputs.
pub(super) fn exact_states(
    system: &System,
    rate_hz: f64,
    n: usize,
) -> Result<Vec<Vec<f64>>, ResponseError> {
    let (m, k) = (system.n_states(), system.n_inputs());
    let h = 1.0 / rate_hz;
    // y' = A y + B u with u(s) = p0 + p1 s + p2 s^2 + p3 s^3. The derivatives of u are further states, so that one exponential contains all
    // integrals.
    let mut a = Matrix::zeros(m + 4 * k, m + 4 * k);
    let (mut y, mut u) = (vec![0.0; m], vec![0.0; k]);
    let (mut moment, mut rates) = (Moment::default(), vec![0.0; m]);
    for j in 0..m + k {
        let unit = if j < m { &mut y[j] } else { &mut u[j - m] };
        *unit = 1.0;
        system.rates(&y, &u, &mut moment, &mut rates);
        rates
            .iter()
            .enumerate()
            .for_each(|(i, v)| a[(i, j)] = h * v);
        let unit = if j < m { &mut y[j] } else { &mut u[j - m] };
        *unit = 0.0;
    }
    for j in 0..3 * k {
        a[(m + j, m + k + j)] = 1.0;
    }
    let e = exponential(&a).ok_or(ResponseError::Diverged { at_s: 0.0 })?;
    let factorial = [1.0, 1.0, 2.0, 6.0];
    let mut states = Vec::with_capacity(n);
    let mut next = vec![0.0; m];
    let mut pieces = Vec::new();
    for i in 0..n {
        check_bounds(&y, i, rate_hz)?;
        states.push(y.clone());
        if i + 1 == n {
            break;
        }
        curves(system, rate_hz, i, &mut pieces);
        next.fill(0.0);
        for (j, v) in y.iter().enumerate() {
            next.iter_mut()
                .enumerate()
                .for_each(|(i, x)| *x += e[(i, j)] * v);
        }
        for (j, p) in pieces.iter().enumerate() {
            for order in 0..4 {
                let v = factorial[order] * p[order];
                let column = m + order * k + j;
                next.iter_mut()
                    .enumerate()
                    .for_each(|(i, x)| *x += e[(i, column)] * v);
            }
        }
        std::mem::swap(&mut y, &mut next);
    }
    Ok(states)
}

/// States at all samples by the Runge-Kutta method of order 4.
pub(super) fn stepped_states(
    system: &System,
    rate_hz: f64,
    n: usize,
    steps: usize,
) -> Result<Vec<Vec<f64>>, ResponseError> {
    let (m, k) = (system.n_states(), system.n_inputs());
    let h = 1.0 / (rate_hz * steps as f64);
    let mut y = vec![0.0; m];
    let mut rates = [const { Vec::new() }; 4].map(|_: Vec<f64>| vec![0.0; m]);
    let (mut middle, mut u) = (vec![0.0; m], vec![0.0; k]);
    let mut moment = Moment::default();
    let mut pieces: Vec<[f64; 4]> = Vec::new();
    let mut states = Vec::with_capacity(n);
    for i in 0..n {
        check_bounds(&y, i, rate_hz)?;
        states.push(y.clone());
        if i + 1 == n {
            break;
        }
        curves(system, rate_hz, i, &mut pieces);
        for step in 0..steps {
            for (stage, (at, of)) in [(0.0, 0), (0.5, 0), (0.5, 1), (1.0, 2)]
                .into_iter()
                .enumerate()
            {
                let s = (step as f64 + at) / steps as f64;
                u.iter_mut()
                    .zip(&pieces)
                    .for_each(|(u, p)| *u = cubic::value_at(*p, s));
                middle.copy_from_slice(&y);
                if stage > 0 {
                    middle
                        .iter_mut()
                        .zip(&rates[of])
                        .for_each(|(x, r)| *x += at * h * r);
                }
                system.rates(&middle, &u, &mut moment, &mut rates[stage]);
            }
            for (j, x) in y.iter_mut().enumerate() {
                *x += h / 6.0 * (rates[0][j] + 2.0 * (rates[1][j] + rates[2][j]) + rates[3][j]);
            }
        }
    }
    Ok(states)
}

fn check_bounds(y: &[f64], i: usize, rate_hz: f64) -> Result<(), ResponseError> {
    let inside = y.iter().all(|v| v.abs() < LARGEST);
    inside.then_some(()).ok_or(ResponseError::Diverged {
        at_s: i as f64 / rate_hz,
    })
}
