//! Load cases: what acts, what holds, what balances.

use crate::model::{GridIx, Model, Vec3};
use nastran::bdf::Subcase;

/// Way in which the loads of a case are balanced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Relief {
    /// The SPC set alone supports the model.
    None,
    /// Inertia relief with supports that the program chooses (PARAM,INREL,-2).
    Automatic,
    /// Inertia relief, with displacements relative to the SUPORT dofs and the dofs of this SUPORT1 set (PARAM,INREL,-1).
    Suport(Option<u32>),
}

/// One load case.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCase {
    /// Subcase id.
    pub subcase: u32,
    /// Label for reports.
    pub label: String,
    /// Loads of the case; several are summed.
    pub loads: Vec<UnitLoad>,
    /// SPC set.
    pub spc: Option<u32>,
    /// MPC set.
    pub mpc: Option<u32>,
    /// Balance of the loads.
    pub relief: Relief,
}

impl LoadCase {
    /// Returns the load case of the subcase `s`: its loads, its SPC and MPC sets, and the balance that the model prescribes for them.
    pub fn of_subcase(model: &Model, s: &Subcase, label: String) -> Self {
        Self {
            subcase: s.id,
            label,
            loads: loads_of_subcase(s),
            spc: s.spc,
            mpc: s.mpc,
            relief: relief_of(model, s.spc, s.suport1),
        }
    }
}

/// Returns the balance of a model without case control: by PARAM,INREL. A model with neither INREL nor `spc` is a free structure.
///
/// A SUPORT1 set that the model lacks stays selected without PARAM,INREL too: the solver refuses it.
fn relief_of(model: &Model, spc: Option<u32>, suport: Option<u32>) -> Relief {
    let missing = suport.filter(|set| !has_suport1(model, *set));
    match (model.params.inrel, spc) {
        _ if missing.is_some() => Relief::Suport(missing),
        (-1, _) => Relief::Suport(suport),
        (-2, _) => Relief::Automatic,
        (_, None) if model.grids.iter().all(|g| g.ps.is_empty()) => Relief::Automatic,
        _ => Relief::None,
    }
}

/// Returns whether the model has this SUPORT1 set.
pub(super) fn has_suport1(model: &Model, set: u32) -> bool {
    model.suports.iter().any(|s| s.0 == Some(set))
}

/// Returns the loads of a subcase of a deck: LOAD and TEMPERATURE(LOAD).
///
/// TEMPERATURE without an option means both options. It is then a load, and the thermal strain is relative to TREF.
fn loads_of_subcase(s: &Subcase) -> Vec<UnitLoad> {
    let temperature = s.temperature_load.map(|set| UnitLoad::Temperature {
        set,
        initial: s.temperature_initial.filter(|initial| *initial != set),
    });
    s.load
        .into_iter()
        .map(UnitLoad::Set)
        .chain(temperature)
        .collect()
}

/// Returns unit loads as load cases with subcases numbered 1 .. n. `spc` and `relief` apply to all cases.
pub fn unit_cases(
    model: &Model,
    (spc, relief): (Option<u32>, Relief),
    loads: &[UnitLoad],
) -> Vec<LoadCase> {
    (1..)
        .zip(loads)
        .map(|(subcase, load)| LoadCase {
            subcase,
            label: String::new(),
            loads: vec![load.clone()],
            spc,
            mpc: model.mpc,
            relief,
        })
        .collect()
}

/// A unit load: the action of one load case.
#[derive(Clone, Debug, PartialEq)]
pub enum UnitLoad {
    /// A force and a moment at a grid, basic frame.
    AtGrid {
        /// Grid index.
        grid: GridIx,
        /// Force.
        force: Vec3,
        /// Moment.
        moment: Vec3,
    },
    /// A load set of the deck.
    Set(u32),
    /// Temperatures: the thermal strain they would give freely acts as a load, and strain is the mechanical rest.
    Temperature {
        /// TEMPERATURE(LOAD): a temperature set of the deck.
        set: u32,
        /// TEMPERATURE(INITIAL): where thermal strain counts from; `None`: from TREF of the materials.
        initial: Option<u32>,
    },
}
