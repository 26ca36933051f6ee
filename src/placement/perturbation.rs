//! Random moves that take a search out of a local optimum.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Returns a layout with `count` gauges moved to random rows of `rows` if these are compatible with the other gauges. If `count` is the number of
/// gauges of the layout, every gauge is tried once.
pub fn move_gauges(
    from: &[usize],
    count: usize,
    rows: usize,
    excludes: &(impl Fn(usize, usize) -> bool + ?Sized),
    rng: &mut ChaCha8Rng,
) -> Vec<usize> {
    let mut layout = from.to_vec();
    for n in 0..count {
        let slot = if count == layout.len() {
            n
        } else {
            rng.random_range(0..layout.len())
        };
        let i = rng.random_range(0..rows);
        if fits(&layout, slot, i, excludes) {
            layout[slot] = i;
        }
    }
    layout
}

/// Returns whether row `i` is compatible with all gauges except the gauge in `slot`.
pub fn fits(
    layout: &[usize],
    slot: usize,
    i: usize,
    excludes: &(impl Fn(usize, usize) -> bool + ?Sized),
) -> bool {
    let mut rest = layout.iter().enumerate().filter(|(q, _)| *q != slot);
    rest.all(|(_, &r)| !excludes(i, r))
}
