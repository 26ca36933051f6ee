//! Uncertainty of a calibrated S, and scatter of strain between repeats of one loading.

use crate::linalg::Matrix;

/// Covariance of strain under loads, in addition to noise: `Cov(eps | f) = q(f)^2 C + sum_jk h_j h_k Cov(S_.j, S_.k) + A`, `h = f - center`.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Covariance of the entries of S, `(n k) x (n k)` by rows, entry `g k + l` for gauge `g` and load `l`; strain^2 per load^2.
    pub covariance: Vec<f64>,
    /// `C`, `n x n` by rows: covariance over gauges of the scatter between repeats of one loading, in units of `q^2`. Scatter grows with the
    /// load.
    pub scatter: Vec<f64>,
    /// `S' S / n` of all calibrated gauges, `k x k` by rows: `q(f)^2 = f' (S' S / n) f` is the mean square of the predicted strain.
    pub mean_square: Vec<f64>,
    /// Factor on the sigma of recovered loads, from runs that were left out. It is 1 if the errors of these runs are as large as expected.
    pub scale: f64,
    /// Degrees of freedom of scatter and scale. The 95 % interval uses Student's factor with these. Infinite if nothing was estimated.
    pub dof: f64,
    /// Degrees of freedom of the scatter in a pattern over the gauges that no loads make, such as a fault of one gauge. It exceeds `dof`, as the
    /// scatter of all such patterns was estimated together.
    pub dof_outside: f64,
    /// Whether S was calibrated only with runs of one load each, without a model.
    pub one_by_one: bool,
    /// `A`, `n x n` by rows: covariance of the readings at any load, from a common zero or the misfit of a straight line. Empty if it is zero.
    pub additive: Vec<f64>,
    /// Loads at which the errors of S do not count, because the runs determine the strain at these loads. Empty if there are no such loads.
    pub center: Vec<f64>,
    /// Whether runs that were left out tested the intervals; `false` if each run was needed to determine S.
    pub is_tested: bool,
}

