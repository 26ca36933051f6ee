//! Strain that gauges read without load, of a calibration with an intercept.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::Job;
use crate::job::table::read_table;
use crate::units::MICROSTRAIN;

/// Returns the common zero of each gauge, strain. It is zero if the job states no common zero, and NaN for gauges that the table lacks.
///
/// # Errors
/// A table without its two columns, or fields that are not numbers.
pub(crate) fn common_zero(
    work: &mut Work,
    job: &Job,
    gauges: &[String],
) -> Result<Vec<f64>, Faults> {
    let named = job
        .sensitivity
        .as_ref()
        .and_then(|s| s.common_zero.as_ref());
    let Some(named) = named else {
        return Ok(vec![0.0; gauges.len()]);
    };
    let text = work
        .inputs
        .read_named_text(job, named)
        .map_err(Faults::from)?;
    let table = read_table(&named.given, &text)?;
    let column = |name: &str| {
        table.column(&[name]).ok_or_else(|| {
            Fault::with_line(
                &*table.file,
                1,
                name,
                format!("no column `{name}`"),
                "give the columns `gauge` and `common_zero`, microstrain, as `calibrate` writes them",
            )
        })
    };
    let (key, value) = (column("gauge")?, column("common_zero")?);
    let mut faults = FaultList::new();
    let mut out = vec![f64::NAN; gauges.len()];
    for (row, (_, fields)) in table.rows.iter().enumerate() {
        let of_row = fields.get(key);
        let place = of_row.and_then(|name| gauges.iter().position(|g| g == name));
        match (table.number(row, value), place) {
            (Ok(read), Some(g)) => out[g] = read.map_or(f64::NAN, |v| v * MICROSTRAIN),
            (Ok(_), None) => {}
            (Err(fault), _) => faults.push(fault),
        }
    }
    Faults::check(faults)?;
    Ok(out)
}
