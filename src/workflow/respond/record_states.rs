//! Load states from a record of loads, one for each sample.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::FileBytes;
use crate::host::work::Work;
use crate::job::{Job, NamedFile, Runs};
use crate::measured::recorded_loads::{quantity_of, read_load_record};
use crate::respond::{LoadState, Spread};

/// Returns a state for each sample of a record that has all loads `names`, and the number of samples that lack one. A record has no intervals: its
/// loads count as exact.
///
/// # Errors
/// A file that can't be read, or lacks a load.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    named: &NamedFile,
    bytes: FileBytes,
    names: &[String],
) -> Result<(Vec<LoadState>, usize), Faults> {
    let file = Runs::in_report_units(named.clone(), "respond", job.report_units);
    let record = read_load_record(&mut work.inputs, job, (&file, None), bytes, names)?;
    work.findings.extend(record.findings.iter().cloned());
    let mut faults = FaultList::new();
    let mut columns = Vec::new();
    for name in names {
        match record.loads.iter().position(|l| l.name == *name) {
            Some(at) => {
                let si = quantity_of(job, name).map_or(1.0, |q| job.units.si(q));
                columns.push((at, si));
            }
            None => faults.push(Fault::new(
                &*named.given,
                name.clone(),
                format!("no column `{name}`"),
                "name the columns after the loads of the job",
            )),
        }
    }
    Faults::check(faults)?;
    let n = record.samples.first().map_or(0, Vec::len);
    let mut states = Vec::with_capacity(n);
    for i in 0..n {
        let value = |(at, si): &(usize, f64)| f64::from(record.samples[*at][i]) / si;
        let values: Vec<f64> = columns.iter().map(value).collect();
        if values.iter().all(|v| v.is_finite()) {
            states.push(LoadState {
                label: record.clock.time_s(i).to_string(),
                spread: Spread::Sigma(vec![0.0; values.len()]),
                values,
            });
        }
    }
    let left_out = n - states.len();
    Ok((states, left_out))
}
