//! What a payload that `[runs]` states strains the gauges of a job whose S is given: `[sensitivity] signatures.payload`.

use super::task::Task;
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::runs::{RunRow, read_runs};
use crate::app::job::table::read_table;
use crate::app::job::{GivenSensitivity, Job};
use crate::app::work::Work;
use crate::finding::{Finding, Severity};
use crate::recovery::Readings;
use crate::units::MICROSTRAIN;

/// Columns of the signature: microstrain per mass, per mass and length along x, along y, and along both.
const COLUMNS: [&str; 4] = ["b0", "b_dx", "b_dy", "b_dxdy"];

/// Takes the strain of the known payload from the readings of every run; what is left is that of the loads.
///
/// `strain = m (b0 + dx b_dx + dy b_dy + dx dy b_dxdy)`, `dx`, `dy` from the nominal place of `[payload]`.
///
/// # Errors
/// Unreadable tables, gauges without a row in the signature.
pub(super) fn take_out(
    work: &mut Work,
    task: &Task,
    readings: &mut [Readings],
) -> Result<(), Faults> {
    let job = task.job;
    let (Some(given), Some(runs)) = (&job.sensitivity, &job.runs) else {
        return Ok(());
    };
    let weighs = job.payload.as_ref().is_none_or(|p| p.weight_in_model);
    if given.signatures.payload.is_none() || !weighs {
        return Ok(());
    }
    let rows = read_runs(&mut work.inputs, job, runs)?;
    let signature = signature(work, task, given)?;
    let mut unknown: Vec<&str> = Vec::new();
    let mut known = 0;
    for run in readings.iter_mut() {
        let row = rows.iter().find(|r| r.run == run.run);
        let Some((kg, dx, dy)) = row.and_then(|r| payload_of(job, r)) else {
            unknown.push(&run.run);
            continue;
        };
        known += 1;
        for (v, b) in run.strain.iter_mut().zip(&signature) {
            *v -= kg * (b[0] + dx * b[1] + dy * b[2] + dx * dy * b[3]);
        }
    }
    if known == 0 {
        return Ok(());
    }
    work.findings.push(Finding::new(
        Severity::Info,
        "payload-known",
        "runs",
        "the strain of the payload that the runs file states is taken from the readings: the loads are those beside it",
        "",
    ));
    if !unknown.is_empty() {
        work.findings.push(Finding::new(
            Severity::Warning,
            "payload-unknown",
            unknown.join(", "),
            "the runs file states no payload for these runs: it is taken for none",
            "state its mass (0 where there is none) and its place",
        ));
    }
    Ok(())
}

/// Mass, kg, and distance from the nominal place, m.
fn payload_of(job: &Job, row: &RunRow) -> Option<(f64, f64, f64)> {
    let length = job.units.length_m();
    let payload = job.payload.as_ref();
    let kg = row
        .payload_mass_kg
        .or(row.payload_force_n.map(|n| n / job.gravity_m_s2()))?;
    let from = |at: Option<f64>, nominal: Option<f64>| {
        at.map_or(0.0, |x| x - nominal.unwrap_or(0.0) * length)
    };
    Some((
        kg,
        from(row.payload_x_m, payload.and_then(|p| p.nominal_x)),
        from(row.payload_y_m, payload.and_then(|p| p.nominal_y)),
    ))
}

/// By gauge of S: strain per kg, per kg m along x, y, and per kg m^2.
fn signature(
    work: &mut Work,
    task: &Task,
    given: &GivenSensitivity,
) -> Result<Vec<[f64; 4]>, Faults> {
    let Some(file) = &given.signatures.payload else {
        return Ok(Vec::new());
    };
    let text = work
        .inputs
        .read_named_text(task.job, file)
        .map_err(Faults::from)?;
    let table = read_table(&file.given, &text)?;
    let key = table.column(&["gauge", "name"]).unwrap_or(0);
    let (kg, m) = (given.per.mass.si, given.per.length.si);
    let scale = [1.0, 1.0 / m, 1.0 / m, 1.0 / (m * m)].map(|per_m| MICROSTRAIN * per_m / kg);
    let mut faults = FaultList::new();
    let mut out = Vec::new();
    for gauge in &task.prepared.sensitivity.gauges {
        let mut b = [0.0; 4];
        match table.rows.iter().position(|r| r.1.get(key) == Some(gauge)) {
            None => faults.push(Fault::of(
                &*file.given,
                "gauge",
                format!("no row for gauge `{gauge}`"),
                "give every gauge a row",
            )),
            Some(row) => {
                for ((b, column), scale) in b.iter_mut().zip(COLUMNS).zip(scale) {
                    let Some(c) = table.column(&[column]) else {
                        continue;
                    };
                    match table.number(row, c) {
                        Ok(v) => *b = v.unwrap_or(0.0) * scale,
                        Err(f) => faults.push(f),
                    }
                }
            }
        }
        out.push(b);
    }
    Faults::check(faults)?;
    Ok(out)
}
