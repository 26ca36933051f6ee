//! Layouts of least condition number. The condition number is the largest factor by which a relative error of the readings grows in the loads.
//!
//! `S` contains the strains of the gauges, not over their standard deviations, with each column times the expected size of its load. `M` is `S'S`.
//! The search maximises `-ln cond S + 0.05 ln(det M) / (2 k)`. Of layouts with nearly equal condition numbers it takes the one with more strain. It
//! trades 1 % of condition number for a fifth of the standard deviations of the loads.
//!
//! The search exchanges single rows. In each slot it ranks all rows by `tr(M) tr(M^-1)`, the condition number in the Frobenius norm, which is updated
//! in closed form. It tests the best rows by eigenvalues.

use super::candidates::{Angles, Candidates, Choice};
use super::coordinate_exchange::LEAST_GAIN;
use super::layout::Layout;
use super::perturbation::{fits, move_gauges};
use super::shortlist::excluder;
use super::spec::Spec;
use crate::linalg::spd;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// A layout with a small condition number.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionedLayout {
    /// The gauges, by place and angle.
    pub gauges: Vec<Choice>,
    /// Condition number of `S` of the layout, including the gauges that stay.
    pub condition: f64,
    /// Least condition number of all tried layouts.
    pub least: f64,
}

/// Weight of the information relative to the condition number.
const INFORMATION: f64 = 0.05;
/// Rows that take part at most, with few loads and with many.
const MOST: [usize; 2] = [12_000, 1_500];
/// Loads from which there are many.
const MANY: usize = 12;
/// Number of rows of a slot tested by eigenvalues, with few loads and with many.
const TESTED_ROWS: [usize; 2] = [24, 6];
/// Share of the mean diagonal that is added to keep a layout without one gauge regular.
const RIDGE: f64 = 1e-10;

/// Returns the layout with the least condition number found, starting from `layout` and from random layouts. `base` is the `S'S` of gauges that stay,
/// with the columns of the candidates. `None` if no tried layout separates the loads.
pub fn find_least_condition(
    c: &Candidates,
    spec: &Spec,
    layout: &Layout,
    base: &[f64],
) -> Option<ConditionedLayout> {
    let k = c.n_loads();
    let many = usize::from(k > MANY);
    let choices = taking_part(c, &layout.gauges, MOST[many]);
    let rows: Vec<f64> = choices
        .iter()
        .flat_map(|&p| {
            let sd = c.sd(p);
            c.row(p).into_iter().map(move |v| v * sd)
        })
        .collect();
    let excludes = excluder(c, spec, &choices);
    let search = Search {
        k,
        rows: &rows,
        base,
        tested: TESTED_ROWS[many],
        excludes: &excludes,
    };
    let known: Vec<usize> = (0..layout.gauges.len()).collect();
    let [starts, perturbations] = if many == 1 { [2, 2] } else { [6, 6] };
    let found: Vec<Option<ConditionedRows>> = (0..starts)
        .into_par_iter()
        .map(|n| {
            let seed = spec.effort.seed.wrapping_mul(7919).wrapping_add(n);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let first = if n == 0 {
                known.clone()
            } else {
                search.perturb_rows(&known, known.len(), &mut rng)
            };
            let mut best = search.improve(first);
            for _ in 0..perturbations {
                if spec.stop.is_asked() {
                    break;
                }
                let from = best.as_ref().map_or(&known, |b| &b.rows).clone();
                let count = 1 + rng.random_range(0..3.min(from.len()));
                best = choose_better(
                    best,
                    search.improve(search.perturb_rows(&from, count, &mut rng)),
                );
            }
            best
        })
        .collect();
    let best = found.into_iter().fold(None, choose_better)?;
    let mut gauges: Vec<Choice> = best.rows.iter().map(|&i| choices[i]).collect();
    gauges.sort_by(|a, b| a.place.cmp(&b.place).then(a.angle.total_cmp(&b.angle)));
    Some(ConditionedLayout {
        gauges,
        condition: best.condition,
        least: best.least,
    })
}

/// The gauges of the layout, then candidates evenly spread over all.
fn taking_part(c: &Candidates, layout: &[Choice], most: usize) -> Vec<Choice> {
    let angles: Vec<f64> = match c.angles() {
        Angles::Fixed => vec![0.0],
        Angles::Grid(a) => a.clone(),
        Angles::Continuous => (0..12)
            .map(|i| f64::from(i) * std::f64::consts::PI / 12.0)
            .collect(),
    };
    let all = c.n_places() * angles.len();
    // A stride without a common factor with the number of angles covers all angles.
    let mut stride = all.div_ceil(most.max(1)).max(1);
    while stride > 1 && greatest_common_divisor(stride, angles.len()) > 1 {
        stride += 1;
    }
    let mut out = layout.to_vec();
    for n in (0..all).step_by(stride) {
        let choice = Choice {
            place: (n / angles.len()) as u32,
            step: if *c.angles() == Angles::Continuous {
                0
            } else {
                (n % angles.len()) as u16
            },
            angle: angles[n % angles.len()],
        };
        if !layout.contains(&choice) {
            out.push(choice);
        }
    }
    out
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

struct ConditionedRows {
    rows: Vec<usize>,
    value: f64,
    condition: f64,
    least: f64,
}

fn choose_better(
    a: Option<ConditionedRows>,
    b: Option<ConditionedRows>,
) -> Option<ConditionedRows> {
    match (a, b) {
        (Some(a), Some(b)) => {
            let least = a.least.min(b.least);
            let best = if b.value > a.value { b } else { a };
            Some(ConditionedRows { least, ..best })
        }
        (a, b) => a.or(b),
    }
}

struct Search<'a, E> {
    k: usize,
    rows: &'a [f64],
    base: &'a [f64],
    tested: usize,
    excludes: &'a E,
}

