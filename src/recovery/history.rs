//! Records of any length: one estimate, samples streamed through it in blocks, constant memory.

use super::dynamic::ReadingCovariance;
use super::errors::ErrorModel;
use super::gain::Gain;
use super::kernel::Samples;
use super::missing_readings::MissingReadings;
use super::reading_plausibility::LARGEST_STRAIN;
use super::sums::Sums;
use super::types::Widening;
use crate::sensitivity::Sensitivity;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, PoisonError, RwLock};

/// Number of sets of silent gauges whose estimate is cached. The estimate of any further set is computed again for every sample that needs it.
const KEPT: usize = 4096;

/// Estimate of the loads of samples, `f = gain (eps - zero)`, with the data for their intervals. If gauges have no reading, the estimate is from the
/// other gauges.
#[derive(Debug)]
pub struct Filter {
    /// From all gauges.
    whole: Arc<Gain>,
    /// `k x n`, by rows.
    gain: Vec<f64>,
    /// `n x k`, S by rows.
    rows: Vec<f64>,
    /// Subtracted from each sample, strain.
    zero: Vec<f64>,
    s: Sensitivity,
    errors: ErrorModel,
    noise_factor: f64,
    typical: Vec<f64>,
    widening: Widening,
    /// Error of the readings in addition to these errors, sample by sample.
    reading_covariance: Option<Arc<ReadingCovariance>>,
    /// Sums of loads that are listed after the loads.
    sums: Vec<Vec<(usize, f64)>>,
    /// Estimates by the set of gauges that read.
    others: RwLock<HashMap<Vec<usize>, Option<Arc<Gain>>>>,
}

/// Loads of samples.
#[derive(Clone, Debug, Default)]
pub struct SampleLoads {
    /// Values of the loads, `n_loads` for each sample. NaN for a load that the active gauges don't determine.
    pub values: Vec<f64>,
    /// Samples in which a gauge has no reading, ascending, with the estimate used for each.
    pub gaps: Vec<(usize, Option<Arc<Gain>>)>,
}

impl Filter {
    /// Returns the filter for `s` with `zero` (strain by gauge) subtracted. The weights include the model error at `typical` loads. The intervals
    /// include `widening`. `None` if numbers are not finite.
    pub fn new(
        s: &Sensitivity,
        zero: Vec<f64>,
        errors: ErrorModel,
        noise_factor: f64,
        typical: &[f64],
        widening: Widening,
    ) -> Option<Self> {
        let all: Vec<usize> = (0..s.gauges.len()).collect();
        let mut filter = Self {
            whole: Arc::new(Gain::new(s, &all, errors, noise_factor, typical)?),
            gain: Vec::new(),
            rows: Vec::new(),
            sums: Vec::new(),
            reading_covariance: None,
            zero,
            s: s.clone(),
            errors,
            noise_factor,
            typical: typical.to_vec(),
            widening,
            others: RwLock::new(HashMap::new()),
        };
        filter.lay_out();
        Some(filter)
    }

    /// Adds further errors of the readings beyond the errors of the filter. Call it before sums of loads are added.
    pub fn add_reading_covariance(&mut self, reading_covariance: Arc<ReadingCovariance>) {
        let noise = reading_covariance.of_noise(&self.whole.used);
        self.whole = Arc::new(self.whole.with_noise(&noise));
        self.reading_covariance = Some(reading_covariance);
        self.others = RwLock::new(HashMap::new());
    }

    /// Adds sums of loads (loads and factors) after the loads.
    pub fn combine(&mut self, sums: &[Vec<(usize, f64)>]) {
        self.whole = Arc::new(self.whole.with_sums(sums));
        self.sums = sums.to_vec();
        self.others = RwLock::new(HashMap::new());
        self.lay_out();
    }

    /// Arranges the gain by load and S by gauge, in the order in which a sample uses them. Rows of S have zeros for sums of loads.
    fn lay_out(&mut self) {
        let (n, k) = (self.s.gauges.len(), self.whole.n_loads());
        let own = self.s.loads.len();
        self.gain = (0..k)
            .flat_map(|l| (0..n).map(move |g| (l, g)))
            .map(|at| self.whole.gain[at])
            .collect();
        self.rows = (0..n)
            .flat_map(|g| (0..k).map(move |l| (g, l)))
            .map(|(g, l)| if l < own { self.s.values[(g, l)] } else { 0.0 })
            .collect();
    }

