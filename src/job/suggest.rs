//! The closest of a list of names, for messages about misspelt ones.

use crate::finding::list_few;

/// Largest number of characters of a word that may be misspelt; longer text is not a word.
const WORD: usize = 200;

/// Returns the name closest to `word` by edit distance, if it is close enough (two letters, or a third of the letters).
pub fn find_closest_name<'a>(
    word: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let word_lower = word.to_lowercase();
    let n = word.chars().count();
    let limit = (n / 3).max(if n > 3 { 2 } else { 1 });
    // The difference in length is a lower bound of the edit distance.
    let is_near = |name: &&str| n <= WORD && name.chars().count().abs_diff(n) <= limit;
    names
        .into_iter()
        .filter(is_near)
        .map(|n| (edit_distance(&word_lower, &n.to_lowercase()), n))
        .filter(|(d, _)| *d <= limit)
        .min_by_key(|(d, _)| *d)
        .map(|(_, n)| n)
}

/// Returns the name that `word` misspells by one letter, or by two of eight; `None` for short words, which are close to any name.
pub fn misspelt<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = find_closest_name(word, names)?;
    let distance = edit_distance(&word.to_lowercase(), &name.to_lowercase());
    let letters = word.chars().count().min(name.chars().count());
    (4 * distance <= letters).then_some(name)
}

/// Returns the remedy for an unknown name: the closest known name, else the list of names.
pub fn remedy<'a>(word: &str, names: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match find_closest_name(word, names.clone()) {
        Some(n) => format!("did you mean `{n}`?"),
        None => {
            let list: Vec<String> = names.into_iter().map(|n| format!("`{n}`")).collect();
            format!("known here: {}", list.join(", "))
        }
    }
}

/// Returns the remedy for a table without the column of row names: `general`, with the header closest to `word` if one is close.
pub fn header_remedy<'a>(
    word: &str,
    headers: impl IntoIterator<Item = &'a str>,
    general: &str,
) -> String {
    find_closest_name(word, headers).map_or_else(
        || general.to_owned(),
        |h| format!("{general}: did you mean `{h}` for `{word}`?"),
    )
}

/// Returns the remedy for gauges without a column: the closest columns, each with its gauge, or a general remedy. A column that is close to several
/// gauges is listed only for the closest gauge.
pub fn column_remedy(gauges: &[&str], columns: &[&str]) -> String {
    let mut pairs: Vec<(usize, &str, &str)> = Vec::new();
    for gauge in gauges {
        let column = find_closest_name(gauge, columns.iter().copied());
        pairs.extend(column.map(|c| {
            (
                edit_distance(&gauge.to_lowercase(), &c.to_lowercase()),
                c,
                *gauge,
            )
        }));
    }
    pairs.sort_unstable();
    let mut suggestions: Vec<(usize, &str, &str)> = Vec::new();
    for p in pairs {
        if suggestions.iter().all(|t| t.1 != p.1) {
            suggestions.push(p);
        }
    }
    if suggestions.is_empty() {
        return "name the columns after the gauges".to_owned();
    }
    let list: Vec<String> = suggestions
        .iter()
        .map(|(_, c, g)| format!("`{c}` for `{g}`"))
        .collect();
    format!(
        "name the columns after the gauges: did you mean {}?",
        list_few(&list)
    )
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
