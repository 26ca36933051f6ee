//! `[[load]]` and `[[combination]]`.

use super::named_file::NamedFile;
use crate::job::quantity::quantity_of_name;
use crate::units::{Quantity, ReportUnits, Unit};

/// A force or moment component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Component {
    FX,
    FY,
    FZ,
    MX,
    MY,
    MZ,
}

impl Component {
    /// All components in dof order.
    pub const ALL: [Component; 6] = [Self::FX, Self::FY, Self::FZ, Self::MX, Self::MY, Self::MZ];

    /// Returns the name in a job.
    pub fn name(self) -> &'static str {
        ["FX", "FY", "FZ", "MX", "MY", "MZ"][self as usize]
    }

    /// Returns the dof, 0 to 5.
    pub fn dof(self) -> usize {
        self as usize
    }

    /// Returns whether the component is a force and not a moment.
    pub fn is_force(self) -> bool {
        (self as usize) < 3
    }

    /// Returns force or moment.
    pub fn quantity(self) -> Quantity {
        if self.is_force() {
            Quantity::Force
        } else {
            Quantity::Moment
        }
    }

    /// Returns a force or moment of `size` as a vector in the axes of the load.
    pub fn vector(self, size: f64) -> [f64; 3] {
        let mut v = [0.0; 3];
        v[self.dof() % 3] = size;
        v
    }
}

/// Action of a load as a job states it, by ids of the deck. A solution uses [`crate::fe::UnitLoad`], with vectors in the basic frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadActs {
    /// A component at a grid, in the axes of `cid` (0 basic) at that grid.
    AtGrid {
        /// Grid id.
        grid: u32,
        /// Component.
        component: Component,
        /// Coordinate system id.
        cid: u32,
    },
    /// A load set of the deck.
    Set(u32),
    /// A column of a given S: only its name is known.
    Named,
}

/// Whether a load is wanted as a result. [`crate::placement::Role`] is the role of a placed gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum LoadRole {
    Wanted,
    Nuisance,
}

/// A column of S.
#[derive(Clone, Debug, PartialEq)]
pub struct JobLoad {
    /// Name.
    pub name: String,
    /// Place and direction of the load.
    pub acts: LoadActs,
    /// Size of the load in its subcase, job units, with sign. It is not zero.
    pub applied: f64,
    /// Results file of the load, if the job states one.
    pub result: Option<NamedFile>,
    /// Subcase, if the job states one. Otherwise the number of the load in the job is used.
    pub subcase: Option<u32>,
    /// Number in job order, from 1: the subcase of the load in the deck that `cases` writes.
    pub number: u32,
    /// Wanted or nuisance.
    pub role: LoadRole,
    /// Prior standard deviation, job units.
    pub expected: Option<f64>,
    /// Weight of the variance of the load in criterion A. The default is 1.
    pub weight: f64,
    /// Line of the job.
    pub line: u32,
}

impl JobLoad {
    /// Returns the stated subcase. Otherwise it is the number of the load in the job, which `cases` also uses.
    pub fn subcase(&self) -> u32 {
        self.subcase.unwrap_or(self.number)
    }

    /// Returns force or moment. `None` for a load set.
    pub fn quantity(&self) -> Option<Quantity> {
        match self.acts {
            LoadActs::AtGrid { component, .. } => Some(component.quantity()),
            LoadActs::Named => Some(quantity_of_name(&self.name)),
            LoadActs::Set(_) => None,
        }
    }

    /// Returns the unit of the load in reports. `None` for a load set, which is stated as a multiple of the set.
    pub fn report_unit(&self, units: &ReportUnits) -> Option<Unit> {
        Some(units.unit(self.quantity()?))
    }
}

/// `[[combination]]`: a sum of loads with a separate interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination {
    /// Name.
    pub name: String,
    /// Loads and their factors.
    pub terms: Vec<(String, f64)>,
    /// Line of the job.
    pub line: u32,
}
