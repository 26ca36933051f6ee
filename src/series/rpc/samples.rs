//! Samples of an RPC III file.

use super::header::{Header, Numbers, RpcError, read_header};
use crate::series::channels::{Channel, Channels};

/// Appends the numbers of samples `from .. to` in the units of the file, one sample after the other, in the order of `columns` (`None` gives NaN).
pub fn read_samples(
    h: &Header,
    bytes: &[u8],
    from: usize,
    to: usize,
    columns: &[Option<usize>],
    out: &mut Vec<f64>,
) {
    let to = to.min(h.samples);
    let (k, first) = (columns.len(), out.len());
    out.resize(first + to.saturating_sub(from) * k, f64::NAN);
    let (n, width) = (h.channels.len(), h.numbers.width());
    let mut at = from;
    while at < to {
        let (group, within) = (at / h.per_group, at % h.per_group);
        let count = (h.per_group - within).min(to - at);
        for (j, column) in columns.iter().enumerate() {
            let Some((c, channel)) = column.and_then(|c| Some((c, h.channels.get(c)?))) else {
                continue;
            };
            let point = (group * n + c) * h.per_group + within;
            let begin = h.start + point * width;
            let Some(data) = bytes.get(begin..begin + count * width) else {
                continue;
            };
            let rows = out.iter_mut().skip(first + (at - from) * k + j).step_by(k);
            for (slot, b) in rows.zip(data.chunks_exact(width)) {
                *slot = value(b, h.numbers, h.big_endian) * channel.scale;
            }
        }
        at += count;
    }
}

fn value(b: &[u8], numbers: Numbers, big_endian: bool) -> f64 {
    match (numbers, b) {
        (Numbers::Int16, &[a, b]) if big_endian => f64::from(i16::from_be_bytes([a, b])),
        (Numbers::Int16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (Numbers::Float32, &[a, b, c, d]) if big_endian => {
            f64::from(f32::from_be_bytes([a, b, c, d]))
        }
        (Numbers::Float32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => f64::NAN,
    }
}

/// Returns the whole record.
///
/// # Errors
/// Errors of [`read_header`].
pub fn read_rpc(bytes: &[u8]) -> Result<Channels, RpcError> {
    let h = read_header(bytes)?;
    let list = h.channels.iter().enumerate().map(|(c, channel)| {
        let mut samples = Vec::new();
        read_samples(&h, bytes, 0, h.samples, &[Some(c)], &mut samples);
        Channel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            samples,
        }
    });
    Ok(Channels {
        rate_hz: 1.0 / h.dt,
        start_s: 0.0,
        list: list.collect(),
    })
}
