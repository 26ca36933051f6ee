//! Solution of one run by least squares. The rows are gauges, wheel forces, equilibrium and prior knowledge, each over its standard deviation.

use super::evidence::{PayloadModel, PayloadRun, Place, WeighSpec};
use crate::estimate::{LinearEstimate, LinearGaussian, ReadingErrors};
use crate::linalg::Matrix;

/// Standard deviation of equilibrium over the standard deviation of a wheel force. Equilibrium is practically exact.
const EXACT: f64 = 1e-3;
/// Standard deviation of the place where only the region is known, in half widths.
const REGION_SD: f64 = 1.0;
/// Standard deviation of a wheel force that stays as the floor gives it.
const SHUT: f64 = 1e-9;

/// Payload of one run, as fitted.
#[derive(Clone, Debug)]
pub struct PayloadFit {
    /// `(F, F dx, F dy)`.
    pub p: [f64; 3],
    /// Covariance of the payload by rows, 3 x 3.
    pub covariance: [f64; 9],
    /// Wheel forces, fitted or computed from the floor.
    pub reactions: Vec<f64>,
}

impl PayloadFit {
    /// Returns zeros, for the time before the first answer.
    pub(super) fn zeros() -> Self {
        Self {
            p: [0.0; 3],
            covariance: [0.0; 9],
            reactions: Vec::new(),
        }
    }
}

/// Whether equilibrium ties measured wheel forces to the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Balance {
    /// It does.
    Kept,
    /// It does not: the payload comes from strain alone, the wheel forces as measured.
    Open,
}

/// A solved run with the sizes of its residuals.
pub(super) struct SolvedRun {
    pub(super) found: PayloadFit,
    /// For each gauge used: its number, stated variance, and expected square of its residual.
    pub(super) gauges: Vec<(usize, f64, f64)>,
    /// Log-likelihood of the wheel forces.
    pub(super) wheels: f64,
}

/// Solves one run. `weights` are factors on the stated noise of the gauges. `old` is the previous answer, whose size determines the model error.
/// `None` if the rows have no solution.
pub(super) fn solve_run(
    model: &PayloadModel,
    run: &PayloadRun,
    spec: &WeighSpec,
    balance: Balance,
    weights: &[f64],
    old: &PayloadFit,
) -> Option<SolvedRun> {
    let u = Unknowns::from_run(model, run, spec);
    let mut rows = gauge_rows(&u, model, run, spec, old)?;
    let wheel_variance = spec.reaction_sigma.powi(2);
    for (w, y) in run.reactions.iter().enumerate().filter(|r| r.1.is_finite()) {
        rows.push(u.single_unknown_row(w, *y, wheel_variance));
    }
    if u.n_wheels > 0 && balance == Balance::Kept {
        rows.extend(equilibrium(&u, model, spec, wheel_variance));
    }
    rows.extend(patterns_shut(&u, spec, old));
    rows.extend(within_region(&u, spec, old));
    if spec.model_rel == 0.0 {
        for r in &mut rows {
            r.a[u.at_c..u.at_z].fill(0.0);
        }
    }
    for c in u.at_c..u.at_z {
        let sd = if spec.model_rel > 0.0 {
            spec.model_rel
        } else {
            1.0
        };
        rows.push(u.single_unknown_row(c, 0.0, sd * sd));
    }
    let variances: Vec<f64> = rows
        .iter()
        .map(|r| r.variance / r.gauge.map_or(1.0, |g| weights[g]))
        .collect();
    let solved = match &model.noise {
        Some(noise) if noise.is_correlated() => {
            // Besides noise, every gauge has an independent model error. Only the noise is correlated between gauges.
            let n = rows.len();
            let mut covariance = vec![0.0; n * n];
            for (i, a) in rows.iter().enumerate() {
                covariance[i * n + i] = variances[i];
                for (j, b) in rows.iter().enumerate().filter(|(j, _)| *j != i) {
                    let (Some(g), Some(h)) = (a.gauge, b.gauge) else {
                        continue;
                    };
                    let size = run.sigma[g] * run.sigma[h] / (weights[g] * weights[h]).sqrt();
                    covariance[i * n + j] = noise.correlation(g, h) * size;
                }
            }
            least_squares(
                &rows,
                ReadingErrors::Covariance(&covariance),
                &variances,
                u.width,
            )?
        }
        _ => least_squares(
            &rows,
            ReadingErrors::Variances(&variances),
            &variances,
            u.width,
        )?,
    };
    let mut gauges = Vec::new();
    let mut wheels = 0.0;
    for (i, row) in rows.iter().enumerate() {
        let residual = row.y
            - row
                .a
                .iter()
                .zip(&solved.value)
                .map(|(a, f)| a * f)
                .sum::<f64>();
        match row.gauge {
            Some(g) => {
                let spread = solved.leverage[i] * variances[i];
                gauges.push((g, row.variance, residual * residual + spread));
            }
            None => wheels -= 0.5 * residual * residual / row.variance,
        }
    }
    Some(SolvedRun {
        found: u.locate_payload(model, &solved),
        gauges,
        wheels,
    })
}

