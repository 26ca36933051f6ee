//! Why a gauge can't be laid onto the model.

use std::fmt;

/// Why a gauge can't be laid onto the model.
#[derive(Clone, Debug, PartialEq)]
pub enum GaugeError {
    /// The direction stands on the surface.
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
    /// A shear bridge on a bar or beam, of which the strain along the axis alone is known.
    ShearOnBar {
        /// Name.
        gauge: String,
        /// Element id.
        element: u32,
    },
}

impl GaugeError {
    /// What is wrong, and what to do.
    pub fn parts(&self) -> (String, &'static str) {
        match self {
            Self::NormalDirection { gauge, element } => (
                format!("gauge `{gauge}`: its direction is normal to element {element}"),
                "give a direction that lies along the surface",
            ),
            Self::NoArea { gauge, element } => (
                format!("gauge `{gauge}`: element {element} has no area"),
                "repair the mesh or choose another element",
            ),
            Self::NoShells { gauge } => (
                format!("gauge `{gauge}`: the model has no shells near which it could sit"),
                "name a bar and its recovery point",
            ),
            Self::NoElement { gauge } => (
                format!("gauge `{gauge}`: its element is not in the model"),
                "correct the id",
            ),
            Self::ShearOnBar { gauge, element } => (
                format!(
                    "gauge `{gauge}`: bar {element} has strain along its axis alone, and none that a shear bridge reads"
                ),
                "use a quarter, half or full bridge, or model the bar in shells",
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
