//! Joins many short lines to few long ones, which make the SVG shorter.

use std::collections::BTreeMap;

type Point = [i64; 2];

/// Joins lines of two points end to end into longer lines, straight on where possible. Longer lines are unchanged.
pub(super) fn trails(lines: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
    let (short, mut out): (Vec<_>, Vec<_>) = lines.into_iter().partition(|l| l.len() == 2);
    let ends: Vec<[Point; 2]> = short.iter().map(|l| [l[0], l[1]]).collect();
    let mut at: BTreeMap<Point, Vec<usize>> = BTreeMap::new();
    for (i, points) in ends.iter().enumerate() {
        for p in points {
            at.entry(*p).or_default().push(i);
        }
    }
    let mut used = vec![false; ends.len()];
    for (i, [a, b]) in ends.iter().copied().enumerate() {
        if std::mem::replace(&mut used[i], true) {
            continue;
        }
        let mut trail = vec![a, b];
        // Extend the trail at its end, then at its beginning.
        for _ in 0..2 {
            while let [.., before, end] = trail[..]
                && let Some((k, next)) = next_line(&ends, &at, &used, before, end)
            {
                used[k] = true;
                if is_straight(before, end, next) {
                    trail.pop();
                }
                trail.push(next);
            }
            trail.reverse();
        }
        out.push(trail);
    }
    out
}

/// Returns a line not yet used that begins at `end`, and its other end. A line straight on from `before` is preferred.
fn next_line(
    ends: &[[Point; 2]],
    at: &BTreeMap<Point, Vec<usize>>,
    used: &[bool],
    before: Point,
    end: Point,
) -> Option<(usize, Point)> {
    let left = at.get(&end)?.iter().filter(|k| !used[**k]);
    let left = left.map(|k| {
        let [p, q] = ends[*k];
        (*k, if p == end { q } else { p })
    });
    let mut any = None;
    for (k, next) in left {
        if is_straight(before, end, next) {
            return Some((k, next));
        }
        any = any.or(Some((k, next)));
    }
    any
}

fn is_straight(a: Point, b: Point, c: Point) -> bool {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
    u[0] * v[1] == u[1] * v[0] && u[0] * v[0] + u[1] * v[1] > 0
}
