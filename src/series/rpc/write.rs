//! A time history as an RPC III file of 16-bit integers.

use super::header::{BLOCK, KEY, RECORD};
use std::io::{Result, Write};

/// Counts at full scale, `INT_FULL_SCALE`.
const FULL_SCALE: f64 = 32_752.0;
/// Samples of a frame, and of a group.
const FRAME: usize = 2048;

/// A channel to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Smallest value of the channel.
    pub min: f64,
    /// Largest value of the channel.
    pub max: f64,
}

impl Target {
    /// Returns the value of one count. The error of a written value is at most half of one count.
    pub fn scale(&self) -> f64 {
        let top = self.min.abs().max(self.max.abs());
        if top.is_finite() && top > 0.0 {
            top / FULL_SCALE
        } else {
            1.0
        }
    }
}

/// Writes `samples` samples, `dt` seconds apart, as an RPC III file. `next` appends the samples from .. to, one sample after the other.
///
/// A number that is not finite repeats the number before it, because the format has no such numbers. The last sample fills up the last
/// frame, and `SAMPLES` states the end. Returns how many numbers were repeated.
///
/// # Errors
/// Returns the errors of `out`.
///
/// # Example
/// Values come back within half a count of the 16-bit numbers:
/// ```
/// use strainbridge::series::rpc::{Target, read_rpc, write_rpc};
///
/// let force: Vec<f64> = (0..300).map(|i| 900.0 * (0.1 * f64::from(i)).sin()).collect();
/// let target = Target { name: "FZ".to_owned(), unit: "N".to_owned(), min: -900.0, max: 900.0 };
/// let half_a_count = 0.5 * target.scale();
/// let mut bytes = Vec::new();
/// let repeated = write_rpc(&mut bytes, &[target], 0.005, force.len(), |from, to, out| {
///     out.extend_from_slice(&force[from..to]);
/// })?;
/// assert_eq!(repeated, 0);
///
/// let record = read_rpc(&bytes).map_err(std::io::Error::other)?;
/// let read = record.samples("FZ").map_err(std::io::Error::other)?;
/// assert_eq!((read.len(), record.rate_hz), (300, 200.0));
/// assert!(read.iter().zip(&force).all(|(r, f)| (r - f).abs() <= 1.001 * half_a_count));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_rpc(
    out: &mut dyn Write,
    targets: &[Target],
    dt: f64,
    samples: usize,
    mut next: impl FnMut(usize, usize, &mut Vec<f64>),
) -> Result<u64> {
    write_header(out, targets, dt, samples)?;
    let n = targets.len();
    let (mut values, mut bytes) = (Vec::new(), Vec::new());
    let mut last = vec![0_i16; n];
    let mut repeated = 0;
    for from in (0..samples).step_by(FRAME) {
        let to = (from + FRAME).min(samples);
        values.clear();
        bytes.clear();
        next(from, to, &mut values);
        for (c, target) in targets.iter().enumerate() {
            let scale = target.scale();
            for s in 0..FRAME {
                match values.get(s * n + c) {
                    Some(v) if v.is_finite() => {
                        let counts = (v / scale).round().clamp(-FULL_SCALE, FULL_SCALE);
                        last[c] = counts as i16;
                    }
                    Some(_) => repeated += 1,
                    None => {}
                }
                bytes.extend_from_slice(&last[c].to_le_bytes());
            }
        }
        out.write_all(&bytes)?;
    }
    Ok(repeated)
}

fn write_header(out: &mut dyn Write, targets: &[Target], dt: f64, samples: usize) -> Result<()> {
    let n = targets.len();
    let mut records: Vec<(String, String)> = Vec::new();
    let mut put = |key: &str, value: String| records.push((key.to_owned(), value));
    put("FILE_TYPE", "TIME_HISTORY".into());
    put("TIME_TYPE", "RESPONSE".into());
    put("DATA_TYPE", "SHORT_INTEGER".into());
    put("OPERATION", "strainbridge recover".into());
    put("DELTA_T", format_real(dt));
    put("CHANNELS", n.to_string());
    put("PTS_PER_FRAME", FRAME.to_string());
    put("PTS_PER_GROUP", FRAME.to_string());
    put("FRAMES", samples.div_ceil(FRAME).to_string());
    put("SAMPLES", samples.to_string());
    put("HALF_FRAMES", "0".into());
    put("BYPASS_FILTER", "0".into());
    put("REPEATS", "1".into());
    put("INT_FULL_SCALE", format!("{FULL_SCALE:.0}"));
    put("PARTITIONS", "1".into());
    put("PART.CHAN_1", "1".into());
    put("PART.NCHAN_1", n.to_string());
    for (i, t) in (1..).zip(targets) {
        put(&format!("DESC.CHAN_{i}"), t.name.clone());
        put(&format!("UNITS.CHAN_{i}"), t.unit.clone());
        put(&format!("SCALE.CHAN_{i}"), format_real(t.scale()));
        put(&format!("LOWER_LIMIT.CHAN_{i}"), format_real(t.min));
        put(&format!("UPPER_LIMIT.CHAN_{i}"), format_real(t.max));
        put(&format!("MAP.CHAN_{i}"), i.to_string());
    }
    let count = records.len() + 3;
    let blocks = (count * RECORD).div_ceil(BLOCK);
    let first = [
        ("FORMAT", "BINARY".to_owned()),
        ("NUM_HEADER_BLOCKS", blocks.to_string()),
        ("NUM_PARAMS", count.to_string()),
    ];
    let mut header = Vec::with_capacity(blocks * BLOCK);
    for (key, value) in first
        .iter()
        .map(|(k, v)| (*k, v.as_str()))
        .chain(records.iter().map(|(k, v)| (k.as_str(), v.as_str())))
    {
        header.extend(pad_text(key, KEY));
        header.extend(pad_text(value, RECORD - KEY));
    }
    header.resize(blocks * BLOCK, 0);
    out.write_all(&header)
}

/// A real that every reader takes for one: with a point, and digits enough to come back.
fn format_real(x: f64) -> String {
    if x.is_finite() {
        format!("{x:.9E}")
    } else {
        "0.0".to_owned()
    }
}

/// Latin-1 text of fixed length that ends with a zero byte.
fn pad_text(text: &str, length: usize) -> Vec<u8> {
    let mut bytes: Vec<u8> = text
        .chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?'))
        .take(length - 1)
        .collect();
    bytes.resize(length, 0);
    bytes
}
