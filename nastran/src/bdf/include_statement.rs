//! The INCLUDE statement: its file name, quoted or not, on one line or several.

use super::fields::excerpt;
use super::line::{Line, Lines, text_of, trim};

/// Largest number of lines of one INCLUDE statement.
const MAX_NAME_LINES: usize = 16;

/// Returns the file name of an INCLUDE statement, which may continue over several lines.
pub(super) fn include_name(lines: &mut Lines) -> Result<String, String> {
    let first = lines.next().map(|l: Line| l.text).unwrap_or_default();
    let rest = trim(trim(first).get(7..).unwrap_or_default());
    let rest = rest.strip_prefix(b"=").map_or(rest, trim);
    match rest.first() {
        Some(&quote @ (b'\'' | b'"')) => {
            let mut name = Vec::new();
            let mut part = rest.get(1..).unwrap_or_default();
            for _ in 0..MAX_NAME_LINES {
                if let Some(end) = memchr::memchr(quote, part) {
                    name.extend_from_slice(trim(part.get(..end).unwrap_or_default()));
                    return Ok(text_of(&name));
                }
                name.extend_from_slice(trim(part));
                // A comma at the end of a line only marks that the name continues.
                if name.last() == Some(&b',') {
                    name.pop();
                }
                let Some(next) = lines.next() else {
                    break;
                };
                part = next.text;
            }
            Err(excerpt(rest))
        }
        Some(_) => {
            let mut name = Vec::new();
            let mut part = without_comment_after_blank(rest);
            for _ in 0..MAX_NAME_LINES {
                match trim(part) {
                    [head @ .., b','] => name.extend_from_slice(head),
                    all => {
                        name.extend_from_slice(all);
                        break;
                    }
                }
                part = lines.next().map(|l: Line| l.text).unwrap_or_default();
            }
            if name.is_empty() {
                Err(String::new())
            } else {
                Ok(text_of(&name))
            }
        }
        None => Err(String::new()),
    }
}

/// Removes a comment: a `$` after a blank begins a comment; a `$` at the start of a name begins a symbol.
fn without_comment_after_blank(s: &[u8]) -> &[u8] {
    match memchr::memmem::find(s, b" $") {
        Some(i) => s.get(..i).unwrap_or(s),
        None => s,
    }
}
