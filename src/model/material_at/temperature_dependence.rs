//! MAT1 with MATT1 and its tables.

use super::material_faults::MaterialFaults;
use crate::model::fault::{FaultKind, ModelFault};
use crate::model::isotropic::{isotropic_material, moduli_faults};
use crate::model::table::property_at;
use crate::model::types::*;
use nastran::bdf::Deck;
use nastran::cards::{Mat1, MaterialTable, Matt1};
use nastran::place::PlacedCard;
use std::collections::{BTreeMap, HashMap};

/// Number of fields of MATT1 that change statics or mass: E, G, NU, RHO, A. The next field is reserved.
const CARRIED: usize = 5;

/// A MAT1 whose values depend on temperature.
#[derive(Debug)]
pub(super) struct TemperatureDependentMaterial<'a> {
    base: &'a PlacedCard<Mat1>,
    matt: &'a PlacedCard<Matt1>,
    /// Tables of E, G, NU, RHO, A.
    tables: [Option<&'a MaterialTable>; CARRIED],
}

/// Returns the materials with a MATT1 by their index in the model. Refused cards and faults are added to `found`.
pub(super) fn dependent_materials<'a>(
    model: &Model,
    deck: &'a Deck,
    found: &mut MaterialFaults,
) -> BTreeMap<u32, TemperatureDependentMaterial<'a>> {
    let cards = &deck.cards;
    let tables: HashMap<u32, &PlacedCard<MaterialTable>> =
        cards.material_tables.iter().map(|t| (t.id, t)).collect();
    let bases: HashMap<u32, &PlacedCard<Mat1>> = cards.mat1s.iter().map(|m| (m.id, m)).collect();
    let places: HashMap<u32, u32> = (0..)
        .zip(&model.materials)
        .map(|(i, m)| (m.id, i))
        .collect();
    let mut out = BTreeMap::new();
    for matt in &cards.matt1s {
        let name = || format!("MATT1 {}", matt.id);
        let missing = |field, what, id: u32| ModelFault {
            card: name(),
            field,
            at: matt.at,
            kind: FaultKind::Missing {
                what,
                id: id.into(),
            },
        };
        let (Some(base), Some(place)) = (bases.get(&matt.id), places.get(&matt.id)) else {
            found.faults.push(missing("MID", "MAT1", matt.id));
            continue;
        };
        let mut own = [None; CARRIED];
        let mut whole = true;
        for (id, slot) in matt.tables.iter().zip(&mut own) {
            let Some(id) = id else { continue };
            match tables.get(id) {
                None => found.faults.push(missing("T", "TABLEM", *id)),
                Some(t) if !t.options.is_empty() => {
                    found.refuse(format!("TABLEM with {}", t.options), Some(t.id), t.at);
                }
                Some(t) => {
                    *slot = Some(&t.card);
                    continue;
                }
            }
            whole = false;
        }
        let stated = base.e.is_some() && base.g.is_some();
        if stated && own[0].is_some() != own[1].is_some() {
            // Solvers differ: the other modulus is either kept or computed from the first one.
            let card = "MATT1 with one of T(E) and T(G) for a MAT1 with E and G".to_owned();
            found.refuse(card, Some(matt.id), matt.at);
            whole = false;
        }
        if matt.tables[CARRIED].is_some() {
            found.refuse(
                "MATT1 with a table of TREF".to_owned(),
                Some(matt.id),
                matt.at,
            );
            whole = false;
        }
        if whole && own.iter().any(Option::is_some) {
            let tables = own;
            out.insert(*place, TemperatureDependentMaterial { base, matt, tables });
        }
    }
    out
}

impl TemperatureDependentMaterial<'_> {
    /// Returns the material id.
    pub(super) fn id(&self) -> u32 {
        self.base.id
    }

    /// Returns a fault of the MATT1.
    pub(super) fn fault(&self, field: &'static str, kind: FaultKind) -> ModelFault {
        ModelFault {
            card: format!("MATT1 {}", self.matt.id),
            field,
            at: self.matt.at,
            kind,
        }
    }

    /// Returns the material at a temperature.
    ///
    /// # Errors
    /// A table that multiplies a blank field; invalid moduli at this temperature.
    pub(super) fn material_at(&self, t: f64) -> Result<Material, ModelFault> {
        let mut card = self.base.card;
        let [e, g, nu, rho, alpha] = self.tables;
        let value = |table: Option<&MaterialTable>, z: Option<f64>, field: &'static str| match table
        {
            None => Ok(z),
            Some(table) => match property_at(table, z, t) {
                Some(value) => Ok(Some(value)),
                None => Err(self.fault(field, FaultKind::Underdetermined)),
            },
        };
        card.e = value(e, card.e, "T(E)")?;
        card.g = value(g, card.g, "T(G)")?;
        card.nu = value(nu, card.nu, "T(NU)")?;
        card.rho = value(rho, Some(card.rho), "T(RHO)")?.unwrap_or(0.0);
        card.alpha = value(alpha, Some(card.alpha), "T(A)")?.unwrap_or(0.0);
        if let Some((field, kind)) = moduli_faults(&card).into_iter().next() {
            return Err(self.fault(field, kind));
        }
        let none = || self.fault("T(E)", FaultKind::Underdetermined);
        isotropic_material(&card, self.base.at).ok_or_else(none)
    }
}
