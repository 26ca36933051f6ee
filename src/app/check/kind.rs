//! What a file is: by content, its name only where that does not tell.

use crate::app::deck::looks_like_op2;

/// A kind of file that `check` reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Job,
    Deck,
    Results,
}

pub(super) fn kind_of(name: &str, bytes: &[u8]) -> Kind {
    let name = name.to_ascii_lowercase();
    let ends = |list: &[&str]| list.iter().any(|e| name.ends_with(e));
    if ends(&[".toml"]) {
        return Kind::Job;
    }
    let head = bytes.trim_ascii_start();
    let punch = head
        .get(..6)
        .is_some_and(|h| h.eq_ignore_ascii_case(b"$TITLE"));
    if looks_like_op2(bytes) || nastran::h5::is_h5(bytes) || punch || ends(&[".op2", ".h5", ".pch"])
    {
        return Kind::Results;
    }
    Kind::Deck
}
