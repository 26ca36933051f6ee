//! Cards that are there twice though Nastran reads one of each.

use super::build::Builder;
use super::fault::FaultKind;
use nastran::cards::{MaterialTable, Matt1, Param};
use nastran::place::Place;
use std::collections::HashMap;
use std::hash::Hash;

/// Names of a repeated card for messages.
struct Words<'a> {
    card: &'a dyn Fn() -> String,
    field: &'static str,
    what: &'static str,
}

/// Cards seen so far, with their content and place.
struct SeenCards<K, T>(HashMap<K, (T, Place)>);

impl<K: Hash + Eq, T: PartialEq> SeenCards<K, T> {
    fn new() -> Self {
        Self(HashMap::new())
    }

    /// Adds a card. A repeated card with different content is an error; one with equal content is reported as a note.
    fn add(&mut self, b: &mut Builder<'_>, key: K, (content, at): (T, Place), words: &Words<'_>) {
        let Some((before, first)) = self.0.get(&key) else {
            self.0.insert(key, (content, at));
            return;
        };
        let (what, first) = (words.what, *first);
        let kind = if *before == content {
            FaultKind::Repeated { what, first }
        } else {
            FaultKind::Duplicate { what, first }
        };
        b.fault((words.card)(), words.field, at, kind);
    }
}

