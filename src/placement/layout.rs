//! The layout: relaxation, rounding, exchange and the certificate, in one call.

use super::candidates::{Angles, Candidates, Choice};
use super::columns::{self, Columns, Groups};
use super::exchange::{self, Effort};
use super::kernel::{Priced, Report, price};
use super::relax::{Active, criterion};
use super::spacing;
use crate::linalg::spd;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Number of gauges to choose.
    pub gauges: usize,
    /// Least distance between two gauges, in the unit of the positions; 0: none. With a distance, a place takes one gauge at most.
    pub spacing: f64,
    /// Information already there, `k x k` by rows (zeros: none): gauges kept, known load sizes.
    pub prior: Vec<f64>,
    /// Leading columns that are present but not asked for (Ds); 0: D over all.
    pub nuisance: usize,
    /// Gap, per load, to which the relaxation is solved; the certificate is as much looser.
    pub tolerance: f64,
    /// How hard to search.
    pub effort: Effort,
}

impl Spec {
    /// Usual settings for `gauges` gauges and `loads` loads: many loads make more local optima, so the search is longer.
    pub fn new(gauges: usize, loads: usize) -> Self {
        Self {
            gauges,
            spacing: 0.0,
            prior: vec![0.0; loads * loads],
            nuisance: 0,
            tolerance: 5e-4,
            effort: Effort {
                starts: 8,
                kicks: if loads > 12 { 60 } else { 12 },
                seed: 1,
            },
        }
    }
}

/// A layout with its certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The gauges, by place and angle.
    pub gauges: Vec<Choice>,
    /// `log det` of its information matrix; with nuisance loads, less that of their block.
    pub log_det: f64,
    /// No layout that keeps the rules has a larger `log det`.
    pub upper_bound: f64,
    /// `exp((log_det - upper_bound) / k)`: at least this share of the best possible.
    pub efficiency_bound: f64,
    /// Passes over all candidates.
    pub passes: usize,
    /// Candidates that could still be in a better layout; 0: this one is the best.
    pub alive: usize,
}

/// Why there is no layout.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlaceError {
    /// Fewer places than gauges.
    #[error(
        "{gauges} gauges are asked for and the candidates hold {places} places: ask for fewer, or widen [candidates]"
    )]
    TooFewPlaces {
        /// Asked for.
        gauges: usize,
        /// There are.
        places: usize,
    },
    /// No layout separates the loads.
    #[error(
        "no {gauges} gauges among these candidates separate the {loads} loads: ask for at least {loads} gauges, drop loads that act alike, \
         or state `expected` for loads with role \"nuisance\""
    )]
    Singular {
        /// Asked for.
        gauges: usize,
        /// Columns.
        loads: usize,
    },
    /// The spacing leaves too few places.
    #[error(
        "{gauges} gauges do not fit at least {spacing} apart among the candidates: reduce the spacing or the number"
    )]
    TooTight {
        /// Asked for.
        gauges: usize,
        /// Asked for.
        spacing: f64,
    },
}

/// Rows an exchange looks at.
const LIST: usize = 1000;

