//! Minimum distance between gauges: which places exclude each other, and a bound that accounts for this distance.

use super::variance_scan::CandidateVariance;
use std::collections::HashMap;

/// Returns the distance of two places.
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Share of the spacing that is allowed for rounding. Two gauges may be exactly a spacing apart.
pub const ROUNDING: f64 = 1e-9;

/// Returns whether two places are too close to each other.
pub fn too_close(a: [f64; 3], b: [f64; 3], spacing: f64) -> bool {
    distance(a, b) < spacing * (1.0 - ROUNDING)
}

/// Returns a partition of the places into sets whose members are all too close to each other. Each set can contain at most one gauge.
///
/// The sets are built greedily from the place with the largest variance downwards, so that few sets contain the weight of the relaxation. A place
/// that is not in `priced` is a separate set. Any such partition gives a valid bound.
pub fn cliques(
    n_places: usize,
    priced: &[CandidateVariance],
    positions: &[[f64; 3]],
    spacing: f64,
) -> Vec<u32> {
    let mut best: HashMap<u32, f64> = HashMap::new();
    for p in priced {
        let b = best.entry(p.choice.place).or_insert(p.d);
        *b = b.max(p.d);
    }
    let mut order: Vec<(u32, f64)> = best.into_iter().collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let rank: HashMap<u32, usize> = order
        .iter()
        .enumerate()
        .map(|(i, &(p, _))| (p, i))
        .collect();
    let cell = |x: [f64; 3]| -> [i64; 3] { x.map(|v| (v / spacing).floor() as i64) };
    let mut grid: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (place, _) in &order {
        grid.entry(cell(positions[*place as usize]))
            .or_default()
            .push(*place);
    }
    let mut of: Vec<u32> = vec![u32::MAX; n_places];
    let mut next = 0;
    for &(seed, _) in &order {
        if of[seed as usize] != u32::MAX {
            continue;
        }
        let x = positions[seed as usize];
        let c = cell(x);
        let mut members = vec![seed];
        let mut near = Vec::new();
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    near.extend(
                        grid.get(&[c[0] + dx, c[1] + dy, c[2] + dz])
                            .into_iter()
                            .flatten()
                            .copied(),
                    );
                }
            }
        }
        near.retain(|&p| {
            of[p as usize] == u32::MAX && p != seed && too_close(positions[p as usize], x, spacing)
        });
        near.sort_by_key(|p| rank[p]);
        for p in near {
            if members
                .iter()
                .all(|&m| too_close(positions[m as usize], positions[p as usize], spacing))
            {
                members.push(p);
            }
        }
        for m in members {
            of[m as usize] = next;
        }
        next += 1;
    }
    for v in &mut of {
        if *v == u32::MAX {
            *v = next;
            next += 1;
        }
    }
    of
}
