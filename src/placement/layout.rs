//! The layout: relaxation, rounding, exchange and the certificate, in one call.

use super::branch_and_bound::{self, Problem, Proof};
use super::candidates::{Angles, Candidates, Choice};
use super::column_generation::{self, Columns, Groups};
use super::exchange::Effort;
use super::robust;
use super::shortlist::{
    Found, LIST, around, better, elimination, excluder, list_of, polish, rows_of, run, value_of,
};
use super::spacing;
use super::spec::{Loss, Spec};
use super::variance_scan::{Priced, Report, price};
use std::collections::HashMap;

/// A layout with its certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The gauges, by place and angle.
    pub gauges: Vec<Choice>,
    /// Its criterion: for D `log det` of its information matrix, for Ds less that of the nuisance block.
    pub log_det: f64,
    /// No layout that keeps the rules has a larger criterion.
    pub upper_bound: f64,
    /// `exp((log_det - upper_bound) / degree)`: at least this share of the best possible.
    pub efficiency_bound: f64,
    /// True where no layout that keeps the rules is better.
    pub proved: bool,
    /// Passes over all candidates.
    pub passes: usize,
    /// Candidates that the bound does not exclude from a better layout; `None` where too many to count.
    pub alive: Option<usize>,
    /// Nodes of the proof; 0 where none was tried.
    pub nodes: usize,
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

