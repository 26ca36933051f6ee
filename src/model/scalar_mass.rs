//! CMASS1 to CMASS4 with PMASS.

use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use nastran::cards::{Pmass, ScalarMassValue};

impl Builder<'_> {
    pub(super) fn scalar_masses(&mut self) {
        let cards = self.cards;
        let properties = self.by_id(&cards.pmasses, |p: &Pmass| p.id, "PMASS");
        let mut out = Vec::new();
        for c in &cards.scalar_masses {
            let card = match c.mass {
                ScalarMassValue::Property(_) => "CMASS1",
                ScalarMassValue::Direct(_) => "CMASS2",
            };
            if !self.element(c.id, card, c.at) {
                continue;
            }
            let name = format!("{card} {}", c.id);
            let mass = match c.mass {
                ScalarMassValue::Direct(mass) => Some(mass),
                ScalarMassValue::Property(pid) => {
                    let pid = pid.unwrap_or(c.id);
                    let found = properties.get(&pid).map(|p| p.mass);
                    if found.is_none() {
                        let kind = FaultKind::Missing {
                            what: "PMASS",
                            id: pid.into(),
                        };
                        self.fault(name.clone(), "PID", c.at, kind);
                    }
                    found
                }
            };
            let ends = self.ends_of(&c.ends, &name, c.at);
            if let (Some(mass), Some(ends)) = (mass, ends) {
                out.push(ScalarMass {
                    id: c.id,
                    mass,
                    ends,
                    at: c.at,
                });
            }
        }
        out.sort_by_key(|m| m.id);
        self.model.scalar_masses = out;
    }
}
