//! ASAM MDF 4: the channels sampled together with those that are wanted, read by parts of their data blocks.
//!
//! `falcon_mdf` determines the layout of the file. Groups of fixed records in blocks, plain or deflated, are read a piece at a time
//! ([`fixed_records`]). Other forms (groups whose records alternate, values apart from invalidation, Zstandard, LZ4) are decoded whole by the
//! library.

mod fault;
mod field;
mod fixed_records;

use super::column::Column;
use super::memory_record::MemoryRecord;
use super::reader::{Bytes, OtherChannel, RecordReader, Times};
use crate::series::error::SeriesError;
use falcon_mdf::io::{ByteSlice, ByteSource};
use falcon_mdf::{ChannelGroup, Mf4Error, Mf4File};
use fault::read_error;
use field::{Field, values};
use fixed_records::{FixedRecordReader, Group};
use std::sync::Arc;

/// Times of two groups that are the same to this share of a step count as one clock.
const SAME: f64 = 1e-3;

/// The bytes of the file as the library asks for them.
struct Source(Bytes);

impl ByteSource for Source {
    fn len(&self) -> u64 {
        (*self.0).as_ref().len() as u64
    }

    fn read_bytes(&self, offset: u64, len: usize) -> falcon_mdf::Result<ByteSlice<'_>> {
        let bytes: &[u8] = (*self.0).as_ref();
        usize::try_from(offset)
            .ok()
            .and_then(|from| bytes.get(from..from.checked_add(len)?))
            .map(ByteSlice::borrowed)
            .ok_or_else(|| {
                Mf4Error::parse_error(format!("the file ends before byte {offset} + {len}"))
            })
    }
}

/// Opens the channels of the group that contains most of `wanted`, or most numbers if `wanted` is empty. Channels of every group with equal times are
/// included, and text is left out. An invalid sample is NaN.
///
/// # Errors
/// A file that can't be read or is cut off, wanted channels on other times.
pub(super) fn open(bytes: Bytes, wanted: &[String]) -> Result<Box<dyn RecordReader>, SeriesError> {
    let file = Mf4File::from_source(Arc::new(Source(bytes.clone()))).map_err(read_error)?;
    let groups: Vec<&ChannelGroup> = file
        .data_groups()
        .iter()
        .flat_map(|d| &d.channel_groups)
        .filter(|g| values(g).next().is_some() && !g.is_vlsd())
        .collect();
    let weight = |g: &ChannelGroup| {
        let asked = values(g).filter(|c| wanted.contains(&c.name)).count();
        (
            asked,
            g.sample_count.saturating_mul(g.channels.len() as u64),
        )
    };
    let Some(main) = groups.iter().copied().max_by_key(|g| weight(g)) else {
        return Err(read_error("it contains no channels"));
    };
    let finished = file.unfinalized().is_none();
    let mut plain: Vec<Option<Group>> = Vec::new();
    for g in &groups {
        plain.push(Group::from_channel_group(&file, &bytes, g, finished)?);
    }
    let at = |g: &ChannelGroup| groups.iter().position(|o| std::ptr::eq(*o, g));
    let main_at = at(main).unwrap_or(0);
    let Some(clock) = plain.get_mut(main_at).and_then(Option::take) else {
        let mut read = decode_group(&file, main)?;
        let rest = groups.iter().filter(|g| !std::ptr::eq(**g, main));
        read.others = rest.flat_map(|g| list_other_channels(g)).collect();
        return Ok(Box::new(read));
    };
    let mut apart: Vec<OtherChannel> = Vec::new();
    let mut list = vec![clock];
    for (other, group) in groups.iter().zip(plain) {
        if std::ptr::eq(*other, main) {
            continue;
        }
        match group {
            Some(group)
                if list
                    .first()
                    .is_some_and(|m| m.same_clock(&group, &bytes, SAME)) =>
            {
                list.push(group);
            }
            _ => apart.extend(list_other_channels(other)),
        }
    }
    let names = apart.iter().map(|c| c.name.clone());
    let names: Vec<String> = names.filter(|n| wanted.contains(n)).collect();
    if !names.is_empty() {
        return Err(SeriesError::Apart { names });
    }
    Ok(Box::new(FixedRecordReader::new(bytes, list, apart)))
}

/// Channels of a group that is not read.
fn list_other_channels(group: &ChannelGroup) -> impl Iterator<Item = OtherChannel> {
    values(group).map(|c| OtherChannel {
        group: group.acquisition_name.clone(),
        name: c.name.clone(),
        unit: c.unit.clone(),
        samples: usize::try_from(group.sample_count).unwrap_or(usize::MAX),
        rate_hz: None,
    })
}

/// A group decoded whole.
fn decode_group(file: &Mf4File, group: &ChannelGroup) -> Result<MemoryRecord, SeriesError> {
    let mut columns = Vec::new();
    let mut samples = Vec::new();
    let decode = |c: &falcon_mdf::Channel| -> Result<Vec<f64>, SeriesError> {
        let signal = file.signal(c).map_err(read_error)?;
        let mut samples = signal.values_f64().map_err(read_error)?;
        if let Some(valid) = signal.validity() {
            for (v, valid) in samples.iter_mut().zip(valid) {
                *v = if valid { *v } else { f64::NAN };
            }
        }
        Ok(samples)
    };
    for c in values(group) {
        columns.push(Column::of_channel(&c.name, &c.unit));
        samples.push(decode(c)?);
    }
    let clock = group.channels.iter().find(|c| c.is_time_channel());
    let stored = clock.map(decode).transpose()?;
    Ok(MemoryRecord {
        columns,
        times: match (&stored, clock) {
            (Some(_), Some(c)) => Times::Stored {
                rounding_s: Field::from_channel(c).map_or(0.0, |f| f.rounding_error()),
                epoch_s: None,
                unit_stated: true,
            },
            _ => Times::None {
                samples: samples.first().map(Vec::len),
            },
        },
        samples,
        stored: stored.unwrap_or_default(),
        others: Vec::new(),
    })
}
