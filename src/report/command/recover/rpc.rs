//! `loads.rsp`.

use super::tables::LoadsFile;
use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::series::rpc::write_rpc;
use crate::workflow::recover::{RecoveredRecord, Samples, rpc_targets};

/// Writes the history in RPC III, report units.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write(
    out: &mut Output,
    record: &RecoveredRecord,
    loads: &LoadsFile,
) -> Result<(), Faults> {
    let targets = rpc_targets(&record.head, &record.sums);
    let h = &loads.header;
    // A record of one sample has no step, but the format requires one.
    let dt = if h.dt > 0.0 { h.dt } else { 1.0 };
    let columns: Vec<usize> = (0..targets.len()).collect();
    out.write("loads.rsp", |w| {
        write_rpc(w, &targets, dt, h.samples, |from, to, out| {
            loads.read(from, to, &columns, out);
        })
        .map(|_| ())
    })?;
    Ok(())
}
