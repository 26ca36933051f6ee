//! Numbers as loggers and spreadsheets write them, read fast and to the last digit; seven digits of a number, written fast.

/// The mark between the whole part and the fraction of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecimalMark {
    /// `1.5`.
    Point,
    /// `1,5`, in a table that has commas and no points in its numbers.
    Comma,
    /// Comma or point: a table that commas don't divide, until one of its numbers shows which.
    CommaOrPoint,
}

impl DecimalMark {
    /// Returns whether a character is the mark between whole and fraction.
    #[inline(always)]
    fn is(self, b: u8) -> bool {
        (b == b'.' && self != Self::Comma) || (b == b',' && self != Self::Point)
    }

    /// Returns the decimal mark that is possible in a table whose fields `delimiter` divides.
    pub fn from_delimiter(delimiter: u8) -> Self {
        if delimiter == b',' {
            Self::Point
        } else {
            Self::CommaOrPoint
        }
    }
}

/// Powers of ten that are exact.
const EXACT: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Returns the number at the beginning of `text` and its length in bytes; `None` if the exact method does not apply. The method applies if the digits
/// are a whole number below 2^53 and the power of ten is at most 22. The product is then the nearest number (Clinger 1990).
#[inline]
pub fn short_number(text: &[u8], mark: DecimalMark) -> Option<(f64, usize)> {
    let mut at = 0;
    let negative = match text.first() {
        Some(b'-') => {
            at = 1;
            true
        }
        Some(b'+') => {
            at = 1;
            false
        }
        _ => false,
    };
    let (mut whole, mut digits, mut power) = (0u64, 0u32, 0i32);
    let mut fraction = false;
    while let Some(&b) = text.get(at) {
        if b.is_ascii_digit() {
            whole = whole.wrapping_mul(10).wrapping_add(u64::from(b - b'0'));
            digits += 1;
            power -= i32::from(fraction);
        } else if !fraction && mark.is(b) {
            fraction = true;
        } else {
            break;
        }
        at += 1;
    }
    if digits == 0 || digits > 18 {
        return None;
    }
    if let Some(b'e' | b'E') = text.get(at) {
        at += 1;
        let down = match text.get(at) {
            Some(b'-') => {
                at += 1;
                true
            }
            Some(b'+') => {
                at += 1;
                false
            }
            _ => false,
        };
        let (from, mut e) = (at, 0i32);
        while let Some(&b) = text.get(at) {
            if !b.is_ascii_digit() || at - from > 3 {
                break;
            }
            e = e * 10 + i32::from(b - b'0');
            at += 1;
        }
        if at == from {
            return None;
        }
        power += if down { -e } else { e };
    }
    if whole >= 1 << 53 {
        return None;
    }
    let scale = *EXACT.get(power.unsigned_abs() as usize)?;
    let size = if power < 0 {
        whole as f64 / scale
    } else {
        whole as f64 * scale
    };
    Some((if negative { -size } else { size }, at))
}

/// Texts that programs and spreadsheets write for a missing value.
const NOT_MEASURED: [&[u8]; 6] = [b"nan", b"na", b"n/a", b"#n/a", b"#nv", b"null"];
/// Texts that the C library of Windows writes for NaN, without the zeros that fill the field.
const NO_NUMBER: [&[u8]; 3] = [b"1.#qnan", b"1.#snan", b"1.#ind"];

/// Returns whether a field is a text for a missing value: `NaN`, `-nan(ind)`, `#N/A`, `-1.#IND00`.
fn is_not_measured(field: &[u8]) -> bool {
    let is = |list: &[&[u8]], f: &[u8]| list.iter().any(|w| f.eq_ignore_ascii_case(w));
    let bare = field
        .strip_prefix(b"-")
        .or_else(|| field.strip_prefix(b"+"))
        .unwrap_or(field);
    // Find the kind of missing value.
    let begins = bare.iter().position(|b| *b == b'(');
    let before = begins.and_then(|at| bare.strip_suffix(b")")?.get(..at));
    let zeros = bare.iter().rev().take_while(|b| **b == b'0').count();
    let filled = bare.get(..bare.len() - zeros).unwrap_or_default();
    let point: Vec<u8> = filled
        .iter()
        .map(|b| if *b == b',' { b'.' } else { *b })
        .collect();
    is(&NOT_MEASURED, field) || is(&[b"nan"], before.unwrap_or(bare)) || is(&NO_NUMBER, &point)
}

/// Returns the number in a whole field; NaN for an empty field, `NaN`, `NA`, `#N/A` and similar texts; `None` if it is not a number.
pub fn number(field: &[u8], mark: DecimalMark) -> Option<f64> {
    let field = field.trim_ascii();
    if let Some((v, n)) = short_number(field, mark)
        && n == field.len()
    {
        return Some(v);
    }
    if field.is_empty() || is_not_measured(field) {
        return Some(f64::NAN);
    }
    let text = std::str::from_utf8(field).ok()?;
    let begins = field.trim_ascii_start().first()?;
    // The standard parser accepts `inf` and `infinity`, which are not readings.
    if !(begins.is_ascii_digit() || b"+-.,".contains(begins)) || text.contains(['i', 'I']) {
        return None;
    }
    if mark == DecimalMark::Comma && text.contains('.') {
        return None;
    }
    if mark != DecimalMark::Point && !text.contains('.') {
        return text.replacen(',', ".", 1).parse().ok();
    }
    text.parse().ok()
}

