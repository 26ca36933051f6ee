//! Memory that few letters of a deck may ask for: generated cards and long id lists.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes of generated cards that a deck may have.
pub(super) const BUDGET: usize = 48 << 20;

/// Takes bytes off the budget; false where too few are left.
pub(super) fn take(budget: &AtomicUsize, bytes: usize) -> bool {
    let taken = budget.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
        left.checked_sub(bytes)
    });
    taken.is_ok()
}
