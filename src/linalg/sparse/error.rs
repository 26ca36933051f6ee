//! Why a factor can't be made.

/// Reason why a factor could not be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot is not a number: an entry of the matrix is infinite or not a number.
    #[error("pivot of unknown {unknown} is not a number")]
    NotANumber {
        /// Caller's numbering.
        unknown: usize,
    },
    /// More entries than indices count or memory holds.
    #[error("the factor is too large for this machine's memory or for 32-bit indices")]
    TooLarge,
}
