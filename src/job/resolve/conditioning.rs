//! `[conditioning]`.

use super::super::faults::Collector;
use super::super::raw_job::RawJob;
use super::super::raw_record::RawTemperature;
use super::super::spanned_value::SpannedValue;
use super::super::types::{ReadingConditioning, TemperatureCompensation};

/// Checks the section. Times must be in order, and the corner of the high-pass filter must be below the corner of the low-pass filter.
pub(super) fn resolve_conditioning(c: &mut Collector, job: &RawJob) -> Option<ReadingConditioning> {
    let section = job.conditioning.as_ref()?;
    let raw = section.value();
    if job.vehicle.is_some() {
        let wrong = "[conditioning] acts on records of strain, and the job has a [vehicle]";
        c.fault(
            section,
            "conditioning",
            wrong,
            "filter the accelerations before, or state `band_hz`",
        );
    }
    if let Some(file) = job.section.iter().find_map(|s| s.value().file.as_ref()) {
        let wrong = "[conditioning] acts on the strain file, and this section is another file";
        c.fault(
            file,
            "section.file",
            wrong,
            "state sections of the strain file by their times, or delete [conditioning]",
        );
    }
    if let (Some(at), Some(dynamic)) = (&raw.low_pass_hz, &job.dynamic)
        && let Some(up_to) = &dynamic.value().up_to_hz
        && *at.value() < 1.5 * *up_to.value()
    {
        let wrong = format!(
            "the filter attenuates loads below `up_to_hz` of [dynamic], {} Hz",
            up_to.value()
        );
        c.fault(
            at,
            "conditioning.low_pass_hz",
            wrong,
            "state at least 1.5 times `up_to_hz`",
        );
    }
    if let Some(at) = &raw.zero_s {
        let [from, to] = *at.value();
        if !(from < to && from.is_finite() && to.is_finite()) {
            let wrong = format!("`[{from}, {to}]`, expected two times in order");
            c.fault(at, "conditioning.zero_s", wrong, "write start and end, s");
        }
    }
    let low_pass_hz = c.positive_number(&raw.low_pass_hz, "conditioning.low_pass_hz");
    let high_pass_hz = c.positive_number(&raw.high_pass_hz, "conditioning.high_pass_hz");
    if let (Some(low), Some(high), Some(at)) = (low_pass_hz, high_pass_hz, &raw.high_pass_hz)
        && high >= low
    {
        let wrong = format!("`{high}` is not below `low_pass_hz`, {low}: no content remains");
        c.fault(
            at,
            "conditioning.high_pass_hz",
            wrong,
            "state a lower frequency",
        );
    }
    let drift = [("none", false), ("linear", true)];
    Some(ReadingConditioning {
        spikes: raw.spikes.as_ref().is_some_and(|s| *s.value()),
        temperature: raw.temperature.as_ref().and_then(|t| compensation(c, t)),
        zero_s: raw.zero_s.as_ref().map(|z| *z.value()),
        linear_drift: c.choose(&raw.drift, "conditioning.drift", &drift, false),
        low_pass_hz,
        high_pass_hz,
        line: c.line(section),
    })
}

fn compensation(
    c: &mut Collector,
    section: &SpannedValue<RawTemperature>,
) -> Option<TemperatureCompensation> {
    let raw = section.value();
    let key = "conditioning.temperature";
    let channel = c.require(
        &raw.channel,
        section,
        &format!("{key}.channel"),
        "channel = \"T1\"",
    );
    let factor = c.require(
        &raw.microstrain_per_deg_c,
        section,
        &format!("{key}.microstrain_per_degC"),
        "microstrain_per_degC = 1.4",
    );
    c.number(
        &raw.microstrain_per_deg_c,
        &format!("{key}.microstrain_per_degC"),
        "a number",
        |_| true,
    );
    Some(TemperatureCompensation {
        channel: channel?,
        microstrain_per_deg_c: factor?,
    })
}
