//! The layout: relaxation, rounding, exchange and the certificate, in one call.

use super::branch_and_bound::{self, Problem, Proof};
use super::candidates::{Angles, Candidates, Choice};
use super::column_generation::{self, Columns, Groups};
use super::exchange::Effort;
use super::robust;
use super::shortlist::{
    LIST, ScoredLayout, better_of, elimination, excluder, largest_variance_rows, list_of, polish,
    rows_of, run, value_of,
};
use super::spacing;
use super::spec::{Loss, Spec};
use super::variance_scan::{CandidateVariance, Report, price};
use std::collections::HashMap;
use std::fmt;

/// A layout with its certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The gauges, by place and angle.
    pub gauges: Vec<Choice>,
    /// Value of the criterion. For D it is `log det` of the information matrix, for Ds this value less `log det` of the nuisance block.
    pub log_det: f64,
    /// Upper bound of the criterion of all permitted layouts.
    pub upper_bound: f64,
    /// Lower bound on the efficiency, relative to the best layout: `exp((log_det - upper_bound) / degree)`.
    pub efficiency_bound: f64,
    /// Whether no permitted layout is better.
    pub proved: bool,
    /// Passes over all candidates.
    pub passes: usize,
    /// Number of candidates that the bound does not exclude from a better layout. `None` if there are too many to count.
    pub alive: Option<usize>,
    /// Number of nodes of the proof. It is 0 if no proof was tried.
    pub nodes: usize,
}

/// Reason why there is no layout.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaceError {
    /// Fewer places than gauges.
    TooFewPlaces {
        /// Requested number of gauges.
        gauges: usize,
        /// Number of places among the candidates.
        places: usize,
    },
    /// No layout separates the loads.
    Singular {
        /// Requested number of gauges.
        gauges: usize,
        /// Columns.
        loads: usize,
    },
    /// The spacing leaves too few places.
    TooTight {
        /// Requested number of gauges.
        gauges: usize,
        /// Requested least distance.
        spacing: f64,
    },
}

impl PlaceError {
    /// Returns the message and the remedy.
    pub fn parts(&self) -> (String, String) {
        match self {
            Self::TooFewPlaces { gauges, places } => (
                format!("{gauges} gauges are asked for and the candidates contain {places} places"),
                "ask for fewer, or widen [candidates]".to_owned(),
            ),
            Self::Singular { gauges, loads } => (
                format!("no {gauges} gauges among these candidates separate the {loads} loads"),
                format!(
                    "ask for at least {loads} gauges, drop loads with the same effect, or state `expected` for loads with role \"nuisance\""
                ),
            ),
            Self::TooTight { gauges, spacing } => (
                format!(
                    "{gauges} gauges with a spacing of at least {spacing} do not fit on the candidates"
                ),
                "reduce the spacing or the number".to_owned(),
            ),
        }
    }
}

impl fmt::Display for PlaceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (wrong, remedy) = self.parts();
        write!(f, "{wrong}: {remedy}")
    }
}

impl std::error::Error for PlaceError {}

