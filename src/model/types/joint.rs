//! Springs between points that move as patches of grids do.

use super::index::{GridIx, Mat3, Vec3};
use crate::linalg::Matrix6;
use nastran::place::Place;

/// CWELD, CFAST, CGAP: six springs at a point, between two ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Element id.
    pub id: u32,
    /// Which card.
    pub card: JointCard,
    /// Ends A and B.
    pub ends: [JointEnd; 2],
    /// Element axes by rows, basic frame; the first leads from A to B.
    pub axes: Mat3,
    /// Where the springs act, basic frame; rigid arms join them to the ends.
    pub location: Vec3,
    /// Stiffness by component: three translations, three rotations.
    pub k: [f64; 6],
    /// How it came onto its patches.
    pub placed: Placement,
    /// Place of the card in the deck.
    pub at: Place,
}

/// How a connector came onto its patches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// How often its diameter was halved until the auxiliary points found the patch, the greater of both sides.
    pub halvings: u8,
    /// Angle between the normals of the patches, degrees, at most 90; 0 where an end is a grid.
    pub angle_deg: f64,
}

/// Which card a joint came from.
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
    /// The name of the card.
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
    /// Grids, each once, and what each of them adds.
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

    /// The translations of a grid, whatever its rotation.
    pub fn translations(g: GridIx, x: Vec3) -> Self {
        let mut motion = Matrix6::zeros();
        motion.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(1.0);
        Self {
            x,
            motion: vec![(g, motion)],
        }
    }
}
