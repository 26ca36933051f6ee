//! Contradictions and gaps of calibration runs: labels exchanged between two runs, loads shared out by chance, one loading in several sizes.

use super::severe;
use crate::calibrate::*;
use crate::finding::Severity;
use crate::recovery::{ErrorModel, Readings, recover};
use crate::sensitivity::Load;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const NOISE: f64 = 1e-6;

/// Microstrain per kN in each of three lanes.
const ROWS: [[f64; 3]; 8] = [
    [2.0, 0.6, 0.1],
    [1.4, 1.2, 0.2],
    [0.9, 1.8, 0.5],
    [0.5, 2.0, 1.0],
    [0.2, 1.3, 1.7],
    [0.1, 0.7, 2.1],
    [0.4, 0.9, 0.6],
    [1.1, 0.3, 0.2],
];

/// Returns runs of 100 kN in each lane, `times` times, without a model. They scatter by `scatter`, all gauges together and each gauge separately.
fn lanes(times: usize, scatter: f64, seed: u64) -> Task {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut off = || 1.0 + scatter * 3.0_f64.sqrt() * random.random_range(-1.0..1.0);
    let runs = (0..3 * times)
        .map(|i| {
            let (lane, size) = (i % 3, off());
            let loads = (0..3).map(|l| if l == lane { 100.0 } else { 0.0 });
            KnownRun {
                run: format!("R{}", i + 1),
                strain: ROWS
                    .iter()
                    .map(|row| 1e-6 * 100.0 * row[lane] * size * off())
                    .collect(),
                noise_factor: 1.0,
                loads: KnownLoads::from_exact(loads.collect()),
                group: lane,
            }
        })
        .collect();
    Task {
        gauges: (0..ROWS.len()).map(|g| format!("G{g}")).collect(),
        loads: ["east", "middle", "west"].map(Load::from_name).to_vec(),
        noise: NOISE,
        model: None,
        runs,
        sums: vec![vec![1.0; 3]],
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    }
}

#[test]
fn two_runs_with_each_others_label_are_named_together_and_not_used() {
    for seed in 0..10 {
        for times in [4, 6] {
            let clean = calibrate(&lanes(times, 0.03, seed)).unwrap();
            assert_eq!(severe(&clean, "runs-exchanged"), None, "{seed}");
            let mut wrong = lanes(times, 0.03, seed);
            let loads = wrong.runs[3].loads.clone();
            wrong.runs[3].loads = std::mem::replace(&mut wrong.runs[7].loads, loads);
            let c = calibrate(&wrong).unwrap();
            let named = severe(&c, "runs-exchanged");
            let wanted = Some((Severity::Warning, "R4, R8".to_owned()));
            assert_eq!(named, wanted, "{seed} {times}: {:?}", c.findings);
            assert_eq!(c.refused, [3, 7]);
        }
    }
}

#[test]
fn blank_readings_next_to_runs_that_contradict_leave_a_covariance() {
    // The residuals of the runs are one pattern, and gauges are many. A matrix computed for each pair from the runs that have both gauges would not
    // be a covariance.
    for seed in 0..20 {
        let mut wrong = lanes(4, 0.003, seed);
        let loads = wrong.runs[3].loads.clone();
        wrong.runs[3].loads = std::mem::replace(&mut wrong.runs[7].loads, loads);
        for g in [1, 3, 6] {
            wrong.runs[g].strain[g] = f64::NAN;
            wrong.runs[7].strain[g] = f64::NAN;
        }
        assert!(calibrate(&wrong).is_ok(), "{seed}");
    }
}

#[test]
fn of_two_runs_a_lane_it_is_an_error_that_names_both_exchanges_that_may_be() {
    for seed in 0..10 {
        let mut wrong = lanes(2, 0.03, seed);
        let loads = wrong.runs[0].loads.clone();
        wrong.runs[0].loads = std::mem::replace(&mut wrong.runs[1].loads, loads);
        let c = calibrate(&wrong).unwrap();
        let found = c.findings.iter().find(|f| f.code == "runs-exchanged");
        let found = found.expect("a finding");
        assert_eq!(found.severity, Severity::Error);
        // The exchanged runs are R1 and R2, or R4 and R5, which have the same lanes.
        for run in ["`R1`", "`R2`", "`R4`", "`R5`"] {
            assert!(found.message.contains(run), "{}", found.message);
        }
    }
}

#[test]
fn loads_that_a_single_known_run_shares_out_by_chance_are_an_error() {
    // Only the sum is known for all runs but one. This one run determines by chance how the sum is shared.
    let mut task = lanes(4, 0.03, 1);
    task.loads.truncate(2);
    task.sums = vec![vec![1.0; 2]];
    task.runs.retain(|r| r.loads.mean[2] == 0.0);
    for (i, run) in task.runs.iter_mut().enumerate() {
        run.loads.mean.truncate(2);
        run.loads.covariance = vec![0.0; 4];
        if i > 0 {
            run.loads.mean = vec![50.0, 50.0];
            run.loads.covariance = vec![5e5, -5e5, -5e5, 5e5];
        }
    }
    let c = calibrate(&task).unwrap();
    let errors = c.findings.iter().filter(|f| f.severity == Severity::Error);
    assert!(errors.count() > 0, "{:?}", c.findings);
}

#[test]
fn sound_gauges_are_not_blamed_if_the_runs_do_not_separate_the_loads() {
    for seed in 0..5 {
        let mut task = lanes(4, 0.03, seed);
        let unlike = task.runs.split_off(6);
        // The runs have one loading in different sizes.
        let first = task.runs[0].clone();
        for (i, run) in task.runs.iter_mut().enumerate() {
            let size = 0.5 + 0.1 * i as f64;
            run.strain = first.strain.iter().map(|v| v * size).collect();
            run.loads = KnownLoads::from_exact(vec![100.0 * size, 50.0 * size, 80.0 * size]);
            run.group = i;
        }
        let c = calibrate(&task).unwrap();
        assert!(severe(&c, "calibration-not-determined").is_some());
        let readings: Vec<_> = (unlike.iter())
            .map(|r| Readings {
                run: r.run.clone(),
                strain: r.strain.clone(),
                noise_factor: 1.0,
            })
            .collect();
        let errors = ErrorModel {
            noise: NOISE,
            model_rel: 0.0,
        };
        let found = recover(&c.sensitivity, &readings, errors);
        let blamed = found.findings.iter().find(|f| f.code.contains("gauge"));
        assert!(blamed.is_none(), "{blamed:?}");
    }
}
