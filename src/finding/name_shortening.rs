//! How much of a file a message repeats.

/// Characters of a name or a path. Longer ones do not occur in practice and are shown by their beginning and their end.
const NAME: usize = 160;
/// Characters of a message.
const TEXT: usize = 4000;

/// Returns the text with overlong names, and an overlong message, cut in the middle. A file may contain a name of a megabyte, and nobody reads a
/// message that repeats it.
pub fn shorten_names(text: impl Into<String>) -> String {
    let text = text.into();
    if text.len() <= NAME {
        return text;
    }
    let ends_name = |c: char| c.is_whitespace() || c == '`';
    let names: String = text
        .split_inclusive(ends_name)
        .map(|piece| {
            let name = piece.trim_end_matches(ends_name);
            let end = piece.get(name.len()..).unwrap_or_default();
            cut(name, NAME) + end
        })
        .collect();
    cut(&names, TEXT)
}

/// Returns the text, cut if it is longer than `most` characters: two thirds of `most` from its beginning and a quarter from its end.
fn cut(text: &str, most: usize) -> String {
    if text.len() <= most || text.chars().count() <= most {
        return text.to_owned();
    }
    let head: String = text.chars().take(2 * most / 3).collect();
    let mut tail: Vec<char> = text.chars().rev().take(most / 4).collect();
    tail.reverse();
    head + "…" + &tail.into_iter().collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_a_megabyte_is_shown_by_its_ends_and_what_people_write_is_left_as_it_is() {
        let message =
            "`strain.csv`: columns that belong to no gauge are left out: P1, P2, [µm/m] äöü";
        assert_eq!(shorten_names(message.repeat(3)), message.repeat(3));
        let name = format!("a{}z", "µ".repeat(1_000_000));
        let message = shorten_names(format!("no column `{name}` in `strain.csv`: rename it"));
        assert!(message.chars().count() < 250, "{message}");
        assert!(
            message.starts_with("no column `aµ")
                && message.ends_with("µz` in `strain.csv`: rename it")
        );
        let many: Vec<String> = (0..300_000).map(|i| format!("`c{i}`")).collect();
        let message = shorten_names(many.join(", "));
        assert!(
            message.chars().count() <= TEXT && message.ends_with("`c299999`"),
            "{message}"
        );
    }
}
