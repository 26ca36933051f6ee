//! The closest of a list of names, for messages about misspelt ones.

/// The name closest to `word` by edit distance, where it is close enough to be meant (two letters, or a third of them).
pub fn closest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word_lower = word.to_lowercase();
    let n = word.chars().count();
    let limit = (n / 3).max(if n > 3 { 2 } else { 1 });
    names
        .into_iter()
        .map(|n| (edit_distance(&word_lower, &n.to_lowercase()), n))
        .filter(|(d, _)| *d <= limit)
        .min_by_key(|(d, _)| *d)
        .map(|(_, n)| n)
}

/// What to do about an unknown name: the closest, else the list.
pub fn remedy<'a>(word: &str, names: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match closest(word, names.clone()) {
        Some(n) => format!("did you mean `{n}`?"),
        None => {
            let list: Vec<String> = names.into_iter().map(|n| format!("`{n}`")).collect();
            format!("known here: {}", list.join(", "))
        }
    }
}

/// Levenshtein distance, a transposition counted as one.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for (i, ca) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, cb) in b.iter().enumerate() {
            let change = rows[i][j] + usize::from(ca != cb);
            let mut best = change.min(rows[i][j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i - 1] == *cb && *ca == b[j - 1] {
                best = best.min(rows[i - 1][j - 1] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows.last().and_then(|r| r.last()).copied().unwrap_or(0)
}
