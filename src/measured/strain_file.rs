//! A strain file as a table: a column a gauge, a row a run (`run`) or a sample (`time`).

use super::conditioning::refuse_runs;
use super::strain_table::{StrainRows, StrainTable};
use super::strain_text::strain_from_text;
use crate::host::fault::Faults;
use crate::host::files::Inputs;
use crate::job::correct::{check_channels, columns_wanted};
use crate::job::readings::{readings_of, stated_readings};
use crate::job::table::read_table;
use crate::job::{Job, JobGauge, NamedFile};
use std::collections::HashSet;

/// Reads a whole strain file from text and corrects its channels as `[[correction]]` states. `wanted` are its [`wanted_columns`].
///
/// # Errors
/// Every fault: no `run` or `time` column, fields that are no numbers, runs named twice, times that don't ascend.
pub fn read_strain(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
    wanted: &[String],
) -> Result<StrainTable, Faults> {
    let text = inputs.read_named_text(job, named)?;
    let mut table = strain_from_text(&named.given, &text, wanted)?;
    check_corrected(job, named, &table.gauges)?;
    let measured = job.measured.as_ref();
    let is_strain = measured.is_some_and(|m| m.strain.given == named.given);
    if is_strain && !matches!(table.rows, StrainRows::Times(_)) {
        refuse_runs(job, &named.given)?;
    }
    table.put_right(&job.corrections);
    table.leave_out(&job.reserved);
    Ok(table)
}

/// Refuses corrections of channels that the job's strain file lacks, if nothing else names the channels.
pub(crate) fn check_corrected(
    job: &Job,
    named: &NamedFile,
    columns: &[String],
) -> Result<(), Faults> {
    let measured = job.measured.as_ref();
    let is_own = measured.is_some_and(|m| m.strain.given == named.given);
    if job.sensitivity.is_some() || !is_own {
        return Ok(());
    }
    check_channels(job, columns, &format!("`{}`", named.given))
}

/// Returns the names of the columns with the readings of the job's gauges; empty if the job does not name its gauges. If a given S names the gauges,
/// this function reads the whole table. Call it once for each command.
pub fn wanted_columns(inputs: &mut Inputs, job: &Job) -> Vec<String> {
    let mut names = gauge_names(inputs, job);
    names.extend(job.reserved.iter().cloned());
    columns_wanted(&job.corrections, &names)
}

/// Returns the readings of the job's gauges without a column in a strain file. A rosette may have one column with its name instead of its legs.
pub fn without_column(inputs: &mut Inputs, job: &Job, columns: &[String]) -> Vec<String> {
    let known: HashSet<&String> = columns.iter().collect();
    let has = |name: &String| known.contains(name);
    if job.gauges.is_empty() {
        let mut names = gauge_names(inputs, job);
        names.retain(|n| !has(n));
        return names;
    }
    let of_gauge = |g: &JobGauge| {
        let mut legs = readings_of(g);
        legs.retain(|leg| !has(leg) && !has(&g.name));
        legs
    };
    job.gauges.iter().flat_map(of_gauge).collect()
}

/// Returns the names of the job's gauges: the stated gauges, with the legs of rosettes, or else the rows of a given S. The list is empty without
/// both. The caller that reads S reports a table of S that can't be read.
pub fn gauge_names(inputs: &mut Inputs, job: &Job) -> Vec<String> {
    let mut names: Vec<String> = job.gauges.iter().map(|g| g.name.clone()).collect();
    // A rosette has its own name as a channel too if S comes from a table.
    let own: HashSet<&str> = job.gauges.iter().map(|g| g.name.as_str()).collect();
    let legs = stated_readings(job).into_iter();
    names.extend(legs.filter(|r| !own.contains(r.as_str())));
    let given = job.sensitivity.as_ref().filter(|_| names.is_empty());
    let text = given.and_then(|s| inputs.read_named_text(job, &s.file).ok());
    if let Some((s, text)) = given.zip(text)
        && let Ok(table) = read_table(&s.file.given, &text)
        && let Some(key) = table.column(&["gauge", "name"])
    {
        names.extend(
            table
                .rows
                .into_iter()
                .filter_map(|(_, mut r)| (key < r.len()).then(|| r.swap_remove(key))),
        );
    }
    names
}
