//! `[fleet]`.

use super::named_file::NamedFile;

/// `[fleet]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    /// Form of file names, with `{vehicle}` and `{day}`.
    pub file_name: NamedFile,
    /// Range below which the S-N line is flatter, report unit of each load; `None`: a straight line.
    pub knee_range: Option<f64>,
    /// Power below the knee; infinite where cycles below do no harm.
    pub slope_below_knee: f64,
}
