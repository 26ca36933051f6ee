//! Mesh error of the strain, from its change on a mesh half as wide.
//!
//! Strain `e(h)` on a mesh of width `h` changes by `e(h/2) - e(h)` if the width is halved. If errors fall with the square of the width, the error at
//! `h` is 4/3 of this change. At folds, edges and corners, errors fall at another rate. The error is taken as [`WHOLE`] times the change. It is
//! subtracted from the strain of the built-in solver. The error that may remain is a part of the covariance of S.
//!
//! # Reference
//! L. F. Richardson, Phil. Trans. R. Soc. A 210 (1911) 307.

use super::specs::corrected_spec_of;
use crate::fe::{CaseResult, LoadCase, ShellField, Solution, UnitLoad};
use crate::finding::{Finding, Severity, list_few};
use crate::gauge::{CornerRows, Gauge, Spot, build, change_by_refining, gauge_reading};
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{Job, Measured};
use crate::model::{GridIx, Load as ModelLoad, Model, RefinedModel, ShellIx};
use crate::sensitivity::{LoadCaseOf, Sensitivity, Uncertainty};
use crate::strain_chain::built_in_solver::{MOST_GRIDS_TWICE, cases_kept, support_of_job};
use crate::strain_chain::deck::DeckModel;
use serde::Serialize;
use std::collections::BTreeSet;

/// Number of shells beyond which only shells around the gauges are divided. A model with four times as many shells would take too long.
const MOST_SHELLS: usize = 40_000;
/// Rows of elements round a gauge's element that are divided with it, the first that [`MOST_SHELLS`] allows. They do not show the mesh error from
/// farther away (a rail that twists too little). It is a third of the whole in open rails with ten rows (docs/reference/verification.md).
const ROWS: [usize; 4] = [10, 8, 6, 4];
/// Error of a mesh over its change by halving the width. Richardson's 4/3 is too large where the finer mesh meets a corner or the thickness
/// of the shell. On open, closed and kicked frames of 40 mm against 13 mm errors fall nearly with the cube of the width. This value leaves
/// the least error (docs/reference/verification.md).
const WHOLE: f64 = 1.1;
/// Share of the error that may remain after subtraction, 1 sd. It applies to each entry of S separately and to the pattern of each load as a
/// whole. If errors fall with the width itself two thirds remain, which is 1.96 of these.
const LEFT: f64 = 1.0 / 3.0;
/// Further error as a share of the strain itself, 1 sd, each entry separately. Halving the width changes almost nothing at gauges that `place` finds,
/// partly by chance. The remaining error at these gauges does not depend on this change (the same frames).
const SLIGHT: f64 = 0.003;
/// Share of the error that may remain, 1 sd, if only the mesh around the gauges was divided. The error from other parts of the mesh adds half of the
/// computed error.
const LEFT_IN_PART: f64 = 0.5;
/// Mesh error above which it exceeds the errors of angle, place and gauge factor of a carefully installed gauge together.
const LARGE: f64 = 0.05;
/// Number of entries of S beyond which their covariance would exceed 128 MB. The remaining error is then not weighted.
const MOST_ENTRIES: usize = 4_000;

/// The mesh error of a gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GaugeMeshError {
    /// Gauge or channel.
    pub name: String,
    /// RMS mesh error divided by the RMS reading, both over the loads at their expected size. The mesh error is the reading on the deck's mesh minus
    /// the limit. It is positive if the mesh reads too much.
    pub mesh_error_rel: f64,
    /// Mesh error by load.
    pub by_load: Vec<LoadMeshError>,
}

/// The mesh error of a gauge under one load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadMeshError {
    /// Load.
    pub name: String,
    /// Reading on the deck's mesh minus the limit, over the limit; `None` if the load does not strain the gauge.
    pub mesh_error_rel: Option<f64>,
}

/// Error of the mesh in the strain of the unit loads.
pub struct MeshError {
    /// Strain on the deck's mesh minus the limit, for each load.
    pub cases: Vec<CaseResult>,
    /// Share of the mesh error that may remain after the correction, 1 sd. It applies to each entry of S and to the pattern of each load.
    pub left: f64,
}