/// An equation: `a` times the unknowns is `y`.
struct Row {
    a: Vec<f64>,
    y: f64,
    variance: f64,
    gauge: Option<usize>,
}

/// Positions of the unknowns of a run: wheel forces where they are measured, `p`, the error of the model, patterns of wheel forces.
struct Unknowns {
    n_wheels: usize,
    /// Numbers of `p` that are asked for: `F`, `F dx`, `F dy`, or `F` alone where the place is known.
    q: usize,
    at_p: usize,
    at_c: usize,
    at_z: usize,
    width: usize,
    patterns: Vec<Vec<f64>>,
    /// `p / F` where the place is known.
    known: [f64; 3],
}

impl Unknowns {
    fn from_run(model: &PayloadModel, run: &PayloadRun, spec: &WeighSpec) -> Self {
        let n_wheels = run.reactions.len();
        let q = if spec.place == Place::Free { 3 } else { 1 };
        let (at_p, at_c) = (n_wheels, n_wheels + q);
        // The model determines the wheel forces on the floor. Patterns of wheel forces in equilibrium with themselves have the uncertainty of the
        // model.
        let patterns = match &model.arms {
            Some(arms) if n_wheels == 0 && spec.model_rel > 0.0 => balanced_patterns(arms),
            _ => Vec::new(),
        };
        // Errors that are common to all gauges. With wheel forces from the floor this is one error of the whole model. With measured wheel forces
        // each column of the model (wheel or payload component) has a separate error.
        let n_common = if n_wheels > 0 { n_wheels + 3 } else { 1 };
        let at_z = at_c + n_common;
        Self {
            n_wheels,
            q,
            at_p,
            at_c,
            at_z,
            width: at_z + patterns.len(),
            patterns,
            known: [1.0, run.shift[0], run.shift[1]],
        }
    }

    fn row(&self) -> Vec<f64> {
        vec![0.0; self.width]
    }

    /// The equation that one unknown is `y`.
    fn single_unknown_row(&self, unknown: usize, y: f64, variance: f64) -> Row {
        let mut a = self.row();
        a[unknown] = 1.0;
        Row {
            a,
            y,
            variance,
            gauge: None,
        }
    }

    /// Entries of the columns of `(F, F dx, F dy)` for the unknowns in use.
    fn fold(&self, c: [f64; 3]) -> Vec<f64> {
        if self.q == 3 {
            c.to_vec()
        } else {
            vec![(0..3).map(|k| c[k] * self.known[k]).sum()]
        }
    }

    /// Number `k` of `(F, F dx, F dy)` by the unknowns in use.
    fn back(&self, k: usize) -> (usize, f64) {
        if self.q == 3 {
            (self.at_p + k, 1.0)
        } else {
            (self.at_p, self.known[k])
        }
    }

