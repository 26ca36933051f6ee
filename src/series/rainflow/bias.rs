//! Estimates the bias that noise in the loads adds to damage, from counts with more noise.

use super::tally::NOISE;

/// Bend of [`rise`]. At the bend, the rise of an extreme changes from the square of the noise to the noise itself. With this value, [`rise`] is
/// within a twelfth of the mean rise of the largest of samples on a parabola. It was compared with some million random cases, for a noise of an
/// eighth to eight times the fall of the parabola within a sample.
const BEND: f64 = 0.21;
/// Ends of the search for the sharpness of peaks, natural logs: beyond them [`rise`] is only a square, or only a straight line.
const ENDS: [f64; 2] = [-4.0, 6.0];

/// Returns the mean rise of the largest of samples by white noise `x`. The samples follow a parabola that falls by half of one within a sample.
/// Below one the rise grows like `x^2`, because only one or two samples can be the largest; above, with many samples, like `x sqrt(log x)`.
fn rise(x: f64) -> f64 {
    x * (BEND * (1.0 + x * x / BEND).ln()).sqrt()
}

/// Bias of a count by noise, from counts with more noise, in natural logarithms of damage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bias {
    /// Log of the counted damage, minus the log of the damage without noise.
    pub taken: f64,
    /// Log of the bias by a straight line through the logarithms of the first two counts.
    pub line: f64,
    /// Change of the result with the added noise, as a multiple of its change with the noise in the loads.
    pub of_added: f64,
}

impl Bias {
    /// Returns the bias of the first of three damages, which were counted with once, twice and three times the noise ([`NOISE`]). The curve `L(q) =
    /// L(0) + a rise(q x)` goes through their logarithms (Cook and Stefanski's simulation extrapolation). `x` is the noise relative to the curvature
    /// of the peaks that do the damage, `a` their weight. A parabola, or a line, through the logarithms removes a fifth to two thirds too much. The
    /// bias grows by less than a square and more than in proportion.
    ///
    /// # Reference
    /// J.R. Cook, L.A. Stefanski, Simulation-extrapolation estimation in parametric measurement error models, JASA 89 (1994) 1314-1328.
    pub fn from_damage(damage: [f64; 3]) -> Self {
        debug_assert_eq!(NOISE, [1.0, 2.0, 3.0]);
        let [once, twice, thrice] = damage;
        if !(once > 0.0 && twice > once && thrice > 0.0) {
            return Self::default();
        }
        let [first, second] = [(twice / once).ln(), (thrice / twice).ln()];
        let ratio = second / first;
        let at = sharpness(ratio);
        let of_first = share(at);
        // `moves` is the derivative of `of_first` with respect to `ratio`. It is set to zero at the ends of the search range.
        let h = 0.01;
        let turn = (ratio_of(at + h) - ratio_of(at - h)) / (2.0 * h);
        let within = at > ENDS[0] + h && at < ENDS[1] - h;
        let moves = match within {
            true => (share(at + h) - share(at - h)) / (2.0 * h) / turn,
            false => 0.0,
        };
        // The added noise differs only in size: sqrt(3) and sqrt(8) times the present noise.
        let added = [3.0, 8.0].map(f64::sqrt);
        Self {
            taken: first * of_first,
            line: first,
            of_added: added[0] * of_first + moves * (added[1] - added[0] - ratio * added[0]),
        }
    }
}

/// The rises between once, twice and three times the noise; `x` by its logarithm.
fn steps(log_x: f64) -> [f64; 3] {
    let x = log_x.exp();
    let [a, b, c] = NOISE.map(|q| rise(q * x));
    [a, b - a, c - b]
}

/// The second step over the first: it falls from 5/3, where peaks are sharp, to 1.
fn ratio_of(log_x: f64) -> f64 {
    let [_, first, second] = steps(log_x);
    second / first
}

/// The rise at once the noise over the first step.
fn share(log_x: f64) -> f64 {
    let [begin, first, _] = steps(log_x);
    begin / first
}

/// Returns the sharpness at which the steps have this ratio, found by bisection.
fn sharpness(ratio: f64) -> f64 {
    let [mut low, mut high] = ENDS;
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if ratio_of(middle) > ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values from random simulation, accurate to three digits. Each comes from 60,000 to four million parabolas at a random place between
    /// samples (seeded splitmix64 and Box and Muller).
    const SIMULATED_RISES: [(f64, f64); 6] = [
        (0.125, 0.0158),
        (0.5, 0.2076),
        (1.0, 0.607),
        (2.0, 1.609),
        (4.0, 3.982),
        (8.0, 9.461),
    ];

    #[test]
    fn the_rise_of_an_extreme_is_that_of_drawn_parabolas() {
        for (x, drawn) in SIMULATED_RISES {
            assert!(
                (rise(x) / drawn - 1.0).abs() < 1.0 / 12.0,
                "{x}: {} {drawn}",
                rise(x)
            );
        }
    }

    #[test]
    fn a_bias_that_follows_the_law_is_taken_off_to_the_last_digit_and_none_where_none_shows() {
        for x in [0.05, 0.3, 1.0, 5.0, 50.0] {
            let damage = NOISE.map(|q| 7.0 * (0.4 * rise(q * x) / rise(x)).exp());
            let bias = Bias::from_damage(damage);
            assert!((bias.taken - 0.4).abs() < 1e-6, "{x}: {bias:?}");
            assert!(bias.line > bias.taken, "{x}: {bias:?}");
        }
        for damage in [[1.0, 1.0, 1.0], [1.0, 0.9, 1.2], [0.0, 1.0, 2.0], [0.0; 3]] {
            assert_eq!(Bias::from_damage(damage).taken, 0.0);
        }
    }
}
