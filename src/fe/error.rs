//! Why a model can't be solved.

use super::load_case::Relief;
use crate::finding::few_of;
use nastran::place::Place;
use std::fmt;

/// A card that the solver does not support, or whose content it can't use.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Card name with its id, such as `CHEXA 12`.
    pub card: String,
    /// Place of the card in the deck.
    pub at: Place,
    /// Fault of the card.
    pub reason: String,
    /// Remedy.
    pub remedy: String,
}

impl Refusal {
    /// Returns the refusal of the card `card`, which is at `at`.
    pub fn new(
        card: impl Into<String>,
        at: Place,
        reason: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            card: card.into(),
            at,
            reason: reason.into(),
            remedy: remedy.into(),
        }
    }
}

/// A degree of freedom without any support.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeDof {
    /// Grid id.
    pub grid: u32,
    /// Degree of freedom, 1 to 6.
    pub dof: u8,
    /// Elements with this grid.
    pub hangs: String,
    /// Place of the grid in the deck.
    pub at: Place,
}

/// Errors that stop the solver.
#[derive(Clone, Debug, PartialEq)]
pub enum FeError {
    /// Cards that the solver does not support, or can't use.
    Refused(Vec<Refusal>),
    /// A dof is made dependent twice, or both dependent and held.
    DependentTwice {
        /// Grid id.
        grid: u32,
        /// 1 to 6.
        dof: u8,
        /// The cards that claim the grid or degree of freedom.
        claims: Vec<String>,
        /// Place of the second claim in the deck.
        at: Place,
    },
    /// Dependent dofs that depend on themselves in a circle.
    CircularDependence {
        /// Grid id.
        grid: u32,
        /// 1 to 6.
        dof: u8,
        /// Place of the grid in the deck.
        at: Place,
    },
    /// Dofs without support although the supports should hold them: mechanisms.
    Mechanism {
        /// The first of the dofs.
        dofs: Vec<FreeDof>,
        /// Number of the dofs.
        count: usize,
        /// Descriptions of the parts that are not connected to the remaining structure.
        parts: Vec<String>,
        /// SPC set that supports the structure; `None` if none is selected.
        spc: Option<u32>,
        /// Balance of the loads that no support takes.
        relief: Relief,
    },
    /// A load acts on a dof without any element.
    LoadOnNothing {
        /// Grid id.
        grid: u32,
        /// 1 to 6.
        dof: u8,
        /// Subcase id.
        subcase: u32,
        /// If AUTOSPC holds this dof: the limit of its stiffness, as a share of the stiffest direction of the grid.
        softer: Option<f64>,
        /// Place of the grid in the deck.
        at: Place,
    },
    /// SPCD names a dof that no SPC holds.
    EnforcedFree {
        /// Grid id.
        grid: u32,
        /// 1 to 6.
        dof: u8,
        /// Place of the grid in the deck.
        at: Place,
    },
    /// A set that a load case names is not in the deck.
    MissingSet {
        /// `LOAD`, `SPC`, `MPC`, `SUPORT1`.
        kind: &'static str,
        /// Id of the missing set.
        sid: u32,
        /// Subcase id.
        subcase: u32,
    },
    /// Inertia relief was requested, but the structure is tied to ground.
    TiedToGround {
        /// Description of the tie to ground.
        what: String,
    },
    /// SUPORT does not constrain the rigid motions exactly once.
    Suport {
        /// Rigid motions that are free.
        free_motions: usize,
        /// Dofs on the SUPORT cards.
        dofs: usize,
    },
    /// The structure has no mass, so nothing balances the loads.
    NoMass,
    /// A number that is infinite or not a number came out of an element.
    NotANumber {
        /// Grid id.
        grid: u32,
        /// Place of the grid in the deck.
        at: Place,
    },
    /// Modes were requested, and the structure has no mass.
    NoMassToVibrate,
    /// Numbers that are infinite, not numbers, or too large for the single precision of result files.
    Overflow {
        /// Subcase id.
        subcase: u32,
        /// `loads`, `displacements`, `strain`.
        what: &'static str,
    },
    /// The factor doesn't fit memory or 32-bit indices.
    TooLarge {
        /// Unknowns of the system.
        unknowns: usize,
    },
    /// The model has nothing to solve.
    Empty,
    /// The caller cancelled the solution.
    Stopped,
}

