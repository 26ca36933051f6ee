//! Groups of fixed records, a piece at a time.

use super::fault::read_error;
use super::field::{Field, values};
use crate::series::error::SeriesError;
use crate::series::record::column::Column;
use crate::series::record::reader::{
    BLOCK, Block, Bytes, OtherChannel, Pick, RecordReader, Sink, Times,
};
use crate::series::record::tile::Tile;
use falcon_mdf::blocks::CompressionType;
use falcon_mdf::data_index::DataBlockInfo;
use falcon_mdf::{ChannelGroup, Mf4File};
use std::borrow::Cow;
use std::io::Read;

/// Bytes of records that are a piece, about.
const PIECE: u64 = 4 << 20;
/// Bytes before the content of a block.
const HEAD: u64 = 24;
/// Bytes that one block may expand to.
const MOST: u64 = 1 << 30;

/// One group of channels.
pub(super) struct Group {
    columns: Vec<Column>,
    fields: Vec<Field>,
    time: Option<Field>,
    samples: usize,
    /// Bytes of a record, of the part before its data, of its data.
    size: usize,
    skip: usize,
    data: usize,
    /// Content that precedes each block, and the block.
    blocks: Vec<(u64, DataBlockInfo)>,
}

impl Group {
    /// Returns the group if its records have fixed length and its blocks are plain or deflated. Otherwise it returns `None`.
    ///
    /// # Errors
    /// Fewer bytes than the group states records, or blocks that lie outside of the file.
    pub(super) fn from_channel_group(
        file: &Mf4File,
        bytes: &Bytes,
        group: &ChannelGroup,
        finished: bool,
    ) -> Result<Option<Self>, SeriesError> {
        let Some(dg) = file.data_groups().get(group.data_group_index) else {
            return Ok(None);
        };
        let length = (**bytes).as_ref().len() as u64;
        let blocks: Vec<(u64, DataBlockInfo)> = dg
            .block_index()
            .iter()
            .map(|(at, b)| (at, b.clone()))
            .collect();
        for (_, b) in &blocks {
            let end = match &b.compression {
                Some(c) => c.data_offset.checked_add(b.compressed_size),
                None => b.offset.checked_add(HEAD + b.original_size),
            };
            if end.is_none_or(|end| end > length) {
                return Err(read_error("the file is cut off: a block ends beyond it"));
            }
        }
        if finished {
            let stated = stated_cycles((**bytes).as_ref(), group.block_offset());
            if stated.is_some_and(|n| n > group.sample_count) {
                return Err(read_error(format!(
                    "the file is cut off: it contains {} of {} samples",
                    group.sample_count,
                    stated.unwrap_or(0)
                )));
            }
        }
        let size = group.record_size(dg.rec_id_size());
        let (data, invalidation) = (group.data_bytes_len(), group.inval_bytes_len());
        let plain = blocks.iter().all(|(_, b)| {
            let codec = b.compression.as_ref().map(|c| c.algorithm);
            let known = matches!(
                codec,
                None | Some(CompressionType::Deflate | CompressionType::TransposedDeflate)
            );
            known && b.invalidation_block.is_none() && b.original_size <= MOST
        });
        let mut fields = Vec::new();
        let mut columns = Vec::new();
        for c in values(group) {
            match Field::from_channel(c).filter(|f| f.fits(data, invalidation)) {
                Some(f) => {
                    fields.push(f);
                    columns.push(Column::of_channel(&c.name, &c.unit));
                }
                None => return Ok(None),
            }
        }
        let time = match group.channels.iter().find(|c| c.is_time_channel()) {
            Some(c) => match Field::from_channel(c).filter(|f| f.fits(data, invalidation)) {
                Some(f) => Some(f),
                None => return Ok(None),
            },
            None => None,
        };
        let whole = !dg.is_unsorted() && plain && size > 0;
        Ok(whole.then_some(Self {
            columns,
            fields,
            time,
            samples: usize::try_from(group.sample_count).unwrap_or(0),
            size,
            skip: usize::from(dg.rec_id_size()),
            data,
            blocks,
        }))
    }

