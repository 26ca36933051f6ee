//! The relaxation over all candidates by column generation, and the bound that certifies it.
//!
//! A small set of rows is solved, every candidate is priced with the result in one pass, the best-priced join, until the bound closes.

use super::candidates::{Angles, Candidates, Choice};
use super::criterion::Criterion;
use super::relax::relax;
use super::relaxation_solution::{Active, RelaxationSolution};
use super::variance_scan::{CandidateVariance, Report, price};
use crate::stop::Stop;
use std::collections::{HashMap, HashSet};

/// Groups of rows. The weights of a group sum to at most 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Groups {
    /// Every row for itself: distinct rows.
    Rows,
    /// One gauge a place, whatever its angle.
    Places,
    /// One gauge in each set of places closer to each other than the spacing: the set's number by place.
    Cliques(Vec<u32>),
}

impl Groups {
    /// Returns the group of a candidate.
    pub fn key(&self, c: Choice) -> u64 {
        match self {
            Groups::Rows => (u64::from(c.place) << 16) | u64::from(c.step),
            Groups::Places => u64::from(c.place),
            Groups::Cliques(of) => u64::from(of[c.place as usize]),
        }
    }

    /// Returns whether a pass over the candidates reports every angle of a place or only the best one.
    pub fn report(&self) -> Report {
        match self {
            Groups::Rows => Report::EachAngle,
            _ => Report::BestOfPlace,
        }
    }
}

/// The relaxation solved over all candidates.
#[derive(Clone, Debug)]
pub struct Columns {
    /// Rows that took part in the solution.
    pub active: Active,
    /// Candidates of these rows.
    pub choices: Vec<Choice>,
    /// Weights of these rows, and `M`.
    pub relaxed: RelaxationSolution,
    /// Upper bound of the `log det` of any layout.
    pub upper_bound: f64,
    /// `T` and its smallest term at the last pass.
    pub top: (f64, f64),
    /// Passes over all candidates.
    pub passes: usize,
}

/// Columns the first solution starts with, at least.
const FIRST_ROWS: usize = 256;
/// Passes after which the gap reached is taken.
const MAX_PASSES: usize = 60;

/// Solves the relaxation for `s` gauges up to a gap (per load) of `tolerance`, or until it is cancelled. The bound is valid in both cases. `None` if
/// no layout has a regular information matrix.
pub fn solve(
    c: &Candidates,
    s: usize,
    prior: &[f64],
    criterion: &Criterion,
    groups: &Groups,
    tolerance: f64,
    warm: &[Choice],
    stop: &Stop,
) -> Option<Columns> {
    let k = c.n_loads();
    let wanted = criterion.degree(k) as f64;
    let mut set = RowSet::new(k, criterion.clone());
    for &w in warm {
        set.add(c, w, groups);
    }
    let mut relaxed = None;
    let mut stride = (c.n_places() / (FIRST_ROWS.max(4 * s))).max(1);
    while relaxed.is_none() {
        for place in (0..c.n_places()).step_by(stride) {
            for choice in first_angles(c.angles(), place as u32) {
                set.add(c, choice, groups);
            }
        }
        relaxed = start(&set, s, prior);
        if relaxed.is_none() && stride == 1 {
            return None;
        }
        stride = (stride / 4).max(1);
    }
    let mut relaxed = relaxed?;
    let mut upper_bound = f64::INFINITY;
    let mut passes = 0;
    loop {
        let (_, least_active) = super::relax::top_sum(
            set.active
                .group
                .iter()
                .copied()
                .zip(relaxed.d.iter().copied()),
            set.active.n_groups,
            s,
        );
        let keep = if matches!(groups, Groups::Cliques(_)) {
            usize::MAX
        } else {
            (4 * s).max(256)
        };
        let threshold = least_active * (1.0 - 1e-9);
        let mut priced = price(c, &relaxed.point.root, threshold, groups.report(), keep);
        passes += 1;
        let top = top_of(&priced, groups, s, threshold);
        let gap = ((relaxed.prior_trace + top.0) / wanted).ln();
        upper_bound = upper_bound.min(relaxed.value() + wanted * gap);
        if gap <= tolerance || passes >= MAX_PASSES || stop.is_asked() {
            return Some(Columns {
                active: set.active,
                choices: set.choices,
                relaxed,
                upper_bound,
                top,
                passes,
            });
        }
        priced.sort_by(|a, b| {
            b.d.total_cmp(&a.d)
                .then((a.choice.place, a.choice.step).cmp(&(b.choice.place, b.choice.step)))
        });
        let room = (6 * k + s).max(96);
        let mut added = 0;
        if matches!(groups, Groups::Cliques(_)) {
            // The best row of each set of places comes first, because the rows with the largest variance are in few sets.
            let mut seen = HashSet::new();
            priced.sort_by_cached_key(|p| !seen.insert(groups.key(p.choice)));
        }
        for p in &priced {
            if added >= room {
                break;
            }
            added += usize::from(set.add(c, p.choice, groups));
        }
        let mut weights = relaxed.weights;
        set.prune(&mut weights, &relaxed.d, least_active, 4000);
        weights.resize(set.active.len(), 0.0);
        let inner = if added == 0 {
            0.1 * tolerance
        } else {
            (0.25 * gap).max(0.3 * tolerance)
        };
        relaxed = relax(&set.active, s, prior, weights, inner, 400)?;
    }
}

