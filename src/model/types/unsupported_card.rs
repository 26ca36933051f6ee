//! A card that no part of the model stands for.

use nastran::place::Place;

/// A card that the model does not carry.
#[derive(Clone, Debug, PartialEq)]
pub struct UnsupportedCard {
    /// Name of the unsupported card.
    pub card: String,
    /// Element id or set id.
    pub id: Option<u32>,
    /// Where it stands.
    pub at: Place,
}
