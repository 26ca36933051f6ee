//! Removal of effects that do not reduce the gap on data that was not fitted.

use super::checks::Fall;
use super::search::ScoredSet;

/// Effect that is removed from a set, with the gap of the set with and without it.
pub(super) struct Useless {
    /// Candidate number.
    pub candidate: usize,
    /// Gap of the set with it.
    pub with: f64,
    /// Gap of the set without it.
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

/// Returns `set` without names by which the gap does not fall, and these names, in the order in which they go. A single name stays, and the
/// checks of the set compare it with no effect at all.
///
/// As long as the gap does not fall by one of them, the name goes by which it rises most beyond its sampling error. If it rises by none, the name
/// goes that costs least log evidence among all by which it does not fall beyond that error: of two effects that look alike, the fitted data choose.
///
/// `names` are those of a set. `compared` gives the gap of a set and, for each of these names, the set without it (`None` where it has no
/// fit). It gives `None` where nothing can be compared, or work is to stop.
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
        // A name by which the gap rises beyond that error goes before all others, the worst first.
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

    /// Squared gaps and log evidence of sets: of three names the gap does not fall by 2, and beyond its error of 1 not by 0 either. The fitted data
    /// need 2 more than 0, so 0 goes; then each of the two that are left lowers the gap.
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
