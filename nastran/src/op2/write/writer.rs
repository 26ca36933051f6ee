//! Writes blocks one after another.

use std::io::Write;

use super::error::WriteError;
use super::stream::Stream;
use super::{entries, head};
use crate::op2::rows::layout;
use crate::results::{Block, Quantity, Rows};

/// Version label of the header, which most readers take for an MSC file.
const LABEL: &str = "XXXXXXXX";

/// Writes an OP2 one block at a time; only the current block is in memory.
///
/// Consecutive blocks of one kind (displacements, stress, strain ..) share a table, so write all subcases of a kind together. Values become 32-bit
/// reals. The writer uses these fields of a [`Block`]: `quantity`, `analysis`, `subcase`, `element`, `form`, `von_mises`, `titles`. It sets `table`,
/// `num_wide` and `entries` itself. Element types include 33 CQUAD4 and 74 CTRIA3 with two rows for each element, 144 CQUAD4 with centre and corners,
/// 34 CBAR and 2 CBEAM.
#[derive(Debug)]
pub struct Op2Writer<W: Write> {
    stream: Stream<W>,
    date: [u32; 3],
    open: Option<&'static str>,
}

impl<W: Write> Op2Writer<W> {
    /// Begins a file; `date` is month, day, year.
    ///
    /// # Errors
    ///
    /// Every error of `out`.
    pub fn new(out: W, date: [u32; 3]) -> Result<Self, WriteError> {
        let mut stream = Stream::new(out);
        stream.header(date, LABEL)?;
        Ok(Op2Writer {
            stream,
            date,
            open: None,
        })
    }

    /// Adds a block, with rows in the order of [`Op2::rows`](crate::op2::Op2::rows). A shell has the first and second row of the centre, then of each
    /// corner. A beam has end A, the stations between, then end B.
    ///
    /// # Errors
    ///
    /// [`WriteError::Unsupported`] for grid point forces and element types without a layout. [`WriteError::Rows`] if an element lacks rows.
    /// [`WriteError::Id`], [`WriteError::Columns`], and every error of the output.
    pub fn write_block(&mut self, block: &Block, rows: &Rows) -> Result<(), WriteError> {
        self.write_encoded(&EncodedBlock::new(block, rows)?)
    }

    /// Adds a block that was encoded before, perhaps on another thread.
    ///
    /// # Errors
    ///
    /// Every error of the output.
    pub fn write_encoded(&mut self, block: &EncodedBlock) -> Result<(), WriteError> {
        if self.open != Some(block.table) {
            self.close_table()?;
            self.stream
                .open_table(block.table, block.subtable, self.date)?;
            self.open = Some(block.table);
        }
        self.stream.record(&block.ident, block.ident.len() / 4)?;
        self.stream.record(&block.entries, block.wide)?;
        Ok(())
    }

    /// Ends the file and returns the output.
    ///
    /// # Errors
    ///
    /// Every error of the output.
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.close_table()?;
        Ok(self.stream.finish()?)
    }

    fn close_table(&mut self) -> Result<(), WriteError> {
        if self.open.take().is_some() {
            self.stream.close_table()?;
        }
        Ok(())
    }
}

/// A block encoded as the words of the file.
#[derive(Clone, Debug)]
pub struct EncodedBlock {
    table: &'static str,
    subtable: &'static str,
    wide: usize,
    ident: Vec<u8>,
    entries: Vec<u8>,
}

impl EncodedBlock {
    /// Encodes a block with these rows; see [`Op2Writer::write_block`].
    ///
    /// # Errors
    ///
    /// Every error of [`Op2Writer::write_block`], except errors of the output.
    pub fn new(block: &Block, rows: &Rows) -> Result<Self, WriteError> {
        let unsupported = || WriteError::Unsupported {
            quantity: block.quantity,
            element: block.element,
        };
        let (table, subtable) = head::names(block.quantity).ok_or_else(unsupported)?;
        let layout = num_wide(block)
            .and_then(|wide| layout(block.quantity, block.element, wide))
            .ok_or_else(unsupported)?;
        Ok(Self {
            table,
            subtable,
            wide: layout.wide,
            ident: head::ident(block, layout.wide),
            entries: entries::entries(block, rows, layout)?,
        })
    }
}

/// Returns all blocks as the bytes of a file; `date` is month, day, year.
///
/// # Errors
///
/// Every error of [`Op2Writer::write_block`].
pub fn write_blocks<'b>(
    blocks: impl IntoIterator<Item = (&'b Block, &'b Rows)>,
    date: [u32; 3],
) -> Result<Vec<u8>, WriteError> {
    let mut writer = Op2Writer::new(Vec::new(), date)?;
    for (block, rows) in blocks {
        writer.write_block(block, rows)?;
    }
    writer.finish()
}

/// Returns the number of words in an entry.
fn num_wide(block: &Block) -> Option<u32> {
    use Quantity as Q;
    let element = block.element.map_or(0, |e| e.0);
    Some(match (block.quantity, element) {
        (Q::Stress | Q::Strain, 33 | 74 | 227 | 228) => 17,
        (Q::Stress | Q::Strain, 64 | 82 | 144) => 87,
        (Q::Stress | Q::Strain, 70 | 75) => 70,
        (Q::Stress | Q::Strain, 39) => 109,
        (Q::Stress | Q::Strain, 67) => 193,
        (Q::Stress | Q::Strain, 68) => 151,
        (Q::Stress | Q::Strain, 255) => 130,
        (Q::Stress | Q::Strain, 34) => 16,
        (Q::Stress | Q::Strain, 100) => 10,
        (Q::Stress | Q::Strain, 2) => 111,
        (Q::Stress | Q::Strain, 1 | 3 | 10) => 5,
        (Q::Stress | Q::Strain, 4) => 4,
        (Q::Stress | Q::Strain | Q::ElementForce, 11..=14) => 2,
        (Q::Stress | Q::Strain | Q::ElementForce, 102) => 7,
        (Q::Stress, 126) => 7,
        (Q::PlyStress | Q::PlyStrain, _) => 11,
        (Q::ElementForce, 33 | 74 | 227 | 228) => 9,
        (Q::ElementForce, 64 | 82 | 144) => 47,
        (Q::ElementForce, 70 | 75) => 38,
        (Q::ElementForce, 34) => 9,
        (Q::ElementForce, 100) => 8,
        (Q::ElementForce, 2) => 100,
        (Q::ElementForce, 1 | 3 | 10) => 3,
        (
            Q::Displacement
            | Q::Velocity
            | Q::Acceleration
            | Q::Eigenvector
            | Q::SpcForce
            | Q::MpcForce
            | Q::AppliedLoad,
            _,
        ) => 8,
        _ => return None,
    })
}
