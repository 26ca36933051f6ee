//! How far a calibrated S may be off, and how much strain scatters between repeats of one loading.

use crate::linalg::Matrix;

/// What stands behind the interval of a load besides noise: `Cov(eps | f) = q(f)^2 C + sum_jk f_j f_k Cov(S_.j, S_.k)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Covariance of the entries of S, `(n k) x (n k)` by rows, entry `g k + l` for gauge `g` and load `l`; strain^2 per load^2.
    pub covariance: Vec<f64>,
    /// `C`, `n x n` by rows: covariance over gauges of what repeats of one loading scatter by, in units of `q^2`: scatter grows with the
    /// load.
    pub scatter: Vec<f64>,
    /// `S' S / n` of all calibrated gauges, `k x k` by rows: `q(f)^2 = f' (S' S / n) f` is the mean square of the predicted strain.
    pub mean_square: Vec<f64>,
    /// Factor on the sigma of recovered loads, learnt from runs left out; 1 where they fall as far off as expected.
    pub scale: f64,
    /// Degrees of freedom behind scatter and scale: the 95 % interval takes Student's factor; infinite where nothing was estimated.
    pub dof: f64,
    /// Those behind the scatter in a pattern over the gauges that no loads make, such as a fault of one gauge; more than `dof`, as the
    /// scatter of all such patterns was estimated together.
    pub dof_outside: f64,
    /// Whether runs of one load alone, without a model, are all that taught it.
    pub one_by_one: bool,
}

impl Uncertainty {
    /// Of a model whose influence coefficients err by `model_rel` each, by as much again a load as a whole, and by `off` (what is left of a
    /// mesh's error, `n x k`) each, as much again by a factor common to all gauges of a load, and by the share `own_rel` each:
    /// `Cov(S_gl, S_hm) = [l = m] ((off_gl off_hl + model_rel^2 S_gl S_hl) (1 + [g = h]) + own_rel^2 S_gl^2 [g = h])`.
    pub fn of_model(s: &Matrix, model_rel: f64, (off, own_rel): (&Matrix, f64)) -> Self {
        let (n, k) = s.shape();
        let (rel2, own2) = (model_rel * model_rel, own_rel * own_rel);
        let on = |yes: bool| f64::from(u8::from(yes));
        let mut covariance = Vec::with_capacity(n * k * n * k);
        for g in 0..n {
            for l in 0..k {
                for h in 0..n {
                    for m in 0..k {
                        let (same_gauge, same_load) = (on(g == h), on(l == m));
                        let own = own2 * s[(g, l)] * s[(h, m)] * same_gauge;
                        let both = off[(g, l)] * off[(h, m)] + rel2 * s[(g, l)] * s[(h, m)];
                        covariance.push(same_load * (both * (1.0 + same_gauge) + own));
                    }
                }
            }
        }
        Self {
            covariance,
            scatter: vec![0.0; n * n],
            mean_square: mean_square(s),
            scale: 1.0,
            dof: f64::INFINITY,
            dof_outside: f64::INFINITY,
            one_by_one: false,
        }
    }

    /// Covariance of the strain that loads `f` cause, `n x n` by rows, noise and `scale` left out.
    pub fn strain_covariance(&self, n: usize, f: &[f64]) -> Vec<f64> {
        let k = f.len();
        let q2 = self.mean_square_of(f);
        let mut out = vec![0.0; n * n];
        for g in 0..n {
            for h in 0..=g {
                let mut sum = q2 * self.scatter.get(g * n + h).copied().unwrap_or(0.0);
                for (j, fj) in f.iter().enumerate() {
                    let row = (g * k + j) * n * k + h * k;
                    let entries = self.covariance.get(row..row + k).unwrap_or(&[]);
                    sum += fj * entries.iter().zip(f).map(|(c, fk)| c * fk).sum::<f64>();
                }
                out[g * n + h] = sum;
                out[h * n + g] = sum;
            }
        }
        out
    }

