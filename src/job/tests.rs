use super::*;
use crate::fe::strain_tensor::Surface;
use crate::gauge::Bridge;
use crate::host::fault::{Fault, Faults};
use crate::reconcile::strain::WheelForces;

/// Parses and resolves the text of a job, without any other file.
pub(crate) fn read_text(text: &str) -> Result<Job, Faults> {
    let (raw, mut faults) = parse::parse_job("job.toml", text);
    let job = resolve::resolve_job("job.toml", text, Path::new(""), raw, &mut faults);
    Faults::check(faults)?;
    Ok(job)
}

fn faults(text: &str) -> Vec<Fault> {
    read_text(text)
        .expect_err("the job should be refused")
        .into_list()
}

/// A job with every key of the command-line contract.
const WHOLE: &str = r#"
title = "Roll-off truck"
units = "m-kg-s"
report_units = { force = "kN", moment = "kN m" }
[model]
deck = "truck.bdf"
results = ["truck.op2", "lf.op2"]
[[load]]
name = "LF.FZ"
grid = 101
component = "FZ"
applied = 1000.0
result = "lf.op2"
subcase = 1
role = "wanted"
expected = 25000.0
[[load]]
name = "other"
load_set = 12
role = "nuisance"
[[load]]
name = "LF.MX"
grid = 101
component = "MX"
cid = 3
[[gauge]]
name = "14"
element = 1205
surface = "top"
direction = [1, 0, 0]
angle_deg = 0
bridge = "full-bending"
bridge_factor = 1.0
grid_length = 5.0
element2 = 1305
surface2 = "bottom"
[[gauge]]
name = "15"
position = [0.1, 2, 3.0]
direction = [0, 1, 0]
[candidates]
properties = [1, 2]
elements = "1 THRU 5000"
surfaces = ["top", "bottom"]
angle_step_deg = "continuous"
[placement]
gauges = 10
spacing = 50.0
noise_microstrain = 1.0
angle_tolerance_deg = 2.0
[measured]
strain = "strain.csv"
zero = "run1.csv"
reference = "none"
noise_microstrain = 1.0
model_uncertainty_rel = 0.02
hold_out = ["R11", "R12"]
[runs]
file = "runs.csv"
columns = { "LF.FZ" = "FZ_LF_kN", payload_mass = "payload_kg" }
units = { force = "kN", mass = "kg", length = "m" }
noise = { force = 0.06 }
wheel_forces = "flat_ground_model"
[ballast]
masses = 2
region = [[0, 1], [2.0, 3.0]]
max_mass = 500
run = "R01"
[payload]
grid = 9101
position = "free"
gravity = 9.81
weight_in_model = true
region = [[0, 1], [2.0, 3.0]]
use = ["strain", "reactions"]
[respond]
elements = "1 THRU 500"
hottest = 20
loads = "loads.csv"
[study]
layouts = ["given", "random", "D"]
gauges = [6, 8, 10]
errors = [{ kind = "relative-uniform", size = 0.1 }]
trials = 2000
seed = 1
[vehicle]
model = "front2"
terms = ["k_s", "c_s"]
data = "data.csv"
hold_out = "holdout.csv"
sample_rate = 500
known = { m_b = 3200.0 }
noise = { acc = 0.02, force = 60.0 }
tolerance = { gain = 0.01, sync = 0.0004 }
band_hz = [0.7, 20.0]
[reconcile]
path = "static"
zones = { L4 = [14] }
places = { rear = 9204 }
thermal_microstrain_per_degC = { quarter = 1.404, full-bending = 0.0 }
effects = "all"
joints = [7]
tolerance = { angle_deg = 1.0, position_mm = 2.0 }
[sensitivity]
file = "A_vertical.csv"
covariance = "calibration.bin"
per = { force = "kN", moment = "kN m", mass = "kg" }
columns = { "LF.FZ" = "FZ_LF" }
signatures = { lateral_wheel_loads = "A_other.csv", thermal = "T_thermal.csv", payload = "B_payload.csv", unaccounted_mass = "B_mass.csv", gauge_angle = "tensor.csv", rail_stiffness = { Z1 = "dA_dt_Z1.csv" } }
"#;

