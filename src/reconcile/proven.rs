//! Sets without names that prove nothing: by which the gap does not fall on what was not fitted.

use super::search::Scored;

/// A name that is left out, with the gap with and without it.
pub(super) struct Useless {
    /// Candidate number.
    pub candidate: usize,
    /// Gap of the set with it.
    pub with: f64,
    /// Gap of the set without it.
    pub without: f64,
}

/// `set` without names beside others by which the gap does not fall, one after the other, the one that raises it most first. A single name
/// is held against no effect at all by whoever judges the set.
///
/// `names` are those of a set. `compared` is the gap of a set and, of each of these names in turn, that of the set without it, with its fit
/// (`None` where that can't be had); on the same readings. It gives `None` where nothing can be compared, or work is to stop.
pub(super) fn without_useless<F>(
    mut set: Scored<F>,
    names: impl Fn(&Scored<F>) -> Vec<usize>,
    mut compared: impl FnMut(&Scored<F>, &[usize]) -> Option<(f64, Vec<Option<(f64, Scored<F>)>>)>,
) -> (Scored<F>, Vec<Useless>) {
    let mut left_out = Vec::new();
    loop {
        let own = names(&set);
        if own.len() < 2 {
            break;
        }
        let Some((with, fewer)) = compared(&set, &own) else {
            break;
        };
        let useless = own
            .into_iter()
            .zip(fewer)
            .filter_map(|(c, f)| f.map(|(gap, fit)| (c, gap, fit)))
            .filter(|(_, gap, _)| *gap <= with)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((candidate, without, fit)) = useless else {
            break;
        };
        left_out.push(Useless {
            candidate,
            with,
            without,
        });
        set = fit;
    }
    (set, left_out)
}

#[cfg(test)]
mod tests {
    use super::{Scored, without_useless};

    /// Gaps of sets by hand: of three names 2 raises the gap most, then 0 does not lower it, 1 does.
    #[test]
    fn names_by_which_the_gap_does_not_fall_go_one_after_the_other_and_the_last_stays() {
        let gap = |set: &[usize]| match set {
            [0, 1, 2] => 5.0,
            [0, 1] => 2.0,
            [0, 2] => 9.0,
            [1, 2] => 4.0,
            [1] => 2.0,
            [0] => 8.0,
            _ => f64::NAN,
        };
        let scored = |set: Vec<usize>| Scored {
            set,
            log_evidence: 0.0,
            fit: (),
        };
        let (left, out) = without_useless(
            scored(vec![0, 1, 2]),
            |s| s.set.clone(),
            |s, names| {
                let without = |c: &usize| {
                    let rest: Vec<usize> = s.set.iter().copied().filter(|m| m != c).collect();
                    Some((gap(&rest), scored(rest)))
                };
                Some((gap(&s.set), names.iter().map(without).collect()))
            },
        );
        assert_eq!(left.set, [1]);
        let told: Vec<(usize, f64, f64)> = out
            .iter()
            .map(|u| (u.candidate, u.with, u.without))
            .collect();
        assert_eq!(told, [(2, 5.0, 2.0), (0, 2.0, 2.0)]);
    }
}