    /// Computes the loads of samples (`n_gauges` readings each, times `to_strain`), and adds them to `out` and `sums`.
    pub fn apply(&self, samples: &[f64], to_strain: f64, out: &mut SampleLoads, sums: &mut Sums) {
        let missing = self.recover(samples, to_strain, out, Some(sums));
        sums.missing.merge(&missing);
    }

    /// Computes the loads of samples like [`Filter::apply`], with a count of missing readings but without sums. This takes half of the arithmetic.
    pub fn loads_of(
        &self,
        samples: &[f64],
        to_strain: f64,
        out: &mut SampleLoads,
        missing: &mut MissingReadings,
    ) {
        missing.merge(&self.recover(samples, to_strain, out, None));
    }

    fn recover(
        &self,
        samples: &[f64],
        to_strain: f64,
        out: &mut SampleLoads,
        mut sums: Option<&mut Sums>,
    ) -> MissingReadings {
        let (n, k) = (self.n_gauges(), self.n_loads());
        let before = out.values.len() / k.max(1);
        let mut gaps = Vec::new();
        pulp::Arch::new().dispatch(Samples {
            gain: &self.gain,
            s: &self.rows,
            zero: &self.zero,
            samples,
            to_strain,
            out: &mut out.values,
            gaps: &mut gaps,
            sums: sums.as_deref_mut(),
        });
        let mut missing = MissingReadings::new(k);
        missing.whole = (samples.len() / n.max(1) - gaps.len()) as u64;
        for at in gaps {
            let readings = samples.get(at * n..(at + 1) * n).unwrap_or_default();
            let gain = self.with_gap(
                readings,
                to_strain,
                &mut out.values,
                (before + at) * k,
                sums.as_deref_mut(),
                &mut missing,
            );
            out.gaps.push((before + at, gain));
        }
        missing
    }

    /// Computes the loads of a sample in which some gauge has no reading from the other gauges, and returns the estimate used.
    fn with_gap(
        &self,
        readings: &[f64],
        to_strain: f64,
        out: &mut [f64],
        at: usize,
        sums: Option<&mut Sums>,
        missing: &mut MissingReadings,
    ) -> Option<Arc<Gain>> {
        let mut strain: Vec<f64> = readings
            .iter()
            .zip(&self.zero)
            .map(|(v, z)| v * to_strain - z)
            .collect();
        for v in &mut strain {
            if v.abs() > LARGEST_STRAIN {
                missing.impossible += 1;
                *v = f64::NAN;
            }
        }
        missing.gaps += 1;
        let used: Vec<usize> = (0..strain.len())
            .filter(|&g| strain[g].is_finite())
            .collect();
        let gain = self.estimate(used)?;
        let loads = gain.loads(&strain);
        for (l, v) in loads.iter().enumerate().filter(|(l, _)| gain.is_seen(*l)) {
            if let Some(slot) = out.get_mut(at + l) {
                *slot = *v;
            }
            if let Some(known) = missing.known_in_gaps.get_mut(l) {
                *known += 1;
            }
        }
        if let Some(sums) = sums {
            self.sum_up(&gain, &strain, &loads, sums);
        }
        Some(gain)
    }

    /// Adds a sample in which at least one gauge has no reading.
    fn sum_up(&self, gain: &Gain, strain: &[f64], loads: &[f64], sums: &mut Sums) {
        for (l, v) in loads.iter().enumerate().filter(|(l, _)| gain.is_seen(*l)) {
            sums.min[l] = sums.min[l].min(*v);
            sums.max[l] = sums.max[l].max(*v);
            sums.sum[l] += v;
            sums.sum_of_squares[l] += v * v;
        }
        for &g in &gain.used {
            let row = self.s.values.row(g);
            let predicted: f64 = row.iter().zip(loads).map(|(s, f)| s * f).sum();
            sums.reading[g] += strain[g] * strain[g];
            sums.residual[g] += (strain[g] - predicted).powi(2);
            sums.read_in_gaps[g] += 1;
        }
    }

    /// Returns the estimate from the gauges `used` only. `None` if no gauge reads.
    pub fn estimate(&self, used: Vec<usize>) -> Option<Arc<Gain>> {
        if used.is_empty() {
            return None;
        }
        let kept = self.others.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = kept.get(&used) {
            return found.clone();
        }
        drop(kept);
        let new = Gain::new(
            &self.s,
            &used,
            self.errors,
            self.noise_factor,
            &self.typical,
        )
        .map(|g| match &self.reading_covariance {
            Some(reading_covariance) => g.with_noise(&reading_covariance.of_noise(&g.used)),
            None => g,
        })
        .map(|g| Arc::new(g.with_sums(&self.sums)));
        let mut kept = self.others.write().unwrap_or_else(PoisonError::into_inner);
        if kept.len() < KEPT {
            kept.insert(used, new.clone());
        }
        new
    }

