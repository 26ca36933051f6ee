//! Formats whose samples lie on even steps and can be read anywhere: the binary record of strainbridge and RPC III.

use super::column::{Column, name_and_unit};
use super::reader::{BLOCK, Block, Bytes, Pick, RecordReader, Sink, Times};
use crate::series::error::SeriesError;
use crate::series::{binary, rpc};

/// Samples a piece.
const PIECE: usize = 16_384;

/// Format of the record.
enum Header {
    Binary(binary::Header),
    Rpc(rpc::Header),
}

/// A record on even steps.
pub(super) struct EvenStepReader {
    bytes: Bytes,
    header: Header,
    columns: Vec<Column>,
}

impl EvenStepReader {
    /// Opens the binary record of strainbridge. The `unit` in its header is the unit of every column without a unit.
    pub(super) fn binary(bytes: Bytes) -> Result<Self, SeriesError> {
        let header = binary::read_header((*bytes).as_ref()).map_err(|e| SeriesError::Broken {
            wrong: e.to_string(),
            remedy: "write the record again as the manual describes it",
        })?;
        let unit = match header.unit {
            1e-6 => "um/m",
            1e-3 => "mm/m",
            1.0 => "m/m",
            u => {
                return Err(SeriesError::Broken {
                    wrong: format!("one unit of its numbers is {u}"),
                    remedy: "write microstrain (1e-6), 1e-3 or 1",
                });
            }
        };
        let names = header.names.iter();
        let columns = names.map(|n| name_and_unit(n).in_file_of(unit));
        Ok(Self {
            columns: columns.collect(),
            bytes,
            header: Header::Binary(header),
        })
    }

    /// Opens an RPC III file.
    pub(super) fn rpc(bytes: Bytes) -> Result<Self, SeriesError> {
        let header = rpc::read_header((*bytes).as_ref())?;
        let channels = header.channels.iter();
        let columns = channels.map(|c| Column::of_channel(&c.name, &c.unit));
        Ok(Self {
            columns: columns.collect(),
            bytes,
            header: Header::Rpc(header),
        })
    }

    fn clock(&self) -> (f64, f64, usize) {
        match &self.header {
            Header::Binary(h) => (h.t0, h.dt, h.samples),
            Header::Rpc(h) => (0.0, h.dt, h.samples),
        }
    }
}

impl RecordReader for EvenStepReader {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn times(&self) -> Times {
        let (start_s, step_s, samples) = self.clock();
        Times::Even {
            start_s,
            step_s,
            samples,
            // Both formats count in seconds.
            unit_stated: true,
        }
    }

    fn n_pieces(&self) -> usize {
        self.clock().2.div_ceil(PIECE)
    }

    fn rows(&self, piece: usize) -> Option<usize> {
        Some(self.clock().2.saturating_sub(piece * PIECE).min(PIECE))
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let (start, step, samples) = self.clock();
        let begin = piece * PIECE;
        let end = (begin + PIECE).min(samples);
        let columns: Vec<Option<usize>> = picks
            .iter()
            .map(|p| match p {
                Pick::Column(c) => Some(*c),
                _ => None,
            })
            .collect();
        let bytes = (*self.bytes).as_ref();
        let mut values = Vec::with_capacity(BLOCK * picks.len());
        for from in (begin..end).step_by(BLOCK) {
            let to = (from + BLOCK).min(end);
            values.clear();
            match &self.header {
                Header::Binary(h) => {
                    binary::read_samples(h, bytes, from, to, &columns, &mut values);
                }
                Header::Rpc(h) => rpc::read_samples(h, bytes, from, to, &columns, &mut values),
            }
            for (j, _) in picks.iter().enumerate().filter(|p| *p.1 == Pick::Time) {
                let slots = values.iter_mut().skip(j).step_by(picks.len());
                for (slot, i) in slots.zip(from..to) {
                    *slot = start + step * i as f64;
                }
            }
            let block = Block {
                first: from - begin,
                rows: to - from,
                values: &values,
            };
            if sink(block).is_break() {
                break;
            }
        }
        Ok(())
    }
}
