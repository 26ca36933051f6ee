//! Replication: `=`, `==`, `*(n)` in fields, `=(n)` in field 1.

use std::sync::atomic::AtomicUsize;

use super::budget::{BUDGET, take};
use super::fault::DeckFaultKind;
use super::fields::excerpt;
use super::number::{Number, read_number};

/// A card and the steps that make the next card from it.
#[derive(Clone, Debug)]
pub(super) struct Template {
    pub card: Vec<Vec<u8>>,
    pub steps: Vec<Vec<u8>>,
}

/// Returns the count of `=(n)` or `=n`.
pub(super) fn count(head: &[u8]) -> Option<usize> {
    let rest = head.strip_prefix(b"=")?;
    let digits = rest
        .strip_prefix(b"(")
        .map_or(rest, |r| r.strip_suffix(b")").unwrap_or(r));
    match read_number(digits)? {
        Number::Integer(n) => usize::try_from(n).ok(),
        Number::Real(_) => None,
    }
}

/// Takes the memory of `n` more cards off the budget. Takes nothing if the budget does not suffice.
pub(super) fn spend(
    budget: &AtomicUsize,
    template: &Template,
    n: usize,
) -> Result<(), DeckFaultKind> {
    let cost = 200 + 16 * template.card.len().max(template.steps.len());
    if take(budget, n.saturating_mul(cost)) {
        return Ok(());
    }
    Err(DeckFaultKind::TooManyReplicated {
        limit: BUDGET / 200,
    })
}

impl Template {
    /// Turns the card into the next one.
    pub(super) fn advance(&mut self) -> Result<(), DeckFaultKind> {
        let mut next = Vec::with_capacity(self.card.len());
        let steps = self
            .steps
            .iter()
            .rposition(|s| !s.is_empty())
            .map_or(0, |i| i + 1);
        for (i, step) in self.steps.iter().take(steps).enumerate() {
            let above = self.card.get(i).map(Vec::as_slice).unwrap_or_default();
            match step.as_slice() {
                b"=" => next.push(above.to_vec()),
                b"==" => {
                    next.extend(self.card.iter().skip(i).cloned());
                    self.card = next;
                    return Ok(());
                }
                [b'*', increment @ ..] => next.push(add_increment(above, increment, step)?),
                text => next.push(text.to_vec()),
            }
        }
        self.card = next;
        Ok(())
    }
}

fn add_increment(above: &[u8], increment: &[u8], step: &[u8]) -> Result<Vec<u8>, DeckFaultKind> {
    let wrong = |why| DeckFaultKind::Replication {
        found: excerpt(step),
        why,
    };
    let inner = increment
        .strip_prefix(b"(")
        .map_or(increment, |r| r.strip_suffix(b")").unwrap_or(r));
    let by = read_number(super::line::trim(inner))
        .ok_or_else(|| wrong("the increment is not a number"))?;
    let from = if above.is_empty() {
        Some(zero_like(by))
    } else {
        read_number(above)
    };
    match (
        from.ok_or_else(|| wrong("the field above is not a number"))?,
        by,
    ) {
        (Number::Integer(a), Number::Integer(b)) => Ok(a
            .checked_add(b)
            .ok_or_else(|| wrong("the number is too large"))?
            .to_string()
            .into_bytes()),
        (Number::Real(a), Number::Real(b)) => Ok(format_exact_real(a + b)),
        (Number::Real(a), Number::Integer(b)) => Ok(format_exact_real(a + b as f64)),
        (Number::Integer(_), Number::Real(_)) => Err(wrong("a real is added to an integer")),
    }
}

fn zero_like(n: Number) -> Number {
    match n {
        Number::Integer(_) => Number::Integer(0),
        Number::Real(_) => Number::Real(0.0),
    }
}

/// Returns every digit of the number, with a point or exponent.
fn format_exact_real(x: f64) -> Vec<u8> {
    format!("{x:?}").into_bytes()
}