#[test]
fn a_job_with_every_key_of_the_contract_is_read() {
    let job = read_text(WHOLE).unwrap();
    assert_eq!(job.loads.len(), 3);
    assert_eq!(job.loads[1].acts, LoadActs::Set(12));
    assert_eq!(job.loads[1].applied, 1.0);
    assert_eq!(
        job.loads[2].subcase(),
        3,
        "left out: its number in job order"
    );
    assert_eq!(
        job.placement.criterion,
        Optimality::Ds,
        "nuisance loads make Ds the default"
    );
    assert_eq!(job.candidates.angles, AngleStep::Continuous);
    assert!(job.candidates.elements.unwrap().contains(77));
    assert_eq!(job.gauges[0].pair, Some((1305, Some(Surface::Bottom))));
    assert_eq!(
        job.gauges[1].place,
        StatedPlace::Position([0.1, 2.0, 3.0], 0)
    );
    assert_eq!(
        job.study.unwrap().errors,
        vec![("relative-uniform".to_owned(), 0.1)]
    );
    assert_eq!(job.vehicle.unwrap().band_hz, Some([0.7, 20.0]));
    assert_eq!(job.runs.unwrap().wheel_forces, WheelForces::FlatGroundModel);
}

#[test]
fn every_fault_is_listed_with_its_line_and_a_remedy() {
    let text = r#"
units = "m-kg-s"
[model]
deck = "truck.bdf"
[[load]]
name = "LF.FZ"
grid = 101
componnent = "FZ"
[[load]]
name = "RF.FZ"
grid = "one hundred"
component = "FQ"
[placement]
gauges = 2.5
spaceing = 3
"#;
    let found = faults(text);
    let lines: Vec<(Option<u32>, &str)> =
        found.iter().map(|f| (f.line, f.field.as_str())).collect();
    for expected in [
        (Some(8), "load[1].componnent"),
        (Some(11), "load[2].grid"),
        (Some(14), "placement.gauges"),
        (Some(15), "placement.spaceing"),
    ] {
        assert!(lines.contains(&expected), "{expected:?} in {found:#?}");
    }
    let text: String = found.iter().map(|f| f.to_string() + "\n").collect();
    assert!(text.contains("did you mean `component`?"), "{text}");
    assert!(text.contains("did you mean `spacing`?"), "{text}");
    assert!(text.contains("a whole number"), "{text}");
}

#[test]
fn a_value_that_can_not_be_is_pointed_at_by_line_and_column() {
    let text = "units = \"m-kg-s\"\n[model]\ndeck = \"truck.bdf\"\n[placement]\ngauges = 2\nspacing = -3.0\ncriterion = \"Q\"\n";
    let found = faults(text);
    for (line, column) in [(6, 11), (7, 13)] {
        let fault = found.iter().find(|f| f.line == Some(line)).unwrap();
        assert!(
            fault.wrong.contains(&format!("(column {column})")),
            "{fault}"
        );
    }
}

#[test]
fn units_are_required_and_a_word_close_to_one_is_suggested() {
    let f = faults("title = \"x\"\n");
    assert!(
        f[0].to_string().starts_with("job.toml:1: units: "),
        "{}",
        f[0]
    );
    let f = faults("units = \"mm-t\"\n");
    assert!(f[0].remedy.contains("mm-t-s"), "{}", f[0]);
    let f = faults("units = \"m-kg-s\"\nreport_units = { force = \"KN\" }\n");
    assert!(
        f[0].to_string()
            .starts_with("job.toml:2: report_units.force: "),
        "{}",
        f[0]
    );
}

