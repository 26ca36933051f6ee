//! A punch file as an index of blocks over its text.

use super::entry::{content, each_entry, is_continuation};
use super::header::Header;
use super::{PunchError, decode};
use crate::results::{Block, Damage, Note, Quantity, Rows, SalvagedFile, ShellForm};

/// Columns of a line as solvers write it. A line of this length is complete even without a line end.
const FULL_LINE: usize = 80;

/// Index of the blocks of a punch file. Rows are decoded block by block from the borrowed bytes.
///
/// # Example
/// ```
/// use nastran::punch::Punch;
/// use nastran::results::Quantity;
///
/// # let head = ["$TITLE   = FRAME", "$SUBTITLE=", "$LABEL   = BRAKING", "$DISPLACEMENTS", "$REAL OUTPUT", "$SUBCASE ID =           3"];
/// # let rows = ["        12       G      1.500000E+00      0.000000E+00     -2.500000E-01",
/// #     "-CONT-                  0.000000E+00      1.000000E-03      0.000000E+00"];
/// # let text: String = head.iter().chain(&rows).enumerate().map(|(i, l)| format!("{l:<72}{:>8}\n", i + 1)).collect();
/// let punch = Punch::read(text.as_bytes())?;
/// let block = &punch.blocks[0];
/// assert_eq!((block.quantity, block.subcase), (Quantity::Displacement, 3));
/// assert_eq!(block.titles, ["FRAME", "", "BRAKING"]);
/// let rows = punch.rows(0)?;
/// assert_eq!(rows.ids[0].entity, 12);
/// assert_eq!(rows.row(0), [1.5, 0.0, -0.25, 0.0, 0.001, 0.0]);
/// // A file that ends within an entry is refused.
/// assert!(Punch::read(&text.as_bytes()[..7 * 81]).is_err());
/// # Ok::<(), nastran::punch::PunchError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Punch<'a> {
    bytes: &'a [u8],
    /// Blocks in file order.
    pub blocks: Vec<Block>,
    /// Notes on skipped content.
    pub notes: Vec<Note>,
    spans: Vec<Span>,
}

/// Place of the entries of a block.
#[derive(Clone, Copy, Debug)]
struct Span {
    start: usize,
    end: usize,
    line: u32,
}

impl<'a> Punch<'a> {
    /// Builds the index of a whole punch file.
    ///
    /// # Errors
    /// [`PunchError::Damaged`] for a text that ends within an entry, and every error of [`Punch::salvage`].
    pub fn read(bytes: &'a [u8]) -> Result<Self, PunchError> {
        Self::salvage(bytes)?
            .require_undamaged()
            .map_err(PunchError::Damaged)
    }

    /// Builds the index of the readable part of a punch file that may be cut, with the damage.
    ///
    /// # Errors
    /// [`PunchError::NoBlocks`] if no header states a result.
    pub fn salvage(bytes: &'a [u8]) -> Result<SalvagedFile<Self>, PunchError> {
        let mut this = Self {
            bytes,
            blocks: Vec::new(),
            notes: Vec::new(),
            spans: Vec::new(),
        };
        let mut header = Header::default();
        let mut open = false;
        let (mut position, mut number) = (0_usize, 0_u32);
        while position < bytes.len() {
            let rest = bytes.get(position..).unwrap_or(&[]);
            let length = memchr::memchr(b'\n', rest).map_or(rest.len(), |n| n + 1);
            let line = rest.get(..length).unwrap_or(rest);
            let line = content(line.strip_suffix(b"\n").unwrap_or(line));
            number = number.saturating_add(1);
            let next = position.saturating_add(length);
            if line.starts_with(b"$") {
                open = false;
                header.take(&String::from_utf8_lossy(line));
            } else if !line.iter().all(u8::is_ascii_whitespace) {
                if !open {
                    open = true;
                    this.blocks.push(block(&header));
                    this.spans.push(Span {
                        start: position,
                        end: position,
                        line: number,
                    });
                }
                if let (Some(b), Some(s)) = (this.blocks.last_mut(), this.spans.last_mut()) {
                    s.end = next;
                    b.entries += usize::from(!is_continuation(line));
                }
            }
            position = next;
        }
        // Text before the first header that names a result is not a result block.
        let known = this
            .blocks
            .iter()
            .map(|b| !b.table.is_empty())
            .collect::<Vec<_>>();
        let mut keep = known.iter();
        this.blocks.retain(|_| *keep.next().unwrap_or(&false));
        let mut keep = known.iter();
        this.spans.retain(|_| *keep.next().unwrap_or(&false));
        if this.blocks.is_empty() {
            return Err(PunchError::NoBlocks);
        }
        this.finish();
        let damage = this.cut_at_the_end(open, number).into_iter().collect();
        Ok(SalvagedFile { file: this, damage })
    }

