//! Rigid elements, MPC, SPC, SUPORT.

use super::{Field, Row, ToFields, dofs, dofs_or_blank};
use crate::cards::*;

impl ToFields for Rbe2 {
    fn card_name(&self) -> &'static str {
        "RBE2"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.independent)
            .add(dofs(self.dofs));
        row.add_all(self.dependent.iter().copied())
            .add_unless_default(self.alpha, 0.0)
            .end()
    }
}

impl ToFields for Rbe3 {
    fn card_name(&self) -> &'static str {
        "RBE3"
    }

    fn to_fields(&self) -> Vec<Field> {
        let mut row = Row::default()
            .add(self.id)
            .add_blanks(1)
            .add(self.reference)
            .add(dofs(self.refc));
        for g in &self.groups {
            row = row
                .add(g.weight)
                .add(dofs(g.dofs))
                .add_all(g.grids.iter().copied());
        }
        if !self.um.is_empty() {
            row = row.next_line().add("UM");
            for (i, (grid, d)) in self.um.iter().enumerate() {
                // A line has three pairs after field 2, which contains UM or is blank.
                if i > 0 && i % 3 == 0 {
                    row = row.next_line().add_blanks(1);
                }
                row = row.add(*grid).add(dofs(*d));
            }
        }
        if self.alpha != 0.0 {
            row = row.next_line().add("ALPHA").add(self.alpha);
        }
        row.end()
    }
}

impl ToFields for Rbe1 {
    fn card_name(&self) -> &'static str {
        "RBE1"
    }

    fn to_fields(&self) -> Vec<Field> {
        let pairs = |mut row: Row, terms: &[(u32, Dofs)]| {
            for (i, (grid, d)) in terms.iter().enumerate() {
                if i > 0 && i % 3 == 0 {
                    row = row.next_line().add_blanks(1);
                }
                row = row.add(*grid).add(dofs(*d));
            }
            row
        };
        let row = pairs(Row::default().add(self.id), &self.independent);
        let row = pairs(row.next_line().add("UM"), &self.dependent);
        if self.alpha == 0.0 {
            row.end()
        } else {
            row.add(self.alpha).end()
        }
    }
}

impl ToFields for Rbar {
    fn card_name(&self) -> &'static str {
        "RBAR"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add_all(self.grids)
            .add_all(self.independent.map(dofs_or_blank));
        row.add_all(self.dependent.map(dofs_or_blank))
            .add_unless_default(self.alpha, 0.0)
            .end()
    }
}

impl ToFields for Mpc {
    fn card_name(&self) -> &'static str {
        "MPC"
    }

    fn to_fields(&self) -> Vec<Field> {
        let mut row = Row::default().add(self.sid);
        for (i, (grid, c, a)) in self.terms.iter().enumerate() {
            if i > 0 && i % 2 == 0 {
                row = row.next_line().add_blanks(1);
            }
            row = row.add(*grid).add(u32::from(*c)).add(*a);
        }
        row.end()
    }
}

impl ToFields for Spc {
    fn card_name(&self) -> &'static str {
        "SPC"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.sid);
        self.terms
            .iter()
            .take(2)
            .fold(row, |row, (grid, d, x)| {
                row.add(*grid).add(dofs(*d)).add_unless_default(*x, 0.0)
            })
            .end()
    }
}

/// Returns the fields of the ids, or of `first THRU last`.
pub(super) fn ids(row: Row, list: &IdList) -> Row {
    match list {
        IdList::Each(ids) => row.add_all(ids.iter().copied()),
        IdList::Thru(a, b) => row.add(*a).add("THRU").add(*b),
    }
}

impl ToFields for Spc1 {
    fn card_name(&self) -> &'static str {
        "SPC1"
    }

    fn to_fields(&self) -> Vec<Field> {
        ids(
            Row::default().add(self.sid).add(dofs(self.dofs)),
            &self.grids,
        )
        .end()
    }
}

impl ToFields for Suport {
    fn card_name(&self) -> &'static str {
        if self.sid.is_some() {
            "SUPORT1"
        } else {
            "SUPORT"
        }
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::from_fields(self.sid.map(Field::from));
        self.terms
            .iter()
            .fold(row, |row, (grid, d)| row.add(*grid).add(dofs(*d)))
            .end()
    }
}
