//! Reads typed values from the fields of one card, and adds a fault for each invalid value.

use std::sync::atomic::AtomicUsize;

use super::fault::{DeckFaultKind, Fault, FieldName};
use super::number::{Number, read_number};
use crate::cards::Dofs;
use crate::place::Place;

/// Content of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value {
    Blank,
    Integer(i64),
    Real(f64),
    Text,
}

/// The fields of a card, index 0 being field 2; continuations follow, 8 to a line.
#[derive(Debug)]
pub(super) struct Fields<'a, 'f> {
    pub name: &'a [u8],
    pub at: Place,
    list: &'a [&'a [u8]],
    faults: &'f mut Vec<Fault>,
    /// Remaining bytes for content that the deck expands from short text.
    budget: &'f AtomicUsize,
    /// An id could not be read: the card is omitted.
    pub unusable: bool,
}

/// Largest number of faults that are kept for a part of a deck. A text with more faults is not a deck.
pub(super) const MAX_FAULTS: usize = 2_000;

/// Returns the field as a message shows it.
pub(super) fn excerpt(field: &[u8]) -> String {
    let mut text: String = super::line::text_of(field.get(..40).unwrap_or(field))
        .chars()
        .filter(|c| !c.is_control())
        .collect();
    if field.len() > 40 {
        text.push_str("..");
    }
    text
}

/// Adds a fault unless there are too many already.
pub(super) fn note_fault(faults: &mut Vec<Fault>, fault: Fault) {
    if faults.len() < MAX_FAULTS {
        faults.push(fault);
    }
}

