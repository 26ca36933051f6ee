//! Optimal layout of a small problem with proof, by branch and bound over the relaxation. The bound also fixes variables.
//!
//! A node has chosen gauges and free rows; all remaining rows are excluded. The relaxation bounds every layout below the node by `value + q ln((tr(G
//! P) + T) / q)`. `P` is the information of the chosen gauges and the prior. `T` is the sum of the `s` largest slopes, at most one of each group.
//!
//! Choosing row `j` replaces the smallest term of `T` by `d_j`. Excluding it replaces `d_j` by the next slope. If the bound then falls below the best
//! known layout, `j` is fixed to the other value.

use super::exchange::RowSelection;
use super::relax::relax;
use super::relaxation_solution::{Active, RelaxationSolution};
use crate::linalg::spd;
use crate::stop::Stop;
use rayon::prelude::*;
use std::collections::HashMap;

/// Problem of the search: choose `s` of the rows.
pub struct Problem<'a> {
    /// Rows and groups; members of a group exclude each other.
    pub active: &'a Active,
    /// Number of gauges.
    pub s: usize,
    /// Prior information.
    pub prior: &'a [f64],
    /// Criterion of the best known layout.
    pub incumbent: f64,
    /// Known upper bound of the criterion.
    pub upper: f64,
    /// Approximate number of floating-point operations after which the search stops. Operations are counted instead of time, so that results don't
    /// depend on the machine.
    pub work: f64,
    /// Cancellation of the search.
    pub stop: &'a Stop,
}

/// Result of the search.
#[derive(Clone, Debug)]
pub struct Proof {
    /// A better layout than the incumbent, if there is one.
    pub best: Option<RowSelection>,
    /// Upper bound of the criterion of any layout; the criterion of the best layout if proved.
    pub upper: f64,
    /// Number of visited nodes.
    pub nodes: usize,
    /// Whether no better layout exists (by more than [`SAME`]).
    pub proved: bool,
}

/// Difference of criteria that counts as zero: rounding of log-determinants.
pub const SAME: f64 = 1e-9;
/// Number of nodes evaluated together: fixed, so that the result does not depend on the number of threads.
const BATCH: usize = 8;
/// Successive tolerances for the relaxation of a node, until it decides.
const LADDER: [f64; 6] = [3e-3, 3e-4, 3e-5, 3e-6, 1e-7, 1e-9];
/// Weights this close to 0 or 1 count as such when a row to branch on is chosen.
const WHOLE: f64 = 1e-6;

#[derive(Clone, Default)]
struct Node {
    bound: f64,
    inside: Vec<u32>,
    free: Vec<u32>,
    weights: Vec<f64>,
}

struct Step {
    found: Vec<RowSelection>,
    children: Vec<Node>,
    work: f64,
}

/// Exclusions between rows, and groups of equal rows.
struct Rules {
    conflicts: Vec<Vec<u32>>,
    /// Number shared by rows with equal readings (except for the sign); `u32::MAX` for a single row.
    twins: Vec<u32>,
}

/// Searches until no better layout is possible, or `work` is spent.
pub fn prove(
    p: &Problem,
    weights: &[f64],
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
) -> Proof {
    let n = p.active.len();
    let rules = Rules::from_active(p.active, excludes);
    let mut known = p.incumbent;
    let mut best: Option<RowSelection> = None;
    let mut open = vec![Node {
        bound: p.upper,
        inside: Vec::new(),
        free: (0..n as u32).collect(),
        weights: weights.to_vec(),
    }];
    let (mut nodes, mut work) = (0, 0.0);
    while !open.is_empty() && work < p.work && !p.stop.is_asked() {
        // Sort the node with the best bound last.
        open.sort_by(|a, b| a.bound.total_cmp(&b.bound).then(a.inside.cmp(&b.inside)));
        let batch = open.split_off(open.len().saturating_sub(BATCH));
        nodes += batch.len();
        let steps: Vec<Step> = batch
            .into_par_iter()
            .map(|node| evaluate(p, &rules, node, known))
            .collect();
        for step in steps {
            work += step.work;
            open.extend(step.children);
            for found in step.found {
                if found.log_det > known {
                    known = found.log_det;
                    best = Some(found);
                }
            }
        }
        open.retain(|node| node.bound > known + SAME);
    }
    let proved = open.is_empty();
    let upper = open.iter().fold(known, |u, node| u.max(node.bound));
    Proof {
        best,
        upper: upper.min(p.upper.max(known)),
        nodes,
        proved,
    }
}