    /// Returns whether another group was sampled at the same times, within a share of a step.
    pub(super) fn same_clock(&self, other: &Self, bytes: &Bytes, share: f64) -> bool {
        if self.samples != other.samples || self.time.is_none() || other.time.is_none() {
            return false;
        }
        // The times of each piece take one megabyte.
        const ROWS: usize = 131_072;
        let mut from = 0;
        while from < self.samples {
            let to = (from + ROWS).min(self.samples);
            let (Ok(a), Ok(b)) = (self.times(bytes, from, to), other.times(bytes, from, to)) else {
                return false;
            };
            let step = match a.as_slice() {
                [a, b, ..] => (b - a).abs(),
                _ => 0.0,
            };
            if !a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= share * step) {
                return false;
            }
            from = to;
        }
        true
    }

    fn times(&self, bytes: &Bytes, from: usize, to: usize) -> Result<Vec<f64>, SeriesError> {
        let mut out = vec![f64::NAN; to - from];
        if let Some(t) = &self.time {
            let records = self.records((**bytes).as_ref(), from, to)?;
            t.decode(&self.body(&records), self.size, self.data, from, &mut out);
        }
        Ok(out)
    }

    /// Bytes of records `from .. to`.
    fn records<'a>(
        &self,
        file: &'a [u8],
        from: usize,
        to: usize,
    ) -> Result<Cow<'a, [u8]>, SeriesError> {
        let size = self.size as u64;
        let (begin, end) = (from as u64 * size, to as u64 * size);
        let first = self
            .blocks
            .partition_point(|(at, b)| at + b.original_size <= begin);
        let mut out: Vec<u8> = Vec::new();
        for (at, block) in self
            .blocks
            .iter()
            .skip(first)
            .take_while(|(at, _)| *at < end)
        {
            let content = content(file, block)?;
            let low = begin.saturating_sub(*at) as usize;
            let high = (end - at).min(block.original_size) as usize;
            let short = || read_error("a block is shorter than its stated length");
            match content {
                Cow::Borrowed(b) if *at <= begin && at + block.original_size >= end => {
                    return b.get(low..high).map(Cow::Borrowed).ok_or_else(short);
                }
                content => {
                    out.extend_from_slice(content.get(low..high).ok_or_else(short)?);
                }
            }
        }
        if out.len() as u64 != end - begin {
            return Err(read_error("the file is cut off: records are missing"));
        }
        Ok(Cow::Owned(out))
    }

    /// Records as the fields count: without the number of their group before each. The first is cut off here, those between stay.
    fn body<'a>(&self, records: &'a [u8]) -> Cow<'a, [u8]> {
        if self.skip == 0 {
            return Cow::Borrowed(records);
        }
        let shifted = records.get(self.skip..).unwrap_or_default();
        // Pad the last record to its full size, so that the length is a multiple of this size.
        let mut out = shifted.to_vec();
        out.resize(records.len(), 0);
        Cow::Owned(out)
    }
}

/// Returns the number of records that the block of a group states; `None` if it can't be read.
fn stated_cycles(file: &[u8], at: u64) -> Option<u64> {
    let word = |from: u64| {
        let from = usize::try_from(from).ok()?;
        let b: [u8; 8] = file.get(from..from.checked_add(8)?)?.try_into().ok()?;
        Some(u64::from_le_bytes(b))
    };
    // Layout of the block: id, reserved, length, number of links; links; number of the group; cycles.
    let links = word(at.checked_add(16)?)?;
    word(at.checked_add(HEAD + 8 * links.min(64) + 8)?)
}

/// Returns the content of a data block, decompressed.
fn content<'a>(file: &'a [u8], block: &DataBlockInfo) -> Result<Cow<'a, [u8]>, SeriesError> {
    let part = |from: u64, len: u64| {
        let from = usize::try_from(from).ok()?;
        file.get(from..from.checked_add(usize::try_from(len).ok()?)?)
    };
    let cut = || read_error("the file is cut off: a block ends beyond it");
    let Some(c) = &block.compression else {
        return part(block.offset + HEAD, block.original_size)
            .map(Cow::Borrowed)
            .ok_or_else(cut);
    };
    let packed = part(c.data_offset, block.compressed_size).ok_or_else(cut)?;
    let mut out = Vec::new();
    flate2::bufread::ZlibDecoder::new(packed)
        .take(block.original_size + 1)
        .read_to_end(&mut out)
        .map_err(read_error)?;
    if out.len() as u64 != block.original_size {
        return Err(read_error("a block expands to another size than stated"));
    }
    if c.algorithm == CompressionType::TransposedDeflate {
        out = Mf4File::un_transpose(&out, c.parameter as usize).map_err(read_error)?;
    }
    Ok(Cow::Owned(out))
}

