//! Files that `place` and `recover` write for other programs, and records from other programs.

use crate::plate::{NoFiles, deck};
use crate::python::read_by;
use nastran::bdf::read_deck;
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Number of samples of the record, and the time between them in s.
const N: usize = 3000;
const DT: f64 = 0.01;
const LOADS: [&str; 3] = ["A.FZ", "B.FX", "C.MX"];

/// Returns the loads at sample `i`, N and N mm: whole periods of sines of different lengths, and a constant.
fn truth(i: usize) -> [f64; 3] {
    let t = i as f64 * DT;
    [
        40.0 + 100.0 * (TAU * t / 3.0).sin(),
        50.0 * (TAU * t / 1.5).cos(),
        300.0,
    ]
}

const JOB: &str = r#"title = "Folded plate"
units = "mm-t-s"
[model]
deck = "model.bdf"
mesh_error = false
[[load]]
name = "A.FZ"
grid = 3
component = "FZ"
expected = 100.0
[[load]]
name = "B.FX"
grid = 11
component = "FX"
expected = 50.0
[[load]]
name = "C.MX"
grid = 13
component = "MX"
expected = 300.0
[placement]
gauges = 6
spacing = 5.0
[measured]
strain = "STRAIN"
[gauges]
file = "gauges.csv"
"#;

pub fn strainbridge(arguments: &[&str]) -> Value {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .args(["--no-cache", "--json"])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(0), "{error}");
    serde_json::from_slice(&done.stdout).unwrap()
}

