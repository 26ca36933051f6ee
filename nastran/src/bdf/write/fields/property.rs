//! Properties.

use super::{Field, Row, ToFields};
use crate::cards::*;

impl ToFields for Pshell {
    fn card_name(&self) -> &'static str {
        "PSHELL"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.mid1)
            .add(self.t)
            .add(self.mid2)
            .add(self.bending_ratio);
        let row = row.add(self.mid3).add(self.shear_ratio).add(self.nsm);
        row.add(self.z1).add(self.z2).add(self.mid4).end()
    }
}

impl ToFields for Pcomp {
    fn card_name(&self) -> &'static str {
        "PCOMP"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.z0)
            .add_unless_default(self.nsm, 0.0)
            .add(self.sb)
            .add_blanks(1)
            .add(self.tref);
        let row = row.add_unless_default(self.ge, 0.0).add(self.lam.as_str());
        self.plies
            .iter()
            .fold(row, |row, ply| {
                let row = row
                    .add(ply.mid)
                    .add(ply.t)
                    .add_unless_default(ply.theta_deg, 0.0);
                row.add(if ply.output { "YES" } else { "" })
            })
            .end()
    }
}

impl ToFields for Pshear {
    fn card_name(&self) -> &'static str {
        "PSHEAR"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.id).add(self.mid).add(self.t);
        row.reals(&[self.nsm, self.f1, self.f2], 0.0).end()
    }
}

impl ToFields for Pbar {
    fn card_name(&self) -> &'static str {
        "PBAR"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.id).add(self.mid);
        let row = row
            .reals(&[self.area, self.i1, self.i2, self.j, self.nsm], 0.0)
            .add_blanks(1);
        row.reals(self.recovery.as_flattened(), 0.0)
            .add_all(self.k)
            .add_unless_default(self.i12, 0.0)
            .end()
    }
}

impl ToFields for Pbarl {
    fn card_name(&self) -> &'static str {
        "PBARL"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.mid)
            .add_blanks(1)
            .add(self.section.as_str())
            .next_line();
        row.add_all(self.dims.iter().copied())
            .add_unless_default(self.nsm, 0.0)
            .end()
    }
}

impl ToFields for Pbeaml {
    fn card_name(&self) -> &'static str {
        "PBEAML"
    }

    fn to_fields(&self) -> Vec<Field> {
        let mut row = Row::default()
            .add(self.id)
            .add(self.mid)
            .add_blanks(1)
            .add(self.section.as_str())
            .next_line();
        for (i, s) in self.stations.iter().enumerate() {
            if i > 0 {
                row = row.add(if s.output { "YES" } else { "NO" }).add(s.x_xb);
            }
            row = row
                .add_all(s.dims.iter().copied())
                .add_unless_default(s.nsm, 0.0);
        }
        row.end()
    }
}

impl ToFields for Pbeam {
    fn card_name(&self) -> &'static str {
        "PBEAM"
    }

    fn to_fields(&self) -> Vec<Field> {
        let mut row = Row::default().add(self.id).add(self.mid);
        for (i, s) in self.stations.iter().enumerate() {
            if i > 0 {
                row = row.add(if s.output { "YES" } else { "NO" }).add(s.x_xb);
            }
            row = row.add_all([s.area, s.i1, s.i2, s.i12, s.j, s.nsm]);
            if i == 0 || s.output {
                row = row.add_all(s.recovery.as_flattened().iter().copied());
            }
        }
        let row = row
            .add_all(self.k)
            .reals(&self.s, 0.0)
            .add_all(self.nsi)
            .add_all(self.cw);
        row.add_all(self.m.as_flattened().iter().copied())
            .add_all(self.n.as_flattened().iter().copied())
            .end()
    }
}

impl ToFields for Prod {
    fn card_name(&self) -> &'static str {
        "PROD"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.id).add(self.mid);
        row.reals(&[self.area, self.j, self.c, self.nsm], 0.0).end()
    }
}

impl ToFields for Ptube {
    fn card_name(&self) -> &'static str {
        "PTUBE"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default()
            .add(self.id)
            .add(self.mid)
            .add(self.od)
            .add(self.t);
        row.add_unless_default(self.nsm, 0.0).add(self.od2).end()
    }
}

impl ToFields for Pbush {
    fn card_name(&self) -> &'static str {
        "PBUSH"
    }

    fn to_fields(&self) -> Vec<Field> {
        let mut row = Row::default().add(self.id).add("K");
        for (&k, &rigid) in self.k.iter().zip(&self.rigid) {
            row = if rigid {
                row.add("RIGID")
            } else {
                row.add_unless_default(k, 0.0)
            };
        }
        if self.b != [0.0; 6] {
            row = row.next_line().add_blanks(1).add("B").reals(&self.b, 0.0);
        }
        if self.ge != [0.0; 6] {
            row = row.next_line().add_blanks(1).add("GE").add_all(self.ge);
        }
        if self.recovery != [1.0; 4] {
            row = row
                .next_line()
                .add_blanks(1)
                .add("RCV")
                .add_all(self.recovery);
        }
        if self.mass != 0.0 {
            row = row.next_line().add_blanks(1).add("M").add(self.mass);
        }
        row.end()
    }
}

impl ToFields for Pelas {
    fn card_name(&self) -> &'static str {
        "PELAS"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default()
            .add(self.id)
            .add(self.k)
            .reals(&[self.ge, self.s], 0.0)
            .end()
    }
}

impl ToFields for Psolid {
    fn card_name(&self) -> &'static str {
        "PSOLID"
    }

    fn to_fields(&self) -> Vec<Field> {
        let row = Row::default().add(self.id).add(self.mid).add(self.cordm);
        row.add_all(self.options.iter().map(|o| o.as_deref())).end()
    }
}

impl ToFields for Pmass {
    fn card_name(&self) -> &'static str {
        "PMASS"
    }

    fn to_fields(&self) -> Vec<Field> {
        Row::default().add(self.id).add(self.mass).end()
    }
}
