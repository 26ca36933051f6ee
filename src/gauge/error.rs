//! Reason why a gauge cannot be placed on the model.

use std::fmt;

/// Reason why a gauge cannot be placed on the model.
#[derive(Clone, Debug, PartialEq)]
pub enum GaugeError {
    /// The direction is normal to the surface.
    NormalDirection {
        /// Name.
        gauge: String,
        /// Element id.
        element: u32,
    },
    /// An element without area.
    NoArea {
        /// Name.
        gauge: String,
        /// Element id.
        element: u32,
    },
    /// No shells.
    NoShells {
        /// Name.
        gauge: String,
    },
    /// An element that is not there.
    NoElement {
        /// Name.
        gauge: String,
    },
    /// A grid that is longer than the part along its axis.
    GridBeyondPart {
        /// Name.
        gauge: String,
        /// Element id.
        element: u32,
        /// Length of the grid, length of the deck.
        grid_length: f64,
        /// Length of the part along the axis of the grid, through its middle.
        part: f64,
    },
    /// A gauge on a bar or beam that reads across its axis: recovery points only have the strain along it.
    AcrossBeam {
        /// Name.
        gauge: String,
        /// Element id.
        element: u32,
        /// Description of the gauge.
        what: &'static str,
    },
}

impl GaugeError {
    /// Returns the fault and the remedy.
    pub fn parts(&self) -> (String, &'static str) {
        match self {
            Self::NormalDirection { gauge, element } => (
                format!("gauge `{gauge}`: its direction is normal to element {element}"),
                "give a direction along the surface",
            ),
            Self::NoArea { gauge, element } => (
                format!("gauge `{gauge}`: element {element} has no area"),
                "repair the mesh or choose another element",
            ),
            Self::NoShells { gauge } => (
                format!("gauge `{gauge}`: the model has no shells to place it on"),
                "name a bar and its recovery point",
            ),
            Self::NoElement { gauge } => (
                format!("gauge `{gauge}`: its element is not in the model"),
                "correct the id",
            ),
            Self::GridBeyondPart {
                gauge,
                element,
                grid_length,
                part,
            } => (
                format!(
                    "gauge `{gauge}`: `grid_length` is {grid_length}, and the part under it (element {element}) is {part:.4} long along the \
                     gauge's axis"
                ),
                "give the length of the gauge's grid in job units, or move the gauge",
            ),
            Self::AcrossBeam {
                gauge,
                element,
                what,
            } => (
                format!(
                    "gauge `{gauge}`: {what} on bar {element}, whose recovery points have only the strain along its axis"
                ),
                "model this part with shells, or give a gauge along the axis: a quarter bridge or a bending bridge",
            ),
        }
    }
}

impl fmt::Display for GaugeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (wrong, remedy) = self.parts();
        write!(f, "{wrong}: {remedy}")
    }
}

impl std::error::Error for GaugeError {}
