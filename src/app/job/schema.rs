//! The JSON schema of a job: keys and types from [`super::raw`], words and meanings from here.

use super::raw::RawJob;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

/// Meaning of a key, and the words it takes where only those will do.
const KEYS: &[(&str, &str, &[&str])] = &[
    ("title", "Title of reports", &[]),
    (
        "units",
        "Unit system of the deck, never guessed",
        &["m-kg-s", "mm-t-s", "mm-kg-s", "in-lbf-s"],
    ),
    (
        "report_units",
        "Units of reports, such as { force = \"kN\", moment = \"kN m\" }",
        &[],
    ),
    ("model", "The finite element model", &[]),
    (
        "model.deck",
        "Nastran deck, or an OP2 that holds the mesh",
        &[],
    ),
    (
        "model.results",
        "OP2, HDF5 or punch files; none: the built-in solver computes them",
        &[],
    ),
    (
        "model.support",
        "What holds the structure: \"deck\" (the SPC set that case control selects, if any, else free), \"free\" (inertia relief), or the id of an SPC set",
        &[],
    ),
    (
        "model.mesh_error",
        "true: the built-in solver solves a mesh half as wide as well (four times the grids, about five times the time), S is what the strain tends to as the mesh gets finer, and `recover` and `place` weigh what is left of the mesh's error (default false)",
        &[],
    ),
    ("load", "A load to be recovered: a column of S", &[]),
    ("load.name", "Its name in tables and reports", &[]),
    ("load.grid", "Grid where it acts", &[]),
    (
        "load.load_set",
        "Load set of the deck, instead of a grid",
        &[],
    ),
    (
        "load.component",
        "Force or moment component, basic frame or that of cid",
        &["FX", "FY", "FZ", "MX", "MY", "MZ"],
    ),
    (
        "load.cid",
        "Coordinate system of the component; default 0, basic",
        &[],
    ),
    (
        "load.applied",
        "The load in its subcase, job units, signed; default 1",
        &[],
    ),
    (
        "load.subcase",
        "Subcase in the results; default: its number in the job",
        &[],
    ),
    ("load.result", "Which of the results files", &[]),
    (
        "load.role",
        "wanted, or nuisance: present but not asked for",
        &["wanted", "nuisance"],
    ),
    (
        "load.expected",
        "Its size, one standard deviation, job units",
        &[],
    ),
    ("gauge", "An installed gauge", &[]),
    ("gauge.name", "Its column in the strain file", &[]),
    ("gauge.element", "Shell or bar it sits on", &[]),
    (
        "gauge.position",
        "Point instead of an element: the nearest shell is taken",
        &[],
    ),
    (
        "gauge.surface",
        "top is Z2, bottom is Z1",
        &["top", "bottom"],
    ),
    ("gauge.direction", "Direction, laid onto the surface", &[]),
    (
        "gauge.angle_deg",
        "Angle from that direction, right-handed about the element normal",
        &[],
    ),
    (
        "gauge.bridge",
        "Wiring of the arms",
        &[
            "quarter",
            "half-bending",
            "full-bending",
            "shear",
            "half",
            "full",
        ],
    ),
    (
        "gauge.bridge_factor",
        "The sum of signed arm strains is divided by this; default 1",
        &[],
    ),
    (
        "gauge.grid_length",
        "Length over which strain is averaged",
        &[],
    ),
    ("gauges", "Installed gauges in a table", &[]),
    (
        "gauges.file",
        "CSV with the keys of [[gauge]] as columns",
        &[],
    ),
    ("candidates", "Where `place` may put gauges", &[]),
    (
        "candidates.properties",
        "Property ids; default: all shells",
        &[],
    ),
    (
        "candidates.elements",
        "Element ids, such as \"1 THRU 5000\"",
        &[],
    ),
    (
        "candidates.angle_step_deg",
        "Step of angles, or \"continuous\"",
        &[],
    ),
    ("placement", "What `place` looks for", &[]),
    ("placement.gauges", "How many", &[]),
    (
        "placement.criterion",
        "What is best: all loads (D), the wanted ones (Ds), mean variance (A), mean error of predicted strain (I)",
        &["D", "Ds", "A", "I", "Bayesian-D"],
    ),
    (
        "placement.spacing",
        "Least distance between gauges, job unit of length",
        &[],
    ),
    (
        "placement.noise_microstrain",
        "Noise of a gauge, one standard deviation",
        &[],
    ),
    (
        "placement.angle_tolerance_deg",
        "How well gauges are aligned, one standard deviation",
        &[],
    ),
    ("measured", "Measured strain", &[]),
    (
        "measured.strain",
        "CSV, RPC III or binary record; a column a gauge, microstrain",
        &[],
    ),
    (
        "measured.zero",
        "Record or runs whose mean is subtracted",
        &[],
    ),
    (
        "measured.reference",
        "none: loads are changes; gravity or a subcase: they are totals",
        &[],
    ),
    (
        "measured.noise_microstrain",
        "Noise of a reading, one standard deviation",
        &[],
    ),
    (
        "measured.model_uncertainty_rel",
        "Error of the predicted strain, one standard deviation",
        &[],
    ),
    (
        "measured.hold_out",
        "Runs, or a second file, never used for fitting",
        &[],
    ),
    ("runs", "What else was measured in each run", &[]),
    (
        "runs.wheel_forces",
        "Where wheel forces come from",
        &["measured", "flat_ground_model"],
    ),
    (
        "ballast",
        "Lumped masses that bring the model's reactions to the measured ones",
        &[],
    ),
    ("payload", "Payload mass and position", &[]),
    (
        "payload.position",
        "Whether its place is known",
        &["known", "free"],
    ),
    ("recover", "What `recover` writes beside loads.csv", &[]),
    (
        "recover.files",
        "Which of them; default all, but for long histories",
        &["rpc", "nastran", "rainflow", "parquet"],
    ),
    (
        "recover.slope",
        "Power of the load range in pseudo-damage; default 5",
        &[],
    ),
    ("fleet", "Records of many vehicles and days", &[]),
    (
        "fleet.file_name",
        "Form of their file names: text with {vehicle} and {day}, and {any} for what doesn't matter",
        &[],
    ),
    (
        "fleet.knee_range",
        "Load range below which the S-N line is flatter, report unit; default none",
        &[],
    ),
    (
        "fleet.slope_below_knee",
        "Power below the knee; default: cycles below do no harm",
        &[],
    ),
    (
        "respond",
        "Strain and stress anywhere from recovered loads",
        &[],
    ),
    ("study", "Recovery repeated under stated errors", &[]),
    ("vehicle", "A vehicle identified from accelerations", &[]),
    (
        "vehicle.model",
        "Which vehicle",
        &crate::vehicle::preset::MODELS,
    ),
    ("vehicle.data", "CSV or RPC III record", &[]),
    (
        "reconcile",
        "Where simulation and measurement disagree",
        &[],
    ),
    (
        "reconcile.path",
        "Strain of runs, or accelerations",
        &["static", "dynamic"],
    ),
    (
        "sensitivity",
        "S computed elsewhere, instead of [model]",
        &[],
    ),
    (
        "sensitivity.covariance",
        "How far that S may be off: calibration.bin, as `calibrate` writes it",
        &[],
    ),
    (
        "combination",
        "A sum of loads with an interval of its own",
        &[],
    ),
    ("combination.name", "Its name in tables and reports", &[]),
    (
        "combination.terms",
        "Factor by load, such as { \"LF.FZ\" = 1, \"RF.FZ\" = 1 }",
        &[],
    ),
    (
        "calibration",
        "How `calibrate` learns S from runs of known load",
        &[],
    ),
    (
        "calibration.runs",
        "Runs that teach; left out: every run of [measured] whose loads [runs] gives",
        &[],
    ),
    (
        "calibration.repeats",
        "Columns of the runs file: runs alike in these are repeats; left out: runs of equal loads",
        &[],
    ),
    (
        "calibration.depends_on",
        "Column of the runs file, such as speed: whether loads come out larger with it is tested",
        &[],
    ),
    (
        "calibration.model_uncertainty_rel",
        "How far the model's S may be off, 1 sd, entry by entry and common to a gauge; default 0.1",
        &[],
    ),
];