impl Rules {
    fn from_active(active: &Active, excludes: &(impl Fn(usize, usize) -> bool + Sync)) -> Self {
        let n = active.len();
        let conflicts: Vec<Vec<u32>> = (0..n)
            .into_par_iter()
            .map(|i| {
                (0..n)
                    .filter(|&j| i != j && excludes(i, j))
                    .map(|j| j as u32)
                    .collect()
            })
            .collect();
        let mut by_row: HashMap<Vec<u64>, Vec<u32>> = HashMap::new();
        for i in (0..n).filter(|&i| conflicts[i].is_empty()) {
            let row = active.row(i);
            let sign = row.iter().find(|v| **v != 0.0).map_or(1.0, |v| v.signum());
            let key = row.iter().map(|v| (v * sign + 0.0).to_bits()).collect();
            by_row.entry(key).or_default().push(i as u32);
        }
        let mut twins = vec![u32::MAX; n];
        for members in by_row.values().filter(|m| m.len() > 1) {
            for &i in members {
                twins[i as usize] = members[0];
            }
        }
        Self { conflicts, twins }
    }
}

fn information(p: &Problem, rows: &[u32]) -> Vec<f64> {
    let mut m = p.prior.to_vec();
    for &i in rows {
        spd::add_outer(&mut m, p.active.row(i as usize), 1.0);
    }
    m
}

/// The criterion of a complete layout.
fn layout(p: &Problem, rows: &[u32]) -> Option<RowSelection> {
    let point = p
        .active
        .criterion
        .evaluate_at(&information(p, rows), p.active.k)?;
    let mut rows: Vec<usize> = rows.iter().map(|&i| i as usize).collect();
    rows.sort_unstable();
    Some(RowSelection {
        rows,
        log_det: point.value,
    })
}

fn evaluate(p: &Problem, rules: &Rules, mut node: Node, known: f64) -> Step {
    let k = p.active.k;
    let mut step = Step {
        found: Vec::new(),
        children: Vec::new(),
        work: 0.0,
    };
    let mut known = known;
    let degree = p.active.criterion.degree(k) as f64;
    loop {
        let s = p.s - node.inside.len();
        let sub = free_rows(p, &node);
        if sub.n_groups < s {
            return step;
        }
        if s == 0 || node.free.len() == s {
            let mut all = node.inside.clone();
            if s > 0 {
                all.extend(&node.free);
            }
            if has_no_conflict(rules, &all) {
                step.found
                    .extend(layout(p, &all).filter(|c| c.log_det > known));
            }
            return step;
        }
        let prior = information(p, &node.inside);
        refill(&mut node.weights, &sub, s as f64);
        let Some(relaxed) = decide(p, &sub, s, &prior, &node.weights, known, degree, &mut step)
        else {
            return step;
        };
        node.weights.clone_from(&relaxed.weights);
        node.bound = node.bound.min(relaxed.value() + degree * relaxed.gap);
        // The rows with the largest weights form a trial layout.
        if let Some(found) = choose_heaviest_rows(p, rules, &node, s)
            && found.log_det > known + SAME
        {
            known = found.log_det;
            step.found.push(found);
        }
        if node.bound <= known + SAME {
            return step;
        }
        let before = (node.inside.len(), node.free.len());
        let marks = marks(&relaxed, &sub, s, known, degree);
        fix(rules, &mut node, &marks);
        if p.s < node.inside.len() || !has_no_conflict(rules, &node.inside) {
            return step;
        }
        // Repeat if many rows were fixed, because the relaxation of the remaining rows is tighter.
        if node.inside.len() > before.0 || node.free.len() * 8 < before.1 * 7 {
            continue;
        }
        branch(rules, node, &mut step);
        return step;
    }
}

/// Rows that are free, groups renumbered.
fn free_rows(p: &Problem, node: &Node) -> Active {
    let mut number: HashMap<u32, u32> = HashMap::new();
    let mut sub = Active {
        k: p.active.k,
        criterion: p.active.criterion.clone(),
        ..Active::default()
    };
    for &i in &node.free {
        let next = number.len() as u32;
        let g = *number.entry(p.active.group[i as usize]).or_insert(next);
        sub.group.push(g);
        sub.rows.extend_from_slice(p.active.row(i as usize));
    }
    sub.n_groups = number.len();
    sub
}