/// The best layout found for `spec`, with the bound that no other can pass.
///
/// # Errors
/// Where there are too few places, or the loads can't be separated by that many gauges.
pub fn place(c: &Candidates, spec: &Spec) -> Result<Layout, PlaceError> {
    let (loads, s) = (c.n_loads(), spec.gauges);
    let q = spec.nuisance.min(loads.saturating_sub(1));
    // The degree of the criterion: loads asked for.
    let k = loads - q;
    let spaced = spec.spacing > 0.0 && !c.positions().is_empty();
    let mut groups = if spaced || *c.angles() == Angles::Continuous {
        Groups::Places
    } else {
        Groups::Rows
    };
    let places = if groups == Groups::Rows {
        c.n_rows()
    } else {
        c.n_places()
    };
    if places < s || s == 0 {
        return Err(PlaceError::TooFewPlaces { gauges: s, places });
    }
    let singular = PlaceError::Singular { gauges: s, loads };
    let mut col = columns::solve(c, s, &spec.prior, q, &groups, spec.tolerance, &[])
        .ok_or_else(|| singular.clone())?;
    let mut upper = col.upper_bound;
    let mut passes = col.passes;
    let quick = Effort {
        starts: 4,
        kicks: 0,
        ..spec.effort
    };
    let mut list = list_of(c, &col, &groups, 0.0);
    let mut best = run(c, spec, &list, &col, quick, None);
    if spaced {
        for _ in 0..CLIQUE_ROUNDS {
            let floor = best.as_ref().map_or(0.0, |b| elimination(&col, k, b.1));
            let priced = price(c, &col.relaxed.linv, floor, Report::BestOfPlace, usize::MAX);
            let of = spacing::cliques(c.n_places(), &priced, c.positions(), spec.spacing);
            groups = Groups::Cliques(of);
            let Some(next) =
                columns::solve(c, s, &spec.prior, q, &groups, spec.tolerance, &col.choices)
            else {
                break;
            };
            passes += next.passes;
            let gained = upper - next.upper_bound;
            upper = upper.min(next.upper_bound);
            col = next;
            list = list_of(c, &col, &groups, 0.0);
            let found = run(c, spec, &list, &col, quick, best.as_ref());
            best = better(best, found);
            if gained < spec.tolerance * k as f64 {
                break;
            }
        }
    }
    let none = if spaced {
        PlaceError::TooTight {
            gauges: s,
            spacing: spec.spacing,
        }
    } else {
        singular
    };
    let incumbent = best.ok_or(none)?;
    let floor = elimination(&col, k, incumbent.1);
    list = list_of(c, &col, &groups, floor);
    let alive = list.iter().filter(|p| p.d >= floor).count();
    let found = run(c, spec, &list, &col, spec.effort, Some(&incumbent));
    let (mut gauges, mut log_det) = better(Some(incumbent.clone()), found).unwrap_or(incumbent);
    if *c.angles() == Angles::Continuous {
        (gauges, log_det) = polish(c, spec, gauges, log_det);
    }
    gauges.sort_by(|a, b| a.place.cmp(&b.place).then(a.angle.total_cmp(&b.angle)));
    // A layout is a lower bound of the best; rounding may leave it above the certificate by as much as the arithmetic.
    upper = upper.max(log_det);
    let efficiency_bound = ((log_det - upper) / k as f64).exp();
    Ok(Layout {
        gauges,
        log_det,
        upper_bound: upper,
        efficiency_bound,
        passes,
        alive,
    })
}

/// Rounds of rebuilding the sets of places within a spacing from new prices.
const CLIQUE_ROUNDS: usize = 4;

type Found = (Vec<Choice>, f64);