    /// Returns the damage if the text ends in a header, within a line, or within an entry of the last block. A cut between two complete entries
    /// cannot be detected.
    fn cut_at_the_end(&self, in_entries: bool, line: u32) -> Option<Damage> {
        let damage = |what: String| {
            Some(Damage {
                at: format!("line {line}"),
                what,
            })
        };
        let last = self.bytes.rsplit(|&b| b == b'\n').next().unwrap_or(&[]);
        if !last.is_empty() && last.len() < FULL_LINE {
            return damage("the text ends within a line".to_owned());
        }
        if !in_entries {
            return damage("the text ends in a header, without entries".to_owned());
        }
        let (block, span) = (self.blocks.last()?, self.spans.last()?);
        if decode::refusal(block).is_some() {
            return None;
        }
        let text = self.bytes.get(span.start..span.end)?;
        let mut rows = Rows {
            columns: decode::columns(block).unwrap_or(&[]),
            ..Rows::default()
        };
        let (from, from_line) = last_entry(text, span.line);
        let read = each_entry(text.get(from..)?, from_line, |entry| {
            decode::push(block, entry, &mut rows)
        });
        read.err().and_then(|e| damage(e.to_string()))
    }

    /// Sets the forms of shell blocks, which the header does not state, and adds notes on blocks that are not decoded.
    fn finish(&mut self) {
        for i in 0..self.blocks.len() {
            let (Some(block), Some(span)) =
                (self.blocks.get(i).cloned(), self.spans.get(i).copied())
            else {
                continue;
            };
            if let Some(why) = decode::refusal(&block) {
                let message = format!(
                    "line {}: {} entries left undecoded: {why}",
                    span.line, block.entries
                );
                self.notes.push(Note {
                    subject: decode::name(&block),
                    message,
                });
                continue;
            }
            if matches!(block.quantity, Quantity::Strain | Quantity::Stress)
                && decode::is_shell(&block)
            {
                let form = self.shell_form(&block, span);
                if let Some(b) = self.blocks.get_mut(i) {
                    b.form = Some(form);
                }
            }
        }
    }

    /// Returns the form of a shell block. Curvature form shows by its fibre column, 0 and -1; stress is always at fibres.
    fn shell_form(&self, block: &Block, span: Span) -> ShellForm {
        let mut curvature = false;
        let text = self.bytes.get(span.start..span.end).unwrap_or(&[]);
        let mut seen = false;
        let _ = each_entry(text, span.line, |entry| {
            if seen {
                // This error only ends the loop after the first entry; it is not reported.
                return Err(PunchError::NoBlocks);
            }
            seen = true;
            let mut rows = Rows {
                columns: decode::columns(block).unwrap_or(&[]),
                ..Rows::default()
            };
            decode::push(block, entry, &mut rows)?;
            curvature = block.quantity == Quantity::Strain
                && rows.row(0).first() == Some(&0.0)
                && rows.row(1).first() == Some(&-1.0);
            Ok(())
        });
        if curvature {
            ShellForm::Curvature
        } else {
            ShellForm::Fiber
        }
    }

    /// Returns the rows of block `index`.
    ///
    /// # Errors
    /// [`PunchError`]: no such block, a block that is not decoded, or damaged text with its line.
    pub fn rows(&self, index: usize) -> Result<Rows, PunchError> {
        let (Some(block), Some(span)) = (self.blocks.get(index), self.spans.get(index)) else {
            return Err(PunchError::NoSuchBlock {
                index,
                blocks: self.blocks.len(),
            });
        };
        if let Some(why) = decode::refusal(block) {
            return Err(PunchError::NotDecoded {
                block: decode::name(block),
                why,
            });
        }
        let mut rows = Rows {
            columns: decode::columns(block).unwrap_or(&[]),
            ..Rows::default()
        };
        let text = self.bytes.get(span.start..span.end).unwrap_or(&[]);
        each_entry(text, span.line, |entry| {
            decode::push(block, entry, &mut rows)
        })?;
        Ok(rows)
    }
}

/// Returns the offset and the line of the last entry of a text of entries.
fn last_entry(text: &[u8], first_line: u32) -> (usize, u32) {
    let (mut at, mut number) = (0_usize, first_line);
    let mut found = (at, number);
    for l in text.split_inclusive(|&b| b == b'\n') {
        if !l.iter().all(u8::is_ascii_whitespace) && !is_continuation(l) {
            found = (at, number);
        }
        at = at.saturating_add(l.len());
        number = number.saturating_add(1);
    }
    found
}

fn block(h: &Header) -> Block {
    Block {
        table: h.table.clone(),
        quantity: h.quantity(),
        analysis: h.analysis(),
        subcase: h.subcase,
        mode: h.mode,
        step: h.step,
        element: h.element,
        form: None,
        von_mises: !h.element_words.contains("MAX"),
        complex: h.complex,
        sort2: h.sort2,
        num_wide: 0,
        entries: 0,
        titles: h.titles.clone(),
    }
}
