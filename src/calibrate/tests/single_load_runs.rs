//! Tests whether a calibration records that each run had one load alone.

use super::installed_position::draw_normal;
use super::repeats::lanes;
use crate::calibrate::*;
use crate::sensitivity::Load;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const NOISE: f64 = 1e-8;

/// Returns two lanes of random strain with three passages each and a scatter of 3 %, and the runs `more`.
fn task(more: &[[f64; 2]]) -> Task {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let s = lanes(&mut random);
    let alone = (0..6).map(|i| if i < 3 { [200.0, 0.0] } else { [0.0, 200.0] });
    let runs = alone.chain(more.iter().copied()).enumerate().map(|(i, f)| {
        let size = 1.0 + 0.03 * draw_normal(&mut random);
        let clean = (0..s.nrows()).map(|g| s[(g, 0)] * f[0] + s[(g, 1)] * f[1]);
        let strain: Vec<f64> = clean.map(|e| size * e).collect();
        KnownRun {
            run: format!("R{i}"),
            strain: strain
                .into_iter()
                .map(|e| e + NOISE * draw_normal(&mut random))
                .collect(),
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(f.to_vec()),
            group: i,
        }
    });
    Task {
        runs: runs.collect(),
        gauges: (0..s.nrows()).map(|g| format!("G{g}")).collect(),
        loads: ["west", "east"].map(Load::from_name).to_vec(),
        noise: NOISE,
        model: None,
        sums: Vec::new(),
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    }
}

#[test]
fn a_calibration_knows_whether_each_of_its_runs_had_one_load_alone() {
    let one_by_one = |task: &Task| {
        let known = calibrate(task).unwrap().sensitivity.uncertainty;
        known.unwrap().one_by_one
    };
    assert!(one_by_one(&task(&[])));
    assert!(!one_by_one(&task(&[[150.0, 200.0]])));
    // A load with uncertainty counts as acting too.
    let mut loose = task(&[]);
    loose.runs[0].loads.covariance[3] = 1.0;
    assert!(!one_by_one(&loose));
    // With a model the loads are forces at places, and their strain is known to add up.
    let mut with_model = task(&[]);
    let values = calibrate(&with_model).unwrap().sensitivity.values;
    with_model.model = Some(ModelPrior {
        values,
        moves: Vec::new(),
        off_drawing: None,
        uncertainty_rel: 0.05,
    });
    assert!(!one_by_one(&with_model));
}
