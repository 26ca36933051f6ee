//! Layouts with the smallest condition number.

use super::*;
use crate::linalg::{Matrix, dense};
use crate::placement::condition;

#[test]
fn eigenvalues_of_a_chain_of_springs_are_those_in_closed_form() {
    // The matrix has 2 on the diagonal and -1 next to it. Its eigenvalues are 2 - 2 cos(i pi / (k + 1)).
    for k in [1, 2, 6, 36] {
        let mut a = vec![0.0; k * k];
        for i in 0..k {
            a[i * k + i] = 2.0;
            if i > 0 {
                a[i * k + i - 1] = -1.0;
                a[(i - 1) * k + i] = -1.0;
            }
        }
        for (i, e) in spd::eigenvalues(&a, k).into_iter().enumerate() {
            let angle = (i + 1) as f64 * std::f64::consts::PI / (k + 1) as f64;
            // Tolerance for the rounding of some hundred rotations.
            assert!((e - (2.0 - 2.0 * angle.cos())).abs() < 1e-13, "{k} {i} {e}");
        }
    }
}

#[test]
fn layouts_for_the_condition_number_are_within_a_fifth_of_the_least_of_all_subsets() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    for trial in 0..60 {
        let (k, n) = (2 + trial % 3, 12);
        let s = k + trial % 4;
        let c = rows_of(&random_rows(&mut rng, n, k));
        let of = |gauges: &[Choice]| {
            let rows: Vec<Vec<f64>> = gauges.iter().map(|&g| c.row(g)).collect();
            dense::condition(&Matrix::from_fn(s, k, |i, j| rows[i][j]))
        };
        let least = subsets(n, s)
            .map(|p| {
                let at = |&p: &usize| Choice {
                    place: p as u32,
                    step: 0,
                    angle: 0.0,
                };
                of(&p.iter().map(at).collect::<Vec<_>>())
            })
            .fold(f64::INFINITY, f64::min);
        let spec = Spec::new(s, k);
        let by_d = place(&c, &spec).unwrap();
        let got = condition::find_least_condition(&c, &spec, &by_d, &vec![0.0; k * k]).unwrap();
        assert_eq!(got.gauges.len(), s);
        let own = of(&got.gauges);
        // The eigenvalues of S'S give the square of the condition number, so the tolerance is wider.
        assert!((own - got.condition).abs() < 1e-6 * own, "trial {trial}");
        assert!(own <= 1.2 * least, "trial {trial}: {own} against {least}");
        assert!(got.least >= least * (1.0 - 1e-6) && got.least <= own * (1.0 + 1e-6));
    }
}

#[test]
fn a_layout_for_the_condition_number_keeps_the_spacing() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    let c = rows_of(&random_rows(&mut rng, 40, 3))
        .with_positions((0..40).map(|i| [f64::from(i), 0.0, 0.0]).collect());
    let spec = Spec {
        spacing: 3.0,
        ..Spec::new(6, 3)
    };
    let by_d = place(&c, &spec).unwrap();
    let got = condition::find_least_condition(&c, &spec, &by_d, &[0.0; 9]).unwrap();
    let mut places: Vec<u32> = got.gauges.iter().map(|g| g.place).collect();
    places.sort_unstable();
    assert!(places.windows(2).all(|w| w[1] - w[0] >= 3), "{places:?}");
}