    /// The answer in `(F, F dx, F dy)`.
    fn locate_payload(&self, model: &PayloadModel, solved: &LinearEstimate) -> PayloadFit {
        let p: [f64; 3] = std::array::from_fn(|k| {
            let (i, c) = self.back(k);
            c * solved.value[i]
        });
        let mut covariance = [0.0; 9];
        for i in 0..3 {
            for j in 0..3 {
                let ((a, ca), (b, cb)) = (self.back(i), self.back(j));
                covariance[3 * i + j] += ca * cb * solved.covariance[(a, b)];
            }
        }
        let reactions = if self.n_wheels > 0 {
            solved.value[..self.n_wheels].to_vec()
        } else {
            model.floor.as_ref().map_or_else(Vec::new, |floor| {
                (0..floor.nrows())
                    .map(|w| (0..3).map(|k| floor[(w, k)] * p[k]).sum())
                    .collect()
            })
        };
        PayloadFit {
            p,
            covariance,
            reactions,
        }
    }
}

/// `strain = wheels R + payload p`, with the error of the model in it; `None` where neither wheel forces nor a floor are known.
fn gauge_rows(
    u: &Unknowns,
    model: &PayloadModel,
    run: &PayloadRun,
    spec: &WeighSpec,
    old: &PayloadFit,
) -> Option<Vec<Row>> {
    let n_wheels = u.n_wheels;
    let mut rows = Vec::new();
    for g in 0..model.gauges.len() {
        let Some(y) = run.strain.get(g).copied().filter(|v| v.is_finite()) else {
            continue;
        };
        let mut row = u.row();
        let mut column: [f64; 3] = std::array::from_fn(|k| model.payload[(g, k)]);
        let mut parts: f64 = (0..3)
            .map(|k| (model.payload[(g, k)] * old.p[k]).powi(2))
            .sum();
        for (w, r) in old.reactions.iter().enumerate() {
            parts += (model.wheels[(g, w)] * r).powi(2);
        }
        if n_wheels > 0 {
            for w in 0..n_wheels {
                row[w] = model.wheels[(g, w)];
            }
        } else {
            let floor = model.floor.as_ref()?;
            for (k, c) in column.iter_mut().enumerate() {
                *c += (0..floor.nrows())
                    .map(|w| model.wheels[(g, w)] * floor[(w, k)])
                    .sum::<f64>();
            }
        }
        for (k, c) in u.fold(column).into_iter().enumerate() {
            row[u.at_p + k] = c;
        }
        if n_wheels > 0 {
            for (w, r) in old.reactions.iter().enumerate().take(n_wheels) {
                row[u.at_c + w] = model.wheels[(g, w)] * r;
            }
            for k in 0..3 {
                row[u.at_c + n_wheels + k] = column[k] * old.p[k];
            }
        } else {
            row[u.at_c] = (0..3).map(|k| column[k] * old.p[k]).sum();
        }
        for (z, pattern) in u.patterns.iter().enumerate() {
            row[u.at_z + z] = pattern
                .iter()
                .enumerate()
                .map(|(w, share)| model.wheels[(g, w)] * share)
                .sum();
        }
        let own = run.sigma.get(g).copied().unwrap_or(0.0);
        let variance = own * own + spec.model_rel.powi(2) * parts;
        if variance > 0.0 {
            rows.push(Row {
                a: row,
                y,
                variance,
                gauge: Some(g),
            });
        }
    }
    Some(rows)
}

