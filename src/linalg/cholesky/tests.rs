use super::{Cholesky, factor_by_columns};

/// Sizes on both sides of the order from which blocks are used.
const ORDERS: [usize; 4] = [1, 30, 64, 150];

/// Returns the covariance 4 (min(i, j) + 1) of a random walk with steps of two.
///
/// L is two on and below the diagonal, so det C = 4^n. Four times the inverse of C is the second difference with a last entry of one.
fn walk(n: usize) -> Vec<f64> {
    (0..n * n)
        .map(|k| 4.0 * ((k / n).min(k % n) + 1) as f64)
        .collect()
}

#[test]
fn the_factor_of_a_random_walk_is_that_of_the_closed_form() {
    for n in ORDERS {
        let c = Cholesky::from_covariance(&walk(n), n).expect("positive definite");
        let log_det = n as f64 * 4f64.ln();
        assert!((c.log_det() / log_det - 1.0).abs() < 1e-12, "{n}");
        let x: Vec<f64> = (0..n).map(|i| ((i * 7 + 3) % 11) as f64).collect();
        // Twice L^-1 x are the steps of x.
        let steps = |i: usize| x[i] - if i > 0 { x[i - 1] } else { 0.0 };
        let chi2: f64 = (0..n).map(|i| steps(i).powi(2)).sum();
        assert!((4.0 * c.chi2(&x) / chi2 - 1.0).abs() < 1e-12, "{n}");
        let solved = c.solve(&x);
        let inverse = c.inverse();
        for i in 0..n {
            let next = if i + 1 < n { steps(i + 1) } else { 0.0 };
            assert!(
                (4.0 * solved[i] - (steps(i) - next)).abs() < 1e-9,
                "{n} {i}"
            );
            for j in 0..n {
                let closed = match i.abs_diff(j) {
                    0 if i + 1 == n => 1.0,
                    0 => 2.0,
                    1 => -1.0,
                    _ => 0.0,
                };
                assert!(
                    (4.0 * inverse[i * n + j] - closed).abs() < 1e-9,
                    "{n} {i} {j}"
                );
            }
        }
    }
}

#[test]
fn what_is_not_positive_definite_or_no_number_has_no_factor() {
    for n in ORDERS {
        for spoilt in [-1.0, f64::NAN] {
            let mut c = walk(n);
            c[n * n - 1] = spoilt;
            assert!(Cholesky::from_covariance(&c, n).is_none(), "{n} {spoilt}");
        }
        assert!(Cholesky::from_covariance(&walk(n), n + 1).is_none());
    }
}

/// Tests the method without memory for blocks, for an order at which blocks are used.
#[test]
fn columns_do_for_orders_for_which_there_are_blocks() {
    let n = 150;
    let mut columns = walk(n);
    factor_by_columns(&mut columns, n);
    let below = (0..n).flat_map(|j| (j..n).map(move |i| j * n + i));
    assert!(below.into_iter().all(|at| columns[at] == 2.0));
    let c = Cholesky::from_covariance(&walk(n), n).expect("positive definite");
    let pairs = c.inverse().into_iter().zip(c.inverse_by_columns());
    for (blocks, columns) in pairs {
        assert!((blocks - columns).abs() < 1e-9);
    }
}
