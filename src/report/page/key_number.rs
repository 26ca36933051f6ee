//! Numbers of a first screen.

/// A number that answers the question of a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyNumber {
    /// Value with its unit.
    pub value: String,
    /// Meaning of the value.
    pub meaning: String,
}

impl KeyNumber {
    /// Returns a key number with its meaning.
    pub fn new(value: impl Into<String>, meaning: impl Into<String>) -> Self {
        /// Characters of a value that stay on one line.
        const ONE_LINE: usize = 16;
        let value: String = value.into();
        let value = match value.chars().count() <= ONE_LINE {
            true => value.replace(' ', "\u{a0}"),
            false => value,
        };
        Self {
            value,
            meaning: meaning.into(),
        }
    }
}
