//! The filter that puts readings at rest, and how far round a sample it reaches.

use super::plant::Plant;
use super::types::{BAND_END, Unfit};
use crate::linalg::complex::ComplexMatrix;
use crate::linalg::{Complex, Matrix};
use crate::series::plans::inverse;
use rayon::prelude::*;

/// Share of the filter weights that may be beyond the reach. It causes an error of a thousandth of the loads there.
const BEYOND: f64 = 1e-3;
/// Longest transform, samples.
const LONGEST: usize = 1 << 20;
/// Samples of the first transform that is tried, in periods of the highest frequency wanted.
const PERIODS: f64 = 16.0;
/// Share of a transform that the reach may take at either side.
const SIDE: usize = 8;
/// Least share of a mode in the variance of a reading due to all modes at a frequency. Below this share the mode is omitted at that frequency. Twenty
/// omitted modes change the standard deviation by less than a hundredth.
const WORTH_ITS_TIME: f64 = 1e-3;

/// Frequencies whose noise is added up together.
const TOGETHER: usize = 256;

/// Filter `T(w) = B (1 - Psi a C G)`, with an `n x n` matrix for each frequency.
pub(super) struct Kernel {
    /// Samples of a transform.
    pub length: usize,
    /// Number of samples on either side on which a quasi-static sample depends.
    pub reach: usize,
    pub bins: Vec<Bin>,
    /// Static displacement of each uncertain mode by a unit of each load, `C`.
    pub moved: Vec<Vec<f64>>,
    /// The static gain, `k x n`.
    pub at_rest: Matrix,
    /// Covariance of quasi-static readings for noise of variance 1, `n x n`.
    pub noise: Matrix,
    /// Count of numbers that the filter stores.
    pub numbers: usize,
}

/// Filter at one frequency.
pub(super) struct Bin {
    /// Factor `B` of the band.
    pub band: f64,
    /// Gain `G`, `k x n`.
    pub gain: ComplexMatrix,
    /// Strain that motion adds to the strain of unit loads, B Psi a C, `n x k`.
    pub added: ComplexMatrix,
    /// Error of quasi-static readings by uncertain mode, `T psi`, if the response of the mode exceeds the assumed response by 1.
    pub spread: Vec<Vec<Complex<f64>>>,
    /// Increase of the response for each uncertain mode, if its frequency or its damping is larger by one standard deviation.
    pub errors: Vec<[Complex<f64>; 2]>,
    /// Error of quasi-static readings for unit loads from modes outside the model, `T (S - Psi C) a`, `n x k`; `None` without such modes.
    pub further: Option<ComplexMatrix>,
}

impl Bin {
    /// `T x` of strain `x`, columns by columns.
    fn remove_dynamic_strain(&self, x: &ComplexMatrix) -> ComplexMatrix {
        x * Complex::new(self.band, 0.0) - &self.added * (&self.gain * x)
    }
}

