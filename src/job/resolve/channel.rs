//! `[[combination]]` and `[[correction]]`.

use super::super::faults::Collector;
use super::super::raw_job::{RawChannelCorrection, RawCombination};
use super::super::readings::stated_readings;
use super::super::spanned_value::SpannedValue;
use super::super::suggest;
use super::super::types::*;
use crate::host::fault::{Fault, FaultList};

/// Largest factor of a load in a sum. The smallest and the largest unit that a job may name differ by nine powers of ten.
const LARGEST_FACTOR: f64 = 1e12;

pub(super) fn combinations(
    c: &mut Collector,
    raw: &[SpannedValue<RawCombination>],
) -> Vec<Combination> {
    let mut out: Vec<Combination> = Vec::new();
    for section in raw {
        let terms: Vec<(String, f64)> = section
            .value()
            .terms
            .iter()
            .map(|(name, factor)| (name.value().clone(), *factor.value()))
            .collect();
        if terms.is_empty() {
            let remedy = "name loads and factors: terms = { \"LF.FZ\" = 1, \"RF.FZ\" = 1 }";
            c.fault(section, "combination.terms", "no terms", remedy);
        }
        if terms
            .iter()
            .any(|t| t.1.is_nan() || t.1.abs() > LARGEST_FACTOR)
        {
            let wrong = "a factor is no finite number, or beyond 1e12";
            c.fault(section, "combination.terms", wrong, "write a number");
        }
        let name = &section.value().name;
        let Some(name) = c.require(name, section, "combination.name", "name = \"total\"") else {
            continue;
        };
        if out.iter().any(|o| o.name == name) {
            let wrong = format!("combination `{name}` occurs twice");
            let remedy = "give every combination its own name";
            c.fault(section, "combination.name", wrong, remedy);
        }
        out.push(Combination {
            name,
            terms,
            line: c.line(section),
        });
    }
    out
}

pub(super) fn corrections(
    c: &mut Collector,
    raw: &[SpannedValue<RawChannelCorrection>],
) -> Vec<StrainCorrection> {
    raw.iter()
        .filter_map(|section| {
            let raw = section.value();
            let gauge = c.require(&raw.gauge, section, "correction.gauge", "gauge = \"P05\"");
            let sign = c.number(&raw.sign, "correction.sign", "1 or -1", |x| x.abs() == 1.0);
            let gain = c.number(&raw.gain, "correction.gain", "a number other than 0", |x| {
                x != 0.0
            });
            let other = raw.exchanged_with.as_ref().map(|s| s.value());
            if other.is_some() && other == gauge.as_ref() {
                let wrong = "a channel cannot be exchanged with itself";
                let remedy = "name the other channel, or delete `exchanged_with`";
                c.fault(section, "correction.exchanged_with", wrong, remedy);
            }
            let any = |_: f64| true;
            let offset = c.number(
                &raw.offset_microstrain,
                "correction.offset_microstrain",
                "a number",
                any,
            );
            Some(StrainCorrection {
                gauge: gauge?,
                sign: sign.unwrap_or(1.0),
                gain: gain.unwrap_or(1.0),
                offset_microstrain: offset.unwrap_or(0.0),
                exchanged_with: raw.exchanged_with.as_ref().map(|s| s.value().clone()),
                angle_deg: c.number(&raw.angle_deg, "correction.angle_deg", "a number", any),
                ignore: raw.ignore.as_ref().is_some_and(|v| *v.value()),
                of_rosette: false,
                line: c.line(section),
            })
        })
        .collect()
}

/// Checks that corrections name gauges of the job and combinations name loads of the job, if the job lists them.
pub fn check_names(job: &Job, faults: &mut FaultList) {
    // The legs of a rosette are channels too: `R1.a`.
    let mut channels: Vec<String> = job.gauges.iter().map(|g| g.name.clone()).collect();
    channels.extend(stated_readings(job));
    for correction in &job.corrections {
        let named = std::iter::once(&correction.gauge).chain(&correction.exchanged_with);
        for name in named.filter(|n| !channels.is_empty() && !channels.contains(n)) {
            faults.push(Fault::with_line(
                &*job.file,
                correction.line,
                "correction.gauge",
                format!("the job has no gauge `{name}`"),
                suggest::remedy(name, channels.iter().map(String::as_str)),
            ));
        }
        if correction.angle_deg.is_some() && job.model.is_none() {
            faults.push(Fault::with_line(
                &*job.file,
                correction.line,
                "correction.angle_deg",
                format!(
                    "gauge `{}` is turned on the model, and the job has no [model]",
                    correction.gauge
                ),
                "delete `angle_deg`, or turn the gauge where S is computed",
            ));
        }
    }
    if job.sensitivity.is_some() {
        return;
    }
    let loads: Vec<&str> = job.loads.iter().map(|l| l.name.as_str()).collect();
    for combination in &job.combinations {
        for (name, _) in combination.terms.iter().filter(|t| !loads.contains(&&*t.0)) {
            faults.push(Fault::with_line(
                &*job.file,
                combination.line,
                "combination.terms",
                format!("the job has no load `{name}`"),
                suggest::remedy(name, loads.iter().copied()),
            ));
        }
        if loads.contains(&&*combination.name) {
            faults.push(Fault::with_line(
                &*job.file,
                combination.line,
                "combination.name",
                format!("`{}` is the name of a load", combination.name),
                "give the combination another name",
            ));
        }
    }
}
