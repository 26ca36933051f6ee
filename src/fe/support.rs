//! What holds a structure under unit loads: an SPC set, or nothing but its own inertia.

use super::UnitLoad;
use super::load_case::{LoadCase, Relief, unit_cases};
use crate::finding::{Finding, Severity};
use crate::model::Model;

/// Which support is wanted.
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

/// What holds the structure in every load case of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Support {
    /// SPC set; `None`: no set holds it (permanent constraints of grids do all the same).
    pub spc: Option<u32>,
    /// What balances loads that no support takes.
    pub relief: Relief,
}

/// Why a support can't be had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SupportError {
    /// The deck has no such SPC set.
    #[error("the deck has no SPC set {set}: {}", known(.there))]
    Missing {
        /// The set asked for.
        set: u32,
        /// Sets of the deck.
        there: Vec<u32>,
    },
    /// Subcases stand on different supports.
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

fn known(sets: &[u32]) -> String {
    match sets {
        [] => "it has none at all".to_owned(),
        _ => format!("it has {}", list(sets)),
    }
}

impl Support {
    /// Held by nothing; PARAM,INREL,-1 of the model says that displacements count from its SUPORT dofs.
    pub fn free(model: &Model) -> Self {
        Self {
            spc: None,
            relief: match model.params.inrel {
                -1 => Relief::Suport(None),
                _ => Relief::Automatic,
            },
        }
    }

    /// Unit loads as load cases on this support, subcases numbered 1 .. n.
    pub fn unit_cases(&self, model: &Model, loads: &[UnitLoad]) -> Vec<LoadCase> {
        unit_cases(model, (self.spc, self.relief), loads)
    }

    /// Whether an SPC set holds the structure.
    pub fn is_held(&self) -> bool {
        self.spc.is_some()
    }

    /// The support in words: `held by SPC set 1`, `free (inertia relief)`.
    pub fn words(&self) -> String {
        match (self.spc, self.relief) {
            (Some(set), Relief::None) => format!("held by SPC set {set}"),
            (Some(set), _) => {
                format!("held by SPC set {set}, inertia relief along what it leaves free")
            }
            (None, _) => "free (inertia relief)".to_owned(),
        }
    }
}

/// What holds a model's structure under unit loads.
///
/// A set that is named, or that the deck's case control selects, holds it; PARAM,INREL of the deck then stays in force for the motions
/// that the set leaves free. Otherwise inertia balances every load.
///
/// # Errors
/// A set that the deck lacks; several sets selected where one must be.
pub fn support_of(model: &Model, wanted: SupportChoice) -> Result<Support, SupportError> {
    let set = match (wanted, model.selected_spcs.as_slice()) {
        (SupportChoice::Free, _) | (SupportChoice::Deck, []) => return Ok(Support::free(model)),
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
    })
}

/// Said where a deck that holds nothing and asks for no inertia relief is solved by it all the same: Nastran would stop at a mechanism.
pub fn assumed_relief(model: &Model, support: Support) -> Option<Finding> {
    (support.spc.is_none() && support.relief == Relief::Automatic && model.params.inrel == 0).then(
        || {
            Finding::new(
                Severity::Warning,
                "inertia-relief-assumed",
                "model",
                "nothing holds the structure and PARAM,INREL is not given: inertia balances the loads (Nastran would stop at a mechanism)",
                "give PARAM,INREL,-2 if that is meant, or select the SPC set that holds the structure",
            )
        },
    )
}

/// Contradictions of each SPC set that a subcase of the deck selects.
pub fn check_spcs(model: &Model) -> Vec<Finding> {
    let selected = model.selected_spcs.iter();
    selected
        .filter_map(|set| contradictions(model, Some(*set)))
        .collect()
}

/// Contradictions of an SPC set: dofs that its cards hold at different values.
pub(super) fn contradictions(model: &Model, spc: Option<u32>) -> Option<Finding> {
    /// Dofs that a message names.
    const SHOWN: usize = 5;
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
        .take(SHOWN)
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
                "the set holds {} dofs at two different values ({}): the answer is that of one of them",
                twice.len(),
                named.join("; ")
            ),
            "let one card only give each of these dofs its value",
        )
        .with_numbers(twice.len() as f64, 0.0)
    })
}

#[cfg(test)]
mod tests;
