//! A card that the model does not contain.

use nastran::place::Place;

/// A card that the model does not support.
#[derive(Clone, Debug, PartialEq)]
pub struct UnsupportedCard {
    /// Name of the unsupported card.
    pub card: String,
    /// Element id or set id.
    pub id: Option<u32>,
    /// Place of the card in the deck.
    pub at: Place,
}
