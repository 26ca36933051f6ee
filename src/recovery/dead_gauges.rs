//! Gauges without a signal, or with a constant reading, over a part of a record in which the strain predicted from the other gauges changes. Such a
//! gauge is dead in that part and valid in the rest of the record.

use super::errors::ErrorModel;
use super::gain::Gain;
use super::types::Widening;
use crate::sensitivity::Sensitivity;
use crate::series::constant_columns::Gives;

/// Divisor of the number of examined samples, for the shortest part to find: the test of residuals covers shorter parts.
const PART: usize = 20;
/// Samples of a part at least.
const LEAST: usize = 10;

/// Returns the number of successive samples with one value, from which on a gauge is tested for a dead part. The record has `samples` samples.
pub fn shortest_part(samples: usize) -> usize {
    (samples / PART).max(LEAST)
}
/// Least change of the strain predicted from the other gauges, in standard deviations of noise and model error. A working gauge shows such a change,
/// however coarsely its reading is rounded.
const CHANGES: f64 = 3.0;
/// Share of the samples of a part in which another gauge must read to test this gauge.
const READS: f64 = 0.9;

/// A part of a record in which a gauge is dead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeadGaugeSpan {
    /// Gauge of S.
    pub gauge: usize,
    /// Content of the gauge's column in that part.
    pub gives: Gives,
    /// First and last of the examined samples in that part.
    pub span: [usize; 2],
    /// Examined samples before and after the part: the gauge is active up to the first and from the second.
    pub within: [usize; 2],
}

/// Returns the dead parts of gauges from samples spread over a record: number of the sample, strain minus zero by gauge (NaN for no reading).
pub fn check(
    s: &Sensitivity,
    samples: &[(usize, &[f64])],
    errors: ErrorModel,
    noise_factor: f64,
) -> Vec<DeadGaugeSpan> {
    let n = s.gauges.len();
    let least = shortest_part(samples.len());
    let of_gauge = |g: usize| {
        let runs = runs_of(samples, g, least).into_iter();
        runs.map(move |(gives, run)| (g, gives, run))
    };
    let runs: Vec<(usize, Gives, [usize; 2])> = (0..n).flat_map(of_gauge).collect();
    if runs.is_empty() {
        return Vec::new();
    }
    let mut rows: Vec<Vec<f64>> = samples.iter().map(|s| s.1.to_vec()).collect();
    for (g, _, [from, to]) in &runs {
        for v in rows.iter_mut().take(*to).skip(*from) {
            v[*g] = f64::NAN;
        }
    }
    let dead = |(g, gives, [from, to]): &(usize, Gives, [usize; 2])| {
        let part = &rows[*from..*to];
        let number = |j: usize| samples.get(j).map_or(usize::MAX, |s| s.0);
        is_dead(s, part, *g, *gives, least, errors, noise_factor).then(|| DeadGaugeSpan {
            gauge: *g,
            gives: *gives,
            span: [number(*from), number(*to - 1)],
            within: [from.checked_sub(1).map_or(0, number), number(*to)],
        })
    };
    runs.iter().filter_map(dead).collect()
}

/// Returns parts of a record, by first and last examined sample, in which no gauge changes by a digit although the gauges change elsewhere. In such a
/// part the structure is at standstill, or the logger repeats one sample. `samples` as in [`check`].
pub fn still_parts(samples: &[(usize, &[f64])]) -> Vec<[usize; 2]> {
    /// Least number of gauges. So many gauges do not stay constant to the last digit by chance.
    const MANY: usize = 3;
    let reads = |row: &[f64]| row.iter().filter(|v| v.is_finite()).count() >= MANY;
    let alike = |a: &[f64], b: &[f64]| {
        let mut pairs = a.iter().zip(b);
        reads(a) && pairs.all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
    };
    let parts = samples.chunk_by(|a, b| alike(a.1, b.1));
    let parts: Vec<[usize; 2]> = parts
        .filter(|part| part.len() >= LEAST && part.len() < samples.len())
        .filter_map(|part| Some([part.first()?.0, part.last()?.0]))
        .collect();
    parts
}

/// Returns the ranges, without their ends, in which a gauge has no reading or a constant reading for at least `least` samples. For a constant reading
/// only samples with a number count.
fn runs_of(samples: &[(usize, &[f64])], gauge: usize, least: usize) -> Vec<(Gives, [usize; 2])> {
    let value = |j: usize| samples[j].1.get(gauge).copied().unwrap_or(f64::NAN);
    let (known, blank): (Vec<usize>, Vec<usize>) =
        (0..samples.len()).partition(|j| value(*j).is_finite());
    let one_value = known.chunk_by(|a, b| value(*a) == value(*b));
    let nothing = blank.chunk_by(|a, b| a + 1 == *b);
    let runs = one_value.map(|run| (Gives::OneValue, run));
    let runs = runs.chain(nothing.map(|run| (Gives::Nothing, run)));
    runs.filter(|(_, run)| run.len() >= least)
        .filter_map(|(gives, run)| Some((gives, [*run.first()?, *run.last()? + 1])))
        .collect()
}

/// Returns whether the other gauges show that gauge `g` is dead in a part. A gauge without readings is dead if they read; a gauge with a constant
/// reading is dead if the strain changes.
fn is_dead(
    s: &Sensitivity,
    part: &[Vec<f64>],
    g: usize,
    gives: Gives,
    least: usize,
    errors: ErrorModel,
    noise_factor: f64,
) -> bool {
    let reads = |h: &usize| {
        let n = part.iter().filter(|row| row[*h].is_finite()).count();
        n as f64 >= READS * part.len() as f64
    };
    let used: Vec<usize> = (0..s.gauges.len()).filter(reads).collect();
    let whole = |row: &&Vec<f64>| used.iter().all(|h| row[*h].is_finite());
    let rows: Vec<&Vec<f64>> = part.iter().filter(whole).collect();
    if used.is_empty() || rows.len() < least.min(part.len()) / 2 {
        return false;
    }
    // A valid gauge with a wrong zero is also constant at standstill. So only a change of strain shows that the gauge is dead, not the value.
    let changes = || match GaugePrediction::new(s, &used, g, errors, noise_factor) {
        Some(others) => others.change(&rows),
        None => any_changes(&used, &rows, errors.noise_variance(noise_factor)),
    };
    gives == Gives::Nothing || changes()
}

