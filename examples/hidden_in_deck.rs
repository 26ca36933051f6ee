//! Hides effects in a frame that is solved on a mesh four times finer than the analyst's mesh. `reconcile` then searches for them with the analyst's
//! deck only.
//!
//! `cargo build --release && cargo run --release --example hidden_in_deck [SEEDS] [EFFECT,EFFECT..]` prints one row for each effect: five sizes, one
//! seed by default. The deck and its gauges are from `../shared/hidden_effects/deck/dev-f1`. Loads, noise, background and effect are new in every
//! case. The background is 1 % of gain scatter, 1 degree of placement scatter, coefficient errors of a fraction of a percent, and the mesh. Cases
//! without a correct result are listed on standard error.
#![allow(clippy::print_stdout, clippy::print_stderr)]

#[path = "../tests/reconcile/hidden/mod.rs"]
#[allow(
    dead_code,
    reason = "the other example judges outcomes, this one result files"
)]
mod hidden;

use hidden::generator::{Background, EFFECTS, Hidden, hide};
use nastran::bdf::{Deck, MemoryLoader, read_deck};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use strainbridge::fe::strain_tensor::Surface;
use strainbridge::fe::{SolveOptions, UnitLoad, solve_unit_loads};
use strainbridge::gauge::{
    Bridge, CornerRows, Gauge, GaugeSpec, Pair, build, gauge_reading, on_refined,
};
use strainbridge::model::{Model, Vec3};
use strainbridge::reconcile::Observations;
use strainbridge::reconcile::strain::{
    GaugeFacts, MassSignature, PayloadWeight, StiffnessOf, StiffnessSignature, StrainFrame,
    WheelForces, Wiring,
};

/// Wheels in the order of the case's files, with their grids.
const WHEELS: [(&str, u32); 6] = [
    ("RR", 9006),
    ("RM", 9004),
    ("RF", 9002),
    ("LF", 9001),
    ("LM", 9003),
    ("LR", 9005),
];
const PAYLOAD: u32 = 9101;
const PLACES: [(&str, u32); 4] = [
    ("front", 9201),
    ("mid_left", 9202),
    ("mid_right", 9203),
    ("rear", 9204),
];
/// Zones that are tried, with their properties, one zone for each size.
const ZONES: [(&str, u32); 5] = [("L2", 12), ("R4", 24), ("L4", 14), ("R2", 22), ("L3", 13)];
const NOMINAL_X_M: f64 = 5.2;
const GRAVITY: f64 = 9.81;
/// Strain of a free quarter bridge, microstrain per degree, as in the job.
const PER_DEGREE: f64 = 1.404;
/// Factor from kN and kN m to N and N mm.
const KILO: f64 = 1e3;
const MICRO: f64 = 1e6;

fn deck(text: &str) -> Deck {
    let mut none = MemoryLoader::default();
    read_deck("nominal.bdf", text.as_bytes().to_vec(), &mut none)
}

/// Returns the deck with a property's thickness times `factor`.
fn thicken_property(text: &str, property: u32, factor: f64) -> String {
    // The deck is in fields of eight columns.
    let change = |line: &str| {
        let field = |k: usize| line.get(8 * k..8 * k + 8).unwrap_or_default().trim();
        if field(0) == "PSHELL" && field(1) == property.to_string() {
            let t: f64 = field(3).parse().expect("a thickness");
            format!("{}{:<8.5}{}", &line[..24], t * factor, &line[32..])
        } else {
            line.to_owned()
        }
    };
    let out: Vec<String> = text.lines().map(change).collect();
    assert_ne!(out.join("\n").trim(), text.trim(), "property {property}");
    out.join("\n")
}

struct Glued {
    name: String,
    full: bool,
    place: [f64; 3],
    element: u32,
    surface: Surface,
    direction: Vec3,
    angle_deg: f64,
    other: Option<(u32, Surface)>,
}