impl<'a, 'f> Fields<'a, 'f> {
    pub(super) fn new(
        name: &'a [u8],
        at: Place,
        list: &'a [&'a [u8]],
        faults: &'f mut Vec<Fault>,
        budget: &'f AtomicUsize,
    ) -> Self {
        Fields {
            name,
            at,
            list,
            faults,
            budget,
            unusable: false,
        }
    }

    /// Returns the number of fields up to the last field that is not blank.
    pub(super) fn len(&self) -> usize {
        self.list
            .iter()
            .rposition(|f| !f.is_empty())
            .map_or(0, |i| i + 1)
    }

    /// Returns the trimmed text of a field, empty for a missing field.
    #[inline]
    pub(super) fn bytes_at(&self, i: usize) -> &'a [u8] {
        self.list.get(i).copied().unwrap_or_default()
    }

    #[inline]
    pub(super) fn is_blank(&self, i: usize) -> bool {
        self.bytes_at(i).is_empty()
    }

    #[inline]
    pub(super) fn value(&self, i: usize) -> Value {
        let raw = self.bytes_at(i);
        if raw.is_empty() {
            return Value::Blank;
        }
        match read_number(raw) {
            Some(Number::Integer(n)) => Value::Integer(n),
            Some(Number::Real(x)) => Value::Real(x),
            None => Value::Text,
        }
    }

    /// Adds a fault at field `i`.
    pub(super) fn fault(&mut self, i: usize, name: &'static str, what: DeckFaultKind) {
        let number = (i / 8 * 10 + i % 8 + 2) as u32;
        let card = super::line::text_of(self.name);
        note_fault(
            self.faults,
            Fault {
                at: self.at,
                card,
                field: Some(FieldName { number, name }),
                what,
            },
        );
    }

    fn excerpt_at(&self, i: usize) -> String {
        excerpt(self.bytes_at(i))
    }

    /// Reads an integer; `None` and a fault if the field is neither blank nor an integer.
    #[inline]
    pub(super) fn integer(&mut self, i: usize, name: &'static str) -> Option<i64> {
        match self.value(i) {
            Value::Blank => None,
            Value::Integer(n) => Some(n),
            Value::Real(_) | Value::Text => {
                let found = self.excerpt_at(i);
                self.fault(i, name, DeckFaultKind::NotInteger { found });
                None
            }
        }
    }

    /// Reads a required positive id; without an id the card is unusable.
    #[inline]
    pub(super) fn id(&mut self, i: usize, name: &'static str) -> u32 {
        if let Value::Integer(n) = self.value(i)
            && let Ok(n @ 1..) = u32::try_from(n)
        {
            return n;
        }
        self.bad_id(i, name)
    }

    #[cold]
    fn bad_id(&mut self, i: usize, name: &'static str) -> u32 {
        self.unusable = true;
        let found = self.excerpt_at(i);
        match self.value(i) {
            Value::Blank => self.fault(i, name, DeckFaultKind::Missing),
            Value::Integer(_) => self.fault(
                i,
                name,
                DeckFaultKind::OutOfRange {
                    found,
                    allowed: "1 and more",
                },
            ),
            _ => self.fault(i, name, DeckFaultKind::NotInteger { found }),
        }
        0
    }

    /// Reads an id of 0 or more; `None` if the field is blank or faulty.
    #[inline]
    pub(super) fn opt_id(&mut self, i: usize, name: &'static str) -> Option<u32> {
        let n = self.integer(i, name)?;
        let id = u32::try_from(n).ok();
        if id.is_none() {
            let found = self.excerpt_at(i);
            self.fault(
                i,
                name,
                DeckFaultKind::OutOfRange {
                    found,
                    allowed: "0 and more",
                },
            );
        }
        id
    }

    /// Reads an id that may be negative.
    #[inline]
    pub(super) fn opt_signed(&mut self, i: usize, name: &'static str) -> Option<i32> {
        let n = self.integer(i, name)?;
        let id = i32::try_from(n).ok();
        if id.is_none() {
            let found = self.excerpt_at(i);
            self.fault(
                i,
                name,
                DeckFaultKind::OutOfRange {
                    found,
                    allowed: "-2147483648 to 2147483647",
                },
            );
        }
        id
    }

    /// Reads a real; `None` if the field is blank or faulty.
    #[inline]
    pub(super) fn opt_real(&mut self, i: usize, name: &'static str) -> Option<f64> {
        match self.value(i) {
            Value::Blank => None,
            Value::Real(x) => Some(x),
            Value::Integer(n) => {
                let found = self.excerpt_at(i);
                self.fault(i, name, DeckFaultKind::IntegerForReal { found });
                Some(n as f64)
            }
            Value::Text => {
                let found = self.excerpt_at(i);
                self.fault(i, name, DeckFaultKind::NotReal { found });
                None
            }
        }
    }

    /// Reads a real with a default.
    #[inline]
    pub(super) fn real_or(&mut self, i: usize, name: &'static str, default: f64) -> f64 {
        self.opt_real(i, name).unwrap_or(default)
    }

    /// Reads a required real; 0 and a fault if the field is blank.
    pub(super) fn required_real(&mut self, i: usize, name: &'static str) -> f64 {
        if self.is_blank(i) {
            self.fault(i, name, DeckFaultKind::Missing);
        }
        self.opt_real(i, name).unwrap_or(0.0)
    }

    /// Reads `N` consecutive reals; a blank field is 0.
    pub(super) fn reals<const N: usize>(
        &mut self,
        first: usize,
        names: [&'static str; N],
    ) -> [f64; N] {
        std::array::from_fn(|k| self.real_or(first + k, names.get(k).copied().unwrap_or(""), 0.0))
    }

    /// Reads degrees of freedom; `None` if the field is blank or faulty. 0 is the empty set.
    pub(super) fn opt_dofs(&mut self, i: usize, name: &'static str) -> Option<Dofs> {
        let raw = self.bytes_at(i);
        if raw.is_empty() {
            return None;
        }
        let dofs = match self.value(i) {
            Value::Integer(n) => u32::try_from(n).ok().and_then(Dofs::from_digits),
            _ => None,
        };
        if dofs.is_none() {
            let found = self.excerpt_at(i);
            self.fault(i, name, DeckFaultKind::NotDofs { found });
        }
        dofs
    }

    /// Reads degrees of freedom; a blank field is the empty set.
    pub(super) fn dofs(&mut self, i: usize, name: &'static str) -> Dofs {
        self.opt_dofs(i, name).unwrap_or_default()
    }

    /// Reads a single component 0 to 6.
    pub(super) fn component(&mut self, i: usize, name: &'static str) -> u8 {
        match self.integer(i, name) {
            None => 0,
            Some(n @ 0..=6) => n as u8,
            Some(_) => {
                let found = self.excerpt_at(i);
                self.fault(
                    i,
                    name,
                    DeckFaultKind::OutOfRange {
                        found,
                        allowed: "0 to 6",
                    },
                );
                0
            }
        }
    }

    /// Lists the ids of a range. A range that exceeds the deck's memory budget is a fault at field `i`.
    pub(super) fn written_out(
        &mut self,
        i: usize,
        name: &'static str,
        range: std::ops::RangeInclusive<u32>,
        step: u32,
    ) -> Vec<u32> {
        let step = usize::try_from(step.max(1)).unwrap_or(1);
        let length = range.end().saturating_sub(*range.start()) as usize / step + 1;
        if super::budget::take(self.budget, length.saturating_mul(4)) {
            return range.step_by(step).collect();
        }
        let found = excerpt(self.bytes_at(i));
        let allowed = "a shorter range";
        self.fault(i, name, DeckFaultKind::OutOfRange { found, allowed });
        Vec::new()
    }

    /// Returns the field in upper case.
    pub(super) fn word(&self, i: usize) -> String {
        super::line::text_of(self.bytes_at(i)).to_ascii_uppercase()
    }

    /// Returns whether the field is this keyword (upper case), in upper or lower case.
    pub(super) fn is_word(&self, i: usize, word: &str) -> bool {
        self.bytes_at(i).eq_ignore_ascii_case(word.as_bytes())
    }

    /// Returns whether the field is text: not blank and not a number.
    pub(super) fn is_text(&self, i: usize) -> bool {
        matches!(self.value(i), Value::Text)
    }
}