/// Returns whether the gauges `used` show that gauge `g`, which has one value in all rows, is dead. Each row is a sample of strain by gauge of S. The
/// gauge is dead if its strain predicted from the used gauges changes by more than noise and model error. It is also dead if the mean of the
/// predicted strain differs from the value by more. If the used gauges don't predict its strain, it is dead if any used gauge changes by more than
/// noise.
pub fn is_shown_dead(
    s: &Sensitivity,
    used: &[usize],
    rows: &[&Vec<f64>],
    g: usize,
    errors: ErrorModel,
    noise_factor: f64,
) -> bool {
    match GaugePrediction::new(s, used, g, errors, noise_factor) {
        Some(others) => others.change(rows) || others.contradict(rows, g),
        None => any_changes(used, rows, errors.noise_variance(noise_factor)),
    }
}

/// Returns whether any gauge of `used` changes by more than noise.
fn any_changes(used: &[usize], rows: &[&Vec<f64>], noise: f64) -> bool {
    let of = |h: &usize| variance(rows.iter().map(|row| row[*h]));
    used.iter().any(|h| of(h) > CHANGES * CHANGES * noise)
}

/// Prediction of the strain at one gauge from some other gauges.
struct GaugePrediction<'a> {
    s: &'a Sensitivity,
    used: &'a [usize],
    errors: ErrorModel,
    noise: f64,
    /// Row of S of the predicted gauge.
    own: Vec<f64>,
    gain: Gain,
    /// Covariance of the loads from noise alone.
    of_noise: Vec<f64>,
}

impl<'a> GaugePrediction<'a> {
    /// Returns the prediction; `None` if the other gauges don't determine a load that strains the gauge.
    fn new(
        s: &'a Sensitivity,
        used: &'a [usize],
        g: usize,
        errors: ErrorModel,
        noise_factor: f64,
    ) -> Option<Self> {
        let none = vec![0.0; s.loads.len()];
        let own: Vec<f64> = s.values.row(g).iter().copied().collect();
        let gain = Gain::new(s, used, errors, noise_factor, &none)?;
        let mut acts = own.iter().enumerate().filter(|(_, s)| **s != 0.0);
        acts.all(|(l, _)| gain.is_seen(l)).then(|| Self {
            s,
            used,
            errors,
            noise: errors.noise_of(s, g, noise_factor),
            of_noise: gain.covariance(&none, &Widening::none()),
            own,
            gain,
        })
    }

    /// Returns whether the predicted strain of the gauge changes by more than its error.
    fn change(&self, rows: &[&Vec<f64>]) -> bool {
        let loads: Vec<Vec<f64>> = rows.iter().map(|row| self.gain.loads(row)).collect();
        let change = variance(loads.iter().map(|f| self.strain(f)));
        let sd = |l: usize| variance(loads.iter().map(|f| f[l])).sqrt();
        let sizes: Vec<f64> = (0..self.own.len()).map(sd).collect();
        change > CHANGES * CHANGES * self.variance(&sizes)
    }

    /// Returns whether the mean of the predicted strain differs from the mean reading of gauge `g` by more than its error.
    fn contradict(&self, rows: &[&Vec<f64>], g: usize) -> bool {
        let n = rows.len().max(1) as f64;
        let mut loads = vec![0.0; self.own.len()];
        for f in rows.iter().map(|row| self.gain.loads(row)) {
            loads.iter_mut().zip(f).for_each(|(sum, f)| *sum += f / n);
        }
        let off = rows.iter().map(|row| row[g]).sum::<f64>() / n - self.strain(&loads);
        off * off > CHANGES * CHANGES * self.variance(&loads)
    }

    /// Returns the loads that strain the gauge.
    fn acts(&self) -> impl Iterator<Item = (usize, f64)> {
        let all = self.own.iter().copied().enumerate();
        all.filter(|(_, s)| *s != 0.0)
    }

    /// Returns the strain of the gauge at these loads.
    fn strain(&self, loads: &[f64]) -> f64 {
        self.acts().map(|(l, s)| s * loads[l]).sum()
    }

    /// Returns the variance of a reading about its prediction, at loads of these sizes. It includes the noise of all gauges and their model error.
    fn variance(&self, sizes: &[f64]) -> f64 {
        let k = sizes.len();
        let noise = self.acts().flat_map(|(l, a)| {
            let with = move |(m, b): (usize, f64)| a * b * self.of_noise[l * k + m];
            self.acts().map(with)
        });
        let model = self.used.iter().enumerate().map(|(i, h)| {
            let share: f64 = self.acts().map(|(l, s)| s * self.gain.gain[(l, i)]).sum();
            let row = self.s.values.row(*h);
            share
                * share
                * self
                    .errors
                    .model_error_covariance(row.iter().copied(), sizes, sizes)
        });
        let own = self
            .errors
            .model_error_covariance(self.own.iter().copied(), sizes, sizes);
        self.noise + noise.sum::<f64>() + model.sum::<f64>() + own
    }
}

/// About their mean.
fn variance(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let n = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / n;
    values.map(|v| (v - mean).powi(2)).sum::<f64>() / n
}
