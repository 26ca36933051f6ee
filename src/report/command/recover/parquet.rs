//! `loads.parquet`.

use super::tables::LoadsFile;
use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::report::command::mistake;
use crate::series::parquet::{UNIT_OF, parquet_bytes};
use crate::workflow::recover::{RecordHead, Samples};

const NAME: &str = "loads.parquet";

/// Writes the history in Parquet: `time` in s, then a column for each load in report units. The metadata contain unit and 95 % half width.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write(out: &mut Output, head: &RecordHead, loads: &LoadsFile) -> Result<(), Faults> {
    let sigma = head.filter.sigma(&vec![0.0; head.n_loads()]);
    let mut notes = Vec::new();
    for ((name, unit), sigma) in head.names.iter().zip(&head.units).zip(sigma) {
        let half = head.filter.coverage_factor() * sigma * unit.factor;
        notes.push((format!("{UNIT_OF}{name}"), unit.name.clone()));
        notes.push((format!("95 % half width of {name}"), half.to_string()));
    }
    let h = &loads.header;
    let columns: Vec<usize> = (0..head.n_loads()).collect();
    let read = |from, to, out: &mut Vec<f64>| loads.read(from, to, &columns, out);
    let bytes = parquet_bytes(&head.names, &notes, [h.t0, h.dt], h.samples, read);
    out.write_bytes(NAME, &bytes.map_err(|e| mistake(NAME, &e))?)?;
    Ok(())
}
