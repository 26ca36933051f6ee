//! Numbers as a reader wants them.

/// What stands where a number is not known.
const UNKNOWN: &str = "-";

/// Four significant digits; a dash where it is not known.
pub fn number(x: f64) -> String {
    if x.is_nan() {
        return UNKNOWN.into();
    }
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return "∞".into();
    }
    let digits = x.abs().log10().floor() as i32;
    if (-4..6).contains(&digits) {
        format!("{x:.*}", (3 - digits).max(0) as usize)
    } else {
        format!("{x:.3e}")
    }
}

/// Formats a number with `digits` decimals; a dash for NaN and infinity.
pub fn fixed(x: f64, digits: usize) -> String {
    match x.is_finite() {
        true => format!("{x:.digits$}"),
        false => UNKNOWN.into(),
    }
}
