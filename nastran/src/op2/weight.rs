//! Grid point weight, table OGPWG.

use super::words::Words;
use crate::results::GridPointWeight;

/// Reads the 78 words of the record: MO 6 x 6, S 3 x 3, mass and centre of gravity in each direction. IS 3 x 3, IQ 3 and Q 3 x 3 follow.
pub(super) fn read_weight(w: Words<'_>, reference: u32) -> Option<GridPointWeight> {
    if w.len() < 78 {
        return None;
    }
    let v = |i: usize| w.real_at(i).unwrap_or(f64::NAN);
    let three = |from: usize| std::array::from_fn(|i| std::array::from_fn(|j| v(from + 3 * i + j)));
    Some(GridPointWeight {
        reference,
        mo: std::array::from_fn(|i| std::array::from_fn(|j| v(6 * i + j))),
        s: three(36),
        mass: std::array::from_fn(|i| v(45 + 4 * i)),
        cg: std::array::from_fn(|i| std::array::from_fn(|j| v(46 + 4 * i + j))),
        inertia_cg: three(57),
    })
}
