//! A record of any length, a piece at a time: readings, and the loads that a filter makes of them.

use super::csv_record::{self, Layout};
use crate::app::fault::Fault;
use crate::app::files::FileBytes;
use crate::app::job::correct::Channel;
use crate::recovery::Sums;
use crate::recovery::history::{Filter, SampleLoads};
use crate::series::binary::{self, Header};
use crate::series::{Channels, rpc};
use crate::units::MICROSTRAIN;

/// Samples a piece of a binary record.
const SAMPLES: usize = 16_384;
/// Samples of a piece taken at a time, few enough to stay in the processor's cache.
const BLOCK: usize = 512;
/// Bytes a piece of a CSV record.
pub(super) const BYTES: usize = 4 << 20;
/// Pieces in memory at a time.
pub(super) const GROUP: usize = 8;

/// How a record is stored.
pub(super) enum Source {
    Binary(Header),
    /// RPC III, channels in microstrain.
    Rpc(rpc::Header),
    Csv(Layout, Vec<(usize, usize)>),
    /// Parquet, MDF4: in memory, microstrain.
    Whole(Channels),
}

pub(super) struct Record {
    pub bytes: FileBytes,
    pub file: String,
    pub source: Source,
    pub columns: Vec<Option<usize>>,
    /// Strain of one unit of the file.
    pub unit: f64,
    /// Seconds in the unit of its times.
    pub second: f64,
    /// What puts the readings of each column right; empty where nothing is to be put right.
    pub channels: Vec<Channel>,
}

impl Record {
    pub fn n_pieces(&self) -> usize {
        match &self.source {
            Source::Binary(h) => h.samples.div_ceil(SAMPLES),
            Source::Rpc(h) => h.samples.div_ceil(SAMPLES),
            Source::Csv(_, pieces) => pieces.len(),
            Source::Whole(c) => c.n_samples().div_ceil(SAMPLES),
        }
    }

    /// Times and readings of a piece.
    pub fn piece(&self, i: usize) -> Result<(Vec<f64>, Vec<f64>), Fault> {
        let (mut times, mut values) = (Vec::new(), Vec::new());
        match &self.source {
            Source::Binary(h) => {
                let (from, to) = (i * SAMPLES, ((i + 1) * SAMPLES).min(h.samples));
                values.reserve((to - from) * self.columns.len());
                binary::read_samples(h, &self.bytes, from, to, &self.columns, &mut values);
                times.extend((from..to).map(|s| h.t0 + h.dt * s as f64));
            }
            Source::Rpc(h) => {
                let (from, to) = (i * SAMPLES, ((i + 1) * SAMPLES).min(h.samples));
                rpc::read_samples(h, &self.bytes, from, to, &self.columns, &mut values);
                times.extend((from..to).map(|s| h.dt * s as f64));
            }
            Source::Whole(c) => {
                let to = ((i + 1) * SAMPLES).min(c.n_samples());
                for s in i * SAMPLES..to {
                    times.push(c.start_s + s as f64 / c.rate_hz);
                    let of = |column: &Option<usize>| {
                        let channel = column.and_then(|c_ix| c.list.get(c_ix));
                        channel.and_then(|x| x.samples.get(s)).copied()
                    };
                    let row = self.columns.iter().map(|k| of(k).unwrap_or(f64::NAN));
                    values.extend(row);
                }
            }
            Source::Csv(l, pieces) => {
                csv_record::read_piece(
                    &self.file,
                    &self.bytes,
                    pieces.get(i).copied().unwrap_or_default(),
                    l,
                    &self.columns,
                    &mut times,
                    &mut values,
                )?;
            }
        }
        self.put_right(&mut values);
        times.iter_mut().for_each(|t| *t *= self.second);
        Ok((times, values))
    }

    /// Readings as `[[correction]]` says.
    fn put_right(&self, values: &mut [f64]) {
        if self.channels.is_empty() {
            return;
        }
        let microstrain = self.unit / MICROSTRAIN;
        for row in values.chunks_exact_mut(self.channels.len()) {
            for (v, c) in row.iter_mut().zip(&self.channels) {
                *v = c.put_right(*v * microstrain) / microstrain;
            }
        }
    }
}

/// Loads of a piece.
pub(super) struct Piece {
    pub times: Vec<f64>,
    pub loads: SampleLoads,
    pub sums: Sums,
}

/// Loads of piece `i`.
pub(super) fn process(record: &Record, filter: &Filter, i: usize) -> Result<Piece, Fault> {
    let mut sums = Sums::new(filter.n_gauges(), filter.n_loads());
    let mut loads = SampleLoads::default();
    let times = match &record.source {
        Source::Binary(h) => {
            let (from, to) = (i * SAMPLES, ((i + 1) * SAMPLES).min(h.samples));
            loads.values.reserve((to - from) * filter.n_loads());
            let mut values = Vec::with_capacity(BLOCK * record.columns.len());
            for block in (from..to).step_by(BLOCK) {
                values.clear();
                let end = (block + BLOCK).min(to);
                binary::read_samples(h, &record.bytes, block, end, &record.columns, &mut values);
                record.put_right(&mut values);
                filter.apply(&values, record.unit, &mut loads, &mut sums);
            }
            (from..to)
                .map(|s| (h.t0 + h.dt * s as f64) * record.second)
                .collect()
        }
        Source::Csv(..) | Source::Rpc(_) | Source::Whole(_) => {
            let (times, values) = record.piece(i)?;
            filter.apply(&values, record.unit, &mut loads, &mut sums);
            times
        }
    };
    Ok(Piece { times, loads, sums })
}