    /// Mean of the covariance of the strain over loads of standard deviations `scales` that are independent of each other, `n x n` by rows,
    /// noise left out, `scale` in.
    pub fn expected_covariance(&self, n: usize, scales: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; n * n];
        for l in 0..scales.len() {
            let mut one = vec![0.0; scales.len()];
            one[l] = self.scale * scales[l];
            let of_load = self.strain_covariance(n, &one);
            out.iter_mut().zip(of_load).for_each(|(a, b)| *a += b);
        }
        out
    }

    /// Quadratic forms of a filter `G eps`: for each of its rows, a load or a sum of loads, the `k x k` matrix `B` with `f' B f` its variance for
    /// the `k` loads `f` of S; `gain` has a column a gauge.
    pub fn load_forms(&self, gain: &Matrix) -> Vec<f64> {
        let (rows, n) = gain.shape();
        let k = (self.mean_square.len() as f64).sqrt().round() as usize;
        let scale2 = self.scale * self.scale;
        let mut out = Vec::with_capacity(rows * k * k);
        for l in 0..rows {
            let mut own = 0.0;
            for g in 0..n {
                for h in 0..n {
                    own += gain[(l, g)]
                        * gain[(l, h)]
                        * self.scatter.get(g * n + h).copied().unwrap_or(0.0);
                }
            }
            for j in 0..k {
                for m in 0..k {
                    let mut sum = own * self.mean_square.get(j * k + m).copied().unwrap_or(0.0);
                    for g in 0..n {
                        for h in 0..n {
                            let at = (g * k + j) * n * k + h * k + m;
                            sum += gain[(l, g)]
                                * gain[(l, h)]
                                * self.covariance.get(at).copied().unwrap_or(0.0);
                        }
                    }
                    out.push(scale2 * sum);
                }
            }
        }
        out
    }

    /// The same for some of the gauges, in the order given by their numbers.
    pub fn of_gauges(&self, gauges: &[usize]) -> Self {
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let nk = (self.covariance.len() as f64).sqrt().round() as usize;
        let k = nk.checked_div(n).unwrap_or(0);
        let entries: Vec<(usize, f64)> = gauges
            .iter()
            .flat_map(|g| (0..k).map(move |l| (g * k + l, 1.0)))
            .collect();
        let gauges: Vec<(usize, f64)> = gauges.iter().map(|g| (*g, 1.0)).collect();
        Self {
            covariance: picked(&self.covariance, nk, &entries),
            scatter: picked(&self.scatter, n, &gauges),
            mean_square: self.mean_square.clone(),
            scale: self.scale,
            dof: self.dof,
            dof_outside: self.dof_outside,
            one_by_one: self.one_by_one,
        }
    }

    /// The same for some of the loads, each in another unit: `loads` has their numbers, and the old units in a new one.
    pub fn of_loads(&self, loads: &[(usize, f64)]) -> Self {
        let k = (self.mean_square.len() as f64).sqrt().round() as usize;
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let of_gauge = |g: usize| loads.iter().map(move |&(l, unit)| (g * k + l, unit));
        let entries: Vec<(usize, f64)> = (0..n).flat_map(of_gauge).collect();
        Self {
            covariance: picked(&self.covariance, n * k, &entries),
            scatter: self.scatter.clone(),
            mean_square: picked(&self.mean_square, k, loads),
            scale: self.scale,
            dof: self.dof,
            dof_outside: self.dof_outside,
            one_by_one: self.one_by_one,
        }
    }

    /// Of one load that is a sum of these, `f` of each: the column `S f`.
    pub fn along(&self, f: &[f64]) -> Self {
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let of_entries = Self {
            scatter: Vec::new(),
            ..self.clone()
        };
        Self {
            covariance: of_entries.strain_covariance(n, f),
            scatter: self.scatter.clone(),
            mean_square: vec![self.mean_square_of(f)],
            ..*self
        }
    }

    /// Sum of the variances of the entries of gauge `g` of S with `k` loads.
    pub fn power(&self, g: usize, k: usize) -> f64 {
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let variance = |e: usize| self.covariance.get(e * (n * k + 1)).copied().unwrap_or(0.0);
        self.scale * self.scale * (g * k..(g + 1) * k).map(variance).sum::<f64>()
    }

    /// `q(f)^2`, strain^2.
    pub fn mean_square_of(&self, f: &[f64]) -> f64 {
        let rows = self.mean_square.chunks_exact(f.len().max(1)).zip(f);
        rows.map(|(row, fj)| fj * row.iter().zip(f).map(|(a, fk)| a * fk).sum::<f64>())
            .sum()
    }
}

/// Some rows and columns of a square matrix of `order`, each times its factor.
fn picked(matrix: &[f64], order: usize, rows: &[(usize, f64)]) -> Vec<f64> {
    let pairs = rows.iter().flat_map(|a| rows.iter().map(move |b| (a, b)));
    let value = |((i, p), (j, q)): (&(usize, f64), &(usize, f64))| {
        p * q * matrix.get(i * order + j).copied().unwrap_or(0.0)
    };
    pairs.map(value).collect()
}

/// `S' S / n`, `k x k` by rows.
pub fn mean_square(s: &Matrix) -> Vec<f64> {
    let gram = s.transpose() * s / s.nrows().max(1) as f64;
    gram.iter().copied().collect()
}