impl Uncertainty {
    /// Returns the uncertainty of a model. Each influence coefficient has an independent error `model_rel`, and an error of the same size that is
    /// common to a load. It has an error `off` (remaining mesh error, `n x k`), and an error of the same size that is common to all gauges of a load.
    /// It also has an independent error of the share `own_rel`: `Cov(S_gl, S_hm) = [l = m] ((off_gl off_hl + model_rel^2 S_gl S_hl) (1 + [g = h]) +
    /// own_rel^2 S_gl^2 [g = h])`.
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
            additive: Vec::new(),
            center: Vec::new(),
            is_tested: true,
        }
    }

    /// Adds the relative error (1 sd) of a scale that all known loads of S share: `Cov(S_gl, S_hm) += sd^2 S_gl S_hm`. The factor from runs that were
    /// left out does not apply to it, since their loads were measured with the same scale.
    pub fn add_common_scale(&mut self, s: &Matrix, sd: f64) {
        if sd == 0.0 {
            return;
        }
        let (n, k) = s.shape();
        let share = (sd / self.scale).powi(2);
        for (e, row) in self.covariance.chunks_exact_mut((n * k).max(1)).enumerate() {
            let own = share * s[(e / k, e % k)];
            for (f, v) in row.iter_mut().enumerate() {
                *v += own * s[(f / k, f % k)];
            }
        }
    }

    /// Returns the covariance of the strain from the loads `f`, `n x n` by rows, without noise and `scale`.
    pub fn strain_covariance(&self, n: usize, f: &[f64]) -> Vec<f64> {
        let mut out = match self.center.is_empty() {
            true => self.change_covariance(n, (f, f)),
            false => self.change_covariance(n, (f, &self.off_center(f))),
        };
        out.iter_mut()
            .zip(&self.additive)
            .for_each(|(v, a)| *v += a);
        out
    }

    /// Returns `f - center`.
    pub fn off_center(&self, f: &[f64]) -> Vec<f64> {
        let center = self.center.iter().copied().chain(std::iter::repeat(0.0));
        f.iter().zip(center).map(|(f, c)| f - c).collect()
    }

    /// Returns `q(f)^2 C + sum_jk h_j h_k Cov(S_.j, S_.k)`, `h` the loads `from` the center.
    fn change_covariance(&self, n: usize, (f, from): (&[f64], &[f64])) -> Vec<f64> {
        let k = f.len();
        let q2 = self.mean_square_of(f);
        let mut out = vec![0.0; n * n];
        for g in 0..n {
            for h in 0..=g {
                let mut sum = q2 * self.scatter.get(g * n + h).copied().unwrap_or(0.0);
                for (j, hj) in from.iter().enumerate() {
                    let row = (g * k + j) * n * k + h * k;
                    let entries = self.covariance.get(row..row + k).unwrap_or(&[]);
                    sum += hj * entries.iter().zip(from).map(|(c, hk)| c * hk).sum::<f64>();
                }
                out[g * n + h] = sum;
                out[h * n + g] = sum;
            }
        }
        out
    }

    /// Returns the uncertainty of loads with the center `kept`, with the part `rest` of the center constant at all loads. The variance of the errors
    /// of S at both parts together is at most twice the sum of the variances at each part: `(a + b)' C (a + b) <= 2 a' C a + 2 b' C b`.
    fn with_center(&self, kept: Vec<f64>, rest: &[f64]) -> Self {
        let is_exact = rest.iter().all(|v| *v == 0.0);
        let times = if is_exact { 1.0 } else { 2.0 };
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let mut additive = self.additive.clone();
        if !is_exact {
            additive.resize(n * n, 0.0);
            let none = vec![0.0; rest.len()];
            let of_rest = self.change_covariance(n, (&none, rest));
            let both = additive.iter_mut().zip(of_rest);
            both.for_each(|(a, c)| *a += times * c);
        }
        Self {
            covariance: self.covariance.iter().map(|c| times * c).collect(),
            additive,
            center: kept,
            ..self.clone()
        }
    }

    /// Returns the mean covariance of the strain over independent loads with the standard deviations `scales`, `n x n` by rows. It contains `scale`
    /// but not the noise.
    pub fn expected_covariance(&self, n: usize, scales: &[f64]) -> Vec<f64> {
        let none = vec![0.0; scales.len()];
        let mut out = match self.additive.is_empty() && self.center.is_empty() {
            true => vec![0.0; n * n],
            false => self.strain_covariance(n, &none),
        };
        out.iter_mut().for_each(|v| *v *= self.scale * self.scale);
        for l in 0..scales.len() {
            let mut one = none.clone();
            one[l] = self.scale * scales[l];
            let of_load = self.change_covariance(n, (&one, &one));
            out.iter_mut().zip(of_load).for_each(|(a, b)| *a += b);
        }
        out
    }

    /// Returns the variance of each row of the filter output `G eps`, which is a load or a sum of loads. `gain` has one column for each gauge.
    pub fn load_forms(&self, gain: &Matrix) -> LoadForms {
        let (rows, n) = gain.shape();
        let k = (self.mean_square.len() as f64).sqrt().round() as usize;
        let scale2 = self.scale * self.scale;
        let through = |l: usize, of: &dyn Fn(usize, usize) -> f64| -> f64 {
            let pairs = (0..n).flat_map(|g| (0..n).map(move |h| (g, h)));
            pairs
                .map(|(g, h)| gain[(l, g)] * gain[(l, h)] * of(g, h))
                .sum()
        };
        let entry = |of: &[f64], at: usize| of.get(at).copied().unwrap_or(0.0);
        let mut out = LoadForms {
            center: self.center.clone(),
            ..LoadForms::default()
        };
        for l in 0..rows {
            let own = through(l, &|g, h| entry(&self.scatter, g * n + h));
            if !self.additive.is_empty() {
                let additive = through(l, &|g, h| entry(&self.additive, g * n + h));
                out.constant.push(scale2 * additive);
            }
            for j in 0..k {
                for m in 0..k {
                    let scatter = own * entry(&self.mean_square, j * k + m);
                    let of_entries = through(l, &|g, h| {
                        entry(&self.covariance, (g * k + j) * n * k + h * k + m)
                    });
                    match self.center.is_empty() {
                        true => out.loads.push(scale2 * (scatter + of_entries)),
                        false => {
                            out.loads.push(scale2 * scatter);
                            out.from_center.push(scale2 * of_entries);
                        }
                    }
                }
            }
        }
        out
    }

    /// Returns the uncertainty for some of the gauges, in the order of `gauges`.
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
            covariance: select_entries(&self.covariance, nk, &entries),
            scatter: select_entries(&self.scatter, n, &gauges),
            mean_square: self.mean_square.clone(),
            scale: self.scale,
            dof: self.dof,
            dof_outside: self.dof_outside,
            one_by_one: self.one_by_one,
            additive: match self.additive.is_empty() {
                true => Vec::new(),
                false => select_entries(&self.additive, n, &gauges),
            },
            center: self.center.clone(),
            is_tested: self.is_tested,
        }
    }

    /// Returns the uncertainty for some of the loads, in other units. `loads` contains the number of each load, and the size of its new unit in old
    /// units.
    pub fn of_loads(&self, loads: &[(usize, f64)]) -> Self {
        if !self.center.is_empty() {
            let of_load = |(l, unit): &(usize, f64)| match *unit == 0.0 {
                true => 0.0,
                false => self.center.get(*l).copied().unwrap_or(0.0) / unit,
            };
            let stays = |l: usize| loads.iter().any(|(m, unit)| *m == l && *unit != 0.0);
            let rest = self.center.iter().enumerate();
            let rest: Vec<f64> = rest.map(|(l, c)| if stays(l) { 0.0 } else { *c }).collect();
            let around = self.with_center(Vec::new(), &rest);
            return Self {
                center: loads.iter().map(of_load).collect(),
                ..around.of_loads(loads)
            };
        }
        let k = (self.mean_square.len() as f64).sqrt().round() as usize;
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let of_gauge = |g: usize| loads.iter().map(move |&(l, unit)| (g * k + l, unit));
        let entries: Vec<(usize, f64)> = (0..n).flat_map(of_gauge).collect();
        Self {
            covariance: select_entries(&self.covariance, n * k, &entries),
            scatter: self.scatter.clone(),
            mean_square: select_entries(&self.mean_square, k, loads),
            scale: self.scale,
            dof: self.dof,
            dof_outside: self.dof_outside,
            one_by_one: self.one_by_one,
            additive: self.additive.clone(),
            center: Vec::new(),
            is_tested: self.is_tested,
        }
    }

    /// Returns the uncertainty of the combined column `S f` for the load combination `f`.
    pub fn combine_loads(&self, f: &[f64]) -> Self {
        if !self.center.is_empty() {
            // `part` is the component of the center along `f`, and `rest` is the remaining vector.
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let part = dot(&self.center, f) / dot(f, f).max(f64::MIN_POSITIVE);
            let rest: Vec<f64> = (self.center.iter().zip(f))
                .map(|(c, f)| c - part * f)
                .collect();
            let largest = self.center.iter().fold(0.0_f64, |a, c| a.max(c.abs()));
            let is_rounding = rest.iter().all(|v| v.abs() <= 1e-12 * largest);
            let rest = if is_rounding {
                vec![0.0; rest.len()]
            } else {
                rest
            };
            return Self {
                center: vec![part],
                ..self.with_center(Vec::new(), &rest).combine_loads(f)
            };
        }
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let of_entries = Self {
            scatter: Vec::new(),
            ..self.clone()
        };
        Self {
            covariance: of_entries.change_covariance(n, (f, f)),
            scatter: self.scatter.clone(),
            mean_square: vec![self.mean_square_of(f)],
            additive: self.additive.clone(),
            center: Vec::new(),
            ..*self
        }
    }

    /// Returns the sum of the variances of the entries of gauge `g` of S with `k` loads.
    pub fn power(&self, g: usize, k: usize) -> f64 {
        let n = (self.scatter.len() as f64).sqrt().round() as usize;
        let variance = |e: usize| self.covariance.get(e * (n * k + 1)).copied().unwrap_or(0.0);
        self.scale * self.scale * (g * k..(g + 1) * k).map(variance).sum::<f64>()
    }

    /// Returns `q(f)^2`, strain^2.
    pub fn mean_square_of(&self, f: &[f64]) -> f64 {
        let rows = self.mean_square.chunks_exact(f.len().max(1)).zip(f);
        rows.map(|(row, fj)| fj * row.iter().zip(f).map(|(a, fk)| a * fk).sum::<f64>())
            .sum()
    }
}

