//! Faults of files of measured strain.

use crate::finding::list_few;
use crate::host::fault::Fault;
use crate::job::Job;
use crate::job::same_name::is_same_name;
use crate::series::SeriesError;

/// Returns the fault of a record in a place where runs are required.
pub(crate) fn no_runs(file: &str) -> Fault {
    Fault::new(
        file,
        "run",
        "the rows are samples of a record, which cannot be read as runs",
        "give the means of static runs, one row for each run, with its name in a column `run`; `recover` recovers the loads of a record",
    )
}

/// Returns the fault of a strain file without a column of a gauge. If only a table of S names the gauges, either file may be wrong.
pub(crate) fn no_gauge_column(
    job: &Job,
    file: &str,
    columns: &[String],
    gauges: &[String],
) -> Fault {
    let (wrong, remedy) = match &job.sensitivity {
        Some(s) if job.gauges.is_empty() => (
            format!("no column has the name of a gauge of `{}`", s.file.given),
            "use the same gauge names in both tables",
        ),
        _ => (
            "no column has the name of a gauge of the job".to_owned(),
            "name the columns after the gauges",
        ),
    };
    let alike = gauges.iter().filter_map(|g| {
        let column = columns.iter().find(|c| is_same_name(c, g))?;
        Some(format!("`{column}` and `{g}`"))
    });
    let alike: Vec<String> = alike.collect();
    if !alike.is_empty() {
        let wrong = format!(
            "{wrong}; columns and gauges differ by case or separators: {}",
            list_few(&alike)
        );
        return Fault::with_line(file, 1, "gauge", wrong, "use the same names in both tables");
    }
    let wrong = match columns.is_empty() {
        true => format!("{wrong}; the file has no column of numbers"),
        false => format!("{wrong}; its columns are {}", list_few(columns)),
    };
    Fault::with_line(file, 1, "gauge", wrong, remedy)
}

/// Returns the fault of a record that can't be read.
pub(crate) fn record_fault(file: &str, e: &SeriesError) -> Fault {
    let (wrong, remedy) = e.parts();
    match e {
        SeriesError::Line { line, what, remedy } => {
            Fault::with_line(file, *line as u32, "row", what, *remedy)
        }
        SeriesError::NotAscending { line, .. } | SeriesError::NoTime { line } => {
            Fault::with_line(file, *line as u32, "time", wrong, remedy)
        }
        SeriesError::Empty => Fault::with_line(
            file,
            1,
            "rows",
            "the file has a header and no rows",
            "write one row for each sample",
        ),
        SeriesError::NoRate => Fault::with_line(
            file,
            1,
            "time",
            "no column `time`",
            "add a column `time` in seconds",
        ),
        _ => Fault::new(file, "record", wrong, remedy),
    }
}
