//! Why a gauge can't be laid onto the model.

/// Why a gauge can't be laid onto the model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GaugeError {
    /// The direction stands on the surface.
    #[error(
        "gauge `{gauge}`: its direction is normal to element {element}: give one that lies along the surface"
    )]
    NormalDirection {
        /// Name.
        gauge: String,
        /// Element id.
        element: u32,
    },
    /// An element without area.
    #[error(
        "gauge `{gauge}`: element {element} has no area: repair the mesh or choose another element"
    )]
    NoArea {
        /// Name.
        gauge: String,
        /// Element id.
        element: u32,
    },
    /// No shells.
    #[error(
        "gauge `{gauge}`: the model has no shells near which it could sit: name a bar and its recovery point"
    )]
    NoShells {
        /// Name.
        gauge: String,
    },
    /// An element that is not there.
    #[error("gauge `{gauge}`: its element is not in the model: check the id")]
    NoElement {
        /// Name.
        gauge: String,
    },
}
