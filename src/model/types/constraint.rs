//! Rigid elements, and sets that constrain grids.

use super::index::GridIx;
use nastran::cards::Dofs;
use nastran::place::Place;

/// A rigid element. Dofs are in the displacement frames of the grids.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct RigidElement {
    pub id: u32,
    pub kind: RigidKind,
    pub at: Place,
}

/// Kinds of rigid elements.
#[derive(Clone, Debug, PartialEq)]
pub enum RigidKind {
    /// RBE2, RBAR and RBE1: dependent dofs follow the rigid motion given by the independent ones.
    Body {
        /// Card of the element.
        card: &'static str,
        /// Independent dofs, six in all.
        independent: Vec<(GridIx, Dofs)>,
        /// Dependent dofs.
        dependent: Vec<(GridIx, Dofs)>,
        /// Thermal expansion coefficient.
        alpha: f64,
    },
    /// RBE3.
    Mean {
        /// Reference grid.
        reference: GridIx,
        /// REFC.
        refc: Dofs,
        /// Weight, dofs, grid.
        arms: Vec<(f64, Dofs, GridIx)>,
        /// UM: dofs made dependent instead of REFC; empty: REFC is dependent.
        um: Vec<(GridIx, Dofs)>,
        /// Thermal expansion coefficient.
        alpha: f64,
    },
    /// RSPLINE, RIGID on a PBUSH, piercing grids of CWELD and CFAST: equations between dofs.
    Equations {
        /// The card they come from.
        card: &'static str,
        /// Terms grid, dof (0-based), coefficient, of each; they sum to zero, the first is dependent.
        equations: Vec<Vec<(GridIx, u8, f64)>>,
    },
}

impl RigidKind {
    /// Returns the card in messages.
    pub fn card(&self) -> &'static str {
        match self {
            Self::Mean { .. } => "RBE3",
            Self::Body { card, .. } | Self::Equations { card, .. } => card,
        }
    }

    /// Returns the field of the card that names the dependent dofs.
    pub fn field(&self) -> &'static str {
        match self {
            Self::Body { card: "RBAR", .. } => "CMA",
            Self::Body { .. } => "GM",
            Self::Mean { um, .. } if um.is_empty() => "REFC",
            Self::Mean { .. } => "UM",
            Self::Equations {
                card: "RSPLINE", ..
            } => "G",
            Self::Equations { .. } => "GA",
        }
    }

    /// Returns the thermal expansion coefficient, 0 if the card has none.
    pub fn alpha(&self) -> f64 {
        match self {
            Self::Body { alpha, .. } | Self::Mean { alpha, .. } => *alpha,
            Self::Equations { .. } => 0.0,
        }
    }

    /// Returns the grids, dependent or not; some may occur several times.
    pub fn grids(&self) -> Vec<GridIx> {
        match self {
            Self::Body {
                independent,
                dependent,
                ..
            } => independent.iter().chain(dependent).map(|t| t.0).collect(),
            Self::Mean {
                reference,
                arms,
                um,
                ..
            } => std::iter::once(*reference)
                .chain(arms.iter().map(|a| a.2))
                .chain(um.iter().map(|t| t.0))
                .collect(),
            Self::Equations { equations, .. } => equations.iter().flatten().map(|t| t.0).collect(),
        }
    }

    /// Returns the dependent dofs.
    pub fn dependent_dofs(&self) -> Vec<(GridIx, Dofs)> {
        match self {
            Self::Body { dependent, .. } => dependent.clone(),
            Self::Mean {
                reference,
                refc,
                um,
                ..
            } => match um.as_slice() {
                [] => vec![(*reference, *refc)],
                um => um.to_vec(),
            },
            Self::Equations { equations, .. } => equations
                .iter()
                .filter_map(|e| e.first())
                .map(|t| (t.0, Dofs(1 << t.1)))
                .collect(),
        }
    }
}

/// Equations of one MPC set id (MPCADD resolved). Each term has grid, dof (0-based) and coefficient. The first term is dependent.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct MpcSet {
    pub sid: u32,
    pub equations: Vec<(Vec<(GridIx, u8, f64)>, Place)>,
}

/// Constraints of one SPC set id (SPCADD resolved): grid, dofs, enforced value.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct SpcSet {
    pub sid: u32,
    pub terms: Vec<(GridIx, Dofs, f64)>,
}
