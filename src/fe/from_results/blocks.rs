//! Kinds of elements in a block of results.

use nastran::results::Block;

/// Returns whether a block holds results of bars or beams.
pub(super) fn is_bar(block: &Block) -> bool {
    block.element.is_some_and(|e| matches!(e.0, 2 | 34 | 100))
}

/// Returns whether a block holds results of shells, bars or beams.
pub(super) fn is_shell_or_bar(block: &Block) -> bool {
    is_bar(block)
        || block
            .element
            .is_some_and(|e| matches!(e.0, 33 | 64 | 70 | 74 | 75 | 82 | 144 | 227 | 228))
}

/// Returns the number of corners of the shells of a block; `None` if it contains other elements.
pub(super) fn shell_corners(block: &Block) -> Option<usize> {
    match block.element?.0 {
        33 | 64 | 82 | 95 | 96 | 144 | 228 => Some(4),
        70 | 74 | 75 | 97 | 98 | 227 => Some(3),
        _ => None,
    }
}
