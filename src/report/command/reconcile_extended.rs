//! Files of the extended model.

use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::job::Job;
use crate::reconcile::strain::StrainFrame;
use crate::report::csv_cell;
use crate::workflow::reconcile::extended_columns::{payload_factors, sensitivity_columns};
use crate::workflow::reconcile::extended_model::{
    DECK, ExtendedRuns, ExtendedS, PAYLOAD, RUNS, SENSITIVITY, STRAIN,
};
use crate::workflow::reconcile::{Reconciliation, extended_job};
use std::fmt::Write;

/// Writes the extended job and the files that it names, if the outcome has one.
pub(super) fn write_extended(found: &Reconciliation, out: &mut Output) -> Result<(), Faults> {
    let Some(extended) = &found.extended_model else {
        return Ok(());
    };
    let mut write = |name: &str, text: String| out.write_bytes(name, text.as_bytes());
    if let Some(strain) = &found.strain {
        let frame = &strain.frame;
        if let Some(readings) = &extended.readings {
            write(STRAIN, strain_csv(frame, readings))?;
        }
        if let Some(s) = &extended.sensitivity {
            write(SENSITIVITY, sensitivity_csv(&found.job, frame, s))?;
            if s.changed {
                write(PAYLOAD, payload_csv(&found.job, frame, &s.influence))?;
            }
        }
        if let Some(noted) = &extended.runs {
            write(RUNS, runs_csv(frame, noted))?;
        }
    }
    if let Some(bytes) = &extended.deck {
        out.write_bytes(DECK, bytes)?;
    }
    if let Some(text) = extended_job(found, out.folder())? {
        out.write_bytes(extended.name, text.as_bytes())?;
    }
    Ok(())
}

fn strain_csv(frame: &StrainFrame, values: &[f64]) -> String {
    let channels = frame.observations.channels.iter();
    let channels: Vec<_> = channels.map(|c| csv_cell(c)).collect();
    let mut out = format!("run,{}\n", channels.join(","));
    for (run, row) in frame
        .observations
        .runs
        .iter()
        .zip(values.chunks_exact(frame.n_gauges().max(1)))
    {
        let cells: Vec<String> = row
            .iter()
            .map(|v| {
                if v.is_finite() {
                    format!("{v:.4}")
                } else {
                    String::new()
                }
            })
            .collect();
        let _ = writeln!(out, "{},{}", csv_cell(run), cells.join(","));
    }
    out
}

fn sensitivity_csv(job: &Job, frame: &StrainFrame, s: &ExtendedS) -> String {
    let columns = sensitivity_columns(job, frame, s);
    let names: Vec<_> = columns.iter().map(|c| csv_cell(&c.column)).collect();
    let mut out = format!("gauge,{}\n", names.join(","));
    for (g, gauge) in frame.gauges.iter().enumerate() {
        let row = columns.iter().filter_map(|c| c.values.get(g));
        let cells: Vec<String> = row.map(|v| format!("{v:.9e}")).collect();
        let _ = writeln!(out, "{},{}", csv_cell(&gauge.name), cells.join(","));
    }
    out
}

fn payload_csv(job: &Job, frame: &StrainFrame, influence: &[f64]) -> String {
    let factors = payload_factors(job);
    let mut out = String::from("gauge,b0,b_dx,b_dy,b_dxdy\n");
    for (gauge, row) in frame
        .gauges
        .iter()
        .zip(influence.chunks_exact(frame.n_columns()))
    {
        let columns = row.iter().skip(frame.n_loads()).zip(factors);
        let cells: Vec<String> = columns.map(|(v, f)| format!("{:.9e}", v / f)).collect();
        let _ = writeln!(out, "{},{}", csv_cell(&gauge.name), cells.join(","));
    }
    out
}

/// Returns the loads and payload of the runs, with the effects in the model, as text of a runs file.
fn runs_csv(frame: &StrainFrame, noted: &ExtendedRuns) -> String {
    let [at_x, at_y] = frame.payload_origin;
    let names: Vec<_> = frame.load_names.iter().map(|n| csv_cell(n)).collect();
    let mut out = format!("run,payload_mass,payload_x,payload_y,{}\n", names.join(","));
    let n_l = frame.n_loads();
    let runs = frame.observations.runs.iter().zip(&noted.payload);
    for (r, (run, [mass, x, y])) in runs.enumerate() {
        let row = noted.loads.iter().skip(r * n_l).take(n_l);
        let loads: Vec<String> = row.map(|f| format!("{f:.6}")).collect();
        let _ = writeln!(
            out,
            "{},{mass:.6},{:.6},{:.6},{}",
            csv_cell(run),
            at_x + x,
            at_y + y,
            loads.join(",")
        );
    }
    out
}
