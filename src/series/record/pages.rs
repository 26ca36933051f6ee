//! Pages of a Parquet column, checked before they are decoded. The Parquet library relies on properties of a page that a damaged file may lack.

use parquet::basic::{Encoding, Type as Kind};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::schema::types::ColumnDescriptor;

/// Pages of one column. Values that are split into streams of bytes are joined again.
pub(super) struct Pages<P> {
    inner: P,
    /// Bits of a definition level; 0 where none are stored.
    level_bits: usize,
    /// Bytes of a value.
    width: usize,
    /// Whether values are texts, each with its length before it.
    is_text: bool,
    /// Whether the dictionary has come.
    has_dictionary: bool,
}

fn damaged_page_error(what: &str) -> ParquetError {
    ParquetError::General(what.to_owned())
}

impl<P: PageReader> Pages<P> {
    /// Returns the pages of a column that is not repeated.
    pub fn new(inner: P, column: &ColumnDescriptor) -> Self {
        let levels = column.max_def_level().max(0).cast_unsigned();
        Self {
            inner,
            level_bits: (u16::BITS - levels.leading_zeros()) as usize,
            width: match column.physical_type() {
                Kind::INT64 | Kind::DOUBLE => 8,
                // Reals of 16 bits have two bytes.
                Kind::FIXED_LEN_BYTE_ARRAY => 2,
                _ => 4,
            },
            is_text: column.physical_type() == Kind::BYTE_ARRAY,
            has_dictionary: false,
        }
    }

    /// Returns the start of the values of a page that does not state the length of its levels.
    fn after_levels(&self, buf: &[u8], values: u32, encoding: Encoding) -> Result<usize> {
        if self.level_bits == 0 {
            return Ok(0);
        }
        let end = if encoding == Encoding::RLE {
            let size = buf.first_chunk().map(|b| u32::from_le_bytes(*b) as usize);
            size.and_then(|n| n.checked_add(4))
        } else {
            (values as usize)
                .checked_mul(self.level_bits)
                .map(|bits| bits.div_ceil(8))
        };
        end.filter(|end| *end <= buf.len())
            .ok_or_else(|| damaged_page_error("a page ends within its levels"))
    }

    /// Refuses texts that do not end within their page.
    fn check_texts(&self, mut bytes: &[u8]) -> Result<()> {
        while let Some((length, rest)) = bytes.split_first_chunk().filter(|_| self.is_text) {
            let length = u32::from_le_bytes(*length) as usize;
            bytes = rest
                .get(length..)
                .ok_or_else(|| damaged_page_error("a text ends beyond its page"))?;
        }
        match self.is_text && !bytes.is_empty() {
            true => Err(damaged_page_error("a page ends within a text")),
            false => Ok(()),
        }
    }

    /// The page, or why it can't be decoded.
    fn check_page(&mut self, page: Page) -> Result<Page> {
        let (values_at, encoding) = match &page {
            Page::DictionaryPage { buf, .. } => {
                self.check_texts(buf)?;
                self.has_dictionary = true;
                return Ok(page);
            }
            Page::DataPage {
                buf,
                num_values,
                encoding,
                def_level_encoding,
                ..
            } => (
                self.after_levels(buf, *num_values, *def_level_encoding)?,
                *encoding,
            ),
            Page::DataPageV2 {
                buf,
                encoding,
                def_levels_byte_len,
                rep_levels_byte_len,
                ..
            } => {
                let levels = def_levels_byte_len.checked_add(*rep_levels_byte_len);
                let at = levels
                    .map(|n| n as usize)
                    .filter(|n| *n <= buf.len())
                    .ok_or_else(|| damaged_page_error("a page ends within its levels"))?;
                (at, *encoding)
            }
        };
        if let (Page::DataPage { buf, .. } | Page::DataPageV2 { buf, .. }, Encoding::PLAIN) =
            (&page, encoding)
        {
            self.check_texts(buf.get(values_at..).unwrap_or_default())?;
        }
        match encoding {
            Encoding::RLE_DICTIONARY | Encoding::PLAIN_DICTIONARY if !self.has_dictionary => Err(
                damaged_page_error("a page needs a dictionary, and the column has none"),
            ),
            Encoding::BYTE_STREAM_SPLIT => Ok(self.join_streams(page, values_at)),
            _ => Ok(page),
        }
    }