/// Places at which the strain is corrected for the error of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WantedAt {
    /// At the job's gauges. A large mesh is divided only around them.
    Gauges,
    /// At all possible gauge positions.
    Anywhere,
}

/// Returns the model on a mesh half as wide. A model of up to `MOST_SHELLS` shells is refined everywhere, and a larger model only in `ROWS` of
/// elements around known `gauges`.
///
/// # Errors
/// The reason why no finer mesh was made, as a message.
pub fn refined_mesh(model: &Model, gauges: Option<&[Gauge]>) -> Result<RefinedModel, String> {
    let n = model.shells.len();
    let count = |divided: &Vec<bool>| divided.iter().filter(|d| **d).count();
    let divided = if n <= MOST_SHELLS {
        vec![true; n]
    } else {
        let shells = shells_under(gauges.unwrap_or_default());
        if shells.is_empty() {
            return Err(format!(
                "the model has {n} shells and no known gauges, and above {MOST_SHELLS} shells no mesh of four times as many is solved"
            ));
        }
        let mut near = ROWS.iter().map(|rows| model.shells_near(&shells, *rows));
        near.find(|d| count(d) <= MOST_SHELLS).ok_or_else(|| {
            format!(
                "more than {MOST_SHELLS} of {n} shells are around the gauges, and above this number no mesh of four times as many is solved"
            )
        })?
    };
    model.refine_shells_at(&divided).ok_or_else(|| {
        "the mesh cannot be refined (shells with mid-side grids, bars or solids along shells in other displacement frames, or no shells)"
            .to_owned()
    })
}

/// Returns the shells whose strain gauges read.
fn shells_under(gauges: &[Gauge]) -> Vec<ShellIx> {
    let arms = gauges.iter().flat_map(|g| &g.arms);
    let shells = arms.filter_map(|arm| match arm.spot {
        Spot::Shell { shell, .. } => Some(shell),
        _ => None,
    });
    shells.collect()
}

/// Returns the gauges of the job that can be placed on the model. Other gauges are reported when the gauges are read.
fn gauges_of(job: &Job, model: &Model) -> Vec<Gauge> {
    let laid = job.gauges.iter().filter_map(|g| {
        let spec = corrected_spec_of(model, job, g).ok()?;
        Some(build(model, &spec, CornerRows::Absent).ok()?.0)
    });
    laid.flatten().collect()
}

/// Subtracts the mesh error from the strain of a job's unit loads and of its `reference` state. Returns the mesh error by load: strain on the deck's
/// mesh minus the limit.
///
/// `None` if the job declines it, or if no finer mesh could be solved, which a finding reports. If the job does not state the key, the mesh error is
/// subtracted on decks of shells with up to [`MOST_GRIDS_TWICE`] grids. For a larger deck or another mesh, a note states the reason why it is not.
pub(super) fn take_out(
    work: &mut Work,
    job: &Job,
    deck: &DeckModel,
    (cases, at): (&[LoadCase], WantedAt),
    (solution, reference): (&mut Solution, &mut [CaseResult]),
) -> Option<MeshError> {
    let asked = job.model.as_ref().and_then(|m| m.mesh_error);
    let grids = deck.model.grids.len();
    match asked {
        Some(true) => {}
        // A model of bars and springs alone has no mesh error.
        None if deck.model.shells.is_empty() => return None,
        None if grids <= MOST_GRIDS_TWICE => {
            let loads = cases.iter().flat_map(|c| &c.loads);
            if let Some(grid) = point_load(&deck.model, loads) {
                work.notes.push(format!(
                    "the error of the mesh is not computed: a load acts at grid {grid} of a shell, and the strain under a point load grows as the mesh becomes finer. \
                     Let it act at the reference grid of an RBE2 or RBE3, or write `mesh_error = true` in [model]"
                ));
                return None;
            }
        }
        None => {
            work.notes.push(format!(
                "the error of the mesh is not computed: the deck has {grids} grids, limit {MOST_GRIDS_TWICE}. `mesh_error = true` in [model] computes it"
            ));
            return None;
        }
        Some(false) => return None,
    }
    let own: Vec<&CaseResult> = solution.cases.iter().chain(&*reference).collect();
    match compute_mesh_error(work, job, deck, (cases, &own), at) {
        Ok((mut errors, left)) => {
            let of_reference = errors.split_off(solution.cases.len());
            let all = solution.cases.iter_mut().zip(&errors);
            for (case, error) in all.chain(reference.iter_mut().zip(&of_reference)) {
                subtract(&mut case.shells, &error.shells);
            }
            Some(MeshError {
                cases: errors,
                left,
            })
        }
        Err(why) if asked.is_none() => {
            let note = format!("the error of the mesh is not computed: {why}");
            work.notes.push(note);
            None
        }
        Err(why) => {
            work.findings
                .push(not_checked(&format!("no finer mesh was solved: {why}")));
            None
        }
    }
}

