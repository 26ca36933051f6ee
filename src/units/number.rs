//! Numbers as a reader wants them.

/// Four significant digits.
pub fn number(x: f64) -> String {
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
