//! Loads. FORCE and MOMENT share a struct: [`Force::to_force_card`] and [`Force::to_moment_card`].

use super::super::card::format_card;
use super::rigid::ids;
use super::{Field, Row, ToFields, id_or_blank};
use crate::cards::*;

impl Force {
    /// Returns the fields of FORCE and of MOMENT.
    fn fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.sid)
            .add(self.grid)
            .add(self.cid)
            .add(self.scale)
            .add_all(self.n)
            .end()
    }

    /// Returns the lines of a FORCE card.
    pub fn to_force_card(&self) -> String {
        format_card("FORCE", &self.fields())
    }

    /// Returns the lines of a MOMENT card.
    pub fn to_moment_card(&self) -> String {
        format_card("MOMENT", &self.fields())
    }
}

impl ToFields for LoadSum {
    fn card_name(&self) -> &'static str {
        "LOAD"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.sid).add(self.scale);
        self.terms
            .iter()
            .fold(row, |row, (factor, set)| row.add(*factor).add(*set))
            .end()
    }
}

impl ToFields for Pload {
    fn card_name(&self) -> &'static str {
        "PLOAD"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.sid)
            .add(self.pressure)
            .add_all(self.grids.map(id_or_blank))
            .end()
    }
}

fn word(letters: &[u8; 4]) -> String {
    letters
        .iter()
        .map(|&c| char::from(c))
        .collect::<String>()
        .trim_end()
        .to_owned()
}

impl ToFields for Pload1 {
    fn card_name(&self) -> &'static str {
        "PLOAD1"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.sid)
            .add(self.element)
            .add(word(&self.kind).as_str());
        row.add(word(&self.scale).as_str())
            .add(self.x1)
            .add(self.p1)
            .add(self.x2)
            .add(self.p2)
            .end()
    }
}

impl ToFields for Pload2 {
    fn card_name(&self) -> &'static str {
        "PLOAD2"
    }

    fn to_fields(&self) -> Vec<Field> {
        ids(
            Row::default().add(self.sid).add(self.pressure),
            &self.elements,
        )
        .end()
    }
}

impl ToFields for Pload4 {
    fn card_name(&self) -> &'static str {
        "PLOAD4"
    }

    fn to_fields(&self) -> Vec<Field> {
        let (first, last) = match &self.elements {
            IdList::Thru(a, b) => (Some(*a), Some(*b)),
            IdList::Each(ids) => (ids.first().copied(), None),
        };
        let row = Row::default()
            .add(self.sid)
            .add(first)
            .add_all(self.pressure);
        let row = match last {
            Some(last) => row.add("THRU").add(last),
            None => row.add_all(self.face),
        };
        let row = match self.direction {
            Some((cid, n)) => row.add(cid).add_all(n),
            None => row.add_blanks(4),
        };
        row.add(self.sorl.as_str()).add(self.ldir.as_str()).end()
    }
}

impl ToFields for Grav {
    fn card_name(&self) -> &'static str {
        "GRAV"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.sid)
            .add(self.cid)
            .add(self.scale)
            .add_all(self.n)
            .end()
    }
}

impl ToFields for Rforce {
    fn card_name(&self) -> &'static str {
        if self.is_rforce1 { "RFORCE1" } else { "RFORCE" }
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.sid)
            .add(self.grid)
            .add(self.cid)
            .add(self.speed)
            .add_all(self.r);
        let row = row
            .add(self.method)
            .add_unless_default(self.acceleration, 0.0);
        row.add_blanks(1).add(id_or_blank(self.part)).end()
    }
}

impl ToFields for Temp {
    fn card_name(&self) -> &'static str {
        "TEMP"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.sid)
            .add(self.grid)
            .add(self.t)
            .end()
    }
}

impl ToFields for Tempd {
    fn card_name(&self) -> &'static str {
        "TEMPD"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default().add(self.sid).add(self.t).end()
    }
}

impl ToFields for Accel {
    fn card_name(&self) -> &'static str {
        "ACCEL"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.sid).add(self.cid).add_all(self.n);
        let row = row.add(self.direction.as_str()).next_line();
        let pairs = self.table.iter();
        pairs
            .fold(row, |row, (at, factor)| row.add(*at).add(*factor))
            .end()
    }
}

impl ToFields for Accel1 {
    fn card_name(&self) -> &'static str {
        "ACCEL1"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.sid).add(self.cid).add(self.scale);
        let row = row.add_all(self.n).next_line();
        self.grids.iter().fold(row, ids).end()
    }
}
