//! Which files are made of a history, and what each of them costs.

use super::damage::extremes;
use super::sink::RecordHead;
use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, Faults};
use crate::host::words::format_number;
use crate::job::{Job, LoadFile};
use crate::recovery::Sums;
use crate::series::rpc::Target;

/// Samples of a history up to which every file is written by default.
const MOST_SAMPLES: usize = 200_000;
/// Samples of a history up to which tables of Nastran are written by default; these contain a pair of numbers per sample as text.
const MOST_ROWS: usize = 20_000;

/// Returns the files that are written of a history with about this number of samples.
///
/// # Errors
/// A fault for each requested file that this build cannot write.
pub(super) fn select_load_files(job: &Job, samples: usize) -> Result<Vec<LoadFile>, Faults> {
    let Some(files) = &job.recover.files else {
        let list = LoadFile::ALL.iter().map(|f| f.1);
        let few = list.filter(|f| {
            let most = match f {
                LoadFile::Nastran => MOST_ROWS,
                LoadFile::Rpc | LoadFile::Rainflow | LoadFile::Parquet => MOST_SAMPLES,
            };
            samples <= most && f.is_built()
        });
        return Ok(few.collect());
    };
    if files.iter().any(|f| !f.is_built()) {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "recover.files",
            "this build of strainbridge does not write Parquet",
            "use a released binary, build with `--features parquet`, or delete `parquet`",
        )));
    }
    Ok(files.clone())
}

/// Returns the findings on the files made from a history.
pub(super) fn findings(job: &Job, head: &RecordHead, sums: &Sums) -> Vec<Finding> {
    let mut out = Vec::new();
    if head.files.contains(&LoadFile::Rpc) {
        out.push(quantisation_finding(head, sums));
    }
    out.extend(left_out(job, head, sums));
    if head.stride > 1 {
        out.push(Finding::new(
            Severity::Info,
            "history-thinned",
            "loads.csv",
            format!(
                "loads.csv has a row for every {} samples, as [recover] csv_every states; loads.bin has all of them (format: docs/reference/files.md)",
                head.stride
            ),
            "drop csv_every to get every sample in loads.csv",
        ));
    }
    out
}

/// Returns the channels of `loads.rsp`.
pub fn rpc_targets(head: &RecordHead, sums: &Sums) -> Vec<Target> {
    let loads = head.names.iter().zip(&head.units).enumerate();
    loads
        .map(|(l, (name, unit))| {
            let [min, max] = extremes(head, sums, l);
            Target {
                name: name.clone(),
                unit: unit.name.clone(),
                min,
                max,
            }
        })
        .collect()
}

/// Returns the finding on the error of 16-bit numbers.
fn quantisation_finding(head: &RecordHead, sums: &Sums) -> Finding {
    let steps: Vec<String> = rpc_targets(head, sums)
        .iter()
        .map(|t| format!("{} {} {}", t.name, format_number(t.scale()), t.unit))
        .collect();
    let samples = sums.missing.samples();
    let repeated: u64 = (0..head.n_loads())
        .map(|l| samples - sums.known_samples(l))
        .sum();
    let gaps = if repeated > 0 {
        format!("; {repeated} missing numbers repeat the number before")
    } else {
        String::new()
    };
    let start = if head.first_s == 0.0 {
        String::new()
    } else {
        format!(
            "; its time begins at 0, the record begins at {} s",
            head.first_s
        )
    };
    Finding::new(
        Severity::Info,
        "rpc-quantised",
        "loads.rsp",
        format!(
            "16-bit integers: values are rounded by up to half a step, {}{gaps}{start}",
            steps.join(", ").trim_end()
        ),
        "use `loads.csv` or `loads.bin` if this matters",
    )
}

/// Returns the finding on files that were not written because the record is long.
fn left_out(job: &Job, head: &RecordHead, sums: &Sums) -> Option<Finding> {
    let left: Vec<&str> = LoadFile::ALL
        .iter()
        .filter(|f| !head.files.contains(&f.1) && f.1.is_built())
        .map(|f| f.0)
        .collect();
    if job.recover.files.is_some() || left.is_empty() {
        return None;
    }
    Some(
        Finding::new(
            Severity::Info,
            "files-not-written",
            left.join(", "),
            "the record is long: these files are written only on request",
            "name them in [recover] files",
        )
        .with_numbers(sums.missing.samples() as f64, MOST_ROWS as f64),
    )
}
