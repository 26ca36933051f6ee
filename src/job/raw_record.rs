//! Sections on records as a job states them: `[conditioning]` and `[dynamic]`.

use super::shapes::DampingValue;
use super::spanned_value::S;
use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawConditioning {
    pub spikes: S<bool>,
    pub temperature: S<RawTemperature>,
    pub zero_s: S<[f64; 2]>,
    pub drift: S<String>,
    pub low_pass_hz: S<f64>,
    pub high_pass_hz: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawTemperature {
    pub channel: S<String>,
    #[serde(rename = "microstrain_per_degC")]
    pub microstrain_per_deg_c: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawDynamic {
    pub up_to_hz: S<f64>,
    pub damping: S<DampingValue>,
    pub frequency_uncertainty_rel: S<f64>,
    pub damping_uncertainty_rel: S<f64>,
}