/// Returns the id of a grid of a shell at which one of the loads acts directly.
///
/// The strain under a point load has no limit for finer meshes. Forces at several grids may be a distributed load, which a finer mesh would have to
/// distribute over more grids.
fn point_load<'a>(model: &Model, mut loads: impl Iterator<Item = &'a UnitLoad>) -> Option<u32> {
    let shells = model.shells.iter();
    let of_shells: BTreeSet<GridIx> = shells.flat_map(|s| s.all_grids()).collect();
    let is_direct = |grid: &GridIx| of_shells.contains(grid);
    let grid = loads.find_map(|load| match load {
        UnitLoad::AtGrid { grid, .. } => Some(*grid).filter(is_direct),
        UnitLoad::Set(sid) => {
            let set = model.load_sets.iter().find(|s| s.sid == *sid)?;
            let mut grids = set.loads.iter().filter_map(|(_, l)| match l {
                ModelLoad::Force(grid, _) | ModelLoad::Moment(grid, _) => Some(*grid),
                _ => None,
            });
            grids.find(is_direct)
        }
        UnitLoad::Temperature { .. } => None,
    })?;
    model.grids.get(grid.us()).map(|g| g.id)
}

/// Subtracts the mesh error from the strain of further unit loads, if it was subtracted from the strain of the job's loads. A note states that loads
/// directly on a shell keep the strain of the deck's mesh.
///
/// # Errors
/// Loads that cannot be solved on the finer mesh.
pub fn subtract_from_additional_loads(
    work: &mut Work,
    job: &Job,
    (deck, known): (&DeckModel, Option<&MeshError>),
    (loads, solved): (&[UnitLoad], &mut [CaseResult]),
) -> Result<(), Faults> {
    if known.is_none() {
        return Ok(());
    }
    if let Some(grid) = point_load(&deck.model, loads.iter()) {
        work.notes.push(format!(
            "the error of the mesh is not subtracted from the strain of the load at grid {grid}: the grid is of a shell"
        ));
        return Ok(());
    }
    let cases = support_of_job(job, &deck.model)?.unit_cases(&deck.model, loads);
    let own: Vec<&CaseResult> = solved.iter().collect();
    let (errors, _) = compute_mesh_error(work, job, deck, (&cases, &own), WantedAt::Gauges)
        .map_err(|why| {
            let wrong = format!("the error of the mesh is not known for all loads: {why}");
            let remedy = "write mesh_error = false in [model]";
            Faults::from(Fault::new(&*job.file, "model.mesh_error", wrong, remedy))
        })?;
    for (case, error) in solved.iter_mut().zip(&errors) {
        subtract(&mut case.shells, &error.shells);
    }
    Ok(())
}

/// Returns the finding that the mesh error is unknown although the job asks for it.
pub(super) fn not_checked(why: &str) -> Finding {
    Finding::new(
        Severity::Warning,
        "mesh-not-checked",
        "model.mesh_error",
        format!("the error of the mesh is unknown: {why}"),
        "state `model_uncertainty_rel`, or compare with a finer deck",
    )
}