fn has_no_conflict(rules: &Rules, rows: &[u32]) -> bool {
    rows.iter().enumerate().all(|(n, &i)| {
        let c = &rules.conflicts[i as usize];
        c.is_empty() || rows[..n].iter().all(|j| c.binary_search(j).is_err())
    })
}

/// Solves the relaxation until it decides whether the node can contain a better layout; returns `None` if it can't.
fn decide(
    p: &Problem,
    sub: &Active,
    s: usize,
    prior: &[f64],
    weights: &[f64],
    known: f64,
    degree: f64,
    step: &mut Step,
) -> Option<RelaxationSolution> {
    let k = p.active.k as f64;
    let mut weights = weights.to_vec();
    let mut last = None;
    for (n, &tolerance) in LADDER.iter().enumerate() {
        let mut found = relax(sub, s, prior, weights.clone(), tolerance, SWEEPS);
        if found.is_none() && n == 0 {
            // The weights of another node may give a load no information here. Restart with equal weights of all groups.
            let share = s as f64 / sub.n_groups as f64;
            let mut members = vec![0.0; sub.n_groups];
            sub.group.iter().for_each(|&g| members[g as usize] += 1.0);
            let even = sub.group.iter().map(|&g| share / members[g as usize]);
            found = relax(sub, s, prior, even.collect(), tolerance, SWEEPS);
        }
        let relaxed = found?;
        step.work +=
            (relaxed.sweeps + 1) as f64 * k * k * (2.0 * sub.len() as f64 + 400.0 * s as f64);
        if relaxed.value() + degree * relaxed.gap <= known + SAME {
            return None;
        }
        let done = degree * relaxed.gap <= 0.2 * (relaxed.value() - known);
        weights.clone_from(&relaxed.weights);
        last = Some(relaxed);
        if done {
            break;
        }
    }
    last
}

/// Sweeps of a relaxation between two looks at its bound.
const SWEEPS: usize = 60;

/// Brings the weights to a sum of `s` with at most 1 in each group.
fn refill(weights: &mut [f64], sub: &Active, s: f64) {
    let mut by_group = vec![0.0; sub.n_groups];
    for (&g, w) in sub.group.iter().zip(weights.iter()) {
        by_group[g as usize] += w;
    }
    for (&g, w) in sub.group.iter().zip(weights.iter_mut()) {
        if by_group[g as usize] > 1.0 {
            *w /= by_group[g as usize];
        }
    }
    by_group.iter_mut().for_each(|w| *w = w.min(1.0));
    let sum: f64 = by_group.iter().sum();
    if sum > s {
        weights.iter_mut().for_each(|w| *w *= s / sum);
        return;
    }
    // Add weight first to groups that have weight, then to all groups.
    for all in [false, true] {
        let fits = |g: usize| all || by_group[g] > 0.0;
        let sum: f64 = by_group.iter().sum();
        let room: f64 = (0..sub.n_groups)
            .filter(|&g| fits(g))
            .map(|g| 1.0 - by_group[g])
            .sum();
        if s - sum <= 0.0 || room <= 0.0 {
            continue;
        }
        let share = ((s - sum) / room).min(1.0);
        let mut given = vec![false; sub.n_groups];
        let gifts: Vec<f64> = (0..sub.n_groups)
            .map(|g| {
                if fits(g) {
                    share * (1.0 - by_group[g])
                } else {
                    0.0
                }
            })
            .collect();
        for (&g, w) in sub.group.iter().zip(weights.iter_mut()) {
            let g = g as usize;
            if !given[g] && gifts[g] > 0.0 && (*w > 0.0 || by_group[g] <= 0.0) {
                *w += gifts[g];
                given[g] = true;
            }
        }
        by_group
            .iter_mut()
            .zip(&gifts)
            .for_each(|(w, gift)| *w += gift);
    }
}

/// The heaviest rows that go together.
fn choose_heaviest_rows(p: &Problem, rules: &Rules, node: &Node, s: usize) -> Option<RowSelection> {
    let mut order: Vec<usize> = (0..node.free.len()).collect();
    order.sort_by(|&a, &b| node.weights[b].total_cmp(&node.weights[a]).then(a.cmp(&b)));
    let mut rows = node.inside.clone();
    for i in order {
        if rows.len() == node.inside.len() + s {
            break;
        }
        let c = &rules.conflicts[node.free[i] as usize];
        if c.is_empty() || rows.iter().all(|j| c.binary_search(j).is_err()) {
            rows.push(node.free[i]);
        }
    }
    (rows.len() == p.s).then(|| layout(p, &rows)).flatten()
}