/// The best layout found for `spec`, with the bound that no other can pass.
///
/// # Errors
/// Where there are too few places, or the loads can't be separated by that many gauges.
pub fn place(c: &Candidates, spec: &Spec) -> Result<Layout, PlaceError> {
    let (loads, s) = (c.n_loads(), spec.gauges);
    // Loads asked for.
    let k = spec.criterion.degree(loads);
    let q = &spec.criterion;
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
    let mut col = column_generation::solve(c, s, &spec.prior, q, &groups, spec.tolerance, &[])
        .ok_or_else(|| singular.clone())?;
    let mut upper = col.upper_bound;
    let mut passes = col.passes;
    let quick = Effort {
        starts: if spaced { 4 } else { 2 },
        perturbations: 0,
        ..spec.effort
    };
    let mut list = list_of(c, &col, &groups, 0.0);
    let mut best = run(c, spec, &list, &col, quick, None);
    if spaced {
        for _ in 0..CLIQUE_ROUNDS {
            let floor = best.as_ref().map_or(0.0, |b| elimination(&col, k, b.1));
            let priced = price(
                c,
                &col.relaxed.point.root,
                floor,
                Report::BestOfPlace,
                usize::MAX,
            );
            let of = spacing::cliques(c.n_places(), &priced, c.positions(), spec.spacing);
            groups = Groups::Cliques(of);
            let Some(next) = column_generation::solve(
                c,
                s,
                &spec.prior,
                q,
                &groups,
                spec.tolerance,
                &col.choices,
            ) else {
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
    // What can't be in a better layout may be in one that loses less.
    let floor = match spec.loss {
        Loss::Judged => elimination(&col, k, incumbent.1),
        Loss::Optimised => 0.0,
    };
    list = list_of(c, &col, &groups, floor);
    let found = run(c, spec, &list, &col, spec.effort, Some(&incumbent));
    let (mut gauges, mut log_det) = better(Some(incumbent.clone()), found).unwrap_or(incumbent);
    // A list that was cut may lack what this layout lacks.
    let rounds = if list.len() < LIST { 0 } else { ROUNDS };
    for _ in 0..rounds {
        if spec.stop.is_asked() {
            break;
        }
        let near = around(c, spec, &gauges);
        let known = (gauges.clone(), log_det);
        let effort = Effort {
            starts: 1,
            perturbations: spec.effort.perturbations / 4,
            ..spec.effort
        };
        passes += 1;
        match run(c, spec, &near, &col, effort, Some(&known)) {
            Some(next) if next.1 > log_det + branch_and_bound::SAME => (gauges, log_det) = next,
            _ => break,
        }
    }
    if *c.angles() == Angles::Continuous {
        (gauges, log_det) = polish(c, spec, gauges, log_det);
    }
    let robust = match spec.loss {
        Loss::Optimised => robust_of(c, spec, &list, &gauges),
        Loss::Judged => None,
    };
    let mut proved = robust.is_none() && log_det >= upper - branch_and_bound::SAME;
    let (mut alive, mut nodes) = (None, 0);
    if let Some(found) = robust {
        (gauges, log_det) = found;
    } else if !proved && spec.proof > 0.0 && *c.angles() != Angles::Continuous {
        let tried;
        (alive, tried) = prove(c, spec, &col, &groups, log_det, upper);
        if let Some((proof, choices)) = tried {
            (proved, nodes) = (proof.proved, proof.nodes);
            upper = upper.min(proof.upper);
            if let Some(best) = proof.best {
                gauges = best.rows.iter().map(|&i| choices[i]).collect();
                log_det = best.log_det;
            }
        }
    }
    gauges.sort_by(|a, b| a.place.cmp(&b.place).then(a.angle.total_cmp(&b.angle)));
    // A layout is a lower bound of the best; rounding may leave it above the certificate by as much as the arithmetic.
    upper = if proved { log_det } else { upper.max(log_det) };
    let efficiency_bound = ((log_det - upper) / k as f64).exp();
    Ok(Layout {
        gauges,
        log_det,
        upper_bound: upper,
        efficiency_bound,
        proved,
        passes,
        alive,
        nodes,
    })
}

/// The layout near `gauges` that leaves most after the worst loss; `None` where there is none better.
fn robust_of(c: &Candidates, spec: &Spec, list: &[Priced], gauges: &[Choice]) -> Option<Found> {
    let mut choices: Vec<Choice> = gauges.to_vec();
    choices.extend(
        list.iter()
            .map(|p| p.choice)
            .filter(|p| !gauges.iter().any(|g| g == p)),
    );
    let active = rows_of(c, spec, &choices);
    let start: Vec<usize> = (0..gauges.len()).collect();
    let excludes = excluder(c, spec, &choices);
    let found = robust::search(&active, &spec.prior, &start, &excludes, spec.effort)?;
    let gauges: Vec<Choice> = found.0.iter().map(|&i| choices[i]).collect();
    let value = value_of(c, spec, &gauges)?;
    Some((gauges, value))
}

/// Rounds of exchange with the rows whose variance in the layout is largest.
const ROUNDS: usize = 5;

/// Rounds of rebuilding the sets of places within a spacing from new prices.
const CLIQUE_ROUNDS: usize = 4;

/// Branch and bound on the candidates that could be in a layout better than `incumbent`; how many there are, and what came of it where
/// it was tried.
fn prove(
    c: &Candidates,
    spec: &Spec,
    col: &Columns,
    groups: &Groups,
    incumbent: f64,
    upper: f64,
) -> (Option<usize>, Option<(Proof, Vec<Choice>)>) {
    let k = spec.criterion.degree(c.n_loads());
    let floor = elimination(col, k, incumbent);
    let root = &col.relaxed.point.root;
    let list = price(
        c,
        root,
        floor,
        Report::EachAngle,
        branch_and_bound::MOST_ROWS + 1,
    );
    if list.len() > branch_and_bound::MOST_ROWS {
        return (None, None);
    }
    let choices: Vec<Choice> = list.iter().map(|p| p.choice).collect();
    let mut active = rows_of(c, spec, &choices);
    let mut number: HashMap<u64, u32> = HashMap::new();
    for (g, &choice) in active.group.iter_mut().zip(&choices) {
        let next = number.len() as u32;
        *g = *number.entry(groups.key(choice)).or_insert(next);
    }
    active.n_groups = number.len();
    let heavy: HashMap<(u32, u64), f64> = col
        .choices
        .iter()
        .zip(&col.relaxed.weights)
        .map(|(p, &w)| ((p.place, p.angle.to_bits()), w))
        .collect();
    let weights: Vec<f64> = choices
        .iter()
        .map(|p| {
            heavy
                .get(&(p.place, p.angle.to_bits()))
                .copied()
                .unwrap_or(0.0)
        })
        .collect();
    let problem = Problem {
        active: &active,
        s: spec.gauges,
        prior: &spec.prior,
        incumbent,
        upper,
        work: spec.proof,
        stop: &spec.stop,
    };
    let proof = branch_and_bound::prove(&problem, &weights, &excluder(c, spec, &choices));
    (Some(choices.len()), Some((proof, choices)))
}
