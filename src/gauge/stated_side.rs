//! The side of a shell that a stated point is on.

use super::surface::{foot_on, from_skins, to_side};
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, ShellIx, Vec3};

/// A point between, on or off the skins of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenSkins {
    /// Distances from the bottom and the top skin, model units.
    pub distance: [f64; 2],
    /// Thickness of the shell.
    pub thickness: f64,
    /// Distance from the surface through the grids.
    pub from_grids: f64,
}

/// Share of the thickness by which a point has to be nearer to one skin than to the other: less is rounding of a drawing.
const UNDECIDED: f64 = 0.1;
/// Share of the thickness by which a point is nearer to the other skin where it contradicts a stated side. A point in the half of the plate
/// that is around the middle surface contradicts neither side.
const OTHER_SIDE: f64 = 0.5;
/// Share of the thickness within which a point is on a skin, or on the surface through the grids.
const ON_SKIN: f64 = 0.25;

impl BetweenSkins {
    /// Returns the side whose skin is nearer, the top where both are equally far.
    pub fn nearer(&self) -> Surface {
        match self.distance[0] < self.distance[1] {
            true => Surface::Bottom,
            false => Surface::Top,
        }
    }

    /// Whether the point is about as far from one skin as from the other.
    pub fn is_undecided(&self) -> bool {
        let [bottom, top] = self.distance;
        (bottom - top).abs() < UNDECIDED * self.thickness
    }

    /// Whether the point is nearer to the other skin than to that of side `stated`, beyond what a drawing leaves open.
    pub fn contradicts(&self, stated: Surface) -> bool {
        let [here, other] = self.of(stated);
        here - other > OTHER_SIDE * self.thickness
    }

    /// Whether the point is on the skin that is not that of side `stated`, and not on the surface through the grids: tables of elements state
    /// their middles there.
    pub fn is_on_other_skin(&self, stated: Surface) -> bool {
        let near = ON_SKIN * self.thickness;
        self.contradicts(stated) && self.of(stated)[1] <= near && self.from_grids > near
    }

    /// Distances from the skin of this side and from the other one.
    pub fn of(&self, side: Surface) -> [f64; 2] {
        let here = self.distance[side.ix()];
        [here, self.distance[1 - side.ix()]]
    }
}

/// Returns how a point is placed to the skins of a shell; `None` for a shell without area or thickness.
pub fn between_skins(model: &Model, ix: ShellIx, x: Vec3) -> Option<BetweenSkins> {
    let shell = model.shells.get(ix.us())?;
    let [bottom, top] = [Surface::Bottom, Surface::Top].map(|s| to_side(model, shell, s));
    let thickness = (top - bottom).abs();
    let found = BetweenSkins {
        distance: from_skins(model, ix, x)?,
        thickness,
        from_grids: foot_on(model, ix, x)?.distance,
    };
    (thickness > 0.0).then_some(found)
}
