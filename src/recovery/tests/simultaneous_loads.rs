//! Several loads at once, although each calibration run had one load.

use super::super::simultaneous_loads::{CODE, check};
use super::super::*;
use crate::estimate::LoadEstimate;
use crate::finding::Severity;
use crate::linalg::Matrix;
use crate::sensitivity::Uncertainty;

/// Returns a run of independent loads with a sigma of one each.
fn run_with_loads(run: &str, loads: [f64; 3]) -> RunEstimate {
    let one = |i: usize| if i.is_multiple_of(4) { 1.0 } else { 0.0 };
    RunEstimate {
        estimate: LoadEstimate {
            run: run.into(),
            names: ["A", "B", "C"].map(String::from).to_vec(),
            values: loads.to_vec(),
            covariance: (0..9).map(one).collect(),
            coverage_factor: 2.0,
            findings: Vec::new(),
        },
        predicted: Vec::new(),
        residual: Vec::new(),
        sd: Vec::new(),
        chi2: 0.0,
        dof: 0,
        leverage: Vec::new(),
        rank: 3,
    }
}

fn calibrated_uncertainty(one_by_one: bool) -> Uncertainty {
    Uncertainty {
        dof: 20.0,
        one_by_one,
        mean_square: (0..9).map(|i| if i % 4 == 0 { 1.0 } else { 0.0 }).collect(),
        ..Uncertainty::of_model(&Matrix::zeros(4, 3), 0.0, (&Matrix::zeros(4, 3), 0.0))
    }
}

/// Tests independent loads of equal sigma. The largest single load is nearest, and the squares of the other loads are the distance from it. For two
/// further loads and 20 degrees of freedom, `F = 9.95` has a probability of a thousandth (tables of F). `3.5^2 + 1.5^2` is within this limit, `4^2 +
/// 3^2` is not. If the strains of the loads are at right angles and equal, the two nearest single loads are the two largest estimates.
#[test]
fn a_run_with_several_loads_is_widened_until_either_of_two_alone_is_a_sigma_away() {
    let within = run_with_loads("one", [10.0, 3.5, 1.5]);
    let beyond = run_with_loads("two", [10.0, -4.0, 3.0]);
    let mut runs = [within.clone(), beyond];
    let found = check(&mut runs, &calibrated_uncertainty(true));
    let named: Vec<_> = found
        .iter()
        .map(|f| (f.subject.as_str(), f.code, f.severity))
        .collect();
    assert_eq!(named, [("two", CODE, Severity::Warning)]);
    assert_eq!(runs[0].estimate.covariance, within.estimate.covariance);
    // Sum of I, the outer product of (0, -4, 3) and the outer product of (10, 0, 3).
    let expected = [101.0, 0.0, 30.0, 0.0, 17.0, -12.0, 30.0, -12.0, 19.0];
    for (c, e) in runs[1].estimate.covariance.iter().zip(expected) {
        assert!((c - e).abs() < 1e-12, "{:?}", runs[1].estimate.covariance);
    }
}

#[test]
fn several_loads_are_no_surprise_where_known_runs_had_them_or_most_runs_do() {
    let several = || run_with_loads("two", [10.0, 9.0, 8.0]);
    assert!(check(&mut [several()], &calibrated_uncertainty(false)).is_empty());
    let mut runs = [
        several(),
        several(),
        several(),
        run_with_loads("one", [0.0, 9.0, 0.0]),
    ];
    let found = check(&mut runs, &calibrated_uncertainty(true));
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].code, found[0].severity), (CODE, Severity::Info));
    assert_eq!(runs[0].estimate.covariance, several().estimate.covariance);
}
