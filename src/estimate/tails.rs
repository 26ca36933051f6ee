//! Chances of a value at least as large, for any result of arithmetic. The chance is 1 for NaN (zero over zero), which is no evidence.

use statrs::distribution::{
    Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, FisherSnedecor, StudentsT,
};

/// A ratio beyond which the chance is 0 to every digit, and whose square and products do not overflow.
const FAR: f64 = 1e100;

fn evaluate_tail(x: f64, tail: impl Fn(f64) -> Option<f64>) -> f64 {
    if x.is_nan() {
        1.0
    } else if x > FAR {
        0.0
    } else {
        tail(x.max(-FAR)).filter(|p| !p.is_nan()).unwrap_or(1.0)
    }
}

/// Probability that a stated interval or region contains the truth.
pub const COVERAGE: f64 = 0.95;
/// Probability of a coverage as low as observed, below which intervals count as too narrow.
pub const TOO_FEW: f64 = 0.01;

/// Returns the probability that at most `held` of `of` independent 95 % intervals contain the truth. It is 1 if `of` is 0.
///
/// # Example
/// ```
/// use strainbridge::estimate::{TOO_FEW, chance_of_so_few};
///
/// // One interval misses with the probability 0.05, two miss with its square.
/// assert!((chance_of_so_few(0, 1) - 0.05).abs() < 1e-12);
/// assert!((chance_of_so_few(0, 2) - 0.0025).abs() < 1e-12);
/// assert_eq!(chance_of_so_few(20, 20), 1.0);
/// // 15 of 20 intervals is evidence that they are too narrow.
/// assert!(chance_of_so_few(15, 20) < TOO_FEW);
/// ```
pub fn chance_of_so_few(held: usize, of: usize) -> f64 {
    Binomial::new(COVERAGE, of as u64).map_or(1.0, |b| b.cdf(held as u64))
}

/// Returns the upper tail probability of chi-square with `dof` degrees of freedom. It is 1 if `dof` is 0 or the value is not a number.
///
/// # Example
/// ```
/// use strainbridge::estimate::chi_square_tail;
///
/// // Abramowitz and Stegun, table 26.8: 3.841 and 18.307 are exceeded with the probability 0.05.
/// assert!((chi_square_tail(3.84146, 1.0) - 0.05).abs() < 1e-6);
/// assert!((chi_square_tail(18.30704, 10.0) - 0.05).abs() < 1e-6);
/// // Two degrees of freedom have a closed form: exp(-x / 2).
/// assert!((chi_square_tail(6.0, 2.0) - (-3.0_f64).exp()).abs() < 1e-12);
/// ```
pub fn chi_square_tail(chi2: f64, dof: f64) -> f64 {
    evaluate_tail(chi2, |x| Some(ChiSquared::new(dof).ok()?.sf(x)))
}

/// Returns the upper tail probability of Student's t, one side; 1 without degrees of freedom.
pub fn student_tail(t: f64, dof: f64) -> f64 {
    evaluate_tail(t, |x| Some(StudentsT::new(0.0, 1.0, dof).ok()?.sf(x)))
}

/// Returns the upper tail probability of a ratio of variances with `dof` and `from` degrees of freedom; 1 if either has none.
pub fn f_tail(ratio: f64, dof: f64, from: f64) -> f64 {
    evaluate_tail(ratio, |x| Some(FisherSnedecor::new(dof, from).ok()?.sf(x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference: Abramowitz and Stegun, Handbook of Mathematical Functions (1964), tables 26.8, 26.9, 26.10.
    #[test]
    fn tails_are_those_of_tables() {
        assert!((chi_square_tail(11.0705, 5.0) - 0.05).abs() < 1e-6);
        // The table has three digits after the point. The tolerance is half a unit of the last digit times the density.
        assert!((student_tail(2.776, 4.0) - 0.025).abs() < 1.2e-5);
        assert!((f_tail(5.19, 4.0, 5.0) - 0.05).abs() < 1e-4);
    }

    #[test]
    fn zero_over_zero_has_no_probability_and_far_values_are_impossible() {
        // Student's tail is one-sided: half of the distribution is above zero.
        for (tail, at_zero) in [
            ((|x| chi_square_tail(x, 3.0)) as fn(f64) -> f64, 1.0),
            (|x| student_tail(x, 3.0), 0.5),
            (|x| f_tail(x, 3.0, 4.0), 1.0),
        ] {
            assert_eq!(
                (tail(f64::NAN), tail(f64::INFINITY), tail(1e308)),
                (1.0, 0.0, 0.0)
            );
            assert!((tail(0.0) - at_zero).abs() < 1e-12);
        }
        assert_eq!(
            (chi_square_tail(1.0, 0.0), f_tail(1.0, f64::NAN, 1.0)),
            (1.0, 1.0)
        );
    }
}
