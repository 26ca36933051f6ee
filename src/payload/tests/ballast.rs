//! Masses from reactions that statics gives.

use crate::payload::{BallastSpec, size_ballast};

/// Returns the reactions of four wheels of a rigid frame at x = 0 and 10, y = -1 and 1, on springs of equal rate.
fn unit(at: [f64; 2]) -> Vec<f64> {
    [(0.0, -1.0), (0.0, 1.0), (10.0, -1.0), (10.0, 1.0)]
        .iter()
        .map(|(x, y)| 0.25 * (1.0 + (x - 5.0) * (at[0] - 5.0) / 25.0 + y * at[1]))
        .collect()
}

fn spec(masses: usize, sigma: f64) -> BallastSpec {
    BallastSpec {
        masses,
        region: [[0.0, 10.0], [-1.0, 1.0]],
        largest: 100.0,
        sigma: vec![sigma; 4],
    }
}

fn add_mass_reactions(masses: &[(f64, [f64; 2])], before: &[f64]) -> Vec<f64> {
    let mut r = before.to_vec();
    for (w, at) in masses {
        for (r, u) in r.iter_mut().zip(unit(*at)) {
            *r += w * u;
        }
    }
    r
}

#[test]
fn one_mass_is_found_with_its_place_and_a_range_that_holds_the_truth() {
    let before = [10.0, 12.0, 20.0, 18.0];
    let m = add_mass_reactions(&[(40.0, [7.0, 0.3])], &before);
    let fit = size_ballast(&before, &m, unit, &spec(1, 0.05));
    let b = fit.masses[0];
    assert!((b.weight - 40.0).abs() < 1e-3, "{b:?}");
    assert!(
        (b.at[0] - 7.0).abs() < 1e-3 && (b.at[1] - 0.3).abs() < 1e-3,
        "{b:?}"
    );
    assert_eq!(fit.fixed, 3);
    // The total is the sum of four readings. Its 95 % interval is 1.96 * 0.05 * 2 on either side, on the grid of the search.
    assert!(b.weight_range[0] < 40.0 && b.weight_range[1] > 40.0 - 1e-3);
    assert!(b.weight_range[1] - b.weight_range[0] < 2.0 * 1.96 * 0.05 * 2.0 + 1e-6);
}

#[test]
fn two_masses_match_every_reaction_and_only_total_and_centre_count_as_fixed() {
    let before = [10.0, 12.0, 20.0, 18.0];
    let truth = [(30.0, [2.0, 0.2]), (50.0, [8.0, -0.4])];
    let m = add_mass_reactions(&truth, &before);
    let fit = size_ballast(&before, &m, unit, &spec(2, 0.05));
    for (r, m) in fit.reactions.iter().zip(&m) {
        assert!((r - m).abs() < 1e-3 * m, "{fit:?}");
    }
    let total: f64 = fit.masses.iter().map(|b| b.weight).sum();
    let along: f64 = fit.masses.iter().map(|b| b.weight * b.at[0]).sum::<f64>() / total;
    let across: f64 = fit.masses.iter().map(|b| b.weight * b.at[1]).sum::<f64>() / total;
    assert!((total - 80.0).abs() < 1e-2, "{total}");
    assert!((along - 5.75).abs() < 1e-2, "{along}");
    assert!((across - (-0.175)).abs() < 1e-2, "{across}");
    assert_eq!(
        fit.fixed, 3,
        "a rigid frame determines three numbers of any number of masses"
    );
    for (b, (w, at)) in fit.masses.iter().zip(truth) {
        assert!(b.weight_range[0] <= w && w <= b.weight_range[1], "{b:?}");
        assert!(
            b.at_range[0][0] <= at[0] && at[0] <= b.at_range[0][1],
            "{b:?}"
        );
    }
}

#[test]
fn bounds_are_kept_where_the_data_ask_for_more() {
    let before = [10.0, 12.0, 20.0, 18.0];
    let m = add_mass_reactions(&[(40.0, [14.0, 0.0])], &before);
    let fit = size_ballast(&before, &m, unit, &spec(1, 0.05));
    let b = fit.masses[0];
    assert!(
        b.at[0] <= 10.0 && b.weight <= 100.0 && b.weight >= 0.0,
        "{b:?}"
    );
    assert!(
        fit.chi2 > 100.0,
        "a mass beyond the region can't be matched"
    );
}
