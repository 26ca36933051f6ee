//! The side of a shell that a stated point is on.

use super::grid_average::neighbours;
use super::side::shell_normal;
use super::surface::{centre, corners, foot_on, from_skins, to_side};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::model::{Mat3, Model, ShellIx, Vec3};

/// A point between, on or off the skins of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenSkins {
    /// Distances from the bottom and the top skin, model units.
    pub distance: [f64; 2],
    /// Thickness of the shell.
    pub thickness: f64,
    /// Distance from the surface through the grids.
    pub from_grids: f64,
    /// Height of the point over the middle surface of the flat shell, along its normal.
    pub height: f64,
    /// Height of the curved surface over the flat shell at this point. The shell and its neighbours define the curved surface.
    pub bulge: f64,
}

/// Least share of the thickness by which a point must be nearer to one skin than to the other. A smaller share is rounding of a drawing.
const UNDECIDED: f64 = 0.1;
/// Share of the thickness by which a point is nearer to the other skin if it contradicts a stated side. A point in the half of the plate around the
/// middle surface contradicts neither side.
const OTHER_SIDE: f64 = 0.5;
/// Share of the thickness within which a point is on a skin, or on the surface through the grids.
const ON_SKIN: f64 = 0.25;

impl BetweenSkins {
    /// Returns the side whose skin is nearer, the top if both are equally far.
    pub fn nearer_side(&self) -> Surface {
        match self.distance[0] < self.distance[1] {
            true => Surface::Bottom,
            false => Surface::Top,
        }
    }

    /// Returns whether the side of the point is ambiguous. This is so if the point is equally far from both skins. It is also so if
    /// the point is on different sides of the flat shell and of the curved surface.
    pub fn is_undecided(&self) -> bool {
        let [bottom, top] = self.distance;
        (bottom - top).abs() < UNDECIDED * self.thickness || self.is_within_bulge()
    }

    /// Returns whether the point is on different sides of the flat shell and of the curved surface, within the tolerance of a drawing.
    pub fn is_within_bulge(&self) -> bool {
        let open = 0.5 * UNDECIDED * self.thickness;
        let over = self.height - self.bulge;
        self.bulge.abs() > open && (over * self.height <= 0.0 || over.abs() < open)
    }

    /// Returns whether the point is nearer to the other skin than to the skin of side `stated`, beyond the tolerance of a drawing.
    pub fn contradicts(&self, stated: Surface) -> bool {
        let [here, other] = self.skin_distances(stated);
        here - other > OTHER_SIDE * self.thickness && !self.is_within_bulge()
    }

    /// Returns whether the point is on the skin opposite to side `stated`, and not on the surface through the grids. Tables of elements state the
    /// middles of elements on that surface.
    pub fn is_on_other_skin(&self, stated: Surface) -> bool {
        let near = ON_SKIN * self.thickness;
        self.contradicts(stated) && self.skin_distances(stated)[1] <= near && self.from_grids > near
    }

    /// Returns the distances from the skin of this side and from the other skin.
    pub fn skin_distances(&self, side: Surface) -> [f64; 2] {
        let here = self.distance[side.ix()];
        [here, self.distance[1 - side.ix()]]
    }
}

/// Returns the position of a point between the skins of a shell. `None` for a shell without area or thickness.
pub fn between_skins(model: &Model, ix: ShellIx, x: Vec3) -> Option<BetweenSkins> {
    let shell = model.shells.get(ix.us())?;
    let [bottom, top] = [Surface::Bottom, Surface::Top].map(|s| to_side(model, shell, s));
    let thickness = (top - bottom).abs();
    let (z, middle) = (shell_normal(model, ix)?, 0.5 * (bottom + top));
    let foot = foot_on(model, ix, x - z * middle)?.point;
    let found = BetweenSkins {
        distance: from_skins(model, ix, x)?,
        thickness,
        from_grids: foot_on(model, ix, x)?.distance,
        height: (x - foot).dot(&z) - middle,
        bulge: bulge(model, ix, foot).unwrap_or(0.0),
    };
    (thickness > 0.0).then_some(found)
}