fn read_glued_gauges(csv: &str) -> Vec<Glued> {
    let side = |s: &str| {
        if s == "bottom" {
            Surface::Bottom
        } else {
            Surface::Top
        }
    };
    let row = |line: &str| {
        let f: Vec<&str> = line.split(',').collect();
        let number = |i: usize| f[i].parse::<f64>().expect("a number");
        Glued {
            name: f[0].into(),
            full: f[4] == "full-bending",
            place: [number(1), number(2), number(3)],
            element: f[7].parse().expect("an element"),
            surface: side(f[8]),
            direction: Vec3::new(number(9), number(10), number(11)),
            angle_deg: number(5),
            other: f
                .get(12)
                .and_then(|e| e.parse().ok())
                .map(|e| (e, side(f[13]))),
        }
    };
    csv.lines().skip(1).map(row).collect()
}

fn build_gauge(model: &Model, g: &Glued, degrees: f64) -> Gauge {
    let shell = model.shell_ix(g.element).expect("the element");
    let spec = GaugeSpec {
        surface: Some(g.surface),
        direction: Some(g.direction),
        angle_rad: (g.angle_deg + degrees).to_radians(),
        bridge: if g.full {
            Bridge::FullBending
        } else {
            Bridge::Quarter
        },
        pair: g
            .other
            .map(|(e, s)| Pair::with_parallel_axis(model.shell_ix(e).expect("the element"), s)),
        ..GaugeSpec::place_on_shell(g.name.clone(), shell)
    };
    let built = build(model, &spec, CornerRows::Absent).expect("a gauge");
    built.0.into_iter().next().expect("one channel")
}

/// Returns microstrain by gauge and load, on the mesh divided twice.
fn truth_of(text: &str, gauges: &[Glued], loads: &[(u32, usize, f64)], degrees: f64) -> Vec<f64> {
    let deck = deck(text);
    let model = Model::from_deck(&deck).0;
    let once = model.refine_shells().expect("the mesh can be divided");
    let twice = once.model.refine_shells().expect("and again");
    let unit = |(grid, dof, size): &(u32, usize, f64)| {
        let mut v = Vec3::zeros();
        v[dof % 3] = *size;
        let (force, moment) = if *dof < 3 {
            (v, Vec3::zeros())
        } else {
            (Vec3::zeros(), v)
        };
        UnitLoad::AtGrid {
            grid: twice.model.grid_ix(*grid).expect("the grid"),
            force,
            moment,
        }
    };
    let loads: Vec<UnitLoad> = loads.iter().map(unit).collect();
    let solved = solve_unit_loads(&twice.model, &loads, &SolveOptions::default()).expect("solved");
    let mut out = Vec::new();
    for g in gauges {
        let coarse = build_gauge(&model, g, degrees);
        let finer = on_refined(&coarse, &model, &once).expect("on the finer mesh");
        let finest = on_refined(&finer, &once.model, &twice).expect("on the finest mesh");
        let cases = solved.0.cases.iter();
        out.extend(cases.map(|c| MICRO * gauge_reading(&finest, c).expect("a reading")));
    }
    out
}

