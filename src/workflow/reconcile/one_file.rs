//! A deck that is spread over files, written as one: every INCLUDE replaced by what it names.

use nastran::bdf::{Deck, MemoryLoader, read_deck};

/// Returns the deck in one file. `files` are its edited sources in the order in which they were read. Returns `None` if the joined text does not read
/// as the same deck (for example with a conditional INCLUDE). Also returns `None` if a file of an INCLUDE is missing.
pub(super) fn one_file(deck: &Deck, files: Vec<(String, Vec<u8>)>) -> Option<Vec<u8>> {
    let mut rest = files.into_iter().map(|f| f.1);
    let main = rest.next()?;
    if deck.sources.len() == 1 {
        return Some(main);
    }
    let mut rest = rest.collect::<Vec<_>>().into_iter();
    let mut out = Vec::with_capacity(main.len());
    join(&main, &mut rest, &mut out)?;
    if rest.next().is_some() {
        return None;
    }
    // Edits replace cards one for one or add cards, so that the number of cards of a kind must not decrease.
    let again = read_deck("joined", out.clone(), &mut MemoryLoader::default());
    let kept = deck.counts.iter().all(|(name, n)| {
        name.eq_ignore_ascii_case("INCLUDE") || again.counts.get(name).is_some_and(|m| m >= n)
    });
    kept.then_some(out)
}

/// Copies `bytes`. Replaces every INCLUDE statement (which may continue over lines until its quote closes) by the next file.
fn join(bytes: &[u8], rest: &mut std::vec::IntoIter<Vec<u8>>, out: &mut Vec<u8>) -> Option<()> {
    let mut lines = bytes.split_inclusive(|b| *b == b'\n');
    while let Some(line) = lines.next() {
        let is_include = line
            .get(..7)
            .is_some_and(|w| w.eq_ignore_ascii_case(b"INCLUDE"));
        if !is_include {
            out.extend_from_slice(line);
            continue;
        }
        let quotes = |l: &[u8]| l.iter().filter(|b| matches!(b, b'\'' | b'"')).count();
        let mut seen = quotes(line);
        note(line, out);
        while seen == 1 {
            let more = lines.next()?;
            note(more, out);
            seen += quotes(more);
        }
        let next = rest.next()?;
        join(&next, rest, out)?;
        if !matches!(out.last(), None | Some(b'\n')) {
            out.push(b'\n');
        }
    }
    Some(())
}

/// Adds the replaced statement as a comment.
fn note(line: &[u8], out: &mut Vec<u8>) {
    out.extend_from_slice(b"$ was: ");
    out.extend_from_slice(line);
    if !line.ends_with(b"\n") {
        out.push(b'\n');
    }
}
