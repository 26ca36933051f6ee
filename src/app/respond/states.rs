//! Load states: a table that `recover` wrote, or the job's static runs recovered here.

use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::table::read_table;
use crate::app::job::{Job, NamedFile};
use crate::app::recover::recovered_runs;
use crate::app::strain::{Prepared, load_units};
use crate::app::work::Work;
use crate::finding::{Finding, Severity};
use crate::recovery::NORMAL_95;
use crate::respond::{LoadState, Spread};

/// The states of the job.
///
/// # Errors
/// Neither loads nor measured strain; tables that can't be read.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    prepared: &Prepared,
) -> Result<Vec<LoadState>, Faults> {
    if let Some(named) = &job.respond.loads {
        return from_table(work, job, named);
    }
    let Some(measured) = job.measured.as_ref().filter(|_| !job.gauges.is_empty()) else {
        return Err(Faults::from(Fault::at(
            &*job.file,
            job.respond.line,
            "respond.loads",
            "the job names no loads and has no measured strain at gauges",
            "name the table that `recover` wrote: [respond] loads = \"job.out/loads.csv\"",
        )));
    };
    let (_, recovery) = recovered_runs(work, job, measured, prepared)?;
    Ok(recovery
        .runs
        .into_iter()
        .map(|r| {
            // The Birge factor and Student's t of the interval count as a wider sigma.
            let widen = (r.estimate.coverage_factor / NORMAL_95).powi(2);
            LoadState {
                label: r.estimate.run,
                values: r.estimate.values,
                spread: Spread::Covariance(
                    r.estimate.covariance.iter().map(|c| c * widen).collect(),
                ),
            }
        })
        .collect())
}

/// Columns `<load>`, and where there `<load>.low`, `<load>.high`, in report units, as `recover` writes them.
fn from_table(work: &mut Work, job: &Job, named: &NamedFile) -> Result<Vec<LoadState>, Faults> {
    let text = work
        .inputs
        .read_named_text(job, named)
        .map_err(Faults::from)?;
    let t = read_table(&named.given, &text)?;
    let names: Vec<String> = job.loads.iter().map(|l| l.name.clone()).collect();
    let units = load_units(job, &names);
    let mut faults = FaultList::new();
    let key = t.column(&["run", "time", "t", "state"]).unwrap_or(0);
    let mut columns = Vec::new();
    let mut without_interval = Vec::new();
    for name in &names {
        let of = |suffix: &str| {
            t.header
                .iter()
                .position(|h| *h == format!("{name}{suffix}"))
        };
        match of("") {
            Some(c) => {
                let interval = of(".low").zip(of(".high"));
                if interval.is_none() {
                    without_interval.push(name.clone());
                }
                columns.push((c, interval));
            }
            None => faults.push(Fault::at(
                &*t.file,
                1,
                name.clone(),
                format!("no column `{name}`"),
                "name the columns after the loads of the job",
            )),
        }
    }
    Faults::check(std::mem::take(&mut faults))?;
    let mut states = Vec::new();
    let mut blank = 0_usize;
    for (row, (_, fields)) in t.rows.iter().enumerate() {
        let mut number = |c: usize| {
            t.number(row, c).unwrap_or_else(|f| {
                faults.push(f);
                None
            })
        };
        let mut values = Vec::new();
        let mut sigma = Vec::new();
        for ((c, interval), u) in columns.iter().zip(&units) {
            values.push(number(*c).map_or(f64::NAN, |v| v / u.factor));
            sigma.push(match interval {
                Some((low, high)) => match (number(*low), number(*high)) {
                    (Some(l), Some(h)) => (h - l) / (2.0 * NORMAL_95) / u.factor,
                    _ => 0.0,
                },
                None => 0.0,
            });
        }
        if values.iter().any(|v| !v.is_finite()) {
            blank += 1;
            continue;
        }
        states.push(LoadState {
            label: fields.get(key).cloned().unwrap_or_default(),
            values,
            spread: Spread::Sigma(sigma),
        });
    }
    Faults::check(faults)?;
    if states.is_empty() {
        return Err(Faults::from(Fault::of(
            &*t.file,
            "loads",
            "no row with all loads",
            "give a row a run or a sample",
        )));
    }
    if blank > 0 {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "states-left-out",
                &named.given,
                format!("{blank} rows lack a load and are left out"),
                "fill them, or cut the record",
            )
            .with_numbers(blank as f64, 0.0),
        );
    }
    work.findings.push(Finding::new(
        Severity::Info,
        "load-errors-independent",
        &named.given,
        if without_interval.is_empty() {
            "a table of intervals holds no correlations between loads: their errors are taken as independent".to_owned()
        } else {
            format!("{} have no interval in the table and count as exact", without_interval.join(", "))
        },
        "let `respond` recover the runs itself ([measured], no [respond] loads) to keep correlations",
    ));
    Ok(states)
}
