//! Reads PARAM cards from table PVT0.

use super::fields::Fields;
use super::records::Geometry;
use crate::cards::{Param, ParamValue};
use crate::op2::words::Words;

/// Reads the parameters of a record: name (2 words), type (1 integer, 2 real, 3 two words: text or a double), value. Stops at an unknown type.
pub(in crate::op2) fn read_params(words: Words<'_>, out: &mut Geometry) {
    let mut f = Fields::new(words, false);
    while f.words_left() >= 4 {
        let Some(param) = param(&mut f, words.format.bytes() == 4) else {
            out.note(
                "PVT0",
                "a parameter of unknown type; the rest of the parameters was left out".to_owned(),
            );
            return;
        };
        out.cards.params.push(Geometry::place(param));
    }
}

fn param(f: &mut Fields<'_>, narrow: bool) -> Option<Param> {
    let name = f.text(2)?;
    let known = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let value = match f.int()? {
        1 => ParamValue::Integer(f.int()?),
        2 => ParamValue::Real(f.read_real()?),
        3 => two_words(f, narrow)?,
        _ => return None,
    };
    known.then_some(Param {
        name,
        values: vec![value],
    })
}

/// Reads text or an 8-byte real; the value is text if it has only characters that a keyword may have.
fn two_words(f: &mut Fields<'_>, narrow: bool) -> Option<ParamValue> {
    let mut number = *f;
    let text = f.text(2)?;
    if text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
    {
        return Some(ParamValue::Text(text));
    }
    number.pair(narrow).map(ParamValue::Real)
}
