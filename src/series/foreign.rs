//! Records of other programs that a build may leave out: Parquet and MDF4, read whole.

use super::channels::{Channels, SeriesError};

/// Kinds of file, each behind a feature of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// Apache Parquet: a column a channel.
    Parquet,
    /// ASAM MDF 4.
    Mdf,
}

impl Foreign {
    /// The kind that the bytes begin as.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"PAR1") {
            Some(Self::Parquet)
        } else if bytes.starts_with(b"MDF ") || bytes.starts_with(b"UnFinMF") {
            Some(Self::Mdf)
        } else {
            None
        }
    }

    /// Its name, and that of the feature.
    pub fn words(self) -> [&'static str; 2] {
        match self {
            Self::Parquet => ["Parquet", "parquet"],
            Self::Mdf => ["MDF4", "mdf"],
        }
    }
}

/// The record in such a file: channels sampled together. `wanted` names the channels that must be among them; none: as many as were
/// sampled together.
///
/// # Errors
/// A build without the feature, a file that can't be read, uneven or missing times, a rate other than the declared one, wanted
/// channels that were not sampled together.
pub fn read_foreign(
    kind: Foreign,
    bytes: &[u8],
    declared_hz: Option<f64>,
    wanted: &[String],
) -> Result<Channels, SeriesError> {
    match kind {
        #[cfg(feature = "parquet")]
        Foreign::Parquet => super::parquet::read_parquet(bytes, declared_hz),
        #[cfg(feature = "mdf")]
        Foreign::Mdf => super::mdf::read_mdf(bytes, declared_hz, wanted),
        #[allow(unreachable_patterns, reason = "with both features on")]
        _ => {
            let (_, _, _) = (bytes, declared_hz, wanted);
            Err(SeriesError::NotBuilt { kind })
        }
    }
}
