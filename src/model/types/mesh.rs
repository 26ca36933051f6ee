//! Grids, frames and elements.

use super::index::{BeamPropertyIx, FrameIx, GridIx, Mat3, MaterialIx, ShellPropertyIx, Vec3};
use nastran::cards::{Dofs, ShellShape, SolidShape};
use nastran::place::Place;

/// Kind of a point of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointKind {
    /// GRID: a place and six dofs.
    Grid,
    /// SPOINT, or the end of a spring without a component: one dof and no place. The model stores it as a grid at the origin of the basic
    /// frame with constrained dofs 2 to 6. All code from cards to results treats it as a grid.
    Scalar,
}

/// A grid, or a scalar point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Id in the file.
    pub id: u32,
    /// Grid or scalar point.
    pub kind: PointKind,
    /// Location, basic frame.
    pub x: Vec3,
    /// Displacement coordinate system.
    pub cd: FrameIx,
    /// Permanent constraints.
    pub ps: Dofs,
    /// Place in the deck.
    pub at: Place,
}

/// A coordinate system resolved to basic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Id in the file, 0 basic.
    pub id: u32,
    /// Kind of the coordinates.
    pub kind: nastran::cards::CoordKind,
    /// Origin, basic frame.
    pub origin: Vec3,
    /// Axes x, y, z by rows, in basic.
    pub axes: Mat3,
}

/// A shell element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// Element id.
    pub id: u32,
    /// Shape.
    pub shape: ShellShape,
    /// Grids, corners first. Only the first `n_grids` are used. A missing mid-side grid repeats its corner.
    pub grids: [GridIx; 8],
    /// Property.
    pub property: ShellPropertyIx,
    /// Angle of the material x axis from side 1-2, radians, right-handed about the normal (MCID already projected).
    pub material_angle_rad: f64,
    /// Offset of the reference plane along the normal.
    pub zoffs: f64,
    /// Thickness at each corner. It is the thickness of the property if the card states none.
    pub thickness: [f64; 4],
    /// Place of the card in the deck.
    pub at: Place,
}

/// CBAR or CBEAM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Element id.
    pub id: u32,
    /// Whether the element is a CBEAM.
    pub is_beam: bool,
    /// Ends A, B.
    pub grids: [GridIx; 2],
    /// Property.
    pub property: BeamPropertyIx,
    /// Offsets of the ends from their grids, basic frame.
    pub offsets: [Vec3; 2],
    /// Element axes, rows x (A to B, offsets included), y (in the plane of the orientation vector), z, basic frame.
    pub axes: Mat3,
    /// Released dofs at A, B, element frame.
    pub pins: [Dofs; 2],
    /// Scalar points of the warping dtheta/dx at A, B (CBEAM with SA and SB, and a property with CW).
    pub warping: Option<[GridIx; 2]>,
    /// Whether SA and SB are stated but the property has no CW. The beam then twists without warping, and the points do not move.
    pub idle_points: bool,
    /// Place of the card in the deck.
    pub at: Place,
}

/// CROD, CTUBE, CONROD.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Rod {
    pub id: u32,
    pub card: RodCard,
    pub grids: [GridIx; 2],
    pub material: MaterialIx,
    pub area: f64,
    pub torsion: f64,
    /// Torsional stress coefficient.
    pub c: f64,
    pub nsm: f64,
    pub at: Place,
}

/// Card from which a rod was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum RodCard {
    Crod,
    Ctube,
    Conrod,
}

/// CBUSH.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bush {
    /// Element id.
    pub id: u32,
    /// Ends. B is `None` if the element is grounded.
    pub grids: (GridIx, Option<GridIx>),
    /// Element axes, basic frame.
    pub axes: Mat3,
    /// Location of the spring, basic frame.
    pub location: Vec3,
    /// Stiffness by component. It is 0 for a RIGID component of the property, which equations constrain.
    pub k: [f64; 6],
    /// Components that are RIGID in the property.
    pub rigid: [bool; 6],
    /// Whether the basic frame is assumed, because neither CID nor the line of the grids gives the axes, and the stiffness differs by direction.
    pub frame_assumed: bool,
    /// Stress and strain recovery coefficients SA, ST, EA, ET.
    pub recovery: [f64; 4],
    /// Place of the card in the deck.
    pub at: Place,
}

/// CELAS1, CELAS2.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Spring {
    pub id: u32,
    pub k: f64,
    pub stress_coefficient: f64,
    /// Grid and dof (0-based, displacement frame of the grid) of both ends. `None` for ground.
    pub ends: [Option<(GridIx, u8)>; 2],
    pub at: Place,
}

/// A solid element.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Solid {
    pub id: u32,
    pub shape: SolidShape,
    /// Grids, corners first. `None` for a missing mid-side grid.
    pub grids: [Option<GridIx>; 20],
    /// Index into `Model::solid_properties`.
    pub property: u32,
    pub at: Place,
}

/// CSHEAR with its PSHEAR.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ShearPanel {
    pub id: u32,
    pub grids: [GridIx; 4],
    pub material: MaterialIx,
    pub t: f64,
    pub nsm: f64,
    pub f1: f64,
    pub f2: f64,
    pub at: Place,
}

/// A concentrated mass: 6 x 6 about its grid, basic frame, before WTMASS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// Element id.
    pub id: u32,
    /// Grid.
    pub grid: GridIx,
    /// Mass matrix in the basic frame, referred to the grid.
    pub matrix: crate::linalg::Matrix6<f64>,
    /// Offset of the centre of gravity from the grid, basic frame (0 for CONM1).
    pub offset: Vec3,
    /// Place of the card in the deck.
    pub at: Place,
}

/// CMASS1 to CMASS4. The kinetic energy is `mass (a - b)^2 / 2` for velocities a and b of the ends, before WTMASS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarMass {
    /// Element id.
    pub id: u32,
    /// Mass, or moment of inertia of a rotation.
    pub mass: f64,
    /// Grid and dof (0-based, displacement frame of the grid) of both ends. `None` for ground.
    pub ends: [Option<(GridIx, u8)>; 2],
    /// Place of the card in the deck.
    pub at: Place,
}

/// SNORM: the normal that shells share at a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridNormal {
    /// Grid of the normal.
    pub grid: GridIx,
    /// Unit vector, basic frame. The sign of the vector has no effect.
    pub n: Vec3,
    /// Place of the card in the deck.
    pub at: Place,
}