/// Returns the best layout found for `spec`, with an upper bound for all layouts.
///
/// # Errors
/// Returns an error if there are too few places, or if that many gauges can't separate the loads.
///
/// # Example
/// Three gauges for two loads, among five whose determinants are easily compared by hand:
/// ```
/// use strainbridge::placement::candidates::{Candidates, Scatter};
/// use strainbridge::placement::{Spec, place};
///
/// let rows = [[1.0, 0.0], [0.0, 1.0], [3.0, 0.0], [0.0, 2.0], [2.0, 2.0]];
/// let fill = |place: usize, row: &mut [f64]| row.copy_from_slice(&rows[place]);
/// let candidates = Candidates::from_rows(2, rows.len(), Scatter::with_uniform_noise(1.0), fill);
/// let layout = place(&candidates, &Spec::new(3, 2))?;
/// let mut chosen: Vec<u32> = layout.gauges.iter().map(|g| g.place).collect();
/// chosen.sort_unstable();
/// // S'S = [[13, 4], [4, 8]], det = 88, is the largest of ten layouts.
/// assert_eq!(chosen, [2, 3, 4]);
/// assert!((layout.log_det - 88.0_f64.ln()).abs() < 1e-9);
/// assert!(layout.log_det <= layout.upper_bound + 1e-9 && layout.proved);
/// # Ok::<(), strainbridge::placement::PlaceError>(())
/// ```
pub fn place(c: &Candidates, spec: &Spec) -> Result<Layout, PlaceError> {
    // Number of wanted loads.
    let k = spec.criterion.degree(c.n_loads());
    let spaced = spec.spacing > 0.0 && !c.positions().is_empty();
    let mut bound = LayoutBound::from_candidates(c, spec, spaced)?;
    let quick = Effort {
        starts: if spaced { 4 } else { 2 },
        perturbations: 0,
        ..spec.effort
    };
    let list = list_of(c, &bound.col, &bound.groups, 0.0);
    let mut best = run(c, spec, &list, &bound.col, quick, None);
    if spaced {
        best = tighten(c, spec, &mut bound, quick, best);
    }
    let incumbent = best.ok_or_else(|| {
        // Too few gauges for the loads are not an error of the spacing, so try without spacing.
        let anywhere = Spec {
            spacing: 0.0,
            ..spec.clone()
        };
        match spaced && run(c, &anywhere, &list, &bound.col, quick, None).is_some() {
            true => PlaceError::TooTight {
                gauges: spec.gauges,
                spacing: spec.spacing,
            },
            false => singular_error(c, spec),
        }
    })?;
    // A candidate that can't be in a better layout may be in a layout with a smaller loss.
    let floor = match spec.loss {
        Loss::Judged => elimination(&bound.col, k, incumbent.1),
        Loss::Optimised => 0.0,
    };
    let list = list_of(c, &bound.col, &bound.groups, floor);
    let found = exchange(c, spec, &mut bound, &list, incumbent);
    let robust = match spec.loss {
        Loss::Optimised => robust_of(c, spec, &list, &found.0),
        Loss::Judged => None,
    };
    let end = match robust {
        Some(found) => End::without_proof(found),
        None => certify(c, spec, &mut bound, found),
    };
    let (mut gauges, log_det) = end.found;
    gauges.sort_by(|a, b| a.place.cmp(&b.place).then(a.angle.total_cmp(&b.angle)));
    // The layout is a lower bound of the optimum. It can exceed the certificate only by rounding.
    let upper_bound = if end.proved {
        log_det
    } else {
        bound.upper.max(log_det)
    };
    let efficiency_bound = ((log_det - upper_bound) / k as f64).exp();
    Ok(Layout {
        gauges,
        log_det,
        upper_bound,
        efficiency_bound,
        proved: end.proved,
        passes: bound.passes,
        alive: end.alive,
        nodes: end.nodes,
    })
}

fn singular_error(c: &Candidates, spec: &Spec) -> PlaceError {
    PlaceError::Singular {
        gauges: spec.gauges,
        loads: c.n_loads(),
    }
}

/// The relaxation: what no layout can pass.
struct LayoutBound {
    /// Candidates of which a layout has one at most.
    groups: Groups,
    /// The relaxation as solved last.
    col: Columns,
    /// The least bound so far.
    upper: f64,
    /// Passes over all candidates so far.
    passes: usize,
}

impl LayoutBound {
    fn from_candidates(c: &Candidates, spec: &Spec, spaced: bool) -> Result<Self, PlaceError> {
        let groups = if spaced || *c.angles() == Angles::Continuous {
            Groups::Places
        } else {
            Groups::Rows
        };
        let places = if groups == Groups::Rows {
            c.n_rows()
        } else {
            c.n_places()
        };
        let gauges = spec.gauges;
        if places < gauges || gauges == 0 {
            return Err(PlaceError::TooFewPlaces { gauges, places });
        }
        let col = solve_relaxed(c, spec, &groups, &[]).ok_or_else(|| singular_error(c, spec))?;
        Ok(Self {
            groups,
            upper: col.upper_bound,
            passes: col.passes,
            col,
        })
    }
}

fn solve_relaxed(c: &Candidates, spec: &Spec, groups: &Groups, warm: &[Choice]) -> Option<Columns> {
    column_generation::solve(
        c,
        spec.gauges,
        &spec.prior,
        &spec.criterion,
        groups,
        spec.tolerance,
        warm,
        &spec.stop,
    )
}

/// Lowers the bound with sets of places within a spacing of each other, and returns the best layout found. A layout has at most one gauge in each
/// set. The sets are built from the candidate variances.
fn tighten(
    c: &Candidates,
    spec: &Spec,
    bound: &mut LayoutBound,
    quick: Effort,
    mut best: Option<ScoredLayout>,
) -> Option<ScoredLayout> {
    let k = spec.criterion.degree(c.n_loads());
    for _ in 0..CLIQUE_ROUNDS {
        if spec.stop.is_asked() {
            break;
        }
        let floor = best
            .as_ref()
            .map_or(0.0, |b| elimination(&bound.col, k, b.1));
        let priced = price(
            c,
            &bound.col.relaxed.point.root,
            floor,
            Report::BestOfPlace,
            usize::MAX,
        );
        let of = spacing::cliques(c.n_places(), &priced, c.positions(), spec.spacing);
        bound.groups = Groups::Cliques(of);
        let Some(next) = solve_relaxed(c, spec, &bound.groups, &bound.col.choices) else {
            break;
        };
        bound.passes += next.passes;
        let gained = bound.upper - next.upper_bound;
        bound.upper = bound.upper.min(next.upper_bound);
        bound.col = next;
        let list = list_of(c, &bound.col, &bound.groups, 0.0);
        let found = run(c, spec, &list, &bound.col, quick, best.as_ref());
        best = better_of(best, found);
        if gained < spec.tolerance * k as f64 {
            break;
        }
    }
    best
}