#[test]
fn a_misspelt_section_is_named_with_its_line() {
    let f = faults("units = \"m-kg-s\"\n\n[placment]\ngauges = 3\n");
    assert_eq!(f[0].line, Some(3));
    assert!(f[0].remedy.contains("`placement`"), "{}", f[0]);
}

#[test]
fn broken_toml_is_a_fault_with_its_line() {
    let f = faults("units = \"m-kg-s\"\n[model\ndeck = 3\n");
    assert!(f.iter().any(|f| f.line == Some(2)), "{f:?}");
}

#[test]
fn contradictions_between_keys_are_faults() {
    let base = "units = \"m-kg-s\"\n[[load]]\nname = \"a\"\n";
    for (more, field) in [
        (
            "grid = 1\nload_set = 2\ncomponent = \"FX\"\n",
            "load.load_set",
        ),
        ("grid = 1\n", "load.component"),
        ("component = \"FX\"\n", "load.grid"),
        ("load_set = 1\napplied = 0\n", "load.applied"),
        ("load_set = 1\nexpected = -3\n", "load.expected"),
        (
            "load_set = 1\n[[load]]\nname = \"a\"\nload_set = 2\n",
            "load.name",
        ),
        (
            "load_set = 1\nresult = \"x.op2\"\n[model]\ndeck = \"d\"\nresults = [\"y.op2\"]\n",
            "load.result",
        ),
    ] {
        let found = faults(&format!("{base}{more}"));
        assert!(found.iter().any(|f| f.field == field), "{field}: {found:?}");
    }
}

/// Returns the gauges of a table. `length_m` is the job's unit of length in metres.
fn gauges_from_table(t: &table::Table, length_m: f64, faults: &mut Vec<Fault>) -> Vec<JobGauge> {
    let columns = gauge_table::GaugeColumns::from_table(t, length_m, faults);
    gauges::gauges_from_table(t, &columns, faults)
}

#[test]
fn gauge_tables_take_the_contracts_columns_and_list_every_fault() {
    let text = "name,element,surface,dir_x,dir_y,dir_z,angle_deg,bridge,bridge_factor,grid_length,element2,surface2\n\
                A,12,top,1,0,0,45,half-bending,2,5.0,13,bottom\n\
                B,1.5,upper,0,0,0,x,quarter,1,0,,\n\
                C,14,bottom,1,0,0,,fullbending,,,,\n";
    let t = table::read_table("g.csv", text).unwrap();
    let mut found = Vec::new();
    let gauges = gauges_from_table(&t, 1.0, &mut found);
    assert_eq!(gauges.len(), 1);
    assert_eq!(gauges[0].place, StatedPlace::Element(12));
    assert_eq!(
        (gauges[0].bridge, gauges[0].bridge_factor, gauges[0].pair),
        (Bridge::HalfBending, 2.0, Some((13, Some(Surface::Bottom))))
    );
    let fields: Vec<(Option<u32>, &str)> =
        found.iter().map(|f| (f.line, f.field.as_str())).collect();
    for expected in [
        (Some(3), "element"),
        (Some(3), "surface"),
        (Some(3), "angle_deg"),
        (Some(4), "bridge"),
    ] {
        assert!(fields.contains(&expected), "{expected:?} in {fields:?}");
    }
}

#[test]
fn a_station_without_a_point_is_refused_in_a_job_and_in_a_table() {
    let text = "name,element,point,station\nA,1,,0.5\nB,1,C,0.5\nC,1,,\n";
    let t = table::read_table("g.csv", text).unwrap();
    let mut found = Vec::new();
    gauges_from_table(&t, 1.0, &mut found);
    let named: Vec<_> = found.iter().map(|f| (f.line, &*f.field)).collect();
    assert_eq!(named, [(Some(2), "station")], "{found:?}");
    let job = "units = \"mm-t-s\"\n[model]\ndeck = \"d.bdf\"\n[[gauge]]\nname = \"A\"\nelement = 1\nstation = 0.5\n";
    let faults = faults(job);
    let at = |f: &Fault| (f.line, &*f.field) == (Some(7), "gauge.station");
    assert!(faults.iter().any(at), "{faults:?}");
}

