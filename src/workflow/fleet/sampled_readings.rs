//! Readings of some pieces of a record, before its loads are recovered.

use crate::host::fault::Fault;
use crate::measured::faults::record_fault;
use crate::series::SeriesError;
use crate::series::record::Record;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Number of pieces of a record that are sampled in advance.
const LOOKED_AT: usize = 10;

/// Readings of the first block of some pieces spread over the record, strain.
pub(super) fn sample_readings(
    record: &Record,
    found: &[(usize, usize, [f64; 2])],
) -> Result<Vec<f64>, Fault> {
    let columns: Vec<Option<usize>> = found.iter().map(|f| Some(f.1)).collect();
    let n = record.n_pieces();
    let taken = n.min(LOOKED_AT);
    let looked_at: Vec<Vec<f64>> = (0..taken)
        .into_par_iter()
        .map(|i| {
            let mut out = Vec::new();
            record.head(i * n / taken, &columns, &mut |block| {
                for row in block.values.chunks_exact(found.len().max(1)) {
                    out.extend(row.iter().zip(found).map(|(v, (_, _, [a, b]))| v * a + b));
                }
                ControlFlow::Break(())
            })?;
            Ok(out)
        })
        .collect::<Result<_, SeriesError>>()
        .map_err(|e| record_fault("record", &e))?;
    Ok(looked_at.concat())
}

/// The columns of `found` that are in `alive`, row by row.
pub(super) fn kept_columns(
    values: &[f64],
    found: &[(usize, usize, [f64; 2])],
    alive: &[(usize, usize, [f64; 2])],
) -> Vec<f64> {
    let keep: Vec<bool> = found
        .iter()
        .map(|f| alive.iter().any(|a| a.0 == f.0))
        .collect();
    let rows = values.chunks_exact(found.len().max(1));
    rows.flat_map(|row| row.iter().zip(&keep).filter(|k| *k.1).map(|k| *k.0))
        .collect()
}