/// Returns the true frame. Columns: wheels, payload weight, its moments for a metre, then side loads and masses.
fn truth(text: &str, gauges: &[Glued], runs: &str) -> StrainFrame {
    let weight = GRAVITY;
    let mut loads: Vec<(u32, usize, f64)> = WHEELS.iter().map(|w| (w.1, 2, KILO)).collect();
    // Payload columns: per kg at the nominal place, per kg and m forward, per kg and m to the left (N mm).
    loads.push((PAYLOAD, 2, -weight));
    loads.push((PAYLOAD, 4, weight * KILO));
    loads.push((PAYLOAD, 3, -weight * KILO));
    let n_l = WHEELS.len();
    let columns = |all: &[f64], n: usize, g: usize| -> Vec<f64> {
        let mut row = all[g * n..g * n + n_l + 3].to_vec();
        row.push(0.0);
        row
    };
    let mut all_loads = loads.clone();
    let mut other_names = Vec::new();
    for (wheel, grid) in WHEELS {
        for (name, dof) in [("FX", 0), ("FY", 1), ("MX", 3), ("MY", 4), ("MZ", 5)] {
            other_names.push(format!("{name}_{wheel}"));
            all_loads.push((grid, dof, if dof < 3 { KILO } else { KILO * KILO }));
        }
    }
    all_loads.extend(PLACES.iter().map(|p| (p.1, 2, -weight)));
    let all = truth_of(text, gauges, &all_loads, 0.0);
    let [at_45, at_90] = [45.0, 90.0].map(|d| truth_of(text, gauges, &loads, d));
    let (n, n_9) = (all_loads.len(), loads.len());
    let influence: Vec<f64> = (0..gauges.len())
        .flat_map(|g| columns(&all, n, g))
        .collect();
    let zone = |(zone, property): &(&str, u32), size: f64| {
        let change = |percent: f64| {
            let changed = thicken_property(text, *property, 1.0 + percent / 100.0);
            let now = truth_of(&changed, gauges, &loads, 0.0);
            let now = (0..gauges.len()).flat_map(|g| columns(&now, n_9, g));
            let change = now.zip(&influence).map(|(a, b)| a - b).collect();
            (percent, change)
        };
        StiffnessSignature {
            of: StiffnessOf::Zone,
            place: zone.to_string(),
            at_percent: vec![change(-size), change(size)],
            prior_percent: 15.0,
        }
    };
    let sizes = EFFECTS
        .iter()
        .find(|e| e.0 == "rail_stiffness")
        .expect("the effect")
        .1;
    let stiffness = ZONES.iter().zip(sizes).map(|(z, s)| zone(z, s)).collect();
    let column = |k: usize| {
        (0..gauges.len())
            .map(|g| all[g * n + k])
            .collect::<Vec<f64>>()
    };
    let rows: Vec<Vec<f64>> = runs
        .lines()
        .skip(1)
        .map(|l| {
            l.split(',')
                .skip(1)
                .map(|v| v.parse().expect("a number"))
                .collect()
        })
        .collect();
    StrainFrame {
        rules: Default::default(),
        stop: Default::default(),
        observations: Observations {
            channels: gauges.iter().map(|g| g.name.clone()).collect(),
            runs: (1..=rows.len()).map(|r| format!("R{r:02}")).collect(),
            values: vec![0.0; rows.len() * gauges.len()],
            held_out: (1..=rows.len()).map(|r| r > 10).collect(),
        },
        gauges: gauges
            .iter()
            .map(|g| GaugeFacts {
                name: g.name.clone(),
                wiring: if g.full {
                    Wiring::Bending
                } else {
                    Wiring::Quarter
                },
                angle_deg: 0.0,
                position: Some(g.place),
            })
            .collect(),
        moments: Vec::new(),
        load_names: WHEELS.iter().map(|w| format!("{}.FZ", w.0)).collect(),
        load_positions: None,
        tensors: (0..gauges.len())
            .map(|g| {
                let plane = |c: usize| {
                    let (x, d, y) = (all[g * n + c], at_45[g * n_9 + c], at_90[g * n_9 + c]);
                    [x, y, 2.0 * d - x - y]
                };
                let mut row: Vec<[f64; 3]> = (0..n_9).map(plane).collect();
                row.push([0.0; 3]);
                row
            })
            .collect(),
        per_mm: None,
        loads: rows.iter().flat_map(|r| r[2..8].to_vec()).collect(),
        payload: rows
            .iter()
            .map(|r| [r[0], r[1] - NOMINAL_X_M, 0.0])
            .collect(),
        payload_origin: [NOMINAL_X_M, 0.0],
        payload_weight: PayloadWeight::InModel,
        wheel_forces: WheelForces::Measured,
        nuisance: Vec::new(),
        ground: 0.0,
        other_loads: other_names
            .into_iter()
            .enumerate()
            .map(|(k, name)| (name, column(n_9 + k)))
            .collect(),
        thermal_uniform: Some(
            gauges
                .iter()
                .map(|g| if g.full { 0.0 } else { PER_DEGREE })
                .collect(),
        ),
        thermal_gradient: None,
        masses: PLACES
            .iter()
            .enumerate()
            .map(|(k, p)| MassSignature {
                place: p.0.into(),
                per_kg: column(n - PLACES.len() + k),
            })
            .collect(),
        stiffness,
        noise: 1.5,
        gauge_noise: None,
        load_noise: 0.06,
        model_rel: 0.0,
        coefficient_rel: 0.0,
        as_modelled: None,
        scatter: Vec::new(),
        learnt: None,
        influence,
    }
}

