//! Turning points of a signal, without small reversals.

use super::Point;

/// Finds the samples where a signal turns. Reversals smaller than `gate` are left out.
///
/// The result contains the largest and the smallest sample. With a gate of 0, rainflow counts of the turning points are those of the signal.
///
/// # Example
/// ```
/// use strainbridge::series::rainflow::turning_points;
///
/// let signal = [0.0, 4.0, 3.5, 5.0, -2.0, -1.0];
/// assert_eq!(turning_points(&signal, 0.0), [0, 1, 2, 3, 4, 5]);
/// // The reversals of 0.5 and of 1 are below the gate.
/// assert_eq!(turning_points(&signal, 1.5), [0, 3, 4]);
/// ```
pub fn turning_points(signal: &[f64], gate: f64) -> Vec<usize> {
    let mut finder = TurningPointFinder::new(gate);
    for (at, value) in signal.iter().enumerate() {
        finder.push(Point { at, value: *value });
    }
    finder.finish()
}

/// Finder of [`turning_points`] in a signal that arrives sample by sample.
#[derive(Clone, Debug)]
pub struct TurningPointFinder {
    gate: f64,
    /// Extremes since the last turning point: the smallest and the largest sample. The later one may become the next turning point.
    low: Option<Point>,
    high: Option<Point>,
    found: Vec<usize>,
    /// Whether the signal rises since the last turning point; `None` before the first one.
    is_rising: Option<bool>,
}

impl TurningPointFinder {
    /// Creates a finder that leaves out reversals smaller than `gate`, in the unit of the signal.
    pub fn new(gate: f64) -> Self {
        Self {
            gate,
            low: None,
            high: None,
            found: Vec::new(),
            is_rising: None,
        }
    }

    /// Receives the next sample. Samples that are not finite are left out.
    pub fn push(&mut self, p: Point) {
        if !p.value.is_finite() {
            return;
        }
        let (Some(low), Some(high)) = (self.low, self.high) else {
            (self.low, self.high) = (Some(p), Some(p));
            return;
        };
        let turns = |size: f64| size > 0.0 && size >= self.gate;
        match self.is_rising {
            Some(true) if p.value > high.value => self.high = Some(p),
            Some(true) if turns(high.value - p.value) => self.turn(high, p, false),
            Some(false) if p.value < low.value => self.low = Some(p),
            Some(false) if turns(p.value - low.value) => self.turn(low, p, true),
            Some(_) => {}
            None if turns(p.value - low.value) => self.turn(low, p, true),
            None if turns(high.value - p.value) => self.turn(high, p, false),
            None if p.value < low.value => self.low = Some(p),
            None if p.value > high.value => self.high = Some(p),
            None => {}
        }
    }

    /// Keeps a turning point, after which the signal went to `now`.
    fn turn(&mut self, at: Point, now: Point, is_rising: bool) {
        self.found.push(at.at);
        (self.low, self.high) = (Some(now), Some(now));
        self.is_rising = Some(is_rising);
    }

    /// Returns the numbers of the samples, in order of time. The list of a signal without a reversal of this size is empty.
    pub fn finish(mut self) -> Vec<usize> {
        let last = match self.is_rising {
            Some(true) => self.high,
            Some(false) => self.low,
            None => None,
        };
        self.found.extend(last.map(|p| p.at));
        self.found
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cycle, Rainflow};
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn damage(values: impl Iterator<Item = f64>) -> f64 {
        let mut sum = 0.0;
        let mut add = |c: Cycle| sum += c.count * c.range().powi(5);
        let mut count = Rainflow::default();
        for (at, value) in values.enumerate() {
            count.push(Point { at, value }, &mut add);
        }
        count.finish(&mut add);
        sum
    }

    #[test]
    fn counts_of_the_points_are_those_of_the_signal_and_a_gate_leaves_out_small_reversals() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut value = 0.0;
        let signal: Vec<f64> = (0..5000)
            .map(|_| {
                value = 0.97 * value + random.random_range(-1.0..1.0);
                value
            })
            .collect();
        let all = turning_points(&signal, 0.0);
        let whole = damage(signal.iter().copied());
        let kept = damage(all.iter().map(|i| signal[*i]));
        assert!((kept / whole - 1.0).abs() < 1e-12, "{kept} {whole}");
        let gate = 2.0;
        let few = turning_points(&signal, gate);
        assert!(few.len() < all.len() / 2, "{} {}", few.len(), all.len());
        let steps: Vec<f64> = few
            .windows(2)
            .map(|w| signal[w[1]] - signal[w[0]])
            .collect();
        assert!(steps.iter().all(|s| s.abs() >= gate));
        assert!(steps.windows(2).all(|s| s[0] * s[1] < 0.0));
        for extreme in [f64::max, f64::min] {
            let of = |list: &mut dyn Iterator<Item = f64>| list.fold(f64::NAN, extreme);
            let points = of(&mut few.iter().map(|i| signal[*i]));
            assert_eq!(points, of(&mut signal.iter().copied()));
        }
    }

    #[test]
    fn constant_and_short_signals_have_no_turning_points() {
        assert!(turning_points(&[], 0.0).is_empty());
        assert!(turning_points(&[3.0; 9], 0.0).is_empty());
        assert!(turning_points(&[0.0, 1.0], 2.0).is_empty());
        assert_eq!(turning_points(&[f64::NAN, 0.0, 1.0, 1.0], 0.5), [1, 2]);
    }
}
