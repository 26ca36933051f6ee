//! Numbers that people read: one, two or five times a power of ten.

/// Rounds to the nearest of 1, 2, 5, 10 .. by ratio. A number that is not positive and finite is returned as it is.
pub(super) fn round(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return x;
    }
    let exponent = x.log10().floor() as i32;
    // The number is parsed from a digit and an exponent, so that 0.2 has no additional rounding error.
    let number = |digit: u32, exponent: i32| format!("{digit}e{exponent}").parse().unwrap_or(x);
    let steps = [
        number(1, exponent),
        number(2, exponent),
        number(5, exponent),
        number(1, exponent + 1),
    ];
    let distance = |step: &f64| (step / x).ln().abs();
    steps
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn numbers_become_one_two_or_five_times_a_power_of_ten() {
        for (x, rounded) in [
            (1.968503937007874, 2.0),
            (2248.089430997105, 2000.0),
            (50.0, 50.0),
            (0.019, 0.02),
            (8.0, 10.0),
            (0.0, 0.0),
        ] {
            assert_eq!(round(x), rounded);
        }
    }
}
