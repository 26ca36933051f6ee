//! Reads the fields of a finished card into its struct, or keeps the card as text.

use std::sync::atomic::AtomicUsize;

use super::card::{connected_points, read_card};
use super::deck::OtherCard;
use super::fields::{Fields, Value};
use super::line::text_of;
use super::part::{Name, Part, Span};
use crate::place::{Place, PlacedCard};

/// Reads a finished card and adds it to the part.
pub(super) fn emit(
    budget: &AtomicUsize,
    part: &mut Part,
    name: Name,
    at: Place,
    list: &[&[u8]],
    spans: &[Span],
) {
    part.count(name);
    let mut fields = Fields::new(name.as_bytes(), at, list, &mut part.faults, budget);
    let id = match fields.value(0) {
        Value::Integer(n) => u32::try_from(n).ok(),
        _ => None,
    };
    if let [b'C', b'M' | b'D', ..] = name.as_bytes()
        && connects_points(name.as_bytes())
    {
        let points = connected_points(&fields).into_iter();
        part.cards
            .connected_points
            .extend(points.map(|card| PlacedCard { card, at }));
    }
    if !read_card(&mut fields, &mut part.cards)
        && let (Some(first), Some(last)) = (spans.first(), spans.last())
    {
        let end = if last.end > first.start {
            last.end
        } else {
            first.end
        };
        part.others.push(OtherCard {
            name: text_of(name.as_bytes()),
            first: id,
            at,
            start: first.start,
            end,
        });
    }
}

/// Returns whether the card is a scalar mass or damper, whose ends may be scalar points.
fn connects_points(name: &[u8]) -> bool {
    matches!(
        name,
        b"CMASS1"
            | b"CMASS2"
            | b"CMASS3"
            | b"CMASS4"
            | b"CDAMP1"
            | b"CDAMP2"
            | b"CDAMP3"
            | b"CDAMP4"
    )
}
