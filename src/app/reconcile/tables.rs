//! `gap.csv` and `loads_before_after.csv`.

use crate::app::Session;
use crate::app::fault::Faults;
use crate::reconcile::Outcome;
use crate::report::csv_cell;
use std::fmt::Write;
use std::path::Path;

pub(super) fn write(session: &mut Session, job: &Path, outcome: &Outcome) -> Result<(), Faults> {
    let mut gap = String::from(
        "gauge,before_microstrain,after_microstrain,floor_microstrain,reading_microstrain\n",
    );
    for c in &outcome.channels {
        let _ = writeln!(
            gap,
            "{},{:.4},{:.4},{:.4},{:.4}",
            csv_cell(&c.channel),
            c.before,
            c.after,
            c.floor,
            c.reading
        );
    }
    let mut loads = String::from("run,load,stated_kN,before_kN,after_kN,sigma_kN,moved\n");
    for l in &outcome.loads {
        let moved = if l.moved() { "yes" } else { "no" };
        let _ = writeln!(
            loads,
            "{},{},{:.4},{:.4},{:.4},{:.4},{moved}",
            csv_cell(&l.run),
            csv_cell(&l.load),
            l.stated,
            l.before,
            l.after,
            l.sigma
        );
    }
    let output = session.output_for(job)?;
    output
        .write_bytes("gap.csv", gap.as_bytes())
        .map_err(Faults::from)?;
    output
        .write_bytes("loads_before_after.csv", loads.as_bytes())
        .map_err(Faults::from)
}
