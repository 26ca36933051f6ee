//! Memory budget for content that a deck expands from short text: generated cards and long id lists.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes of generated cards that a deck may have.
pub(super) const BUDGET: usize = 48 << 20;

/// Takes bytes off the budget; returns false if too few bytes remain.
pub(super) fn take(budget: &AtomicUsize, bytes: usize) -> bool {
    let taken = budget.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
        left.checked_sub(bytes)
    });
    taken.is_ok()
}
