//! `[study]`.

/// `[study]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// `given`, `random`, `D`, as written.
    pub layouts: Vec<String>,
    /// Gauge counts.
    pub gauges: Vec<usize>,
    /// Kind and size of each error.
    pub errors: Vec<(String, f64)>,
    /// Trials; default 1000.
    pub trials: usize,
    /// Seed; default 1.
    pub seed: u64,
    /// Line of the job.
    pub line: u32,
}
