//! `loads.csv` and `loads.bin` of a record: formed in parallel, written in order by a thread of their own.

use super::columns::columns;
use crate::host::fault::Fault;
use crate::host::files::FileBytes;
use crate::host::output::{OpenFile, Output};
use crate::report::csv_cell;
use crate::series::binary::{self, Header};
use crate::series::number::push_seven_digits;
use crate::strain_chain::LoadUnits;
use crate::workflow::recover::{Block, RecordHead, Samples};
use rayon::prelude::*;
use std::io::{Seek, Write};
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

/// File name of the loads as text: every sample, or every n-th sample.
pub(super) const CSV: &str = "loads.csv";
/// File name of the loads as numbers: every sample.
pub(super) const BIN: &str = "loads.bin";

/// The two files during writing.
pub(super) struct LoadTables {
    head: Arc<RecordHead>,
    /// To the thread that writes.
    sender: Option<SyncSender<Vec<Text>>>,
    writer: Option<JoinHandle<Result<Tables, WriteError>>>,
}

/// Content for the files: rows of `loads.csv`, numbers of `loads.bin`.
struct Text {
    rows: Vec<u8>,
    numbers: Vec<u8>,
}

/// The open files.
struct Tables {
    csv: OpenFile,
    /// `loads.bin` with all samples; `None` if no output needs all of them.
    bin: Option<OpenFile>,
}