/// Returns the mesh error by load case, and the share of it that may remain. The mesh error is the strain on the deck's mesh (`solved`) minus the
/// limit.
///
/// # Errors
/// The reason why no finer mesh was solved, as a message.
fn compute_mesh_error(
    work: &mut Work,
    job: &Job,
    deck: &DeckModel,
    (cases, solved): (&[LoadCase], &[&CaseResult]),
    at: WantedAt,
) -> Result<(Vec<CaseResult>, f64), String> {
    let refined = work.stage("refine", |_| {
        let gauges = (at == WantedAt::Gauges).then(|| gauges_of(job, &deck.model));
        refined_mesh(&deck.model, gauges.as_deref())
    })?;
    let sets = |model: &Model| -> Vec<u32> { model.load_sets.iter().map(|s| s.sid).collect() };
    let (of_deck, kept) = (sets(&deck.model), sets(&refined.model));
    let acting = || cases.iter().flat_map(|c| &c.loads);
    for load in acting() {
        let UnitLoad::Set(sid) = load else { continue };
        if of_deck.contains(sid) && !kept.contains(sid) {
            return Err(format!(
                "load set {sid} acts on elements, and a mesh of half the width is solved for loads at grids, gravity and rotation"
            ));
        }
    }
    let of_sets = acting().filter(|l| matches!(l, UnitLoad::Set(_)));
    if let Some(grid) = point_load(&deck.model, of_sets) {
        return Err(format!(
            "a load set acts at grid {grid} of a shell, and its distribution over the grids of a finer mesh is not known"
        ));
    }
    if cases.iter().any(|c| c.mpc != deck.model.mpc) {
        return Err("the subcases select different MPC sets".to_owned());
    }
    // New grids on a side of an undivided element depend on the grids of that side. The finer model contains these equations as well.
    let mpc = refined.model.mpc;
    let cases: Vec<LoadCase> = cases
        .iter()
        .map(|c| LoadCase { mpc, ..c.clone() })
        .collect();
    let fine = work
        .stage("solve the finer mesh", |w| {
            let made = (deck, "mesh half as wide");
            cases_kept(w, made, &refined.model, &cases)
        })
        .map_err(|faults| faults.first_reason())?;
    let pairs: Vec<_> = solved.iter().copied().zip(&fine.cases).collect();
    let left = match refined.is_whole() {
        true => LEFT,
        false => LEFT_IN_PART,
    };
    let errors = work.stage("mesh error", |_| {
        let changes = change_by_refining(&deck.model, &refined, &pairs).into_iter();
        changes.map(|c| times(c, -WHOLE)).collect()
    });
    Ok((errors, left))
}

/// Returns a strain field times a number.
fn times(mut case: CaseResult, factor: f64) -> CaseResult {
    let shells = &mut case.shells;
    let corners = shells.corners.iter_mut().flatten();
    let sides = shells.centre.iter_mut().chain(corners);
    sides.flatten().flatten().for_each(|v| *v *= factor);
    case
}

fn subtract(from: &mut ShellField, what: &ShellField) {
    let corners = from.corners.iter_mut().flatten();
    let others = what.corners.iter().flatten();
    let sides = from.centre.iter_mut().chain(corners);
    for (a, b) in sides.zip(what.centre.iter().chain(others)) {
        for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
            *a -= b;
        }
    }
}

/// Returns the error of a reading that may remain if the mesh was divided everywhere, 1 sd, strain. It is the root of the sum of squares over
/// loads of the size `scales`; 0 without `errors`.
pub fn left_in_reading(
    gauge: &Gauge,
    (loads, errors): (&[LoadCaseOf], &[LoadCaseOf]),
    scales: &[f64],
) -> f64 {
    if errors.is_empty() {
        return 0.0;
    }
    let squares = |cases: &[LoadCaseOf]| -> f64 {
        let of = |(e, f): (&LoadCaseOf, &f64)| {
            let strain = gauge_reading(gauge, e.case).unwrap_or(0.0);
            (strain * f / e.applied).powi(2)
        };
        cases.iter().zip(scales).map(of).sum()
    };
    let [of_error, of_strain] = left_squared();
    (of_error * squares(errors) + of_strain * squares(loads)).sqrt()
}

/// Returns the squared shares that may remain after the mesh error is subtracted: a share of the mesh error, and a share of the strain. The share of
/// the mesh error adds an independent part of each entry and a part of the load's pattern.
pub fn left_squared() -> [f64; 2] {
    [2.0 * LEFT * LEFT, SLIGHT * SLIGHT]
}