fn first_angles(angles: &Angles, place: u32) -> Vec<Choice> {
    match angles {
        Angles::Fixed => vec![Choice {
            place,
            step: 0,
            angle: 0.0,
        }],
        Angles::Grid(a) => {
            let stride = (a.len() / 4).max(1);
            (0..a.len())
                .step_by(stride)
                .map(|i| Choice {
                    place,
                    step: i as u16,
                    angle: a[i],
                })
                .collect()
        }
        Angles::Continuous => (0..4)
            .map(|i| Choice {
                place,
                step: 0,
                angle: f64::from(i) * std::f64::consts::FRAC_PI_4,
            })
            .collect(),
    }
}

/// Returns the relaxation with equal weight in every group.
fn start(set: &RowSet, s: usize, prior: &[f64]) -> Option<RelaxationSolution> {
    let groups = set.active.n_groups;
    if groups < s {
        return None;
    }
    let mut members = vec![0usize; groups];
    for &g in &set.active.group {
        members[g as usize] += 1;
    }
    let share = s as f64 / groups as f64;
    let weights = set
        .active
        .group
        .iter()
        .map(|&g| share / members[g as usize] as f64)
        .collect();
    relax(&set.active, s, prior, weights, 0.05, 60)
}

/// Returns `T` over the candidates whose price is at least `threshold`: the sum of the `s` largest group maxima, and the smallest of these maxima.
pub fn top_of(
    priced: &[CandidateVariance],
    groups: &Groups,
    s: usize,
    threshold: f64,
) -> (f64, f64) {
    let mut best: Vec<f64> = match groups {
        Groups::Rows | Groups::Places => priced.iter().map(|p| p.d).collect(),
        Groups::Cliques(_) => {
            let mut by_key: HashMap<u64, f64> = HashMap::new();
            for p in priced {
                let b = by_key.entry(groups.key(p.choice)).or_insert(p.d);
                *b = b.max(p.d);
            }
            by_key.into_values().collect()
        }
    };
    best.sort_unstable_by(|a, b| b.total_cmp(a));
    best.truncate(s);
    let sum: f64 = best.iter().sum();
    if best.len() < s {
        // Candidates that the pass left out are worth at most its threshold.
        return (sum + (s - best.len()) as f64 * threshold, threshold);
    }
    (sum, best.last().copied().unwrap_or(0.0))
}

struct RowSet {
    active: Active,
    choices: Vec<Choice>,
    seen: HashMap<(u32, u64), usize>,
    groups: HashMap<u64, u32>,
}

impl RowSet {
    fn new(k: usize, criterion: Criterion) -> Self {
        Self {
            active: Active {
                k,
                criterion,
                ..Active::default()
            },
            choices: Vec::new(),
            seen: HashMap::new(),
            groups: HashMap::new(),
        }
    }

    /// True where the candidate was new.
    fn add(&mut self, c: &Candidates, choice: Choice, groups: &Groups) -> bool {
        let id = (choice.place, choice.angle.to_bits());
        if self.seen.contains_key(&id) {
            return false;
        }
        self.seen.insert(id, self.choices.len());
        let next = self.groups.len() as u32;
        let g = *self.groups.entry(groups.key(choice)).or_insert(next);
        self.active.rows.extend(c.row(choice));
        self.active.group.push(g);
        self.active.n_groups = self.groups.len();
        self.choices.push(choice);
        true
    }

    /// Drops rows without weight and with low price once there are more than `limit`.
    fn prune(&mut self, weights: &mut Vec<f64>, d: &[f64], least: f64, limit: usize) {
        let n = weights.len();
        if self.active.len() <= limit {
            return;
        }
        let keep: Vec<bool> = (0..self.active.len())
            .map(|i| i >= n || weights[i] > 0.0 || d[i] > 0.8 * least)
            .collect();
        let k = self.active.k;
        let old = std::mem::take(&mut self.active);
        self.active.k = k;
        self.active.criterion = old.criterion.clone();
        self.seen.clear();
        let (old_groups, mut renumber) = (std::mem::take(&mut self.groups), HashMap::new());
        let choices = std::mem::take(&mut self.choices);
        for (i, &choice) in choices.iter().enumerate().filter(|(i, _)| keep[*i]) {
            let next = renumber.len() as u32;
            let g = *renumber.entry(old.group[i]).or_insert(next);
            self.active.rows.extend_from_slice(old.row(i));
            self.active.group.push(g);
            self.seen
                .insert((choice.place, choice.angle.to_bits()), self.choices.len());
            self.choices.push(choice);
        }
        self.active.n_groups = renumber.len();
        self.groups = old_groups
            .into_iter()
            .filter_map(|(key, g)| renumber.get(&g).map(|&n| (key, n)))
            .collect();
        let mut i = 0;
        weights.retain(|_| {
            i += 1;
            keep[i - 1]
        });
    }
}
