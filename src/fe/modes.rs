//! Elastic modes by subspace iteration on the factor of the static solution.

use super::element::Prepared;
use super::error::FeError;
use super::mass::Mass;
use super::solve::Relief;
use super::system::System;
use crate::finding::Finding;
use crate::linalg::DMatrix;
use crate::model::Model;
use rayon::prelude::*;

/// Eigenvalues agree between two rounds within this share.
const CONVERGED: f64 = 1e-9;
const ROUNDS: usize = 60;

/// A mode of vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Cycles per unit of time.
    pub frequency: f64,
    /// Shape with unit generalized mass, basic frame: translation and rotation by grid index.
    pub shape: Vec<[f64; 6]>,
}

/// The lowest elastic modes, ascending; rigid motions are left out.
///
/// Subspace iteration on P K^-1 P' M, where P takes the rigid motions out (R'M u = 0): a balanced load needs no more than the
/// determinately supported stiffness that statics use.
///
/// # Reference
/// K. J. Bathe, Finite Element Procedures, 2nd ed. 2014, section 11.6.
///
/// # Errors
/// See [`FeError`].
pub fn free_modes(
    model: &Model,
    spc: Option<u32>,
    mpc: Option<u32>,
    count: usize,
) -> Result<(Vec<Mode>, Vec<Finding>), FeError> {
    let refused = super::unsupported::unsupported(model, &[]);
    if !refused.is_empty() {
        return Err(FeError::Refused(refused));
    }
    let prepared = Prepared::new(model);
    let mass = Mass::new(&prepared).map_err(FeError::Refused)?;
    let mut findings = Vec::new();
    let system = System::new(
        &prepared,
        &mass,
        (spc, mpc),
        Relief::Automatic,
        &mut findings,
    )?;
    let factor = system.factor(model, &system.stiffness)?;
    let n = system.symbolic.n_unknowns();
    let p = (2 * count).min(count + 8).min(n);
    let take_out = |u: &mut Vec<[f64; 6]>| {
        if let Some(body) = &system.body {
            body.take_out(&mass, u);
        }
    };
    let mut shapes: Vec<Vec<[f64; 6]>> = (0..p)
        .into_par_iter()
        .map(|c| {
            let mut u = system.unpack(&prepared, &start_values(n, c));
            take_out(&mut u);
            u
        })
        .collect();
    let mut before = vec![f64::INFINITY; count.min(p)];
    let mut values = Vec::new();
    for _ in 0..ROUNDS {
        let forces: Vec<Vec<[f64; 6]>> = shapes.par_iter().map(|u| mass.times(u)).collect();
        // Shapes that turned out alike were dropped.
        let mut columns = vec![0.0; n * shapes.len()];
        for (f, column) in forces.iter().zip(columns.chunks_exact_mut(n.max(1))) {
            system.pack(&prepared, f.clone(), column)?;
        }
        factor
            .solve(&mut columns)
            .map_err(|e| system.refused(model, e))?;
        let moved: Vec<Vec<[f64; 6]>> = columns
            .par_chunks_exact(n.max(1))
            .map(|c| {
                let mut u = system.unpack(&prepared, c);
                take_out(&mut u);
                u
            })
            .collect();
        let with_mass: Vec<Vec<[f64; 6]>> = moved.par_iter().map(|u| mass.times(u)).collect();
        let stiffness = gram(&moved, &forces);
        let weight = gram(&moved, &with_mass);
        let Some((lambda, vectors)) = generalized(&stiffness, &weight) else {
            break;
        };
        shapes = (0..lambda.len())
            .into_par_iter()
            .map(|c| combine(&moved, |r| vectors[(r, c)]))
            .collect();
        values = lambda;
        let done = values
            .iter()
            .zip(&before)
            .all(|(a, b)| (a - b).abs() <= CONVERGED * a.abs());
        before = values.iter().take(count).copied().collect();
        if done && !before.is_empty() {
            break;
        }
    }
    let modes = values
        .iter()
        .zip(shapes)
        .take(count)
        .map(|(l, shape)| Mode {
            frequency: l.max(0.0).sqrt() / std::f64::consts::TAU,
            shape,
        })
        .collect();
    Ok((modes, findings))
}

/// Repeatable values between -1 and 1 (splitmix64).
fn start_values(n: usize, column: usize) -> Vec<f64> {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(column as u64 + 1);
    (0..n)
        .map(|_| {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect()
}

fn gram(a: &[Vec<[f64; 6]>], b: &[Vec<[f64; 6]>]) -> DMatrix<f64> {
    let p = a.len();
    let pairs: Vec<(usize, usize)> = (0..p).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
    let dots: Vec<f64> = pairs
        .par_iter()
        .map(|&(i, j)| {
            a[i].iter()
                .flatten()
                .zip(b[j].iter().flatten())
                .map(|(x, y)| x * y)
                .sum()
        })
        .collect();
    let mut m = DMatrix::zeros(p, p);
    for ((i, j), v) in pairs.into_iter().zip(dots) {
        m[(i, j)] = v;
        m[(j, i)] = v;
    }
    m
}

fn combine(fields: &[Vec<[f64; 6]>], amount: impl Fn(usize) -> f64) -> Vec<[f64; 6]> {
    let mut out = vec![[0.0; 6]; fields.first().map_or(0, Vec::len)];
    for (r, field) in fields.iter().enumerate() {
        let c = amount(r);
        for (o, v) in out.iter_mut().zip(field) {
            o.iter_mut().zip(v).for_each(|(o, v)| *o += c * v);
        }
    }
    out
}

/// Eigenvalues, ascending, and vectors of K x = lambda M x with x'Mx = 1; directions almost without mass are dropped.
fn generalized(k: &DMatrix<f64>, m: &DMatrix<f64>) -> Option<(Vec<f64>, DMatrix<f64>)> {
    let scale: Vec<f64> = (0..m.nrows())
        .map(|i| {
            if m[(i, i)] > 0.0 {
                1.0 / m[(i, i)].sqrt()
            } else {
                0.0
            }
        })
        .collect();
    let scaled = |a: &DMatrix<f64>| {
        DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * scale[i] * scale[j])
    };
    let eigen = scaled(m).symmetric_eigen();
    let kept: Vec<usize> = (0..m.nrows())
        .filter(|&i| eigen.eigenvalues[i] > 1e-12)
        .collect();
    if kept.is_empty() {
        return None;
    }
    let whiten = DMatrix::from_fn(m.nrows(), kept.len(), |r, c| {
        scale[r] * eigen.eigenvectors[(r, kept[c])] / eigen.eigenvalues[kept[c]].sqrt()
    });
    let reduced = (whiten.transpose() * k * &whiten).symmetric_eigen();
    let mut order: Vec<usize> = (0..kept.len()).collect();
    order.sort_by(|&a, &b| reduced.eigenvalues[a].total_cmp(&reduced.eigenvalues[b]));
    let values = order.iter().map(|&i| reduced.eigenvalues[i]).collect();
    let vectors = &whiten
        * DMatrix::from_fn(kept.len(), kept.len(), |r, c| {
            reduced.eigenvectors[(r, order[c])]
        });
    Some((values, vectors))
}
