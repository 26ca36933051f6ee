//! Search for the known name nearest to a misspelt one.

/// Returns the known name that differs from `word` by one letter: added, omitted, replaced, or exchanged with its neighbour. If several names fit,
/// the name with the longest common beginning is chosen, then the shortest.
pub(super) fn find_nearest_name(
    word: &str,
    known: impl Iterator<Item = &'static str>,
) -> Option<&'static str> {
    let near = known.filter(|k| differs_by_one(k, word));
    near.min_by_key(|k| (std::cmp::Reverse(common_prefix_length(k, word)), k.len()))
}

/// Returns the number of letters that two words share at their beginning.
fn common_prefix_length(a: &str, b: &str) -> usize {
    a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count()
}

/// Returns whether the distance of two words is 1.
fn differs_by_one(a: &str, b: &str) -> bool {
    let same = common_prefix_length(a, b);
    let (a, b) = (a.as_bytes().get(same..), b.as_bytes().get(same..));
    let (a, b) = (a.unwrap_or_default(), b.unwrap_or_default());
    match (a, b) {
        ([_, x @ ..], [_, y @ ..]) if x == b || a == y || x == y => true,
        ([p, q, x @ ..], [r, s, y @ ..]) => (p, q, x) == (s, r, y),
        ([], [_]) | ([_], []) => true,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the number of letters to add, omit, replace or exchange with their neighbour to change one word into the other.
    ///
    /// # Reference
    /// Optimal string alignment, after F. J. Damerau (1964), Communications of the ACM 7, 171.
    fn distance(a: &str, b: &str) -> usize {
        let (a, b) = (a.as_bytes(), b.as_bytes());
        let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
        for i in 1..=a.len() {
            let mut row = vec![i];
            for j in 1..=b.len() {
                let at = |r: usize, c: usize| rows.get(r).and_then(|r| r.get(c)).copied();
                let same = a.get(i - 1) == b.get(j - 1);
                let replaced = at(i - 1, j - 1).unwrap_or(0) + usize::from(!same);
                let left_out = at(i - 1, j).unwrap_or(0) + 1;
                let added = row.last().copied().unwrap_or(0) + 1;
                let mut least = replaced.min(left_out).min(added);
                let crossed =
                    i > 1 && j > 1 && a.get(i - 1) == b.get(j - 2) && a.get(i - 2) == b.get(j - 1);
                if let (true, Some(before)) = (crossed, at(i.wrapping_sub(2), j.wrapping_sub(2))) {
                    least = least.min(before + 1);
                }
                row.push(least);
            }
            rows.push(row);
        }
        rows.last().and_then(|r| r.last()).copied().unwrap_or(0)
    }

    #[test]
    fn words_that_differ_by_one_are_those_at_distance_one() {
        // Pairs of all words of up to four letters from an alphabet of three letters.
        let mut words = vec![String::new()];
        for first in 0.. {
            let Some(word) = words.get(first).filter(|w| w.len() < 4).cloned() else {
                break;
            };
            words.extend(["A", "B", "C"].map(|letter| format!("{word}{letter}")));
        }
        assert_eq!(words.len(), 121);
        for a in &words {
            for b in &words {
                assert_eq!(differs_by_one(a, b), distance(a, b) == 1, "{a} {b}");
            }
        }
    }
}
