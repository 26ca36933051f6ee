//! Cases of `../shared/hidden_effects/static` as frames, and a seeded generator that hides effects in them.

#[path = "../../../nastran/tests/support/mod.rs"]
mod support;

#[path = "../../drawn/mod.rs"]
pub mod drawn;

pub mod generator;
pub mod judge;

use std::path::{Path, PathBuf};
use strainbridge::reconcile::Observations;
use strainbridge::reconcile::strain::{
    GaugeFacts, MassSignature, PayloadWeight, StiffnessOf, StiffnessSignature, StrainFrame,
    WheelForces, Wiring,
};

/// Returns the folder of the shared material, if present.
pub fn find_shared_folder() -> Option<PathBuf> {
    support::find_shared_path("hidden_effects")
}

struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

fn table(path: &Path) -> Table {
    let text = std::fs::read_to_string(path).expect("a table of the case");
    let mut lines = text.lines().map(|l| {
        l.split(',')
            .map(|c| c.trim().to_string())
            .collect::<Vec<_>>()
    });
    let header = lines.next().expect("a header");
    Table {
        header,
        rows: lines.filter(|r| r.len() > 1).collect(),
    }
}

impl Table {
    fn number(&self, row: usize, column: usize) -> f64 {
        self.rows[row][column].parse().expect("a number")
    }
    fn column(&self, name: &str) -> Vec<f64> {
        let c = self
            .header
            .iter()
            .position(|h| h == name)
            .expect("the column");
        (0..self.rows.len()).map(|r| self.number(r, c)).collect()
    }
}

/// Returns a frame with wheel forces only: strain = `influence` times `loads`.
///
/// `influence` is gauges by loads and four payload columns, `loads` is runs by loads. The noise is one microstrain.
/// Forces and model are exact.
pub fn plain_frame(
    observations: Observations,
    gauges: Vec<GaugeFacts>,
    load_names: Vec<String>,
    influence: Vec<f64>,
    loads: Vec<f64>,
) -> StrainFrame {
    StrainFrame {
        rules: Default::default(),
        stop: Default::default(),
        tensors: vec![Vec::new(); gauges.len()],
        payload: vec![[0.0; 3]; observations.runs.len()],
        observations,
        gauges,
        moments: Vec::new(),
        load_names,
        load_positions: None,
        influence,
        per_mm: None,
        loads,
        payload_origin: [0.0; 2],
        payload_weight: PayloadWeight::InModel,
        wheel_forces: WheelForces::Measured,
        other_loads: Vec::new(),
        nuisance: Vec::new(),
        ground: 0.0,
        thermal_uniform: None,
        thermal_gradient: None,
        masses: Vec::new(),
        stiffness: Vec::new(),
        noise: 1.0,
        gauge_noise: None,
        load_noise: 0.0,
        model_rel: 0.0,
        coefficient_rel: 0.0,
        as_modelled: None,
        scatter: Vec::new(),
        learnt: None,
    }
}