/// Returns the best layout by exchange, first within the list, then with the rows whose variance in the layout is largest. Continuous angles are
/// refined at the end.
fn exchange(
    c: &Candidates,
    spec: &Spec,
    bound: &mut LayoutBound,
    list: &[CandidateVariance],
    incumbent: ScoredLayout,
) -> ScoredLayout {
    let found = run(c, spec, list, &bound.col, spec.effort, Some(&incumbent));
    let mut best = better_of(Some(incumbent.clone()), found).unwrap_or(incumbent);
    // A truncated list may lack rows that would improve this layout.
    let rounds = if list.len() < LIST { 0 } else { ROUNDS };
    for _ in 0..rounds {
        if spec.stop.is_asked() {
            break;
        }
        let near = largest_variance_rows(c, spec, &best.0);
        let effort = Effort {
            starts: 1,
            perturbations: spec.effort.perturbations / 4,
            ..spec.effort
        };
        bound.passes += 1;
        match run(c, spec, &near, &bound.col, effort, Some(&best)) {
            Some(next) if next.1 > best.1 + branch_and_bound::SAME => best = next,
            _ => break,
        }
    }
    if *c.angles() == Angles::Continuous {
        best = polish(c, spec, best.0, best.1);
    }
    best
}

/// Final layout with its proof and the number of candidates that could still be in a better layout.
struct End {
    found: ScoredLayout,
    proved: bool,
    alive: Option<usize>,
    nodes: usize,
}

impl End {
    fn without_proof(found: ScoredLayout) -> Self {
        Self {
            found,
            proved: false,
            alive: None,
            nodes: 0,
        }
    }
}

/// Compares the layout with the bound. If the bound is higher and a proof is requested, it also runs the proof.
fn certify(c: &Candidates, spec: &Spec, bound: &mut LayoutBound, found: ScoredLayout) -> End {
    let mut end = End::without_proof(found);
    end.proved = end.found.1 >= bound.upper - branch_and_bound::SAME;
    if end.proved || !(spec.proof > 0.0) || *c.angles() == Angles::Continuous {
        return end;
    }
    let (alive, tried) = prove(c, spec, &bound.col, &bound.groups, end.found.1, bound.upper);
    end.alive = alive;
    if let Some((proof, choices)) = tried {
        (end.proved, end.nodes) = (proof.proved, proof.nodes);
        bound.upper = bound.upper.min(proof.upper);
        if let Some(best) = proof.best {
            let gauges = best.rows.iter().map(|&i| choices[i]).collect();
            end.found = (gauges, best.log_det);
        }
    }
    end
}

/// Returns the layout near `gauges` that keeps the most information after the worst loss; `None` if no better layout is found.
fn robust_of(
    c: &Candidates,
    spec: &Spec,
    list: &[CandidateVariance],
    gauges: &[Choice],
) -> Option<ScoredLayout> {
    let mut choices: Vec<Choice> = gauges.to_vec();
    choices.extend(
        list.iter()
            .map(|p| p.choice)
            .filter(|p| !gauges.iter().any(|g| g == p)),
    );
    let active = rows_of(c, spec, &choices);
    let start: Vec<usize> = (0..gauges.len()).collect();
    let excludes = excluder(c, spec, &choices);
    let found = robust::search(
        &active,
        &spec.prior,
        &start,
        &excludes,
        spec.effort,
        &spec.stop,
    )?;
    let gauges: Vec<Choice> = found.0.iter().map(|&i| choices[i]).collect();
    let value = value_of(c, spec, &gauges)?;
    Some((gauges, value))
}

/// Rounds of exchange with the rows whose variance in the layout is largest.
const ROUNDS: usize = 5;

/// Rounds of rebuilding the sets of places within a spacing from new prices.
const CLIQUE_ROUNDS: usize = 4;

/// Runs branch and bound on the candidates that could be in a layout better than `incumbent`. Returns the number of these candidates if they are few
/// enough, and the proof with its layout if it was attempted.
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
