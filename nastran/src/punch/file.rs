//! A punch file as an index of blocks over its text.

use super::entry::{content, each_entry, is_continuation};
use super::header::Header;
use super::{PunchError, decode};
use crate::results::{Block, Note, Quantity, Rows, ShellForm};

/// A punch file: the index is made at once, rows are decoded block by block from the bytes it borrows.
#[derive(Clone, Debug)]
pub struct Punch<'a> {
    bytes: &'a [u8],
    /// Blocks in file order.
    pub blocks: Vec<Block>,
    /// What was passed over.
    pub notes: Vec<Note>,
    spans: Vec<Span>,
}

/// Where the entries of a block stand.
#[derive(Clone, Copy, Debug)]
struct Span {
    start: usize,
    end: usize,
    line: u32,
}

impl<'a> Punch<'a> {
    /// The index of a punch file.
    ///
    /// # Errors
    /// [`PunchError::NoBlocks`] where no header names a result.
    pub fn read(bytes: &'a [u8]) -> Result<Self, PunchError> {
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
        // Text before the first header that names a result is no block of ours.
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
        Ok(this)
    }

    /// Shell forms, which the header does not state, and notes on what is not decoded.
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

    /// Curvature form shows by its fibre column, 0 and -1; stress is always at fibres.
    fn shell_form(&self, block: &Block, span: Span) -> ShellForm {
        let mut curvature = false;
        let text = self.bytes.get(span.start..span.end).unwrap_or(&[]);
        let mut seen = false;
        let _ = each_entry(text, span.line, |entry| {
            if seen {
                // Any error ends the walk; this one is not shown.
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

    /// The rows of block `index`.
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

fn block(h: &Header) -> Block {
    Block {
        table: h.table.clone(),
        quantity: h.quantity(),
        analysis: h.analysis,
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
