//! Lists of ids: one by one, and ranges with THRU and BY.

use super::super::fault::DeckFaultKind;
use super::super::fields::{Fields, Value};
use crate::cards::IdList;

/// Reads the ids from field `first` on. A plain range stays a range, so a card that mixes single ids and ranges gives several parts. Blank fields are
/// skipped.
pub(super) fn id_lists(f: &mut Fields, first: usize, name: &'static str) -> Vec<IdList> {
    let mut lists = Vec::new();
    let mut each: Vec<u32> = Vec::new();
    let end = f.len();
    let mut i = first;
    while i < end {
        match f.value(i) {
            Value::Blank => {}
            Value::Integer(n) => match u32::try_from(n) {
                Ok(id @ 1..) => each.push(id),
                _ => out_of_range(f, i, name),
            },
            Value::Text if f.is_word(i, "THRU") => {
                i = range(f, i, name, &mut each, &mut lists);
                continue;
            }
            // Text such as ALL GRIDS is not supported and becomes a fault.
            _ => {
                f.integer(i, name);
            }
        }
        i += 1;
    }
    if !each.is_empty() {
        lists.push(IdList::Each(each));
    }
    lists
}

fn out_of_range(f: &mut Fields, i: usize, name: &'static str) {
    let found = f.word(i);
    f.fault(
        i,
        name,
        DeckFaultKind::OutOfRange {
            found,
            allowed: "1 and more",
        },
    );
}

/// Reads `THRU b [BY n]` at field `i`; the lower end is the last id of `each`. Returns the index after the range.
fn range(
    f: &mut Fields,
    i: usize,
    name: &'static str,
    each: &mut Vec<u32>,
    lists: &mut Vec<IdList>,
) -> usize {
    let next = (i + 1..f.len()).find(|&k| !f.is_blank(k)).unwrap_or(i + 1);
    let upper = match f.value(next) {
        Value::Integer(n) => u32::try_from(n).ok(),
        _ => None,
    };
    let (Some(lower), Some(upper)) = (each.last().copied(), upper) else {
        if f.is_blank(next) {
            f.fault(next, name, DeckFaultKind::Missing);
        } else {
            f.integer(next, name);
        }
        return next + 1;
    };
    if upper < lower {
        out_of_range(f, next, name);
        return next + 1;
    }
    let by = if f.is_word(next + 1, "BY") {
        f.integer(next + 2, name).filter(|&n| n > 0)
    } else {
        None
    };
    let Some(by) = by else {
        each.pop();
        if !each.is_empty() {
            lists.push(IdList::Each(std::mem::take(each)));
        }
        lists.push(IdList::Thru(lower, upper));
        return next + if f.is_word(next + 1, "BY") { 3 } else { 1 };
    };
    each.pop();
    let step = u32::try_from(by).unwrap_or(u32::MAX);
    each.extend(f.written_out(next, name, lower..=upper, step));
    next + 3
}

/// Returns the ids as a single list; if there are several parts, ranges are expanded.
pub(super) fn join_ids(f: &mut Fields, first: usize, name: &'static str) -> IdList {
    let mut lists = id_lists(f, first, name);
    if lists.len() == 1 {
        return lists.pop().unwrap_or(IdList::Each(Vec::new()));
    }
    let mut all = Vec::new();
    for list in lists {
        match list {
            IdList::Each(ids) => all.extend(ids),
            IdList::Thru(a, b) => all.extend(f.written_out(first, name, a..=b, 1)),
        }
    }
    IdList::Each(all)
}
