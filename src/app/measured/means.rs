//! What a strain file comes to where only its means count: sums over the rows, of a record passed over once, however long it is.

use super::strain_file::{StrainTable, open_strain, read_strain, record_fault};
use crate::app::fault::Faults;
use crate::app::files::{FileBytes, Inputs};
use crate::app::job::correct::{Channel, channel_of, column_of};
use crate::app::job::{Job, NamedFile};
use crate::recovery::net::Series;
use crate::series::record::csv::Layout;
use crate::series::record::is_format;
use std::ops::ControlFlow;

/// Text beyond which a record is passed over rather than read whole: its samples would take as much again.
const LARGE: usize = 16 << 20;

/// A strain file.
#[derive(Clone, Debug)]
pub enum StrainFile {
    /// Runs, or a record small enough to be a table.
    Table(StrainTable),
    /// A record.
    Means(StrainMeans),
}

/// The sums of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainMeans {
    /// File as given.
    pub file: String,
    /// Gauge names.
    pub gauges: Vec<String>,
    /// Readings of each, microstrain, channels put right.
    pub readings: Vec<Series>,
}

impl StrainFile {
    /// Gauge names.
    pub fn gauges(&self) -> &[String] {
        match self {
            Self::Table(t) => &t.gauges,
            Self::Means(m) => &m.gauges,
        }
    }

    /// Sums over all rows, by column.
    pub fn readings(&self) -> Vec<Series> {
        match self {
            Self::Means(m) => m.readings.clone(),
            Self::Table(t) => {
                let mut out = vec![Series::default(); t.gauges.len()];
                for i in 0..t.n_rows() {
                    out.iter_mut()
                        .zip(t.row(i))
                        .for_each(|(series, v)| series.add(*v));
                }
                out
            }
        }
    }
}

/// Whether the bytes are a record that is not to be read whole.
pub fn is_long_record(bytes: &FileBytes) -> bool {
    is_format(bytes) || bytes.len() > LARGE && Layout::of(bytes).is_ok_and(|l| l.is_record())
}

/// A strain file, its channels put right as `[[correction]]` says; of a record the sums. `wanted`: its [`super::strain_file::wanted_columns`].
///
/// # Errors
/// Every fault of the file.
pub fn read_strain_file(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
    wanted: &[String],
) -> Result<StrainFile, Faults> {
    let bytes = inputs.read_named(job, named).map_err(Faults::from)?;
    let record = |bytes| means(job, &named.given, bytes, wanted).map(StrainFile::Means);
    if is_long_record(&bytes) {
        return record(bytes);
    }
    // A short record is a table too, unless it holds what only records may: words for no reading, dates, lines before its header.
    match read_strain(inputs, job, named, wanted) {
        Err(_) if Layout::of(&bytes).is_ok_and(|l| l.is_record()) => record(bytes),
        read => read.map(StrainFile::Table),
    }
}

fn means(job: &Job, file: &str, bytes: FileBytes, names: &[String]) -> Result<StrainMeans, Faults> {
    let (record, columns) = open_strain(file, bytes, names)?;
    let gauge = |name: &str| column_of(&job.corrections, name).to_owned();
    let is_reserved = |c: &(usize, String, f64)| job.reserved.contains(&gauge(&c.1));
    let columns: Vec<_> = columns.into_iter().filter(|c| !is_reserved(c)).collect();
    let gauges: Vec<String> = columns.iter().map(|c| gauge(&c.1)).collect();
    let channels: Vec<(f64, Channel)> = columns
        .iter()
        .zip(&gauges)
        .map(|(c, g)| (c.2, channel_of(&job.corrections, g)))
        .collect();
    let picks: Vec<Option<usize>> = columns.iter().map(|c| Some(c.0)).collect();
    let mut readings = vec![Series::default(); gauges.len()];
    for piece in 0..record.n_pieces() {
        let read = record.read(piece, &picks, &mut |block| {
            for row in block.values.chunks_exact(picks.len().max(1)) {
                for ((v, (micro, channel)), series) in row.iter().zip(&channels).zip(&mut readings)
                {
                    series.add(channel.put_right(v * micro));
                }
            }
            ControlFlow::Continue(())
        });
        read.map_err(|e| Faults::from(record_fault(file, &e)))?;
    }
    Ok(StrainMeans {
        file: file.to_owned(),
        gauges,
        readings,
    })
}