impl Builder<'_> {
    /// Refuses parameters, temperatures, enforced displacements, tables of materials and combinations of sets (LOAD, SPCADD, MPCADD) that occur twice
    /// with different content.
    pub(super) fn check_duplicates(&mut self) {
        self.repeated_params();
        self.repeated_temperatures();
        self.repeated_materials();
        let cards = self.cards;
        let mut sums: HashMap<u32, Place> = HashMap::new();
        for l in &cards.loads {
            // Nastran allows one LOAD card for each id. It does not add up several LOAD cards with one id.
            if let Some(first) = sums.insert(l.sid, l.at) {
                let what = "id of the LOAD combination";
                let kind = FaultKind::Duplicate { what, first };
                self.fault(format!("LOAD {}", l.sid), "SID", l.at, kind);
            }
        }
        for (card, sums) in [("SPCADD", &cards.spcadds), ("MPCADD", &cards.mpcadds)] {
            // One card defines a set. It is not documented whether a solver takes the first card, takes the second, or adds both.
            let mut seen = SeenCards::new();
            for sum in sums {
                let words = Words {
                    card: &|| format!("{card} {}", sum.sid),
                    field: "SID",
                    what: "id of the combination of sets",
                };
                seen.add(self, sum.sid, (&sum.card.sets, sum.at), &words);
            }
        }
        let mut moved = SeenCards::new();
        for s in &cards.spcds {
            for (grid, dofs, value) in &s.terms {
                for dof in dofs.iter0() {
                    let words = Words {
                        card: &|| format!("SPCD {} of grid {grid} dof {}", s.sid, dof + 1),
                        field: "D",
                        what: "enforced displacement",
                    };
                    moved.add(self, (s.sid, *grid, dof), (*value, s.at), &words);
                }
            }
        }
    }

    fn repeated_params(&mut self) {
        let mut seen = SeenCards::<&str, &Param>::new();
        let cards = self.cards;
        let acting = |p: &&nastran::place::PlacedCard<Param>| {
            super::case_params::OF_STRUCTURE.contains(&p.name.as_str())
        };
        for p in cards.params.iter().filter(acting) {
            let words = Words {
                card: &|| format!("PARAM,{}", p.name),
                field: "V1",
                what: "parameter",
            };
            seen.add(self, p.name.as_str(), (&p.card, p.at), &words);
        }
    }

    fn repeated_temperatures(&mut self) {
        let cards = self.cards;
        let mut defaults = SeenCards::new();
        for t in &cards.tempds {
            let words = Words {
                card: &|| format!("TEMPD {}", t.sid),
                field: "T",
                what: "temperature of all grids",
            };
            defaults.add(self, t.sid, (t.t, t.at), &words);
        }
        let mut grids = SeenCards::new();
        for t in &cards.temps {
            let words = Words {
                card: &|| format!("TEMP {} of grid {}", t.sid, t.grid),
                field: "T",
                what: "temperature of the grid",
            };
            grids.add(self, (t.sid, t.grid), (t.t, t.at), &words);
        }
    }

    fn repeated_materials(&mut self) {
        let cards = self.cards;
        let mut tables = SeenCards::<u32, &MaterialTable>::new();
        for t in &cards.material_tables {
            let words = Words {
                card: &|| format!("TABLEM {}", t.id),
                field: "TID",
                what: "table id",
            };
            tables.add(self, t.id, (&t.card, t.at), &words);
        }
        let mut dependent = SeenCards::<u32, &Matt1>::new();
        for m in &cards.matt1s {
            let words = Words {
                card: &|| format!("MATT1 {}", m.id),
                field: "MID",
                what: "material id",
            };
            dependent.add(self, m.id, (&m.card, m.at), &words);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::model::{FaultKind, FaultWeight, Model, ModelFault};
    use nastran::bdf::{MemoryLoader, read_deck};

    fn faults(bulk: &str) -> Vec<ModelFault> {
        let text =
            format!("SOL 101\nCEND\nBEGIN BULK\nGRID,1\nGRID,2,,1.,0.,0.\n{bulk}\nENDDATA\n");
        let deck = read_deck("deck.bdf", text.into_bytes(), &mut MemoryLoader::default());
        assert!(deck.faults.is_empty(), "{:?}", deck.faults);
        let faults = Model::from_deck(&deck).1.into_iter();
        faults.filter(|f| f.kind != FaultKind::Unattached).collect()
    }

    #[test]
    fn a_card_that_is_there_twice_is_refused_if_its_content_differs_and_else_reported() {
        let table = |y| format!("TABLEM1,7\n,0.,1.,20.,{y},ENDT");
        let [two, three] = ["2.", "3."].map(table);
        let mat = "MAT1,1,1.,,0.\n";
        for [first, same, other] in [
            ["PARAM,WTMASS,.1", "PARAM,WTMASS,.1", "PARAM,WTMASS,.2"],
            ["TEMPD,4,10.", "TEMPD,4,10.", "TEMPD,4,20."],
            ["TEMP,4,2,20.", "TEMP,4,2,20.", "TEMP,4,2,30."],
            ["SPCD,1,2,1,.1", "SPCD,1,2,12,.1", "SPCD,1,2,1,.2"],
            [two.as_str(), two.as_str(), three.as_str()],
            ["MATT1,1,7", "MATT1,1,7", "MATT1,1,8"],
            [
                "SPC1,1,1,1\nSPC1,2,1,2\nSPCADD,9,1,2",
                "SPCADD,9,1,2",
                "SPCADD,9,1",
            ],
            [
                "MPC,1,1,1,1.,2,1,1.\nMPC,2,1,2,1.,2,2,1.\nMPCADD,9,1,2",
                "MPCADD,9,1,2",
                "MPCADD,9,2",
            ],
        ] {
            let base = format!("{mat}{}\n", two.replace(",7", ",9"));
            let base = format!(
                "{base}{}",
                base.replace("TABLEM1,9", "TABLEM1,8").replace(mat, "")
            );
            let with = |second: &str| faults(&format!("{base}{first}\n{second}"));
            let differing = with(other);
            assert!(
                differing
                    .iter()
                    .any(|f| matches!(f.kind, FaultKind::Duplicate { .. })),
                "{first}: {differing:?}"
            );
            let repeated = with(same);
            assert!(
                repeated
                    .iter()
                    .any(|f| matches!(f.kind, FaultKind::Repeated { .. }))
                    && repeated.iter().all(|f| f.weight() == FaultWeight::Note),
                "{first}: {repeated:?}"
            );
        }
    }

    #[test]
    fn a_second_load_combination_of_one_id_is_refused() {
        let found = faults("FORCE,1,2,,1.,1.,0.,0.\nLOAD,5,1.,1.,1\nLOAD,5,1.,1.,1");
        assert!(
            found.len() == 1 && matches!(found[0].kind, FaultKind::Duplicate { .. }),
            "{found:?}"
        );
    }
}