impl FeError {
    /// Returns each fault separately: place, subject, fault and remedy.
    pub fn faults(&self) -> Vec<Refusal> {
        let one = |card: String, at: Place, reason: String, remedy: &str| {
            vec![Refusal {
                card,
                at,
                reason,
                remedy: remedy.to_owned(),
            }]
        };
        let nowhere = Place::default();
        match self {
            Self::Refused(list) => list.clone(),
            Self::DependentTwice {
                grid,
                dof,
                claims,
                at,
            } => one(
                format!("grid {grid}"),
                *at,
                format!("dof {dof} is claimed by: {}", claims.join(", ")),
                "let only one card make this dof dependent, and do not hold it",
            ),
            Self::CircularDependence { grid, dof, at } => one(
                format!("grid {grid}"),
                *at,
                format!(
                    "dof {dof} depends on itself through a chain of rigid elements or MPC equations"
                ),
                "break the circle",
            ),
            Self::Mechanism {
                dofs,
                count,
                parts,
                spc,
                relief,
            } => std::iter::once(mechanism(dofs, *count, (*spc, *relief)))
                .chain(mechanism_faults(dofs, parts))
                .collect(),
            Self::LoadOnNothing {
                grid,
                dof,
                subcase,
                softer,
                at,
            } => load_on_nothing(*grid, *dof, *subcase, *softer, *at),
            Self::EnforcedFree { grid, dof, at } => one(
                format!("grid {grid}"),
                *at,
                format!("SPCD moves dof {dof}, which no SPC holds"),
                "put the dof into the SPC set of the subcase",
            ),
            Self::MissingSet { kind, sid, subcase } => one(
                format!("{kind} = {sid}"),
                nowhere,
                format!("subcase {subcase} names it, but the deck has no set of this number"),
                "add the set or correct the number",
            ),
            Self::TiedToGround { what } => one(
                "PARAM,INREL".to_owned(),
                nowhere,
                format!("inertia relief needs a free structure, but {what}"),
                "remove the support, or solve without inertia relief",
            ),
            Self::Suport { free_motions, dofs } => one(
                "SUPORT".to_owned(),
                nowhere,
                format!(
                    "{dofs} dofs for {free_motions} free rigid motions, or dofs that do not hold all of them"
                ),
                "name as many dofs as there are rigid motions, able to hold each of them, or use PARAM,INREL,-2",
            ),
            Self::NoMass => one(
                "model".to_owned(),
                nowhere,
                "the structure has no mass, so the loads of a free structure cannot be balanced"
                    .to_owned(),
                "give the materials a density or add CONM2",
            ),
            Self::NoMassToVibrate => one(
                "model".to_owned(),
                nowhere,
                "the structure has no mass, so it has no modes".to_owned(),
                "give the materials a density or add CONM2",
            ),
            Self::NotANumber { grid, at } => one(
                format!("grid {grid}"),
                *at,
                "the stiffness at this grid is not a number".to_owned(),
                "check for zero or huge property values of the elements there",
            ),
            Self::Overflow { subcase, what } => one(
                format!("subcase {subcase}"),
                nowhere,
                format!("its {what} are not numbers, or above 3.4e38"),
                "check for loads, moduli, thicknesses and areas that are far too large or far too small",
            ),
            Self::TooLarge { unknowns } => one(
                "model".to_owned(),
                nowhere,
                format!("the factor of {unknowns} unknowns does not fit this machine's memory"),
                "use a coarser mesh, or solve it on a machine with more memory",
            ),
            Self::Empty => one(
                "model".to_owned(),
                nowhere,
                "there is no element to solve".to_owned(),
                "add elements",
            ),
            Self::Stopped => one(
                "model".to_owned(),
                nowhere,
                "the work was stopped".to_owned(),
                "ask again",
            ),
        }
    }
}

fn load_on_nothing(
    grid: u32,
    dof: u8,
    subcase: u32,
    softer: Option<f64>,
    at: Place,
) -> Vec<Refusal> {
    let (reason, remedy) = match softer {
        None => (
            format!("subcase {subcase} loads dof {dof}, which no element holds"),
            "connect the grid, or move the load",
        ),
        Some(share) => (
            format!(
                "subcase {subcase} loads dof {dof}, which has less than {share:e} of the stiffest direction of the grid: AUTOSPC holds it \
                 with its load"
            ),
            "replace the much stiffer part by a rigid element (RBE2, MPC), give PARAM,AUTOSPC,NO, or move the load",
        ),
    };
    vec![Refusal {
        card: format!("grid {grid}"),
        at,
        reason,
        remedy: remedy.to_owned(),
    }]
}

/// Returns the error on dofs that move although the supports should hold the structure.
fn mechanism(dofs: &[FreeDof], count: usize, support: (Option<u32>, Relief)) -> Refusal {
    let (held, remedy) = match support {
        (Some(set), Relief::None) => (
            format!("SPC set {set} holds the structure"),
            "hold these dofs in the set, connect the free parts, or name the set that holds them",
        ),
        (Some(set), _) => (
            format!("SPC set {set} holds the structure, inertia balances the remaining motions"),
            "hold these dofs in the set, or connect the free parts",
        ),
        (None, Relief::None) => (
            "no SPC set is selected, nor inertia relief".to_owned(),
            "select the SPC set that holds the structure (SPC = .. in case control), or give PARAM,INREL,-2",
        ),
        (None, _) => (
            "no SPC set is selected, inertia balances the structure as a whole".to_owned(),
            "connect the free parts, or select the SPC set that holds them",
        ),
    };
    let named: Vec<String> = dofs
        .iter()
        .map(|d| format!("grid {} dof {}", d.grid, d.dof))
        .collect();
    let motions = match count {
        1 => "a motion remains".to_owned(),
        n => format!("{n} motions remain"),
    };
    Refusal {
        card: support
            .0
            .map_or("SPC".to_owned(), |set| format!("SPC {set}")),
        at: Place::default(),
        reason: format!(
            "{held}, and {motions} without resistance, largest at {}",
            few_of(&named, count)
        ),
        remedy: remedy.to_owned(),
    }
}

/// One fault a loose dof and a loose part.
fn mechanism_faults(dofs: &[FreeDof], parts: &[String]) -> Vec<Refusal> {
    let mut list: Vec<Refusal> = dofs
        .iter()
        .map(|d| Refusal {
            card: format!("grid {}", d.grid),
            at: d.at,
            reason: format!("dof {} is not held; free grids: {}", d.dof, d.hangs),
            remedy: "connect or hold it".to_owned(),
        })
        .collect();
    list.extend(parts.iter().map(|p| Refusal {
        card: "model".to_owned(),
        at: Place::default(),
        reason: p.clone(),
        remedy: "join the part to the structure (RBE2, RBE3, shared grids) or delete it".to_owned(),
    }));
    list
}

impl fmt::Display for FeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.faults().iter().enumerate() {
            let separator = if i > 0 { "\n" } else { "" };
            write!(
                f,
                "{separator}line {}: {}: {}: {}",
                fault.at.line, fault.card, fault.reason, fault.remedy
            )?;
        }
        Ok(())
    }
}

impl std::error::Error for FeError {}
