//! Numbers in a page: arrays as base64 of their steps, single numbers with the digits that show.

use serde_json::{Value, json};

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Base64 (RFC 4648, section 4) of bytes.
fn base64(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = group
            .iter()
            .enumerate()
            .fold(0_u32, |w, (i, b)| w | u32::from(*b) << (16 - 8 * i));
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k)) as usize & 63];
            out.push(if k <= group.len() { digit as char } else { '=' });
        }
    }
    out
}

/// Packs whole numbers in rows of `columns` as base64 of variable-length bytes. Each number is stored as its difference from the number above it. A
/// byte contains seven bits, the lowest first; its eighth bit is set if more bytes follow. Differences 0, -1, 1, -2 .. are coded as 0, 1, 2, 3 ..
pub fn packed_deltas(values: &[i64], columns: usize) -> Value {
    let mut bytes = Vec::with_capacity(2 * values.len());
    for (i, v) in values.iter().enumerate() {
        let above = i.checked_sub(columns).map_or(0, |k| values[k]);
        let step = v.wrapping_sub(above);
        let mut left = ((step << 1) ^ (step >> 63)) as u64;
        while left > 127 {
            bytes.push((left & 127) as u8 | 128);
            left >>= 7;
        }
        bytes.push(left as u8);
    }
    json!(base64(&bytes))
}

/// Number of steps between zero and the largest value in [`steps_of`].
pub const STEPS: f64 = 2047.0;

/// Returns numbers as shares of `most`, in [`STEPS`]. A number that is not finite gives one step below the smallest value.
pub fn steps_of(values: impl Iterator<Item = f64>, most: f64) -> Vec<i64> {
    let step = |v: f64| {
        if !v.is_finite() {
            -(STEPS as i64) - 1
        } else if most > 0.0 {
            (v / most * STEPS).round().clamp(-STEPS, STEPS) as i64
        } else {
            0
        }
    };
    values.map(step).collect()
}

/// Rounds a number to six significant digits; null for a number that is not finite.
pub fn round_number(x: f64) -> Value {
    if !x.is_finite() {
        return Value::Null;
    }
    format!("{x:.5e}")
        .parse::<f64>()
        .map_or(Value::Null, |v| json!(v))
}

/// Rounds a list of numbers to six significant digits each; null for numbers that are not finite.
pub fn round_numbers(values: impl IntoIterator<Item = f64>) -> Vec<Value> {
    values.into_iter().map(round_number).collect()
}
