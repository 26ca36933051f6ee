//! The short list of candidates on which a layout is searched, and the search on it.

use super::candidates::{Angles, Candidates, Choice};
use super::column_generation::{Columns, Groups};
use super::exchange::{self, Effort};
use super::relaxation_solution::Active;
use super::spacing;
use super::spec::Spec;
use super::variance_scan::{CandidateVariance, Report, price};
use crate::linalg::spd;
use std::collections::{HashMap, HashSet};

/// Number of rows for an exchange.
pub(super) const LIST: usize = 700;

/// A layout with its criterion.
pub(super) type ScoredLayout = (Vec<Choice>, f64);

/// Returns the better of two.
pub(super) fn better_of(a: Option<ScoredLayout>, b: Option<ScoredLayout>) -> Option<ScoredLayout> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.1 > a.1 { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Returns the price below which a candidate cannot be in a better layout than `incumbent`. A layout with this candidate loses the smallest term of
/// `T`.
pub(super) fn elimination(col: &Columns, k: usize, incumbent: f64) -> f64 {
    let needed = k as f64 * ((incumbent - col.relaxed.value()) / k as f64).exp();
    (needed - col.relaxed.prior_trace - col.top.0 + col.top.1).max(0.0) * (1.0 - 1e-9)
}

/// Returns the rows for an exchange: rows with weight, then rows with the best price. There are at most [`LIST`] rows, with prices of at least
/// `floor`.
pub(super) fn list_of(
    c: &Candidates,
    col: &Columns,
    groups: &Groups,
    floor: f64,
) -> Vec<CandidateVariance> {
    let report = if *c.angles() == Angles::Continuous {
        Report::BestOfPlace
    } else {
        Report::EachAngle
    };
    let mut threshold = (0.6 * col.top.1).max(floor);
    let mut priced = price(c, &col.relaxed.point.root, threshold, report, LIST);
    while priced.len() < LIST.min(c.n_rows()) && threshold > floor.max(1e-6 * col.top.1) {
        threshold = (0.5 * threshold).max(floor);
        priced = price(c, &col.relaxed.point.root, threshold, report, LIST);
    }
    let order = |a: &CandidateVariance, b: &CandidateVariance| {
        b.d.total_cmp(&a.d)
            .then((a.choice.place, a.choice.step).cmp(&(b.choice.place, b.choice.step)))
    };
    if priced.len() > LIST {
        priced.select_nth_unstable_by(LIST - 1, order);
        priced.truncate(LIST);
    }
    let seen: HashSet<(u32, u64)> = priced
        .iter()
        .map(|p| (p.choice.place, p.choice.angle.to_bits()))
        .collect();
    for (i, &choice) in col.choices.iter().enumerate() {
        if col.relaxed.weights[i] > 0.0 && !seen.contains(&(choice.place, choice.angle.to_bits())) {
            priced.push(CandidateVariance {
                d: col.relaxed.d[i],
                choice,
            });
        }
    }
    if let Groups::Cliques(of) = groups {
        // The rows with the largest variance are in few places. The best row of each further set of places keeps enough choice within the spacing.
        let mut sets = HashSet::new();
        let mut wide = price(
            c,
            &col.relaxed.point.root,
            0.0,
            Report::BestOfPlace,
            usize::MAX,
        );
        wide.sort_by(order);
        wide.retain(|p| sets.insert(of[p.choice.place as usize]));
        let seen: HashSet<(u32, u64)> = priced
            .iter()
            .map(|p| (p.choice.place, p.choice.angle.to_bits()))
            .collect();
        wide.retain(|p| !seen.contains(&(p.choice.place, p.choice.angle.to_bits())));
        priced.extend(wide.into_iter().take(LIST / 2));
    }
    priced.sort_by(order);
    priced
}

/// Returns the rows with the largest variance in a layout. An exchange of gauge `j` for row `i` can gain only if `d_i > d_j`, because `(1 + d_i)(1 -
/// d_j) + d_ij^2 <= 1 + d_i - d_j`.
pub(super) fn largest_variance_rows(
    c: &Candidates,
    spec: &Spec,
    gauges: &[Choice],
) -> Vec<CandidateVariance> {
    let k = c.n_loads();
    let mut m = spec.prior.clone();
    for &g in gauges {
        spd::add_outer(&mut m, &c.row(g), 1.0);
    }
    let Some(point) = spec.criterion.evaluate_at(&m, k) else {
        return Vec::new();
    };
    let slope = point.slope(k);
    let mut u = vec![0.0; k];
    let least = gauges.iter().fold(f64::INFINITY, |least, &g| {
        let row = c.row(g);
        spd::times(&slope, &row, &mut u);
        least.min(spd::dot(&row, &u))
    });
    let mut priced = price(c, &point.root, least, Report::BestOfPlace, LIST);
    if priced.len() > LIST {
        priced.select_nth_unstable_by(LIST - 1, by_price);
        priced.truncate(LIST);
    }
    priced.sort_by(by_price);
    priced
}

/// The dearest first.
fn by_price(a: &CandidateVariance, b: &CandidateVariance) -> std::cmp::Ordering {
    b.d.total_cmp(&a.d)
        .then((a.choice.place, a.choice.step).cmp(&(b.choice.place, b.choice.step)))
}

/// Returns the best layout that a search on `list` finds. `known` is a layout to start from.
pub(super) fn run(
    c: &Candidates,
    spec: &Spec,
    list: &[CandidateVariance],
    col: &Columns,
    effort: Effort,
    known: Option<&ScoredLayout>,
) -> Option<ScoredLayout> {
    let mut choices: Vec<Choice> = list.iter().map(|p| p.choice).collect();
    let mut index: HashMap<(u32, u64), usize> = choices
        .iter()
        .enumerate()
        .map(|(i, p)| ((p.place, p.angle.to_bits()), i))
        .collect();
    for p in known.iter().flat_map(|f| &f.0) {
        index
            .entry((p.place, p.angle.to_bits()))
            .or_insert_with(|| {
                choices.push(*p);
                choices.len() - 1
            });
    }
    let start: Option<Vec<usize>> = known.map(|f| {
        let at = |p: &Choice| index.get(&(p.place, p.angle.to_bits())).copied();
        f.0.iter().filter_map(at).collect()
    });
    let mut weights = vec![0.0; choices.len()];
    for (p, &w) in col.choices.iter().zip(&col.relaxed.weights) {
        if let Some(&i) = index.get(&(p.place, p.angle.to_bits())) {
            weights[i] = w;
        }
    }
    for p in known.iter().flat_map(|f| &f.0) {
        if let Some(&i) = index.get(&(p.place, p.angle.to_bits())) {
            weights[i] += 0.2;
        }
    }
    let active = rows_of(c, spec, &choices);
    let excludes = excluder(c, spec, &choices);
    let found = exchange::search(
        &active,
        spec.gauges,
        &spec.prior,
        &weights,
        start.as_deref(),
        &excludes,
        effort,
        &spec.stop,
    )?;
    Some((
        found.rows.iter().map(|&i| choices[i]).collect(),
        found.log_det,
    ))
}

/// Returns the rows of choices, each in a separate group.
pub(super) fn rows_of(c: &Candidates, spec: &Spec, choices: &[Choice]) -> Active {
    Active {
        k: c.n_loads(),
        criterion: spec.criterion.clone(),
        rows: choices.iter().flat_map(|&p| c.row(p)).collect(),
        group: (0..choices.len() as u32).collect(),
        n_groups: choices.len(),
    }
}

/// Returns whether two choices (by index) exclude each other.
pub(super) fn excluder<'a>(
    c: &'a Candidates,
    spec: &Spec,
    choices: &'a [Choice],
) -> impl Fn(usize, usize) -> bool + Sync + use<'a> {
    let positions = c.positions();
    let apart = spec.spacing;
    let spaced = apart > 0.0 && !positions.is_empty();
    let one_a_place = *c.angles() == Angles::Continuous || apart > 0.0;
    move |i, j| {
        let (a, b) = (choices[i].place as usize, choices[j].place as usize);
        i == j
            || (one_a_place && a == b)
            || (spaced && spacing::too_close(positions[a], positions[b], apart))
    }
}

