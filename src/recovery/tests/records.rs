//! Records: the same estimate and the same intervals as runs, with and without gaps.

use super::super::history::{Filter, SampleLoads};
use super::super::*;
use super::{NOISE, draw_normal, frame};
use crate::linalg::Matrix;
use crate::sensitivity::{Load, Sensitivity, Uncertainty};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

fn filter(s: &Sensitivity, errors: ErrorModel, typical: &[f64]) -> Filter {
    let n = s.gauges.len();
    Filter::new(s, vec![0.0; n], errors, 1.0, typical, Widening::none()).unwrap()
}

/// Returns 14 gauges, 6 wanted loads of 10 and 10 nuisance loads of 1 with stated sizes. There are more loads than gauges.
pub(super) fn many_nuisances() -> Sensitivity {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let loads = (0..16)
        .map(|l| Load {
            name: format!("L{l}"),
            expected: Some(if l < 6 { 10.0 } else { 1.0 }),
            wanted: l < 6,
            quantity: None,
        })
        .collect();
    Sensitivity {
        gauges: (0..14).map(|g| format!("G{g}")).collect(),
        loads,
        values: Matrix::from_fn(14, 16, |_, _| 10e-6 * draw_normal(&mut rng)),
        uncertainty: None,
        noise: None,
    }
}

#[test]
fn a_streamed_record_gives_what_the_same_samples_give_as_runs() {
    let Some(frame) = frame(9) else { return };
    let got = recover(&frame.s, &frame.readings, NOISE);
    // The record has the same widening by residuals as the runs.
    let (zero, widening) = (vec![0.0; 20], got.widening.clone());
    let filter = Filter::new(&frame.s, zero, NOISE, 1.0, &got.typical, widening).unwrap();
    let samples: Vec<f64> = frame
        .readings
        .iter()
        .flat_map(|r| r.strain.iter().map(|v| v * 1e6))
        .collect();
    let (mut out, mut sums) = (SampleLoads::default(), Sums::new(20, 9));
    filter.apply(&samples, 1e-6, &mut out, &mut sums);
    for (i, r) in got.runs.iter().enumerate() {
        let sigma = filter.sigma(&r.estimate.values);
        for l in 0..9 {
            let error = out.values[i * 9 + l] - r.estimate.values[l];
            assert!(error.abs() < 1e-6 * r.estimate.sigma(l));
            assert!((sigma[l] / r.estimate.sigma(l) - 1.0).abs() < 1e-9);
        }
    }
    assert_eq!((sums.missing.whole, sums.missing.gaps), (12, 0));
    let rms = (sums.residual.iter().sum::<f64>() / (12.0 * 11.0)).sqrt();
    assert!((rms - got.residual_rms).abs() < 1e-12);
}