type WriteError = (&'static str, std::io::Error);

impl LoadTables {
    /// Begins the files.
    ///
    /// # Errors
    /// A file that can't be written.
    pub fn begin(out: &mut Output, head: &Arc<RecordHead>) -> Result<Self, Fault> {
        let mut tables = Tables {
            csv: out.open(CSV)?,
            bin: match has_numbers(head) {
                true => Some(out.open(BIN)?),
                false => None,
            },
        };
        let begun = tables.begin(head);
        begun.map_err(|(name, e)| out.fault(name, &e))?;
        let (sender, texts) = sync_channel::<Vec<Text>>(1);
        let writer = std::thread::Builder::new().spawn(move || {
            for text in texts.into_iter().flatten() {
                tables.write_rows(&text)?;
            }
            Ok(tables)
        });
        Ok(Self {
            head: Arc::clone(head),
            sender: Some(sender),
            writer: Some(writer.map_err(|e| out.fault(CSV, &e))?),
        })
    }

    /// Writes the next blocks.
    ///
    /// # Errors
    /// A file that can't be written.
    pub fn take(&mut self, out: &Output, blocks: &[Block]) -> Result<(), Fault> {
        let texts = blocks.par_iter().map(|b| text(&self.head, b)).collect();
        let sent = self.sender.as_ref().map(|s| s.send(texts));
        match sent {
            Some(Ok(())) => Ok(()),
            // The thread ended early: `join` returns its error.
            _ => self.join(out).map(|_| ()),
        }
    }

    /// Completes the files. The number of samples is now known, so the header of `loads.bin` is written again.
    ///
    /// # Errors
    /// A file that can't be written.
    pub fn end(mut self, out: &Output, samples: u64) -> Result<(), Fault> {
        let Some(mut tables) = self.join(out)? else {
            return Ok(());
        };
        let ended = tables.end(&self.head, samples);
        ended.map_err(|(name, e)| out.fault(name, &e))
    }

    /// Waits until all that was handed over is written.
    fn join(&mut self, out: &Output) -> Result<Option<Tables>, Fault> {
        self.sender = None;
        let Some(writer) = self.writer.take() else {
            return Ok(None);
        };
        match writer.join() {
            Ok(done) => done.map(Some).map_err(|(name, e)| out.fault(name, &e)),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

impl Drop for LoadTables {
    fn drop(&mut self) {
        self.sender = None;
        // The files are discarded, so that errors of writing them do not matter.
        if let Some(writer) = self.writer.take() {
            let _ = writer.join();
        }
    }
}

impl Tables {
    fn begin(&mut self, head: &RecordHead) -> Result<(), WriteError> {
        let names = columns("time", &head.names);
        let names: Vec<_> = names.iter().map(|n| csv_cell(n)).collect();
        writeln!(self.csv, "{}", names.join(",")).map_err(|e| (CSV, e))?;
        self.header(head, 0)
    }

    fn header(&mut self, head: &RecordHead, samples: u64) -> Result<(), WriteError> {
        let Some(bin) = &mut self.bin else {
            return Ok(());
        };
        let loads = head.names.iter().zip(&head.units);
        let names: Vec<String> = loads.map(with_unit).collect();
        binary::write_header(bin, &names, samples, head.first_s, head.step_s, 1.0)
            .map_err(|e| (BIN, e))
    }

    fn write_rows(&mut self, text: &Text) -> Result<(), WriteError> {
        self.csv.write_all(&text.rows).map_err(|e| (CSV, e))?;
        match &mut self.bin {
            Some(bin) => bin.write_all(&text.numbers).map_err(|e| (BIN, e)),
            None => Ok(()),
        }
    }

    fn end(&mut self, head: &RecordHead, samples: u64) -> Result<(), WriteError> {
        self.csv.flush().map_err(|e| (CSV, e))?;
        if let Some(bin) = &mut self.bin {
            bin.rewind().map_err(|e| (BIN, e))?;
        }
        self.header(head, samples)?;
        match &mut self.bin {
            Some(bin) => bin.flush().map_err(|e| (BIN, e)),
            None => Ok(()),
        }
    }
}

/// Returns whether all samples are written as numbers.
fn has_numbers(head: &RecordHead) -> bool {
    head.stride > 1 || head.is_read_again()
}

fn with_unit((name, unit): (&String, &LoadUnits)) -> String {
    if unit.name.is_empty() {
        name.clone()
    } else {
        format!("{name} [{}]", unit.name)
    }
}

/// Rows and numbers of a block.
fn text(head: &RecordHead, block: &Block) -> Text {
    let mut text = Text {
        rows: Vec::new(),
        numbers: Vec::new(),
    };
    if has_numbers(head) {
        let values = &block.loads.values;
        text.numbers.reserve(values.len() * 4);
        for f in values.chunks_exact(head.n_loads().max(1)) {
            for (v, u) in f.iter().zip(&head.units) {
                let number = (v * u.factor) as f32;
                text.numbers.extend_from_slice(&number.to_le_bytes());
            }
        }
    }
    let skipped = (head.stride - block.first % head.stride) % head.stride;
    let samples = block.samples(head.n_loads());
    for sample in samples.skip(skipped).step_by(head.stride) {
        text.rows
            .extend_from_slice(sample.time.to_string().as_bytes());
        for interval in head.intervals(&sample) {
            match interval {
                Some(ends) => ends.into_iter().for_each(|v| {
                    text.rows.push(b',');
                    push_seven_digits(&mut text.rows, v);
                }),
                None => text.rows.extend_from_slice(b",,,"),
            }
        }
        text.rows.push(b'\n');
    }
    text
}

/// `loads.bin` as written.
pub(super) struct LoadsFile {
    bytes: FileBytes,
    /// Header of `loads.bin`.
    pub header: Header,
}

impl LoadsFile {
    /// Reads back the complete `loads.bin` of an output folder.
    ///
    /// # Errors
    /// A file that can't be read.
    pub fn read_back(out: &Output) -> Result<Self, Fault> {
        let bytes = out.read_back(BIN)?;
        let header = binary::read_header(&bytes);
        let header = header.map_err(|e| {
            let remedy = "report this as an error of the program";
            Fault::new(BIN, "header", e.to_string(), remedy)
        })?;
        Ok(Self { bytes, header })
    }
}

impl Samples for LoadsFile {
    fn n_samples(&self) -> usize {
        self.header.samples
    }

    fn read(&self, from: usize, to: usize, columns: &[usize], out: &mut Vec<f64>) {
        let columns: Vec<Option<usize>> = columns.iter().copied().map(Some).collect();
        binary::read_samples(&self.header, &self.bytes, from, to, &columns, out);
    }
}
