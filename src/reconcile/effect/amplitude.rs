//! Amplitudes that differ from run to run: temperature, side loads, ground.

/// Strain patterns whose amplitudes are unknown in every run and known only by their usual size: a part that repeats in all runs (axles
/// scrub the same way each time the truck drives up) and a part that is another in every run.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitudes {
    /// One pattern over the gauges each: microstrain per unit amplitude.
    pub patterns: Vec<Vec<f64>>,
    /// The kind of each pattern: patterns of a kind share their sizes.
    pub kinds: Vec<usize>,
    /// Usual scatter (prior sd from run to run) of each kind, in `unit`.
    pub usual: Vec<f64>,
    /// Usual size (prior sd) of the part of each kind that repeats in all runs; zero where nothing repeats, or a parameter holds it.
    pub steady: Vec<f64>,
    /// Unit for reports.
    pub unit: &'static str,
    /// Above this root mean square an amplitude is not plausible.
    pub plausible: f64,
}
