//! Stated place and recorded mass of a payload, compared with the readings.

use super::model::Parts;
use super::task::Task;
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::Faults;
use crate::host::words::format_number;
use crate::host::work::Work;
use crate::measured::runs_file::read_runs;
use crate::payload::{PayloadRun, Place, WeighSpec, WeighedRun, Weighing, weigh};

/// Number of standard deviations from which readings contradict a stated place, as for moments of wheel forces.
pub(super) const REFUTED: f64 = 4.0;
/// Relative difference between weighed and recorded mass above which one of them is wrong.
const OTHER_MASS: f64 = 0.1;

/// Returns the finding on a stated place that the strain contradicts. The runs are weighed again with a free place. The finding is an error if the
/// weight changes by more than its interval.
pub(super) fn place_contradicted(
    task: &Task,
    parts: &Parts,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    weighing: &Weighing,
) -> Option<Finding> {
    let has_strain = runs.iter().any(|r| r.strain.iter().any(|v| v.is_finite()));
    if spec.place != Place::Known || !has_strain {
        return None;
    }
    let free = WeighSpec {
        place: Place::Free,
        ..spec.clone()
    };
    let free = weigh(&parts.model, runs, &free);
    // Each run uses its own place, if the runs file states one.
    let of = |((run, known), free)| Some((sigmas(free, run)?, known, free));
    let stated = runs.iter().zip(&weighing.runs).zip(&free.runs);
    let refuted = stated.filter_map(of);
    let mut refuted: Vec<(f64, &WeighedRun, &WeighedRun)> =
        refuted.filter(|(s, ..)| *s > REFUTED).collect();
    refuted.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (worst, known, free) = *refuted.first()?;
    let moves = |(_, known, free): &(f64, &WeighedRun, &WeighedRun)| {
        free.force < known.interval[0] || free.force > known.interval[1]
    };
    let severity = match refuted.iter().any(moves) {
        true => Severity::Error,
        false => Severity::Warning,
    };
    let names: Vec<&str> = refuted.iter().map(|r| r.1.run.as_str()).collect();
    let (length, force) = (
        task.job.report_units.length.name,
        task.job.report_units.force.name,
    );
    let place = [0, 1].map(|k| format_number(task.nominal[k] + free.shift[k]));
    Some(
        Finding::new(
            severity,
            "payload-place-contradicted",
            list_few(&names),
            format!(
                "the readings contradict the stated place of the payload. With a free place, run {} weighs {} ± {} {force} at {}, {} \
                 {length}; at the stated place it weighs {} {force}",
                free.run,
                format_number(free.force),
                format_number(NORMAL_95 * free.sigma),
                place[0],
                place[1],
                format_number(known.force)
            ),
            "correct the place in the runs file, `nominal_x`, `nominal_y` or `grid`, or let the payload be anywhere: position = \"free\"",
        )
        .with_numbers(worst, REFUTED),
    )
}

/// Returns the distance between the found and the stated place in standard deviations. Returns `None` if no place was found.
fn sigmas(free: &WeighedRun, run: &PayloadRun) -> Option<f64> {
    let [a, b, _, d] = free.shift_covariance;
    let determinant = a * d - b * b;
    if free.refused.is_some() || !(determinant > 0.0) {
        return None;
    }
    let [x, y] = [0, 1].map(|k| free.shift[k] - run.shift[k]);
    let square = (d * x * x - 2.0 * b * x * y + a * y * y) / determinant;
    Some(square.sqrt()).filter(|s| s.is_finite())
}

/// Returns the finding on masses of the runs file that differ from the result by more than the interval and 10 %, in most runs.
///
/// # Errors
/// The faults of the runs file.
pub(super) fn mass_contradicted(
    work: &mut Work,
    task: &Task,
    weighing: &Weighing,
) -> Result<Option<Finding>, Faults> {
    let Some(file) = &task.job.runs else {
        return Ok(None);
    };
    let rows = read_runs(&mut work.inputs, task.job, file)?;
    let unit = &task.job.report_units.mass;
    let compared = weighing.runs.iter().filter_map(|r| {
        let row = rows.iter().find(|row| row.run == r.run)?;
        let recorded = row.payload_mass_kg? / unit.si;
        r.refused.is_none().then_some((r, recorded))
    });
    let compared: Vec<(&WeighedRun, f64)> = compared.collect();
    let mass = |force: f64| force / task.weight_of_mass;
    let differs = |(r, recorded): &&(&WeighedRun, f64)| {
        let outside = *recorded < mass(r.interval[0]) || *recorded > mass(r.interval[1]);
        outside && (mass(r.force) - recorded).abs() > OTHER_MASS * recorded.abs()
    };
    let off: Vec<&(&WeighedRun, f64)> = compared.iter().filter(differs).collect();
    let Some((run, recorded)) = off.first().filter(|_| 2 * off.len() > compared.len()) else {
        return Ok(None);
    };
    let names: Vec<&str> = off.iter().map(|r| r.0.run.as_str()).collect();
    let ratio = mass(run.force) / recorded;
    Ok(Some(
        Finding::new(
            Severity::Error,
            "recorded-mass-contradicts",
            list_few(&names),
            format!(
                "the payload masses of `{}` contradict the readings: run {} weighs {} to {} {}, and the recorded payload is {} {}",
                file.file.given,
                run.run,
                format_number(mass(run.interval[0])),
                format_number(mass(run.interval[1])),
                unit.name,
                format_number(*recorded),
                unit.name
            ),
            "check the recorded masses and their unit, scale and unit of the wheel forces or the gauges, and the run of the zero",
        )
        .with_numbers(ratio, 1.0),
    ))
}
