use super::*;
use crate::app::fault::{Fault, Faults};
use crate::app::measured::gauge_columns::{StrainColumn, find_gauge_columns};
use crate::app::measured::{runs_file, strain_file, strain_table, strain_text};
use crate::fe::strain_tensor::Surface;
use crate::gauge::Bridge;
use crate::reconcile::strain::WheelForces;
use crate::series::record::{Column, name_and_unit};
use std::path::PathBuf;

/// A job text parsed and resolved, without any file but the job.
fn read_text(text: &str) -> Result<Job, Faults> {
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

fn shared() -> Option<PathBuf> {
    crate::support::shared(".")
}

fn jobs_below(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            jobs_below(&path, out);
        } else if path.file_name().is_some_and(|n| n == "job.toml") {
            out.push(path);
        }
    }
}

#[test]
fn every_shared_job_is_read_with_all_files_it_names() {
    let Some(shared) = shared() else { return };
    let mut jobs = Vec::new();
    jobs_below(&shared, &mut jobs);
    assert!(jobs.len() >= 10, "{jobs:?}");
    for path in jobs {
        let mut inputs = Inputs::of(&crate::app::context::Disk);
        let job =
            read_job(&mut inputs, &path).unwrap_or_else(|f| panic!("{}: {f:?}", path.display()));
        if let Some(m) = &job.measured {
            let wanted = strain_file::wanted_columns(&mut inputs, &job);
            let strain = strain_file::read_strain(&mut inputs, &job, &m.strain, &wanted).unwrap();
            let names: Vec<&String> = job.gauges.iter().map(|g| &g.name).collect();
            assert_eq!(
                strain.gauges.iter().collect::<Vec<_>>(),
                names,
                "{}",
                path.display()
            );
            assert!(strain.n_rows() >= 12);
        }
        if let Some(r) = &job.runs {
            let runs = runs_file::read_runs(&mut inputs, &job, r).unwrap();
            assert!(runs.iter().all(|r| r.loads_si.len() == 6
                && r.payload_mass_kg.is_some()
                && r.payload_x_m.is_some()));
        }
    }
}

#[test]
fn a_runs_file_is_read_in_si_by_the_jobs_names() {
    let Some(shared) = shared() else { return };
    let mut inputs = Inputs::of(&crate::app::context::Disk);
    let job = read_job(
        &mut inputs,
        &shared.join("hidden_effects/static/dev-s1/job.toml"),
    )
    .unwrap();
    assert_eq!(
        job.sensitivity.as_ref().unwrap().columns[0],
        ("RR.FZ".into(), "FZ_RR".into()),
        "in the order of the job"
    );
    let text =
        std::fs::read_to_string(shared.join("hidden_effects/static/dev-s1/runs.csv")).unwrap();
    let first: Vec<f64> = text
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .skip(1)
        .map(|x| x.parse().unwrap())
        .collect();
    let runs = runs_file::read_runs(&mut inputs, &job, job.runs.as_ref().unwrap()).unwrap();
    assert_eq!(runs[0].payload_mass_kg, Some(first[0]));
    assert_eq!(runs[0].loads_si["RR.FZ"], first[2] * 1e3);
    assert_eq!(runs[0].loads_si["LR.FZ"], first[7] * 1e3);
}

/// Every key of the command-line contract in one job.
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
    assert_eq!(job.gauges[0].pair, Some((1305, Surface::Bottom)));
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