/// Without these limits, 1.5 would mean system 1, and a station beyond the end would mean the end.
#[test]
fn a_gauge_table_is_held_to_the_limits_of_a_job() {
    for (header, good, bad) in [
        ("cid", ["0", "7"], ["1.5", "-1"]),
        ("station", ["0", "1"], ["1.5", "-0.1"]),
        ("transverse_sensitivity", ["-0.4", "0.4"], ["0.5", "3"]),
    ] {
        let found = |value: &str| {
            let text = format!("name,element,point,{header}\nA,1,C,{value}\n");
            let t = table::read_table("g.csv", &text).unwrap();
            let mut found = Vec::new();
            gauges_from_table(&t, 1.0, &mut found);
            found
        };
        for value in good {
            let found = found(value);
            assert!(found.is_empty(), "{header} {value}: {found:?}");
        }
        for value in bad {
            let found = found(value);
            let named = |f: &Fault| (f.line, &*f.field) == (Some(2), header);
            assert!(found.iter().any(named), "{header} {value}: {found:?}");
            // A job has the same limit.
            if header != "cid" {
                let key = format!("gauge.{header}");
                let job = format!(
                    "units = \"m-kg-s\"\n[[gauge]]\nname = \"A\"\nelement = 1\npoint = \"C\"\n{header} = {value}\n"
                );
                assert!(faults(&job).iter().any(|f| f.field == key), "{key} {value}");
            }
        }
    }
}

/// Half a direction would be read as the x axis of the element.
#[test]
fn a_direction_in_a_gauge_table_is_whole_or_absent() {
    for (header, row, at) in [
        ("dir_x,dir_y,dir_z", "1,0,0", None),
        ("dir_x,dir_y,dir_z", ",,", None),
        ("dir_x,dir_y,dir_z", "0,1,", Some("dir_z")),
        ("dir_x,dir_z", "1,0", Some("dir_y")),
    ] {
        let text = format!("name,element,{header}\nA,1,{row}\n");
        let t = table::read_table("g.csv", &text).unwrap();
        let mut found = Vec::new();
        gauges_from_table(&t, 1.0, &mut found);
        let fields: Vec<&str> = found.iter().map(|f| f.field.as_str()).collect();
        assert_eq!(fields, Vec::from_iter(at), "{row}: {found:?}");
    }
}

