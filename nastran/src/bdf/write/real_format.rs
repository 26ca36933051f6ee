//! Reals in few columns: `1.5-3`, `.5`, `-0.`.

/// Returns a short Nastran form of `x` that reads back as exactly `x`, without an exponent if 8 columns suffice.
///
/// A value that is not finite is written as 0.
pub fn shortest_real(x: f64) -> String {
    let (negative, digits, exponent) = parts(&format!("{:e}", finite_or_zero(x)));
    format_shortest(negative, &digits, exponent)
}

/// Returns the Nastran form of `x` in at most `width` columns (at least 8) with as many digits as fit.
///
/// In 16 columns the relative error is 5e-12 at worst (negative numbers with an exponent), mostly 0.
///
/// # Example
/// ```
/// use nastran::bdf::{Number, format_real, read_number, shortest_real};
///
/// assert_eq!(shortest_real(0.0015), ".0015");
/// for x in [7.85e-9, -210_000.0, 2.0 / 3.0, 6.674_3e-11] {
///     let text = format_real(x, 8);
///     assert!(text.len() <= 8);
///     let Some(Number::Real(read)) = read_number(text.as_bytes()) else { panic!("{text}") };
///     assert!((read / x - 1.0).abs() < 1e-4);
///     // The shortest form loses nothing.
///     assert_eq!(read_number(shortest_real(x).as_bytes()), Some(Number::Real(x)));
/// }
/// ```
pub fn format_real(x: f64, width: usize) -> String {
    let exact = shortest_real(x);
    if exact.len() <= width {
        return exact;
    }
    for decimals in (0..17).rev() {
        let (negative, digits, exponent) = parts(&format!("{:.*e}", decimals, finite_or_zero(x)));
        let text = format_shortest(negative, &digits, exponent);
        if text.len() <= width {
            return text;
        }
    }
    exact
}

fn finite_or_zero(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}

/// Returns sign, digits without trailing zeros, and the power of ten of the first digit, from text such as `-1.25e-3`.
fn parts(text: &str) -> (bool, String, i32) {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let negative = mantissa.starts_with('-');
    let mut digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    while digits.len() > 1 && digits.ends_with('0') {
        digits.pop();
    }
    (negative, digits, exponent.parse().unwrap_or(0))
}

/// Formats the value `d.ddd * 10^exponent` without an exponent if that takes at most 8 columns, otherwise in the shortest form.
fn format_shortest(negative: bool, digits: &str, exponent: i32) -> String {
    let sign = if negative { "-" } else { "" };
    if digits == "0" {
        return format!("{sign}0.");
    }
    let n = i32::try_from(digits.len()).unwrap_or(i32::MAX);
    let mut best = String::new();
    let mut offer = |text: String| {
        if best.is_empty() || text.len() < best.len() {
            best = text;
        }
    };
    if (-20..20).contains(&exponent) {
        let plain = format!("{sign}{}", with_point(digits, exponent + 1));
        if plain.len() <= 8 {
            return plain;
        }
        offer(plain);
    }
    // Try the point after `k` digits: a shift of the point can shorten the exponent by a digit.
    for k in [1, 0, n, exponent + 9, exponent - 9, exponent + 1] {
        let power = exponent + 1 - k;
        if (0..=n).contains(&k) && power != 0 {
            offer(format!("{sign}{}{power:+}", with_point(digits, k)));
        }
    }
    best
}

/// Returns the digits with the point after the first `k`; zeros are added if the point is outside the digits.
fn with_point(digits: &str, k: i32) -> String {
    let n = digits.len();
    match usize::try_from(k) {
        Ok(k) if k >= n => format!("{digits}{}.", "0".repeat(k - n)),
        Ok(k) => {
            let (head, tail) = digits.split_at(k);
            format!("{head}.{tail}")
        }
        Err(_) => format!(".{}{digits}", "0".repeat(k.unsigned_abs() as usize)),
    }
}
