//! Text in lines of a given width.

/// Returns a text in lines of at most `width` characters. Lines after the first begin with `indent` spaces. A word wider than a line is cut.
pub fn wrap_lines(text: &str, width: usize, indent: usize) -> Vec<String> {
    let indent = indent.min(width / 2);
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    let mut used = 0;
    for word in text.split_whitespace() {
        let mut word = word;
        loop {
            let begins = used == if lines.is_empty() { 0 } else { indent };
            let n = word.chars().count();
            let gap = usize::from(!begins);
            if used + gap + n <= width {
                if !begins {
                    line.push(' ');
                }
                line.push_str(word);
                used += gap + n;
                break;
            }
            if begins {
                let at = word.char_indices().nth((width - used).max(1));
                let (head, tail) = word.split_at(at.map_or(word.len(), |a| a.0));
                line.push_str(head);
                word = tail;
            }
            lines.push(std::mem::replace(&mut line, " ".repeat(indent)));
            used = indent;
            if word.is_empty() {
                break;
            }
        }
    }
    if !line.trim().is_empty() {
        lines.push(line);
    }
    lines
}

/// Returns a text of at most `width` characters; three dots mark an omitted end.
pub(super) fn cut_to_width(text: &str, width: usize) -> String {
    match text.chars().count() <= width {
        true => text.to_owned(),
        false => {
            let kept: String = text.chars().take(width.saturating_sub(3)).collect();
            format!("{}...", kept.trim_end())
        }
    }
}
