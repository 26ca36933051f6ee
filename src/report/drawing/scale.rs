//! An axis on paper: from values to millimetres, with ticks at round numbers.

/// Scale of an axis: linear, or logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Scale {
    /// Ends of the values; of their logarithms where `by_powers`.
    ends: [f64; 2],
    /// Positions of the values, mm.
    place: [f64; 2],
    by_powers: bool,
}

impl Scale {
    /// Creates a scale on which all `values` are between the ends, with some room at both ends if `roomy`.
    pub(in crate::report) fn from_values(
        values: impl Iterator<Item = f64>,
        place: [f64; 2],
        by_powers: bool,
    ) -> Self {
        let counted = values
            .map(|v| if by_powers { v.log10() } else { v })
            .filter(|v| v.is_finite());
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        counted.for_each(|v| (low, high) = (low.min(v), high.max(v)));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let width = high - low;
        let room = if width > 0.0 {
            0.04 * width
        } else {
            (0.1 * low.abs()).max(1e-9)
        };
        // A bar that begins at zero needs no room below zero.
        let below = if low == 0.0 { 0.0 } else { room };
        Self {
            ends: [low - below, high + room],
            place,
            by_powers,
        }
    }

    /// Returns the position of a value. `None` if the value is not on the scale.
    pub(in crate::report) fn position_of_value(&self, value: f64) -> Option<f64> {
        let v = if self.by_powers { value.log10() } else { value };
        let share = (v - self.ends[0]) / (self.ends[1] - self.ends[0]);
        let place = self.place[0] + share * (self.place[1] - self.place[0]);
        place.is_finite().then_some(place)
    }

    /// Returns round values between the ends, with their labels.
    pub(in crate::report) fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.ends;
        if self.by_powers {
            let step = (((high - low) / 6.0).ceil() as i32).max(1);
            let (first, last) = (low.ceil() as i32, high.floor() as i32);
            let powers = (first..=last).filter(|p| p.rem_euclid(step) == 0);
            return powers.map(|p| (10f64.powi(p), format!("1e{p}"))).collect();
        }
        let step = round_step((high - low) / 6.0);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let first = (low / step).ceil();
        let n = ((high / step).floor() - first).clamp(0.0, 20.0) as usize;
        let large = low.abs().max(high.abs()) >= 1e6 || step < 1e-4;
        (0..=n)
            .map(|i| {
                let v = (first + i as f64) * step;
                let word = if large && v != 0.0 {
                    format!("{v:.2e}")
                } else {
                    format!("{v:.digits$}")
                };
                (v, word)
            })
            .collect()
    }
}

/// Returns the smallest of 1, 2 or 5 times a power of ten that is at least `x`.
pub(in crate::report) fn round_step(x: f64) -> f64 {
    let power = 10f64.powf(x.abs().max(1e-300).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|s| s * power);
    steps
        .into_iter()
        .find(|s| *s >= x * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}
