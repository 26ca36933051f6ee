//! Simulated measurements of the truck: the readings of its gauges and wheel transducers.

use super::chapter::DECK;
use super::jobs::{NOISE, PAYLOAD, WHEELS};
use crate::fe::floor::{FloorLoad, FloorSolution, solve_standing};
use crate::fe::strain_tensor::Surface;
use crate::fe::{CaseResult, UnitLoad};
use crate::gauge::{CornerRows, Gauge, GaugeSpec, build, gauge_reading, on_refined};
use crate::host::fault::{Fault, Faults};
use crate::model::{GridIx, Model, Vec3};
use crate::report::figure::{Ends, Figure, intervals};
use crate::units::{KILO, MICROSTRAIN, STANDARD_GRAVITY_M_S2};
use nastran::bdf::{MemoryLoader, read_deck};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write;

/// A gauge as stated in the gluing sheet.
pub(super) struct InstalledGauge {
    name: String,
    element: u32,
    surface: Surface,
    direction: Vec3,
}

impl InstalledGauge {
    /// Returns the gauges of a placement's result.
    pub(super) fn read_gauges(result: &Value) -> Vec<Self> {
        let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
        result["gauges"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|g| InstalledGauge {
                name: g["name"].as_str().unwrap_or_default().to_owned(),
                element: g["element"].as_u64().unwrap_or(0) as u32,
                surface: if g["surface"] == "bottom" {
                    Surface::Bottom
                } else {
                    Surface::Top
                },
                direction: Vec3::new(
                    number(&g["direction"][0]),
                    number(&g["direction"][1]),
                    number(&g["direction"][2]),
                ),
            })
            .collect()
    }
}

/// Simulated measurements, with the true loads, which recovery does not use.
pub(super) struct SimulatedMeasurements {
    pub strain_csv: String,
    pub runs_csv: String,
    /// Effect that the demo hides in the readings.
    pub hidden: String,
    /// Name, wheel loads (kN) and payload (kN) of each run.
    truth: Vec<(String, Vec<f64>, f64)>,
}

impl SimulatedMeasurements {
    /// Returns the root mean square error of the recovered wheel loads over the root mean square of the loads.
    pub(super) fn error_of(&self, result: &Value) -> f64 {
        let (mut off, mut size) = (0.0, 0.0);
        for load in result["loads"].as_array().into_iter().flatten() {
            let wheel = WHEELS
                .iter()
                .position(|(w, _)| load["name"] == format!("{w}.FZ"));
            let run = self.truth.iter().find(|t| load["run"] == t.0);
            if let (Some(w), Some(run), Some(v)) = (wheel, run, load["value"].as_f64()) {
                off += (v - run.1[w]).powi(2);
                size += run.1[w].powi(2);
            }
        }
        (off / size).sqrt()
    }

    /// Returns a figure of the recovered wheel loads with intervals, for the run with the largest error. The true loads are red.
    pub(super) fn figure_of(&self, result: &Value) -> Figure {
        let of_run = |(run, wheels, _): &(String, Vec<f64>, f64)| {
            let row = |((wheel, _), truth): (&(&str, u32), &f64)| {
                let mut loads = result["loads"].as_array().into_iter().flatten();
                let name = format!("{wheel}.FZ");
                let load = loads.find(|l| l["run"] == *run && l["name"] == name)?;
                let ends = ["low", "value", "high"].map(|k| load[k].as_f64().unwrap_or(f64::NAN));
                Some((name, ends, *truth))
            };
            let rows: Vec<_> = WHEELS.iter().zip(wheels).filter_map(row).collect();
            let off: f64 = rows
                .iter()
                .map(|(_, v, truth)| (v[1] - truth).powi(2))
                .sum();
            (off, run.clone(), rows)
        };
        let runs = self.truth.iter().map(of_run);
        let (_, run, rows) = runs.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        let shown = rows.iter().map(|(name, ends, _)| (name.clone(), *ends));
        let title = format!("load of run {run}, kN");
        let caption = "Recovered loads with 95 % intervals, and the true loads: an interval that contains the true load is right.";
        let mut figure = intervals(&[(run, shown.collect())], &title, Ends::Interval, caption);
        if let Some((_, traces)) = figure.choices.first_mut() {
            for trace in traces.iter_mut() {
                trace["name"] = json!("recovered, 95 % interval");
            }
            let names: Vec<&String> = rows.iter().map(|r| &r.0).collect();
            let truth: Vec<f64> = rows.iter().map(|r| r.2).collect();
            traces.push(json!({
                "type": "scatter", "mode": "markers", "name": "true load", "x": truth, "y": names,
                "marker": { "size": 9, "color": "#c0392b", "symbol": "x" },
            }));
        }
        figure
    }