impl Kernel {
    /// Creates the filter for samples at `rate_hz`. It may contain at most `most_numbers` numbers.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn new(plant: &Plant<'_>, rate_hz: f64, most_numbers: usize) -> Result<Self, Unfit> {
        let mut kernel = Self::without_errors(plant, rate_hz, most_numbers)?;
        let length = kernel.length as f64;
        kernel.noise = kernel.noise_of();
        kernel.err(plant, |b| b as f64 * rate_hz / length);
        Ok(kernel)
    }

    /// Returns the filter without the covariance of its noise and without its errors. Arguments as in [`Kernel::new`].
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn without_errors(
        plant: &Plant<'_>,
        rate_hz: f64,
        most_numbers: usize,
    ) -> Result<Self, Unfit> {
        let up_to = plant.dynamics().up_to_hz;
        let end_hz = BAND_END * up_to;
        if !(2.0 * end_hz < rate_hz) {
            return Err(Unfit::Rate { rate_hz, end_hz });
        }
        let narrow = Unfit::Narrow { rate_hz, end_hz };
        let wanted = PERIODS * rate_hz / up_to;
        if !(wanted <= LONGEST as f64) {
            return Err(narrow);
        }
        let at_rest = plant.gain_at_rest().ok_or(Unfit::Untold { hz: 0.0 })?;
        let first = (wanted as usize).next_power_of_two();
        let mut length = first;
        loop {
            let n_bins = (end_hz / rate_hz * length as f64) as usize + 1;
            let numbers = n_bins.saturating_mul(numbers_of(plant));
            if length > LONGEST || numbers > most_numbers {
                if length == first {
                    return Err(too_large(plant));
                }
                if is_narrow(plant, &at_rest, length / 2, rate_hz) {
                    return Err(narrow);
                }
                let seconds = length as f64 / (2 * SIDE) as f64 / rate_hz;
                return Err(Unfit::Rings { seconds });
            }
            let hz = |b: usize| b as f64 * rate_hz / length as f64;
            let bins = (0..n_bins)
                .into_par_iter()
                .map(|b| bin(plant, hz(b)))
                .collect::<Result<Vec<Bin>, Unfit>>()?;
            let loads = of_loads(&at_rest, &bins);
            let reach = reach_of(&loads, length, at_rest.shape());
            if reach <= length / SIDE {
                return Ok(Self {
                    length,
                    reach,
                    bins,
                    moved: Vec::new(),
                    at_rest,
                    noise: Matrix::zeros(0, 0),
                    numbers,
                });
            }
            length *= 2;
        }
    }

    /// Returns the covariance of quasi-static readings for white noise of variance 1, `n x n`.
    fn noise_of(&self) -> Matrix {
        let n = self.at_rest.ncols();
        let sides = |b: usize| if b == 0 { 1.0 } else { 2.0 } / self.length as f64;
        let of_group = |(group, bins): (usize, &[Bin])| {
            let mut sum = Matrix::zeros(n, n);
            for (b, bin) in (group * TOGETHER..).zip(bins) {
                let t = bin.remove_dynamic_strain(&ComplexMatrix::identity(n, n));
                sum += (&t * t.adjoint()).map(|v| v.re * sides(b));
            }
            sum
        };
        let groups = self.bins.par_chunks(TOGETHER).enumerate().map(of_group);
        let groups: Vec<Matrix> = groups.collect();
        groups.iter().fold(Matrix::zeros(n, n), |sum, m| sum + m)
    }

    /// Adds the errors of quasi-static readings from uncertain frequencies and damping, and from modes outside the model.
    fn err(&mut self, plant: &Plant<'_>, hz: impl Fn(usize) -> f64 + Sync) {
        let erring = find_uncertain_modes(plant, &self.bins, &hz);
        let d = plant.dynamics();
        let shapes = ComplexMatrix::from_fn(plant.n_gauges(), erring.len(), |g, j| {
            plant.shapes[(g, erring[j])]
        });
        self.bins.par_iter_mut().enumerate().for_each(|(b, bin)| {
            let spread = bin.remove_dynamic_strain(&shapes);
            bin.spread = spread
                .column_iter()
                .map(|c| c.iter().copied().collect())
                .collect();
            bin.errors = erring.iter().map(|j| errors_of(plant, *j, hz(b))).collect();
            let rest =
                || bin.remove_dynamic_strain(&plant.rest) * plant.omitted_mode_response(hz(b));
            bin.further = d.further_hz.map(|_| rest());
        });
        self.moved = erring
            .iter()
            .map(|j| plant.modal_displacement(*j))
            .collect();
    }
}

/// Returns the increase of the response of mode `j` for one standard deviation more of its frequency and of its damping.
fn errors_of(plant: &Plant<'_>, j: usize, hz: f64) -> [Complex<f64>; 2] {
    let (a, mode) = (plant.answer(j, hz), &plant.dynamics().modes[j]);
    [
        a.by_frequency * mode.frequency_sd,
        a.by_damping * mode.damping_sd,
    ]
}

