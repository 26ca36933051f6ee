//! The lists of a TDMS file: which channels there are and where their samples lie.

use super::fault::read_error;
use super::stamp::Stamp;
use crate::series::error::SeriesError;
use std::collections::BTreeMap;

/// Bytes before what a segment holds.
const LEAD: usize = 28;
const META: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

/// Properties that state the times of a waveform.
const CLOCK: [&str; 3] = ["wf_start_time", "wf_start_offset", "wf_increment"];

/// Storage of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    /// A time: fractions of 2^-64 s and seconds since 1904; as a number, seconds since 1970.
    Time,
    /// Text, of varying length.
    Text,
}

impl Kind {
    fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            1 => Self::I8,
            2 => Self::I16,
            3 => Self::I32,
            4 => Self::I64,
            5 | 0x21 => Self::U8,
            6 => Self::U16,
            7 => Self::U32,
            8 => Self::U64,
            9 | 0x19 => Self::F32,
            10 | 0x1a => Self::F64,
            0x20 => Self::Text,
            0x44 => Self::Time,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
            Self::Time => 16,
            Self::Text => 0,
        }
    }

    fn is_number(self) -> bool {
        self != Self::Text
    }

    fn value(self, b: &[u8], big: bool) -> f64 {
        if self == Self::Time {
            return Stamp::from_bytes(b, big).map_or(f64::NAN, Stamp::since_1970);
        }
        let mut w = [0_u8; 8];
        for (i, slot) in w.iter_mut().enumerate().take(self.size()) {
            let at = if big { self.size() - 1 - i } else { i };
            *slot = b.get(at).copied().unwrap_or(0);
        }
        let [a, b, c, d, ..] = w;
        match self {
            Self::I8 => f64::from(a.cast_signed()),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::I64 => i64::from_le_bytes(w) as f64,
            Self::U64 => u64::from_le_bytes(w) as f64,
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(w),
            Self::Time | Self::Text => f64::NAN,
        }
    }
}

/// Value of a property.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Text(String),
    Time(Stamp),
}

/// Samples that lie together.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Number of the first sample.
    first: usize,
    count: usize,
    /// Byte of the first, and from one to the next.
    at: usize,
    stride: usize,
    big: bool,
}

/// A property of the clock that a later segment states otherwise.
#[derive(Clone, Debug)]
pub struct Restart {
    /// Number of samples before the segment.
    pub first: usize,
    /// Name of the property.
    pub key: String,
    /// Value of the property from this segment on.
    pub value: Value,
}

/// A channel of numbers.
#[derive(Clone, Debug)]
pub struct Channel {
    pub group: String,
    pub name: String,
    pub kind: Kind,
    pub samples: usize,
    pub properties: BTreeMap<String, Value>,
    pub restarts: Vec<Restart>,
    runs: Vec<Run>,
}

impl Channel {
    /// Writes the samples `from .. to`, as stored, to `slots`.
    pub fn decode<'a>(
        &self,
        file: &[u8],
        from: usize,
        to: usize,
        mut slots: impl Iterator<Item = &'a mut f64>,
    ) {
        let mut next = self.runs.partition_point(|r| r.first + r.count <= from);
        let mut i = from;
        while let Some(r) = self.runs.get(next).filter(|_| i < to) {
            let until = to.min(r.first + r.count);
            for s in i..until {
                let at = r.at + (s - r.first) * r.stride;
                let Some(slot) = slots.next() else { return };
                *slot = match file.get(at..at + self.kind.size()) {
                    Some(b) => self.kind.value(b, r.big),
                    None => f64::NAN,
                };
            }
            i = until;
            next += 1;
        }
    }
}

