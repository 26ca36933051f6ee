//! GRID, GRDSET, CORD1x, CORD2x, CONM1, CONM2.

use super::{Field, Row, ToFields, dofs};
use crate::cards::{Conm1, Conm2, Coord, CoordDefinition, CoordKind, Grdset, Grid};

impl ToFields for Grid {
    fn card_name(&self) -> &'static str {
        "GRID"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.id)
            .add(self.cp)
            .add_all(self.x)
            .add(self.cd)
            .add(self.ps.map_or(Field::Blank, dofs))
            .add(self.seid)
            .end()
    }
}

impl ToFields for Grdset {
    fn card_name(&self) -> &'static str {
        "GRDSET"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add_blanks(1)
            .add(self.cp)
            .add_blanks(3)
            .add(self.cd);
        row.add(self.ps.map_or(Field::Blank, dofs))
            .add(self.seid)
            .end()
    }
}

impl ToFields for Coord {
    fn card_name(&self) -> &'static str {
        match (self.definition, self.kind) {
            (CoordDefinition::Grids(_), CoordKind::Rectangular) => "CORD1R",
            (CoordDefinition::Grids(_), CoordKind::Cylindrical) => "CORD1C",
            (CoordDefinition::Grids(_), CoordKind::Spherical) => "CORD1S",
            (CoordDefinition::Points { .. }, CoordKind::Rectangular) => "CORD2R",
            (CoordDefinition::Points { .. }, CoordKind::Cylindrical) => "CORD2C",
            (CoordDefinition::Points { .. }, CoordKind::Spherical) => "CORD2S",
        }
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.id);
        match self.definition {
            CoordDefinition::Grids(grids) => row.add_all(grids).end(),
            CoordDefinition::Points { rid, a, b, c } => {
                row.add(rid).add_all(a).add_all(b).add_all(c).end()
            }
        }
    }
}

impl ToFields for Conm1 {
    fn card_name(&self) -> &'static str {
        "CONM1"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.id)
            .add(self.grid)
            .add(self.cid)
            .reals(&self.m, 0.0)
            .end()
    }
}

impl ToFields for Conm2 {
    fn card_name(&self) -> &'static str {
        "CONM2"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.grid)
            .add(self.cid)
            .add(self.mass);
        row.reals(&self.offset, 0.0)
            .add_blanks(1)
            .reals(&self.inertia, 0.0)
            .end()
    }
}