/// Returns the frame of a case folder in matrix form.
pub fn frame_of(dir: &Path) -> StrainFrame {
    let meta: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(dir.join("meta.json")).expect("meta.json"))
            .expect("valid json");
    let number = |k: &str| meta[k].as_f64().expect("a number in meta.json");
    let strain = table(&dir.join("strain.csv"));
    let runs = table(&dir.join("runs.csv"));
    let gauges = table(&dir.join("gauges.csv"));
    let vertical = table(&dir.join("A_vertical.csv"));
    let payload = table(&dir.join("B_payload.csv"));
    let tensor = table(&dir.join("tensor.csv"));
    let n_g = gauges.rows.len();
    let n_l = vertical.header.len() - 1;
    let held: Vec<&str> = meta["holdout_runs"]
        .as_array()
        .expect("runs")
        .iter()
        .filter_map(|v| v.as_str())
        .collect();
    let n_c = n_l + 4;
    let mut influence = Vec::new();
    let mut tensors = Vec::new();
    let mut facts = Vec::new();
    for g in 0..n_g {
        let mut row: Vec<f64> = (1..=n_l).map(|c| vertical.number(g, c)).collect();
        row.extend((1..=4).map(|c| payload.number(g, c)));
        let wiring = if gauges.rows[g][4].starts_with("full") {
            Wiring::Bending
        } else {
            Wiring::Quarter
        };
        let plane = match wiring {
            Wiring::Quarter => (0..n_l + 2)
                .map(|c| {
                    let (exx, gxy) = (tensor.number(g, 1 + 2 * c), tensor.number(g, 2 + 2 * c));
                    [exx, -0.29 * exx, gxy]
                })
                .collect(),
            _ => row
                .iter()
                .take(n_l + 2)
                .map(|a| [*a, -0.29 * a, 0.0])
                .collect(),
        };
        tensors.push(plane);
        facts.push(GaugeFacts {
            name: gauges.rows[g][0].clone(),
            wiring,
            angle_deg: gauges.column("angle_deg")[g],
            position: Some([
                gauges.number(g, 1),
                gauges.number(g, 2),
                gauges.number(g, 3),
            ]),
        });
        influence.extend(row);
    }
    let x = runs.column("payload_x_m");
    let kg = runs.column("payload_kg");
    let other = table(&dir.join("A_other.csv"));
    let thermal = table(&dir.join("T_thermal.csv"));
    let mass = table(&dir.join("B_mass.csv"));
    let zone = |k: usize| {
        let t = table(&dir.join(format!("dA_dt_Z{k}.csv")));
        let mut change = vec![0.0; n_g * n_c];
        for g in 0..n_g {
            for c in 0..n_l + 2 {
                change[g * n_c + c] = t.number(g, c + 1);
            }
        }
        StiffnessSignature {
            of: StiffnessOf::Zone,
            place: format!("Z{k}"),
            at_percent: vec![(1.0, change)],
            prior_percent: 15.0,
        }
    };
    let observations = Observations {
        channels: strain.header[1..].to_vec(),
        runs: strain.rows.iter().map(|r| r[0].clone()).collect(),
        values: strain
            .rows
            .iter()
            .flat_map(|r| r[1..].iter().map(|v| v.parse::<f64>().expect("a reading")))
            .collect(),
        held_out: strain
            .rows
            .iter()
            .map(|r| held.contains(&r[0].as_str()))
            .collect(),
    };
    let load_names = vertical.header[1..]
        .iter()
        .map(|h| format!("{}.FZ", h.trim_start_matches("FZ_")))
        .collect();
    let loads = (0..runs.rows.len())
        .flat_map(|r| (3..3 + n_l).map(move |c| (r, c)))
        .map(|(r, c)| runs.number(r, c))
        .collect();
    StrainFrame {
        tensors,
        payload: kg
            .iter()
            .zip(&x)
            .map(|(m, x)| [*m, x - number("nominal_payload_x_m"), 0.0])
            .collect(),
        payload_origin: [number("nominal_payload_x_m"), 0.0],
        payload_weight: if meta["analyst_includes_payload_gravity"].as_bool() == Some(false) {
            PayloadWeight::Missing
        } else {
            PayloadWeight::InModel
        },
        wheel_forces: if meta["fz_source"] == "flat_ground_model" {
            WheelForces::FlatGroundModel
        } else {
            WheelForces::Measured
        },
        other_loads: other.header[1..]
            .iter()
            .map(|h| (h.clone(), other.column(h)))
            .collect(),
        thermal_uniform: Some(thermal.column("thermal_uniform")),
        thermal_gradient: Some(thermal.column("thermal_gradient")),
        masses: mass.header[1..]
            .iter()
            .map(|h| MassSignature {
                place: h.clone(),
                per_kg: mass.column(h),
            })
            .collect(),
        stiffness: (1..=4).map(zone).collect(),
        noise: number("strain_noise_ue"),
        load_noise: number("fz_noise_kN"),
        model_rel: number("model_uncertainty_rel"),
        ..plain_frame(observations, facts, load_names, influence, loads)
    }
}