    /// Returns the stretches of a record in which some gauges are dead, in order, each with the estimate from the other gauges. `dead` contains
    /// gauges and samples. A stretch without another gauge is not returned.
    pub fn stretches(&self, dead: &[(usize, Range<usize>)]) -> Vec<(Range<usize>, Arc<Gain>)> {
        let ends = dead.iter().flat_map(|(_, part)| [part.start, part.end]);
        let mut ends: Vec<usize> = ends.collect();
        ends.sort_unstable();
        ends.dedup();
        let of_stretch = |border: &[usize]| {
            let [from, to] = border else { return None };
            let is_dead = |g: &usize| dead.iter().any(|(d, part)| d == g && part.contains(from));
            let left: Vec<usize> = (0..self.n_gauges()).filter(|g| !is_dead(g)).collect();
            let some = left.len() < self.n_gauges();
            some.then(|| Some((*from..*to, self.estimate(left)?)))?
        };
        ends.windows(2).filter_map(of_stretch).collect()
    }

    /// Returns the standard deviation of each load of a sample with loads `f`, if all gauges read. The readings' error is its mean over the record.
    pub fn sigma(&self, f: &[f64]) -> Vec<f64> {
        self.sigma_of((&self.whole, None), f)
    }

    /// Returns the standard deviation of each load of a sample in which only the gauges of `gain` read.
    pub fn sigma_with(&self, gain: &Gain, f: &[f64]) -> Vec<f64> {
        self.sigma_of((gain, None), f)
    }

    /// Returns the standard deviation of each load of one sample of the record, by its number; `gain` is `None` if all gauges read.
    pub fn sigma_at(&self, sample: usize, gain: Option<&Gain>, f: &[f64]) -> Vec<f64> {
        self.sigma_of((gain.unwrap_or(&self.whole), Some(sample)), f)
    }

    fn sigma_of(&self, (gain, sample): (&Gain, Option<usize>), f: &[f64]) -> Vec<f64> {
        // An unknown load has no value and is set to zero, so that its coefficients add no error.
        let known: Vec<f64> = f
            .iter()
            .map(|v| if v.is_finite() { *v } else { 0.0 })
            .collect();
        let mut sigma = gain.sigma(&known, &self.widening);
        for (l, s) in sigma.iter_mut().enumerate() {
            *s = s.hypot(self.of_motion(gain, sample, l).sqrt());
        }
        sigma
    }

    /// Returns the variance that motion leaves in load `l`; the widening by residuals does not change it.
    fn of_motion(&self, gain: &Gain, sample: Option<usize>, l: usize) -> f64 {
        let reading_covariance = self.reading_covariance.as_ref();
        reading_covariance.map_or(0.0, |d| d.of_motion(sample, &gain.used, &gain.weights(l)))
    }

    /// Returns the half width of the 95 % interval divided by sigma.
    pub fn coverage_factor(&self) -> f64 {
        self.widening.coverage_factor
    }

    /// Returns the standard deviation of a change of load `l` between the samples with the numbers `ends`. `change` is the change of all loads, NaN
    /// for an unknown load. `gain` is the estimate used, or `None` for the estimate from all gauges. The motion error oscillates with the load. At
    /// turning points it is largest, root 2 of its rms value, with opposite signs at both ends.
    pub fn sigma_of_change(
        &self,
        gain: Option<&Gain>,
        l: usize,
        change: &[f64],
        ends: [usize; 2],
    ) -> f64 {
        let known = |v: &f64| if v.is_finite() { *v } else { 0.0 };
        let known: Vec<f64> = change.iter().map(known).collect();
        let gain = gain.unwrap_or(&self.whole);
        let own = gain.sigma_of_change(l, &known, &self.widening);
        let [from, to] = ends.map(|i| (2.0 * self.of_motion(gain, Some(i), l)).sqrt());
        own.hypot(from + to)
    }

    /// Returns the estimate from all gauges.
    pub fn gain_of_all_gauges(&self) -> &Gain {
        &self.whole
    }

    /// Returns the number of loads.
    pub fn n_loads(&self) -> usize {
        self.whole.n_loads()
    }

    /// Returns the number of gauges.
    pub fn n_gauges(&self) -> usize {
        self.zero.len()
    }
}
