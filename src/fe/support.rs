//! Support of a structure under unit loads: an SPC set, springs to ground, or inertia.

use super::UnitLoad;
use super::free_motions::{held_motions, springs_in_words};
use super::load_case::{LoadCase, Relief, unit_cases};
use crate::finding::{Finding, Severity, list_few};
use crate::model::Model;

/// Requested support.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SupportChoice {
    /// The SPC set that the deck's case control selects; free where it selects none.
    #[default]
    Deck,
    /// Free: inertia relief, whatever the deck selects.
    Free,
    /// This SPC set of the deck.
    Set(u32),
}

/// Support of the structure in every load case of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Support {
    /// SPC set. `None` if no set supports the structure. Permanent constraints of grids always apply.
    pub spc: Option<u32>,
    /// Balance of the loads that no support takes.
    pub relief: Relief,
    /// Rigid motions that springs to ground resist if no SPC set is selected, 0 to 6.
    pub by_springs: u8,
}

/// Reasons why a support can't be determined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SupportError {
    /// The deck has no such SPC set.
    #[error("the deck has no SPC set {set}: {}", list_known_sets(.there))]
    Missing {
        /// The requested set.
        set: u32,
        /// Sets of the deck.
        there: Vec<u32>,
    },
    /// Subcases have different supports.
    #[error(
        "the deck's subcases select different SPC sets ({}): unit loads need one, name it", list(.sets)
    )]
    Several {
        /// Sets selected.
        sets: Vec<u32>,
    },
}

fn list(sets: &[u32]) -> String {
    let words: Vec<String> = sets.iter().map(u32::to_string).collect();
    words.join(", ")
}

fn list_known_sets(sets: &[u32]) -> String {
    match sets {
        [] => "it has none at all".to_owned(),
        _ => format!("it has {}", list(sets)),
    }
}

impl Support {
    /// Returns the support of a model without an SPC set. Springs to ground and permanent constraints hold the rigid motions that they resist.
    /// Inertia balances the loads along the other rigid motions. With PARAM,INREL,-1, displacements are relative to the SUPORT dofs.
    pub fn without_spc(model: &Model) -> Self {
        let held = held_motions(model);
        Self {
            spc: None,
            relief: match (held.free, model.params.inrel) {
                (0, _) => Relief::None,
                (_, -1) => Relief::Suport(None),
                _ => Relief::Automatic,
            },
            by_springs: held.by_springs as u8,
        }
    }

    /// Returns the unit loads as load cases on this support, subcases numbered 1 .. n.
    pub fn unit_cases(&self, model: &Model, loads: &[UnitLoad]) -> Vec<LoadCase> {
        unit_cases(model, (self.spc, self.relief), loads)
    }

    /// Returns whether an SPC set or springs to ground hold every rigid motion that they are meant to hold.
    pub fn is_held(&self) -> bool {
        self.spc.is_some() || self.relief == Relief::None
    }

    /// Returns a description of the support: `held by SPC set 1`, `free (inertia relief)`, `held by springs to ground`.
    pub fn words(&self) -> String {
        match (self.spc, self.relief, self.by_springs) {
            (Some(set), Relief::None, _) => format!("held by SPC set {set}"),
            (Some(set), _, _) => {
                format!("held by SPC set {set}, inertia relief along the free motions")
            }
            (None, Relief::None, 0) => "held by the constraints of its grids".to_owned(),
            (None, Relief::None, _) => "held by springs to ground".to_owned(),
            (None, _, 0) => "free (inertia relief)".to_owned(),
            (None, _, n) => {
                let motions = rigid_motions(usize::from(n));
                format!(
                    "held by springs to ground along {motions}, inertia relief along the others"
                )
            }
        }
    }
}

/// Formats a number of rigid motions: `1 rigid motion`, `3 rigid motions`.
fn rigid_motions(n: usize) -> String {
    format!("{n} rigid motion{}", if n == 1 { "" } else { "s" })
}

/// Returns the support of a model's structure under unit loads.
///
/// The requested SPC set, or the set of the deck's case control, supports the structure. PARAM,INREL of the deck then applies to the motions that
/// the set leaves free. Without a set, springs to ground support it, and inertia balances loads along the motions that nothing resists.
///
/// # Errors
/// A set that the deck lacks; several sets selected where one is required.
pub fn support_of(model: &Model, wanted: SupportChoice) -> Result<Support, SupportError> {
    let set = match (wanted, model.selected_spcs.as_slice()) {
        (SupportChoice::Free, _) | (SupportChoice::Deck, []) => {
            return Ok(Support::without_spc(model));
        }
        (SupportChoice::Set(set), _) | (SupportChoice::Deck, &[set]) => set,
        (SupportChoice::Deck, several) => {
            return Err(SupportError::Several {
                sets: several.to_vec(),
            });
        }
    };
    if model.spcs.iter().all(|s| s.sid != set) {
        return Err(SupportError::Missing {
            set,
            there: model.spcs.iter().map(|s| s.sid).collect(),
        });
    }
    let relief = match model.params.inrel {
        -1 => Relief::Suport(None),
        -2 => Relief::Automatic,
        _ => Relief::None,
    };
    Ok(Support {
        spc: Some(set),
        relief,
        by_springs: 0,
    })
}