/// Rotates one gauge after the other to its best angle.
pub(super) fn polish(
    c: &Candidates,
    spec: &Spec,
    mut gauges: Vec<Choice>,
    mut log_det: f64,
) -> ScoredLayout {
    let k = c.n_loads();
    for _ in 0..20 {
        let before = log_det;
        for i in 0..gauges.len() {
            let mut m = spec.prior.clone();
            for (j, &g) in gauges.iter().enumerate() {
                if j != i {
                    spd::add_outer(&mut m, &c.row(g), 1.0);
                }
            }
            // With as many gauges as loads, the matrix without one gauge is singular. A small multiple of the identity makes it regular and does not
            // change the optimum.
            let scale = (0..k).map(|p| m[p * k + p]).sum::<f64>() / k as f64 * 1e-9;
            for p in 0..k {
                m[p * k + p] += scale;
            }
            let Some(point) = spec.criterion.evaluate_at(&m, k) else {
                continue;
            };
            let one = c.subset(&[gauges[i].place]);
            let Some(p) = price(&one, &point.root, 0.0, Report::BestOfPlace, usize::MAX)
                .first()
                .copied()
            else {
                continue;
            };
            let turned = Choice {
                angle: p.choice.angle,
                ..gauges[i]
            };
            let old = std::mem::replace(&mut gauges[i], turned);
            match value_of(c, spec, &gauges) {
                Some(v) if v > log_det => log_det = v,
                _ => gauges[i] = old,
            }
        }
        if log_det - before < 1e-9 {
            break;
        }
    }
    (gauges, log_det)
}

/// Returns the criterion of a layout. `None` if the layout is singular.
pub(super) fn value_of(c: &Candidates, spec: &Spec, gauges: &[Choice]) -> Option<f64> {
    let mut m = spec.prior.clone();
    for &g in gauges {
        spd::add_outer(&mut m, &c.row(g), 1.0);
    }
    spec.criterion.evaluate_at(&m, c.n_loads()).map(|p| p.value)
}
