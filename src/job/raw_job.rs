//! The job as written: every key of every section, each value with its place in the text, nothing required here.

use super::raw_record::{RawConditioning, RawDynamic};
use super::shapes::{Counts, Ids, NumberOrNumbers, NumberOrWord, PropertyIds, Texts};
use super::spanned_value::SpannedValue;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

pub(super) use super::spanned_value::S;

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawJob {
    pub title: S<String>,
    pub units: S<String>,
    pub report_units: Option<RawUnits>,
    pub model: S<RawModel>,
    pub load: Vec<SpannedValue<RawLoad>>,
    pub calibration: S<RawCalibration>,
    pub combination: Vec<SpannedValue<RawCombination>>,
    pub correction: Vec<SpannedValue<RawChannelCorrection>>,
    pub gauge: Vec<SpannedValue<RawGauge>>,
    pub gauges: S<RawGauges>,
    pub candidates: S<RawCandidates>,
    pub placement: S<RawPlacement>,
    pub measured: S<RawMeasured>,
    pub runs: S<RawRuns>,
    pub compare: S<RawCompare>,
    pub section: Vec<SpannedValue<RawSection>>,
    pub ballast: S<RawBallast>,
    pub payload: S<RawPayload>,
    pub conditioning: S<RawConditioning>,
    pub dynamic: S<RawDynamic>,
    pub recover: S<RawRecover>,
    pub respond: S<RawRespond>,
    pub study: S<RawStudy>,
    pub vehicle: S<RawVehicle>,
    pub reconcile: S<RawReconcile>,
    pub sensitivity: S<RawSensitivity>,
    pub fleet: S<RawFleet>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawUnits {
    pub force: S<String>,
    pub moment: S<String>,
    pub length: S<String>,
    pub mass: S<String>,
    pub stress: S<String>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawModel {
    pub deck: S<String>,
    pub results: Vec<SpannedValue<String>>,
    pub support: S<NumberOrWord>,
    pub mesh_error: S<bool>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawLoad {
    pub name: S<String>,
    pub grid: S<u32>,
    pub load_set: S<u32>,
    pub component: S<String>,
    pub cid: S<u32>,
    pub applied: S<f64>,
    pub result: S<String>,
    pub subcase: S<u32>,
    pub role: S<String>,
    pub expected: S<f64>,
    pub weight: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawCombination {
    pub name: S<String>,
    pub terms: BTreeMap<SpannedValue<String>, SpannedValue<f64>>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawCalibration {
    pub runs: S<Vec<SpannedValue<String>>>,
    pub repeats: S<Vec<SpannedValue<String>>>,
    pub depends_on: S<String>,
    pub model_uncertainty_rel: S<f64>,
    pub position_tolerance: S<f64>,
    pub angle_tolerance_deg: S<f64>,
    pub scale_sd: S<f64>,
    pub terms: S<String>,
    pub check: S<Vec<SpannedValue<String>>>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawChannelCorrection {
    pub gauge: S<String>,
    pub sign: S<f64>,
    pub gain: S<f64>,
    pub offset_microstrain: S<f64>,
    pub exchanged_with: S<String>,
    pub angle_deg: S<f64>,
    pub ignore: S<bool>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawGauge {
    pub name: S<String>,
    pub element: S<u32>,
    pub position: S<[f64; 3]>,
    pub cid: S<u32>,
    pub surface: S<String>,
    pub direction: S<[f64; 3]>,
    pub angle_deg: S<f64>,
    pub bridge: S<String>,
    pub bridge_factor: S<f64>,
    pub grid_length: S<f64>,
    pub element2: S<u32>,
    pub surface2: S<String>,
    pub rosette: S<String>,
    pub point: S<String>,
    pub station: S<f64>,
    pub transverse_sensitivity: S<f64>,
    pub role: S<String>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawGauges {
    pub file: S<String>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawCandidates {
    pub properties: S<PropertyIds>,
    pub elements: S<Ids>,
    pub surfaces: S<Vec<SpannedValue<String>>>,
    pub angle_step_deg: S<NumberOrWord>,
    pub grid_length: S<f64>,
    pub bridge: S<Texts>,
    pub rosette: S<String>,
    pub sets: S<Ids>,
    pub exclude_properties: S<PropertyIds>,
    pub exclude_elements: S<Ids>,
    pub wanted_elements: S<Ids>,
    pub file: S<String>,
    pub boxes: S<Vec<Vec<[f64; 2]>>>,
    pub exclude_boxes: S<Vec<Vec<[f64; 2]>>>,
    pub clear_of: Option<RawClear>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawClear {
    pub edges: S<f64>,
    pub holes: S<f64>,
    pub joints: S<f64>,
    pub loads: S<f64>,
    pub attachments: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawPlacement {
    pub gauges: S<u32>,
    pub criterion: S<String>,
    pub spacing: S<f64>,
    pub noise_microstrain: S<f64>,
    pub angle_tolerance_deg: S<f64>,
    pub model_uncertainty_rel: S<f64>,
    pub seed: S<u64>,
    pub position_tolerance: S<f64>,
    pub gauge_factor_rel: S<f64>,
    pub noise_by_bridge: BTreeMap<SpannedValue<String>, SpannedValue<f64>>,
    pub loss: S<String>,
    pub keep: S<Texts>,
    pub symmetric: S<String>,
    pub costs: BTreeMap<SpannedValue<String>, SpannedValue<f64>>,
    pub budget: S<f64>,
    pub curve: S<Counts>,
    pub reserve: S<u32>,
    pub references: BTreeMap<String, u32>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawMeasured {
    pub strain: S<String>,
    pub zero: S<String>,
    pub zero_runs: S<Vec<SpannedValue<String>>>,
    pub reference: S<NumberOrWord>,
    pub noise_microstrain: S<NumberOrNumbers>,
    pub noise_correlation: S<f64>,
    pub model_uncertainty_rel: S<f64>,
    pub hold_out: S<Texts>,
    pub time_unit: S<String>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawRuns {
    pub file: S<String>,
    pub columns: BTreeMap<SpannedValue<String>, SpannedValue<String>>,
    pub units: Option<RawUnits>,
    pub noise: Option<RawRunNoise>,
    pub wheel_forces: S<String>,
    pub ground: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawRunNoise {
    pub force: S<f64>,
    pub moment: S<f64>,
    pub mass: S<f64>,
    pub length: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawCompare {
    pub file: S<String>,
    pub columns: BTreeMap<SpannedValue<String>, SpannedValue<String>>,
    pub units: Option<RawUnits>,
    pub noise: Option<RawCompareNoise>,
    pub shift_s: S<NumberOrWord>,
    pub time_unit: S<String>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawCompareNoise {
    pub force: S<f64>,
    pub moment: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawSection {
    pub name: S<String>,
    pub start_s: S<f64>,
    pub end_s: S<f64>,
    pub file: S<String>,
    pub within: BTreeMap<SpannedValue<String>, [f64; 2]>,
    pub at_least_s: S<f64>,
    pub repeats: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawBallast {
    pub masses: S<u32>,
    pub region: S<Vec<[f64; 2]>>,
    pub properties: S<PropertyIds>,
    pub max_mass: S<f64>,
    pub run: S<String>,
    pub gravity: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawPayload {
    pub grid: S<u32>,
    pub position: S<String>,
    pub gravity: S<f64>,
    pub weight_in_model: S<bool>,
    pub unloaded: S<String>,
    pub region: S<Vec<[f64; 2]>>,
    #[serde(rename = "use")]
    pub sources: S<Vec<SpannedValue<String>>>,
    pub nominal_x: S<f64>,
    pub nominal_y: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawRecover {
    pub files: S<Vec<SpannedValue<String>>>,
    pub slope: S<f64>,
    pub csv_every: S<u32>,
    pub turning_points: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawFleet {
    pub file_name: S<String>,
    pub knee_range: S<f64>,
    pub slope_below_knee: S<f64>,
    pub reference: S<RawReferenceDay>,
    pub target: BTreeMap<SpannedValue<String>, SpannedValue<f64>>,
    pub mission: Vec<SpannedValue<RawMission>>,
    pub mission_hours: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawReferenceDay {
    pub vehicle: S<String>,
    pub day: S<String>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawMission {
    pub name: S<String>,
    pub share: S<f64>,
    pub days: Vec<SpannedValue<String>>,
    pub vehicles: Vec<SpannedValue<String>>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawRespond {
    pub elements: S<Ids>,
    pub hottest: S<u32>,
    pub loads: S<String>,
    pub slope: S<f64>,
    pub mean_stress: S<String>,
    pub ultimate: S<f64>,
    pub mean_sensitivity: S<f64>,
    pub fatigue_class: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawStudy {
    pub layouts: S<Vec<SpannedValue<String>>>,
    pub gauges: S<Counts>,
    pub errors: Vec<SpannedValue<RawError>>,
    pub trials: S<u32>,
    pub seed: S<u64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawError {
    pub kind: S<String>,
    pub size: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawVehicle {
    pub model: S<String>,
    pub terms: S<Vec<SpannedValue<String>>>,
    pub data: S<String>,
    pub input: S<Texts>,
    pub hold_out: S<String>,
    pub sample_rate: S<f64>,
    pub known: BTreeMap<String, f64>,
    pub noise: Option<RawVehicleNoise>,
    pub tolerance: Option<RawTolerance>,
    pub band_hz: S<[f64; 2]>,
    pub columns: BTreeMap<String, String>,
    pub places: BTreeMap<String, [f64; 2]>,
    pub bounds: BTreeMap<String, [f64; 2]>,
    pub corrections: BTreeMap<String, RawCorrection>,
    pub mass_change: Option<RawMassChange>,
    pub leaf: BTreeMap<SpannedValue<String>, RawLeaf>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawLeaf {
    pub hanger_to_axle: S<f64>,
    pub axle_to_shackle: S<f64>,
    pub shackle_angle_deg: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawCorrection {
    pub gain: S<f64>,
    pub delay_s: S<f64>,
    pub clock_ppm: S<f64>,
    pub slip_at_s: S<f64>,
    pub slip_s: S<f64>,
    pub low_pass_s: S<f64>,
    pub low_pass_order: S<u8>,
    pub line_hz: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawMassChange {
    pub body: S<String>,
    pub at_s: S<f64>,
    pub over_s: S<f64>,
    pub weight: S<bool>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawVehicleNoise {
    pub acc: S<f64>,
    pub force: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawTolerance {
    pub gain: S<f64>,
    pub sync: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawReconcile {
    pub path: S<String>,
    pub zones: BTreeMap<String, PropertyIds>,
    pub places: BTreeMap<String, u32>,
    #[serde(rename = "thermal_microstrain_per_degC")]
    pub thermal: BTreeMap<SpannedValue<String>, f64>,
    pub temperature_set: Option<u32>,
    pub effects: S<Texts>,
    pub joints: Option<Ids>,
    pub causes: BTreeMap<String, String>,
    pub tolerance: Option<RawGluing>,
    /// Hypotheses of the user's own.
    pub effect: Vec<SpannedValue<RawEffect>>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawEffect {
    /// Id of the effect in results.
    pub id: S<String>,
    /// CSV file with a row for each gauge and a column for each load: the change of S due to an effect of size one.
    pub signature: S<String>,
    /// Edit of the deck that represents an effect of size one.
    pub edit: Option<RawEdit>,
    /// Standard deviation of the size of the effect before the measurement. The default is 1.
    pub prior: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawEdit {
    /// A shell property whose thickness is scaled.
    pub property: Option<u32>,
    /// Factor of the thickness.
    pub thickness_scale: Option<f64>,
    /// A bush whose stiffness is scaled.
    pub cbush: Option<u32>,
    /// Factor of the stiffness.
    pub stiffness_scale: Option<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawGluing {
    pub angle_deg: S<f64>,
    pub position_mm: S<f64>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawSensitivity {
    pub file: S<String>,
    pub per: Option<RawUnits>,
    pub columns: BTreeMap<SpannedValue<String>, SpannedValue<String>>,
    pub signatures: Option<RawSignatures>,
    pub covariance: S<String>,
    pub common_zero: S<String>,
    pub range: BTreeMap<SpannedValue<String>, [f64; 2]>,
    pub strain_range: BTreeMap<SpannedValue<String>, [f64; 2]>,
}

#[derive(Deserialize, JsonSchema, Default, Debug)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawSignatures {
    pub lateral_wheel_loads: S<String>,
    pub thermal: S<String>,
    pub payload: S<String>,
    pub unaccounted_mass: S<String>,
    pub gauge_angle: S<String>,
    pub rail_stiffness: BTreeMap<String, SpannedValue<String>>,
}
