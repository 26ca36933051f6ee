//! Measured readings by run and channel, and the held-out runs.

/// Readings of channels (gauges, accelerometers) in runs (static states, records), by rows of runs; NaN for a missing reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Observations {
    /// Channel names.
    pub channels: Vec<String>,
    /// Run names.
    pub runs: Vec<String>,
    /// `n_runs x n_channels` by rows.
    pub values: Vec<f64>,
    /// Whether a run is held out and never used for fitting, by run.
    pub held_out: Vec<bool>,
}

impl Observations {
    /// Returns the number of channels.
    pub fn n_channels(&self) -> usize {
        self.channels.len()
    }

    /// Returns the reading of `channel` in `run`; NaN if it is missing.
    pub fn value(&self, run: usize, channel: usize) -> f64 {
        self.values
            .get(run * self.channels.len() + channel)
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// Runs used for fitting, in file order.
    pub fn fit_runs(&self) -> Vec<usize> {
        self.runs_where(false)
    }

    /// Returns the held-out runs, in file order. If no run is held out, these are the fit runs.
    pub fn proof_runs(&self) -> Vec<usize> {
        let kept = self.runs_where(true);
        if kept.is_empty() {
            self.fit_runs()
        } else {
            kept
        }
    }

    fn runs_where(&self, held_out: bool) -> Vec<usize> {
        (0..self.runs.len())
            .filter(|&r| self.held_out.get(r).copied().unwrap_or(false) == held_out)
            .collect()
    }

    /// Returns the (run, channel) pairs of `runs` that have a reading, run by run.
    pub fn entries(&self, runs: &[usize]) -> Vec<(usize, usize)> {
        let mut out = Vec::with_capacity(runs.len() * self.channels.len());
        for &r in runs {
            out.extend(
                (0..self.channels.len())
                    .filter(|&c| self.value(r, c).is_finite())
                    .map(|c| (r, c)),
            );
        }
        out
    }
}
