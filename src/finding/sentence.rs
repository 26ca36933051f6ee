//! Sentences of findings: a capital letter and a full stop.

/// Returns a text with a capital first letter.
pub fn capitalize(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Returns a clause about `subject` as a sentence with a full stop. It begins with a capital letter unless it begins with a name, a number or code.
pub(super) fn sentence(clause: &str, subject: &str) -> String {
    let clause = clause.trim_end();
    let first = clause.split_whitespace().next().unwrap_or_default();
    let letters = first.trim_end_matches([',', ':', ';']);
    let is_word = !letters.is_empty() && letters.chars().all(|c| c.is_ascii_lowercase());
    let is_name = subject
        .split([',', ' '])
        .next()
        .is_some_and(|name| name == letters);
    let text = match is_word && !is_name {
        true => capitalize(clause),
        false => clause.to_owned(),
    };
    match clause.is_empty() || clause.ends_with(['.', '?', '!']) {
        true => text,
        false => text + ".",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clause_becomes_a_sentence_and_a_name_stays_as_it_is() {
        let sentence_of_left = |clause| sentence(clause, "left, right");
        assert_eq!(sentence_of_left("the gauge is dead"), "The gauge is dead.");
        assert_eq!(
            sentence_of_left("left has no signal"),
            "left has no signal."
        );
        assert_eq!(sentence_of_left("k_s is unknown"), "k_s is unknown.");
        assert_eq!(sentence_of_left("`a` is 1"), "`a` is 1.");
        assert_eq!(sentence_of_left("It is done. "), "It is done.");
        assert_eq!(sentence_of_left(""), "");
    }
}