/// Reads numbers and text of the lists.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], SeriesError> {
        let end = self.at.checked_add(n);
        let part = end.and_then(|end| self.bytes.get(self.at..end));
        let part = part.ok_or_else(|| read_error("the file is cut off"))?;
        self.at += n;
        Ok(part)
    }

    fn u32(&mut self) -> Result<u32, SeriesError> {
        let b: [u8; 4] = self.take(4)?.try_into().map_err(read_error)?;
        Ok(if self.big {
            u32::from_be_bytes(b)
        } else {
            u32::from_le_bytes(b)
        })
    }

    fn u64(&mut self) -> Result<u64, SeriesError> {
        let b: [u8; 8] = self.take(8)?.try_into().map_err(read_error)?;
        Ok(if self.big {
            u64::from_be_bytes(b)
        } else {
            u64::from_le_bytes(b)
        })
    }

    fn text(&mut self) -> Result<String, SeriesError> {
        let n = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(n)?).into_owned())
    }

    fn value(&mut self) -> Result<Value, SeriesError> {
        let code = self.u32()?;
        match Kind::from_code(code) {
            Some(Kind::Text) => self.text().map(Value::Text),
            Some(Kind::Time) => {
                let stamp = Stamp::from_bytes(self.take(Kind::Time.size())?, self.big);
                let stamp = stamp.ok_or_else(|| read_error("the file is cut off"))?;
                Ok(Value::Time(stamp))
            }
            Some(kind) => {
                let b = self.take(kind.size())?;
                Ok(Value::Number(kind.value(b, self.big)))
            }
            None => Err(read_error(format!(
                "a property has the unsupported type {code:#x}"
            ))),
        }
    }
}

/// Type and size of an object's samples in a segment.
#[derive(Clone, Copy)]
struct Index {
    kind: Kind,
    values: usize,
    bytes: usize,
}

#[derive(Default)]
struct Object {
    index: Option<Index>,
    properties: BTreeMap<String, Value>,
    restarts: Vec<Restart>,
    runs: Vec<Run>,
    samples: usize,
    kind: Option<Kind>,
}

/// Returns the channels in the order of the file, including text channels.
///
/// # Errors
/// Lists that can't be read, samples of a kind that is not read, a channel that changes its kind.
pub fn channels_of(bytes: &[u8]) -> Result<Vec<Channel>, SeriesError> {
    let mut objects: BTreeMap<String, Object> = BTreeMap::new();
    let mut order: Vec<String> = Vec::new();
    let mut active: Vec<String> = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        at = segment(bytes, at, &mut objects, &mut order, &mut active)?;
    }
    let mut out = Vec::new();
    for path in order {
        let Some(o) = objects.remove(&path) else {
            continue;
        };
        let parts = names_of(&path);
        // A channel without samples has no kind. The file and its groups are not channels.
        let Some(kind) = o.kind.or((parts.len() > 1).then_some(Kind::Text)) else {
            continue;
        };
        let mut parts = parts.into_iter().rev();
        let name = parts.next().unwrap_or_default();
        out.push(Channel {
            group: parts.next().unwrap_or_default(),
            name,
            kind,
            samples: o.samples,
            properties: o.properties,
            restarts: o.restarts,
            runs: o.runs,
        });
    }
    Ok(out)
}

/// Reads the segment at `at`; where the next one begins.
fn segment(
    bytes: &[u8],
    at: usize,
    objects: &mut BTreeMap<String, Object>,
    order: &mut Vec<String>,
    active: &mut Vec<String>,
) -> Result<usize, SeriesError> {
    let mut c = Cursor {
        bytes,
        at,
        big: false,
    };
    if c.take(4)? != b"TDSm" {
        return Err(read_error(format!("no segment begins at byte {at}")));
    }
    let flags = c.u32()?;
    // All further numbers have the byte order that the flags state.
    c.big = flags & BIG_ENDIAN != 0;
    c.u32()?;
    let (next, raw) = (c.u64()?, c.u64()?);
    let begin = at + LEAD;
    let end = if next == u64::MAX {
        return Err(read_error("its last segment was not finished"));
    } else {
        usize::try_from(next)
            .ok()
            .and_then(|n| begin.checked_add(n))
            .filter(|end| *end <= bytes.len())
            .ok_or_else(|| read_error("the file is cut off"))?
    };
    if flags & META != 0 {
        if flags & NEW_LIST != 0 {
            active.clear();
        }
        for _ in 0..c.u32()? {
            object(&mut c, objects, order, active)?;
        }
    }
    if flags & RAW == 0 {
        return Ok(end);
    }
    if flags & DAQMX != 0 {
        return Err(read_error("it contains DAQmx raw data"));
    }
    let data = usize::try_from(raw)
        .ok()
        .and_then(|n| begin.checked_add(n))
        .filter(|d| *d <= end)
        .ok_or_else(|| read_error("samples begin beyond their segment"))?;
    samples(objects, active, data, end, flags)?;
    Ok(end)
}

