//! Frame in which solvers output shell strain.
//!
//! | element | x axis | z axis | evidence |
//! |---|---|---|---|
//! | CQUAD4, CQUADR | bisector of the diagonals: `unit(unit(d13) - unit(d24))` | `unit(d13 x d24)` | CQUAD4: MSC, NX (note); CQUADR: the manuals |
//! | CTRIA3, CTRIAR | side 1-2 | side 1-2 x side 1-3 | CTRIA3: MSC (note); CTRIAR: the manuals |
//! | CTRIA6 | side 1-2 (flat elements with straight sides) | as CTRIA3 | MSC, all digits |
//! | CQUAD8 | its angle to the curves of constant s equals the angle of y to the curves of constant r, at the place of output | r x s | the manuals |
//!
//! Note: output of these programs against displacement gradients, CQUAD4 to 1e-6, CTRIA3 in all digits.
//!
//! `d13 = G3 - G1`, `d24 = G4 - G2`; `y = z x x`. Warped quads: z is the normal of the mean plane.
//!
//! # Reference
//! MSC Nastran Quick Reference Guide, CQUAD4, CQUADR, CQUAD8, CTRIA3, CTRIA6, CTRIAR, "element coordinate system".

use crate::model::{Mat3, Model, Shell, Vec3};
use nastran::cards::ShellShape;

/// Place on a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShellPlace {
    /// The centre.
    Centre,
    /// Corner G1 (0) to G4 (3).
    Corner(usize),
}

/// Returns the output frame of a quadrilateral with corners `p`. Rows are x, y, z in basic. `None` if the quadrilateral has no area.
pub fn quad_axes(p: [Vec3; 4]) -> Option<Mat3> {
    let [d13, d24] = [p[2] - p[0], p[3] - p[1]];
    let z = d13.cross(&d24).try_normalize(0.0)?;
    let x = (d13.try_normalize(0.0)? - d24.try_normalize(0.0)?).try_normalize(0.0)?;
    rows(x, z)
}

/// Returns the output frame of a triangle with corners `p`. Rows are x, y, z in basic. `None` if the triangle has no area.
pub fn tria_axes(p: [Vec3; 3]) -> Option<Mat3> {
    let z = (p[1] - p[0]).cross(&(p[2] - p[0])).try_normalize(0.0)?;
    rows((p[1] - p[0]).try_normalize(0.0)?, z)
}

/// Returns the frame at equal angles to tangents `r` and `s`: x is as far from r as y is from s.
pub fn balanced_axes(r: Vec3, s: Vec3) -> Option<Mat3> {
    let z = r.cross(&s).try_normalize(0.0)?;
    let (r, s) = (r.try_normalize(0.0)?, s.try_normalize(0.0)?);
    let x = (r + s).try_normalize(0.0)? + (r - s).try_normalize(0.0)?;
    rows(x.try_normalize(0.0)?, z)
}

fn rows(x: Vec3, z: Vec3) -> Option<Mat3> {
    let y = z.cross(&x);
    let axes = Mat3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]);
    axes.iter().all(|v| v.is_finite()).then_some(axes)
}

/// Returns the output frame of a shell of the model at a place. Rows are x, y, z in basic. `None` if the element has no area or not this corner.
pub fn shell_axes(model: &Model, shell: &Shell, place: ShellPlace) -> Option<Mat3> {
    let x = |i: usize| model.grids.get(shell.grids.get(i)?.us()).map(|g| g.x);
    if let ShellPlace::Corner(c) = place
        && c >= shell.shape.n_corners()
    {
        return None;
    }
    match shell.shape {
        ShellShape::Quad4 | ShellShape::QuadR => quad_axes([x(0)?, x(1)?, x(2)?, x(3)?]),
        ShellShape::Tria3 | ShellShape::TriaR | ShellShape::Tria6 => {
            tria_axes([x(0)?, x(1)?, x(2)?])
        }
        ShellShape::Quad8 => {
            let p: Option<Vec<Vec3>> = (0..8).map(x).collect();
            let [r, s] = quad8_tangents(&p?, place)?;
            balanced_axes(r, s)
        }
    }
}

/// Tangents along r (side 1-2) and s (side 1-4) of a serendipity quadrilateral. A mid-side grid that repeats its corner is missing:
/// the middle of the side is taken.
fn quad8_tangents(p: &[Vec3], place: ShellPlace) -> Option<[Vec3; 2]> {
    let corner = [*p.first()?, *p.get(1)?, *p.get(2)?, *p.get(3)?];
    let middle = |i: usize| {
        let (a, b) = (corner[i], corner[(i + 1) % 4]);
        let m = p.get(4 + i).copied().unwrap_or(a);
        if m == a || m == b { (a + b) / 2.0 } else { m }
    };
    let m = [middle(0), middle(1), middle(2), middle(3)];
    // A parabola has the ends a, c and the middle b. Its slope is -3a + 4b - c at a and a - 4b + 3c at c.
    let at_start = |a: Vec3, b: Vec3, c: Vec3| -3.0 * a + 4.0 * b - c;
    let at_end = |a: Vec3, b: Vec3, c: Vec3| a - 4.0 * b + 3.0 * c;
    let [c1, c2, c3, c4] = corner;
    Some(match place {
        ShellPlace::Centre => [m[1] - m[3], m[2] - m[0]],
        ShellPlace::Corner(0) => [at_start(c1, m[0], c2), at_start(c1, m[3], c4)],
        ShellPlace::Corner(1) => [at_end(c1, m[0], c2), at_start(c2, m[1], c3)],
        ShellPlace::Corner(2) => [at_end(c4, m[2], c3), at_end(c2, m[1], c3)],
        ShellPlace::Corner(3) => [at_start(c4, m[2], c3), at_end(c1, m[3], c4)],
        ShellPlace::Corner(_) => return None,
    })
}

#[cfg(test)]
mod tests;
