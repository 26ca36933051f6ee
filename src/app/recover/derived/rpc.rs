//! `loads.rsp`.

use super::History;
use crate::app::fault::Faults;
use crate::app::words::short;
use crate::app::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::series::rpc::{Target, write_rpc};

const NAME: &str = "loads.rsp";

/// Writes the history in RPC III, report units, and states what 16 bits cost.
pub(super) fn write(
    session: &mut Session,
    arguments: &JobArguments,
    history: &History,
) -> Result<(), Faults> {
    let targets: Vec<Target> = history
        .names
        .iter()
        .zip(history.units)
        .enumerate()
        .map(|(l, (name, unit))| {
            let [min, max] = history.extremes(l);
            Target {
                name: name.clone(),
                unit: unit.name.clone(),
                min,
                max,
            }
        })
        .collect();
    let h = &history.header;
    // A record of one sample has no step: the format wants one.
    let dt = if h.dt > 0.0 { h.dt } else { 1.0 };
    let columns = history.all();
    let mut repeated = 0;
    session
        .output_for(&arguments.job)?
        .write(NAME, |w| {
            repeated = write_rpc(w, &targets, dt, h.samples, |from, to, out| {
                history.samples(from, to, &columns, out);
            })?;
            Ok(())
        })
        .map_err(Faults::from)?;
    let steps: Vec<String> = targets
        .iter()
        .map(|t| format!("{} {} {}", t.name, short(t.scale()), t.unit))
        .collect();
    let gaps = if repeated > 0 {
        format!("; {repeated} numbers that were not measured repeat the one before")
    } else {
        String::new()
    };
    let start = if h.t0 == 0.0 {
        String::new()
    } else {
        format!("; its time begins at 0, that of the record at {} s", h.t0)
    };
    session.findings.push(Finding::new(
        Severity::Info,
        "rpc-quantised",
        NAME,
        format!(
            "16-bit integers: values are off by up to half of a step, which is {}{gaps}{start}",
            steps.join(", ").trim_end()
        ),
        "take `loads.csv` or `loads.bin` where that matters",
    ));
    Ok(())
}
