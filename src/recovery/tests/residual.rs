//! Tests findings on residuals of correct jobs and of wrong gauges.

use super::super::*;
use super::{KN, draw_normal, frame};
use crate::finding::{Finding, Severity};
use crate::linalg::Matrix;
use crate::sensitivity::{Load, Sensitivity};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Returns 20 gauges and 6 loads.
fn job(seed: u64) -> (Sensitivity, ChaCha8Rng) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let s = Sensitivity {
        gauges: (0..20).map(|g| format!("G{g}")).collect(),
        loads: (0..6).map(|l| Load::from_name(format!("L{l}"))).collect(),
        values: Matrix::from_fn(20, 6, |_, _| 10e-6 * draw_normal(&mut rng)),
        uncertainty: None,
        noise: None,
    };
    (s, rng)
}

/// Returns 12 similar runs of that job. Every coefficient of S has an error of `model_rel`, equal in all runs, and the noise is 1 microstrain.
fn right_runs(s: &Sensitivity, rng: &mut ChaCha8Rng, model_rel: f64) -> Vec<Readings> {
    let wrong = Matrix::from_fn(20, 6, |g, l| {
        s.values[(g, l)] * (1.0 + model_rel * draw_normal(rng))
    });
    (0..12)
        .map(|i| {
            let f: Vec<f64> = (0..6).map(|_| 20.0 + 4.0 * draw_normal(rng)).collect();
            Readings {
                run: format!("R{i}"),
                strain: (0..20)
                    .map(|g| {
                        (0..6).map(|l| wrong[(g, l)] * f[l]).sum::<f64>() + 1e-6 * draw_normal(rng)
                    })
                    .collect(),
                noise_factor: 1.0,
            }
        })
        .collect()
}

#[test]
fn right_jobs_whose_model_errs_alike_in_all_runs_are_not_flagged() {
    let (mut above, mut below, mut stopped) = (0, 0, 0);
    let jobs = 1000;
    for seed in 0..jobs {
        let model_rel = if seed % 2 == 0 { 0.02 } else { 0.0 };
        let (s, mut rng) = job(seed);
        let readings = right_runs(&s, &mut rng, model_rel);
        let errors = ErrorModel {
            noise: 1e-6,
            model_rel,
        };
        let got = recover(&s, &readings, errors);
        let has = |code: &str| i32::from(got.findings.iter().any(|f| f.code == code));
        above += has("residual-above-stated-errors") + has("strain-not-explained");
        below += has("residual-below-stated-errors");
        stopped += i32::from(got.findings.iter().any(|f| f.severity == Severity::Error));
    }
    // Nominal rates are .1 % above, one in a million below, and .1 % stopped (docs/4-recovering-loads.md). Counts above 5, 1 and 5 in 1,000 jobs have
    // a probability of less than one in a thousand.
    assert!(above <= 5, "{above} of {jobs} flagged above");
    assert!(below <= 1, "{below} of {jobs} flagged below");
    assert!(stopped <= 5, "{stopped} of {jobs} stopped");
}

#[test]
fn the_chi_square_of_right_jobs_is_that_of_its_degrees_of_freedom() {
    // The mean and variance of chi2 - dof over 300 jobs are 0 and 2 dof.
    let (mut sum, mut square, mut dof) = (0.0, 0.0, 0);
    for seed in 0..300 {
        let (s, mut rng) = job(seed);
        let readings = right_runs(&s, &mut rng, 0.02);
        let errors = ErrorModel {
            noise: 1e-6,
            model_rel: 0.02,
        };
        let solved = super::super::run_estimates::solve(&s, &readings, errors);
        let (pattern, _) = &solved.patterns[0];
        let projection = residuals::Projection::new(
            &s,
            pattern,
            errors,
            &solved.typical,
            residuals::RemovedLoads::All,
        )
        .unwrap();
        let strain: Vec<&[f64]> = readings.iter().map(|r| &r.strain[..]).collect();
        let loads: Vec<Vec<f64>> = solved
            .runs
            .iter()
            .map(|r| r.estimate.values.clone())
            .collect();
        let joint = projection.test_pattern(pattern, &strain, &loads).unwrap();
        dof = joint.dof;
        sum += joint.chi2 - dof as f64;
        square += (joint.chi2 - dof as f64).powi(2);
    }
    assert_eq!(dof, 12 * 14);
    let (mean, variance) = (sum / 300.0, square / 300.0);
    // The mean of 300 jobs has a sd of sqrt(2 168 / 300) = 1.1. The variance has a sd of 8 %.
    assert!(mean.abs() < 4.0, "{mean}");
    assert!((variance / 336.0 - 1.0).abs() < 0.35, "{variance}");
}

