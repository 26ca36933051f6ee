//! The binary record of strainbridge: little endian, samples one after the other.
//!
//! | bytes | content |
//! |---|---|
//! | 0-7 | `STRAINBH` |
//! | 8-11 | u32, 1: version |
//! | 12-15 | u32, 4 or 8: bytes a number (f32, f64) |
//! | 16-19 | u32: number of columns |
//! | 20-23 | u32: where the samples begin |
//! | 24-31 | u64: number of samples |
//! | 32-39 | f64: time of the first sample, s |
//! | 40-47 | f64: time between samples, s |
//! | 48-55 | f64: value of one unit (1e-6: microstrain) |
//! | 56- | names: u16 length, UTF-8 |
//!
//! Then the samples, `n_columns` numbers each; a number that was not measured is NaN.

use std::io::{self, Write};

const MAGIC: &[u8; 8] = b"STRAINBH";

/// Header of a record in this format: all fields before the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Bytes per number, 4 or 8.
    pub width: usize,
    /// Names of the columns.
    pub names: Vec<String>,
    /// First byte of the samples.
    pub start: usize,
    /// Number of samples.
    pub samples: usize,
    /// Time of the first sample, s.
    pub t0: f64,
    /// Time between samples, s.
    pub dt: f64,
    /// Value of one unit. 1e-6 stands for microstrain.
    pub unit: f64,
}

/// Fault of a header, as a message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct HeaderError(&'static str);

/// Returns whether the bytes begin like such a record.
pub fn is_record(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Reads the header and compares it with the size of the file.
///
/// # Errors
/// Another version, numbers of another width, a cut header, fewer bytes than the samples it promises.
pub fn read_header(bytes: &[u8]) -> Result<Header, HeaderError> {
    let fault = HeaderError;
    let at = |from: usize, n: usize| bytes.get(from..from.checked_add(n)?);
    let u32_at = |from| {
        at(from, 4)
            .and_then(|b| b.try_into().ok())
            .map(u32::from_le_bytes)
    };
    let f64_at = |from| {
        at(from, 8)
            .and_then(|b| b.try_into().ok())
            .map(f64::from_le_bytes)
    };
    let short = || fault("the header is cut off");
    if u32_at(8).ok_or_else(short)? != 1 {
        return Err(fault("not version 1"));
    }
    let width = u32_at(12).ok_or_else(short)? as usize;
    if width != 4 && width != 8 {
        return Err(fault("numbers are neither 4 nor 8 bytes long"));
    }
    let columns = u32_at(16).ok_or_else(short)? as usize;
    let start = u32_at(20).ok_or_else(short)? as usize;
    let samples = at(24, 8)
        .and_then(|b| b.try_into().ok())
        .map(u64::from_le_bytes)
        .ok_or_else(short)?;
    let (t0, dt, unit) = (
        f64_at(32).ok_or_else(short)?,
        f64_at(40).ok_or_else(short)?,
        f64_at(48).ok_or_else(short)?,
    );
    let mut names = Vec::new();
    let mut p = 56;
    for _ in 0..columns {
        let n = at(p, 2)
            .and_then(|b| b.try_into().ok())
            .map(u16::from_le_bytes)
            .ok_or_else(short)? as usize;
        let name = at(p + 2, n)
            .and_then(|b| std::str::from_utf8(b).ok())
            .ok_or_else(|| fault("the name of a column is not text"))?;
        names.push(name.to_owned());
        p += 2 + n;
    }
    let left = bytes
        .len()
        .checked_sub(start)
        .filter(|_| start >= p)
        .ok_or_else(short)?;
    let row = columns
        .checked_mul(width)
        .filter(|r| *r > 0)
        .ok_or_else(|| fault("no columns"))?;
    let samples = usize::try_from(samples).map_err(|_| fault("too many samples"))?;
    if samples.checked_mul(row).is_none_or(|n| n > left) {
        return Err(fault("the file has fewer bytes than the header states"));
    }
    Ok(Header {
        width,
        names,
        start,
        samples,
        t0,
        dt,
        unit,
    })
}

/// Writes a header for `samples` samples of f32.
///
/// # Errors
/// An I/O error of `out`.
pub fn write_header(
    out: &mut dyn Write,
    names: &[String],
    samples: u64,
    t0: f64,
    dt: f64,
    unit: f64,
) -> io::Result<()> {
    let text: usize = names.iter().map(|n| 2 + n.len()).sum();
    let start = (56 + text).div_ceil(64) * 64;
    out.write_all(MAGIC)?;
    for v in [1, 4, names.len() as u32, start as u32] {
        out.write_all(&v.to_le_bytes())?;
    }
    out.write_all(&samples.to_le_bytes())?;
    for v in [t0, dt, unit] {
        out.write_all(&v.to_le_bytes())?;
    }
    for n in names {
        out.write_all(&(n.len() as u16).to_le_bytes())?;
        out.write_all(n.as_bytes())?;
    }
    out.write_all(&vec![0; start - 56 - text])
}

/// Appends the numbers of samples `from .. to` in the order of `columns` (`None` gives NaN).
pub fn read_samples(
    h: &Header,
    bytes: &[u8],
    from: usize,
    to: usize,
    columns: &[Option<usize>],
    out: &mut Vec<f64>,
) {
    let row = h.names.len() * h.width;
    let Some(data) = bytes.get(h.start + from * row..h.start + to * row) else {
        return;
    };
    let whole =
        columns.len() == h.names.len() && columns.iter().enumerate().all(|(i, c)| *c == Some(i));
    if whole && h.width == 8 {
        out.extend(
            data.chunks_exact(8)
                .map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])),
        );
    } else if whole {
        out.extend(
            data.chunks_exact(4)
                .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
        );
    } else {
        for sample in data.chunks_exact(row) {
            out.extend(columns.iter().map(|c| {
                match c.and_then(|c| sample.get(c * h.width..(c + 1) * h.width)) {
                    Some(&[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
                    Some(&[a, b, c, d, e, f, g, i]) => f64::from_le_bytes([a, b, c, d, e, f, g, i]),
                    _ => f64::NAN,
                }
            }));
        }
    }
}
