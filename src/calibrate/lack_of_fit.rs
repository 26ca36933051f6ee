//! Lack of fit: whether the strain of the calibration runs has a common zero, or squares and products of the loads, in addition to `S f`.
//!
//! The test is weighted least squares, gauge by gauge, over the loadings (means of repeats, which share what S lacks). The term that explains most is
//! added to the model of all gauges while it is significant. The effect of the terms on the loads enters the intervals.

use super::common_zero::{less_zero, zero_of};
use super::loading::{Loading, loadings};
use super::state::{State, sensitivity_of};
use super::terms_held_out::held_out;
use super::types::{HeldOutError, LackOfFit, Task, Term, TermTest};
use super::unknown_directions::project_out;
use crate::estimate::f_tail;
use crate::finding::{Finding, Severity};
use crate::linalg::spd;
use crate::recovery::{ErrorModel, Readings, estimate};
use crate::units::number;
use std::collections::BTreeMap;

/// Limits of the tests.
#[derive(Clone, Copy, Debug)]
struct FitRules {
    /// Chance below which a term is significant, over all gauges and terms of a kind. Three kinds are tested, and one calibration in 300 without any
    /// such term may report one.
    significant: f64,
    /// Least share of a term's square that the loads themselves do not make. A term with less is a combination of the loads.
    apart: f64,
    /// Terms found at most: a structure that needs more is not described by second order.
    most: usize,
    /// Least number of loadings beyond the coefficients of a gauge that a test needs. Student's t with one degree of freedom decides nothing.
    fewest: usize,
}

const RULES: FitRules = FitRules {
    significant: 1e-3,
    apart: 1e-6,
    most: 6,
    fewest: 3,
};

/// A term by the loads that it is a product of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate {
    term: Term,
    loads: [usize; 2],
}

impl Candidate {
    fn value(&self, phi: &[f64]) -> f64 {
        match self.term {
            Term::CommonZero => 1.0,
            Term::Squares | Term::Products => phi[self.loads[0]] * phi[self.loads[1]],
        }
    }
}

/// Significant terms, with their effects.
pub(super) struct LackOfFitTest {
    pub answer: LackOfFit,
    pub findings: Vec<Finding>,
    /// Covariance of readings that the significant terms cause over the loadings, `n x n` by rows. It is empty without significant terms.
    pub covariance: Vec<f64>,
}

/// Tests whether a fit lacks terms, and returns the significant terms with their covariance.
pub(super) fn check(task: &Task, state: &State) -> LackOfFitTest {
    let loadings = loadings(task, state);
    let candidates = candidates(task);
    let tests = |added: &[Candidate]| -> Vec<CandidateTest> {
        let left = candidates.iter().filter(|c| !added.contains(c));
        let left: Vec<Candidate> = left.copied().collect();
        test(&loadings, added, &left)
    };
    let first = tests(&[]);
    let mut answer = LackOfFit {
        tests: first
            .iter()
            .map(|t| TermTest {
                term: t.candidate.term,
                p: t.p,
            })
            .collect(),
        held_out: held_out(task, &loadings),
    };
    answer.tests.sort_by_key(|t| t.term);
    let (mut added, mut found) = (Vec::new(), Vec::new());
    let mut open = first;
    while let Some(best) = open.into_iter().min_by(|a, b| a.p.total_cmp(&b.p)) {
        if !(best.p < RULES.significant) || added.len() == RULES.most {
            break;
        }
        added.push(best.candidate);
        found.push(best);
        open = tests(&added);
    }
    let mut out = LackOfFitTest {
        answer,
        findings: Vec::new(),
        covariance: Vec::new(),
    };
    if added.is_empty() {
        return out;
    }
    let changes = changes(&loadings, &added);
    out.covariance = covariance(&loadings, &changes, &added);
    for of_zero in [true, false] {
        let kind: Vec<&CandidateTest> = (found.iter())
            .filter(|t| (t.candidate.term == Term::CommonZero) == of_zero)
            .collect();
        out.findings.extend(finding(
            task,
            state,
            &loadings,
            (&added, &kind),
            out.answer.held_out,
        ));
    }
    out
}

