//! Formats numbers for reports.

/// Text for an unknown number.
const UNKNOWN: &str = "-";

/// Formats a number with four significant digits; a dash if it is unknown.
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
pub fn format_fixed(x: f64, digits: usize) -> String {
    match x.is_finite() {
        true => format!("{x:.digits$}"),
        false => UNKNOWN.into(),
    }
}

/// Formats a share in percent with three digits: `9.64 %`; a dash for NaN and infinity.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if !percent.is_finite() {
        return UNKNOWN.into();
    }
    let digits = match percent.abs() {
        v if v >= 100.0 || v == 0.0 => 0,
        v => (2 - v.log10().floor() as i32).clamp(0, 4) as usize,
    };
    format!("{percent:.digits$} %")
}
