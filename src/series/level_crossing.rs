//! Level crossings of a signal.

/// Counts the crossings of each level, by the level crossing method of ASTM E1049 (section 5.1).
///
/// A level at or above `reference` counts each time the signal rises beyond it. A level below counts each time the signal falls beyond it. A sample
/// that is not finite ends a crossing: nothing is counted over it.
///
/// # Reference
/// ASTM E1049-85, Standard Practices for Cycle Counting in Fatigue Analysis, 5.1.
///
/// # Example
/// Three periods of a wave from -2 to 2:
/// ```
/// use strainbridge::series::level_crossing::count_crossings;
///
/// let wave = [0.0, 2.0, 0.0, -2.0].repeat(3);
/// assert_eq!(count_crossings(wave.into_iter(), &[-3.0, -1.0, 0.0, 1.0, 3.0], 0.0), [0, 3, 3, 3, 0]);
/// ```
pub fn count_crossings(
    signal: impl Iterator<Item = f64>,
    levels: &[f64],
    reference: f64,
) -> Vec<u64> {
    let mut counts = vec![0; levels.len()];
    let mut before = f64::NAN;
    for value in signal {
        for (count, level) in counts.iter_mut().zip(levels) {
            let passes = if *level >= reference {
                before <= *level && value > *level
            } else {
                before >= *level && value < *level
            };
            *count += u64::from(passes);
        }
        before = value;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A history by hand with the reversals of the rainflow example of ASTM E1049 (figure 6): -2, 1, -3, 5, -1, 3, -4, 4, -2. The reference is 0.
    ///
    /// Rises through 0, 1, 2, 3, 4 go to 1, 5, 3 and 4; falls through -1, -2, -3 go to -3, -1, -4 and -2.
    #[test]
    fn a_history_with_the_reversals_of_the_standard_is_counted_by_hand() {
        let history = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];
        let levels: Vec<f64> = (-4..=5).map(f64::from).collect();
        let counts = count_crossings(history.into_iter(), &levels, 0.0);
        // -4: none beyond; -3: to -4; -2: to -3, -4; -1: to -3, -4, -2; 0: four rises; 1: to 5, 3, 4; 2: the same; 3: to 5, 4; 4: to 5; 5: none.
        assert_eq!(counts, [0, 1, 2, 3, 4, 3, 3, 2, 1, 0]);
    }

    /// N periods of an amplitude A cross every level between -A and A exactly N times.
    #[test]
    fn a_sine_crosses_each_level_once_a_period() {
        let n = 50_000;
        let wave = (0..n).map(|i| 3.0 * (TAU * 25.0 * f64::from(i) / f64::from(n) - 0.1).sin());
        let levels: Vec<f64> = (0..40).map(|k| -3.9 + 0.2 * f64::from(k)).collect();
        let counts = count_crossings(wave, &levels, 0.0);
        for (level, count) in levels.iter().zip(counts) {
            assert_eq!(count, if level.abs() < 3.0 { 25 } else { 0 }, "{level}");
        }
    }

    #[test]
    fn a_gap_is_no_crossing() {
        let history = [-1.0, f64::NAN, 1.0, -1.0, 1.0];
        assert_eq!(count_crossings(history.into_iter(), &[0.0], 0.0), [1]);
    }
}
