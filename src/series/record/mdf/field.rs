//! One number of a record.

use crate::series::record::time_unit::single_rounding_s;
use falcon_mdf::blocks::{ChannelType, DataType};
use falcon_mdf::{Channel, ChannelGroup, Conversion};

/// Returns the channels that hold numbers and are not the group's clock.
pub(super) fn values(g: &ChannelGroup) -> impl Iterator<Item = &Channel> {
    let channels = g.channels.iter();
    channels.filter(|c| !c.is_master() && c.is_numeric() && !c.is_array())
}

/// Type of a number, from which its bits are decoded.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Unsigned,
    Signed,
    F32,
    F64,
    /// The number of the record.
    Index,
}

/// Position of a number in a record, and its conversion.
pub(super) struct Field {
    kind: Kind,
    big_endian: bool,
    at: usize,
    bytes: usize,
    shift: u32,
    bits: u32,
    conversion: Conversion,
    is_float: bool,
    /// Byte after the data, and mask of the invalidation bit.
    invalid: Option<(usize, u8)>,
    all_invalid: bool,
}

impl Field {
    /// Returns the field of a channel; `None` for a channel that is not a plain number of fixed length.
    pub(super) fn from_channel(c: &Channel) -> Option<Self> {
        let index = matches!(
            c.channel_type,
            ChannelType::VirtualMaster | ChannelType::VirtualData
        );
        if !index
            && !matches!(
                c.channel_type,
                ChannelType::FixedLength | ChannelType::Master
            )
        {
            return None;
        }
        let bits = c.bit_count;
        let (kind, big_endian) = match c.data_type {
            _ if index => (Kind::Index, false),
            DataType::UIntLe => (Kind::Unsigned, false),
            DataType::UIntBe => (Kind::Unsigned, true),
            DataType::IntLe => (Kind::Signed, false),
            DataType::IntBe => (Kind::Signed, true),
            DataType::FloatLe if bits == 32 => (Kind::F32, false),
            DataType::FloatBe if bits == 32 => (Kind::F32, true),
            DataType::FloatLe if bits == 64 => (Kind::F64, false),
            DataType::FloatBe if bits == 64 => (Kind::F64, true),
            _ => return None,
        };
        let shift = u32::from(c.bit_offset);
        let real = matches!(kind, Kind::F32 | Kind::F64);
        let fits = kind == Kind::Index || (bits > 0 && shift + bits <= 64);
        if !fits || (real && shift != 0) || c.is_array() || c.unreadable().is_some() {
            return None;
        }
        // A conversion that gives text for some values is not numeric.
        let numeric = matches!(
            c.conversion,
            Conversion::None
                | Conversion::Linear { .. }
                | Conversion::Rational { .. }
                | Conversion::Algebraic { .. }
                | Conversion::TableInterpolated { .. }
                | Conversion::TableLookup { .. }
                | Conversion::RangeTable { .. }
        );
        numeric.then(|| Self {
            kind,
            big_endian,
            at: c.byte_offset as usize,
            bytes: (shift + bits).div_ceil(8) as usize,
            shift,
            bits,
            conversion: c.conversion.clone(),
            is_float: c.is_float(),
            invalid: c.invalidation_bit.then(|| {
                let bit = c.inval_bit_pos;
                ((bit / 8) as usize, 1 << (bit % 8))
            }),
            all_invalid: c.all_invalid,
        })
    }

    /// Returns whether the field is within records of so many bytes.
    pub(super) fn fits(&self, data: usize, invalidation: usize) -> bool {
        let within = self.kind == Kind::Index || self.at + self.bytes <= data;
        within && self.invalid.is_none_or(|(byte, _)| byte < invalidation)
    }

    /// Returns the largest rounding error of a value. It is half a count, or the last bit of a 32-bit real at the end of a day.
    pub(super) fn rounding_error(&self) -> f64 {
        let one = self.conversion.convert(1.0, self.is_float)
            - self.conversion.convert(0.0, self.is_float);
        match self.kind {
            Kind::Index | Kind::F64 => 0.0,
            Kind::F32 => single_rounding_s(one),
            Kind::Unsigned | Kind::Signed => 0.5 * one.abs(),
        }
    }

    /// Decodes the value in each of several consecutive records. The first record has number `first`. Each record has `size` bytes, of which `data`
    /// are before the invalidation bytes.
    pub(super) fn decode(
        &self,
        records: &[u8],
        size: usize,
        data: usize,
        first: usize,
        out: &mut [f64],
    ) {
        let rows = records.chunks_exact(size.max(1));
        let plain = self.invalid.is_none() && !self.all_invalid && !self.big_endian;
        if plain && self.kind == Kind::F32 && matches!(self.conversion, Conversion::None) {
            for (slot, row) in out.iter_mut().zip(rows) {
                let bytes = row.get(self.at..).and_then(|r| r.first_chunk());
                *slot = bytes.map_or(f64::NAN, |b| f64::from(f32::from_le_bytes(*b)));
            }
            return;
        }
        for (i, (slot, row)) in out.iter_mut().zip(rows).enumerate() {
            let invalid = self
                .invalid
                .is_some_and(|(byte, mask)| row.get(data + byte).is_none_or(|b| b & mask != 0));
            *slot = if invalid || self.all_invalid {
                f64::NAN
            } else {
                self.value(row, first + i)
            };
        }
    }

    #[inline]
    fn value(&self, row: &[u8], index: usize) -> f64 {
        let raw = if self.kind == Kind::Index {
            index as f64
        } else {
            self.raw_value(row.get(self.at..self.at + self.bytes).unwrap_or_default())
        };
        match &self.conversion {
            Conversion::None => raw,
            Conversion::Linear { offset, factor } => factor * raw + offset,
            other => other.convert(raw, self.is_float),
        }
    }

    #[inline]
    fn raw_value(&self, b: &[u8]) -> f64 {
        match (self.kind, b) {
            (Kind::F32, &[a, b, c, d]) if self.big_endian => {
                f64::from(f32::from_be_bytes([a, b, c, d]))
            }
            (Kind::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (Kind::F64, &[a, b, c, d, e, f, g, h]) if self.big_endian => {
                f64::from_be_bytes([a, b, c, d, e, f, g, h])
            }
            (Kind::F64, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            (Kind::Unsigned | Kind::Signed, b) if !b.is_empty() && b.len() <= 8 => {
                let mut word = [0; 8];
                if self.big_endian {
                    for (slot, b) in word.iter_mut().zip(b.iter().rev()) {
                        *slot = *b;
                    }
                } else {
                    for (slot, b) in word.iter_mut().zip(b) {
                        *slot = *b;
                    }
                }
                let unused = 64 - self.bits;
                let left = (u64::from_le_bytes(word) >> self.shift) << unused;
                if self.kind == Kind::Signed {
                    (left.cast_signed() >> unused) as f64
                } else {
                    (left >> unused) as f64
                }
            }
            _ => f64::NAN,
        }
    }
}
