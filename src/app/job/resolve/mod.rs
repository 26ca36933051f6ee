//! Raw job to [`Job`]: required keys, words, defaults, contradictions.

mod calibration;
mod channel;
mod dynamic;
mod fleet;
mod gauge;
mod load;
mod measured;
mod placement;
mod units;
mod vehicle;

pub(super) use channel::check_names as check_named;
pub(super) use gauge::{bridge_from, check_gauge, point_from, rosette_from, surface_from};

use super::faults::Collector;
use super::raw::{RawCandidates, RawJob};
use super::spanned::Spanned;
use super::types::*;
use crate::app::fault::{Fault, FaultList};
use std::path::Path;

/// The job, complete but for the gauges of its gauge file; faults are added to the list.
pub(super) fn resolve_job(
    file: &str,
    text: &str,
    folder: &Path,
    raw: RawJob,
    faults: &mut FaultList,
) -> Job {
    let parsed = faults.is_empty();
    let mut c = Collector { file, text, faults };
    let units = units::system(&mut c, &raw.units, parsed);
    let report_units = units::units(
        &mut c,
        raw.report_units.as_ref(),
        crate::units::ReportUnits::of(units),
        "report_units",
    );
    let stem = Path::new(file)
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    // S is given, or learnt from runs of known load.
    let taught = raw.sensitivity.is_some() || raw.calibration.is_some() || raw.runs.is_some();
    let behind = if raw.model.is_none() && taught {
        load::Behind::Table
    } else {
        load::Behind::Model
    };
    let loads = load::loads(&mut c, &raw.load, behind);
    let criterion = placement::default_criterion(&loads);
    let model = load::model(&mut c, raw.model.as_ref());
    load::check_results(&mut c, model.as_ref(), &loads);
    let measured = measured::measured(&mut c, raw.measured.as_ref(), raw.fleet.as_ref());
    Job {
        read: Vec::new(),
        title: raw.title.map_or(stem, |t| t.into_inner()),
        units,
        report_units,
        model,
        calibration: calibration::calibration(&mut c, raw.calibration.as_ref()),
        combinations: channel::combinations(&mut c, &raw.combination),
        corrections: channel::corrections(&mut c, &raw.correction),
        gauges: gauge::gauges(&mut c, &raw.gauge),
        gauge_file: gauge::gauge_file(&mut c, raw.gauges.as_ref()),
        candidates: placement::candidates(&mut c, raw.candidates.as_ref()),
        placement: placement::placement(
            &mut c,
            raw.placement.as_ref(),
            measured.as_ref(),
            criterion,
        ),
        measured,
        runs: measured::runs(&mut c, raw.runs.as_ref(), report_units),
        ballast: measured::ballast(&mut c, raw.ballast.as_ref()),
        payload: measured::payload(&mut c, raw.payload.as_ref()),
        fleet: fleet::fleet(&mut c, raw.fleet.as_ref()),
        dynamic: dynamic::dynamic(&mut c, raw.dynamic.as_ref()),
        recover: measured::recover(&mut c, raw.recover.as_ref()),
        respond: measured::respond(&mut c, raw.respond.as_ref()),
        study: placement::study(&mut c, raw.study.as_ref()),
        vehicle: vehicle::vehicle(&mut c, raw.vehicle.as_ref()),
        reconcile: vehicle::reconcile(&mut c, raw.reconcile.as_ref()),
        sensitivity: vehicle::sensitivity(&mut c, raw.sensitivity.as_ref(), units),
        loads,
        file: file.to_owned(),
        folder: folder.to_owned(),
    }
}

/// The candidates of a file of their own.
pub(super) fn candidates_of(c: &mut Collector, raw: &Spanned<RawCandidates>) -> Candidates {
    placement::candidates(c, Some(raw))
}

/// Gauge names are unique.
pub(super) fn check_names(job: &Job, faults: &mut FaultList) {
    for (i, g) in job.gauges.iter().enumerate() {
        if let Some(first) = job.gauges.iter().take(i).find(|o| o.name == g.name) {
            let wrong = format!(
                "gauge `{}` stands twice, first at `{}:{}`",
                g.name, first.file, first.line
            );
            faults.push(Fault::at(
                &*g.file,
                g.line,
                "name",
                wrong,
                "give every gauge its own name",
            ));
        }
    }
}
