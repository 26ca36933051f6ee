//! Faults of a deck as a model.

use crate::finding::LISTED;
use nastran::place::Place;
use std::fmt;

/// A fault of the model, with the card and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFault {
    /// Card, such as `CQUAD4 12`.
    pub card: String,
    /// Field, such as `PID`; `card` if the fault concerns the whole card.
    pub field: &'static str,
    /// Place of the card in the deck.
    pub at: Place,
    /// Kind of the fault.
    pub kind: FaultKind,
}

/// Whether a fault stops a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultWeight {
    /// A remark: the model is complete.
    Note,
    /// The model lacks the content of an unsupported card: refuse to use it.
    NotCarried,
    /// The model is unreliable: refuse to solve it.
    Error,
}

/// Kind of a fault, with its numbers.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum FaultKind {
    /// Another card, to which this card refers, is missing.
    Missing { what: &'static str, id: i64 },
    /// Unsupported card to which other cards refer.
    NotCarried {
        /// Kind of card that the reference needs.
        what: &'static str,
        /// The first card that refers to it.
        user: String,
        /// Number of further references.
        more: usize,
    },
    /// An id occurs twice.
    Duplicate { what: &'static str, first: Place },
    /// A card occurs twice with equal content, and is read once.
    Repeated { what: &'static str, first: Place },
    /// A temperature set that states no temperature of a grid, and none of all grids.
    NoTemperature {
        grid: u32,
        /// The first element that needs it.
        element: String,
        /// Number of further grids.
        more: usize,
    },
    /// An element id is shared by elements of unlike kind.
    SharedId { other: String, first: Place },
    /// A number that must be above 0 isn't.
    NotPositive { what: &'static str, value: f64 },
    /// Two ends of a line element coincide.
    ZeroLength { length: f64 },
    /// A shell without area, or folded over itself.
    Degenerate { what: &'static str },
    /// An orientation vector is parallel to the element or has no length.
    Orientation,
    /// The points of a coordinate system don't define axes.
    CollinearFrame,
    /// Coordinate systems refer to each other in a circle.
    FrameCycle,
    /// Sets that sum each other in a circle.
    SumCycle { sets: Vec<u32> },
    /// The arms of an RBE3 can't carry a moment about some axis.
    CollinearArms,
    /// A dof is dependent in two places.
    DependentTwice { grid: u32, dof: u8, first: Place },
    /// A dof is dependent and constrained.
    DependentAndIndependent { grid: u32, dof: u8 },
    /// A rigid element whose independent dofs aren't the six of a rigid body.
    NotSixIndependent { n: usize },
    /// A number of section dimensions that the type doesn't have.
    SectionDimensions {
        section: String,
        expected: usize,
        found: usize,
    },
    /// Section dimensions that give no section.
    SectionShape { section: String },
    /// A section type that isn't known.
    UnknownSection { section: String },
    /// Poisson's ratio outside -1 to 0.5.
    Poisson { nu: f64 },
    /// E, G and nu don't fix an isotropic material.
    Underdetermined,
    /// Something the model can't carry yet.
    Unsupported { what: String, remedy: &'static str },
    /// A grid that no element uses.
    Unattached,
    /// A point of a connector whose projection is on no shell of its patch.
    OffPatch { what: &'static str, side: char },
    /// A word that the card does not allow.
    Word {
        found: String,
        expected: &'static str,
    },
}

impl ModelFault {
    /// Returns whether the fault prevents a solution.
    pub fn weight(&self) -> FaultWeight {
        match self.kind {
            FaultKind::Unattached | FaultKind::SharedId { .. } | FaultKind::Repeated { .. } => {
                FaultWeight::Note
            }
            // Solvers ignore a set of SPCADD or MPCADD that has no cards.
            FaultKind::Missing { what: "set", .. } => FaultWeight::Note,
            // Shells need a thickness, and locations need grids and coordinate systems. Without other unsupported cards, results are still usable.
            FaultKind::NotCarried { what, .. } => match what {
                "grid" | "coordinate system" | "shell property" => FaultWeight::NotCarried,
                _ => FaultWeight::Note,
            },
            _ => FaultWeight::Error,
        }
    }

    /// Returns the remedy.
    pub fn remedy(&self) -> String {
        use FaultKind::*;
        match &self.kind {
            Missing { what, .. } => format!("add the {what}, or correct the id"),
            NotCarried {
                what: "grid" | "coordinate system" | "shell property",
                ..
            } => "replace it by a supported card; results do not replace it".into(),
            NotCarried { .. } => {
                "replace it by a supported card, or solve with Nastran and name the results in the job".into()
            }
            Duplicate {
                what: "parameter" | "enforced displacement",
                ..
            }
            | Repeated { .. } => "delete one of them".into(),
            Duplicate { .. } => "delete one of them, or renumber".into(),
            NoTemperature { .. } => {
                "add a TEMP for each grid, or a TEMPD for the grids without one".into()
            }
            SharedId { .. } => "renumber one of them, so that results distinguish them".into(),
            NotPositive { what, .. } => format!("give a {what} above 0"),
            ZeroLength { .. } => "merge the ends by an RBE2, or correct grids and offsets".into(),
            Degenerate { .. } => "correct the order of its grids, or delete the element".into(),
            Orientation => "give an orientation vector that isn't parallel to the element".into(),
            CollinearFrame => "move point C off the line A B, and B off A".into(),
            SumCycle { .. } => {
                "remove one of the sets of the circle from the card that names it".into()
            }
            FrameCycle => "define one of the systems of the circle in the basic system".into(),
            CollinearArms => {
                "add a grid off the line, or add rotations 456 to the connected dofs".into()
            }
            DependentTwice { .. } => "let only one of the two make the dof dependent".into(),
            DependentAndIndependent { .. } => "remove the dof from one of the two lists".into(),
            NotSixIndependent { .. } => "name six independent dofs that fix a rigid body".into(),
            SectionDimensions { expected, .. } => format!("give {expected} dimensions"),
            SectionShape { .. } => {
                "correct the dimensions: walls thinner than the outline, all above 0".into()
            }
            UnknownSection { .. } => {
                "use a section of the manual, or PBAR / PBEAM with numbers".into()
            }
            Poisson { .. } => "give a ratio above -1 and up to 0.5".into(),
            Underdetermined => "give two of E, G and NU".into(),
            Unsupported { remedy, .. } => (*remedy).into(),
            Unattached => "attach it, or delete it if nothing refers to it; otherwise AUTOSPC holds it".into(),
            OffPatch { .. } => "move the point over the patch, name the property or shell at this place, or give a smaller diameter; shells with mid-side \
             grids cannot be a patch".into(),
            Word { expected, .. } => format!("write {expected}"),
        }
    }
}

impl fmt::Display for ModelFault {
    /// Formats the message about the card, without file, line and remedy.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.card, self.kind)
    }
}

impl fmt::Display for FaultKind {
    /// Formats the message about the fault.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use FaultKind::*;
        match self {
            Missing { what, id } => write!(f, "{what} {id} is missing"),
            NotCarried { what, user, more } => {
                write!(f, "the card is not supported, and {user}")?;
                if *more > 0 {
                    write!(f, " (and {more} more)")?;
                }
                write!(f, " refers to its {what}")
            }
            Duplicate { what, first } => {
                write!(f, "the {what} occurs twice, first on line {}", first.line)
            }
            Repeated { what, first } => {
                write!(
                    f,
                    "the {what} occurs twice with the same content, first on line {}, and is read once",
                    first.line
                )
            }
            NoTemperature {
                grid,
                element,
                more,
            } => {
                write!(f, "grid {grid} of {element}")?;
                if *more > 0 {
                    write!(f, " (and {more} more grids)")?;
                }
                write!(
                    f,
                    " has no temperature in the set, and the set has no TEMPD"
                )
            }
            SharedId { other, first } => {
                write!(f, "{other} on line {} has the same id", first.line)
            }
            NotPositive { what, value } => write!(f, "the {what} is {value}"),
            ZeroLength { length } => write!(f, "the length is {length:e}"),
            Degenerate { what } => write!(f, "the element has no {what}"),
            Orientation => write!(f, "the orientation vector has no part across the element"),
            CollinearFrame => write!(f, "points A, B, C are on a line"),
            FrameCycle => write!(f, "the system is defined through others by its own id"),
            SumCycle { sets } => {
                write!(f, "the sets name each other in a circle: ")?;
                for sid in sets.iter().take(LISTED) {
                    write!(f, "{sid} -> ")?;
                }
                if sets.len() > LISTED {
                    write!(f, ".. ({} sets) -> ", sets.len())?;
                }
                write!(f, "{}", sets.first().unwrap_or(&0))
            }
            CollinearArms => write!(
                f,
                "the connected grids are on a line and carry no rotation about it"
            ),
            DependentTwice { grid, dof, first } => {
                write!(
                    f,
                    "dof {dof} of grid {grid} is dependent already on line {}",
                    first.line
                )
            }
            DependentAndIndependent { grid, dof } => {
                write!(f, "dof {dof} of grid {grid} is dependent and independent")
            }
            NotSixIndependent { n } => write!(f, "{n} independent dofs, a rigid body has 6"),
            SectionDimensions { section, found, .. } => {
                write!(f, "section {section} with {found} dimensions")
            }
            SectionShape { section } => write!(f, "the dimensions give no {section} section"),
            UnknownSection { section } => write!(f, "section type {section} is not known"),
            Poisson { nu } => write!(f, "Poisson's ratio is {nu}"),
            Underdetermined => write!(f, "E, G and NU do not determine the material"),
            Unsupported { what, .. } => write!(f, "{what} is not supported"),
            Unattached => write!(f, "no element uses it"),
            OffPatch { what, side } => {
                write!(f, "{what} meets no shell of side {side}")
            }
            Word { found, .. } => write!(f, "`{found}` is not known"),
        }
    }
}
