//! Error of quasi-static readings over a record.

use super::block::Block;
use crate::linalg::Matrix;

/// Covariance of quasi-static readings beyond noise of one variance at every gauge, strain^2.
///
/// It is the sum of two parts. The first is `N - v 1` of the filtered noise, by the gauges that read. The second is the motion `sum_j e_j e_j'`, a
/// mean square for every window of time. Its sources are one standard deviation of each mode's frequency and damping, and modes outside the model.
/// The errors of one mode are common to all gauges, loads and samples.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingCovariance {
    /// Number of gauges.
    n: usize,
    /// Samples of a window.
    window: usize,
    /// Lower triangle by rows, by window.
    motion: Vec<f64>,
    /// Number of samples in the mean of each window.
    told: Vec<f64>,
    /// Lower triangle by rows, mean of all windows.
    mean: Vec<f64>,
    /// Gauges that read, and their noise, `n_used x n_used`; the set that reads most often is first.
    noise: Vec<(Vec<usize>, Matrix)>,
}

/// Covariance of the readings of one sample in addition to independent noise, by gauge of S, `n x n`, strain^2.
#[derive(Clone, Debug, PartialEq)]
pub struct AddedCovariance {
    /// Covariance of noise, independent in every sample.
    pub noise: Matrix,
    /// Covariance of errors that all samples share.
    pub shared: Matrix,
}

impl AddedCovariance {
    /// Returns the total covariance of the gauges `used`.
    pub fn total_covariance(&self, used: &[usize]) -> Matrix {
        let n = used.len();
        let at = |a: usize, b: usize| (used[a], used[b]);
        Matrix::from_fn(n, n, |a, b| self.noise[at(a, b)] + self.shared[at(a, b)])
    }
}

/// Returns the count of numbers in the lower triangle of `n` rows.
pub fn triangle(n: usize) -> usize {
    n * (n + 1) / 2
}

impl ReadingCovariance {
    /// Creates an empty covariance for `n` gauges and the given number of samples.
    pub(super) fn new(n: usize, samples: usize, window: usize) -> Self {
        let windows = samples.div_ceil(window.max(1));
        Self {
            n,
            window: window.max(1),
            motion: vec![0.0; windows * triangle(n)],
            told: vec![0.0; windows],
            mean: vec![0.0; triangle(n)],
            noise: Vec::new(),
        }
    }

    /// Adds the noise covariance of readings of the gauges `used`, less white noise of the variance `share`.
    pub(super) fn add_noise(&mut self, used: &[usize], noise: &Matrix, share: f64) {
        let n = used.len();
        self.noise
            .push((used.to_vec(), noise - Matrix::identity(n, n) * share));
    }

    /// Adds the errors of a block of the gauges `used`.
    pub(super) fn add(&mut self, used: &[usize], block: &Block, n_told: usize) {
        let size = triangle(self.n);
        for i in 0..n_told {
            let at = (block.first_valid + i * block.step) / self.window;
            let Some(told) = self.told.get_mut(at) else {
                continue;
            };
            *told += 1.0;
            let sums = &mut self.motion[at * size..(at + 1) * size];
            for by_gauge in &block.errors {
                for (a, [x, y]) in used.iter().zip(by_gauge) {
                    for (b, [u, v]) in used.iter().zip(by_gauge).take_while(|(b, _)| *b <= a) {
                        sums[triangle(*a) + b] += 0.5 * (x[i] * u[i] + y[i] * v[i]);
                    }
                }
            }
        }
    }

    /// Converts sums to means.
    pub(super) fn settle(&mut self) {
        let size = triangle(self.n);
        let all: f64 = self.told.iter().sum();
        for (sums, told) in self.motion.chunks_exact_mut(size.max(1)).zip(&self.told) {
            for (mean, sum) in self.mean.iter_mut().zip(sums) {
                *mean += *sum / all.max(1.0);
                *sum /= told.max(1.0);
            }
        }
    }

    /// Returns the covariance of the motion error at a sample: of its window, or of the nearest window with a computed error.
    fn motion_at(&self, sample: usize) -> &[f64] {
        let size = triangle(self.n);
        let (at, windows) = (sample / self.window, self.told.len());
        let near = (0..windows).flat_map(|d| [at.checked_sub(d), at.checked_add(d)]);
        let told = |w: &usize| self.told.get(*w).is_some_and(|t| *t > 0.0);
        match near.flatten().find(told) {
            Some(w) => &self.motion[w * size..(w + 1) * size],
            None => &self.mean,
        }
    }

    /// Returns the variance of the motion error of the combination `weights` of the gauges `used`, at a sample. `None` as `sample` gives the mean
    /// over the record.
    pub fn of_motion(&self, sample: Option<usize>, used: &[usize], weights: &[f64]) -> f64 {
        let part = sample.map_or(&*self.mean, |i| self.motion_at(i));
        let mut sum = 0.0;
        for (a, x) in used.iter().zip(weights) {
            for (b, y) in used.iter().zip(weights).take_while(|(b, _)| *b < a) {
                sum += 2.0 * x * y * part[triangle(*a) + b];
            }
            sum += x * x * part[triangle(*a) + a];
        }
        sum.max(0.0)
    }

    /// Returns the noise part of the covariance of readings of the gauges `used`, `n_used x n_used`. It is from the stored set of these gauges, or
    /// else from the largest set that contains them. It is zero if no set contains them.
    pub fn of_noise(&self, used: &[usize]) -> Matrix {
        let n = used.len();
        let own = self.noise.iter().find(|(set, _)| set == used);
        let holds = |set: &[usize]| used.iter().all(|g| set.binary_search(g).is_ok());
        let Some((set, noise)) = own.or_else(|| self.noise.iter().find(|(set, _)| holds(set)))
        else {
            return Matrix::zeros(n, n);
        };
        let at: Vec<usize> = used
            .iter()
            .filter_map(|g| set.binary_search(g).ok())
            .collect();
        Matrix::from_fn(n, n, |a, b| noise[(at[a], at[b])])
    }

    /// Returns both parts at a sample in which the gauges `used` read.
    pub fn covariances_at(&self, sample: usize, used: &[usize]) -> AddedCovariance {
        let own = self.of_noise(used);
        let mut noise = Matrix::zeros(self.n, self.n);
        let mut shared = Matrix::zeros(self.n, self.n);
        let part = self.motion_at(sample);
        for (i, &a) in used.iter().enumerate() {
            for (j, &b) in used.iter().enumerate() {
                noise[(a, b)] = own[(i, j)];
                shared[(a, b)] = part[triangle(a.max(b)) + a.min(b)];
            }
        }
        AddedCovariance { noise, shared }
    }
}
