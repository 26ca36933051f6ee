//! Names that differ by case and separators alone.

/// Returns whether two names are equal apart from case and separators: `DIR_X`, `dir x` and `dirx`.
///
/// Blanks and `_`, `-`, `.`, `:`, `/` are separators. Between two digits a separator counts: `F1.1` is not `F11`. A minus at an end is a sign:
/// `FX-` is not `FX`.
pub fn is_same_name(a: &str, b: &str) -> bool {
    let (a, b) = (normalize_name(a), normalize_name(b));
    !a.is_empty() && a == b
}

/// Returns whether two names are equal apart from case and separators. Single letters must be equal, because `x` and `X` may be two loads.
pub fn is_same_word(a: &str, b: &str) -> bool {
    a.chars().filter(|c| c.is_alphanumeric()).count() > 1 && is_same_name(a, b)
}

/// Returns a name in lower case without its separators.
fn normalize_name(name: &str) -> String {
    let is_separator = |c: char| c.is_whitespace() || ['_', '-', '.', ':', '/'].contains(&c);
    let signs = |separators: &str| separators.replace(|c: char| c != '-', "");
    let (mut out, mut separators) = (String::new(), String::new());
    for c in name.chars() {
        if is_separator(c) {
            separators.push(c);
            continue;
        }
        if out.is_empty() {
            out = signs(&separators);
        } else if !separators.is_empty() && c.is_numeric() && out.ends_with(char::is_numeric) {
            out.push('.');
        }
        separators.clear();
        out.extend(c.to_lowercase());
    }
    match out.is_empty() {
        true => out,
        false => out + &signs(&separators),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn case_and_separators_do_not_count_but_signs_and_points_between_digits_do() {
        for (a, b) in [
            ("DIR_X", "dirx"),
            ("dir x", "dir_x"),
            ("B-FZ", "b.fz"),
            ("element 2", "element2"),
            ("F1.1", "f1_1"),
            ("FX-", "fx -"),
        ] {
            assert!(is_same_name(a, b), "{a} {b}");
        }
        for (a, b) in [
            ("F1.1", "F11"),
            ("FX-", "FX"),
            ("FX-", "FX+"),
            ("-FX", "FX"),
            ("_", "-"),
            ("", ""),
        ] {
            assert!(!is_same_name(a, b), "{a} {b}");
        }
        assert!(is_same_name("X", "x") && !is_same_word("X", "x"));
    }
}
