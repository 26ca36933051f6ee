//! Readings of a job by run and gauge, with those that are held out.

use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{HoldOut, Job, Measured, Reference};
use crate::measured::zero::{ZeroedTable, read_zeroed, some_left, subtract_and_test_zero};
use crate::reconcile::Observations;
use crate::recovery::Readings;
use crate::units::MICROSTRAIN;

/// Returns the readings of the strain file and of a held-out file, runs by name.
pub(super) fn observations(job: &Job, work: &mut Work) -> Result<Observations, Faults> {
    let Some(measured) = &job.measured else {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "measured",
            "no `[measured]`",
            "name the strain file",
        )));
    };
    if measured.reference != Reference::None {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            measured.line,
            "measured.reference",
            "runs are compared as changes from the state at which the gauges read zero",
            "write reference = \"none\", and the loads of [runs] as changes from that state",
        )));
    }
    let zeroed = read_zeroed(work, job, measured, &measured.strain)?;
    let runs = zeroed.runs()?.to_vec();
    let ZeroedTable {
        table,
        mut noise_factor,
    } = zeroed;
    let mut out = Observations {
        runs,
        channels: table.gauges.clone(),
        values: table.microstrain.clone(),
        held_out: Vec::new(),
    };
    out.held_out = match &measured.hold_out {
        HoldOut::Runs(names) => out.runs.iter().map(|r| names.contains(r)).collect(),
        _ => vec![false; out.runs.len()],
    };
    if let HoldOut::File(named) = &measured.hold_out {
        let zeroed = read_zeroed(work, job, measured, named)?;
        let names = zeroed.runs()?.to_vec();
        let ZeroedTable {
            table: kept,
            noise_factor: own,
        } = zeroed;
        noise_factor.extend(own);
        if kept.gauges != out.channels {
            return Err(Faults::from(Fault::new(
                &*kept.file,
                "header",
                "other gauges than the strain file",
                "give the same columns",
            )));
        }
        out.held_out.extend(vec![true; names.len()]);
        out.runs.extend(names);
        out.values.extend(&kept.microstrain);
    }
    if out.held_out.iter().all(|h| *h) || out.runs.len() < 2 {
        let wrong = "fewer than one run for the fit and one for the proof";
        return Err(Faults::from(Fault::new(
            &*table.file,
            "run",
            wrong,
            "measure more runs, or remove some from `hold_out`",
        )));
    }
    if !out.held_out.iter().any(|h| *h) {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-hold-out",
            &*table.file,
            "[measured] has no `hold_out`: the gap is cross-validated, each run is predicted from the other runs",
            "hold out a third of the runs with `hold_out`",
        ));
    }
    test_readings(work, measured, &table.file, &noise_factor, &mut out)?;
    Ok(out)
}

/// Tests, as `recover` does, whether readings can be strain in their stated unit. Impossible readings become missing readings.
///
/// # Errors
/// One fault if no reading is left.
fn test_readings(
    work: &mut Work,
    measured: &Measured,
    file: &str,
    noise_factor: &[f64],
    observations: &mut Observations,
) -> Result<(), Faults> {
    let width = observations.channels.len().max(1);
    let rows = observations.values.chunks(width).zip(noise_factor);
    let readings: Vec<Readings> = rows
        .zip(&observations.runs)
        .map(|((row, noise_factor), run)| Readings {
            run: run.clone(),
            strain: row.iter().map(|v| v * MICROSTRAIN).collect(),
            noise_factor: *noise_factor,
        })
        .collect();
    let kept = subtract_and_test_zero(work, measured, &observations.channels, &readings);
    some_left(file, &kept)?;
    let strain = kept.iter().flat_map(|r| &r.strain);
    for (v, kept) in observations.values.iter_mut().zip(strain) {
        if kept.is_nan() {
            *v = f64::NAN;
        }
    }
    Ok(())
}
