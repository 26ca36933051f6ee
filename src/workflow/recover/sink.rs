//! Receivers of the loads of a record. Loads arrive in blocks, in order of time, and are not stored here.

use crate::host::fault::Fault;
use crate::job::LoadFile;
use crate::recovery::Gain;
use crate::recovery::history::{Filter, SampleLoads};
use crate::strain_chain::LoadUnits;
use std::ops::Range;
use std::sync::Arc;

/// Receiver of the loads of a record during recovery.
pub trait RecordSink {
    /// Starts the loads of a record. It is called before the first block.
    ///
    /// # Errors
    /// A fault if a file cannot be created.
    fn begin(&mut self, head: &Arc<RecordHead>) -> Result<(), Fault>;

    /// Receives the next blocks, in order of time.
    ///
    /// # Errors
    /// A fault if the blocks cannot be stored. The rest of the record is then not read.
    fn take(&mut self, blocks: Vec<Block>) -> Result<(), Fault>;

    /// Completes the loads of the record. It is called after the last block, with the number of samples.
    ///
    /// # Errors
    /// A fault if a file cannot be completed.
    fn end(&mut self, samples: u64) -> Result<(), Fault>;

    /// Returns the recorded samples, to be read again. It is called after the last block, and only if [`RecordHead::is_read_again`].
    ///
    /// # Errors
    /// A fault if the samples cannot be read.
    fn samples(&self) -> Result<Box<dyn Samples + '_>, Fault>;
}

/// Samples of a record, read in any order.
pub trait Samples: Sync {
    /// Returns the number of samples.
    fn n_samples(&self) -> usize;

    /// Appends the loads `columns` of samples `from .. to`, report units, rounded to single precision. A load that is not known is NaN.
    fn read(&self, from: usize, to: usize, columns: &[usize], out: &mut Vec<f64>);
}

/// Receiver that discards the loads of a record.
pub(super) struct Unheard;

impl RecordSink for Unheard {
    fn begin(&mut self, _: &Arc<RecordHead>) -> Result<(), Fault> {
        Ok(())
    }

    fn take(&mut self, _: Vec<Block>) -> Result<(), Fault> {
        Ok(())
    }

    fn end(&mut self, _: u64) -> Result<(), Fault> {
        Ok(())
    }

    fn samples(&self) -> Result<Box<dyn Samples + '_>, Fault> {
        Ok(Box::new(Self))
    }
}

impl Samples for Unheard {
    fn n_samples(&self) -> usize {
        0
    }

    fn read(&self, _: usize, _: usize, _: &[usize], _: &mut Vec<f64>) {}
}

/// Description of the loads of a record before its first sample.
#[derive(Debug)]
pub struct RecordHead {
    /// The strain file, as the job names it.
    pub file: String,
    /// Loads, then combinations.
    pub names: Vec<String>,
    /// Units of loads and combinations.
    pub units: Vec<LoadUnits>,
    /// The estimate of every sample.
    pub filter: Filter,
    /// Time of the first sample, s.
    pub first_s: f64,
    /// Time between samples, s.
    pub step_s: f64,
    /// `loads.csv` has a row for every n-th sample, with this n.
    pub stride: usize,
    /// Files to make from the history.
    pub files: Vec<LoadFile>,
    /// Share of the range of a load below which `turning_points.csv` leaves out its reversals; no such file if `None`.
    pub turning_points: Option<f64>,
    /// Whether loads are compared with recorded loads or counted by section.
    pub is_compared: bool,
    /// Stretches of samples in which some gauges are dead, and the estimate from the remaining gauges.
    pub stretches: Vec<(Range<usize>, Arc<Gain>)>,
}

impl RecordHead {
    /// Returns the number of loads, including combinations.
    pub fn n_loads(&self) -> usize {
        self.names.len()
    }

    /// Returns the estimate of a sample in such a stretch; `None` if all gauges read.
    pub fn estimate_at(&self, sample: usize) -> Option<&Gain> {
        let stretch = self.stretches.iter().find(|s| s.0.contains(&sample));
        stretch.map(|s| &*s.1)
    }

    /// Returns whether an output reads the whole history a second time.
    pub fn is_read_again(&self) -> bool {
        !self.files.is_empty() || self.turning_points.is_some() || self.is_compared
    }

    /// Returns value, low and high end of the 95 % interval of each load of a sample, report units. Returns `None` for a load that the active gauges
    /// don't determine.
    pub fn intervals<'a>(
        &'a self,
        sample: &Sample<'a>,
    ) -> impl Iterator<Item = Option<[f64; 3]>> + 'a {
        let sigma = self.filter.sigma_at(sample.at, sample.gap, sample.loads);
        let loads = sample.loads.iter().zip(sigma).zip(&self.units);
        loads.map(|((v, s), u)| {
            let half = self.filter.coverage_factor() * s;
            let known = v.is_finite() && s.is_finite();
            known.then_some([*v, v - half, v + half].map(|v| v * u.factor))
        })
    }
}

/// Some consecutive samples.
#[derive(Clone, Debug)]
pub struct Block {
    /// Number of the first sample in the record.
    pub first: usize,
    /// Times, s.
    pub times: Vec<f64>,
    /// Loads, job units.
    pub loads: SampleLoads,
}

/// A sample.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Number of the sample in the record.
    pub at: usize,
    /// Time, s.
    pub time: f64,
    /// Loads, job units; NaN if the active gauges don't determine them.
    pub loads: &'a [f64],
    /// Estimate without the gauges that give no reading; `None` if all gauges read.
    pub gap: Option<&'a Gain>,
}

impl Block {
    /// Returns the samples of `n_loads` loads each.
    pub fn samples(&self, n_loads: usize) -> impl Iterator<Item = Sample<'_>> {
        let mut gaps = self.loads.gaps.iter().peekable();
        let loads = self.loads.values.chunks_exact(n_loads.max(1));
        let samples = self.times.iter().zip(loads).enumerate();
        samples.map(move |(i, (time, loads))| {
            let gap = gaps.next_if(|g| g.0 == i);
            Sample {
                at: self.first + i,
                time: *time,
                loads,
                gap: gap.and_then(|g| g.1.as_deref()),
            }
        })
    }
}
