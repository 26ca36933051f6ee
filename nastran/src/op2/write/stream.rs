//! Keys, records and tables as bytes.

use std::io::{self, Write};

/// Largest number of words in a physical record; longer records are split, always between entries.
const LARGEST_PIECE: usize = 65_536;

/// Output stream of a file that is being written.
#[derive(Debug)]
pub(super) struct Stream<W> {
    out: W,
    /// Number of the last record of the open table; the key contains the negative number.
    record: i32,
}

impl<W: Write> Stream<W> {
    pub(super) fn new(out: W) -> Self {
        Stream { out, record: 0 }
    }

    /// Writes the closing key 0, flushes the output and returns it.
    pub(super) fn finish(mut self) -> io::Result<W> {
        self.key(0)?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn physical(&mut self, bytes: &[u8]) -> io::Result<()> {
        let n = u32::try_from(bytes.len())
            .map_err(|_| io::Error::other("a record is too long"))?
            .to_le_bytes();
        self.out.write_all(&n)?;
        self.out.write_all(bytes)?;
        self.out.write_all(&n)
    }

    fn key(&mut self, key: i32) -> io::Result<()> {
        self.physical(&key.to_le_bytes())
    }

    /// Writes a key with the number of words, then the words.
    fn words(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.key(
            i32::try_from(bytes.len() / 4).map_err(|_| io::Error::other("a record is too long"))?,
        )?;
        self.physical(bytes)
    }

    /// Writes the header: date (month, day, year), tape label, version label.
    pub(super) fn header(&mut self, date: [u32; 3], version: &str) -> io::Result<()> {
        let [month, day, year] = date;
        self.words(&ints(&[month, day, year % 100]))?;
        self.words(b"NASTRAN FORT TAPE ID CODE - ")?;
        self.words(&name(version))?;
        self.key(-1)?;
        self.key(0)
    }

    /// Opens a table: name, trailer, sub-table name with the date.
    pub(super) fn open_table(
        &mut self,
        table: &str,
        subtable: &str,
        date: [u32; 3],
    ) -> io::Result<()> {
        self.words(&name(table))?;
        self.key(-1)?;
        self.words(&ints(&[101, 0, 0, 0, 0, 0, 0]))?;
        self.record = 1;
        self.open_record()?;
        let [month, day, year] = date;
        let mut head = name(subtable).to_vec();
        head.extend_from_slice(&ints(&[month, day, year % 100, 0, 1]));
        self.words(&head)
    }

    fn open_record(&mut self) -> io::Result<()> {
        self.record = self.record.saturating_add(1);
        self.key(self.record.saturating_neg())?;
        self.key(1)?;
        self.key(0)
    }

    /// Writes a record of entries of `wide` words.
    pub(super) fn record(&mut self, bytes: &[u8], wide: usize) -> io::Result<()> {
        self.open_record()?;
        let entry = wide.max(1).saturating_mul(4);
        let piece = (LARGEST_PIECE / wide.max(1)).max(1).saturating_mul(entry);
        bytes.chunks(piece).try_for_each(|piece| self.words(piece))
    }

    /// Closes the open table.
    pub(super) fn close_table(&mut self) -> io::Result<()> {
        self.open_record()?;
        self.key(0)
    }
}

/// Returns eight characters, padded with blanks.
fn name(text: &str) -> [u8; 8] {
    let mut name = [b' '; 8];
    name.iter_mut().zip(text.bytes()).for_each(|(n, c)| *n = c);
    name
}

fn ints(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}
