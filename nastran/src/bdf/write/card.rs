//! Writes a card as text, in small field if no value loses digits, otherwise in large field.

use super::real_format::{format_real, shortest_real};

/// A field to be written.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum Field {
    Blank,
    Integer(i64),
    Real(f64),
    Text(String),
}

impl From<u32> for Field {
    fn from(id: u32) -> Self {
        Field::Integer(i64::from(id))
    }
}

impl From<i32> for Field {
    fn from(id: i32) -> Self {
        Field::Integer(i64::from(id))
    }
}

impl From<f64> for Field {
    fn from(x: f64) -> Self {
        Field::Real(x)
    }
}

impl From<&str> for Field {
    fn from(word: &str) -> Self {
        if word.is_empty() {
            Field::Blank
        } else {
            Field::Text(word.to_owned())
        }
    }
}

impl<T: Into<Field>> From<Option<T>> for Field {
    fn from(value: Option<T>) -> Self {
        value.map_or(Field::Blank, Into::into)
    }
}

impl Field {
    fn format_exact(&self) -> String {
        match self {
            Field::Blank => String::new(),
            Field::Integer(n) => n.to_string(),
            Field::Real(x) => shortest_real(*x),
            Field::Text(t) => t.clone(),
        }
    }

    fn format_large(&self) -> String {
        match self {
            Field::Real(x) => format_real(*x, 16),
            other => other.format_exact(),
        }
    }
}

/// Returns the text of a card, with lines that end in `\n`. `fields` begin with field 2, 8 to a line.
///
/// The text is in small field (8 columns) if every value keeps all its digits, otherwise in large field (16 columns).
pub fn format_card(name: &str, fields: &[Field]) -> String {
    let used = fields
        .iter()
        .rposition(|f| *f != Field::Blank)
        .map_or(0, |i| i + 1);
    let fields = fields.get(..used).unwrap_or_default();
    let exact: Vec<String> = fields.iter().map(Field::format_exact).collect();
    if exact.iter().all(|t| t.len() <= 8) {
        return lines(name, "+", &exact, 8);
    }
    let large: Vec<String> = fields.iter().map(Field::format_large).collect();
    let mut text = lines(&format!("{name}*"), "*", &large, 4);
    // A card in large field has an even number of lines.
    if large.len().div_ceil(4) % 2 == 1 {
        text.push_str("*\n");
    }
    text
}

fn lines(name: &str, continuation: &str, texts: &[String], per_line: usize) -> String {
    let width = 64 / per_line;
    let mut out = String::new();
    let mut chunks = texts.chunks(per_line);
    let mut head = name;
    let mut row = chunks.next().unwrap_or_default();
    loop {
        let mut line = format!("{head:<8}");
        for text in row {
            line.push_str(&format!("{text:<width$}"));
        }
        out.push_str(line.trim_end());
        out.push('\n');
        match chunks.next() {
            Some(next) => row = next,
            None => return out,
        }
        head = continuation;
    }
}
