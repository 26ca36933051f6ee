//! Fields of typed cards, for writing the cards.

mod element;
mod geometry;
mod load;
mod material;
mod property;
mod rigid;

use super::card::{Field, format_card};

/// A card that can be written. [`ToFields::to_card`] gives lines that read back as the same card.
///
/// # Example
/// ```
/// use nastran::bdf::{MemoryLoader, ToFields, read_deck};
/// use nastran::cards::Grid;
///
/// let grid = Grid { id: 12, cp: None, x: [1.0 / 3.0, -2.5e-7, 1000.0], cd: Some(4), ps: None, seid: None };
/// let text = format!("BEGIN BULK\n{}ENDDATA\n", grid.to_card());
/// let deck = read_deck("grid.bdf", text.into(), &mut MemoryLoader::default());
/// let read = &deck.cards.grids[0];
/// assert_eq!((read.id, read.cd, read.x[1], read.x[2]), (12, Some(4), -2.5e-7, 1000.0));
/// // A third needs the 16 columns of the large field.
/// assert!((3.0 * read.x[0] - 1.0).abs() < 1e-11);
/// ```
pub trait ToFields {
    /// Card name.
    fn card_name(&self) -> &'static str;

    /// Returns the fields, from field 2 on, 8 to a line.
    fn to_fields(&self) -> Vec<Field>;

    /// Returns the card as lines of a deck, which read back as this card.
    fn to_card(&self) -> String {
        format_card(self.card_name(), &self.to_fields())
    }
}

/// A list that grows field by field.
#[derive(Default)]
struct Row(Vec<Field>);

impl Row {
    fn from_fields(fields: impl IntoIterator<Item = Field>) -> Row {
        Row(fields.into_iter().collect())
    }

    fn add(mut self, value: impl Into<Field>) -> Row {
        self.0.push(value.into());
        self
    }

    fn add_all<T: Into<Field>>(mut self, values: impl IntoIterator<Item = T>) -> Row {
        self.0.extend(values.into_iter().map(Into::into));
        self
    }

    fn add_blanks(mut self, n: usize) -> Row {
        self.0.extend(std::iter::repeat_n(Field::Blank, n));
        self
    }

    /// Adds a real, which stays blank if it is the default.
    fn add_unless_default(self, x: f64, default: f64) -> Row {
        if x == default {
            self.add_blanks(1)
        } else {
            self.add(x)
        }
    }

    fn reals(self, values: &[f64], default: f64) -> Row {
        values
            .iter()
            .fold(self, |row, &x| row.add_unless_default(x, default))
    }

    /// Adds blanks up to field 2 of the next line.
    fn next_line(mut self) -> Row {
        while !self.0.len().is_multiple_of(8) {
            self.0.push(Field::Blank);
        }
        self
    }

    fn end(self) -> Vec<Field> {
        self.0
    }
}

/// Returns degrees of freedom as digits; the empty set is 0.
fn dofs(d: crate::cards::Dofs) -> Field {
    Field::Text(d.to_string())
}

/// Returns degrees of freedom as digits; the empty set is blank.
fn dofs_or_blank(d: crate::cards::Dofs) -> Field {
    if d.is_empty() { Field::Blank } else { dofs(d) }
}

/// Returns an id; 0 is blank.
fn id_or_blank(id: u32) -> Field {
    if id == 0 { Field::Blank } else { id.into() }
}
