//! Amplitudes that differ from run to run: temperature, side loads, ground.

/// Strain patterns whose amplitudes are unknown in every run, except for their usual size. One part of an amplitude repeats in all runs, since axles
/// scrub the same way each time the truck drives up. The other part differs in every run.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitudes {
    /// Patterns over the gauges: microstrain per unit amplitude.
    pub patterns: Vec<Vec<f64>>,
    /// Kind of each pattern. Patterns of one kind share their sizes.
    pub kinds: Vec<usize>,
    /// Usual scatter (prior sd from run to run) of each kind, in `unit`.
    pub usual: Vec<f64>,
    /// Usual size (prior sd) of the part of each kind that repeats in all runs. Zero if no part repeats, or if a parameter contains it.
    pub steady: Vec<f64>,
    /// Correlation between a run and the next run in file order, for patterns that are noise (including the stated noise). Zero for all other
    /// patterns.
    pub correlation: f64,
    /// Unit for reports.
    pub unit: &'static str,
    /// Largest plausible root mean square of the amplitudes of each kind.
    pub plausible: Vec<f64>,
}

/// Amplitudes with the sizes (variance roots) of each of their kinds.
#[derive(Clone, Debug)]
pub struct SizedAmplitudes {
    /// Patterns.
    pub amplitudes: Amplitudes,
    /// For each kind, the standard deviation from run to run. These are followed by the standard deviation of the repeating part of each kind.
    pub sizes: Vec<f64>,
}

impl SizedAmplitudes {
    /// Returns the variance from run to run of the amplitudes of `kind`.
    pub fn scatter_variance(&self, kind: usize) -> f64 {
        self.sizes.get(kind).map_or(0.0, |s| s * s)
    }

    /// Returns the variance of the part that repeats in all runs.
    pub fn steady_variance(&self, kind: usize) -> f64 {
        self.sizes
            .get(self.amplitudes.usual.len() + kind)
            .map_or(0.0, |s| s * s)
    }
}
