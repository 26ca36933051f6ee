//! Readings of a job by run and gauge, with those that are held out.

use crate::app::fault::{Fault, Faults};
use crate::app::job::strain::{StrainRows, StrainTable};
use crate::app::job::{HoldOut, Job, Reference};
use crate::app::work::Work;
use crate::app::zeroed::read_zeroed;
use crate::finding::{Finding, Severity};
use crate::reconcile::Observations;

/// Readings of the strain file and of a held-out file, runs by name.
pub(super) fn observations(job: &Job, work: &mut Work) -> Result<Observations, Faults> {
    let Some(measured) = &job.measured else {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "measured",
            "no `[measured]`",
            "name the strain file",
        )));
    };
    if measured.reference != Reference::None {
        return Err(Faults::from(Fault::at(
            &*job.file,
            measured.line,
            "measured.reference",
            "runs are compared as changes from the state at which the gauges read zero",
            "write reference = \"none\", and the loads of [runs] as changes from that state",
        )));
    }
    let table = read_zeroed(work, job, measured, &measured.strain)?.table;
    let runs_of = |t: &StrainTable| match &t.rows {
        StrainRows::Runs(runs) => Ok(runs.clone()),
        StrainRows::Times(_) => {
            let wrong = "rows are samples of one record";
            Err(Faults::from(Fault::of(
                &*t.file,
                "run",
                wrong,
                "give the means of static runs, a row each, with a column `run`",
            )))
        }
    };
    let mut out = Observations {
        runs: runs_of(&table)?,
        channels: table.gauges.clone(),
        values: table.microstrain.clone(),
        held_out: Vec::new(),
    };
    out.held_out = match &measured.hold_out {
        HoldOut::Runs(names) => out.runs.iter().map(|r| names.contains(r)).collect(),
        _ => vec![false; out.runs.len()],
    };
    if let HoldOut::File(named) = &measured.hold_out {
        let kept = read_zeroed(work, job, measured, named)?.table;
        if kept.gauges != out.channels {
            return Err(Faults::from(Fault::of(
                &*kept.file,
                "header",
                "other gauges than the strain file",
                "give the same columns",
            )));
        }
        let names = runs_of(&kept)?;
        out.held_out.extend(vec![true; names.len()]);
        out.runs.extend(names);
        out.values.extend(&kept.microstrain);
    }
    if out.held_out.iter().all(|h| *h) || out.runs.len() < 2 {
        let wrong = "fewer than one run to fit and one to prove";
        return Err(Faults::from(Fault::of(
            &*table.file,
            "run",
            wrong,
            "measure more runs, keep some from `hold_out`",
        )));
    }
    if !out.held_out.iter().any(|h| *h) {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-hold-out",
            &*table.file,
            "[measured] has no `hold_out`: the gap is cross-validated, every run in turn judged by what the others tell",
            "keep a third of the runs with `hold_out`",
        ));
    }
    Ok(out)
}