/// Writes the case and a job that uses the analyst's deck; returns the path of the job.
fn write(case: &Hidden, shared: &Path, folder: &Path) -> PathBuf {
    let f = &case.frame;
    let n_g = f.n_gauges();
    let mut strain = format!("run,{}\n", f.observations.channels.join(","));
    let mut runs = String::from("run,payload_kg,payload_x_m");
    for w in WHEELS {
        let _ = write!(runs, ",FZ_{}_kN", w.0);
    }
    for (r, run) in f.observations.runs.iter().enumerate() {
        let row = &f.observations.values[r * n_g..(r + 1) * n_g];
        let cells: Vec<String> = row.iter().map(|v| format!("{v:.3}")).collect();
        let _ = writeln!(strain, "{run},{}", cells.join(","));
        let _ = write!(
            runs,
            "\n{run},{:.3},{:.5}",
            f.payload[r][0],
            NOMINAL_X_M + f.payload[r][1]
        );
        for v in &f.loads[r * f.n_loads()..(r + 1) * f.n_loads()] {
            let _ = write!(runs, ",{v:.5}");
        }
    }
    let there = shared.display().to_string().replace('\\', "/");
    let mut job = std::fs::read_to_string(shared.join("job.toml"))
        .expect("the job")
        .replace("nominal.bdf", &format!("{there}/nominal.bdf"))
        .replace("gauges.csv", &format!("{there}/gauges.csv"))
        .replace(
            "noise_microstrain = 1.5",
            &format!("noise_microstrain = {}", f.noise),
        )
        .replace(
            "model_uncertainty_rel = 0.02",
            "model_uncertainty_rel = 0.01",
        )
        // The tolerance that the job declares is the placement scatter of the background.
        .replace(
            "[reconcile]\n",
            "[reconcile]\ntolerance = { angle_deg = 1.0 }\n",
        );
    if f.payload_weight == PayloadWeight::Missing {
        job = job.replace("weight_in_model = true", "weight_in_model = false");
    }
    if f.wheel_forces == WheelForces::FlatGroundModel {
        job = job.replace("\"measured\"", "\"flat_ground_model\"");
    }
    std::fs::create_dir_all(folder).expect("a folder");
    for (name, text) in [
        ("strain.csv", &strain),
        ("runs.csv", &runs),
        ("job.toml", &job),
    ] {
        std::fs::write(folder.join(name), text).expect("written");
    }
    folder.join("job.toml")
}

