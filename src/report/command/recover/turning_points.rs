//! `turning_points.csv`: the samples in which a load turns, with all loads at these times.

use super::nastran::PIECE;
use super::tables::LoadsFile;
use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::report::csv_cell;
use crate::series::rainflow::{Point, TurningPointFinder};
use crate::workflow::recover::{RecoveredRecord, Samples, rpc_targets};

const NAME: &str = "turning_points.csv";

/// Writes the samples in which any load turns by at least `share` of its range, and the first and the last sample. All loads of a row are of one
/// time, so that their phase is kept.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write(
    out: &mut Output,
    record: &RecoveredRecord,
    loads: &LoadsFile,
    share: f64,
) -> Result<(), Faults> {
    let head = &record.head;
    let columns: Vec<usize> = (0..head.n_loads()).collect();
    let samples = loads.header.samples;
    let mut finders: Vec<TurningPointFinder> = rpc_targets(head, &record.sums)
        .iter()
        .map(|t| TurningPointFinder::new(share * (t.max - t.min)))
        .collect();
    let mut block = Vec::new();
    for from in (0..samples).step_by(PIECE) {
        block.clear();
        loads.read(from, samples.min(from + PIECE), &columns, &mut block);
        for (i, row) in block.chunks(columns.len().max(1)).enumerate() {
            for (finder, value) in finders.iter_mut().zip(row) {
                let value = *value;
                finder.push(Point {
                    at: from + i,
                    value,
                });
            }
        }
    }
    let mut kept: Vec<usize> = finders
        .into_iter()
        .flat_map(TurningPointFinder::finish)
        .collect();
    kept.extend(
        samples
            .checked_sub(1)
            .into_iter()
            .flat_map(|last| [0, last]),
    );
    kept.sort_unstable();
    kept.dedup();
    let units = head.units.iter().map(|u| u.name.as_str());
    let names = head.names.iter().map(String::as_str);
    out.declare(NAME, std::iter::once(("time", "s")).chain(names.zip(units)));
    let header = &loads.header;
    out.write(NAME, |w| {
        let names = head.names.iter().map(|n| format!(",{}", csv_cell(n)));
        writeln!(w, "time{}", names.collect::<String>())?;
        for at in kept {
            block.clear();
            loads.read(at, at + 1, &columns, &mut block);
            write!(w, "{}", header.t0 + at as f64 * header.dt)?;
            for value in &block {
                match value.is_finite() {
                    true => write!(w, ",{}", *value as f32)?,
                    false => write!(w, ",")?,
                }
            }
            writeln!(w)?;
        }
        Ok(())
    })?;
    Ok(())
}