/// Gauges of a table; `length_m` are the metres in the job's unit of length.
fn gauges_from_table(t: &table::Table, length_m: f64, faults: &mut Vec<Fault>) -> Vec<JobGauge> {
    let columns = gauge_table::GaugeColumns::of(t, length_m, faults);
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
        (Bridge::HalfBending, 2.0, Some((13, Surface::Bottom)))
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

/// Read as they stand, 1.5 would be system 1 and a station beyond the end that of the end.
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
            // The same in a job.
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

/// Half a direction would be taken for the element x axis.
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

/// An angle that isn't read would be 0.
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
    // What others keep beside their gauges.
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
fn strain_tables_hold_runs_or_samples() {
    let read = |text: &str| strain_text::strain_from_text("s.csv", text, &[]);
    let s = read("run,G1,G2\nR1,1.5,\nR2,3,4\n").unwrap();
    assert_eq!(
        s.rows,
        strain_table::StrainRows::Runs(vec!["R1".into(), "R2".into()])
    );
    assert!(s.row(0)[1].is_nan());
    let f = read("time;G1\n0;1\n0.1;2\n0.1;3\n").unwrap_err();
    assert_eq!((f[0].line, f[0].field.as_str()), (Some(4), "time"));
    let f = read("run,G1\nR1,1\nR2,2\nR1,3\n").unwrap_err();
    assert_eq!((f[0].line, f[0].field.as_str()), (Some(4), "run"));
    assert!(read("G1\n1\n").is_err() && read("run,G1\n").is_err());
}

#[test]
fn a_long_table_in_parts_is_the_whole_table() {
    let rows = (0..25_001).map(|i| format!("R{i},{i},-{i}\n"));
    let text = format!("run,G1,G2\n{}", rows.collect::<String>());
    let s = strain_text::strain_from_text("s.csv", &text, &[]).unwrap();
    assert_eq!(s.n_rows(), 25_001);
    assert!((0..25_001).all(|i| s.row(i) == [i as f64, -(i as f64)]));
}

#[test]
fn rows_of_another_length_are_faults() {
    let f = table::read_table("s.csv", "run,G1,G2\nR1,1\n").unwrap_err();
    assert!(
        f[0].to_string()
            .starts_with("s.csv:2: row: 2 fields, the header has 3"),
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

/// The runs of a table, read for a job with these further lines under `[runs]`.
fn runs_of(table: &str, more: &str) -> Result<Vec<runs_file::RunRow>, Faults> {
    let files = crate::app::context::InMemory::default().with("runs.csv", table);
    let text = format!(
        "units = \"m-kg-s\"\nreport_units = {{ force = \"kN\" }}\n[[load]]\nname = \"LF.FZ\"\n[[load]]\nname = \"LF.MX\"\n\
         [calibration]\n[runs]\nfile = \"runs.csv\"\n{more}"
    );
    let job = read_text(&text)?;
    let runs = job.runs.as_ref().unwrap();
    runs_file::read_runs(&mut Inputs::of(&files), &job, runs)
}

#[test]
fn units_of_a_runs_file_stand_in_its_header_or_below_and_contradict_nothing() {
    let si = |table: &str, more: &str| {
        let rows = runs_of(table, more).unwrap_or_else(|f| panic!("{f:?}"));
        assert_eq!(rows.len(), 1);
        ["LF.FZ", "LF.MX"].map(|l| rows[0].loads_si[l])
    };
    let plain = si("run,LF.FZ,LF.MX\nR1,2,3\n", "");
    assert_eq!(plain, [2e3, 3.0]);
    let below = si("run,LF.FZ,LF.MX\n-,N,kN m\nR1,2000,0.003\n", "");
    let beside = si("run,LF.FZ [N],LF.MX (N*m)\nR1,2000,3\n", "");
    // 0.003 times a thousand: the last digit.
    assert!(below[0] == 2e3 && (below[1] - 3.0).abs() < 1e-12);
    assert_eq!(beside, plain);
    let named = "columns = { \"LF.FZ\" = \"axle (front)\" }\n";
    assert_eq!(si("run,axle (front),LF.MX\nR1,2,3\n", named), plain);
    // What the job states as well must be the same.
    let stated = "units = { force = \"kN\" }\n";
    assert_eq!(si("run,LF.FZ [kN],LF.MX\nR1,2,3\n", stated), plain);
    let fault = |table: &str, more: &str| runs_of(table, more).unwrap_err().into_list().remove(0);
    let f = fault("run,LF.FZ [N],LF.MX\nR1,2,3\n", stated);
    let said = f.to_string();
    assert!(
        said.starts_with("runs.csv:1: LF.FZ [N]: the column says `N`, the job says `kN`"),
        "{said}"
    );
    let f = fault("run,LF.FZ [kg],LF.MX\nR1,2,3\n", "");
    let said = f.to_string();
    assert!(
        said.contains("`kg` is no unit of force") && said.contains("kN"),
        "{said}"
    );
}

#[test]
fn labels_rows_of_units_and_noise_of_a_runs_file_are_not_mistaken() {
    let si = |table: &str, more: &str| {
        let rows = runs_of(table, more).unwrap_or_else(|f| panic!("{table}: {f:?}"));
        ["LF.FZ", "LF.MX"].map(|l| rows[rows.len() - 1].loads_si[l])
    };
    let plain = [2e3, 3.0];
    let named = "columns = { \"LF.FZ\" = \"axle (front)\" }\n";
    let below = "run,axle (front),LF.MX\n-,N,N m\nR1,2000,3\n";
    assert_eq!(si(below, named), plain);
    let square = "columns = { \"LF.FZ\" = \"axle [front]\" }\n";
    assert_eq!(si("run,axle [front],LF.MX\nR1,2,3\n", square), plain);
    assert_eq!(si("run,LF.FZ,LF.MX\nunit,N,N m\nR1,2000,3\n", ""), plain);
    // A run without loads is no row of units.
    let bare = "LF.FZ,LF.MX,run\n,,R0\n2,3,R1\n";
    assert_eq!(si(bare, ""), plain);
    assert_eq!(runs_of(bare, "").unwrap().len(), 2);
    let said = |table: &str, more: &str| runs_of(table, more).unwrap_err()[0].to_string();
    let stated = format!("{named}units = {{ force = \"kN\" }}\n");
    for (table, more, wrong) in [
        (
            below,
            stated.as_str(),
            "the column says `N`, the job says `kN`",
        ),
        (
            "run,LF.FZ,LF.MX\n-,kg,N m\nR1,2,3\n",
            "",
            "`kg` is no unit of force",
        ),
        (
            "run,LF.FZ [kg],LF.MX\n-,kN,N m\nR1,2,3\n",
            "",
            "`kg` beside the name, `kN` in the row of units below",
        ),
        // Noise in kN, or as the column in N?
        (
            "run,LF.FZ [N],LF.MX\nR1,2000,3\n",
            "noise = { force = 50.0 }\n",
            "runs.noise.force: is 50 in `kN` or",
        ),
    ] {
        let said = said(table, more);
        assert!(said.contains(wrong), "{said}");
    }
    let both = "units = { force = \"N\" }\nnoise = { force = 50.0 }\n";
    assert_eq!(si("run,LF.FZ [N],LF.MX\nR1,2000,3\n", both), plain);
}

#[test]
fn labels_and_units_of_gauges_are_told_apart() {
    let read = |text: &str, gauges: &[&str]| {
        let gauges: Vec<String> = gauges.iter().map(|g| (*g).to_owned()).collect();
        strain_text::strain_from_text("s.csv", text, &gauges)
    };
    for gauges in [&["SG1 (left)"][..], &[]] {
        for (text, microstrain) in [
            ("run,SG1 (left)\n-,mm/m\nR1,0.5\n", 500.0),
            ("run,SG1 (left)\nunit,[mm/m]\nR1,0.5\n", 500.0),
            ("run,SG1 (left) (mm/m)\nR1,0.5\n", 500.0),
            ("run,SG1 (left)\nR1,0.5\n", 0.5),
        ] {
            let t = read(text, gauges).unwrap_or_else(|f| panic!("{text}: {f:?}"));
            assert_eq!(t.gauges, ["SG1 (left)"], "{text}");
            assert_eq!(t.microstrain, [microstrain], "{text}");
        }
    }
    // Another column beside the gauge's own.
    let raw = read("run,P01,P01 (raw)\nR1,0.5,7\n", &["P01"]).unwrap();
    assert_eq!(raw.gauges, ["P01", "P01 (raw)"]);
    let two = [
        Column::of_channel("P01", "um/m"),
        Column::of_channel("P01", "raw"),
    ];
    let found = find_gauge_columns("r.mf4", &two, &["P01".to_owned()]).unwrap();
    assert_eq!(of_gauges(&found), [("P01", Some(1.0)), ("P01 [raw]", None)]);
    // No strain, whether gauges are known or not.
    for gauges in [&["G1"][..], &[]] {
        for text in [
            "run,G1\n-,mV/V\nR1,1\n",
            "run,G1 (mV/V)\nR1,1\n",
            "run,G1 [mV/V]\nR1,1\n",
        ] {
            let said = read(text, gauges).unwrap_err()[0].to_string();
            assert!(said.contains("G1: `mV/V` is no unit of strain"), "{said}");
        }
    }
    let both = read("run,G1 [mV/V]\n-,um/m\nR1,1\n", &["G1"]);
    assert!(both.unwrap_err()[0].wrong.contains("`mV/V`"));
    // A run without a reading is no row of units.
    let bare = read("G1,run\n,R1\n3,R2\n", &["G1"]).unwrap();
    assert_eq!(
        bare.rows,
        strain_table::StrainRows::Runs(vec!["R1".into(), "R2".into()])
    );
}

fn of_gauges(columns: &[StrainColumn]) -> Vec<(&str, Option<f64>)> {
    let each = columns.iter();
    each.map(|c| (c.name.as_str(), c.microstrain)).collect()
}

/// Names of the columns of a text with this header, and what a 1 in each is in microstrain.
fn columns_of_text(header: &str, gauges: &[String]) -> Result<Vec<(String, f64)>, Faults> {
    let ones = header.split(',').map(|_| ",1").collect::<String>();
    let text = format!("run,{header}\nR1{ones}\n");
    let table = strain_text::strain_from_text("s.csv", &text, gauges)?;
    Ok(table.gauges.into_iter().zip(table.microstrain).collect())
}

#[test]
fn a_table_and_a_record_give_one_verdict_on_a_header() {
    let gauges = |list: &[&str]| -> Vec<String> { list.iter().map(|g| (*g).into()).collect() };
    for (header, wanted, expected) in [
        (
            "P01 [um/m],P01 (raw)",
            &["P01"][..],
            Some([("P01", 1.0), ("P01 (raw)", 1.0)]),
        ),
        (
            "P01,P02 [mm/m]",
            &["P01"],
            Some([("P01", 1.0), ("P02", 1e3)]),
        ),
        // The gauge's name holds a bracket, written with a blank or without.
        (
            "SG1(left),SG1(right)",
            &["SG1(left)", "SG1(right)"],
            Some([("SG1(left)", 1.0), ("SG1(right)", 1.0)]),
        ),
        (
            "SG1 (left),SG1 (t)",
            &["SG1(left)", "SG1 (t)"],
            Some([("SG1(left)", 1.0), ("SG1 (t)", 1.0)]),
        ),
        (
            "SG1 (t),SG1 (left)",
            &[],
            Some([("SG1 (t)", 1.0), ("SG1 (left)", 1.0)]),
        ),
        ("P01 (raw),P01 (kN)", &["P01"], None),
        ("P01 [um/m],P01 [mm/m]", &["P01"], None),
    ] {
        let gauges = gauges(wanted);
        let columns: Vec<Column> = header.split(',').map(name_and_unit).collect();
        let of_record = find_gauge_columns("r.csv", &columns, &gauges);
        let of_text = columns_of_text(header, &gauges);
        let Some(expected) = expected else {
            assert!(of_record.is_err() && of_text.is_err(), "{header}");
            continue;
        };
        let of_record = of_record.unwrap_or_else(|f| panic!("{header}: {f:?}"));
        let named = expected.map(|(name, scale)| (name, Some(scale)));
        assert_eq!(of_gauges(&of_record), named, "{header}");
        let of_text = of_text.unwrap_or_else(|f| panic!("{header}: {f:?}"));
        let named = expected.map(|(name, scale)| (name.to_owned(), scale));
        assert_eq!(of_text, named, "{header}");
    }
}

#[test]
fn where_no_gauges_are_known_a_unit_of_anything_else_is_no_strain() {
    for header in ["torque (N m)", "torque (kNm)", "G1 [mV/V]", "way (mm)"] {
        let said = columns_of_text(header, &[]).unwrap_err()[0].to_string();
        assert!(said.contains("is no unit of strain"), "{said}");
        // A record holds other channels too: they are left out.
        let column = [name_and_unit(header)];
        let found = find_gauge_columns("r.parquet", &column, &[]).unwrap();
        assert_eq!(found[0].microstrain, None, "{header}");
    }
}

#[test]
fn units_that_contradict_each_other_are_faults_of_what_is_asked_for() {
    let read = |text: &str, gauges: &[&str]| {
        let gauges: Vec<String> = gauges.iter().map(|g| (*g).to_owned()).collect();
        strain_text::strain_from_text("s.csv", text, &gauges)
    };
    let text = "run,G1 [m/m],G2 [um/m]\n-,um/m,microstrain\nR1,1,2\n";
    for gauges in [&["G1", "G2"][..], &["G1 [m/m]", "G2"], &[]] {
        let said = read(text, gauges).unwrap_err()[0].to_string();
        let wrong = "G1 [m/m]: `m/m` beside the name, `um/m` in the row of units below";
        assert!(said.contains(wrong), "{said}");
    }
    let table = read(text, &["G2"]).unwrap();
    assert_eq!(table.gauges[1], "G2");
    assert_eq!(table.microstrain[1], 2.0);
    let said = read("time [s],G1\nms,um/m\n0,1\n1,2\n", &["G1"]).unwrap_err()[0].to_string();
    assert!(said.contains("`s` beside the name, `ms` in"), "{said}");
    // A millionth of a meganewton is not a millinewton.
    for [beside, below] in [["MN", "mN"], ["N", "kN"]] {
        let table = format!("run,LF.FZ [{beside}],LF.MX\n-,{below},N m\nR1,2,3\n");
        let named = format!("columns = {{ \"LF.FZ\" = \"LF.FZ [{beside}]\" }}\n");
        for more in ["", &named] {
            let said = runs_of(&table, more).unwrap_err()[0].to_string();
            let wrong = format!("`{beside}` beside the name, `{below}` in the row of units below");
            assert!(said.contains(&wrong), "{said}");
        }
    }
}

#[test]
fn a_column_of_runs_that_is_written_otherwise_is_asked_for() {
    let said = strain_text::strain_from_text("s.csv", "Run,G1\nR1,2\n", &["G1".to_owned()]);
    let said = said.unwrap_err()[0].to_string();
    assert!(said.contains("did you mean `Run` for `run`?"), "{said}");
    let said = runs_of("Runs,LF.FZ\nR1,2\n", "").unwrap_err()[0].to_string();
    assert!(said.contains("did you mean `Runs` for `run`?"), "{said}");
    let said = strain_text::strain_from_text("s.csv", "a,b\n1,2\n", &[]).unwrap_err();
    assert!(!said[0].to_string().contains("did you mean"), "{said:?}");
}

#[test]
fn a_row_of_units_tells_which_of_two_columns_holds_a_load() {
    let table = "run,LF.FZ [kN],LF.FZ (raw),LF.MX\n-,kN,V,N m\nR1,2,9,3\n";
    let rows = runs_of(table, "").unwrap();
    assert_eq!(rows[0].loads_si["LF.FZ"], 2e3);
    let twice = "run,LF.FZ [kN],LF.FZ [N],LF.MX\nR1,2,2000,3\n";
    let said = runs_of(twice, "").unwrap_err()[0].to_string();
    assert!(said.contains("two columns hold `LF.FZ`"), "{said}");
}

#[test]
fn a_channel_that_is_ignored_is_not_asked_for_its_unit() {
    let files = crate::app::context::InMemory::default()
        .with("s.csv", "run,G1,G2 [mV/V]\nR1,1,2\nR2,2,3\n");
    let job = read_text(
        "units = \"m-kg-s\"\n[model]\ndeck = \"d.bdf\"\n[[load]]\nname = \"a\"\ngrid = 1\ncomponent = \"FZ\"\n[[gauge]]\nname = \"G1\"\nelement = 1\n\
         [[gauge]]\nname = \"G2\"\nelement = 2\n[measured]\nstrain = \"s.csv\"\n\
         [[correction]]\ngauge = \"G2\"\nignore = true\n",
    )
    .unwrap();
    let measured = job.measured.as_ref().unwrap();
    let mut inputs = Inputs::of(&files);
    let wanted = strain_file::wanted_columns(&mut inputs, &job);
    let table = strain_file::read_strain(&mut inputs, &job, &measured.strain, &wanted).unwrap();
    assert_eq!(table.gauges, ["G1", "G2"]);
    assert!(table.row(0)[0] == 1.0 && table.row(0)[1].is_nan());
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
        let asks = |t: &String| t.contains("1500 %") && t.contains("Write 0.15 for 15 %");
        assert!(found.iter().any(asks), "{key}: {found:?}");
        for size in ["-0.1", "1e6"] {
            assert!(!of(size).is_empty(), "{key} {size}");
        }
    }
    // A size in microstrain or degrees is no fraction.
    for kind in ["absolute-normal", "angle"] {
        let text = format!("{head}{}", study(kind).replace("SIZE", "15"));
        let found = read_text(&text).err().map(Faults::into_list);
        let sizes = found.iter().flatten();
        assert!(sizes.filter(|f| f.field == "study.errors.size").count() == 0);
    }
}