/// State of a free row by the bound.
#[derive(Clone, Copy, PartialEq)]
enum Mark {
    Free,
    In,
    Out,
}

fn marks(r: &RelaxationSolution, sub: &Active, s: usize, known: f64, degree: f64) -> Vec<Mark> {
    let mut largest = vec![f64::NEG_INFINITY; sub.n_groups];
    let mut members = vec![0; sub.n_groups];
    for (&g, &d) in sub.group.iter().zip(&r.d) {
        let g = g as usize;
        largest[g] = largest[g].max(d);
        members[g] += 1;
    }
    let mut sorted = largest.clone();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let top: f64 = sorted.iter().take(s).sum();
    let least = sorted.get(s - 1).copied().unwrap_or(0.0);
    let next = sorted.get(s).copied();
    // The least sum of slopes that a better layout can have.
    let needed = degree * ((known + SAME - r.value()) / degree).exp() - r.prior_trace;
    sub.group
        .iter()
        .zip(&r.d)
        .map(|(&g, &d)| {
            let g = g as usize;
            let replaced = largest[g].max(least);
            if top - replaced + d <= needed {
                return Mark::Out;
            }
            if members[g] == 1 && d >= least && next.is_none_or(|n| top - d + n <= needed) {
                return Mark::In;
            }
            Mark::Free
        })
        .collect()
}

/// Moves rows that are fixed, and takes out what conflicts with those that are in.
fn fix(rules: &Rules, node: &mut Node, marks: &[Mark]) {
    let mut gone: Vec<u32> = Vec::new();
    for (&i, m) in node.free.iter().zip(marks) {
        if *m == Mark::In {
            node.inside.push(i);
            gone.extend(&rules.conflicts[i as usize]);
        }
    }
    gone.sort_unstable();
    let keep: Vec<bool> = node
        .free
        .iter()
        .zip(marks)
        .map(|(i, m)| *m == Mark::Free && gone.binary_search(i).is_err())
        .collect();
    let mut flags = keep.iter();
    node.free.retain(|_| flags.next().copied().unwrap_or(false));
    let mut flags = keep.iter();
    node.weights
        .retain(|_| flags.next().copied().unwrap_or(false));
    node.inside.sort_unstable();
}

/// The two nodes with and without the row whose weight is least certain.
fn branch(rules: &Rules, node: Node, step: &mut Step) {
    let open = |w: f64| (w - 0.5).abs();
    let Some(mut at) = (0..node.free.len())
        .filter(|&i| node.weights[i] > WHOLE)
        .min_by(|&a, &b| {
            open(node.weights[a])
                .total_cmp(&open(node.weights[b]))
                .then(a.cmp(&b))
        })
    else {
        return;
    };
    // Of identical rows, branch on the first one. The branch without it excludes all of them.
    let class = rules.twins[node.free[at] as usize];
    if class != u32::MAX
        && let Some(first) = node
            .free
            .iter()
            .position(|&i| rules.twins[i as usize] == class)
    {
        at = first;
    }
    let row = node.free[at];
    let without = |drop: &dyn Fn(u32) -> bool| -> (Vec<u32>, Vec<f64>) {
        node.free
            .iter()
            .zip(&node.weights)
            .filter(|(i, _)| !drop(**i))
            .map(|(i, w)| (*i, *w))
            .unzip()
    };
    let c = &rules.conflicts[row as usize];
    let (free, weights) = without(&|i| i == row || c.binary_search(&i).is_ok());
    let mut inside = node.inside.clone();
    inside.push(row);
    inside.sort_unstable();
    step.children.push(Node {
        bound: node.bound,
        inside,
        free,
        weights,
    });
    let (free, weights) =
        without(&|i| i == row || class != u32::MAX && rules.twins[i as usize] == class);
    step.children.push(Node {
        bound: node.bound,
        inside: node.inside.clone(),
        free,
        weights,
    });
}

/// Number of rows up to which a proof is tried.
pub const MOST_ROWS: usize = 3000;
