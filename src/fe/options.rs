//! Options of the solver.

use crate::stop::Stop;

/// Points of an element at which strain is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Corners {
    /// At centre and corners.
    #[default]
    Compute,
    /// At the centre only: a fifth of the memory.
    Leave,
}

/// Strain of a heated structure: mechanical or total.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum HeatedStrain {
    /// Total less thermal, as in Nastran: the reading of a gauge that is compensated for its material.
    #[default]
    Mechanical,
    /// Thermal expansion included, the strain of the displacements: the apparent strain of a gauge without compensation.
    Total,
}

/// Settings of the solver.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct SolveOptions {
    /// Whether strain is also computed at the corners.
    pub corners: Corners,
    /// Strain of a heated structure, with thermal expansion or without.
    pub heated: HeatedStrain,
    /// Elastic modes computed in addition to the static solution, from its factor; 0: none.
    pub modes: usize,
    /// Ends the work between two steps with [`super::FeError::Stopped`].
    pub stop: Stop,
}
