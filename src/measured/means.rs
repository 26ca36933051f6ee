//! Means of a strain file: sums over the rows of a record in one pass, however long it is.

use super::open::is_record;
use super::record::Record;
use super::strain_file::read_strain;
use super::strain_table::StrainTable;
use crate::host::fault::Faults;
use crate::host::files::{FileBytes, Inputs};
use crate::job::{Job, NamedFile};
use crate::recovery::net::Series;
use crate::series::record::is_format;

/// Bytes of text beyond which a record is read in one pass, not as a whole: its samples would take as much memory again.
const LARGE: usize = 16 << 20;

/// A strain file.
#[derive(Clone, Debug)]
pub enum StrainFile {
    /// Runs, or a record small enough to be a table.
    Table(StrainTable),
    /// A fault if the strain file is a record, not a table of runs.
    Means(StrainMeans),
}

/// The sums of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainMeans {
    /// Gauge names.
    pub gauges: Vec<String>,
    /// Readings of each gauge, microstrain, with corrected channels.
    pub readings: Vec<Series>,
    /// First readings, microstrain, one row for each sample.
    pub first: Vec<f64>,
}

/// Samples of a long record from which the covariance of its noise is estimated.
const FIRST: usize = 4096;

impl StrainFile {
    /// Gauge names.
    pub fn gauges(&self) -> &[String] {
        match self {
            Self::Table(t) => &t.gauges,
            Self::Means(m) => &m.gauges,
        }
    }

    /// Returns the rows, microstrain by column. For a long record, these are only the first rows.
    pub fn rows(&self) -> Box<dyn Iterator<Item = &[f64]> + '_> {
        match self {
            Self::Means(m) => Box::new(m.first.chunks_exact(m.gauges.len().max(1))),
            Self::Table(t) => Box::new((0..t.n_rows()).map(|i| t.row(i))),
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

/// Returns whether the bytes are a record that is not to be read whole.
pub fn is_long_record(bytes: &FileBytes) -> bool {
    is_format(bytes) || bytes.len() > LARGE && is_record(bytes)
}

/// Reads a strain file and corrects its channels as `[[correction]]` states. A record is read as sums. `wanted` are its
/// [`super::strain_file::wanted_columns`].
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
    let record = |bytes| {
        let record =
            Record::open(job, (&named.given, None), bytes, (wanted, &[]))?.with_all_strain(job);
        Ok(StrainFile::Means(StrainMeans {
            readings: record.sums()?,
            first: record.first_microstrain(FIRST)?,
            gauges: record.names_read(),
        }))
    };
    if is_long_record(&bytes) {
        return record(bytes);
    }
    // A short record is read as a table, unless it contains text that only records may contain. Such text is a word for a missing reading, a date, or
    // a line before the header.
    match read_strain(inputs, job, named, wanted) {
        Err(_) if is_record(&bytes) => record(bytes),
        read => read.map(StrainFile::Table),
    }
}
