//! Numbers in a page: arrays as base64 of little-endian bytes (plotly.js reads `{dtype, bdata}`), single numbers with the digits that show.

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

/// Reals of 32 bits.
pub fn packed_f32(values: impl Iterator<Item = f64>) -> Value {
    let bytes: Vec<u8> = values.flat_map(|v| (v as f32).to_le_bytes()).collect();
    json!({ "dtype": "f4", "bdata": base64(&bytes) })
}

/// Whole numbers, of 16 bits where all of them fit.
pub fn packed_u32(values: &[u32]) -> Value {
    if values.iter().all(|v| *v <= u32::from(u16::MAX)) {
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|v| (*v as u16).to_le_bytes())
            .collect();
        return json!({ "dtype": "u2", "bdata": base64(&bytes) });
    }
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    json!({ "dtype": "u4", "bdata": base64(&bytes) })
}

/// Reals as shares of `most`, in 32767 steps; [`i16::MIN`] where there is none.
pub fn packed_i16(values: impl Iterator<Item = f64>, most: f64) -> Value {
    let step = |v: f64| {
        if !v.is_finite() {
            i16::MIN
        } else if most > 0.0 {
            (v / most * 32767.0).round().clamp(-32767.0, 32767.0) as i16
        } else {
            0
        }
    };
    let bytes: Vec<u8> = values.flat_map(|v| step(v).to_le_bytes()).collect();
    json!({ "dtype": "i2", "bdata": base64(&bytes) })
}

/// Six significant digits; null where there is no number.
pub fn short(x: f64) -> Value {
    if !x.is_finite() {
        return Value::Null;
    }
    format!("{x:.5e}")
        .parse::<f64>()
        .map_or(Value::Null, |v| json!(v))
}

/// The same for a list.
pub fn shorts(values: impl IntoIterator<Item = f64>) -> Vec<Value> {
    values.into_iter().map(short).collect()
}