/// Terms that may be missing.
fn candidates(task: &Task) -> Vec<Candidate> {
    let k = task.own_loads();
    let zero = (!task.is_extended()).then_some(Candidate {
        term: Term::CommonZero,
        loads: [0, 0],
    });
    let pairs = (0..k).flat_map(|l| (l..k).map(move |m| [l, m]));
    let second = pairs.map(|loads| Candidate {
        term: match loads[0] == loads[1] {
            true => Term::Squares,
            false => Term::Products,
        },
        loads,
    });
    zero.into_iter().chain(second).collect()
}

/// The clearest term of a kind.
struct CandidateTest {
    candidate: Candidate,
    /// Gauge at which it is clearest.
    gauge: usize,
    /// Chance of a term so large, times gauges and terms of its kind (Bonferroni), at most 1.
    p: f64,
}

/// Returns the clearest term of each kind that is not in `added`: `F = (RSS - RSS') / (RSS' / (m - p - 1))` for `m` loadings and `p` coefficients.
///
/// # Reference
/// N. R. Draper, H. Smith, Applied Regression Analysis (3rd ed., 1998), section 6.1: the extra sum of squares.
fn test(loadings: &[Loading], added: &[Candidate], candidates: &[Candidate]) -> Vec<CandidateTest> {
    let n = loadings.first().map_or(0, |l| l.strain.len());
    let mut best: BTreeMap<Term, (CandidateTest, usize)> = BTreeMap::new();
    for gauge in 0..n {
        let read: Vec<&Loading> = loadings
            .iter()
            .filter(|l| l.strain[gauge].is_finite())
            .collect();
        let root: Vec<f64> = read.iter().map(|l| l.weight[gauge].sqrt()).collect();
        let weighted = |of: &dyn Fn(&Loading) -> f64| -> Vec<f64> {
            read.iter().zip(&root).map(|(l, w)| w * of(l)).collect()
        };
        let basis = basis(&read, &root, added);
        let Some(free) = read.len().checked_sub(basis.len() + RULES.fewest) else {
            continue;
        };
        let free = (free + RULES.fewest - 1) as f64;
        let mut rest = weighted(&|l| l.strain[gauge]);
        project_out(&mut rest, &basis);
        let all = spd::dot(&rest, &rest);
        for candidate in candidates {
            let mut column = weighted(&|l| candidate.value(&l.phi));
            let own = spd::dot(&column, &column);
            project_out(&mut column, &basis);
            let apart = spd::dot(&column, &column);
            if !(apart > RULES.apart * own) {
                continue;
            }
            let explained = spd::dot(&column, &rest).powi(2) / apart;
            let ratio = explained / ((all - explained).max(0.0) / free);
            let tested = CandidateTest {
                candidate: *candidate,
                gauge,
                p: f_tail(ratio, 1.0, free),
            };
            match best.get_mut(&candidate.term) {
                Some((kept, count)) => {
                    *count += 1;
                    if tested.p < kept.p {
                        *kept = tested;
                    }
                }
                None => {
                    best.insert(candidate.term, (tested, 1));
                }
            }
        }
    }
    let corrected = |(tested, count): (CandidateTest, usize)| CandidateTest {
        p: (tested.p * count as f64).min(1.0),
        ..tested
    };
    best.into_values().map(corrected).collect()
}

/// Orthonormal basis of the weighted columns of the loads and of the terms `added`.
fn basis(read: &[&Loading], root: &[f64], added: &[Candidate]) -> Vec<Vec<f64>> {
    let k = read.first().map_or(0, |l| l.phi.len());
    let column = |c: usize| -> Vec<f64> {
        let value = |l: &Loading| match c.checked_sub(k) {
            None => l.phi[c],
            Some(a) => added[a].value(&l.phi),
        };
        read.iter().zip(root).map(|(l, w)| w * value(l)).collect()
    };
    let mut out: Vec<Vec<f64>> = Vec::new();
    for mut x in (0..k + added.len()).map(column) {
        let own = spd::dot(&x, &x);
        project_out(&mut x, &out);
        // The second projection removes the rounding error of the first.
        project_out(&mut x, &out);
        let size = spd::dot(&x, &x);
        if size > RULES.apart * RULES.apart * own && size > 0.0 {
            out.push(x.iter().map(|v| v / size.sqrt()).collect());
        }
    }
    out
}

