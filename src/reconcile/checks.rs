//! Checks that a set of effects must pass before it is named, for strain and for motion.

use super::outcome::Verdict;

/// A check of a set.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Check {
    /// Reason against the set; `None` where the set passes.
    pub against: Option<String>,
}

impl Check {
    /// Returns a check that `passes`, or fails for the reason `against`.
    pub fn from_condition(passes: bool, against: impl FnOnce() -> String) -> Self {
        Self {
            against: (!passes).then(against),
        }
    }

    /// Returns a check that fails if there is a reason against the set.
    pub fn unless(against: Option<String>) -> Self {
        Self { against }
    }
}

/// Returns the reasons of the checks that failed, in order.
pub(super) fn reasons(checks: &[Check]) -> Vec<String> {
    checks.iter().filter_map(|c| c.against.clone()).collect()
}

/// Returns the verdict on the best set of effects.
///
/// A set that is not empty and fails no check is named. Otherwise the verdict is `unknown` if the residual of the analyst's model exceeds its
/// expected residual (`agrees` is false). Otherwise it is `below-detectability` for a set that failed or with a `hint`, and `none` without either.
pub(super) fn verdict(is_empty: bool, checks: &[Check], agrees: bool, hint: bool) -> Verdict {
    let passes = checks.iter().all(|c| c.against.is_none());
    match (is_empty, passes, agrees) {
        (false, true, _) => Verdict::Named,
        (_, _, false) => Verdict::Unknown,
        (false, false, true) => Verdict::BelowDetectability,
        (true, _, true) if hint => Verdict::BelowDetectability,
        (true, _, true) => Verdict::None,
    }
}

/// Fall of a sum of squared residuals on data that were not fitted, with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fall {
    /// Sum of squares without the effect minus the sum with the effect.
    pub by: f64,
    /// Standard error of `by`.
    pub error: f64,
}

impl Fall {
    /// Returns the fall from the residuals `without` an effect to the residuals `with` it.
    ///
    /// With a right model, the residual of each reading has its expected size `floor`, independent of the contribution of the effect. The standard
    /// error of the fall is therefore `2 sqrt(sum floor^2 (without - with)^2)`.
    pub fn from_residuals(without: &[f64], with: &[f64], floor: &[f64]) -> Self {
        let (mut by, mut variance) = (0.0, 0.0);
        for ((a, b), f) in without.iter().zip(with).zip(floor) {
            by += a * a - b * b;
            variance += (2.0 * f * (a - b)).powi(2);
        }
        Self {
            by,
            error: variance.sqrt(),
        }
    }

    /// Returns whether the fall exceeds its standard error.
    pub fn is_seen(self) -> bool {
        self.by > self.error
    }
}

/// Returns the reason against a set of `n` effects with log evidence `level`; `None` if no alternative explains the data decisively better. The log
/// evidence of such an alternative exceeds `level` by more than `limit`, plus `decisive` for each effect that it has in excess of `n`. `alternatives`
/// are the explanations with their log evidence.
pub(super) fn describe_better_alternative<'a>(
    (n, level): (usize, f64),
    [limit, decisive]: [f64; 2],
    alternatives: impl Iterator<Item = (&'a [String], f64)>,
) -> Option<String> {
    let cost = |ids: &[String]| limit + decisive * ids.len().saturating_sub(n) as f64;
    let far = alternatives.filter(|a| a.1 - level > cost(a.0));
    let best = far.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "{} explains the fitted data better, by {:.1} of log evidence",
        best.0.join(" + "),
        best.1 - level
    ))
}

#[cfg(test)]
mod tests {
    use super::{Check, Fall, describe_better_alternative, reasons, verdict};
    use crate::reconcile::Verdict;

    #[test]
    fn one_failed_check_withholds_a_name_and_the_residual_without_it_decides_between_unknown_and_below()
     {
        let fine = [
            Check::from_condition(true, || "never".into()),
            Check::unless(None),
        ];
        let failed = [fine[0].clone(), Check::unless(Some("too small".into()))];
        assert_eq!(verdict(false, &fine, false, false), Verdict::Named);
        assert_eq!(verdict(false, &failed, false, true), Verdict::Unknown);
        assert_eq!(
            verdict(false, &failed, true, false),
            Verdict::BelowDetectability
        );
        assert_eq!(
            verdict(true, &fine, true, true),
            Verdict::BelowDetectability
        );
        assert_eq!(verdict(true, &fine, true, false), Verdict::None);
        assert_eq!(verdict(true, &fine, false, false), Verdict::Unknown);
        assert_eq!(reasons(&failed), ["too small"]);
    }

    /// Tests one reading at an expected residual of 1 that the effect fully explains. If it is off by 3, the fall is 9 with the error 2 * 3. If it is
    /// off by 1, the fall is 1 with the error 2.
    #[test]
    fn a_fall_counts_only_beyond_its_standard_error() {
        let large = Fall::from_residuals(&[3.0, 1.0], &[0.0, 1.0], &[1.0, 1.0]);
        assert_eq!((large.by, large.error), (9.0, 6.0));
        assert!(large.is_seen());
        assert!(!Fall::from_residuals(&[1.0], &[0.0], &[1.0]).is_seen());
        assert!(!Fall::from_residuals(&[1.0], &[1.0], &[1.0]).is_seen());
    }

    #[test]
    fn an_alternative_is_ahead_only_beyond_the_limit() {
        let ids = ["a".to_owned()];
        let one = |n: usize, e: f64| {
            describe_better_alternative((n, 10.0), [3.0, 5.0], [(&ids[..], e)].into_iter())
        };
        assert_eq!(one(1, 12.9), None);
        assert!(one(1, 13.1).is_some_and(|w| w.contains('a')));
        // The alternative has one effect, and the set has no effect.
        assert_eq!(one(0, 17.9), None);
        assert!(one(0, 18.1).is_some());
    }
}
