//! Runs that a calibration does not use or does not contain: with many of them, the model does not fit.

use super::types::Coverage;
use crate::estimate::{COVERAGE, TOO_FEW, chance_of_so_few};
use crate::finding::{Finding, Severity};

/// Share of the runs that may be excluded as suspect: labels and zeros are wrong in one run of twenty, seldom in one of ten.
const MOST: f64 = 0.1;

/// Returns an error if more than a tenth of the runs is excluded as suspect.
pub(super) fn too_many(excluded: usize, runs: usize) -> Option<Finding> {
    let share = excluded as f64 / runs.max(1) as f64;
    // A single excluded run may be one wrong label, even if it is more than this share of a few runs.
    (excluded > 1 && share > MOST).then(|| {
        Finding::new(
            Severity::Error,
            "calibration-runs-excluded",
            "calibration",
            format!(
                "{excluded} of {runs} runs contradict the others, and the intervals do not include them: the model of the strain does not fit these runs",
            ),
            "correct labels, zeros and loads of these runs in the files, or exclude them with `[calibration] runs`; if they are right, \
             loads act that the job does not contain",
        )
        .with_numbers(share, MOST)
    })
}

/// Returns an error if significantly fewer than 95 % of the left-out runs are within their 95 % regions.
pub(super) fn held_too_few(coverage: &Coverage) -> Option<Finding> {
    let of = coverage.of;
    let chance = chance_of_so_few(coverage.held, of);
    (chance < TOO_FEW).then(|| {
        let share = coverage.held as f64 / of as f64;
        Finding::new(
            Severity::Error,
            "calibration-coverage-low",
            "calibration",
            format!(
                "the 95 % regions of the left-out runs contain {} of {of} known loads, {:.0} % (probability {chance:.1e} for correct \
                 regions): intervals are too narrow",
                coverage.held,
                100.0 * share
            ),
            "check for runs with a wrong label or zero, and for loads that are not in the job. Check whether strain is proportional to the loads",
        )
        .with_numbers(share, COVERAGE)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Binomial tails of 0.95: 16 or fewer of 20 intervals contain the load with 1.6 %, 15 or fewer with 0.26 % (tables).
    #[test]
    fn a_tally_far_below_its_promise_is_an_error_and_chance_is_not() {
        let tally = |held, of| Coverage {
            held,
            of,
            factor: 1.0,
        };
        assert!(held_too_few(&tally(16, 20)).is_none());
        assert!(held_too_few(&tally(0, 0)).is_none());
        let found = held_too_few(&tally(15, 20)).unwrap();
        assert_eq!(
            (found.severity, found.code),
            (Severity::Error, "calibration-coverage-low")
        );
        assert!(held_too_few(&tally(283, 338)).is_some());
    }

    #[test]
    fn a_tenth_of_the_runs_may_be_excluded() {
        assert!(too_many(1, 10).is_none());
        assert!(too_many(2, 19).is_some() && too_many(32, 370).is_none());
    }
}
