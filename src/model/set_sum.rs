//! Sets that sum other sets (LOAD, SPCADD, MPCADD): in which order they can be written out, and which name each other in a circle.

use std::collections::{BTreeMap, BTreeSet};

/// Loads or sets in all sums of a deck. Above this limit a few cards would need more memory than a model of their size.
pub(super) const MOST_TERMS: usize = 4_000_000;

/// Order of sums of sets. Each sum follows the sums that it names. Circles of sums have no such order and are listed separately.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct SumOrder {
    /// Ids of the sums in this order.
    pub ready: Vec<u32>,
    /// Each circle as a list of ids, from the smallest id on. Every id names the next id, and the last id names the first.
    pub circles: Vec<Vec<u32>>,
}

/// Returns the order of sums. `names` contains the sets that each sum names, including sets that are not sums.
///
/// # Reference
/// Kahn, Topological sorting of large networks, Communications of the ACM 5 (1962): linear in the number of names.
pub(super) fn sum_order(names: &BTreeMap<u32, BTreeSet<u32>>) -> SumOrder {
    let mut named_by: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut open: BTreeMap<u32, usize> = BTreeMap::new();
    for (sum, sets) in names {
        let sums = sets.iter().filter(|s| names.contains_key(s));
        let mut n = 0;
        for other in sums {
            named_by.entry(*other).or_default().push(*sum);
            n += 1;
        }
        open.insert(*sum, n);
    }
    let mut out = SumOrder::default();
    let mut free: Vec<u32> = open.iter().filter(|o| *o.1 == 0).map(|o| *o.0).collect();
    while let Some(sum) = free.pop() {
        open.remove(&sum);
        for later in named_by.get(&sum).into_iter().flatten() {
            if let Some(n) = open.get_mut(later) {
                *n = n.saturating_sub(1);
                if *n == 0 {
                    free.push(*later);
                }
            }
        }
        out.ready.push(sum);
    }
    out.circles = circles(names, open.into_keys().collect());
    out
}

/// The circles among sums that each name another of them.
fn circles(names: &BTreeMap<u32, BTreeSet<u32>>, mut left: BTreeSet<u32>) -> Vec<Vec<u32>> {
    let mut out = Vec::new();
    while let Some(&start) = left.first() {
        let (mut path, mut place) = (Vec::new(), BTreeMap::new());
        let mut at = Some(start);
        while let Some(sum) = at {
            if let Some(&from) = place.get(&sum) {
                let mut circle: Vec<u32> = path.iter().copied().skip(from).collect();
                let smallest = (0..circle.len()).min_by_key(|i| circle.get(*i));
                circle.rotate_left(smallest.unwrap_or(0));
                out.push(circle);
                break;
            }
            place.insert(sum, path.len());
            path.push(sum);
            at = names
                .get(&sum)
                .and_then(|sets| sets.iter().copied().find(|s| left.contains(s)));
        }
        path.iter().for_each(|s| {
            left.remove(s);
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(names: &[(u32, &[u32])]) -> SumOrder {
        let names = names
            .iter()
            .map(|(sum, sets)| (*sum, sets.iter().copied().collect()))
            .collect();
        sum_order(&names)
    }

    #[test]
    fn a_sum_comes_after_those_it_names() {
        let found = order(&[(1, &[7, 2]), (2, &[3, 8]), (3, &[9])]);
        assert_eq!(found.ready, [3, 2, 1]);
        assert!(found.circles.is_empty());
    }

    #[test]
    fn circles_are_named_as_they_go_and_what_hangs_on_them_is_not_written_out() {
        let found = order(&[
            (1, &[2]),
            (2, &[5]),
            (5, &[3]),
            (3, &[2]),
            (8, &[8]),
            (4, &[9]),
        ]);
        assert_eq!(found.ready, [4]);
        assert_eq!(found.circles, [vec![2, 5, 3], vec![8]]);
    }
}
