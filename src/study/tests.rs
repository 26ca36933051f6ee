//! Compares errors of loads with the covariance that theory gives.

use super::*;
use crate::linalg::Matrix;

/// Returns eight gauges under two loads, in microstrain per unit.
fn pool() -> Vec<PoolGauge> {
    (0..8)
        .map(|i| {
            let a = f64::from(i) * 0.7;
            PoolGauge {
                row: vec![1e-6 * (2.0 + a.cos()), 1e-6 * a.sin()],
                turned: Some([
                    vec![1e-6 * 0.3, 1e-6 * 0.8],
                    vec![-0.3e-6 * (2.0 + a.cos()), 0.1e-6],
                ]),
                slope: Some([vec![2e-9, 0.0], vec![0.0, -1e-9]]),
            }
        })
        .collect()
}

fn spec(trials: usize) -> StudySpec {
    StudySpec {
        truth: vec![TrueLoad::Known(100.0), TrueLoad::Known(40.0)],
        prior: vec![None, None],
        sizes: None,
        noise: 1e-6,
        trials,
        seed: 5,
    }
}

fn all_gauges_layout() -> Vec<Vec<usize>> {
    vec![(0..8).collect()]
}

fn error(kind: ErrorKind, size: f64) -> StudyError {
    StudyError { kind, size }
}

/// Returns (S'S)^-1 S' of the pool.
fn inverse() -> Matrix {
    let p = pool();
    let s = Matrix::from_fn(8, 2, |g, l| p[g].row[l]);
    (s.transpose() * &s).try_inverse().expect("regular") * s.transpose()
}

#[test]
fn normal_noise_scatters_the_loads_as_the_covariance_states_and_intervals_cover() {
    let row = study_layout(
        &pool(),
        &all_gauges_layout(),
        error(ErrorKind::AbsoluteNormal, 3.0),
        &spec(20_000),
    );
    let a = inverse();
    // 20,000 draws determine an sd to 1 / sqrt(2 * 20,000) = .5 %, and a share of .95 to .0015. The limits are four times these values.
    for l in 0..2 {
        let expected = 3e-6 * a.row(l).norm();
        assert!((row.sigma[l] / expected - 1.0).abs() < 0.02, "{row:?}");
        assert!(row.bias[l].abs() < 4.0 * expected / 20_000_f64.sqrt());
        assert!((row.coverage[l] - 0.95).abs() < 0.006, "{row:?}");
    }
    assert_eq!(row.singular, 0);
}

#[test]
fn uniform_errors_scatter_as_a_third_of_their_square() {
    let row = study_layout(
        &pool(),
        &all_gauges_layout(),
        error(ErrorKind::RelativeUniform, 0.1),
        &spec(20_000),
    );
    let (a, p) = (inverse(), pool());
    // A sum of eight uniform errors is nearly normal. The limit is four times the .5 % to which 20,000 draws determine its sd.
    for l in 0..2 {
        let variance: f64 = (0..8)
            .map(|g| {
                let y = p[g].row[0] * 100.0 + p[g].row[1] * 40.0;
                (a[(l, g)] * 0.1 * y).powi(2) / 3.0
            })
            .sum();
        assert!(
            (row.sigma[l] / variance.sqrt() - 1.0).abs() < 0.02,
            "{row:?}"
        );
    }
}

#[test]
fn a_wrong_angle_shortens_the_reading_and_leaves_a_bias() {
    // To second order, e(a) = e0 + 2 a (e45 - m) - 2 a^2 (e0 - e90) / 2. The mean is therefore off by -sd^2 (e0 - e90).
    let sd = 1.0_f64;
    let row = study_layout(
        &pool(),
        &all_gauges_layout(),
        error(ErrorKind::Angle, sd),
        &spec(40_000),
    );
    let (a, p) = (inverse(), pool());
    let of = |r: &[f64]| r[0] * 100.0 + r[1] * 40.0;
    for l in 0..2 {
        let (mut bias, mut variance) = (0.0, 0.0);
        for g in 0..8 {
            let turned = p[g].turned.as_ref().expect("given");
            let (e0, e45, e90) = (of(&p[g].row), of(&turned[0]), of(&turned[1]));
            bias -= a[(l, g)] * sd.to_radians().powi(2) * (e0 - e90);
            variance += (a[(l, g)] * 2.0 * sd.to_radians() * (e45 - (e0 + e90) / 2.0)).powi(2);
        }
        let scatter = variance.sqrt();
        assert!(
            (row.sigma[l] / scatter - 1.0).abs() < 0.03,
            "{row:?} {scatter}"
        );
        assert!(
            (row.bias[l] - bias).abs() < 4.0 * scatter / 200.0,
            "{row:?} {bias}"
        );
    }
}