fn object(
    c: &mut Cursor,
    objects: &mut BTreeMap<String, Object>,
    order: &mut Vec<String>,
    active: &mut Vec<String>,
) -> Result<(), SeriesError> {
    let path = c.text()?;
    if !objects.contains_key(&path) {
        order.push(path.clone());
    }
    let object = objects.entry(path.clone()).or_default();
    match c.u32()? {
        u32::MAX => object.index = None,
        0 => {}
        0x1269 | 0x1369 => return Err(read_error("it contains DAQmx raw data")),
        _ => {
            let code = c.u32()?;
            let kind = Kind::from_code(code).ok_or_else(|| {
                read_error(format!("`{path}` has the unsupported type {code:#x}"))
            })?;
            c.u32()?;
            let values = usize::try_from(c.u64()?).map_err(read_error)?;
            let size = if kind == Kind::Text {
                usize::try_from(c.u64()?).map_err(read_error)?
            } else {
                values
                    .checked_mul(kind.size())
                    .ok_or_else(|| read_error("too many samples"))?
            };
            object.index = Some(Index {
                kind,
                values,
                bytes: size,
            });
        }
    }
    for _ in 0..c.u32()? {
        let key = c.text()?;
        let value = c.value()?;
        let is_later = object.samples > 0 && CLOCK.contains(&key.as_str());
        let before = object.restarts.iter().rev().find(|r| r.key == key);
        let before = before.map(|r| &r.value).or(object.properties.get(&key));
        if !is_later || before.is_none() {
            object.properties.insert(key, value);
        } else if before != Some(&value) {
            let first = object.samples;
            object.restarts.push(Restart { first, key, value });
        }
    }
    if !active.contains(&path) {
        active.push(path);
    }
    Ok(())
}

/// Notes where the samples of a segment lie: chunks of one round of all channels each.
fn samples(
    objects: &mut BTreeMap<String, Object>,
    active: &[String],
    data: usize,
    end: usize,
    flags: u32,
) -> Result<(), SeriesError> {
    let indices: Vec<(&String, Index)> = active
        .iter()
        .filter_map(|p| Some((p, objects.get(p)?.index?)))
        .filter(|(_, i)| i.values > 0)
        .collect();
    let chunk: usize = indices
        .iter()
        .try_fold(0_usize, |sum, i| sum.checked_add(i.1.bytes))
        .unwrap_or(0);
    if chunk == 0 {
        return Ok(());
    }
    if !(end - data).is_multiple_of(chunk) {
        return Err(read_error(
            "the file is cut off: samples are missing in its last segment",
        ));
    }
    let interleaved = flags & INTERLEAVED != 0;
    let row: usize = indices.iter().map(|i| i.1.kind.size()).sum();
    for number in 0..(end - data) / chunk {
        let mut at = data + number * chunk;
        for (path, index) in &indices {
            let Some(object) = objects.get_mut(*path) else {
                continue;
            };
            if object.kind.is_some_and(|k| k != index.kind) {
                return Err(read_error(format!("`{path}` changes its type")));
            }
            object.kind = Some(index.kind);
            if index.kind.is_number() {
                let stride = if interleaved { row } else { index.kind.size() };
                push(object, at, index.values, stride, flags & BIG_ENDIAN != 0);
            } else {
                object.samples += index.values;
            }
            at += if interleaved {
                index.kind.size()
            } else {
                index.bytes
            };
        }
    }
    Ok(())
}

/// Adds a run, to the last one where it continues it.
fn push(object: &mut Object, at: usize, count: usize, stride: usize, big: bool) {
    let first = object.samples;
    object.samples += count;
    if let Some(last) = object.runs.last_mut()
        && last.stride == stride
        && last.big == big
        && last.at + last.count * stride == at
    {
        last.count += count;
        return;
    }
    object.runs.push(Run {
        first,
        count,
        at,
        stride,
        big,
    });
}

/// The names in a path such as `/'group'/'channel'`; a quote within is doubled.
fn names_of(path: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut chars = path.chars().peekable();
    while let Some(c) = chars.next() {
        if c != '\'' {
            continue;
        }
        let mut name = String::new();
        while let Some(c) = chars.next() {
            if c == '\'' {
                if chars.peek() != Some(&'\'') {
                    break;
                }
                chars.next();
            }
            name.push(c);
        }
        out.push(name);
    }
    out
}