/// Strain by loading and gauge that the fit with the terms `added` makes more than that without.
fn changes(loadings: &[Loading], added: &[Candidate]) -> Vec<Vec<f64>> {
    let n = loadings.first().map_or(0, |l| l.strain.len());
    let mut out = vec![vec![0.0; n]; loadings.len()];
    for gauge in 0..n {
        let at: Vec<usize> = (0..loadings.len())
            .filter(|i| loadings[*i].strain[gauge].is_finite())
            .collect();
        let read: Vec<&Loading> = at.iter().map(|i| &loadings[*i]).collect();
        let root: Vec<f64> = read.iter().map(|l| l.weight[gauge].sqrt()).collect();
        let y: Vec<f64> = read
            .iter()
            .zip(&root)
            .map(|(l, w)| w * l.strain[gauge])
            .collect();
        let fitted = |basis: &[Vec<f64>]| -> Vec<f64> {
            let mut rest = y.clone();
            project_out(&mut rest, basis);
            y.iter().zip(rest).map(|(y, r)| y - r).collect()
        };
        let without = fitted(&basis(&read, &root, &[]));
        let with = fitted(&basis(&read, &root, added));
        for (place, i) in at.iter().enumerate() {
            out[*i][gauge] = (with[place] - without[place]) / root[place];
        }
    }
    out
}

/// Returns the mean over the loadings of the squared changes, or the effect of a common zero on a small load if it is larger.
fn covariance(loadings: &[Loading], changes: &[Vec<f64>], added: &[Candidate]) -> Vec<f64> {
    let n = changes.first().map_or(0, Vec::len);
    let mut out = vec![0.0; n * n];
    for change in changes {
        spd::add_outer(&mut out, change, 1.0 / changes.len() as f64);
    }
    if added.iter().any(|c| c.term == Term::CommonZero) {
        let zero = zero_by_gauge(loadings, added);
        let mut of_zero = vec![0.0; n * n];
        spd::add_outer(&mut of_zero, &zero, 1.0);
        let trace = |c: &[f64]| (0..n).map(|g| c[g * n + g]).sum::<f64>();
        if trace(&of_zero) > trace(&out) {
            return of_zero;
        }
    }
    out
}

/// Strain without load in the fit with the terms `added`.
fn zero_by_gauge(loadings: &[Loading], added: &[Candidate]) -> Vec<f64> {
    let n = loadings.first().map_or(0, |l| l.strain.len());
    let others: Vec<Candidate> = (added.iter())
        .filter(|c| c.term != Term::CommonZero)
        .copied()
        .collect();
    let of = |gauge: usize| {
        let read: Vec<&Loading> = loadings
            .iter()
            .filter(|l| l.strain[gauge].is_finite())
            .collect();
        let root: Vec<f64> = read.iter().map(|l| l.weight[gauge].sqrt()).collect();
        let basis = basis(&read, &root, &others);
        let mut one = root.clone();
        project_out(&mut one, &basis);
        let y: Vec<f64> = read
            .iter()
            .zip(&root)
            .map(|(l, w)| w * l.strain[gauge])
            .collect();
        let (own, apart) = (spd::dot(&root, &root), spd::dot(&one, &one));
        match apart > RULES.apart * own {
            true => spd::dot(&one, &y) / apart,
            false => 0.0,
        }
    };
    (0..n)
        .map(of)
        .map(|z| if z.is_finite() { z } else { 0.0 })
        .collect()
}

