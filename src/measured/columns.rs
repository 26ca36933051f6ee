//! Columns of a strain file and the gauges of S.

use crate::finding::{Finding, Severity, list_few};
use crate::host::work::Work;
use crate::job::{NamedFile, suggest};
use std::collections::{HashMap, HashSet};

/// Returns the position of each gauge's column and adds the findings on columns. `None` for a gauge without a column.
pub(crate) fn columns_of(
    work: &mut Work,
    named: &NamedFile,
    header: &[String],
    gauges: &[String],
) -> Vec<Option<usize>> {
    let columns = columns_of_gauges(header, gauges);
    let silent = gauges.iter().zip(&columns).filter(|(_, c)| c.is_none());
    let silent: Vec<&str> = silent.map(|(g, _)| g.as_str()).collect();
    let unknown = unknown_columns(header, gauges);
    work.findings
        .extend(gauges_without_strain(named, &silent, &unknown));
    let of_file = format!("`{}`: ", named.given);
    work.findings
        .extend(strain_without_gauge(&of_file, header, gauges));
    columns
}

/// Returns the position of each gauge's column. `None` for a gauge without a column.
pub(crate) fn columns_of_gauges(header: &[String], gauges: &[String]) -> Vec<Option<usize>> {
    let places: HashMap<&String, usize> =
        header.iter().rev().zip((0..header.len()).rev()).collect();
    gauges.iter().map(|g| places.get(g).copied()).collect()
}

/// Returns a warning on gauges without a column in a strain file. `unknown` contains the columns that belong to no gauge.
pub(crate) fn gauges_without_strain(
    named: &NamedFile,
    silent: &[&str],
    unknown: &[&str],
) -> Option<Finding> {
    let of_file = format!("`{}`: ", named.given);
    (!silent.is_empty()).then(|| gauge_without_column(&of_file, silent, unknown))
}

/// Returns the warning on gauges without a column. `of_file` precedes its message.
pub(crate) fn gauge_without_column(of_file: &str, silent: &[&str], unknown: &[&str]) -> Finding {
    Finding::new(
        Severity::Warning,
        "gauge-without-strain",
        list_few(silent),
        format!("{of_file}gauges without a column are left out"),
        suggest::column_remedy(silent, unknown),
    )
}

/// Returns the columns that belong to no gauge.
pub(crate) fn unknown_columns<'a>(header: &'a [String], gauges: &[String]) -> Vec<&'a str> {
    let known: HashSet<&String> = gauges.iter().collect();
    let unknown = header.iter().filter(|h| !known.contains(h));
    unknown.map(String::as_str).collect()
}

/// Returns a warning about strain columns that belong to no gauge. `of_file` is the start of the message.
pub(crate) fn strain_without_gauge(
    of_file: &str,
    header: &[String],
    gauges: &[String],
) -> Option<Finding> {
    let unknown = unknown_columns(header, gauges);
    (!unknown.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "strain-without-gauge",
            list_few(&unknown),
            format!("{of_file}columns that belong to no gauge are left out"),
            "add the gauges, or drop the columns",
        )
    })
}
