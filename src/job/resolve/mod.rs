//! Resolves a raw job to a [`Job`]: required keys, allowed values, defaults, contradictions.

mod calibration;
mod channel;
mod compare;
mod conditioning;
mod dynamic;
mod fleet;
mod gauge;
mod load;
mod measured;
mod placement;
mod section;
mod units;
mod vehicle;

pub(super) use channel::check_names as check_named;
pub(super) use gauge::{
    ELEMENT_STATED, POINT_ALONE, POINT_STATED, STATION_ALONE, bridge_from, check_gauge, point_from,
    role_from, rosette_from, surface_from, with_pair,
};
pub use gauge::{SAME_SIDE, SAME_SIDE_REMEDY};

use super::faults::Collector;
use super::raw_job::{RawCandidates, RawJob, RawPlacement};
use super::readings::readings_of;
use super::spanned_value::SpannedValue;
use super::types::*;
use crate::host::fault::{Fault, FaultList};
use std::collections::BTreeMap;
use std::path::Path;

/// Returns the job without the gauges of its gauge file. Faults are added to the list.
pub(super) fn resolve_job(
    file: &str,
    text: &str,
    folder: &Path,
    raw: RawJob,
    faults: &mut FaultList,
) -> Job {
    let parsed = faults.is_empty();
    let mut c = Collector::new(file, text, faults);
    let units = units::system(&mut c, &raw.units, parsed);
    let report_units = units::units(
        &mut c,
        raw.report_units.as_ref(),
        crate::units::ReportUnits::from_system(units),
        "report_units",
    );
    let stem = Path::new(file)
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    // S is given, or estimated from calibration runs.
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
    let measured = measured::resolve_measured(&mut c, raw.measured.as_ref(), raw.fleet.as_ref());
    one_source(&mut c, &raw);
    let conditioning = conditioning::resolve_conditioning(&mut c, &raw);
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
        reserved: Vec::new(),
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
        compare: compare::compare(&mut c, raw.compare.as_ref(), report_units),
        sections: section::sections(&mut c, &raw.section),
        ballast: measured::ballast(&mut c, raw.ballast.as_ref()),
        payload: measured::payload(&mut c, raw.payload.as_ref()),
        fleet: fleet::fleet(&mut c, raw.fleet.as_ref()),
        conditioning,
        dynamic: dynamic::resolve_dynamic(&mut c, raw.dynamic.as_ref()),
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

/// Refuses a job that states S twice: by `[model]`, and by a `[sensitivity]` without the covariance of a calibration. A calibrated S is used
/// together with its model, which has the strain of every other place.
fn one_source(c: &mut Collector, raw: &RawJob) {
    if let (Some(_), Some(given)) = (&raw.model, &raw.sensitivity)
        && given.value().covariance.is_none()
    {
        c.fault(
            given,
            "sensitivity",
            "the job has a [model] too: S would come from this table, and the model would not be used",
            "delete [sensitivity] to compute S from the model, or [model] to take S from the table; a calibrated S needs its `covariance`",
        );
    }
}

/// Returns the candidates of a separate file.
pub(super) fn candidates_of(c: &mut Collector, raw: &SpannedValue<RawCandidates>) -> Candidates {
    placement::candidates(c, Some(raw))
}

/// The placement of a file of picked lists.
pub(super) fn placement_of(c: &mut Collector, raw: &SpannedValue<RawPlacement>) -> Placement {
    placement::placement(c, Some(raw), None, Optimality::D)
}

/// Refuses two channels with one name, because a strain column would then belong to both. Names that differ only by case or spaces count as one name.
pub(super) fn check_names(job: &Job, faults: &mut FaultList) {
    check_names_of(job.gauges.iter(), faults);
    let spots = job.candidates.spots.iter().flatten();
    check_names_of(spots.map(|s| &s.gauge), faults);
}

fn check_names_of<'a>(gauges: impl Iterator<Item = &'a JobGauge>, faults: &mut FaultList) {
    let mut seen: BTreeMap<String, (&str, &JobGauge)> = BTreeMap::new();
    for g in gauges {
        let mut own = readings_of(g);
        // A table of S may have a row for a rosette as one channel.
        own.push(g.name.clone());
        own.dedup();
        let mut clash = None;
        for channel in own {
            let key: String = channel.split_whitespace().collect();
            let first = seen.entry(key.to_lowercase()).or_insert((&g.name, g));
            if !std::ptr::eq(first.1, g) {
                clash = clash.or(Some((channel, *first)));
            }
        }
        let Some((channel, (of, first))) = clash else {
            continue;
        };
        let at = format!("`{}:{}`", first.file, first.line);
        let (wrong, remedy) = match first.name == g.name {
            true => (
                format!("gauge `{}` is stated twice, first at {at}", g.name),
                "give every gauge a separate name",
            ),
            false => (
                format!(
                    "channel `{channel}` of gauge `{}` has the name of a channel of gauge `{of}` at {at}",
                    g.name
                ),
                "rename one of them. Names must differ by more than case and spaces, and a rosette `G` has the channels `G.a`, `G.b`, `G.c`",
            ),
        };
        faults.push(Fault::with_line(&*g.file, g.line, "name", wrong, remedy));
    }
}
