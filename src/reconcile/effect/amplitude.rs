//! Amplitudes that differ from run to run: temperature, side loads, ground.

/// Strain patterns whose amplitudes are unknown in every run and known only by their usual size.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitudes {
    /// One pattern over the gauges each: microstrain per unit amplitude.
    pub patterns: Vec<Vec<f64>>,
    /// The kind of each pattern: patterns of a kind share one size.
    pub kinds: Vec<usize>,
    /// Usual size (prior sd) of each kind, in `unit`.
    pub usual: Vec<f64>,
    /// Unit for reports.
    pub unit: &'static str,
    /// Above this root mean square an amplitude is not plausible.
    pub plausible: f64,
}
