//! A number with its uncertainty, rounded for readers.

use super::number::number;

/// Sizes between which a value is written without an exponent.
const PLAIN: std::ops::Range<f64> = 1e-3..1e6;
/// Half width below which it is written with an exponent, since it would have more zeros than digits.
const TINY: f64 = 1e-6;

/// Returns a value with the half width of its 95 % interval: `4.53 ± 0.36`. The half width has two significant digits; the value ends at the
/// same place, and has at most four significant digits. A dash is the text for an unknown value.
///
/// # Example
/// ```
/// use strainbridge::units::plus_minus;
///
/// assert_eq!(plus_minus(4.5321, 0.3612), "4.53 ± 0.36");
/// assert_eq!(plus_minus(38012.3, 1234.0), "38000 ± 1200");
/// assert_eq!(plus_minus(f64::NAN, 1.0), "-");
/// ```
pub fn plus_minus(value: f64, half: f64) -> String {
    if !value.is_finite() || !half.is_finite() || half <= 0.0 {
        return match value.is_finite() && half.is_finite() {
            true => number(value),
            false => "-".into(),
        };
    }
    if !PLAIN.contains(&value.abs().max(half)) || half < TINY {
        return format!("{} ± {half:.1e}", number(value));
    }
    let of_half = 1 - exponent(half);
    let of_value = match value == 0.0 {
        true => of_half,
        false => of_half.min(3 - exponent(value)),
    };
    format!(
        "{} ± {}",
        format_rounded(value, of_value),
        format_rounded(half, of_half)
    )
}

/// Returns the half width of a 95 % interval, `± 0.36`, with two significant digits; a dash for an unknown one.
pub fn half_width(half: f64) -> String {
    match half.is_finite() && PLAIN.contains(&half) {
        true => format!("± {}", format_rounded(half, 1 - exponent(half))),
        false if half.is_finite() => format!("± {half:.1e}"),
        false => "-".into(),
    }
}

fn exponent(x: f64) -> i32 {
    // A number that rounds up to the next power of ten has the exponent of that power.
    let e = x.abs().log10().floor() as i32;
    let two = x.abs() / 10f64.powi(e - 1);
    if two.round() >= 100.0 { e + 1 } else { e }
}

/// Formats a number up to a decimal place; negative places are before the decimal point.
fn format_rounded(x: f64, places: i32) -> String {
    let unit = 10f64.powi(-places);
    // Adding 0.0 removes the sign of a negative zero.
    let x = (x / unit).round() * unit + 0.0;
    format!("{x:.*}", places.max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_and_half_width_end_at_one_place() {
        for (value, half, text) in [
            (4.5321, 0.3612, "4.53 ± 0.36"),
            (-38.0123, 2.2, "-38.0 ± 2.2"),
            (38012.3, 1234.0, "38000 ± 1200"),
            (0.00012, 0.36, "0.00 ± 0.36"),
            (-0.00012, 0.36, "0.00 ± 0.36"),
            (12.0, 0.0996, "12.00 ± 0.10"),
            // The value has at most four digits, and the half width is never rounded to zero.
            (123.456789, 0.0012, "123.5 ± 0.0012"),
            (2.7e6, 1.2e4, "2.700e6 ± 1.2e4"),
            (0.0, 0.5, "0.00 ± 0.50"),
            (f64::NAN, 1.0, "-"),
        ] {
            assert_eq!(plus_minus(value, half), text);
        }
        assert_eq!(half_width(0.3612), "± 0.36");
        assert_eq!(half_width(f64::INFINITY), "-");
    }
}
