//! What is wanted of the solver.

use crate::stop::Stop;

/// Where strain is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Corners {
    /// At centre and corners.
    #[default]
    Compute,
    /// At the centre only: a fifth of the memory.
    Leave,
}

/// What of the strain of a heated structure is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum HeatedStrain {
    /// Total less thermal, as Nastran gives it: what a gauge compensated for its material reads.
    #[default]
    Mechanical,
    /// Thermal expansion included, the strain of the displacements: the apparent strain of a gauge that compensates nothing.
    Total,
}

/// Settings of the solver.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct SolveOptions {
    /// Strain at the corners, too.
    pub corners: Corners,
    /// With thermal expansion or without.
    pub heated: HeatedStrain,
    /// Elastic modes wanted beside the static solution, from its factor; 0: none.
    pub modes: usize,
    /// Ends the work between two steps with [`super::FeError::Stopped`].
    pub stop: Stop,
}