/// Returns a finding if inertia relief is assumed, or acts on fewer motions than stated.
///
/// Inertia relief is assumed if the deck neither holds the structure nor requests inertia relief; Nastran stops at a mechanism for such a deck.
/// Inertia relief acts on fewer motions than stated if springs to ground resist some of the six rigid motions. The job states `support = "free"` in
/// this case, or the deck PARAM,INREL. Inertia then balances loads along the remaining motions alone. Nastran treats all motions that SUPORT or INREL
/// name as free, so that its rigid body check fails for such a model.
pub fn relief_finding(model: &Model, support: Support, wanted: SupportChoice) -> Option<Finding> {
    let n = usize::from(support.by_springs);
    let stated = wanted == SupportChoice::Free || model.params.inrel < 0;
    // The solver refuses SUPORT dofs if their number differs from the number of free motions.
    let exact = matches!(support.relief, Relief::Suport(_));
    if support.spc.is_some() || exact || (n == 0 && support.relief == Relief::None) {
        return None;
    }
    if !stated {
        let held = match n {
            0 => "nothing holds the structure".to_owned(),
            n => format!(
                "springs to ground ({}) resist {} of 6",
                springs_in_words(model),
                rigid_motions(n)
            ),
        };
        return (support.relief == Relief::Automatic).then(|| {
            Finding::new(
                Severity::Warning,
                "inertia-relief-assumed",
                "model",
                format!("{held} and PARAM,INREL is not given: inertia balances the loads along the free motions (Nastran would stop at a mechanism)"),
                "give PARAM,INREL,-2 if this is intended, or select the SPC set that holds the structure",
            )
        });
    }
    (n > 0).then(|| {
        let by = springs_in_words(model);
        let balanced = match support.relief {
            Relief::None => "the structure is held, and inertia balances no load",
            _ => "inertia balances the loads along the other motions alone",
        };
        Finding::new(
            Severity::Warning,
            "tied-to-ground",
            "model",
            format!(
                "inertia relief is stated, and springs to ground ({by}) resist {} of 6: {balanced}",
                rigid_motions(n)
            ),
            "remove the springs to ground if the structure is free; delete PARAM,INREL, SUPORT and support = \"free\" if the springs hold it",
        )
        .with_numbers(n as f64, 0.0)
    })
}

/// Returns a finding on SUPORT without PARAM,INREL, which dialects read in different ways.
pub fn suport_without_inrel(model: &Model, sequence: Option<u32>) -> Option<Finding> {
    /// Rigid format of inertia relief, which needs no parameter.
    const INERTIA_RELIEF: u32 = 2;
    if sequence == Some(INERTIA_RELIEF) {
        return None;
    }
    let mut dofs = model.suports.iter().filter(|s| s.0.is_none());
    let grid = dofs.find_map(|s| model.grids.get(s.1.first()?.0.us()))?;
    (model.params.inrel == 0).then(|| {
        Finding::new(
            Severity::Warning,
            "suport-without-inrel",
            format!("SUPORT of grid {}", grid.id),
            "PARAM,INREL is not given: SUPORT holds nothing here, and inertia balances the loads of a structure without supports. MSC Nastran holds these dofs at zero instead, OptiStruct balances by inertia",
            "write PARAM,INREL,-1 for inertia relief, or hold the dofs with an SPC set",
        )
    })
}

/// Returns contradictions in an SPC set: dofs that its cards hold at different values.
pub fn contradictions(model: &Model, spc: Option<u32>) -> Option<Finding> {
    let mut values: Vec<(u32, f64)> = Vec::new();
    for set in model.spcs.iter().filter(|s| Some(s.sid) == spc) {
        for (g, dofs, value) in &set.terms {
            values.extend(dofs.iter0().map(|i| (6 * g.0 + i as u32, *value)));
        }
    }
    values.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    values.dedup();
    let twice: Vec<[(u32, f64); 2]> = values
        .windows(2)
        .filter_map(|w| match w {
            [a, b] if a.0 == b.0 && a.1 != b.1 => Some([*a, *b]),
            _ => None,
        })
        .collect();
    let named: Vec<String> = twice
        .iter()
        .filter_map(|[a, b]| {
            let grid = model.grids.get((a.0 / 6) as usize)?;
            Some(format!(
                "grid {} dof {}: {} and {}",
                grid.id,
                a.0 % 6 + 1,
                a.1,
                b.1
            ))
        })
        .collect();
    (!twice.is_empty()).then(|| {
        Finding::new(
            Severity::Error,
            "contradicting-spc",
            format!("SPC {}", spc.unwrap_or_default()),
            format!(
                "the set holds {} dofs at two different values ({}): the answer uses one of them",
                twice.len(),
                list_few(&named)
            ),
            "let only one card give each of these dofs its value",
        )
        .with_numbers(twice.len() as f64, 0.0)
    })
}

#[cfg(test)]
mod tests;
