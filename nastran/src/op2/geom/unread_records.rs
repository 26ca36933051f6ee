//! Records without a reader: the names of their entries, and whether they act.

use super::fields::LARGEST_ID;
use crate::bdf::vocabulary::{Effect, effect_of_card};
use crate::cards::UnreadEntry;
use crate::op2::words::Words;
use std::collections::HashMap;
use std::sync::OnceLock;

/// Entries that decks carry and that act where case control selects them. The geometry blocks contain no case control.
const SELECTED: [&str; 10] = [
    "MATT1", "TABLEM1", "TABLEM2", "TABLEM3", "TABLEM4", "NSM", "NSM1", "NSML", "NSML1", "NSMADD",
];

/// Code of a record: its first three words.
pub(super) type Code = (i64, i64, i64);

/// Meaning of a record without a reader.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum UnreadRecord {
    /// Entries that act.
    Acting(Vec<UnreadEntry>),
    /// Entries of this name, which act where case control selects them.
    Selected(&'static str),
    /// Entries without influence.
    WithoutInfluence,
}

/// Returns the entries of a record without a reader. `words` follow the record's code. `stated` is the length of an entry, if the code states it. A
/// record whose entries vary in length, or have an unknown length, is one entry.
pub(super) fn classify_unread_record(
    code: Code,
    table: &str,
    words: Words<'_>,
    stated: Option<usize>,
) -> UnreadRecord {
    let Some((name, length)) = names().get(&code).copied() else {
        let (a, b, c) = code;
        return UnreadRecord::Acting(vec![UnreadEntry {
            name: format!("record {a},{b},{c} of {table}"),
            id: None,
            is_load: false,
        }]);
    };
    if SELECTED.contains(&name) {
        return UnreadRecord::Selected(name);
    }
    if let Some(Effect::None(_) | Effect::ActsWith(_)) = effect_of_card(name) {
        return UnreadRecord::WithoutInfluence;
    }
    let length = stated.unwrap_or(length);
    let is_whole = length > 0 && words.len().is_multiple_of(length);
    let id = |v: i64| (1..=LARGEST_ID).contains(&v).then_some(v);
    let ids = words.entries(length.max(1)).map(|entry| {
        let id = entry.int(0).and_then(id)?;
        u32::try_from(id).ok()
    });
    let ids: Option<Vec<u32>> = is_whole.then(|| ids.collect()).flatten();
    let is_load = table.starts_with("GEOM3") || name == "SPCD";
    let entry = |id: Option<u32>| UnreadEntry {
        name: name.to_owned(),
        id,
        is_load: is_load && id.is_some(),
    };
    UnreadRecord::Acting(match ids {
        Some(ids) => ids.into_iter().map(|id| entry(Some(id))).collect(),
        None => vec![entry(None)],
    })
}

/// Returns names and lengths of entries by the code of their record; the length is 0 if it is not fixed.
fn names() -> &'static HashMap<Code, (&'static str, usize)> {
    static NAMES: OnceLock<HashMap<Code, (&'static str, usize)>> = OnceLock::new();
    NAMES.get_or_init(|| {
        include_str!("records.txt")
            .lines()
            .filter_map(parse_record_name)
            .collect()
    })
}

/// Reads `NAME a,b,c length`.
fn parse_record_name(line: &'static str) -> Option<(Code, (&'static str, usize))> {
    let mut words = line.split(' ');
    let name = words.next()?;
    let mut code = words.next()?.split(',').map(str::parse);
    let mut next = || code.next()?.ok();
    let code = (next()?, next()?, next()?);
    let length = words.next().and_then(|w| w.parse().ok()).unwrap_or(0);
    Some((code, (name, length)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_one_name_and_no_reader_of_its_own() {
        let lines = include_str!("records.txt").lines();
        let codes: Vec<Code> = lines.filter_map(parse_record_name).map(|n| n.0).collect();
        assert!(codes.len() > 300, "{}", codes.len());
        assert_eq!(codes.len(), names().len());
        let dispatch = include_str!("dispatch.rs");
        for (a, b, c) in codes {
            assert!(
                !dispatch.contains(&format!("({a}, {b}, {c})")),
                "{a},{b},{c}"
            );
        }
    }
}