pub fn job(dir: &Path, name: &str, strain: &str) -> String {
    let path = dir.join(name);
    std::fs::write(&path, JOB.replace("STRAIN", strain)).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Creates a folder with the plate, its placed gauges, their S, and the strain of the true loads in `strain.csv` and
/// `runs.csv`.
pub fn plate(name: &str) -> PathBuf {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("exchange")
        .join(name);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    std::fs::write(dir.join("model.bdf"), deck()).unwrap();
    let first = dir.join("first.toml");
    let without = JOB.replace("[gauges]\nfile = \"gauges.csv\"\n", "");
    std::fs::write(&first, without.replace("STRAIN", "none.csv")).unwrap();
    strainbridge(&["place", first.to_str().unwrap()]);
    std::fs::copy(dir.join("first.out/gauges.csv"), dir.join("gauges.csv")).unwrap();
    let s = std::fs::read_to_string(dir.join("first.out/sensitivity.csv")).unwrap();
    let rows: Vec<(String, Vec<f64>)> = s
        .lines()
        .skip(1)
        .map(|l| {
            let mut f = l.split(',');
            let name = f.next().unwrap().to_owned();
            (name, f.map(|v| v.parse().unwrap()).collect())
        })
        .collect();
    let names: Vec<&str> = rows.iter().map(|r| r.0.as_str()).collect();
    let strain_of = |f: [f64; 3]| -> String {
        rows.iter()
            .map(|(_, s)| format!(",{:?}", s.iter().zip(f).map(|(a, b)| a * b).sum::<f64>()))
            .collect()
    };
    let mut record = format!("time,{}\n", names.join(","));
    for i in 0..N {
        record += &format!("{:?}{}\n", i as f64 * DT, strain_of(truth(i)));
    }
    std::fs::write(dir.join("strain.csv"), &record).unwrap();
    std::fs::write(dir.join("strain_real.csv"), &record).unwrap();
    let mut runs = format!("run,{}\n", names.join(","));
    for i in [10, 200] {
        runs += &format!("R{i}{}\n", strain_of(truth(i)));
    }
    std::fs::write(dir.join("runs.csv"), runs).unwrap();
    dir
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or(f64::NAN)
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array()
        .map_or(Vec::new(), |l| l.iter().map(number).collect())
}

fn assert_near(what: &str, got: f64, expected: f64, allowed: f64) {
    assert!(
        (got - expected).abs() <= allowed,
        "{what}: {got} for {expected}"
    );
}

#[test]
fn our_reader_gets_back_the_loads_of_every_run_from_force_moment_and_load() {
    let dir = plate("cards");
    strainbridge(&["recover", &job(&dir, "runs.toml", "runs.csv")]);
    let text = std::fs::read(dir.join("runs.out/loads.bdf")).unwrap();
    let read = read_deck(
        "loads.bdf",
        [b"BEGIN BULK\n".to_vec(), text].concat(),
        &mut NoFiles,
    );
    assert!(read.faults.is_empty(), "{:?}", read.faults);
    let c = &read.cards;
    assert_eq!((c.forces.len(), c.moments.len(), c.loads.len()), (2, 1, 2));
    for (load, i) in c.loads.iter().zip([10, 200]) {
        assert_eq!(load.card.terms.len(), truth(i).len());
        for (part, expected) in load.card.terms.iter().zip(truth(i)) {
            assert_near("run", load.card.scale * part.0, expected, 1e-6 * 300.0);
        }
    }
    assert_eq!(
        (c.forces[0].card.grid, c.forces[0].card.n),
        (3, [0.0, 0.0, 1.0])
    );
    assert_eq!(
        (c.forces[1].card.grid, c.forces[1].card.n),
        (11, [1.0, 0.0, 0.0])
    );
    assert_eq!(
        (c.moments[0].card.grid, c.moments[0].card.n),
        (13, [1.0, 0.0, 0.0])
    );
}

#[test]
fn pseudo_damage_of_sines_is_their_cycles_times_range_to_the_slope() {
    let dir = plate("damage");
    let result = strainbridge(&["recover", &job(&dir, "record.toml", "strain.csv")]);
    let damage = result["damage"].as_array().unwrap();
    assert_eq!(damage.len(), 3);
    // Load A has 10 periods of 3 s with a range of 200, minus half a cycle at the ends of the record. The ranges there
    // are below half of 200 and count for 2 (1/2)^5 / 2 of a cycle at most. Load B has 20 periods of 1.5 s with a range
    // of 100, from a peak to one sample before the last peak.
    let [a, b, c] = [0, 1, 2].map(|l| &damage[l]);
    let cycles = |d: &Value, range: f64| number(&d["damage"]) / range.powi(5);
    assert_near("A", cycles(a, 200.0), 9.5, 0.04);
    assert_near("B", cycles(b, 100.0), 20.0, 0.01);
    assert_near(
        "largest range of A",
        number(&a["largest_range"]),
        200.0,
        0.01,
    );
    // The constant moment has only rounding errors.
    assert!(number(&c["largest_range"]) < 1e-3 * 300.0);
    for d in [a, b] {
        assert!(number(&d["damage_low"]) < number(&d["damage"]));
        assert!(number(&d["damage"]) < number(&d["damage_high"]));
    }
    let table = std::fs::read_to_string(dir.join("record.out/rainflow.csv")).unwrap();
    let counted: f64 = table
        .lines()
        .filter(|l| l.starts_with("A.FZ"))
        .map(|l| l.split(',').nth(4).unwrap().parse::<f64>().unwrap())
        .sum();
    assert_near("rows of A", counted, number(&a["cycles"]), 1e-9);
}

#[test]
fn rpc3_file_and_pynastran_read_the_history_that_recover_writes() {
    let dir = plate("history");
    let result = strainbridge(&["recover", &job(&dir, "record.toml", "strain.csv")]);
    let out = dir.join("record.out");
    let paths =
        ["loads.rsp", "loads.bdf", "loads.xlsx"].map(|f| out.join(f).to_str().unwrap().to_owned());
    let Some(read) = read_by("read_exchange.py", &paths.each_ref().map(String::as_str)) else {
        return;
    };
    let rsp = &read["loads.rsp"];
    assert_eq!(rsp["samples"], N);
    for (l, name) in LOADS.iter().enumerate() {
        let channel = &rsp["channels"][l];
        assert_eq!(channel["name"], *name);
        assert_near("dt", number(&channel["dt"]), DT, 1e-9);
        let step = number(&channel["step"]);
        let data = numbers(&channel["data"]);
        assert_eq!(data.len(), N, "{name}");
        for (i, v) in data.iter().enumerate() {
            // Half a step, and 32-bit reals on the way.
            assert_near(name, *v, truth(i)[l], 0.5 * step + 1e-6 * 300.0);
        }
    }
    let bdf = &read["loads.bdf"];
    let dload = bdf["dloads"].as_object().unwrap().values().next().unwrap();
    assert_eq!(numbers(&dload[0][0]), [1.0; 3]);
    for (l, id) in numbers(&dload[0][1]).iter().enumerate() {
        let tload = &bdf["tloads"][(*id as u32).to_string()][0];
        let [excite, table] = [0, 1].map(|i| number(&tload[i]).to_string());
        let card = &bdf["forces"][&excite][0];
        assert_eq!(card[0], ["FORCE", "FORCE", "MOMENT"][l]);
        assert_eq!(number(&card[1]), [3.0, 11.0, 13.0][l]);
        let [times, values] = [0, 1].map(|i| numbers(&bdf["tables"][&table][i]));
        assert_eq!((times.len(), values.len()), (N, N));
        for (i, (t, v)) in times.iter().zip(&values).enumerate() {
            assert_near("time", *t, i as f64 * DT, 1e-8);
            assert_near("table", *v, truth(i)[l], 1e-6 * 300.0);
        }
    }
    let sheet = &read["loads.xlsx"]["Loads"];
    assert_eq!(sheet[1][0], "A.FZ");
    assert_near(
        "mean",
        number(&sheet[1][3]),
        number(&result["loads"][0]["value"]),
        1e-9,
    );
    let findings = read["loads.xlsx"]["Findings"].as_array().unwrap();
    let listed = result["findings"].as_array().unwrap();
    assert!(findings.len() > 1 && findings.len() <= listed.len() + 1);
}

#[test]
fn openpyxl_and_meshio_read_the_gauge_plan_and_the_loads_of_runs() {
    let dir = plate("tables");
    let result = strainbridge(&["recover", &job(&dir, "runs.toml", "runs.csv")]);
    let paths = [
        "first.out/gauges.xlsx",
        "first.out/gauges.vtu",
        "runs.out/loads.xlsx",
        "runs.out/loads.vtu",
    ]
    .map(|f| dir.join(f).to_str().unwrap().to_owned());
    let Some(read) = read_by("read_exchange.py", &paths.each_ref().map(String::as_str)) else {
        return;
    };
    let placed: Value =
        serde_json::from_str(&std::fs::read_to_string(dir.join("first.out/result.json")).unwrap())
            .unwrap();
    let gauges = placed["gauges"].as_array().unwrap();
    let sheet = read["gauges.xlsx"]["Gauges"].as_array().unwrap();
    assert_eq!(sheet.len(), 1 + gauges.len());
    let vtu = &read["gauges.vtu"];
    assert_eq!(vtu["cells"]["vertex"], gauges.len());
    for (i, g) in gauges.iter().enumerate() {
        let row = &sheet[i + 1];
        assert_eq!(
            (&row[0], &row[1], &row[2]),
            (&g["name"], &g["element"], &g["surface"])
        );
        for axis in 0..3 {
            assert_near(
                "x",
                number(&row[3 + axis]),
                number(&g["position"][axis]),
                1e-9,
            );
            let point = number(&vtu["points"][i][axis]);
            assert_near("point", point, number(&g["position"][axis]), 1e-9);
            let arrow = number(&vtu["point_data"]["axis"][i][axis]);
            // 32-bit reals.
            assert_near("axis", arrow, number(&g["direction"][axis]), 1e-6);
        }
        assert_near(
            "angle",
            number(&row[10]),
            number(&g["angle_seen_deg"]),
            1e-9,
        );
    }
    for name in ["Gluing sheet", "Sensitivity", "Units", "Findings"] {
        assert!(read["gauges.xlsx"][name].is_array(), "{name}");
    }
    let loads = result["loads"].as_array().unwrap();
    for (r, i) in [10, 200].into_iter().enumerate() {
        let row = &read["loads.xlsx"]["Loads"][r + 1];
        assert_eq!(row[0], format!("R{i}"));
        for l in 0..3 {
            assert_near(
                "sheet",
                number(&row[1 + 3 * l]),
                number(&loads[3 * r + l]["value"]),
                1e-9,
            );
        }
        let arrows = &read["loads.vtu"]["point_data"];
        let force = &arrows[format!("force R{i}")];
        assert_near("arrow", number(&force[0][2]), truth(i)[0], 1e-6 * 300.0);
        assert_near("arrow", number(&force[1][0]), truth(i)[1], 1e-6 * 300.0);
        let moment = &arrows[format!("moment R{i}")];
        assert_near("arrow", number(&moment[2][0]), truth(i)[2], 1e-6 * 300.0);
    }
}

#[test]
fn records_that_rpc3_file_writes_give_the_same_loads_as_the_table_they_come_from() {
    let dir = plate("records");
    let paths = ["strain.csv", "strain_real.csv"].map(|f| dir.join(f).to_str().unwrap().to_owned());
    let Some(_) = read_by("read_exchange.py", &paths.each_ref().map(String::as_str)) else {
        return;
    };
    let expected = strainbridge(&["recover", &job(&dir, "csv.toml", "strain.csv")]);
    // 16 bits of the largest strain give an error of some thousandths of the largest load, 32-bit reals some
    // millionths.
    for (file, allowed) in [("strain.rsp", 3e-3), ("strain_real.rsp", 3e-5)] {
        let got = strainbridge(&["recover", &job(&dir, "rpc.toml", file)]);
        assert_eq!(got["samples"], N);
        for l in 0..3 {
            for key in ["value", "min", "max"] {
                let [a, b] = [&got, &expected].map(|r| number(&r["loads"][l][key]));
                assert_near(key, a, b, allowed * 300.0);
            }
        }
    }
}

#[cfg(all(feature = "mdf", feature = "parquet"))]
#[test]
fn records_that_pyarrow_and_asammdf_write_give_the_same_loads_as_the_table_they_come_from() {
    let dir = plate("foreign");
    let path = dir.join("strain.csv");
    if read_by("read_records.py", &[path.to_str().unwrap()]).is_none() {
        return;
    }
    let expected = strainbridge(&["recover", &job(&dir, "csv.toml", "strain.csv")]);
    // 64-bit reals give equal values. 32-bit reals give errors of some millionths.
    for (file, allowed) in [
        ("strain.parquet", 1e-9),
        ("strain_odd.parquet", 3e-5),
        ("strain.mf4", 1e-9),
        ("strain_packed.mf4", 1e-9),
    ] {
        let got = strainbridge(&["recover", &job(&dir, "foreign.toml", file)]);
        assert_eq!(got["samples"], N, "{file}");
        for l in 0..3 {
            for key in ["value", "min", "max"] {
                let [a, b] = [&got, &expected].map(|r| number(&r["loads"][l][key]));
                assert_near(key, a, b, allowed * 300.0);
            }
        }
    }
    let out = dir.join("csv.out/loads.parquet");
    let Some(read) = read_by("read_records.py", &[out.to_str().unwrap()]) else {
        return;
    };
    let columns = &read["loads.parquet"]["columns"];
    for (l, name) in LOADS.iter().enumerate() {
        let values = numbers(&columns[*name]);
        assert_eq!(values.len(), N);
        for (i, v) in values.iter().enumerate() {
            // 32-bit reals.
            assert_near(name, *v, truth(i)[l], 1e-6 * 300.0);
        }
    }
    let times = numbers(&columns["time"]);
    assert_near("time", times[N - 1], (N - 1) as f64 * DT, 1e-9);
    assert_eq!(read["loads.parquet"]["notes"]["unit of A.FZ"], "N");
}

#[cfg(not(any(feature = "mdf", feature = "parquet")))]
#[test]
fn a_build_that_does_not_read_a_kind_of_file_states_the_remedy() {
    let dir = plate("refused");
    for (file, begin, feature) in [
        ("a.parquet", &b"PAR1...."[..], "parquet"),
        ("a.mf4", b"MDF     4.10    ", "mdf"),
    ] {
        std::fs::write(dir.join(file), begin).unwrap();
        let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args(["recover", &job(&dir, "refused.toml", file)])
            .output()
            .unwrap();
        assert_eq!(done.status.code(), Some(2));
        let error = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(error.contains(&format!("--features {feature}")), "{error}");
    }
}