#[test]
fn a_gauge_off_by_a_tenth_stops_the_job_or_leaves_intervals_that_cover() {
    let Some(frame) = frame(9) else { return };
    // With a model uncertainty of 2 %, an error of a tenth is five sd. The larger the leverage of the gauge, the smaller its residual. Most jobs with
    // an influential gauge are stopped: 92 of 100 with the worst gauge (leverage .73). In the other jobs the intervals cover 87 %. The numbers are in
    // docs/4-recovering-loads.md.
    let typical: Vec<f64> = (0..9)
        .map(|l| {
            let sum: f64 = frame.truth.iter().map(|f| (f[l] * KN).powi(2)).sum();
            (sum / frame.truth.len() as f64).sqrt()
        })
        .collect();
    for (model_rel, least) in [(0.0, 0.9), (0.02, 0.8)] {
        let errors = ErrorModel {
            noise: 1e-6,
            model_rel,
        };
        let gain = Gain::new(
            &frame.s,
            &(0..20).collect::<Vec<_>>(),
            errors,
            1.0,
            &typical,
        )
        .unwrap();
        let mut worst = (1.0, 0, 0.0);
        let mut misled: Vec<f64> = Vec::new();
        for g in 0..20 {
            if gain.leverage[g] >= 0.8 {
                continue;
            }
            let (mut covered, mut of) = (0, 0);
            let mut asked = 0;
            for seed in 0..12 {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let wrong = Matrix::from_fn(20, 9, |g, l| {
                    frame.s.values[(g, l)] * (1.0 + model_rel * draw_normal(&mut rng))
                });
                let readings: Vec<Readings> = frame
                    .truth
                    .iter()
                    .enumerate()
                    .map(|(i, f)| Readings {
                        run: format!("R{i}"),
                        strain: (0..20)
                            .map(|h| {
                                let own: f64 =
                                    (0..9).map(|l| wrong[(h, l)] * f[l] * KN).sum::<f64>();
                                own * if h == g { 1.1 } else { 1.0 } + 1e-6 * draw_normal(&mut rng)
                            })
                            .collect(),
                        noise_factor: 1.0,
                    })
                    .collect();
                let got = recover(&frame.s, &readings, errors);
                asked += 9 * readings.len();
                if got.findings.iter().any(|f| f.severity == Severity::Error) {
                    continue;
                }
                for (r, f) in got.runs.iter().zip(&frame.truth) {
                    for l in 0..9 {
                        let [low, high] = r.estimate.interval(l);
                        covered += u32::from(low <= f[l] * KN && f[l] * KN <= high);
                        of += 1;
                    }
                }
            }
            misled.push(f64::from(of - covered) / asked as f64);
            if of >= 200 {
                let share = f64::from(covered) / f64::from(of);
                if share < worst.0 {
                    worst = (share, g, gain.leverage[g]);
                }
            }
        }
        assert!(worst.0 >= least, "model {model_rel}: {worst:?}");
        // Over all jobs with this gauge, stopped or not, the share of misleading intervals is a twentieth, as in correct jobs. The intervals of a job
        // share its model errors, so the share scatters by .085 from job to job (simulated). The mean over 12 scatters by .025.
        let most = misled.iter().copied().fold(0.0, f64::max);
        let mean = misled.iter().sum::<f64>() / misled.len() as f64;
        assert!(
            most <= 0.125 && mean <= 0.08,
            "model {model_rel}: {misled:?}"
        );
    }
}

/// Tests a gauge with 0.7 of its gain. It reads 30 % less than the strain predicted from the other gauges. The deviation from the prediction of all
/// gauges, which includes this gauge, is not 30 %.
#[test]
fn the_gain_that_is_stated_of_a_suspect_is_that_against_the_others_and_its_interval_covers() {
    for (noise, model_rel) in [(20e-6, 0.0), (20e-6, 0.01)] {
        let errors = ErrorModel { noise, model_rel };
        let (mut covered, mut of) = (0, 0);
        for seed in 0..300 {
            let (s, mut rng) = job(seed);
            let wrong = Matrix::from_fn(20, 6, |g, l| {
                s.values[(g, l)] * (1.0 + model_rel * draw_normal(&mut rng))
            });
            let readings: Vec<Readings> = (0..12)
                .map(|i| {
                    let f: Vec<f64> = (0..6).map(|_| 20.0 * draw_normal(&mut rng)).collect();
                    let strain = (0..20).map(|g| {
                        let own: f64 = (0..6).map(|l| wrong[(g, l)] * f[l]).sum();
                        own * if g == 3 { 0.7 } else { 1.0 } + noise * draw_normal(&mut rng)
                    });
                    Readings {
                        run: format!("R{i}"),
                        strain: strain.collect(),
                        noise_factor: 1.0,
                    }
                })
                .collect();
            let got = recover(&s, &readings, errors);
            let suspect_finding = got.findings.iter().find(|f| {
                f.code == GAUGE_SUSPECT && f.subject == "G3" && f.message.contains("% (± ")
            });
            // A finding of severity error has an interval without zero for every gauge.
            let errors = got.findings.iter().filter(|f| {
                f.severity == Severity::Error && f.code == GAUGE_SUSPECT && f.subject != "all"
            });
            for [size, half] in errors.filter_map(size_and_half) {
                assert!(size.abs() > half, "{seed}: {size} {half}");
            }
            let Some(suspect_finding) = suspect_finding else {
                continue;
            };
            let [size, half] = size_and_half(suspect_finding).unwrap();
            covered += i32::from((size + 30.0).abs() <= half);
            of += 1;
        }
        // With at least 250 trials a share of .95 scatters by .014. It is off by .03 one time in thirty.
        assert!(of >= 250, "{of}");
        let share = f64::from(covered) / f64::from(of);
        assert!(
            (0.91..=0.99).contains(&share),
            "{model_rel}: {share} of {of}"
        );
    }
}

/// Returns the size and half width of a gain that a finding states, in percent.
fn size_and_half(found: &Finding) -> Option<[f64; 2]> {
    let (size, rest) = found
        .message
        .split_once("deviates by ")?
        .1
        .split_once(" % (± ")?;
    let half = rest.split_once(" %")?.0;
    Some([size.parse().ok()?, half.parse().ok()?])
}
