//! Faces of solids as identified by PLOAD4.

use super::types::{GridIx, Solid};
use nastran::cards::SolidShape;

/// Returns the faces by corner, each in an order whose right-hand normal points into the element.
pub(crate) fn faces(shape: SolidShape) -> &'static [&'static [usize]] {
    match shape {
        SolidShape::Tetra => &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
        SolidShape::Penta => &[
            &[0, 1, 2],
            &[3, 5, 4],
            &[0, 3, 4, 1],
            &[1, 4, 5, 2],
            &[2, 5, 3, 0],
        ],
        SolidShape::Hexa => &[
            &[0, 1, 2, 3],
            &[4, 7, 6, 5],
            &[0, 4, 5, 1],
            &[1, 5, 6, 2],
            &[2, 6, 7, 3],
            &[3, 7, 4, 0],
        ],
        SolidShape::Pyram => &[
            &[0, 1, 2, 3],
            &[0, 4, 1],
            &[1, 4, 2],
            &[2, 4, 3],
            &[3, 4, 0],
        ],
    }
}

/// Returns the corners of the face that PLOAD4 identifies by `corner`. In general these are G1 on the face and G3 opposite on the face. A tetrahedron
/// has G1 and the corner that is not on the face. A triangular face of a wedge has G1 alone. The right-hand normal of the corner order points into
/// the element, in the direction of positive pressure. The first corner is G1, so that the corner pressures are in the same order.
pub(super) fn solid_face(s: &Solid, corner: [Option<GridIx>; 2]) -> Option<[Option<GridIx>; 4]> {
    let place = |g: Option<GridIx>| {
        let g = g?;
        s.grids
            .iter()
            .take(s.shape.n_corners())
            .position(|c| *c == Some(g))
    };
    let first = place(corner[0])?;
    let second = place(corner[1]);
    if corner[1].is_some() && second.is_none() {
        return None;
    }
    let face = faces(s.shape).iter().find(|f| {
        let Some(i) = f.iter().position(|c| *c == first) else {
            return false;
        };
        match (s.shape, f.len(), second) {
            (SolidShape::Tetra, _, Some(off)) => !f.contains(&off),
            (_, 3, None) => true,
            (_, 4, Some(opposite)) => f.get((i + 2) % 4) == Some(&opposite),
            // Triangular face of a pyramid: G1 and G3 are both on it.
            (SolidShape::Pyram, 3, Some(other)) => f.contains(&other),
            _ => false,
        }
    })?;
    let start = face.iter().position(|c| *c == first)?;
    let mut out = [None; 4];
    for (k, slot) in out.iter_mut().enumerate().take(face.len()) {
        let c = *face.get((start + k) % face.len())?;
        *slot = *s.grids.get(c)?;
    }
    Some(out)
}
