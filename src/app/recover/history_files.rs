//! `loads.csv` and `loads.bin` of a record: formed in parallel, written in order by a thread of their own.

use super::record::{GROUP, Piece, Record, process};
use super::trace::Spans;
use crate::app::context::Progress;
use crate::app::fault::Fault;
use crate::app::output::Output;
use crate::app::strain::LoadUnits;
use crate::recovery::history::Filter;
use crate::recovery::{Gain, Sums};
use crate::series::number::push_seven_digits;
use rayon::prelude::*;
use std::io::Write;

/// What goes into the files: rows of `loads.csv`, numbers of `loads.bin`.
struct Text {
    rows: Vec<u8>,
    numbers: Vec<u8>,
}

/// How loads are written.
pub(super) struct Form<'a> {
    pub filter: &'a Filter,
    pub units: &'a [LoadUnits],
    /// Every how many samples a row.
    pub stride: usize,
    /// Whether `loads.bin` is written.
    pub numbers: bool,
}

impl Form<'_> {
    /// Rows and numbers of a piece whose first sample is the `first` of the record.
    fn text(&self, piece: &Piece, first: usize) -> Text {
        let mut text = Text {
            rows: Vec::new(),
            numbers: Vec::new(),
        };
        let loads = piece
            .loads
            .values
            .chunks_exact(self.filter.n_loads().max(1));
        if self.numbers {
            text.numbers.reserve(piece.loads.values.len() * 4);
            for f in loads.clone() {
                for (v, u) in f.iter().zip(self.units) {
                    let number = (v * u.factor) as f32;
                    text.numbers.extend_from_slice(&number.to_le_bytes());
                }
            }
        }
        let skipped = (self.stride - first % self.stride) % self.stride;
        let mut gaps = piece.loads.gaps.iter().peekable();
        for (i, (t, f)) in piece
            .times
            .iter()
            .zip(loads)
            .enumerate()
            .skip(skipped)
            .step_by(self.stride)
        {
            while gaps.next_if(|g| g.0 < i).is_some() {}
            let gap = gaps.next_if(|g| g.0 == i).and_then(|g| g.1.as_deref());
            self.row(*t, f, gap, &mut text.rows);
        }
        text
    }

    /// A row of `loads.csv`; `gap`: the estimate of a sample in which some gauge gave nothing.
    fn row(&self, t: f64, f: &[f64], gap: Option<&Gain>, out: &mut Vec<u8>) {
        out.extend_from_slice(t.to_string().as_bytes());
        let sigma = match gap {
            Some(gain) => self.filter.sigma_with(gain, f),
            None => self.filter.sigma(f),
        };
        for ((v, s), u) in f.iter().zip(sigma).zip(self.units) {
            let half = self.filter.coverage_factor() * s;
            for shown in [*v, v - half, v + half] {
                out.push(b',');
                if v.is_finite() && s.is_finite() {
                    push_seven_digits(out, shown * u.factor);
                }
            }
        }
        out.push(b'\n');
    }
}

/// A file of the output folder and its name.
pub(super) struct Named {
    pub name: &'static str,
    pub file: std::io::BufWriter<std::fs::File>,
}

pub(super) type WriteError = (&'static str, std::io::Error);

impl Named {
    pub fn put(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        self.file.write_all(bytes).map_err(|e| (self.name, e))
    }
}

/// Recovers the record piece by piece, in parallel, while another thread writes; the sums over it.
///
/// # Errors
/// The first unreadable piece, a file that can't be written.
pub(super) fn stream(
    record: &Record,
    form: &Form,
    csv: &mut Named,
    mut bin: Option<&mut Named>,
    out: &Output,
    progress: &dyn Progress,
    spans: &mut Spans,
) -> Result<Sums, Fault> {
    progress.parts(record.n_pieces());
    let mut sums = Sums::new(form.filter.n_gauges(), form.filter.n_loads());
    let (sender, texts) = std::sync::mpsc::sync_channel::<Vec<Text>>(1);
    let (read, written) = std::thread::scope(|scope| {
        let writer = scope.spawn(move || -> Result<(), WriteError> {
            for text in texts.into_iter().flatten() {
                csv.put(&text.rows)?;
                if let Some(b) = &mut bin {
                    b.put(&text.numbers)?;
                }
            }
            Ok(())
        });
        let mut first = 0;
        let mut read = Ok(());
        for group in (0..record.n_pieces()).collect::<Vec<_>>().chunks(GROUP) {
            let done: Result<Vec<Piece>, Fault> = group
                .par_iter()
                .map(|&i| process(record, form.filter, i))
                .collect();
            let done = match done {
                Ok(d) => d,
                Err(f) => {
                    read = Err(f);
                    break;
                }
            };
            let mut starts = Vec::with_capacity(done.len());
            for piece in &done {
                sums.merge(&piece.sums);
                spans.add(piece);
                starts.push(first);
                first += piece.times.len();
            }
            progress.advance(done.len());
            let texts = done
                .par_iter()
                .zip(&starts)
                .map(|(p, s)| form.text(p, *s))
                .collect();
            if sender.send(texts).is_err() {
                break;
            }
        }
        drop(sender);
        (read, writer.join())
    });
    read?;
    match written {
        Ok(w) => w.map_err(|(name, e)| out.fault(name, &e))?,
        Err(panic) => std::panic::resume_unwind(panic),
    }
    Ok(sums)
}
