//! Springs between points that move as patches of grids do.

use super::index::{GridIx, Mat3, Vec3};
use crate::linalg::Matrix6;
use nastran::place::Place;

/// CWELD, CFAST, CGAP: six springs at a point, between two ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Element id.
    pub id: u32,
    /// Card of the joint.
    pub card: JointCard,
    /// Ends A and B.
    pub ends: [JointEnd; 2],
    /// Element axes by rows, basic frame; the first leads from A to B.
    pub axes: Mat3,
    /// Location of the springs, basic frame. Rigid arms join it to the ends.
    pub location: Vec3,
    /// Stiffness by component: three translations, three rotations.
    pub k: [f64; 6],
    /// Way in which the connector was placed on its patches.
    pub placed: Placement,
    /// Place of the card in the deck.
    pub at: Place,
}

/// Way in which a connector was placed on its patches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// Number of times that the diameter was halved until the auxiliary points met the patch. It is the larger number of both sides.
    pub halvings: u8,
    /// Angle between the normals of the patches, degrees, at most 90. It is 0 if an end is a grid.
    pub angle_deg: f64,
}

/// Card from which a joint was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointCard {
    /// CWELD.
    Cweld,
    /// CFAST.
    Cfast,
    /// CGAP, as its initial opening has it.
    Cgap {
        /// U0 is above 0: KB acts along the axis and nothing across.
        open: bool,
        /// F0: of no effect where the gap is linear.
        preload: f64,
    },
}

impl JointCard {
    /// Returns the name of the card.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cweld => "CWELD",
            Self::Cfast => "CFAST",
            Self::Cgap { .. } => "CGAP",
        }
    }
}

/// An end of a joint: translation and rotation of its point as the sum over grids of `motion * (u, theta)`, all in the basic frame.
#[derive(Clone, Debug, PartialEq)]
pub struct JointEnd {
    /// Point of the joint, basic frame.
    pub x: Vec3,
    /// Grids, each once, with the contribution of each grid to the motion.
    pub motion: Vec<(GridIx, Matrix6<f64>)>,
}

impl JointEnd {
    /// A grid itself.
    pub fn grid(g: GridIx, x: Vec3) -> Self {
        Self {
            x,
            motion: vec![(g, Matrix6::identity())],
        }
    }

    /// Returns the motion of an end from the translations of a grid only.
    pub fn translations(g: GridIx, x: Vec3) -> Self {
        let mut motion = Matrix6::zeros();
        motion.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(1.0);
        Self {
            x,
            motion: vec![(g, motion)],
        }
    }
}