fn kinds(ids: &[String]) -> Vec<&str> {
    let mut out: Vec<&str> = ids.iter().filter_map(|i| i.split(':').next()).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Returns the score (`named`, `rival`, `none`, `unknown`, `false`) and the share of the gap that is explained.
fn score_answer(case: &Hidden, result: &Value) -> (&'static str, f64) {
    let texts = |v: &Value| -> Vec<String> {
        let list = v.as_array().into_iter().flatten();
        list.filter_map(|n| n.as_str().map(str::to_owned)).collect()
    };
    let named = texts(&result["named"]);
    let share = result["gap"]["explained_share"].as_f64().unwrap_or(0.0);
    let want = kinds(&case.truth);
    let rivals = result["rivals"].as_array().into_iter().flatten();
    let listed = rivals.clone().any(|r| {
        let ids = match &r["ids"] {
            Value::Array(_) => texts(&r["ids"]),
            _ => vec![r["id"].as_str().unwrap_or_default().to_owned()],
        };
        kinds(&ids) == want
    });
    let verdict = result["verdict"].as_str().unwrap_or_default();
    let word = match verdict {
        "named" if kinds(&named) == want => "named",
        "named" if listed => "rival",
        "named" => "false",
        "unknown" if want == ["unknown"] => "named",
        "unknown" => "unknown",
        _ if want == ["none"] => "named",
        _ => "none",
    };
    (word, share)
}

fn main() {
    let Some(dir) = hidden::find_shared_folder() else {
        eprintln!("../shared/hidden_effects is absent");
        return;
    };
    let here = std::env::current_exe().expect("this program has a path");
    let program = here
        .ancestors()
        .nth(2)
        .expect("the folder above examples")
        .join(format!("strainbridge{}", std::env::consts::EXE_SUFFIX));
    assert!(
        program.exists(),
        "build the program first: cargo build --release"
    );
    let dir = dir.join("deck/dev-f1").canonicalize().expect("the case");
    let args: Vec<String> = std::env::args().collect();
    let seeds: u64 = args.get(1).and_then(|a| a.parse().ok()).unwrap_or(1);
    let only = args.get(2).cloned().unwrap_or_default();
    let read = |name: &str| std::fs::read_to_string(dir.join(name)).expect("the file");
    let gauges = read_glued_gauges(&read("gauges.csv"));
    let base = truth(&read("nominal.bdf"), &gauges, &read("runs.csv"));
    let folder = std::env::temp_dir().join("strainbridge_hidden_in_deck");
    let mut effects: Vec<(&str, [f64; 5])> = vec![("none", [0.0; 5])];
    effects.extend(EFFECTS.iter().filter(|e| e.0 != "thermal_gradient"));
    println!("| effect | cases | named | rival named | none | unknown | false | gap closed |");
    println!("|---|---|---|---|---|---|---|---|");
    for (effect, sizes) in effects {
        if !only.is_empty() && !only.split(',').any(|o| o == effect) {
            continue;
        }
        let mut counts = [0usize; 5];
        let (mut shares, mut n) = (0.0, 0);
        for (i, size) in sizes.into_iter().enumerate() {
            let mut one = base.clone();
            // Select the zone whose exact change was solved at this size.
            one.stiffness = vec![base.stiffness[i].clone()];
            for seed in 0..seeds {
                let case = hide(
                    &one,
                    effect,
                    size,
                    Background::Messy,
                    300 + 10 * i as u64 + seed,
                );
                let job = write(&case, &dir, &folder);
                let out = folder.join("out");
                let done = Command::new(&program)
                    .args(["reconcile", "--no-cache", "--out"])
                    .args([&out, &job])
                    .output()
                    .expect("the program runs");
                assert!(
                    done.status.code().is_some_and(|c| c < 2),
                    "{}",
                    String::from_utf8_lossy(&done.stderr)
                );
                let text = std::fs::read_to_string(out.join("result.json")).expect("a result");
                let result: Value = serde_json::from_str(&text).expect("json");
                let (word, share) = score_answer(&case, &result);
                let at = ["named", "rival", "none", "unknown", "false"]
                    .iter()
                    .position(|w| *w == word);
                counts[at.expect("a word")] += 1;
                if word == "named" {
                    shares += share;
                    n += 1;
                } else {
                    eprintln!(
                        "{word}: {effect} {size} seed {seed}, truth {:?}, named {}, signal {:.2} noise sd",
                        case.truth, result["named"], case.signal
                    );
                }
            }
        }
        let all: usize = counts.iter().sum();
        let [named, rival, none, unknown, wrong] = counts;
        println!(
            "| `{effect}` | {all} | {named} | {rival} | {none} | {unknown} | {wrong} | {:.0} % |",
            100.0 * shares / f64::from(n.max(1))
        );
    }
}