/// `sum R = F` and, where the place is free, `sum R arm = F (dx, dy)`.
fn equilibrium(
    u: &Unknowns,
    model: &PayloadModel,
    spec: &WeighSpec,
    wheel_variance: f64,
) -> Vec<Row> {
    let exact = wheel_variance * EXACT * EXACT;
    let mut equations: Vec<([f64; 3], Vec<f64>, f64)> =
        vec![([-1.0, 0.0, 0.0], vec![1.0; u.n_wheels], 1.0)];
    // If the position is known, the moments serve as a check only. They do not change the forces.
    if let (Some(arms), Place::Free) = (&model.arms, spec.place) {
        for axis in 0..2 {
            let mut c = [0.0; 3];
            c[1 + axis] = -1.0;
            let arm: Vec<f64> = arms.iter().map(|a| a[axis]).collect();
            let size = arm.iter().fold(0.0_f64, |s, a| s.max(a.abs())).max(1e-12);
            equations.push((c, arm, size));
        }
    }
    let row = |(c, arm, size): ([f64; 3], Vec<f64>, f64)| {
        let mut a = u.row();
        a[..u.n_wheels].copy_from_slice(&arm);
        for (k, c) in u.fold(c).into_iter().enumerate() {
            a[u.at_p + k] = c;
        }
        Row {
            a,
            y: 0.0,
            variance: exact * size * size,
            gauge: None,
        }
    };
    equations.into_iter().map(row).collect()
}

/// Patterns of wheel forces as far as the model's uncertainty opens them.
fn patterns_shut(u: &Unknowns, spec: &WeighSpec, old: &PayloadFit) -> Vec<Row> {
    let share = spec.model_rel * old.p[0].abs().max(f64::MIN_POSITIVE);
    // Before the first answer the size of the payload is unknown, so the patterns are fixed at zero.
    let sd = if old.p[0] == 0.0 { SHUT } else { share };
    (u.at_z..u.width)
        .map(|unknown| u.single_unknown_row(unknown, 0.0, sd * sd))
        .collect()
}

/// A free place is in the region, as far as its half width goes.
fn within_region(u: &Unknowns, spec: &WeighSpec, old: &PayloadFit) -> Vec<Row> {
    let mut rows = Vec::new();
    if let (Some(region), 3) = (spec.region, u.q) {
        let size = old.p[0].abs();
        for (axis, [low, high]) in region.into_iter().enumerate() {
            let half = (high - low) / 2.0;
            if size > 0.0 && half > 0.0 {
                let mut row =
                    u.single_unknown_row(u.at_p + 1 + axis, 0.0, (size * half * REGION_SD).powi(2));
                row.a[u.at_p] = -(low + high) / 2.0;
                rows.push(row);
            }
        }
    }
    rows
}

/// Least squares over the rows, columns scaled to unit length.
fn least_squares(
    rows: &[Row],
    errors: ReadingErrors<'_>,
    variances: &[f64],
    width: usize,
) -> Option<LinearEstimate> {
    let a = Matrix::from_fn(rows.len(), width, |i, l| rows[i].a[l]);
    let y: Vec<f64> = rows.iter().map(|r| r.y).collect();
    let scales: Vec<f64> = (0..width)
        .map(|l| {
            let size = (0..rows.len())
                .map(|i| a[(i, l)].powi(2) / variances[i])
                .sum::<f64>()
                .sqrt();
            if size > 0.0 { 1.0 / size } else { 1.0 }
        })
        .collect();
    let model = LinearGaussian {
        rows: &a,
        errors,
        prior_sd: &vec![None; width],
        scales: &scales,
    };
    model.estimate(&y)
}

/// Patterns of wheel forces of unit length without resultant force and moments: what equilibrium leaves open.
fn balanced_patterns(arms: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let n = arms.len();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let rigid = [
        vec![1.0; n],
        arms.iter().map(|a| a[0]).collect(),
        arms.iter().map(|a| a[1]).collect(),
    ];
    let units = (0..n).map(|i| (0..n).map(|w| f64::from(u8::from(w == i))).collect());
    for (i, mut v) in rigid.into_iter().chain(units).enumerate() {
        let size = v.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
        for _ in 0..2 {
            for b in &basis {
                let along: f64 = v.iter().zip(b).map(|(x, y)| x * y).sum();
                v.iter_mut().zip(b).for_each(|(x, y)| *x -= along * y);
            }
        }
        let left = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if left > 1e-6 * size && left > 0.0 {
            basis.push(v.iter().map(|x| x / left).collect());
        } else if i < 3 {
            return Vec::new();
        }
    }
    basis.split_off(3.min(basis.len()))
}