impl<E: Fn(usize, usize) -> bool> Search<'_, E> {
    fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.k..(i + 1) * self.k]
    }

    fn len(&self) -> usize {
        self.rows.len() / self.k
    }

    fn information(&self, rows: &[usize]) -> Vec<f64> {
        let mut m = self.base.to_vec();
        rows.iter()
            .for_each(|&i| spd::add_outer(&mut m, self.row(i), 1.0));
        m
    }

    /// Returns the objective and the condition number; `None` if `m` is singular.
    fn value(&self, m: &[f64]) -> Option<(f64, f64)> {
        let l = spd::cholesky(m, self.k)?;
        let e = spd::eigenvalues(m, self.k);
        let (low, high) = (e.first()?, e.last()?);
        let condition = (high / low).sqrt();
        let value = -condition.ln() + INFORMATION * spd::log_det(&l, self.k) / (2 * self.k) as f64;
        (value.is_finite()).then_some((value, condition))
    }

    fn perturb_rows(&self, from: &[usize], count: usize, rng: &mut ChaCha8Rng) -> Vec<usize> {
        move_gauges(from, count, self.len(), self.excludes, rng)
    }

    fn fits(&self, rows: &[usize], slot: usize, i: usize) -> bool {
        fits(rows, slot, i, self.excludes)
    }

    fn improve(&self, mut rows: Vec<usize>) -> Option<ConditionedRows> {
        let mut now = self
            .value(&self.information(&rows))
            .unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let mut least = now.1;
        for _ in 0..50 {
            let before = now.0;
            for slot in 0..rows.len() {
                let rest: Vec<usize> = rows
                    .iter()
                    .enumerate()
                    .filter(|(q, _)| *q != slot)
                    .map(|(_, &r)| r)
                    .collect();
                let m = self.information(&rest);
                for i in self.rank_rows(&m, &rows, slot) {
                    let mut with = m.clone();
                    spd::add_outer(&mut with, self.row(i), 1.0);
                    if let Some(v) = self.value(&with) {
                        least = least.min(v.1);
                        if v.0 > now.0 + LEAST_GAIN {
                            (now, rows[slot]) = (v, i);
                        }
                    }
                }
            }
            if !(now.0 - before > LEAST_GAIN) {
                break;
            }
        }
        now.0.is_finite().then_some(ConditionedRows {
            rows,
            value: now.0,
            condition: now.1,
            least,
        })
    }

    /// Returns the compatible rows that give the least `tr(M) tr(M^-1)` together with the matrix `m` of the other gauges.
    fn rank_rows(&self, m: &[f64], rows: &[usize], slot: usize) -> Vec<usize> {
        let k = self.k;
        let trace: f64 = (0..k).map(|p| m[p * k + p]).sum();
        let mut m = m.to_vec();
        // With as many gauges as loads, the matrix without one gauge is singular. The ridge is relative to the trace, because rows of weak loads are
        // small compared with a load that all gauges measure.
        let ridge = RIDGE * trace.max(f64::MIN_POSITIVE) / k as f64;
        (0..k).for_each(|p| m[p * k + p] += ridge);
        let Some(l) = spd::cholesky(&m, k) else {
            return Vec::new();
        };
        let inverse = spd::gram_of_lower(&spd::inverse_lower(&l, k), k);
        let spread: f64 = (0..k).map(|p| inverse[p * k + p]).sum();
        let mut u = vec![0.0; k];
        let mut keyed: Vec<(f64, usize)> = (0..self.len())
            .map(|i| {
                let a = self.row(i);
                spd::times(&inverse, a, &mut u);
                let left = spread - spd::dot(&u, &u) / (1.0 + spd::dot(a, &u));
                ((trace + spd::dot(a, a)) * left, i)
            })
            .collect();
        let by = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        let sure = (8 * self.tested).min(keyed.len());
        if sure > 0 && sure < keyed.len() {
            keyed.select_nth_unstable_by(sure - 1, by);
            keyed.truncate(sure);
        }
        keyed.sort_by(by);
        keyed
            .into_iter()
            .map(|x| x.1)
            .filter(|&i| self.fits(rows, slot, i))
            .take(self.tested)
            .collect()
    }
}