/// An angle that is not read would be 0.
#[test]
fn columns_that_look_like_those_of_a_gauge_table_are_faults() {
    for (header, meant) in [
        ("angle", "angle_deg"),
        ("surfaces", "surface"),
        ("elemnt", "element"),
        ("grid_lenght", "grid_length"),
    ] {
        let t = table::read_table("g.csv", &format!("name,{header}\nA,1\n")).unwrap();
        let mut found = Vec::new();
        gauges_from_table(&t, 1.0, &mut found);
        let named = |f: &Fault| f.field == header && f.remedy.contains(meant);
        assert!(found.iter().any(named), "{header}: {found:?}");
    }
    // Columns that users keep in addition to the columns that are read.
    let t = table::read_table(
        "g.csv",
        "name,element,angle_deg,x_m,y_m,z_m,member,place,row,leverage,role,angle_seen_deg\nA,1,45,0,0,0,rail,web,2,.3,estimate,45\n",
    );
    let mut found = Vec::new();
    gauges_from_table(&t.unwrap(), 1.0, &mut found);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn positions_in_metres_become_job_units() {
    let t = table::read_table(
        "g.csv",
        "gauge,x_m,y_m,z_m,kind,surface\nA,1.5,-0.25,0,quarter,top\n",
    )
    .unwrap();
    let mut found = Vec::new();
    let gauges = gauges_from_table(&t, 1e-3, &mut found);
    assert_eq!(gauges[0].position, Some([1500.0, -250.0, 0.0]));
}

#[test]
fn rows_of_another_length_are_faults() {
    let f = table::read_table("s.csv", "run,G1,G2\nR1,1\n").unwrap_err();
    assert!(
        f[0].to_string()
            .starts_with("s.csv:2: row: the row has 2 fields, the header has 3"),
        "{}",
        f[0]
    );
}

#[test]
fn without_a_model_a_load_needs_a_name_alone_and_with_one_it_must_act_somewhere() {
    let job = read_text("units = \"m-kg-s\"\n[[load]]\nname = \"west\"\n[calibration]\n").unwrap();
    assert_eq!(job.loads[0].acts, LoadActs::Named);
    let found =
        faults("units = \"m-kg-s\"\n[model]\ndeck = \"d.bdf\"\n[[load]]\nname = \"west\"\n");
    assert!(found.iter().any(|f| f.field == "load.grid"), "{found:?}");
}

#[test]
fn a_relative_error_above_1_asks_whether_percent_was_meant() {
    let head = "units = \"mm-t-s\"\n[model]\ndeck = \"d.bdf\"\n";
    let measured = "[measured]\nstrain = \"s.csv\"\nmodel_uncertainty_rel = ";
    let study = |kind: &str| {
        format!("[study]\ntrials = 10\nerrors = [{{ kind = \"{kind}\", size = SIZE }}]\n")
    };
    let dynamic = "[dynamic]\nup_to_hz = 4.0\ndamping = 0.02\n";
    for (key, text) in [
        (
            "measured.model_uncertainty_rel",
            format!("{measured}SIZE\n"),
        ),
        (
            "placement.model_uncertainty_rel",
            "[placement]\nmodel_uncertainty_rel = SIZE\n".into(),
        ),
        (
            "placement.gauge_factor_rel",
            "[placement]\ngauge_factor_rel = SIZE\n".into(),
        ),
        (
            "calibration.model_uncertainty_rel",
            "[calibration]\nmodel_uncertainty_rel = SIZE\n".into(),
        ),
        (
            "dynamic.frequency_uncertainty_rel",
            format!("{dynamic}frequency_uncertainty_rel = SIZE\n"),
        ),
        (
            "dynamic.damping_uncertainty_rel",
            format!("{dynamic}damping_uncertainty_rel = SIZE\n"),
        ),
        ("study.errors.size", study("relative-uniform")),
        ("study.errors.size", study("relative-normal")),
        ("study.errors.size", study("factor")),
    ] {
        let of = |size: &str| match read_text(&format!("{head}{}", text.replace("SIZE", size))) {
            Ok(_) => Vec::new(),
            Err(faults) => {
                let faults = faults.into_list().into_iter();
                let named = faults.filter(|f| f.field == key);
                named.map(|f| format!("{} {}", f.wrong, f.remedy)).collect()
            }
        };
        for size in ["0.05", "1.0"] {
            assert!(of(size).is_empty(), "{key} {size}: {:?}", of(size));
        }
        let found = of("15");
        let asks = |t: &String| t.contains("1500 %") && t.contains("write 0.15 for 15 %");
        assert!(found.iter().any(asks), "{key}: {found:?}");
        for size in ["-0.1", "1e6"] {
            assert!(!of(size).is_empty(), "{key} {size}");
        }
    }
    // A size in microstrain or degrees is not a fraction.
    for kind in ["absolute-normal", "angle"] {
        let text = format!("{head}{}", study(kind).replace("SIZE", "15"));
        let found = read_text(&text).err().map(Faults::into_list);
        let sizes = found.iter().flatten();
        assert!(sizes.filter(|f| f.field == "study.errors.size").count() == 0);
    }
}