/// Appends `value` with seven digits, as `1.234567e3`. A number that is not finite appends nothing.
///
/// The digits come from a product in double precision. The last digit may differ from the exact rounding by one if the eighth and the following
/// digits are 4999999 or 5000000.
pub fn push_seven_digits(out: &mut Vec<u8>, value: f64) {
    if !value.is_finite() {
        return;
    }
    let size = value.abs();
    if value.is_sign_negative() {
        out.push(b'-');
    }
    if size == 0.0 {
        out.extend_from_slice(b"0.000000e0");
        return;
    }
    if !(1e-280..1e280).contains(&size) {
        out.extend_from_slice(format!("{size:.6e}").as_bytes());
        return;
    }
    let mut power = size.log10().floor() as i32;
    let mut digits = scale_by_power(size, 6 - power);
    if digits >= 10_000_000 {
        power += 1;
        digits = scale_by_power(size, 6 - power);
    } else if digits < 1_000_000 {
        power -= 1;
        digits = scale_by_power(size, 6 - power);
    }
    let mut text = [b'0'; 8];
    for place in text.iter_mut().rev() {
        *place = b'0' + (digits % 10) as u8;
        digits /= 10;
    }
    out.push(text[1]);
    out.push(b'.');
    out.extend_from_slice(&text[2..]);
    out.push(b'e');
    if power < 0 {
        out.push(b'-');
    }
    let power = power.unsigned_abs();
    if power >= 100 {
        out.push(b'0' + (power / 100) as u8);
    }
    if power >= 10 {
        out.push(b'0' + (power / 10 % 10) as u8);
    }
    out.push(b'0' + (power % 10) as u8);
}

fn scale_by_power(size: f64, power: i32) -> u64 {
    let exact = |p: u32| EXACT.get(p as usize).copied();
    let product = match (exact(power.unsigned_abs()), power < 0) {
        (Some(scale), true) => size / scale,
        (Some(scale), false) => size * scale,
        (None, _) => size * 10f64.powi(power),
    };
    product.round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    /// Returns finite numbers of every exponent and sign from random bits.
    fn finite_numbers(count: usize) -> impl Iterator<Item = (f64, usize)> {
        let mut rng = StdRng::seed_from_u64(1);
        let draw = move || (f64::from_bits(rng.random()), rng.random_range(0..12));
        let drawn = std::iter::repeat_with(draw);
        drawn.filter(|d| d.0.is_finite()).take(count)
    }

    #[test]
    fn short_numbers_are_read_as_the_standard_library_reads_them() {
        for (v, digits) in finite_numbers(2000) {
            for text in [
                format!("{v}"),
                format!("{v:.digits$e}"),
                format!("{:.digits$}", v % 1e6),
            ] {
                let wanted: Option<f64> = text.parse().ok();
                assert!(wanted.is_some());
                assert_eq!(
                    number(text.as_bytes(), DecimalMark::Point),
                    wanted,
                    "{text}"
                );
                let comma = text.replace('.', ",");
                let read = number(comma.as_bytes(), DecimalMark::CommaOrPoint);
                assert_eq!(read, wanted, "{comma}");
            }
        }
    }

    #[test]
    fn seven_digits_come_back_within_half_a_unit_of_the_last() {
        for (v, _) in finite_numbers(2000).filter(|(v, _)| v.abs() > 1e-300) {
            let mut out = Vec::new();
            push_seven_digits(&mut out, v);
            let back: f64 = std::str::from_utf8(&out).unwrap().parse().unwrap();
            assert!((back - v).abs() <= 5.001e-7 * v.abs(), "{v} {back}");
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in [
            "abc", "1,5", "1.2.3", "--1", "1e", "inf", "-inf", "0x10", "1 2", "e5", ".",
        ] {
            assert_eq!(number(text.as_bytes(), DecimalMark::Point), None, "{text}");
        }
        for text in ["1,2,3", "1.234,5", "1,234.5"] {
            assert_eq!(
                number(text.as_bytes(), DecimalMark::CommaOrPoint),
                None,
                "{text}"
            );
        }
        for text in [
            "",
            " ",
            "NaN",
            "nan",
            "NA",
            "-nan",
            "-nan(ind)",
            "nan(snan)",
            "+NaN",
            "#N/A",
            "1.#QNAN",
            "-1.#IND",
            "1.#QNAN000",
            "-1,#IND00",
        ] {
            let marks = [DecimalMark::Point, DecimalMark::Comma];
            for mark in marks {
                assert!(
                    number(text.as_bytes(), mark).is_some_and(f64::is_nan),
                    "{text}"
                );
            }
        }
        // Infinity and incomplete markers are not missing values.
        for text in [
            "1.#INF",
            "-1.#INF00",
            "nan(",
            "(nan)",
            "-#N/A",
            "1.#",
            "nano",
        ] {
            assert_eq!(number(text.as_bytes(), DecimalMark::Point), None, "{text}");
        }
        for (text, mark) in [("1.5", DecimalMark::Comma), ("1,5", DecimalMark::Point)] {
            assert_eq!(number(text.as_bytes(), mark), None, "{text}");
        }
        assert_eq!(number(b"-1,5e2", DecimalMark::Comma), Some(-150.0));
    }

    #[test]
    fn seven_digits_are_written_as_the_standard_library_writes_them() {
        for v in [
            1.0,
            -2.5,
            123_456.7,
            1e-9,
            9.999_999_6,
            9.999_999_4,
            1e22,
            1e23,
            3e-120,
            0.0,
            1e300,
            999_999_950.0,
        ] {
            let mut out = Vec::new();
            push_seven_digits(&mut out, v);
            assert_eq!(String::from_utf8(out).unwrap(), format!("{v:.6e}"));
        }
    }
}
