//! Expanded LOAD combinations: each is a sum of sets of primitive loads.

use super::build::Builder;
use super::fault::FaultKind;
use super::load::Sets;
use super::set_sum::{MOST_TERMS, SumOrder, sum_order};
use nastran::cards::LoadSum;
use nastran::place::PlacedCard;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Sets of primitive loads with their factors, each set once, in the order in which they were first named.
#[derive(Clone, Debug, Default)]
struct Weights {
    list: Vec<(u32, f64)>,
    place: HashMap<u32, usize>,
}

impl Weights {
    fn add(&mut self, sid: u32, factor: f64) {
        let next = self.list.len();
        let at = *self.place.entry(sid).or_insert(next);
        match self.list.get_mut(at) {
            Some(entry) => entry.1 += factor,
            None => self.list.push((sid, factor)),
        }
    }
}

impl Builder<'_> {
    /// Returns the expanded LOAD combinations: `scale * sum(factor * set)`. A set may be another combination.
    pub(super) fn combinations(&mut self, sets: &Sets) -> Sets {
        let cards = self.cards;
        let mut by_sid: BTreeMap<u32, Vec<&PlacedCard<LoadSum>>> = BTreeMap::new();
        for l in &cards.loads {
            by_sid.entry(l.sid).or_default().push(l);
        }
        let names: BTreeMap<u32, BTreeSet<u32>> = by_sid
            .iter()
            .map(|(sid, cards)| {
                let terms = cards.iter().flat_map(|l| &l.terms);
                (*sid, terms.map(|t| t.1).collect())
            })
            .collect();
        let SumOrder { ready, circles } = sum_order(&names);
        for circle in circles {
            let first = circle.first().and_then(|sid| by_sid.get(sid)?.first());
            if let Some(l) = first {
                let kind = FaultKind::SumCycle { sets: circle };
                self.fault(format!("LOAD {}", l.sid), "L", l.at, kind);
            }
        }
        let (mut weights, mut left) = (BTreeMap::new(), MOST_TERMS);
        for sid in ready {
            let cards = by_sid.get(&sid).map_or(&[][..], Vec::as_slice);
            let sum = self.weights(cards, sets, &weights);
            left = left.saturating_sub(sum.list.len());
            if left == 0 {
                self.too_many_loads(sid, &by_sid);
                break;
            }
            weights.insert(sid, sum);
        }
        self.written_out_sums(&by_sid, sets, weights)
    }

    /// The sets of primitive loads of the cards of one combination.
    fn weights(
        &mut self,
        cards: &[&PlacedCard<LoadSum>],
        sets: &Sets,
        known: &BTreeMap<u32, Weights>,
    ) -> Weights {
        let mut sum = Weights::default();
        for l in cards {
            for (factor, sid) in &l.terms {
                if let Some(inner) = known.get(sid) {
                    for (leaf, f) in &inner.list {
                        sum.add(*leaf, f * factor * l.scale);
                    }
                } else if sets.contains_key(sid) {
                    sum.add(*sid, factor * l.scale);
                } else {
                    let kind = FaultKind::Missing {
                        what: "load set",
                        id: (*sid).into(),
                    };
                    self.fault(format!("LOAD {}", l.sid), "L", l.at, kind);
                }
            }
        }
        sum
    }

    fn written_out_sums(
        &mut self,
        by_sid: &BTreeMap<u32, Vec<&PlacedCard<LoadSum>>>,
        sets: &Sets,
        weights: BTreeMap<u32, Weights>,
    ) -> Sets {
        let (mut out, mut left) = (Sets::new(), MOST_TERMS);
        for (sid, sum) in weights {
            let terms: Vec<_> = sum
                .list
                .iter()
                .filter_map(|(leaf, f)| Some((*f, sets.get(leaf)?)))
                .collect();
            let n = terms.iter().map(|t| t.1.len()).sum();
            let Some(rest) = left.checked_sub(n) else {
                self.too_many_loads(sid, by_sid);
                break;
            };
            left = rest;
            let loads = terms
                .iter()
                .flat_map(|(f, loads)| loads.iter().map(move |(g, load)| (g * f, load.clone())));
            out.insert(sid, loads.collect());
        }
        out
    }

    fn too_many_loads(&mut self, sid: u32, by_sid: &BTreeMap<u32, Vec<&PlacedCard<LoadSum>>>) {
        if let Some(l) = by_sid.get(&sid).and_then(|cards| cards.first()) {
            let what = format!("LOAD combinations of more than {MOST_TERMS} loads");
            let remedy = "write fewer combinations that name combinations";
            let kind = FaultKind::Unsupported { what, remedy };
            self.fault(format!("LOAD {sid}"), "L", l.at, kind);
        }
    }
}