/// Returns the finding on the terms of a kind, with their effect on the loads.
fn finding(
    task: &Task,
    state: &State,
    loadings: &[Loading],
    (added, kind): (&[Candidate], &[&CandidateTest]),
    held_out: Option<HeldOutError>,
) -> Option<Finding> {
    let clearest = kind.first()?;
    let rest: Vec<Candidate> = (added.iter())
        .filter(|a| kind.iter().all(|t| t.candidate != **a))
        .copied()
        .collect();
    let own: Vec<Candidate> = kind.iter().map(|t| t.candidate).collect();
    // Change that these terms make in addition to the other terms.
    let with = changes(loadings, added);
    let without = match rest.is_empty() {
        true => vec![vec![0.0; task.gauges.len()]; loadings.len()],
        false => changes(loadings, &rest),
    };
    let differences: Vec<Vec<f64>> = with
        .iter()
        .zip(&without)
        .map(|(a, b)| less_zero(a, b))
        .collect();
    let (load, share) = largest_effect(task, state, loadings, &differences)?;
    let load = &task.loads[load].name;
    let gauge = &task.gauges[clearest.gauge];
    let p = format!("chance {:.1e}", clearest.p);
    let percent = number(100.0 * share);
    let (code, message, remedy) = match clearest.candidate.term {
        Term::CommonZero => {
            let zero = zero_by_gauge(loadings, &own)[clearest.gauge];
            (
                "common-zero",
                format!(
                    "without load the gauges do not read zero: gauge `{gauge}` reads {} microstrain ({p}). In the calibration runs this moves load `{load}` by up to \
                     {percent} % of its range. Intervals include it",
                    number(1e6 * zero)
                ),
                match held_out {
                    Some(h) => format!(
                        "take the zero of the calibration runs again, or write [calibration] terms = \"intercept\": the error of left-out runs is {} % of the range \
                         with it, {} % without",
                        number(100.0 * h.intercept),
                        number(100.0 * h.linear)
                    ),
                    None => "take the zero of the calibration runs again, or write [calibration] terms = \"intercept\"".to_owned(),
                },
            )
        }
        Term::Squares | Term::Products => {
            let names: Vec<String> = own
                .iter()
                .map(|c| {
                    let [a, b] = c.loads.map(|l| task.loads[l].name.as_str());
                    if a == b {
                        format!("{a}^2")
                    } else {
                        format!("{a} {b}")
                    }
                })
                .collect();
            (
                "lack-of-fit",
                format!(
                    "the strain is not proportional to the loads: it has terms of {}, clearest at gauge `{gauge}` ({p}). In the calibration runs this moves load \
                     `{load}` by up to {percent} % of its range. Intervals include it",
                    names.join(", ")
                ),
                "calibrate only over the range of loads that you use, or look for contact, slip or a channel that is not linear".to_owned(),
            )
        }
    };
    Some(
        Finding::new(Severity::Warning, code, load, message, remedy)
            .with_numbers(clearest.p, RULES.significant),
    )
}

/// The load that changes of the strain move most, over its largest value in the runs, as recovered loads are estimated.
fn largest_effect(
    task: &Task,
    state: &State,
    loadings: &[Loading],
    changes: &[Vec<f64>],
) -> Option<(usize, f64)> {
    let of = (&state.scales[..], &state.posterior, &state.scatter);
    let s = sensitivity_of(task, of, 1.0, &[]);
    let errors = ErrorModel {
        noise: task.noise,
        model_rel: 0.0,
    };
    let k = s.loads.len();
    let zero = zero_of(task, &state.posterior);
    let mut largest = vec![0.0_f64; k];
    let mut moved = vec![0.0_f64; k];
    for (loading, change) in loadings.iter().zip(changes) {
        let strain = less_zero(&state.posterior.predict(&loading.phi), &zero);
        let readings = Readings {
            run: String::new(),
            strain: strain.iter().zip(change).map(|(a, b)| a + b).collect(),
            noise_factor: 1.0,
        };
        let found = estimate(&s, &readings, errors).estimate;
        for l in 0..k {
            let known = loading.phi[l] * state.scales[l];
            largest[l] = largest[l].max(known.abs());
            moved[l] = moved[l].max((found.values[l] - known).abs());
        }
    }
    let share = |l: usize| moved[l] / largest[l];
    (0..k)
        .filter(|l| task.loads[*l].wanted && share(*l).is_finite())
        .map(|l| (l, share(l)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
}
