//! Place of an entry in its file, so that every message can name file and line.

/// Index of a file in the list of files that the reader returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct SourceIx(pub u32);

/// A line of a text file, or a record of a binary one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Place {
    /// The file.
    pub source: SourceIx,
    /// Line, counted from 1; 0 for an entry of a binary file.
    pub line: u32,
}

/// A card and its place in the deck.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedCard<T> {
    /// The card.
    pub card: T,
    /// First line of the card.
    pub at: Place,
}

impl<T> std::ops::Deref for PlacedCard<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.card
    }
}
