//! The fields of typed cards, for writing them.

mod element;
mod geometry;
mod load;
mod material;
mod property;
mod rigid;

use super::card::{Field, format_card};

/// A card that can be written.
pub trait ToFields {
    /// Card name.
    fn card_name(&self) -> &'static str;

    /// Returns the fields, from field 2 on, 8 to a line.
    fn to_fields(&self) -> Vec<Field>;

    /// The card as lines of a deck, which read back as this card.
    fn to_card(&self) -> String {
        format_card(self.card_name(), &self.to_fields())
    }
}

/// A list that grows field by field.
#[derive(Default)]
struct Row(Vec<Field>);

impl Row {
    fn of(fields: impl IntoIterator<Item = Field>) -> Row {
        Row(fields.into_iter().collect())
    }

    fn add(mut self, value: impl Into<Field>) -> Row {
        self.0.push(value.into());
        self
    }

    fn all<T: Into<Field>>(mut self, values: impl IntoIterator<Item = T>) -> Row {
        self.0.extend(values.into_iter().map(Into::into));
        self
    }

    fn blank(mut self, n: usize) -> Row {
        self.0.extend(std::iter::repeat_n(Field::Blank, n));
        self
    }

    /// A real that is left blank where it is the default.
    fn real(self, x: f64, default: f64) -> Row {
        if x == default {
            self.blank(1)
        } else {
            self.add(x)
        }
    }

    fn reals(self, values: &[f64], default: f64) -> Row {
        values.iter().fold(self, |row, &x| row.real(x, default))
    }

    /// Blanks up to field 2 of the next line.
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

/// Degrees of freedom as digits; none as 0.
fn dofs(d: crate::cards::Dofs) -> Field {
    Field::Text(d.to_string())
}

/// Degrees of freedom; none is blank.
fn dofs_or_blank(d: crate::cards::Dofs) -> Field {
    if d.is_empty() { Field::Blank } else { dofs(d) }
}

/// An id; 0 is blank.
fn id_or_blank(id: u32) -> Field {
    if id == 0 { Field::Blank } else { id.into() }
}
