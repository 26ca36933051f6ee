//! A record being recovered, a piece at a time.

use super::health::Health;
use super::sample_tests::TestedSamples;
use crate::recovery::MissingReadings;
use crate::recovery::dynamic::ReadingCovariance;
use crate::recovery::history::{Filter, SampleLoads};
use crate::sensitivity::Sensitivity;
use crate::series::SeriesError;
use crate::series::constant_columns::blank_readings;
use crate::series::rainflow::{Counter, Marks};
use crate::series::record::Record;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of samples in a batch, whose strain stays in the nearest cache. The thinned residuals of [`Health`] restart with each batch.
const NEAR: usize = 128;

/// Number of records in recovery at the moment.
#[derive(Default)]
pub(super) struct UnderWay(AtomicUsize);

/// One record in recovery, counted until it is dropped.
pub(super) struct ActiveRecordGuard<'a>(&'a AtomicUsize);

impl UnderWay {
    /// Counts one more record.
    pub fn begin(&self) -> ActiveRecordGuard<'_> {
        self.0.fetch_add(1, Ordering::Relaxed);
        ActiveRecordGuard(&self.0)
    }
}

impl ActiveRecordGuard<'_> {
    /// Returns the number of pieces of the record that may be in memory at a time. A single record may have as many pieces as there are threads.
    /// Several records share this number. The memory of all records therefore grows with the number of threads, not with its square. The results do
    /// not depend on it.
    pub fn pieces(&self) -> usize {
        let records = self.0.load(Ordering::Relaxed).max(1);
        rayon::current_num_threads().div_ceil(records).max(1)
    }
}

impl Drop for ActiveRecordGuard<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A record in recovery, with its active gauges.
pub(super) struct RecordRecovery {
    pub filter: Filter,
    /// S of the used gauges.
    pub sensitivity: Sensitivity,
    /// Loads at which the model's error is evaluated.
    pub typical: Vec<f64>,
    /// Gauges without a reading, or with one constant value.
    pub silent: Vec<String>,
    /// Gauges of the job.
    pub used: Vec<usize>,
    pub columns: Vec<Option<usize>>,
    /// Factors and offsets that convert a reading of each column to strain: `strain = factor * reading + offset`.
    pub scale: [Vec<f64>; 2],
    pub zero: Vec<f64>,
    /// Readings that count as missing, because the gauge is dead there: number of the used gauge, and samples.
    pub blank: Vec<(usize, Range<usize>)>,
    /// S of the used gauges, strain per report unit. It is zero for sums of loads.
    pub s: Vec<Vec<f64>>,
    /// Report units per job unit, by load and sum.
    pub factors: Vec<f64>,
    /// Samples of the record.
    pub samples: usize,
    /// Noise variance of a reading less zero, in units of the variance of a single reading.
    pub noise_factor: f64,
    /// Errors of the readings beyond this noise, if vibration was removed from them.
    pub errors_beyond: Option<Arc<ReadingCovariance>>,
    /// Number of samples after which noise is independent.
    pub apart: usize,
    /// Number of samples that are blank because vibration was removed.
    pub blank_by_filter: u64,
}

/// Result of a piece of a record.
pub(super) struct Part {
    /// Loads in report units, row by row.
    pub loads: Vec<f64>,
    /// Mark of each sample, computed from its loads ([`Marks`]).
    pub marks: Vec<u64>,
    pub health: Health,
    pub missing: MissingReadings,
    pub tested: TestedSamples,
    /// Number of samples with a missing reading, by the gauges that read.
    pub by_gauges: BTreeMap<Vec<usize>, u64>,
}

impl Part {
    /// Counts the samples with a missing reading by the gauges that read.
    fn count_gaps(&mut self, recovered: &SampleLoads) {
        for gain in recovered.gaps.iter().filter_map(|g| g.1.as_deref()) {
            match self.by_gauges.get_mut(&gain.used) {
                Some(n) => *n += 1,
                None => {
                    self.by_gauges.insert(gain.used.clone(), 1);
                }
            }
        }
    }
}

impl RecordRecovery {
    /// Returns an empty selection of samples to test.
    pub fn tested_samples(&self) -> TestedSamples {
        TestedSamples::new(
            self.used.len(),
            self.factors.len(),
            (self.samples, self.apart),
        )
    }

