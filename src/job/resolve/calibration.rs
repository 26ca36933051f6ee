//! `[calibration]`.

use super::super::faults::Collector;
use super::super::raw_job::{RawCalibration, S};
use super::super::spanned_value::SpannedValue;
use super::super::types::{CalibrationKeys, Terms};

/// Relative error of a model's S if the job states none: models deviate by 1 to 10 %, at unknown places.
const DEFAULT_MODEL_UNCERTAINTY_REL: f64 = 0.1;

pub(super) fn calibration(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawCalibration>>,
) -> CalibrationKeys {
    let mut out = CalibrationKeys {
        runs: None,
        repeats: Vec::new(),
        depends_on: None,
        model_uncertainty_rel: DEFAULT_MODEL_UNCERTAINTY_REL,
        position_tolerance: 0.0,
        angle_tolerance_deg: 0.0,
        scale_sd: 0.0,
        terms: Terms::Linear,
        check: Vec::new(),
        line: 0,
    };
    let Some(section) = raw else { return out };
    let raw = section.value();
    let words = |list: &SpannedValue<Vec<SpannedValue<String>>>| -> Vec<String> {
        list.value().iter().map(|w| w.value().clone()).collect()
    };
    out.runs = raw.runs.as_ref().map(words);
    out.repeats = raw.repeats.as_ref().map(words).unwrap_or_default();
    out.depends_on = raw.depends_on.as_ref().map(|w| w.value().clone());
    let key = "calibration.model_uncertainty_rel";
    if c.fraction(&raw.model_uncertainty_rel, key).is_some()
        && let Some(rel) = c.positive_number(&raw.model_uncertainty_rel, key)
    {
        out.model_uncertainty_rel = rel;
    }
    out.scale_sd = (c.fraction(&raw.scale_sd, "calibration.scale_sd")).unwrap_or(0.0);
    out.terms = terms(c, &raw.terms);
    out.check = raw.check.as_ref().map(words).unwrap_or_default();
    for (raw, key, out) in [
        (
            &raw.position_tolerance,
            "calibration.position_tolerance",
            &mut out.position_tolerance,
        ),
        (
            &raw.angle_tolerance_deg,
            "calibration.angle_tolerance_deg",
            &mut out.angle_tolerance_deg,
        ),
    ] {
        *out = c.positive_number(raw, key).unwrap_or(0.0);
    }
    out.line = c.line(section);
    out
}

/// `terms`. A quadratic model would need loads that are solved for by iteration in every sample of a record, which `recover` does not do.
fn terms(c: &mut Collector, word: &S<String>) -> Terms {
    let key = "calibration.terms";
    if let Some(word) = word.as_ref().filter(|w| w.value() == "quadratic") {
        c.fault(
            word,
            key,
            "`quadratic` is not available: loads are recovered by a linear model",
            "write terms = \"linear\" or \"intercept\"; the finding `lack-of-fit` reports what squares of loads change, and intervals include it",
        );
        return Terms::Linear;
    }
    let choices = [("linear", Terms::Linear), ("intercept", Terms::Intercept)];
    c.choose(word, key, &choices, Terms::Linear)
}
