//! Shells, shear panels, bars, beams, rods, bushes, springs, solids.

use super::{Field, Row, ToFields, dofs_or_blank, id_or_blank};
use crate::cards::*;

fn angle(angle: MaterialAngle) -> Field {
    match angle {
        MaterialAngle::Theta(0.0) => Field::Blank,
        MaterialAngle::Theta(x) => x.into(),
        MaterialAngle::Mcid(cid) => cid.into(),
    }
}

fn tflag(on: bool) -> Field {
    if on { Field::Integer(1) } else { Field::Blank }
}

impl ToFields for Shell {
    fn card_name(&self) -> &'static str {
        self.shape.card()
    }

    fn to_fields(&self) -> Vec<Field> {
        let grids = self
            .grids
            .iter()
            .take(self.shape.n_grids())
            .map(|&g| id_or_blank(g));
        let row = Row::default().add(self.id).add(self.pid).add_all(grids);
        let (angle, t) = (angle(self.angle), self.thickness);
        match self.shape {
            ShellShape::Quad4 | ShellShape::QuadR => row
                .add(angle)
                .add(self.zoffs)
                .add_blanks(1)
                .add(tflag(self.tflag))
                .add_all(t)
                .end(),
            ShellShape::Tria3 | ShellShape::TriaR => {
                let row = row
                    .add(angle)
                    .add(self.zoffs)
                    .next_line()
                    .add_blanks(1)
                    .add(tflag(self.tflag));
                row.add_all(t.into_iter().take(3)).end()
            }
            ShellShape::Quad8 => row
                .add_all(t)
                .add(angle)
                .add(self.zoffs)
                .add(tflag(self.tflag))
                .end(),
            ShellShape::Tria6 => row
                .add(angle)
                .add(self.zoffs)
                .add_all(t.into_iter().take(3))
                .add(tflag(self.tflag))
                .end(),
        }
    }
}

impl ToFields for ShearPanel {
    fn card_name(&self) -> &'static str {
        "CSHEAR"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.id)
            .add(self.pid)
            .add_all(self.grids)
            .end()
    }
}

/// Returns three fields.
fn orientation(row: Row, v: Orientation) -> Row {
    match v {
        Orientation::Vector(x) => row.add_all(x),
        Orientation::Grid(g) => row.add(g).add_blanks(2),
        Orientation::Blank => row.add_blanks(3),
    }
}

fn offt(flag: Option<[u8; 3]>) -> Field {
    flag.map_or(Field::Blank, |f| {
        Field::Text(f.iter().map(|&c| char::from(c)).collect())
    })
}

fn bar(b: &Bar, flag: Field) -> Row {
    let row = orientation(
        Row::default().add(b.id).add(b.pid).add_all(b.grids),
        b.orientation,
    )
    .add(flag);
    let row = row.add_all(b.pins.map(dofs_or_blank));
    b.offsets.iter().fold(row, |row, w| row.reals(w, 0.0))
}

impl ToFields for Bar {
    fn card_name(&self) -> &'static str {
        "CBAR"
    }

    fn to_fields(&self) -> Vec<Field> {
        bar(self, offt(self.offt)).end()
    }
}

impl ToFields for Beam {
    fn card_name(&self) -> &'static str {
        "CBEAM"
    }

    fn to_fields(&self) -> Vec<Field> {
        let flag = self.bit.map_or(offt(self.bar.offt), Field::Real);
        bar(&self.bar, flag).add_all(self.warping).end()
    }
}

impl ToFields for Rod {
    fn card_name(&self) -> &'static str {
        if self.is_tube { "CTUBE" } else { "CROD" }
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.id)
            .add(self.pid)
            .add_all(self.grids)
            .end()
    }
}

impl ToFields for Conrod {
    fn card_name(&self) -> &'static str {
        "CONROD"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add_all(self.grids)
            .add(self.mid)
            .add(self.area);
        row.reals(&[self.torsion, self.c, self.nsm], 0.0).end()
    }
}

impl ToFields for Bush {
    fn card_name(&self) -> &'static str {
        "CBUSH"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.pid)
            .add(self.grids.0)
            .add(self.grids.1);
        orientation(row, self.orientation)
            .add(self.cid)
            .add(self.s)
            .add(self.ocid)
            .reals(&self.offset, 0.0)
            .end()
    }
}

impl ToFields for Spring {
    fn card_name(&self) -> &'static str {
        match self.stiffness {
            SpringStiffness::Property(_) => "CELAS1",
            SpringStiffness::Direct { .. } => "CELAS2",
        }
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.id);
        let row = match self.stiffness {
            SpringStiffness::Property(pid) => row.add(pid),
            SpringStiffness::Direct { k, .. } => row.add(k),
        };
        let row = ends(row, &self.ends);
        match self.stiffness {
            SpringStiffness::Property(_) => row.end(),
            SpringStiffness::Direct {
                damping,
                stress_coefficient,
                ..
            } => row.reals(&[damping, stress_coefficient], 0.0).end(),
        }
    }
}

impl ToFields for Solid {
    fn card_name(&self) -> &'static str {
        self.shape.card()
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.id)
            .add(self.pid)
            .add_all(self.grids.map(id_or_blank))
            .end()
    }
}

impl ToFields for ScalarMass {
    fn card_name(&self) -> &'static str {
        match self.mass {
            ScalarMassValue::Property(_) => "CMASS1",
            ScalarMassValue::Direct(_) => "CMASS2",
        }
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.id);
        let row = match self.mass {
            ScalarMassValue::Property(pid) => row.add(pid),
            ScalarMassValue::Direct(mass) => row.add(mass),
        };
        ends(row, &self.ends).end()
    }
}

impl ToFields for Snorm {
    fn card_name(&self) -> &'static str {
        "SNORM"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.grid).add(self.cid);
        row.add_all(self.n).end()
    }
}

/// Returns grid and component of both ends; ground is blank.
fn ends(row: Row, ends: &[Option<(u32, u8)>; 2]) -> Row {
    ends.iter().fold(row, |row, end| match end {
        Some((grid, c)) => row.add(*grid).add(u32::from(*c)),
        None => row.add_blanks(2),
    })
}