/// Returns the height of the curved surface over a flat shell at a point `x` on it, along the normal. The shell and its neighbours outline this
/// surface.
///
/// Grids of a mesh are on the surface, and a flat shell cuts it off. With the surface `z = -x' K x / 2` about the centre of the shell, the slope of
/// its normal is `K x`. The curvature `K` (2 by 2, symmetric) is a least-squares fit to the normals at the centres of the neighbours without a bend.
/// The shell passes through its corners `c`, so that the height is `(mean(c' K c) - x' K x) / 2`.
fn bulge(model: &Model, ix: ShellIx, x: Vec3) -> Option<f64> {
    let shell = model.shells.get(ix.us())?;
    let (axes, middle) = (
        shell_axes(model, shell, ShellPlace::Centre)?,
        centre(model, shell)?,
    );
    let n = axes.row(2).transpose();
    let (mut normal_matrix, mut right) = (Mat3::zeros(), Vec3::zeros());
    for near in neighbours(model, ix) {
        let to = axes * (centre(model, model.shells.get(near.us())?)? - middle);
        let m = shell_normal(model, near)?;
        let m = axes * m * m.dot(&n).signum();
        // Unknowns: K along the first axis, across, along the second axis.
        let rows = [
            (Vec3::new(to.x, to.y, 0.0), m.x / m.z),
            (Vec3::new(0.0, to.x, to.y), m.y / m.z),
        ];
        for (row, slope) in rows {
            normal_matrix += row * row.transpose();
            right += row * slope;
        }
    }
    let scale = normal_matrix.trace();
    // With one neighbour, this is the smallest curvature that explains its slope.
    let curvature = normal_matrix
        .svd(true, true)
        .solve(&right, f64::EPSILON.sqrt() * scale)
        .ok()?;
    let form = |p: Vec3| {
        let p = axes * (p - middle);
        curvature.x * p.x * p.x + 2.0 * curvature.y * p.x * p.y + curvature.z * p.y * p.y
    };
    let count = shell.shape.n_corners();
    let at_corners: f64 = corners(model, shell)?[..count]
        .iter()
        .map(|c| form(*c))
        .sum();
    Some(0.5 * (at_corners / count as f64 - form(x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nastran::bdf::{MemoryLoader, read_deck};

    const RADIUS: f64 = 50.0;
    const THICKNESS: f64 = 1.0;

    /// Returns a tube about z with grids on the middle surface: `n` shells around, with normals outwards, and three rows.
    fn tube(n: u32) -> Model {
        let mut deck = "SOL 101\nCEND\nBEGIN BULK\n".to_owned();
        for row in 0..4 {
            for i in 0..n {
                let turn = std::f64::consts::TAU * f64::from(i) / f64::from(n);
                let [x, y] = [RADIUS * turn.cos(), RADIUS * turn.sin()];
                deck += &format!("GRID,{},,{x:.6},{y:.6},{}.\n", 1 + i + 100 * row, 10 * row);
            }
        }
        for row in 0..3 {
            for i in 0..n {
                let (a, b) = (1 + i + 100 * row, 1 + (i + 1) % n + 100 * row);
                let id = 1 + i + 100 * row;
                deck += &format!("CQUAD4,{id},1,{a},{b},{},{}\n", b + 100, a + 100);
            }
        }
        deck += &format!("PSHELL,1,1,{THICKNESS:.1}\nMAT1,1,200000.,,.3\nENDDATA\n");
        let deck = read_deck("tube.bdf", deck.into_bytes(), &mut MemoryLoader::default());
        assert!(deck.faults.is_empty(), "{:?}", deck.faults);
        Model::from_deck(&deck).0
    }

    #[test]
    fn the_bulge_of_a_tube_is_its_sagitta() {
        for n in [24, 36, 72] {
            let model = tube(n);
            let ix = model.shell_ix(101).unwrap();
            let half = std::f64::consts::PI / f64::from(n);
            let middle = centre(&model, &model.shells[ix.us()]).unwrap();
            let sagitta = RADIUS * (1.0 - half.cos());
            let found = bulge(&model, ix, middle).unwrap();
            // The error is of the next order in the angle between shells: `half^2`, times 3.
            assert!(
                (found / sagitta - 1.0).abs() < 3.0 * half * half,
                "{n}: {found} {sagitta}"
            );
        }
    }

    #[test]
    fn a_point_on_the_skin_of_a_coarse_tube_leaves_the_side_open_where_the_flat_shell_hides_it() {
        for (n, open) in [(20, [true, false]), (72, [false, false])] {
            let model = tube(n);
            let ix = model.shell_ix(101).unwrap();
            let half = std::f64::consts::PI / f64::from(n);
            let [inner, outer] = [-0.5, 0.5].map(|side| {
                let r = RADIUS + side * THICKNESS;
                let x = Vec3::new(r * half.cos(), r * half.sin(), 15.0);
                between_skins(&model, ix, x).unwrap()
            });
            assert_eq!(
                [inner, outer].map(|b| b.is_undecided()),
                open,
                "{n} {inner:?} {outer:?}"
            );
            // A stated side that agrees with the curved surface is not contradicted.
            assert!(!inner.contradicts(Surface::Bottom), "{n} {inner:?}");
            assert!(!outer.contradicts(Surface::Top), "{n} {outer:?}");
            assert!(outer.contradicts(Surface::Bottom), "{n} {outer:?}");
        }
    }
}