#[test]
fn places_scatter_by_the_slope_of_the_strain() {
    let row = study_layout(
        &pool(),
        &all_gauges_layout(),
        error(ErrorKind::Position, 2.0),
        &spec(20_000),
    );
    let a = inverse();
    // The limit is four times the .5 % to which 20,000 draws determine an sd.
    for l in 0..2 {
        let per = f64::hypot(2e-9 * 100.0, 1e-9 * 40.0) * 2.0;
        let expected = per * a.row(l).norm();
        assert!((row.sigma[l] / expected - 1.0).abs() < 0.02, "{row:?}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("one thread");
    let e = error(ErrorKind::Factor, 0.01);
    let layouts = vec![vec![0, 2, 4, 6], vec![1, 3, 5, 7]];
    let a = one.install(|| study_layout(&pool(), &layouts, e, &spec(500)));
    let b = study_layout(&pool(), &layouts, e, &spec(500));
    assert_eq!(a, b);
}

#[test]
fn layouts_that_do_not_separate_the_loads_are_counted_and_left_out() {
    let layouts = vec![vec![0], vec![0, 1, 2]];
    let row = study_layout(
        &pool(),
        &layouts,
        error(ErrorKind::Factor, 0.01),
        &spec(100),
    );
    assert_eq!(row.singular, 1);
    assert!(row.sigma.iter().all(|s| s.is_finite()));
}

#[test]
fn nuisance_loads_are_drawn_and_their_prior_is_used() {
    // A third load that strains all gauges: with its prior in S, the error is smaller than if the load is left out.
    let mut p = pool();
    for (g, gauge) in p.iter_mut().enumerate() {
        gauge.row.push(1e-6 * (0.4 * g as f64).cos());
        gauge.turned = None;
    }
    let with = StudySpec {
        truth: vec![
            TrueLoad::Known(100.0),
            TrueLoad::Known(40.0),
            TrueLoad::Drawn(20.0),
        ],
        prior: vec![None, None, Some(20.0)],
        ..spec(4000)
    };
    let known = study_layout(
        &p,
        &all_gauges_layout(),
        error(ErrorKind::AbsoluteNormal, 1.0),
        &with,
    );
    let without = StudySpec {
        noise: 1.0,
        ..with.clone()
    };
    // If the assumed noise far exceeds the noise of the readings, the prior dominates, as if the load were left out.
    let left_out = study_layout(
        &p,
        &all_gauges_layout(),
        error(ErrorKind::AbsoluteNormal, 1.0),
        &without,
    );
    assert!(
        known.sigma[0] < 0.5 * left_out.sigma[0],
        "{known:?} {left_out:?}"
    );
    assert!((known.coverage[0] - 0.95).abs() < 0.02, "{known:?}");
}

/// Loads in other units do not change the condition number of scaled columns; stated sizes scale it.
#[test]
fn the_condition_number_is_that_of_scaled_columns() {
    let of = |p: &[PoolGauge], sizes: Option<Vec<f64>>| {
        let with = StudySpec { sizes, ..spec(2) };
        study_layout(
            p,
            &all_gauges_layout(),
            error(ErrorKind::AbsoluteNormal, 1.0),
            &with,
        )
        .condition_number
    };
    let mut other = pool();
    for g in &mut other {
        g.row[1] *= 1e-3;
    }
    let plain = of(&pool(), None);
    assert!((of(&other, None) / plain - 1.0).abs() < 1e-9);
    assert!(of(&other, Some(vec![1.0, 1.0])) > 100.0 * plain);
    assert!(
        (of(&other, Some(vec![1.0, 1e3])) / of(&pool(), Some(vec![1.0; 2])) - 1.0).abs() < 1e-9
    );
}

/// For readings with an error factor and independent loads `f`, the variance of the error is `sum_g a_lg^2 u^2 sum_l s_gl^2 sd_l^2`.
#[test]
fn loads_are_drawn_with_their_standard_deviation() {
    let drawn = StudySpec {
        truth: vec![TrueLoad::Drawn(100.0), TrueLoad::Drawn(40.0)],
        ..spec(20_000)
    };
    let row = study_layout(
        &pool(),
        &all_gauges_layout(),
        error(ErrorKind::Factor, 0.02),
        &drawn,
    );
    let (a, p) = (inverse(), pool());
    for l in 0..2 {
        let variance: f64 = (0..8)
            .map(|g| {
                let y = (p[g].row[0] * 100.0).powi(2) + (p[g].row[1] * 40.0).powi(2);
                (a[(l, g)] * 0.02).powi(2) * y
            })
            .sum();
        // A product of two normal numbers has kurtosis 9. 20,000 draws therefore determine its sd to 1 %, and the sd of the sum more closely.
        assert!(
            (row.sigma[l] / variance.sqrt() - 1.0).abs() < 0.03,
            "{row:?}"
        );
    }
}

#[test]
fn the_sign_convention_of_a_load_changes_the_sign_of_its_bias_and_nothing_else() {
    let drawn = StudySpec {
        truth: vec![TrueLoad::Drawn(100.0), TrueLoad::Drawn(40.0)],
        ..spec(200)
    };
    let mut negated = pool();
    let turn = |row: &mut Vec<f64>| row[1] = -row[1];
    for g in &mut negated {
        turn(&mut g.row);
        g.turned.iter_mut().flatten().for_each(turn);
        g.slope.iter_mut().flatten().for_each(turn);
    }
    for kind in ErrorKind::ALL {
        let [one, other] = [pool(), negated.clone()]
            .map(|p| study_layout(&p, &all_gauges_layout(), error(kind, 0.5), &drawn));
        // Tolerance for rounding in sums of 200 errors.
        let close = |a: f64, b: f64, of: f64| (a - b).abs() <= 1e-9 * of;
        for (l, sign) in [(0, 1.0), (1, -1.0)] {
            let sigma = one.sigma[l];
            assert!(close(other.sigma[l], sigma, sigma), "{kind:?}");
            assert!(close(other.bias[l], sign * one.bias[l], sigma), "{kind:?}");
            assert_eq!(other.coverage[l], one.coverage[l], "{kind:?}");
        }
    }
}
