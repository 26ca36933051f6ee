//! The loads of a record in memory.

use super::sink::{Block, RecordHead, RecordSink, Sample, Samples};
use crate::host::fault::Fault;
use std::sync::Arc;

/// Every sample of a record.
#[derive(Clone, Debug, Default)]
pub struct History {
    head: Option<Arc<RecordHead>>,
    blocks: Vec<Block>,
}

/// A sample in report units.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRow {
    /// Time, s.
    pub time: f64,
    /// Value, low and high end of the 95 % interval, by load; `None` if the active gauges don't determine the load.
    pub loads: Vec<Option<[f64; 3]>>,
}

impl History {
    /// Returns the samples in order of time.
    pub fn rows(&self) -> impl Iterator<Item = HistoryRow> {
        let head = self.head.iter();
        let samples = head.flat_map(|h| {
            let blocks = self.blocks.iter();
            blocks.flat_map(move |b| b.samples(h.n_loads()).map(move |s| (h, s)))
        });
        samples.map(|(head, sample): (_, Sample)| HistoryRow {
            time: sample.time,
            loads: head.intervals(&sample).collect(),
        })
    }

    /// Returns the samples in order of time.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}

impl RecordSink for History {
    fn begin(&mut self, head: &Arc<RecordHead>) -> Result<(), Fault> {
        self.head = Some(Arc::clone(head));
        self.blocks.clear();
        Ok(())
    }

    fn take(&mut self, mut blocks: Vec<Block>) -> Result<(), Fault> {
        self.blocks.append(&mut blocks);
        Ok(())
    }

    fn end(&mut self, _: u64) -> Result<(), Fault> {
        Ok(())
    }

    fn samples(&self) -> Result<Box<dyn Samples + '_>, Fault> {
        Ok(Box::new(self))
    }
}

impl Samples for &History {
    fn n_samples(&self) -> usize {
        let last = self.blocks.last();
        last.map_or(0, |b| b.first + b.times.len())
    }

    fn read(&self, from: usize, to: usize, columns: &[usize], out: &mut Vec<f64>) {
        let Some(head) = &self.head else { return };
        let k = head.n_loads();
        let begin = self.blocks.partition_point(|b| b.first <= from);
        for block in &self.blocks[begin.saturating_sub(1)..] {
            if block.first >= to {
                break;
            }
            let range = from.saturating_sub(block.first)..block.times.len().min(to - block.first);
            for i in range {
                out.extend(columns.iter().map(|&l| {
                    let value = block.loads.values.get(i * k + l);
                    let factor = head.units.get(l).map_or(1.0, |u| u.factor);
                    f64::from(value.map_or(f64::NAN, |v| v * factor) as f32)
                }));
            }
        }
    }
}