/// Returns the modes whose errors are large enough to compute.
fn find_uncertain_modes(
    plant: &Plant<'_>,
    bins: &[Bin],
    hz: &(impl Fn(usize) -> f64 + Sync),
) -> Vec<usize> {
    let moved: Vec<Vec<f64>> = (0..plant.n_modes())
        .map(|j| plant.modal_displacement(j))
        .collect();
    let of_bin = |(b, bin): (usize, &Bin)| -> Vec<bool> {
        let spread = bin.remove_dynamic_strain(&plant.shapes);
        let of_mode = |(j, c): (usize, &Vec<f64>)| {
            let by = ComplexMatrix::from_fn(1, c.len(), |_, l| Complex::new(c[l], 0.0)) * &bin.gain;
            let [f, z] = errors_of(plant, j, hz(b));
            spread.column(j).norm_squared() * by.norm_squared() * (f.norm_sqr() + z.norm_sqr())
        };
        let variances: Vec<f64> = moved.iter().enumerate().map(of_mode).collect();
        let all: f64 = variances.iter().sum();
        variances
            .iter()
            .map(|v| *v > WORTH_ITS_TIME * all)
            .collect()
    };
    let by_bin: Vec<Vec<bool>> = bins.par_iter().enumerate().map(of_bin).collect();
    let errs = |j: &usize| by_bin.iter().any(|b| b[*j]);
    (0..plant.n_modes()).filter(errs).collect()
}

/// Real numbers that a frequency takes.
fn numbers_of(plant: &Plant<'_>) -> usize {
    let (n, k, m) = (plant.n_gauges(), plant.n_loads(), plant.n_modes());
    2 * (3 * n * k + n * m + 2 * m)
}

fn too_large(plant: &Plant<'_>) -> Unfit {
    Unfit::Large {
        gauges: plant.n_gauges(),
        loads: plant.n_loads(),
        modes: plant.n_modes(),
    }
}

/// Returns whether the band alone, whatever the structure, reaches farther than a transform of `length` allows.
fn is_narrow(plant: &Plant<'_>, at_rest: &Matrix, length: usize, rate_hz: f64) -> bool {
    let n_bins = (BAND_END * plant.dynamics().up_to_hz / rate_hz * length as f64) as usize + 1;
    let of_bin = |b: usize| {
        let band = plant.band(b as f64 * rate_hz / length as f64);
        at_rest.map(|v| Complex::new(v * band, 0.0))
    };
    let loads: Vec<ComplexMatrix> = (0..n_bins).map(of_bin).collect();
    reach_of(&loads, length, at_rest.shape()) > length / SIDE
}

fn bin(plant: &Plant<'_>, hz: f64) -> Result<Bin, Unfit> {
    let band = plant.band(hz);
    let added = plant.added_strain(hz);
    let gain = plant.gain(&added).ok_or(Unfit::Untold { hz })?;
    Ok(Bin {
        band,
        gain,
        added: added * Complex::new(band, 0.0),
        spread: Vec::new(),
        errors: Vec::new(),
        further: None,
    })
}

/// Returns the loads by the filter and the static gain after it, per unit reading, `k x n` for each frequency.
fn of_loads(at_rest: &Matrix, bins: &[Bin]) -> Vec<ComplexMatrix> {
    let gain = at_rest.map(|v| Complex::new(v, 0.0));
    bins.par_iter()
        .map(|b| &gain * Complex::new(b.band, 0.0) - (&gain * &b.added) * &b.gain)
        .collect()
}

/// The samples to either side beyond which no load has more than [`BEYOND`] of its weights.
fn reach_of(loads: &[ComplexMatrix], length: usize, (k, n): (usize, usize)) -> usize {
    let plan = inverse(length);
    let of_load = |l: usize| {
        let mut by_lag = vec![0.0; length / 2 + 1];
        for g in 0..n {
            let mut bins = plan.make_input_vec();
            for (bin, of_bin) in bins.iter_mut().zip(loads) {
                *bin = of_bin[(l, g)];
            }
            bins[0].im = 0.0;
            let mut out = plan.make_output_vec();
            let done = plan.process(&mut bins, &mut out);
            debug_assert!(done.is_ok());
            for (i, v) in out.iter().enumerate() {
                by_lag[i.min(length - i)] += v.abs();
            }
        }
        let may_lie_beyond = BEYOND * by_lag.iter().sum::<f64>();
        let mut beyond = 0.0;
        let lags = by_lag.iter().enumerate().rev();
        let mut farther = lags.skip_while(|(_, w)| {
            beyond += **w;
            beyond <= may_lie_beyond
        });
        farther.next().map_or(0, |(lag, _)| lag)
    };
    let reaches: Vec<usize> = (0..k).into_par_iter().map(of_load).collect();
    reaches.into_iter().max().unwrap_or(0)
}