    /// Returns the readings of the used gauges, strain, every sample, a column each. Readings in dead parts are NaN.
    ///
    /// # Errors
    /// A piece that can't be decoded.
    pub fn strain_columns(&self, record: &Record) -> Result<Vec<Vec<f64>>, SeriesError> {
        let n = self.used.len();
        let [factors, offsets] = &self.scale;
        let mut out = vec![Vec::with_capacity(record.clock.samples); n];
        let mut strain = Vec::new();
        for piece in 0..record.n_pieces() {
            record.read(piece, &self.columns, &mut |block| {
                strain.clear();
                for row in block.values.chunks_exact(n.max(1)) {
                    let scale = factors.iter().zip(offsets);
                    strain.extend(row.iter().zip(scale).map(|(v, (a, b))| v * a + b));
                }
                blank_readings(&mut strain, n, block.first, &self.blank);
                for row in strain.chunks_exact(n.max(1)) {
                    out.iter_mut().zip(row).for_each(|(c, v)| c.push(*v));
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(out)
    }

    /// A piece of the record, decoded and recovered, its samples marked.
    ///
    /// # Errors
    /// An error if the piece cannot be decoded.
    pub fn part(&self, record: &Record, piece: usize, marks: &Marks) -> Result<Part, SeriesError> {
        let (n, k) = (self.used.len(), self.factors.len());
        let (begin, end) = record.span(piece);
        let mut part = Part {
            loads: Vec::with_capacity((end - begin) * k),
            marks: Vec::with_capacity(end - begin),
            health: Health::new(&self.s),
            missing: MissingReadings::new(k),
            tested: self.tested_samples(),
            by_gauges: BTreeMap::new(),
        };
        let [factors, offsets] = &self.scale;
        let (mut strain, mut recovered) = (Vec::new(), SampleLoads::default());
        record.read(piece, &self.columns, &mut |block| {
            let firsts = (block.first..).step_by(NEAR);
            for (values, first) in block.values.chunks(NEAR * n.max(1)).zip(firsts) {
                strain.resize(values.len(), f64::NAN);
                pulp::Arch::new().dispatch(|| {
                    let rows = values.chunks_exact(n);
                    for (out, row) in strain.chunks_exact_mut(n).zip(rows) {
                        let scale = factors.iter().zip(offsets);
                        for ((out, v), (a, b)) in out.iter_mut().zip(row).zip(scale) {
                            *out = v * a + b;
                        }
                    }
                });
                blank_readings(&mut strain, n, first, &self.blank);
                recovered.values.clear();
                recovered.gaps.clear();
                self.filter
                    .loads_of(&strain, 1.0, &mut recovered, &mut part.missing);
                part.count_gaps(&recovered);
                let loads = &mut recovered.values;
                for row in loads.chunks_exact_mut(k) {
                    row.iter_mut().zip(&self.factors).for_each(|(v, f)| *v *= f);
                }
                pulp::Arch::new().dispatch(|| {
                    for row in strain.chunks_exact_mut(n) {
                        row.iter_mut().zip(&self.zero).for_each(|(v, z)| *v -= z);
                    }
                });
                part.health.add(&strain, loads);
                part.tested.add(first, &strain, loads);
                part.loads.extend_from_slice(loads);
                marks.append_marks(loads, &mut part.marks);
            }
            ControlFlow::Continue(())
        })?;
        Ok(part)
    }
}

/// Adds consecutive pieces to the counters. Each thread counts some of the loads. It takes the samples in runs that stay in its cache for all of
/// these loads.
pub(super) fn count_pieces(counters: &mut [Counter], parts: &[Part]) {
    /// Samples of a run.
    const RUN: usize = 1024;
    let k = counters.len().max(1);
    let each = k.div_ceil(rayon::current_num_threads()).max(1);
    counters.par_chunks_mut(each).for_each(|counters| {
        for part in parts {
            for (loads, marks) in part.loads.chunks(RUN * k).zip(part.marks.chunks(RUN)) {
                counters.iter_mut().for_each(|c| c.push(loads, marks));
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_share_the_threads_among_them() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(8);
        pool.build().unwrap().install(|| {
            let all = UnderWay::default();
            let first = all.begin();
            assert_eq!(first.pieces(), 8);
            let others: Vec<ActiveRecordGuard> = (0..7).map(|_| all.begin()).collect();
            assert_eq!(first.pieces(), 1);
            let more = all.begin();
            assert_eq!(more.pieces(), 1);
            drop(others);
            assert_eq!(first.pieces(), 4);
        });
    }
}
