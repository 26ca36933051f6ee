use super::Precision;

#[test]
fn inverse_and_determinant_of_a_two_by_two_covariance_are_those_of_the_closed_form() {
    // [[4, 1], [1, 3]]: determinant 11, inverse [[3, -1], [-1, 4]] / 11.
    let p = Precision::from_covariance(&[4.0, 1.0, 1.0, 3.0], 2).expect("positive definite");
    assert!((p.log_det() - 11f64.ln()).abs() < 1e-12);
    assert!(
        (p.entry(0, 0) - 3.0 / 11.0).abs() < 1e-14 && (p.entry(1, 0) + 1.0 / 11.0).abs() < 1e-14
    );
    assert!((p.quadratic_sparse(&[(0, 2.0), (1, 1.0)]) - (12.0 - 4.0 + 4.0) / 11.0).abs() < 1e-14);
    let (dense, sparse) = (p.apply(&[2.0, 1.0]), p.apply_sparse(&[(0, 2.0), (1, 1.0)]));
    for (i, closed) in [5.0 / 11.0, 2.0 / 11.0].into_iter().enumerate() {
        assert!((dense[i] - closed).abs() < 1e-14 && (sparse[i] - closed).abs() < 1e-14);
    }
}

#[test]
fn precision_times_covariance_is_the_identity() {
    let n = 60;
    let entry =
        |i: usize, j: usize| (-(i.abs_diff(j) as f64) / 7.0).exp() + if i == j { 0.5 } else { 0.0 };
    let a: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
    let p = Precision::from_covariance(&a, n).expect("positive definite");
    for i in 0..n {
        for j in 0..n {
            let product: f64 = (0..n).map(|k| entry(i, k) * p.entry(k, j)).sum();
            assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-10);
        }
    }
}

#[test]
fn a_covariance_that_is_not_positive_definite_has_no_precision() {
    assert!(Precision::from_covariance(&[1.0, 2.0, 2.0, 1.0], 2).is_none());
}