    /// Returns the page with its streams of bytes joined to values; missing bytes cause an error when the values are read.
    fn join_streams(&self, mut page: Page, values_at: usize) -> Page {
        let (Page::DataPage { buf, encoding, .. } | Page::DataPageV2 { buf, encoding, .. }) =
            &mut page
        else {
            return page;
        };
        let (levels, streams) = buf.split_at(values_at.min(buf.len()));
        let count = streams.len() / self.width;
        let mut plain = Vec::with_capacity(buf.len());
        plain.extend_from_slice(levels);
        let streams: Vec<&[u8]> = streams
            .chunks_exact(count.max(1))
            .take(self.width)
            .collect();
        for i in 0..count {
            plain.extend(streams.iter().filter_map(|s| s.get(i)));
        }
        *buf = plain.into();
        *encoding = Encoding::PLAIN;
        page
    }
}

impl<P: PageReader> Iterator for Pages<P> {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl<P: PageReader> PageReader for Pages<P> {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        match self.inner.get_next_page()? {
            Some(page) => self.check_page(page).map(Some),
            None => Ok(None),
        }
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.inner.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.inner.skip_next_page()
    }

    fn at_record_boundary(&mut self) -> Result<bool> {
        self.inner.at_record_boundary()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::record::{Options, open_record, read_channels};
    use parquet::data_type::{DoubleType, FloatType};
    use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use std::sync::Arc;

    /// Returns a file with evenly spaced samples of one channel, every seventh missing. Values are encoded as separate byte streams.
    fn split(n: i16) -> Vec<u8> {
        let properties = WriterProperties::builder()
            .set_dictionary_enabled(false)
            .set_encoding(Encoding::BYTE_STREAM_SPLIT);
        write_samples(n, properties)
    }

    /// Writes evenly spaced samples of one channel, every seventh missing, with these properties.
    fn write_samples(n: i16, properties: WriterPropertiesBuilder) -> Vec<u8> {
        let schema = "message m { required double time; optional float g; }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let properties = properties
            .set_data_page_row_count_limit(100)
            .set_write_batch_size(50)
            .build();
        let mut out = Vec::new();
        let mut file = SerializedFileWriter::new(&mut out, schema, Arc::new(properties)).unwrap();
        let mut group = file.next_row_group().unwrap();
        let times: Vec<f64> = (0..n).map(|i| f64::from(i) * 0.01).collect();
        let mut column = group.next_column().unwrap().unwrap();
        let written = column.typed::<DoubleType>().write_batch(&times, None, None);
        written.unwrap();
        column.close().unwrap();
        let levels: Vec<i16> = (0..n).map(|i| i16::from(i % 7 != 0)).collect();
        let values = (0..n).filter(|i| i % 7 != 0);
        let values: Vec<f32> = values.map(|i| f32::from(i) + 0.5).collect();
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<FloatType>();
        typed.write_batch(&values, Some(&levels), None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        file.close().unwrap();
        out
    }

    #[test]
    fn values_in_streams_of_bytes_are_those_written() {
        let record = open_record(Arc::new(split(1000)), &Options::default()).unwrap();
        let read = read_channels(&record).unwrap();
        for (i, v) in read.list[0].samples.iter().enumerate() {
            let right = if i % 7 == 0 { f64::NAN } else { i as f64 + 0.5 };
            assert!(*v == right || v.is_nan() && right.is_nan(), "{i}: {v}");
        }
    }

    #[test]
    fn a_damaged_byte_anywhere_is_an_answer_or_an_error() {
        // The second file has dictionaries, whose indices may be negative in a damaged file.
        for whole in [split(60), write_samples(60, WriterProperties::builder())] {
            for at in 0..whole.len() {
                for flip in [0x01, 0x10, 0xff] {
                    let mut bytes = whole.clone();
                    bytes[at] ^= flip;
                    if let Ok(record) = open_record(Arc::new(bytes), &Options::default()) {
                        let _ = read_channels(&record);
                    }
                }
            }
        }
    }
}