/// Reader of groups with one clock as a record.
pub(super) struct FixedRecordReader {
    bytes: Bytes,
    groups: Vec<Group>,
    columns: Vec<Column>,
    /// Group and field of each column.
    places: Vec<(usize, usize)>,
    /// First sample of each piece, and the number of samples.
    starts: Vec<usize>,
    others: Vec<OtherChannel>,
}

impl FixedRecordReader {
    /// Creates the reader. Pieces end at the ends of blocks of the first group, so that a deflated block is usually expanded only once.
    pub(super) fn new(bytes: Bytes, groups: Vec<Group>, others: Vec<OtherChannel>) -> Self {
        let mut places = Vec::new();
        let mut columns = Vec::new();
        for (g, group) in groups.iter().enumerate() {
            for (f, column) in group.columns.iter().enumerate() {
                places.push((g, f));
                columns.push(column.clone());
            }
        }
        let mut starts = vec![0];
        if let Some(main) = groups.first() {
            let size = main.size as u64;
            let mut last = 0;
            for (at, block) in &main.blocks {
                let mut end = at + block.original_size;
                // A large uncompressed block is split into parts.
                if block.compression.is_none() {
                    let mut part = last + PIECE;
                    while part < end {
                        starts.push((part / size) as usize);
                        last = part;
                        part += PIECE;
                    }
                }
                end = end.min(main.samples as u64 * size);
                if end >= last + PIECE {
                    starts.push((end / size) as usize);
                    last = end;
                }
            }
            starts.retain(|s| *s < main.samples);
            starts.push(main.samples);
            starts.dedup();
            if main.samples == 0 {
                starts = vec![0];
            }
        }
        Self {
            bytes,
            groups,
            columns,
            places,
            starts,
            others,
        }
    }

    fn span(&self, piece: usize) -> Option<(usize, usize)> {
        Some((*self.starts.get(piece)?, *self.starts.get(piece + 1)?))
    }
}

impl RecordReader for FixedRecordReader {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn other_channels(&self) -> &[OtherChannel] {
        &self.others
    }

    fn times(&self) -> Times {
        let main = self.groups.first();
        match main.and_then(|g| g.time.as_ref()) {
            Some(t) => Times::Stored {
                rounding_s: t.rounding_error(),
                epoch_s: None,
                unit_stated: true,
            },
            None => Times::None {
                samples: Some(main.map_or(0, |g| g.samples)),
            },
        }
    }

    fn n_pieces(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    fn rows(&self, piece: usize) -> Option<usize> {
        self.span(piece).map(|(from, to)| to - from)
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let Some((begin, end)) = self.span(piece) else {
            return Ok(());
        };
        let file: &[u8] = (*self.bytes).as_ref();
        // Read the records of each group that has a pick.
        let place = |pick: &Pick| match pick {
            Pick::Time => Some((0, None)),
            Pick::Column(c) => self.places.get(*c).map(|(g, f)| (*g, Some(*f))),
            Pick::Nothing => None,
        };
        let mut records: Vec<Option<Cow<[u8]>>> = vec![None; self.groups.len()];
        for (g, _) in picks.iter().filter_map(place) {
            if let (Some(slot @ None), Some(group)) = (records.get_mut(g), self.groups.get(g)) {
                *slot = Some(group.records(file, begin, end)?);
            }
        }
        let bodies: Vec<Option<Cow<[u8]>>> = records
            .iter()
            .zip(&self.groups)
            .map(|(r, g)| r.as_ref().map(|r| g.body(r)))
            .collect();
        let k = picks.len();
        let mut values = vec![f64::NAN; BLOCK * k];
        let mut tile = Tile::new();
        for from in (begin..end).step_by(BLOCK) {
            let to = (from + BLOCK).min(end);
            for (j, pick) in picks.iter().enumerate() {
                let Some((g, f)) = place(pick) else { continue };
                let (Some(group), Some(Some(body))) = (self.groups.get(g), bodies.get(g)) else {
                    continue;
                };
                let field = match f {
                    Some(f) => group.fields.get(f),
                    None => group.time.as_ref(),
                };
                let rows = body.get((from - begin) * group.size..(to - begin) * group.size);
                if let (Some(field), Some(rows)) = (field, rows) {
                    let out = tile.column(j, to - from, &mut values, k);
                    field.decode(rows, group.size, group.data, from, out);
                }
            }
            tile.lay_out(&mut values, k);
            let block = Block {
                first: from - begin,
                rows: to - from,
                values: values.get(..(to - from) * k).unwrap_or_default(),
            };
            if sink(block).is_break() {
                break;
            }
        }
        Ok(())
    }
}
