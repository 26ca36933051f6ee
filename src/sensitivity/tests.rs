use super::*;
use crate::finding::Severity;
use crate::linalg::Matrix;

fn s(rows: usize, values: &[f64], names: &[&str]) -> Sensitivity {
    Sensitivity {
        gauges: (0..rows).map(|i| format!("G{i}")).collect(),
        loads: names.iter().map(|n| Load::from_name(*n)).collect(),
        values: Matrix::from_row_slice(rows, names.len(), values),
        uncertainty: None,
        noise: None,
    }
}

#[test]
fn two_loads_that_act_alike_are_named_with_their_combination() {
    let s = s(
        4,
        &[1.0, 2.0, 0.0, 2.0, 4.0, 1.0, 3.0, 6.0, 0.0, 4.0, 8.0, -1.0],
        &["LF", "RF", "LM"],
    );
    assert_eq!(s.rank(), 2);
    let f = check_separability(&s);
    let bad = f.iter().find(|f| f.code == "loads-not-separable").unwrap();
    assert_eq!(bad.severity, Severity::Error);
    assert!(
        bad.subject.contains("LF") && bad.subject.contains("RF") && !bad.subject.contains("LM"),
        "{}",
        bad.subject
    );
    // LF - 0.5 RF causes no strain: (1, 2, 3, 4) - (2, 4, 6, 8) / 2.
    assert!(
        bad.message.contains("0.500 RF") || bad.message.contains("2.00 LF"),
        "{}",
        bad.message
    );
}

#[test]
fn fewer_gauges_than_loads_names_what_stays_free() {
    let s = s(1, &[1.0, 1.0], &["A", "B"]);
    let codes: Vec<&str> = check_separability(&s).iter().map(|f| f.code).collect();
    assert!(
        codes.contains(&"fewer-gauges-than-loads") && codes.contains(&"loads-not-separable"),
        "{codes:?}"
    );
    assert_eq!(s.condition_number(), f64::INFINITY);
}

#[test]
fn a_load_that_strains_nothing_is_named_once() {
    let s = s(3, &[1.0, 0.0, 2.0, 0.0, 3.0, 0.0], &["A", "B"]);
    let f = check_separability(&s);
    assert_eq!(f.len(), 1, "{f:?}");
    assert_eq!(
        (f[0].code, f[0].subject.as_str()),
        ("load-without-strain", "B")
    );
}

#[test]
fn units_change_the_raw_condition_number_and_not_the_scaled_one() {
    let newton = s(3, &[1.0, 0.1, 0.2, 1.0, -0.3, 0.4], &["F", "M"]);
    let mut millimetre = newton.clone();
    millimetre.values.column_mut(1).scale_mut(1e-3);
    assert!((newton.condition_number_scaled() - millimetre.condition_number_scaled()).abs() < 1e-9);
    assert!(millimetre.condition_number() > 100.0 * newton.condition_number());
}

/// Returns an uncertainty of two gauges and two loads, with a center and an additive part, from arbitrary numbers.
fn build_uncertainty() -> (Uncertainty, Matrix) {
    let root = Matrix::from_fn(4, 4, |i, j| 0.3 + (1.7 * (i * 4 + j) as f64).sin());
    let covariance = &root * root.transpose();
    let known = Uncertainty {
        covariance: covariance.iter().copied().collect(),
        scatter: vec![0.04, 0.01, 0.01, 0.09],
        mean_square: vec![2.0, 0.5, 0.5, 1.0],
        scale: 1.5,
        dof: 8.0,
        dof_outside: 8.0,
        one_by_one: false,
        additive: vec![0.5, 0.1, 0.1, 0.7],
        center: vec![2.0, -1.0],
        is_tested: true,
    };
    (known, covariance)
}

