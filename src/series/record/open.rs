//! Which format a file is.

use super::csv::Csv;
use super::even::Record;
use super::even_step_formats::EvenStepReader;
use super::reader::{Bytes, RecordReader};
use super::source::{Source, is_read_in_parts};
use super::tdms::{Tdms, is_tdms};
use super::uff::{Uff, is_uff};
use crate::series::channels::{Channel, Channels};
use crate::series::error::SeriesError;
use crate::series::{binary, rpc};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Options for opening a record.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Sample rate that the job states, Hz. It is required if the file has no times. Otherwise it is compared with the times.
    pub declared_hz: Option<f64>,
    /// Seconds in one stored time, for a file that states no unit of time.
    pub time_unit_s: Option<f64>,
    /// Channels that must be among the channels sampled together, if a file contains several clocks. Empty: the channels of the group with most
    /// numbers.
    pub wanted: Vec<String>,
}

/// Opens a record of any supported format. The first bytes determine the format. A file of no known format is a table of text.
///
/// # Errors A format that this build does not support, a file that can't be read, impossible times (see [`Record::new`]).
pub fn open_record(bytes: Bytes, options: &Options) -> Result<Record, SeriesError> {
    let reader = reader_of(bytes, options)?;
    Record::new(reader, options.declared_hz, options.time_unit_s)
}

/// Opens a record like [`open_record`], from bytes that need not be in memory. Of a file that is [read in parts](is_read_in_parts) it reads only
/// the bytes that it decodes.
///
/// # Errors
/// Every error of [`open_record`], and a file that can't be read.
pub fn open_source(source: Source, options: &Options) -> Result<Record, SeriesError> {
    let unreadable = |e: std::io::Error| SeriesError::Broken {
        wrong: format!("it cannot be read ({e})"),
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
            return Record::new(
                parquet(source, options)?,
                options.declared_hz,
                options.time_unit_s,
            );
        }
    }
    open_record(source.read_all().map_err(unreadable)?, options)
}

/// A format of records other than tables of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The binary record of strainbridge.
    Binary,
    /// RPC III.
    Rpc,
    /// Apache Parquet.
    Parquet,
    /// Feather, the file format of Apache Arrow.
    Feather,
    /// ASAM MDF 4.
    Mdf,
    /// TDMS of National Instruments.
    Tdms,
    /// Universal file, data sets 58.
    Uff,
}

impl Format {
    /// Returns the name of the format with an article, for messages.
    pub fn words(self) -> &'static str {
        match self {
            Self::Binary => "a binary record of strainbridge",
            Self::Rpc => "a record in RPC III form",
            Self::Parquet => "a Parquet file",
            Self::Feather => "a Feather file",
            Self::Mdf => "a record in MDF form",
            Self::Tdms => "a record in TDMS form",
            Self::Uff => "a universal file (UFF)",
        }
    }

    /// Returns the name of the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Binary => "binary record",
            Self::Rpc => "RPC III",
            Self::Parquet => "Parquet",
            Self::Feather => "Feather",
            Self::Mdf => "MDF4",
            Self::Tdms => "TDMS",
            Self::Uff => "UFF 58",
        }
    }
}

/// Returns the format that the first bytes indicate. `None` if they are not a record, or a table of text.
pub fn format_of(bytes: &[u8]) -> Option<Format> {
    if binary::is_record(bytes) {
        return Some(Format::Binary);
    }
    if rpc::is_rpc(bytes) {
        return Some(Format::Rpc);
    }
    if bytes.starts_with(b"PAR1") {
        return Some(Format::Parquet);
    }
    if bytes.starts_with(b"ARROW1") {
        return Some(Format::Feather);
    }
    if bytes.starts_with(b"MDF ") || bytes.starts_with(b"UnFinMF") {
        return Some(Format::Mdf);
    }
    if is_tdms(bytes) {
        return Some(Format::Tdms);
    }
    is_uff(bytes).then_some(Format::Uff)
}

/// Returns whether the first bytes indicate a format of records other than a table of text.
pub fn is_format(bytes: &[u8]) -> bool {
    format_of(bytes).is_some()
}

fn reader_of(bytes: Bytes, options: &Options) -> Result<Box<dyn RecordReader>, SeriesError> {
    Ok(match format_of((*bytes).as_ref()) {
        Some(Format::Binary) => Box::new(EvenStepReader::binary(bytes)?),
        Some(Format::Rpc) => Box::new(EvenStepReader::rpc(bytes)?),
        Some(Format::Parquet) => return parquet(Source::Memory(bytes), options),
        Some(Format::Feather) => return feather(bytes),
        Some(Format::Mdf) => return mdf(bytes, &options.wanted),
        Some(Format::Tdms) => Box::new(Tdms::new(bytes, &options.wanted)?),
        Some(Format::Uff) => Box::new(Uff::new(bytes, &options.wanted)?),
        None => Box::new(Csv::new(bytes)?),
    })
}

#[cfg(feature = "parquet")]
fn parquet(source: Source, options: &Options) -> Result<Box<dyn RecordReader>, SeriesError> {
    let file = super::parquet::Parquet::new(source)?;
    file.check_types(&options.wanted, options.declared_hz.is_none())?;
    Ok(Box::new(file))
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: Source, _: &Options) -> Result<Box<dyn RecordReader>, SeriesError> {
    Err(SeriesError::NotBuilt {
        name: "a Parquet file",
        feature: "parquet",
    })
}

#[cfg(feature = "parquet")]
fn feather(bytes: Bytes) -> Result<Box<dyn RecordReader>, SeriesError> {
    Ok(Box::new(super::feather::Feather::new(bytes)?))
}

#[cfg(not(feature = "parquet"))]
fn feather(_: Bytes) -> Result<Box<dyn RecordReader>, SeriesError> {
    Err(SeriesError::NotBuilt {
        name: "a Feather file",
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

/// Returns a whole record in memory.
///
/// # Errors
/// Errors of [`open_record`] and [`Record::read`].
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
