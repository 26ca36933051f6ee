//! MAT1, MAT2, MAT8, MAT9, MATT1, TABLEM1 to TABLEM4, PARAM.

use super::{Field, Row, ToFields};
use crate::cards::*;

impl ToFields for Mat1 {
    fn card_name(&self) -> &'static str {
        "MAT1"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.e)
            .add(self.g)
            .add(self.nu);
        row.reals(&[self.rho, self.alpha, self.tref, self.ge], 0.0)
            .add_all(self.limits)
            .end()
    }
}

impl ToFields for Mat2 {
    fn card_name(&self) -> &'static str {
        "MAT2"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add_all(self.g)
            .add_unless_default(self.rho, 0.0);
        row.reals(&self.alpha, 0.0)
            .reals(&[self.tref, self.ge], 0.0)
            .end()
    }
}

impl ToFields for Mat8 {
    fn card_name(&self) -> &'static str {
        "MAT8"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add_all([self.e1, self.e2, self.nu12, self.g12]);
        let row = row
            .add(self.g1z)
            .add(self.g2z)
            .add_unless_default(self.rho, 0.0);
        row.reals(&self.alpha, 0.0)
            .add_unless_default(self.tref, 0.0)
            .end()
    }
}

impl ToFields for Mat9 {
    fn card_name(&self) -> &'static str {
        "MAT9"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .reals(&self.g, 0.0)
            .add_unless_default(self.rho, 0.0);
        row.reals(&self.alpha, 0.0)
            .reals(&[self.tref, self.ge], 0.0)
            .end()
    }
}

impl ToFields for Param {
    fn card_name(&self) -> &'static str {
        "PARAM"
    }

    fn to_fields(&self) -> Vec<Field> {
        let value = |v: &ParamValue| match v {
            ParamValue::Integer(n) => Field::Integer(*n),
            ParamValue::Real(x) => Field::Real(*x),
            ParamValue::Text(t) => Field::Text(t.clone()),
        };
        Row::default()
            .add(self.name.as_str())
            .add_all(self.values.iter().map(value))
            .end()
    }
}

impl ToFields for Matt1 {
    fn card_name(&self) -> &'static str {
        "MATT1"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default().add(self.id).add_all(self.tables).end()
    }
}

impl ToFields for MaterialTable {
    fn card_name(&self) -> &'static str {
        match self.form {
            MaterialTableForm::Replaces(_) => "TABLEM1",
            MaterialTableForm::Shifted { .. } => "TABLEM2",
            MaterialTableForm::Scaled { .. } => "TABLEM3",
            MaterialTableForm::Series { .. } => "TABLEM4",
        }
    }

    fn to_fields(&self) -> Vec<Field> {
        let pairs = |row: Row, points: &[(f64, f64)]| {
            let row = row.next_line();
            points.iter().fold(row, |row, (x, y)| row.add(*x).add(*y))
        };
        let row = Row::default().add(self.id);
        let row = match &self.form {
            MaterialTableForm::Replaces(points) => pairs(row, points),
            MaterialTableForm::Shifted { x1, points } => pairs(row.add(*x1), points),
            MaterialTableForm::Scaled { x, points } => pairs(row.add_all(*x), points),
            MaterialTableForm::Series { x, a } => {
                row.add_all(*x).next_line().add_all(a.iter().copied())
            }
        };
        row.add("ENDT").end()
    }
}
