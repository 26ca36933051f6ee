//! One dependent dof, and the card that makes it so.

use nastran::place::Place;

/// Relation `dependent = sum of coefficient * other`. Dofs are numbered 6 * grid index + (0 to 5), in the displacement frames of the grids.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Relation {
    pub(crate) dependent: u32,
    pub(crate) terms: Vec<(u32, f64)>,
    /// Index into the list of claims, for messages.
    pub(crate) claim: u32,
}

/// A card that makes dofs dependent.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Claim {
    pub(crate) card: String,
    pub(crate) at: Place,
}