    /// Returns the root mean square over the runs of the relative error of the recovered payload.
    pub(super) fn payload_error_of(&self, result: &Value) -> f64 {
        let (mut off, mut n) = (0.0, 0.0);
        for p in result["payload"].as_array().into_iter().flatten() {
            let run = self.truth.iter().find(|t| p["run"] == t.0);
            if let (Some(run), Some(v)) = (run, p["force"].as_f64()) {
                off += (v / run.2 - 1.0).powi(2);
                n += 1.0;
            }
        }
        f64::sqrt(off / n)
    }
}

/// Payload by run: mass in kg, shift along the truck from the nominal place in mm. A container sits between its rails and does not shift across.
const RUNS: [(f64, f64); 12] = [
    (3700.0, -300.0),
    (5500.0, 250.0),
    (1500.0, 400.0),
    (6800.0, -150.0),
    (2400.0, -500.0),
    (8000.0, 100.0),
    (4600.0, 550.0),
    (6100.0, -420.0),
    (3100.0, 180.0),
    (5000.0, -60.0),
    (7200.0, 320.0),
    (2900.0, -250.0),
];
/// Unevenness of the ground under a wheel, mm, 1 sd.
const GROUND: f64 = 4.0;
/// Scatter of gauge factors, 1 sd.
const GAIN: f64 = 0.002;
const SEED: u64 = 11;

