//! Removal of effects that do not reduce the gap on data that was not fitted.

use super::checks::Fall;
use super::search::ScoredSet;

/// Effect that is removed from a set, with the gap of the set with and without it.
pub(super) struct Useless {
    /// Candidate number.
    pub candidate: usize,
    /// Gap of the set with the effect.
    pub with: f64,
    /// Gap of the set without the effect.
    pub without: f64,
}

/// Set of effects without one of its members.
pub(super) struct ReducedEffectSet<F> {
    /// Gap of the smaller set, on the readings that the whole set is compared on.
    pub gap: f64,
    /// Fall of the gap due to the removed effect.
    pub fall: Fall,
    /// Fit of the smaller set.
    pub fit: ScoredSet<F>,
}

/// Returns `set` without the effects that do not reduce the gap, and these effects in the order of their removal. A single effect stays, and the
/// checks of the set compare it with no effect at all.
///
/// While at least one effect does not reduce the gap, one effect is removed. If effects increase the gap by more than its sampling error, the effect
/// with the largest increase is removed. Otherwise it is the effect whose removal costs least log evidence, among all effects that do not reduce the
/// gap by more than that error. Of two indistinguishable effects, the fitted data therefore choose.
///
/// `names` returns the effects of a set. `compared` returns the gap of a set and, for each of these effects, the set without it (`None` if that set
/// has no fit). It returns `None` if no comparison is possible, or if a stop is requested.
pub(super) fn without_useless<F>(
    mut set: ScoredSet<F>,
    names: impl Fn(&ScoredSet<F>) -> Vec<usize>,
    mut compared: impl FnMut(&ScoredSet<F>, &[usize]) -> Option<(f64, Vec<Option<ReducedEffectSet<F>>>)>,
) -> (ScoredSet<F>, Vec<Useless>) {
    let mut left_out = Vec::new();
    loop {
        let own = names(&set);
        if own.len() < 2 {
            break;
        }
        let Some((with, fewer)) = compared(&set, &own) else {
            break;
        };
        let fewer = own.into_iter().zip(fewer);
        let mut unseen: Vec<(usize, ReducedEffectSet<F>)> = fewer
            .filter_map(|(c, f)| f.map(|f| (c, f)))
            .filter(|(_, f)| !f.fall.is_seen())
            .collect();
        if unseen.iter().all(|(_, f)| f.fall.by > 0.0) {
            break;
        }
        // An effect that increases the gap by more than this error is removed before all others, the largest increase first.
        let rise = |f: &ReducedEffectSet<F>| (f.fall.by < -f.fall.error).then_some(-f.fall.by);
        unseen.sort_by(|(_, a), (_, b)| {
            let [x, y] = [a, b].map(|f| rise(f).unwrap_or(0.0));
            let evidence = b.fit.log_evidence.total_cmp(&a.fit.log_evidence);
            y.total_cmp(&x).then(evidence)
        });
        let Some((candidate, least)) = unseen.into_iter().next() else {
            break;
        };
        left_out.push(Useless {
            candidate,
            with,
            without: least.gap,
        });
        set = least.fit;
    }
    (set, left_out)
}

#[cfg(test)]
mod tests {
    use super::{Fall, ReducedEffectSet, ScoredSet, without_useless};

    /// Squared gaps and log evidence of sets of three effects.
    ///
    /// Effect 2 does not reduce the gap, and effect 0 does not reduce it by more than its error of 1. The fitted data need effect 2 more than effect
    /// 0, so effect 0 is removed. Each of the two remaining effects then reduces the gap.
    #[test]
    fn the_name_that_costs_least_evidence_goes_and_only_as_long_as_one_proves_nothing() {
        let squared = |set: &[usize]| match set {
            [0, 1, 2] => 5.0,
            [0, 1] => 5.0,
            [0, 2] => 9.0,
            [1, 2] => 5.5,
            [1] => 8.0,
            [2] => 9.0,
            _ => f64::NAN,
        };
        let scored = |set: Vec<usize>| ScoredSet {
            log_evidence: if set.contains(&2) { 50.0 } else { 10.0 },
            set,
            fit: (),
        };
        let (left, out) = without_useless(
            scored(vec![0, 1, 2]),
            |s| s.set.clone(),
            |s, names| {
                let without = |c: &usize| {
                    let rest: Vec<usize> = s.set.iter().copied().filter(|m| m != c).collect();
                    Some(ReducedEffectSet {
                        gap: squared(&rest),
                        fall: Fall {
                            by: squared(&rest) - squared(&s.set),
                            error: 1.0,
                        },
                        fit: scored(rest),
                    })
                };
                Some((squared(&s.set), names.iter().map(without).collect()))
            },
        );
        assert_eq!(left.set, [1, 2]);
        let gone: Vec<(usize, f64, f64)> = out
            .iter()
            .map(|u| (u.candidate, u.with, u.without))
            .collect();
        assert_eq!(gone, [(0, 5.0, 5.5)]);
    }
}
