//! Numbers as Nastran writes them: `1`, `1.5-3`, `.5`, `-0.`, `1.D-3`.

/// A field that is a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// No point and no exponent.
    Integer(i64),
    /// With a point or an exponent.
    Real(f64),
}

/// Reads the number in a trimmed field, correctly rounded; `None` if the field is not a finite number.
///
/// A real has a point or an exponent letter (E or D). If there is a point, the letter may be missing before a signed exponent (`1.5-3`). A blank is
/// allowed after a leading sign and before the exponent.
pub fn read_number(field: &[u8]) -> Option<Number> {
    let mut at = 0;
    let mut negative = false;
    if let Some(&sign @ (b'+' | b'-')) = field.first() {
        negative = sign == b'-';
        at = skip_blanks(field, 1);
    }
    let (point_at, whole) = digits(field, at, 0);
    let point = field.get(point_at) == Some(&b'.');
    let (end, mantissa) = match point {
        true => digits(field, point_at + 1, whole),
        false => (point_at, whole),
    };
    let behind = end - point_at - usize::from(point);
    let count = point_at - at + behind;
    if count == 0 {
        return None;
    }
    if end == field.len() && !point {
        return integer(field.get(at..end)?, mantissa, negative);
    }
    let exponent = if end == field.len() {
        0
    } else {
        exponent(field, end, point)?
    };
    if count <= DIGITS
        && mantissa <= 1 << 53
        && let Some(value) = scale_exactly(mantissa, exponent - behind as i64)
    {
        return Some(Number::Real(if negative { -value } else { value }));
    }
    parse_with_std(field)
}

/// Largest number of digits that always fit in a `u64`.
const DIGITS: usize = 18;

/// Appends the digits from `at` on to a mantissa, modulo 2^64; also returns where they end.
#[inline]
fn digits(field: &[u8], mut at: usize, mut mantissa: u64) -> (usize, u64) {
    while let Some(digit) = field.get(at).map(|c| c.wrapping_sub(b'0'))
        && digit < 10
    {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (at, mantissa)
}

fn skip_blanks(field: &[u8], mut at: usize) -> usize {
    while field.get(at) == Some(&b' ') {
        at += 1;
    }
    at
}

/// Returns the integer of these digits; leading zeros do not count.
fn integer(digits: &[u8], mantissa: u64, negative: bool) -> Option<Number> {
    if digits.len() > DIGITS && digits.iter().skip_while(|c| **c == b'0').count() > DIGITS {
        return None;
    }
    let value = i64::try_from(mantissa).ok()?;
    Some(Number::Integer(if negative { -value } else { value }))
}

/// Reads the exponent that begins at `at` and must extend to the end of the field.
fn exponent(field: &[u8], at: usize, point: bool) -> Option<i64> {
    let mut at = skip_blanks(field, at);
    let letter = matches!(field.get(at), Some(b'e' | b'E' | b'd' | b'D'));
    if letter {
        at = skip_blanks(field, at + 1);
    }
    let mut negative = false;
    let signed = matches!(field.get(at), Some(b'+' | b'-'));
    if signed {
        negative = field.get(at) == Some(&b'-');
        at += 1;
    }
    if !letter && !(signed && point) {
        return None;
    }
    let digits = field.get(at..)?;
    if digits.is_empty() || digits.len() > 6 {
        return None;
    }
    let mut value = 0_i64;
    for &c in digits {
        if !c.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i64::from(c - b'0');
    }
    Some(if negative { -value } else { value })
}

/// Returns `mantissa * 10^power` if one rounding suffices, that is if both factors are exact doubles.
fn scale_exactly(mantissa: u64, power: i64) -> Option<f64> {
    const POWERS: [f64; 23] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
        1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
    ];
    let factor = *POWERS.get(usize::try_from(power.unsigned_abs()).ok()?)?;
    let m = mantissa as f64;
    Some(if power < 0 { m / factor } else { m * factor })
}

/// Reads a long mantissa or a large exponent with the standard library.
fn parse_with_std(field: &[u8]) -> Option<Number> {
    let mut text = String::with_capacity(field.len() + 1);
    let mut digit_seen = false;
    for &c in field {
        match c {
            b' ' => {}
            b'd' | b'D' | b'E' => text.push('e'),
            b'+' | b'-' if digit_seen && !text.ends_with('e') => {
                text.push('e');
                text.push(char::from(c));
            }
            _ => {
                digit_seen |= c.is_ascii_digit() || c == b'.';
                text.push(char::from(c));
            }
        }
    }
    text.parse::<f64>()
        .ok()
        .filter(|x| x.is_finite())
        .map(Number::Real)
}
