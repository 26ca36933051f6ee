//! What damage would be without the noise that is in its loads, from counts with more noise.

use super::tally::NOISE;

/// Where the rise of an extreme leaves the square of the noise for the noise itself. With it [`rise`] is within a twelfth of the mean rise of the
/// largest of samples on a parabola, drawn some million times, from a noise of an eighth to eight times what the parabola falls within a sample.
const BEND: f64 = 0.21;
/// Ends of the search for the sharpness of peaks, natural logs: beyond them only a square, or a straight line, is left of [`rise`].
const ENDS: [f64; 2] = [-4.0, 6.0];

/// What white noise `x` adds, in the mean, to the largest of samples on a parabola that falls by half of one within a sample: like `x^2` below one,
/// where one or two samples compete, like `x sqrt(log x)` above, where many do.
fn rise(x: f64) -> f64 {
    x * (BEND * (1.0 + x * x / BEND).ln()).sqrt()
}

/// How a count without noise follows from counts with noise, in logarithms of damage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bias {
    /// Log of what was counted, less that without noise.
    pub taken: f64,
    /// What a straight line through the first two counts would take.
    pub line: f64,
    /// By how much the result moves with the noise that was added, as a multiple of what the noise itself makes.
    pub of_added: f64,
}

impl Bias {
    /// The bias of the first of damages counted with noise of once, twice and three times ([`NOISE`]): `L(q) = L(0) + a rise(q x)` goes through the
    /// logarithms, `x` being how large the noise is beside the curvature of the peaks that do the damage, `a` how much they count (Cook and
    /// Stefanski's simulation extrapolation). A parabola, or a line, through them takes off a fifth to two thirds too much, since the bias
    /// grows by less than a square and more than in proportion.
    ///
    /// # Reference
    /// J.R. Cook, L.A. Stefanski, Simulation-extrapolation estimation in parametric measurement error models, JASA 89 (1994) 1314-1328.
    pub fn of(damage: [f64; 3]) -> Self {
        debug_assert_eq!(NOISE, [1.0, 2.0, 3.0]);
        let [once, twice, thrice] = damage;
        if !(once > 0.0 && twice > once && thrice > 0.0) {
            return Self::default();
        }
        let [first, second] = [(twice / once).ln(), (thrice / twice).ln()];
        let ratio = second / first;
        let at = sharpness(ratio);
        let of_first = share(at);
        // How the share of the first step moves with the ratio of the steps; not at all where the search ends.
        let h = 0.01;
        let turn = (ratio_of(at + h) - ratio_of(at - h)) / (2.0 * h);
        let within = at > ENDS[0] + h && at < ENDS[1] - h;
        let moves = match within {
            true => (share(at + h) - share(at - h)) / (2.0 * h) / turn,
            false => 0.0,
        };
        // The added noise is one and the same but for its size, sqrt(3) and sqrt(8) of that there is.
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

/// Where the steps have a ratio, by halving.
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

    /// Drawn: 60,000 to four million parabolas at a random place between samples (seeded splitmix64 and Box and Muller), good to three digits.
    const DRAWN: [(f64, f64); 6] = [
        (0.125, 0.0158),
        (0.5, 0.2076),
        (1.0, 0.607),
        (2.0, 1.609),
        (4.0, 3.982),
        (8.0, 9.461),
    ];

    #[test]
    fn the_rise_of_an_extreme_is_that_of_drawn_parabolas() {
        for (x, drawn) in DRAWN {
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
            let bias = Bias::of(damage);
            assert!((bias.taken - 0.4).abs() < 1e-6, "{x}: {bias:?}");
            assert!(bias.line > bias.taken, "{x}: {bias:?}");
        }
        for damage in [[1.0, 1.0, 1.0], [1.0, 0.9, 1.2], [0.0, 1.0, 2.0], [0.0; 3]] {
            assert_eq!(Bias::of(damage).taken, 0.0);
        }
    }
}
