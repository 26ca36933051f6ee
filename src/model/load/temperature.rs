//! TEMP, TEMPD, TEMPP1, TEMPRB.

use crate::model::build::Builder;
use crate::model::types::*;
use nastran::cards::IdList;
use nastran::place::Place;
use std::collections::{BTreeMap, HashMap};

impl Builder<'_> {
    /// The elements of a list; of a range those that exist.
    fn written_out<'s>(&'s self, ids: &'s IdList) -> Box<dyn Iterator<Item = u32> + 's> {
        match ids {
            IdList::Each(list) => Box::new(list.iter().copied()),
            IdList::Thru(a, b) => {
                let (a, b) = (*a, *b);
                let known = self.element_ids.keys().copied();
                Box::new(known.filter(move |id| (a..=b).contains(id)))
            }
        }
    }

    pub(in crate::model) fn temperatures(&mut self) {
        let cards = self.cards;
        let mut sets: BTreeMap<u32, TemperatureSet> = BTreeMap::new();
        let fresh = |sid: u32, at: Place| TemperatureSet {
            sid,
            default: None,
            grids: Vec::new(),
            elements: HashMap::new(),
            unsupported: Vec::new(),
            at,
        };
        for t in &cards.tempds {
            sets.entry(t.sid)
                .or_insert_with(|| fresh(t.sid, t.at))
                .default = Some(t.t);
        }
        for t in &cards.temps {
            let Some(g) = self.grid(t.grid, &format!("TEMP {}", t.sid), "G", t.at) else {
                continue;
            };
            sets.entry(t.sid)
                .or_insert_with(|| fresh(t.sid, t.at))
                .grids
                .push((g, t.t));
        }
        for t in &cards.tempp1s {
            let set = sets.entry(t.sid).or_insert_with(|| fresh(t.sid, t.at));
            if t.at_surfaces {
                set.unsupported
                    .push(("TEMPP1 with TS1, TS2".to_owned(), t.at));
            }
            let plate = ElementTemperature::Plate {
                mean: t.mean,
                gradient: t.gradient,
            };
            set.elements
                .extend(self.written_out(&t.elements).map(|id| (id, plate)));
        }
        for t in &cards.temprbs {
            let set = sets.entry(t.sid).or_insert_with(|| fresh(t.sid, t.at));
            if t.at_points {
                set.unsupported
                    .push(("TEMPRB with temperatures of points".to_owned(), t.at));
            }
            let line = ElementTemperature::Line {
                ends: t.ends,
                gradient: t.gradient,
            };
            set.elements
                .extend(self.written_out(&t.elements).map(|id| (id, line)));
        }
        self.model.temperatures = sets.into_values().collect();
    }
}