/// `Cov(eps | f) = q^2 C + A + sum h_j h_k Cov(S_.j, S_.k)`, `h = f - center`, written out, and the covariance of recovered loads from it.
#[test]
fn the_covariance_of_strain_counts_errors_of_s_from_its_center() {
    let (known, covariance) = build_uncertainty();
    let f = [3.0, 1.5];
    let h = [1.0, 2.5];
    let q2 = 2.0 * 9.0 + 2.0 * 0.5 * 4.5 + 2.25;
    let found = known.strain_covariance(2, &f);
    for g in 0..2 {
        for i in 0..2 {
            let of_s: f64 = (0..4)
                .map(|at| h[at / 2] * h[at % 2] * covariance[(g * 2 + at / 2, i * 2 + at % 2)])
                .sum();
            let expected = q2 * known.scatter[g * 2 + i] + known.additive[g * 2 + i] + of_s;
            assert!((found[g * 2 + i] - expected).abs() < 1e-12);
        }
    }
    let gain = Matrix::from_row_slice(1, 2, &[0.6, -0.2]);
    let strain = Matrix::from_row_slice(2, 2, &found);
    let passed = (&gain * strain * gain.transpose())[(0, 0)] * 1.5 * 1.5;
    let forms = known.load_forms(&gain);
    assert!((forms.variance(0, &f) - passed).abs() < 1e-12);
    // Between two states, terms that do not depend on the loads cancel. The change is then computed as if the loads counted from the center.
    let plain = Uncertainty {
        additive: Vec::new(),
        center: Vec::new(),
        ..known.clone()
    };
    let change = plain.load_forms(&gain).variance(0, &f);
    assert!((forms.variance_of_change(0, &f) - change).abs() < 1e-12);
}

/// The added covariance is `relative^2 s s'`. Only the standard deviation of strain along S itself grows by it.
#[test]
fn a_common_scale_adds_its_share_of_the_strain() {
    let s = Matrix::from_row_slice(2, 2, &[1.0, 2.0, 3.0, -1.0]);
    let (mut known, _) = build_uncertainty();
    known.center = Vec::new();
    let before = known.strain_covariance(2, &[1.0, 2.0]);
    known.add_common_scale(&s, 0.03);
    let after = known.strain_covariance(2, &[1.0, 2.0]);
    let strain = [5.0, 1.0];
    for i in 0..4 {
        let added = (0.03 / 1.5_f64).powi(2) * strain[i / 2] * strain[i % 2];
        assert!((after[i] - before[i] - added).abs() < 1e-12);
    }
}

/// Loads in other units, and a load that is a sum of them, have the same covariance of strain on either side of the center. It is no smaller if loads
/// with a center are left out, or if the sum is not along the center.
#[test]
fn other_units_and_sums_of_loads_are_no_less_uncertain() {
    let (known, _) = build_uncertainty();
    let diagonal = |u: &Uncertainty, f: &[f64]| {
        let c = u.strain_covariance(2, f);
        [c[0], c[3]]
    };
    let is_no_less =
        |wide: [f64; 2], own: [f64; 2]| wide.iter().zip(own).all(|(w, o)| *w >= o - 1e-12);
    for t in [-3.0, -1.0, 0.0, 0.5, 2.0, 10.0] {
        let f = [0.7 * t, 1.3 * t];
        let turned = known.of_loads(&[(1, 10.0), (0, 0.1)]);
        let (a, b) = (
            diagonal(&turned, &[0.13 * t, 7.0 * t]),
            diagonal(&known, &f),
        );
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
        let along = known.combine_loads(&[0.7, 1.3]);
        assert!(
            is_no_less(diagonal(&along, &[t]), diagonal(&known, &f)),
            "{t}"
        );
        let one = known.of_loads(&[(0, 1.0)]);
        assert!(
            is_no_less(diagonal(&one, &[t]), diagonal(&known, &[t, 0.0])),
            "{t}"
        );
        let centered = known.combine_loads(&[2.0, -1.0]);
        let (a, b) = (diagonal(&centered, &[t]), diagonal(&known, &[2.0 * t, -t]));
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
    }
}