/// Returns the mesh error of every gauge of S; empty if no mesh error was computed.
pub fn mesh_errors(
    gauges: &[Gauge],
    s: &Sensitivity,
    errors: &[LoadCaseOf],
) -> Vec<GaugeMeshError> {
    let scales = s.scales();
    let of_gauge = |(g, gauge): (usize, &Gauge)| {
        let (mut off, mut read, mut sign) = (0.0, 0.0, 0.0);
        let by_load = errors.iter().enumerate().map(|(l, e)| {
            let error = gauge_reading(gauge, e.case).unwrap_or(f64::NAN) / e.applied;
            let limit = s.values[(g, l)];
            let scale = scales.get(l).copied().unwrap_or(1.0);
            off += (error * scale).powi(2);
            read += (limit * scale).powi(2);
            sign += error * limit * scale * scale;
            LoadMeshError {
                name: e.load.name.clone(),
                mesh_error_rel: Some(error / limit).filter(|r| r.is_finite()),
            }
        });
        let by_load = by_load.collect();
        let size = if read > 0.0 { (off / read).sqrt() } else { 0.0 };
        GaugeMeshError {
            name: gauge.name.clone(),
            mesh_error_rel: size.copysign(sign),
            by_load,
        }
    };
    if errors.is_empty() {
        return Vec::new();
    }
    gauges.iter().enumerate().map(of_gauge).collect()
}

/// Returns the finding on gauges at which the mesh is too coarse.
pub fn coarse_at_gauges(gauges: &[Gauge], errors: &[GaugeMeshError], left: f64) -> Option<Finding> {
    let mut large: Vec<(&Gauge, f64)> = gauges
        .iter()
        .zip(errors)
        .map(|(g, e)| (g, e.mesh_error_rel))
        .filter(|(_, e)| e.abs() > LARGE)
        .collect();
    large.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let worst = large.first()?.1.abs();
    let n = large.len();
    let named: Vec<String> = large
        .iter()
        .map(|(g, e)| format!("`{}` {:+.0} % (element {})", g.name, 100.0 * e, g.element))
        .collect();
    Some(
        Finding::new(
            Severity::Warning,
            "mesh-coarse-at-gauges",
            "model",
            format!(
                "the deck's mesh is too coarse at {n} of {} gauges: the readings have errors of {}. S is corrected for this error, and \
                 {:.0} % of it is treated as uncertainty",
                gauges.len(),
                list_few(&named),
                100.0 * left
            ),
            "refine the deck around these elements (half the width gives a quarter of the error), or move the gauges",
        )
        .with_numbers(worst, LARGE),
    )
}

/// Returns the uncertainty of S from the model error and the remaining mesh error. `None` if no mesh error was computed, or if S is too large, which
/// a finding reports.
pub(super) fn uncertainty(
    work: &mut Work,
    measured: Option<&Measured>,
    gauges: &[Gauge],
    s: &Sensitivity,
    (errors, left_share): (&[LoadCaseOf], f64),
) -> Option<Uncertainty> {
    let measured = measured?;
    let (n, k) = s.values.shape();
    if errors.len() != k || gauges.len() != n {
        return None;
    }
    if n * k > MOST_ENTRIES {
        let message = format!(
            "S has {} entries, and above {MOST_ENTRIES} their covariance is not stored: S is corrected for the mesh error, but intervals \
             do not include the remaining error",
            n * k
        );
        let remedy =
            "use fewer gauges at a time, or state the remaining error in `model_uncertainty_rel`";
        let code = "mesh-error-not-weighed";
        work.findings.push(
            Finding::new(Severity::Warning, code, "model.mesh_error", message, remedy)
                .with_numbers((n * k) as f64, MOST_ENTRIES as f64),
        );
        return None;
    }
    let left = crate::linalg::Matrix::from_fn(n, k, |g, l| {
        let error = gauge_reading(&gauges[g], errors[l].case).unwrap_or(0.0);
        left_share * error / errors[l].applied
    });
    Some(Uncertainty::of_model(
        &s.values,
        measured.model_uncertainty_rel,
        (&left, SLIGHT),
    ))
}