#[test]
fn the_same_rows_as_runs_and_as_samples_have_the_same_sigma_nuisance_loads_of_stated_size_among_them()
 {
    let s = many_nuisances();
    for model_rel in [0.0, 0.02] {
        let errors = ErrorModel {
            noise: 1e-6,
            model_rel,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let readings: Vec<Readings> = (0..12)
            .map(|i| {
                let f: Vec<f64> = s
                    .loads
                    .iter()
                    .map(|l| l.expected.unwrap() * draw_normal(&mut rng))
                    .collect();
                Readings {
                    run: format!("R{i}"),
                    strain: (0..14)
                        .map(|g| {
                            (0..16).map(|l| s.values[(g, l)] * f[l]).sum::<f64>()
                                + 1e-6 * draw_normal(&mut rng)
                        })
                        .collect(),
                    noise_factor: 1.0,
                }
            })
            .collect();
        let got = recover(&s, &readings, errors);
        assert_eq!(got.widening, Widening::none());
        let filter = filter(&s, errors, &got.typical);
        let samples: Vec<f64> = readings.iter().flat_map(|r| r.strain.clone()).collect();
        let (mut out, mut sums) = (SampleLoads::default(), Sums::new(14, 16));
        filter.apply(&samples, 1.0, &mut out, &mut sums);
        for (i, r) in got.runs.iter().enumerate() {
            let sigma = filter.sigma(&out.values[i * 16..(i + 1) * 16]);
            for l in 0..16 {
                let own = r.estimate.sigma(l);
                assert!((sigma[l] / own - 1.0).abs() < 1e-9, "{} {own}", sigma[l]);
                assert!((out.values[i * 16 + l] - r.estimate.values[l]).abs() < 1e-9 * own);
            }
        }
    }
}

#[test]
fn a_nuisance_load_with_a_stated_size_widens_the_interval_of_a_sample_as_that_of_a_run() {
    // A and B each strain one of two gauges, and N of 1 sd strains both. The variance of A is (noise / S)^2 + (S_N / S)^2, so sigma is .01005 and not
    // .00100.
    let loads = ["A", "B", "N"]
        .map(|n| Load {
            name: n.into(),
            expected: (n == "N").then_some(1.0),
            wanted: n != "N",
            quantity: None,
        })
        .to_vec();
    let s = Sensitivity {
        gauges: vec!["1".into(), "2".into()],
        loads,
        values: Matrix::from_row_slice(2, 3, &[1e-3, 0.0, 1e-5, 0.0, 1e-3, 1e-5]),
        uncertainty: None,
        noise: None,
    };
    let sigma = filter(&s, NOISE, &[0.0; 3]).sigma(&[0.0; 3]);
    assert!(
        (sigma[0] - (1e-6_f64 + 1e-4).sqrt()).abs() < 1e-6,
        "{sigma:?}"
    );
}

#[test]
fn whole_blocks_give_what_single_samples_give_and_a_gap_spoils_its_sample_alone() {
    let s = Sensitivity {
        gauges: ["1", "2", "3"].map(String::from).to_vec(),
        loads: ["A", "B"].map(Load::from_name).to_vec(),
        values: Matrix::from_row_slice(3, 2, &[1e-3, 2e-4, -3e-4, 1e-3, 5e-4, 7e-4]),
        uncertainty: None,
        noise: None,
    };
    let filter = Filter::new(
        &s,
        vec![1e-5, 0.0, -1e-5],
        NOISE,
        1.0,
        &[0.0; 2],
        Widening::none(),
    )
    .unwrap();
    // Two whole blocks and a part of a third. One reading is missing in the middle of the second block.
    let mut samples: Vec<f64> = (0..3 * 77)
        .map(|i| ((i * 37) % 101) as f64 - 50.0)
        .collect();
    samples[3 * 40 + 1] = f64::NAN;
    let (mut out, mut sums) = (SampleLoads::default(), Sums::new(3, 2));
    filter.apply(&samples, 1e-6, &mut out, &mut sums);
    let mut together = Sums::new(3, 2);
    for (i, sample) in samples.chunks_exact(3).enumerate() {
        let mut one = SampleLoads::default();
        filter.apply(sample, 1e-6, &mut one, &mut together);
        for (a, b) in one.values.iter().zip(&out.values[2 * i..]) {
            assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{i}: {a} {b}");
        }
    }
    assert_eq!((sums.missing.whole, sums.missing.gaps), (76, 1));
    assert_eq!((together.missing.whole, together.missing.gaps), (76, 1));
    assert_eq!(out.gaps.iter().map(|g| g.0).collect::<Vec<_>>(), [40]);
    for (a, b) in sums.residual.iter().zip(&together.residual) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    // Two gauges remain for two loads. Solution by hand: y1 = S11 a + S12 b, y3 = S31 a + S32 b.
    let y = [samples[120] * 1e-6 - 1e-5, samples[122] * 1e-6 + 1e-5];
    let det = 1e-3 * 7e-4 - 2e-4 * 5e-4;
    let a = (7e-4 * y[0] - 2e-4 * y[1]) / det;
    let b = (1e-3 * y[1] - 5e-4 * y[0]) / det;
    assert!((out.values[80] - a).abs() < 1e-9 && (out.values[81] - b).abs() < 1e-9);
    // The intervals are wider than with all three gauges.
    let gain = out.gaps[0].1.as_ref().unwrap();
    let (with, without) = (filter.sigma(&[a, b]), filter.sigma_with(gain, &[a, b]));
    assert!(without[0] > with[0] && without[1] > with[1]);
}

#[test]
fn a_load_that_the_other_gauges_do_not_determine_is_blank_and_the_others_are_not() {
    let s = Sensitivity {
        gauges: ["1", "2", "3"].map(String::from).to_vec(),
        loads: ["A", "B"].map(Load::from_name).to_vec(),
        values: Matrix::from_row_slice(3, 2, &[1e-3, 0.0, 1e-3, 0.0, 0.0, 1e-3]),
        uncertainty: None,
        noise: None,
    };
    let filter = filter(&s, NOISE, &[0.0; 2]);
    let samples = [1e-3, 1e-3, 2e-3, 1e-3, 1e-3, f64::NAN, 1e-3, 1e-3, 1e308];
    let (mut out, mut sums) = (SampleLoads::default(), Sums::new(3, 2));
    filter.apply(&samples, 1.0, &mut out, &mut sums);
    for i in 0..3 {
        assert!((out.values[2 * i] - 1.0).abs() < 1e-12);
    }
    assert!((out.values[1] - 2.0).abs() < 1e-12);
    assert!(out.values[3].is_nan() && out.values[5].is_nan());
    assert_eq!(
        (
            sums.missing.whole,
            sums.missing.gaps,
            sums.missing.impossible
        ),
        (1, 2, 1)
    );
    assert_eq!((sums.known_samples(0), sums.known_samples(1)), (3, 1));
}

/// Returns samples of loads A = 1, B = 2, every second one without the only gauge that determines B.
fn half_without_b(s: &Sensitivity) -> Vec<Readings> {
    (0..20)
        .map(|i| {
            let mut strain: Vec<f64> = (0..3)
                .map(|g| s.values[(g, 0)] + 2.0 * s.values[(g, 1)])
                .collect();
            if i % 2 == 1 {
                strain[2] = f64::NAN;
            }
            Readings::of_sample(f64::from(i), strain, 1.0)
        })
        .collect()
}

#[test]
fn the_typical_size_of_a_load_comes_from_the_samples_that_determine_it() {
    let plain = Sensitivity {
        gauges: ["1", "2", "3"].map(String::from).to_vec(),
        loads: ["A", "B"].map(Load::from_name).to_vec(),
        values: Matrix::from_row_slice(3, 2, &[1e-3, 0.0, 1e-3, 0.0, 0.0, 1e-3]),
        uncertainty: None,
        noise: None,
    };
    let calibrated = Sensitivity {
        noise: None,
        uncertainty: Some(Uncertainty::of_model(
            &plain.values,
            0.02,
            (&Matrix::zeros(3, 2), 0.0),
        )),
        ..plain.clone()
    };
    for (s, model_rel) in [(plain, 0.02), (calibrated, 0.0)] {
        let errors = ErrorModel {
            noise: 1e-6,
            model_rel,
        };
        let got = recover_samples(&s, half_without_b(&s), errors);
        for (found, truth) in got.typical.iter().zip([1.0, 2.0]) {
            assert!((found - truth).abs() < 1e-9, "{:?}", got.typical);
        }
        // A gap is reported for the record, not for the examined samples.
        assert!(
            got.findings.iter().all(|f| f.code != NOT_SOLVABLE),
            "{:?}",
            got.findings
        );
    }
}

#[test]
fn samples_without_gauges_for_a_load_give_no_finding_if_the_record_determines_it() {
    let mut s = Sensitivity {
        gauges: ["1", "2", "3"].map(String::from).to_vec(),
        loads: ["A", "B"].map(Load::from_name).to_vec(),
        values: Matrix::from_row_slice(3, 2, &[1e-3, 0.0, 1e-3, 0.0, 0.0, 1e-3]),
        uncertainty: None,
        noise: None,
    };
    let is_reported = |s: &Sensitivity| {
        let samples = half_without_b(s).into_iter().skip(1).step_by(2).collect();
        let got = recover_samples(s, samples, NOISE);
        assert!(
            got.runs
                .iter()
                .all(|r| r.determines_load(0) && !r.determines_load(1))
        );
        got.findings.iter().any(|f| f.code == NOT_SOLVABLE)
    };
    assert!(!is_reported(&s));
    s.values[(2, 1)] = 0.0;
    assert!(is_reported(&s));
}

#[test]
fn by_a_calibrated_s_a_record_has_the_intervals_of_a_run_with_and_without_sums() {
    let values = Matrix::from_row_slice(4, 2, &[3e-6, 1e-6, 2e-6, -1e-6, -1e-6, 2e-6, 1e-6, 3e-6]);
    let mean_square = crate::sensitivity::mean_square(&values);
    // Entries of S have separate errors of 2e-7 and a common error of 1e-7. Gauges have a separate scatter of 3 % and a common scatter of 2 %.
    // Cross-validation doubles all of them.
    let alike = |each: f64, all: f64, order: usize| -> Vec<f64> {
        let entry = |i: usize| {
            if i / order == i % order {
                each * each
            } else {
                0.0
            }
        };
        (0..order * order).map(|i| entry(i) + all * all).collect()
    };
    let s = Sensitivity {
        gauges: ["1", "2", "3", "4"].map(String::from).to_vec(),
        loads: ["A", "B"].map(Load::from_name).to_vec(),
        noise: None,
        uncertainty: Some(Uncertainty {
            covariance: alike(2e-7, 1e-7, 8),
            scatter: alike(0.03, 0.02, 4),
            mean_square,
            scale: 2.0,
            dof: 9.0,
            dof_outside: 9.0,
            one_by_one: false,
            additive: Vec::new(),
            center: Vec::new(),
            is_tested: true,
        }),
        values,
    };
    let truth = [3.0, 2.0];
    let strain = s.values.row_iter().map(|row| row[0] * 3.0 + row[1] * 2.0);
    let run = Readings::of_sample(0.0, strain.collect(), 1.0);
    let of_run = estimate(&s, &run, NOISE).estimate;
    let c = &of_run.covariance;
    let wanted = [
        of_run.sigma(0),
        of_run.sigma(1),
        (c[0] + c[1] + c[2] + c[3]).sqrt(),
    ];
    let mut filter = filter(&s, NOISE, &truth);
    let close = |found: f64, wanted: f64| {
        assert!((found / wanted - 1.0).abs() < 1e-6, "{found} {wanted}");
    };
    for (l, sigma) in filter.sigma(&truth).into_iter().enumerate() {
        close(sigma, wanted[l]);
    }
    filter.combine(&[vec![(0, 1.0), (1, 1.0)]]);
    let found = filter.sigma(&[3.0, 2.0, 5.0]);
    assert_eq!(found.len(), 3);
    for (sigma, wanted) in found.into_iter().zip(wanted) {
        close(sigma, wanted);
    }
}
