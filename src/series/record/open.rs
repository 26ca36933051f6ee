//! Which format a file is.

use super::csv::Csv;
use super::even::Record;
use super::reader::{Bytes, RecordReader};
use super::source::{Source, is_read_in_parts};
use super::stored::Stored;
use super::tdms::{Tdms, is_tdms};
use super::uff::{Uff, is_uff};
use crate::series::channels::{Channel, Channels};
use crate::series::error::SeriesError;
use crate::series::{binary, rpc};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// How a record is opened.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Its sample rate as stated elsewhere, Hz: needed where the file has no times, else held against them.
    pub declared_hz: Option<f64>,
    /// Channels that must be among those sampled together, where a file holds several clocks; none: those of the group with most
    /// numbers.
    pub wanted: Vec<String>,
}

/// A record of any format that is read, told by its first bytes; what is none of the others is a table of text.
///
/// # Errors
/// A format that this build leaves out, a file that can't be read, times that can't be (see [`Record::new`]).
pub fn open_record(bytes: Bytes, options: &Options) -> Result<Record, SeriesError> {
    let reader = reader_of(bytes, options)?;
    Record::new(reader, options.declared_hz)
}

/// As [`open_record`], of bytes that need not be in memory: of a file that is [read in parts](is_read_in_parts) what is decoded alone is read.
///
/// # Errors
/// As [`open_record`]; a file that can't be read.
pub fn open_source(source: Source, options: &Options) -> Result<Record, SeriesError> {
    let unreadable = |e: std::io::Error| SeriesError::Broken {
        wrong: format!("it can't be read ({e})"),
        remedy: "check the path and the disk",
    };
    if let Source::File(file) = &source {
        let mut begin = [0; 4];
        let known = begin
            .len()
            .min(usize::try_from(file.size()).unwrap_or(usize::MAX));
        let begin = begin.get_mut(..known).unwrap_or_default();
        file.read_at(0, begin).map_err(unreadable)?;
        if is_read_in_parts(begin) {
            return Record::new(parquet(source)?, options.declared_hz);
        }
    }
    open_record(source.whole().map_err(unreadable)?, options)
}

/// Whether the bytes begin as one of the formats of records, and are no table of text.
pub fn is_format(bytes: &[u8]) -> bool {
    binary::is_record(bytes)
        || rpc::is_rpc(bytes)
        || is_tdms(bytes)
        || is_uff(bytes)
        || [&b"PAR1"[..], b"MDF ", b"UnFinMF"]
            .iter()
            .any(|m| bytes.starts_with(m))
}

fn reader_of(bytes: Bytes, options: &Options) -> Result<Box<dyn RecordReader>, SeriesError> {
    let begin = (*bytes).as_ref();
    if binary::is_record(begin) {
        return Ok(Box::new(Stored::binary(bytes)?));
    }
    if rpc::is_rpc(begin) {
        return Ok(Box::new(Stored::rpc(bytes)?));
    }
    if begin.starts_with(b"PAR1") {
        return parquet(Source::Memory(bytes));
    }
    if begin.starts_with(b"MDF ") || begin.starts_with(b"UnFinMF") {
        return mdf(bytes, &options.wanted);
    }
    if is_tdms(begin) {
        return Ok(Box::new(Tdms::new(bytes, &options.wanted)?));
    }
    if is_uff(begin) {
        return Ok(Box::new(Uff::new(bytes, &options.wanted)?));
    }
    Ok(Box::new(Csv::new(bytes)?))
}

#[cfg(feature = "parquet")]
fn parquet(source: Source) -> Result<Box<dyn RecordReader>, SeriesError> {
    Ok(Box::new(super::parquet::Parquet::new(source)?))
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: Source) -> Result<Box<dyn RecordReader>, SeriesError> {
    Err(SeriesError::NotBuilt {
        name: "a Parquet file",
        feature: "parquet",
    })
}

#[cfg(feature = "mdf")]
fn mdf(bytes: Bytes, wanted: &[String]) -> Result<Box<dyn RecordReader>, SeriesError> {
    super::mdf::open(bytes, wanted)
}

#[cfg(not(feature = "mdf"))]
fn mdf(_: Bytes, _: &[String]) -> Result<Box<dyn RecordReader>, SeriesError> {
    Err(SeriesError::NotBuilt {
        name: "an MDF4 file",
        feature: "mdf",
    })
}

/// A whole record in memory.
///
/// # Errors
/// As [`open_record`] and [`Record::read`].
pub fn read_channels(record: &Record) -> Result<Channels, SeriesError> {
    let k = record.columns().len();
    let picks: Vec<Option<usize>> = (0..k).map(Some).collect();
    let pieces: Vec<Vec<f64>> = (0..record.n_pieces())
        .into_par_iter()
        .map(|piece| {
            let mut rows = Vec::new();
            record.read(piece, &picks, &mut |block| {
                rows.extend_from_slice(block.values);
                ControlFlow::Continue(())
            })?;
            Ok(rows)
        })
        .collect::<Result<_, SeriesError>>()?;
    let list = record.columns().iter().enumerate().map(|(c, column)| {
        let mut samples = Vec::with_capacity(record.clock.samples);
        for rows in &pieces {
            samples.extend(rows.iter().skip(c).step_by(k));
        }
        Channel {
            name: column.name.clone(),
            unit: column.unit.clone(),
            samples,
        }
    });
    let list: Vec<Channel> = list.collect();
    Ok(Channels {
        start_s: record.clock.start_s,
        ..Channels::from_list(record.clock.rate_hz, list)?
    })
}