fn better(a: Option<Found>, b: Option<Found>) -> Option<Found> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.1 > a.1 { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// The price under which a candidate can't be in a layout better than `incumbent`: forcing it in replaces the smallest term of `T`.
fn elimination(col: &Columns, k: usize, incumbent: f64) -> f64 {
    let needed = k as f64 * ((incumbent - col.relaxed.log_det) / k as f64).exp();
    (needed - col.relaxed.prior_trace - col.top.0 + col.top.1).max(0.0) * (1.0 - 1e-9)
}

/// The rows for an exchange: those with weight, then the best-priced, at most [`LIST`], none under `floor`.
fn list_of(c: &Candidates, col: &Columns, groups: &Groups, floor: f64) -> Vec<Priced> {
    let report = if *c.angles() == Angles::Continuous {
        Report::BestOfPlace
    } else {
        Report::EachAngle
    };
    let mut threshold = (0.6 * col.top.1).max(floor);
    let mut priced = price(c, &col.relaxed.linv, threshold, report, LIST);
    while priced.len() < LIST.min(c.n_rows()) && threshold > floor.max(1e-6 * col.top.1) {
        threshold = (0.5 * threshold).max(floor);
        priced = price(c, &col.relaxed.linv, threshold, report, LIST);
    }
    let order = |a: &Priced, b: &Priced| {
        b.d.total_cmp(&a.d)
            .then((a.choice.place, a.choice.step).cmp(&(b.choice.place, b.choice.step)))
    };
    if priced.len() > LIST {
        priced.select_nth_unstable_by(LIST - 1, order);
        priced.truncate(LIST);
    }
    let seen: std::collections::HashSet<(u32, u64)> = priced
        .iter()
        .map(|p| (p.choice.place, p.choice.angle.to_bits()))
        .collect();
    for (i, &choice) in col.choices.iter().enumerate() {
        if col.relaxed.weights[i] > 0.0 && !seen.contains(&(choice.place, choice.angle.to_bits())) {
            priced.push(Priced {
                d: col.relaxed.d[i],
                choice,
            });
        }
    }
    if let Groups::Cliques(of) = groups {
        // The best-priced rows crowd in few places; the best of each further set of places keeps a choice within the spacing.
        let mut sets = std::collections::HashSet::new();
        let mut wide = price(c, &col.relaxed.linv, 0.0, Report::BestOfPlace, usize::MAX);
        wide.sort_by(order);
        wide.retain(|p| sets.insert(of[p.choice.place as usize]));
        let seen: std::collections::HashSet<(u32, u64)> = priced
            .iter()
            .map(|p| (p.choice.place, p.choice.angle.to_bits()))
            .collect();
        wide.retain(|p| !seen.contains(&(p.choice.place, p.choice.angle.to_bits())));
        priced.extend(wide.into_iter().take(LIST / 2));
    }
    priced.sort_by(order);
    priced
}

fn run(
    c: &Candidates,
    spec: &Spec,
    list: &[Priced],
    col: &Columns,
    effort: Effort,
    known: Option<&Found>,
) -> Option<Found> {
    let k = c.n_loads();
    let mut choices: Vec<Choice> = list.iter().map(|p| p.choice).collect();
    let mut index: std::collections::HashMap<(u32, u64), usize> = choices
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
    let rows = choices.iter().flat_map(|&p| c.row(p)).collect();
    let active = Active {
        k,
        nuisance: spec.nuisance.min(k.saturating_sub(1)),
        rows,
        group: (0..choices.len() as u32).collect(),
        n_groups: choices.len(),
    };
    let positions = c.positions();
    let (spaced, one_a_place) = (
        spec.spacing > 0.0 && !positions.is_empty(),
        *c.angles() == Angles::Continuous || spec.spacing > 0.0,
    );
    let excludes = |i: usize, j: usize| {
        let (a, b) = (choices[i].place as usize, choices[j].place as usize);
        i == j
            || (one_a_place && a == b)
            || (spaced && spacing::too_close(positions[a], positions[b], spec.spacing))
    };
    let found = exchange::search(
        &active,
        spec.gauges,
        &spec.prior,
        &weights,
        &excludes,
        effort,
    )?;
    Some((
        found.rows.iter().map(|&i| choices[i]).collect(),
        found.log_det,
    ))
}

/// Turns one gauge after the other to its best angle.
fn polish(c: &Candidates, spec: &Spec, mut gauges: Vec<Choice>, mut log_det: f64) -> Found {
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
            // With as many gauges as loads the rest alone is singular: a trace of identity keeps it regular without moving the optimum.
            let scale = (0..k).map(|p| m[p * k + p]).sum::<f64>() / k as f64 * 1e-9;
            for p in 0..k {
                m[p * k + p] += scale;
            }
            let Some(l) = spd::cholesky(&m, k) else {
                continue;
            };
            let mut linv = spd::inverse_lower(&l, k);
            linv[..spec.nuisance.min(k - 1) * k].fill(0.0);
            let one = c.subset(&[gauges[i].place]);
            let Some(p) = price(&one, &linv, 0.0, Report::BestOfPlace, usize::MAX)
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

/// The criterion of a layout; `None` where it is singular.
fn value_of(c: &Candidates, spec: &Spec, gauges: &[Choice]) -> Option<f64> {
    let k = c.n_loads();
    let mut m = spec.prior.clone();
    for &g in gauges {
        spd::add_outer(&mut m, &c.row(g), 1.0);
    }
    criterion(&m, k, spec.nuisance.min(k.saturating_sub(1))).map(|v| v.0)
}
