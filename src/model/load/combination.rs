//! LOAD.

use super::Sets;
use crate::model::build::Builder;
use crate::model::fault::FaultKind;
use nastran::cards::LoadSum;
use nastran::place::Placed;
use std::collections::BTreeMap;

impl Builder<'_> {
    /// LOAD combinations written out. One may sum others: those come first that wait for none.
    pub(super) fn combinations(&mut self, sets: &Sets) -> Sets {
        let cards = self.cards;
        let mut out: Sets = BTreeMap::new();
        let mut waiting: Vec<&Placed<LoadSum>> = cards.loads.iter().collect();
        loop {
            let sums: Vec<u32> = waiting.iter().map(|l| l.sid).collect();
            let (ready, later): (Vec<_>, Vec<_>) = waiting
                .into_iter()
                .partition(|l| l.terms.iter().all(|t| !sums.contains(&t.1)));
            // Only circles left: what they refer to is missing.
            let circle = ready.is_empty();
            for l in if circle { later.clone() } else { ready } {
                let mut sum = Vec::new();
                for (factor, sid) in &l.terms {
                    match out.get(sid).or(sets.get(sid)) {
                        Some(loads) => sum.extend(
                            loads
                                .iter()
                                .map(|(f, load)| (f * factor * l.scale, load.clone())),
                        ),
                        None => {
                            let kind = FaultKind::Missing {
                                what: "load set",
                                id: (*sid).into(),
                            };
                            self.fault(format!("LOAD {}", l.sid), "L", l.at, kind);
                        }
                    }
                }
                out.entry(l.sid).or_default().extend(sum);
            }
            if circle || later.is_empty() {
                return out;
            }
            waiting = later;
        }
    }
}
