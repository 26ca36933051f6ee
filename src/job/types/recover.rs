//! `[recover]`.

/// File that `recover` writes in addition to `loads.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadFile {
    /// `loads.rsp`: the history in RPC III.
    Rpc,
    /// `loads.bdf`: FORCE, MOMENT and LOAD, for a history TABLED1.
    Nastran,
    /// `rainflow.csv`: cycles and pseudo-damage of the history.
    Rainflow,
    /// `loads.parquet`: the history in Parquet.
    Parquet,
}

impl LoadFile {
    /// Returns whether this build can write the file.
    pub fn is_built(self) -> bool {
        self != Self::Parquet || cfg!(feature = "parquet")
    }

    /// All files, with their names in a job.
    pub const ALL: [(&'static str, LoadFile); 4] = [
        ("rpc", Self::Rpc),
        ("nastran", Self::Nastran),
        ("rainflow", Self::Rainflow),
        ("parquet", Self::Parquet),
    ];
}

/// `[recover]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Recover {
    /// Requested files. `None` means all files, except for long histories.
    pub files: Option<Vec<LoadFile>>,
    /// Power of the load range in pseudo-damage.
    pub slope: f64,
    /// `loads.csv` has a row for every n-th sample, with this n. The default is 1.
    pub csv_every: usize,
    /// Share of the range of a load below which `turning_points.csv` leaves out its reversals. `None` means no such file.
    pub turning_points: Option<f64>,
}