/// Drives twelve runs.
///
/// # Errors
/// Mistakes of the program only: the deck is its own.
pub(super) fn simulate(glued: &[InstalledGauge]) -> Result<SimulatedMeasurements, Faults> {
    let program = |wrong: String| {
        Faults::from(Fault::new(
            "truck.bdf",
            "demo",
            wrong,
            "report this as an error of the program",
        ))
    };
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut normal = move || {
        let (u, v): (f64, f64) = (
            random.random_range(1e-300..1.0),
            random.random_range(0.0..1.0),
        );
        (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
    };
    let deck = read_deck(
        "truck.bdf",
        DECK.as_bytes().to_vec(),
        &mut MemoryLoader::default(),
    );
    let model = Model::from_deck(&deck).0;
    let missing = || program("a grid of the story is missing".into());
    let wheels: Vec<GridIx> = WHEELS
        .iter()
        .map(|w| model.grid_ix(w.1))
        .collect::<Option<_>>()
        .ok_or_else(missing)?;
    let payload = model.grid_ix(PAYLOAD).ok_or_else(missing)?;
    let (none, up) = (Vec3::zeros(), Vec3::new(0.0, 0.0, 1.0));
    let turns = [
        (up, none),
        (none, Vec3::new(1.0, 0.0, 0.0)),
        (none, Vec3::new(0.0, 1.0, 0.0)),
    ];
    let loads: Vec<UnitLoad> = turns
        .iter()
        .map(|(force, moment)| UnitLoad::AtGrid {
            grid: payload,
            force: *force,
            moment: *moment,
        })
        .collect();
    // The real truck has a finer mesh than its model: its readings come from elements of half the size.
    let real = model
        .refine_shells()
        .ok_or_else(|| program("the mesh cannot be refined".into()))?;
    let standing = solve_standing(&real.model, 2, &wheels, &loads, None)
        .map_err(|e| program(e.to_string()))?;
    let gauges: Vec<Gauge> = glued
        .iter()
        .map(|g| {
            let spec = GaugeSpec {
                surface: Some(g.surface),
                direction: Some(g.direction),
                ..GaugeSpec::place_on_shell(g.name.clone(), model.shell_ix(g.element)?)
            };
            let gauge = build(&model, &spec, CornerRows::Absent)
                .ok()?
                .0
                .into_iter()
                .next()?;
            on_refined(&gauge, &model, &real)
        })
        .collect::<Option<_>>()
        .ok_or_else(|| program("a gauge cannot be placed".into()))?;
    let at = model.grids.get(payload.us()).map_or(none, |g| g.x);
    let flipped = reads_most(&gauges, &standing, &turns, at);
    let gains: Vec<f64> = gauges
        .iter()
        .enumerate()
        .map(|(g, _)| (1.0 + GAIN * normal()) * if g == flipped { -1.0 } else { 1.0 })
        .collect();
    let mut simulated = SimulatedMeasurements {
        strain_csv: "run".into(),
        runs_csv: "run,payload_mass,payload_x,payload_y".into(),
        hidden: format!(
            "sign_flip:{}",
            glued.get(flipped).map_or("", |g| g.name.as_str())
        ),
        truth: Vec::new(),
    };
    glued.iter().for_each(|g| {
        let _ = write!(simulated.strain_csv, ",{}", g.name);
    });
    WHEELS.iter().for_each(|w| {
        let _ = write!(simulated.runs_csv, ",{}.FZ", w.0);
    });
    for (i, (kilogram, dx)) in RUNS.into_iter().enumerate() {
        let run = format!("R{:02}", i + 1);
        let weight = kilogram * STANDARD_GRAVITY_M_S2;
        // Force down, and its moment about the point: d x F.
        let amounts = [-weight, 0.0, weight * dx];
        let heights: Vec<f64> = WHEELS.iter().map(|_| GROUND * normal()).collect();
        let reactions = reactions(&standing, &turns, at, &amounts, &heights);
        let _ = write!(simulated.strain_csv, "\n{run}");
        for (gauge, gain) in gauges.iter().zip(&gains) {
            let strain = superpose_strain(gauge, &standing.contacts, &reactions)
                + superpose_strain(gauge, &standing.others, &amounts);
            let read = gain * strain / MICROSTRAIN + NOISE.0 * normal();
            let _ = write!(simulated.strain_csv, ",{read:.2}");
        }
        let _ = write!(
            simulated.runs_csv,
            "\n{run},{kilogram:.1},{:.3},{:.3}",
            (at.x + dx) / KILO,
            at.y / KILO
        );
        for r in &reactions {
            let _ = write!(simulated.runs_csv, ",{:.3}", r / KILO + NOISE.1 * normal());
        }
        let truth = reactions.iter().map(|r| r / KILO).collect();
        simulated.truth.push((run, truth, weight / KILO));
    }
    simulated.strain_csv.push('\n');
    simulated.runs_csv.push('\n');
    Ok(simulated)
}

/// The gauge that reads most under a payload in the middle on flat ground: the one that is wired the wrong way round.
fn reads_most(
    gauges: &[Gauge],
    standing: &FloorSolution,
    turns: &[(Vec3, Vec3); 3],
    at: Vec3,
) -> usize {
    let amounts = [-1.0, 0.0, 0.0];
    let reactions = reactions(standing, turns, at, &amounts, &[0.0; WHEELS.len()]);
    let reading = |g: &Gauge| {
        superpose_strain(g, &standing.contacts, &reactions)
            + superpose_strain(g, &standing.others, &amounts)
    };
    let sizes = gauges.iter().map(|g| reading(g).abs()).enumerate();
    sizes
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |largest| largest.0)
}

/// Reactions to the payload on ground of these heights.
fn reactions(
    standing: &FloorSolution,
    turns: &[(Vec3, Vec3); 3],
    at: Vec3,
    amounts: &[f64; 3],
    heights: &[f64],
) -> Vec<f64> {
    let n = heights.len();
    let mut sum = standing.floor.reactions(&FloorLoad {
        force: 0.0,
        moment: [0.0; 2],
        lift: heights.iter().map(|h| -h).collect(),
    });
    for (((force, moment), case), amount) in turns.iter().zip(&standing.others).zip(amounts) {
        let load = standing
            .floor
            .load(at, *force, *moment, standing.lift(case));
        for (s, r) in sum.iter_mut().zip(standing.floor.reactions(&load)) {
            *s += amount * r;
        }
    }
    sum.truncate(n);
    sum
}

fn superpose_strain(gauge: &Gauge, cases: &[CaseResult], amounts: &[f64]) -> f64 {
    cases
        .iter()
        .zip(amounts)
        .map(|(c, a)| a * gauge_reading(gauge, c).unwrap_or(0.0))
        .sum()
}
