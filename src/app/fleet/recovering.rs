//! A record being recovered, a piece at a time.

use super::health::Health;
use super::judged::Judged;
use crate::recovery::Missing;
use crate::recovery::history::{Filter, SampleLoads};
use crate::sensitivity::Sensitivity;
use crate::series::SeriesError;
use crate::series::rainflow::Counter;
use crate::series::record::Record;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// A record being recovered: the gauges of it that read.
pub(super) struct Recovering {
    pub filter: Filter,
    /// S of the used gauges.
    pub sensitivity: Sensitivity,
    /// Loads at which the model's error is weighed.
    pub typical: Vec<f64>,
    /// Gauges that give nothing, or one and the same value.
    pub silent: Vec<String>,
    /// Gauges of the job.
    pub used: Vec<usize>,
    pub columns: Vec<Option<usize>>,
    /// Strain of one unit of each column, and of none.
    pub scale: [Vec<f64>; 2],
    pub zero: Vec<f64>,
    /// S of the used gauges, strain per report unit.
    pub s: Vec<Vec<f64>>,
    /// Report units per job unit, by load.
    pub factors: Vec<f64>,
}

/// What a piece of a record gives.
pub(super) struct Part {
    /// Loads in report units, row by row.
    pub loads: Vec<f64>,
    pub health: Health,
    pub missing: Missing,
    pub judged: Judged,
}

impl Recovering {
    /// A piece of the record, decoded and recovered.
    ///
    /// # Errors
    /// What can't be decoded.
    pub fn part(&self, record: &Record, piece: usize) -> Result<Part, SeriesError> {
        let (n, k) = (self.used.len(), self.factors.len());
        let (begin, end) = record.span(piece);
        let mut part = Part {
            loads: Vec::with_capacity((end - begin) * k),
            health: Health::new(&self.s),
            missing: Missing::new(k),
            judged: Judged::new(n, k, record.clock.samples),
        };
        let [factors, offsets] = &self.scale;
        let (mut strain, mut recovered) = (Vec::new(), SampleLoads::default());
        record.read(piece, &self.columns, &mut |block| {
            strain.resize(block.values.len(), f64::NAN);
            let rows = block.values.chunks_exact(n);
            for (out, row) in strain.chunks_exact_mut(n).zip(rows) {
                let scale = factors.iter().zip(offsets);
                for ((out, v), (a, b)) in out.iter_mut().zip(row).zip(scale) {
                    *out = v * a + b;
                }
            }
            recovered.values.clear();
            recovered.gaps.clear();
            self.filter
                .loads_of(&strain, 1.0, &mut recovered, &mut part.missing);
            let loads = &mut recovered.values;
            for row in loads.chunks_exact_mut(k) {
                row.iter_mut().zip(&self.factors).for_each(|(v, f)| *v *= f);
            }
            for row in strain.chunks_exact_mut(n) {
                row.iter_mut().zip(&self.zero).for_each(|(v, z)| *v -= z);
            }
            part.health.add(&strain, loads);
            part.judged.add(block.first, &strain, loads);
            part.loads.extend_from_slice(loads);
            ControlFlow::Continue(())
        })?;
        Ok(part)
    }
}

/// Counts what pieces that follow each other give.
pub(super) fn counted(counters: &mut [Counter], parts: &[Part]) {
    counters.par_iter_mut().for_each(|c| {
        for part in parts {
            c.push(&part.loads);
        }
    });
}