/// Variance of filtered readings as a function of the loads `f`, with a part for each row of the filter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadForms {
    /// `k x k` matrix `B` by rows a row of the filter: `f' B f`.
    loads: Vec<f64>,
    /// Errors of S for loads less `center`; empty without a center.
    from_center: Vec<f64>,
    /// See [`Uncertainty::center`].
    center: Vec<f64>,
    /// Part at any load; empty: zero.
    constant: Vec<f64>,
}

impl LoadForms {
    /// Returns the variance of row `l` at loads `f`.
    pub fn variance(&self, l: usize, f: &[f64]) -> f64 {
        let constant = self.constant.get(l).copied().unwrap_or(0.0);
        let own = constant + form(&self.loads, l, f);
        if self.from_center.is_empty() {
            return own;
        }
        let off: Vec<f64> = f.iter().zip(&self.center).map(|(f, c)| f - c).collect();
        own + form(&self.from_center, l, &off)
    }

    /// Returns the variance of the change of row `l` when the loads change by `f`. Terms that do not depend on the loads cancel.
    pub fn variance_of_change(&self, l: usize, f: &[f64]) -> f64 {
        form(&self.loads, l, f) + form(&self.from_center, l, f)
    }
}

/// Returns `f' B f` with matrix number `l` of a list.
fn form(all: &[f64], l: usize, f: &[f64]) -> f64 {
    let k = f.len();
    let one = all.get(l * k * k..(l + 1) * k * k).unwrap_or(&[]);
    let rows = one.chunks_exact(k.max(1)).zip(f);
    rows.map(|(row, fj)| fj * row.iter().zip(f).map(|(b, fm)| b * fm).sum::<f64>())
        .sum()
}

/// Returns some rows and columns of a square matrix of size `order`, each times its factor.
fn select_entries(matrix: &[f64], order: usize, rows: &[(usize, f64)]) -> Vec<f64> {
    let pairs = rows.iter().flat_map(|a| rows.iter().map(move |b| (a, b)));
    let value = |((i, p), (j, q)): (&(usize, f64), &(usize, f64))| {
        p * q * matrix.get(i * order + j).copied().unwrap_or(0.0)
    };
    pairs.map(value).collect()
}

/// Returns `S' S / n`, `k x k` by rows.
pub fn mean_square(s: &Matrix) -> Vec<f64> {
    let gram = s.transpose() * s / s.nrows().max(1) as f64;
    gram.iter().copied().collect()
}