/// The schema as JSON text (draft 2020-12).
pub fn job_schema() -> String {
    let settings = SchemaSettings::draft2020_12().for_deserialize().with(|s| {
        s.inline_subschemas = true;
    });
    let schema = settings.into_generator().into_root_schema_for::<RawJob>();
    let mut value = schema.to_value();
    without_null(&mut value);
    if let Some(top) = value.as_object_mut() {
        top.insert("title".into(), "strainbridge job".into());
    }
    for (path, meaning, words) in KEYS {
        if let Some(key) = key_at(&mut value, path) {
            key.insert("description".into(), (*meaning).into());
            let words = (!words.is_empty()).then(|| json!(words));
            let list = key.get("items").is_some_and(Value::is_object);
            match (words, key.get_mut("items").and_then(Value::as_object_mut)) {
                (Some(words), Some(items)) if list => items.insert("enum".into(), words),
                (Some(words), _) => key.insert("enum".into(), words),
                (None, _) => None,
            };
        }
    }
    // A map of plain values always has a text form.
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

/// The schema of a key such as `load.grid`.
fn key_at<'a>(root: &'a mut Value, path: &str) -> Option<&'a mut Map<String, Value>> {
    let mut at = root;
    for name in path.split('.') {
        let below = if at.get("properties").is_some() {
            at
        } else {
            at.get_mut("items")?
        };
        at = below.get_mut("properties")?.get_mut(name)?;
    }
    at.as_object_mut()
}

/// TOML has no null: an absent key is left out instead.
fn without_null(value: &mut Value) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(without_null),
        Value::Object(map) => {
            if let Some(Value::Array(types)) = map.get_mut("type") {
                types.retain(|t| t != "null");
                if let [only] = types.as_slice() {
                    let only = only.clone();
                    map.insert("type".into(), only);
                }
            }
            if let Some(Value::Array(any)) = map.get_mut("anyOf") {
                any.retain(|s| s.get("type") != Some(&"null".into()));
                if let [Value::Object(only)] = any.as_slice() {
                    let only = only.clone();
                    map.remove("anyOf");
                    map.extend(only);
                }
            }
            if map.get("default").is_some_and(Value::is_null) {
                map.remove("default");
            }
            map.values_mut().for_each(without_null);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_with_a_meaning_exists() {
        let mut schema: Value = serde_json::from_str(&job_schema()).unwrap();
        for (path, ..) in KEYS {
            assert!(key_at(&mut schema, path).is_some(), "{path}");
        }
        assert!(!job_schema().contains("null"));
    }
}
