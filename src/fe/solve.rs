//! Linear statics: load cases in, strain fields out.

use super::assembly::{Assembled, assemble};
use super::autospc::weak_unknowns;
use super::constraint::{Reduction, State, reduce};
use super::element::Prepared;
use super::error::{FeError, FreeDof, what_hangs};
use super::grid_frames::{to_basic, to_local};
use super::load::load_vector;
use super::mass::{Mass, MassProperties};
use super::relief::{Balance, RigidBody};
use super::shell_strain::{Corners, shell_fields};
use super::{CaseResult, Solution, UnitLoad};
use crate::finding::{Finding, Severity};
use crate::linalg::sparse::{Factor, FactorError, OrderingMethod};
use crate::model::Model;

/// How the loads of a case are held in balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Relief {
    /// By the SPC set alone.
    None,
    /// By inertia, supports chosen by us (PARAM,INREL,-2).
    Automatic,
    /// By inertia, displacements relative to the SUPORT dofs and those of this SUPORT1 set (PARAM,INREL,-1).
    Suport(Option<u32>),
}

/// One load case.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCase {
    /// Subcase id.
    pub subcase: u32,
    /// For people.
    pub label: String,
    /// What acts; several are summed.
    pub loads: Vec<UnitLoad>,
    /// SPC set.
    pub spc: Option<u32>,
    /// MPC set.
    pub mpc: Option<u32>,
    /// What balances the loads.
    pub relief: Relief,
}

/// Settings of the solver.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct SolveOptions {
    /// Strain at the corners, too.
    pub corners: Corners,
}

/// What the solver has to say beside the solution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Grids of the model.
    pub grids: usize,
    /// Unknowns of the largest system solved.
    pub dofs: usize,
    /// Entries of its factor.
    pub factor_nonzeros: usize,
    /// Its ordering.
    pub ordering: Option<OrderingMethod>,
    /// Smallest pivot of the matrix scaled to unit diagonal: below 1e-10 the structure is nearly a mechanism.
    pub smallest_pivot: f64,
    /// Balance of every case solved by inertia relief.
    pub balance: Vec<Balance>,
    /// Mass and centre of gravity.
    pub mass: Option<MassProperties>,
}

/// How a model without case control is balanced: by PARAM,INREL; a model with neither INREL nor `spc` as a free structure.
pub fn relief_of(model: &Model, spc: Option<u32>, suport: Option<u32>) -> Relief {
    match (model.params.inrel, spc) {
        (-1, _) => Relief::Suport(suport),
        (-2, _) => Relief::Automatic,
        (_, None) if model.grids.iter().all(|g| g.ps.is_empty()) => Relief::Automatic,
        _ => Relief::None,
    }
}

/// Solves unit loads on the free structure, subcases numbered 1 .. n.
///
/// # Errors
/// See [`FeError`].
pub fn solve_unit_loads(
    model: &Model,
    loads: &[UnitLoad],
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    let relief = relief_of(model, None, None);
    let cases: Vec<LoadCase> = (1..)
        .zip(loads)
        .map(|(subcase, load)| LoadCase {
            subcase,
            label: String::new(),
            loads: vec![load.clone()],
            spc: None,
            mpc: None,
            relief,
        })
        .collect();
    solve_cases(model, &cases, options)
}

/// Solves load cases; those with the same constraints share one factor.
///
/// # Errors
/// See [`FeError`].
pub fn solve_cases(
    model: &Model,
    cases: &[LoadCase],
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    let refused = super::unsupported::unsupported(model, cases);
    if !refused.is_empty() {
        return Err(FeError::Refused(refused));
    }
    let prepared = Prepared::new(model);
    let mass = Mass::new(&prepared).map_err(FeError::Refused)?;
    let x: Vec<_> = model.grids.iter().map(|g| g.x).collect();
    let mut report = SolveReport {
        grids: model.grids.len(),
        mass: mass.properties(&x),
        ..SolveReport::default()
    };
    let mut findings = Vec::new();
    let mut results: Vec<Option<CaseResult>> = vec![None; cases.len()];
    let mut done = vec![false; cases.len()];
    for first in 0..cases.len() {
        if done[first] {
            continue;
        }
        let key = |c: &LoadCase| (c.spc, c.mpc, c.relief);
        let group: Vec<usize> = (first..cases.len())
            .filter(|&i| key(&cases[i]) == key(&cases[first]))
            .collect();
        group.iter().for_each(|&i| done[i] = true);
        let members: Vec<&LoadCase> = group.iter().map(|&i| &cases[i]).collect();
        let solved = solve_group(&prepared, &mass, &members, &mut report, &mut findings)?;
        let fields = shell_fields(&prepared, &solved, options.corners)?;
        for (((i, case), u), shells) in group.iter().zip(members).zip(solved).zip(fields) {
            results[*i] = Some(CaseResult {
                subcase: case.subcase,
                label: case.label.clone(),
                shells,
                beams: super::beam_strain::beam_field(&prepared, &u),
                displacement: u,
            });
        }
    }
    let source = concat!("strainbridge ", env!("CARGO_PKG_VERSION")).to_owned();
    Ok((
        Solution {
            cases: results.into_iter().flatten().collect(),
            source,
            findings,
        },
        report,
    ))
}

/// Displacements (basic frame) of cases with the same constraints.
fn solve_group(
    prepared: &Prepared<'_>,
    mass: &Mass,
    cases: &[&LoadCase],
    report: &mut SolveReport,
    findings: &mut Vec<Finding>,
) -> Result<Vec<Vec<[f64; 6]>>, FeError> {
    let model = prepared.model;
    let Some(case) = cases.first() else {
        return Ok(Vec::new());
    };
    check_sets(model, cases)?;
    let reduction = reduce(model, &prepared.axes, case.spc, case.mpc)?;
    let mut assembled = assemble(prepared, &reduction)?;
    let body = match case.relief {
        Relief::None => None,
        _ => {
            let x = model.grids.iter().map(|g| g.x).collect();
            Some(RigidBody::new(
                x,
                &prepared.axes,
                mass,
                &reduction,
                &touched(prepared, &reduction),
            )?)
        }
    };
    if let Some(body) = &body {
        findings.extend(ties(prepared, &assembled, body));
    }
    let weak = if model.params.autospc {
        weak_unknowns(&assembled)
    } else {
        Vec::new()
    };
    for (unknown, k) in &weak {
        assembled
            .stiffness
            .add_to_diagonal(&assembled.symbolic, *unknown, *k);
    }
    findings.extend(autospc_finding(model, &assembled, &weak));
    let start = assembled.symbolic.unknown_start().to_vec();
    let supports = match (&body, case.relief) {
        (Some(body), Relief::Suport(set)) => {
            let dofs: Vec<_> = model
                .suports
                .iter()
                .filter(|(sid, _)| sid.is_none() || *sid == set)
                .flat_map(|(_, list)| list.iter().copied())
                .collect();
            body.given_supports(&prepared.axes, &assembled.numbering, &start, &dofs)?
        }
        (Some(body), _) => body.choose_supports(&prepared.axes, &assembled.numbering),
        (None, _) => Vec::new(),
    };
    let diagonal = assembled.stiffness.diagonal_values(&assembled.symbolic);
    for unknown in &supports {
        assembled
            .stiffness
            .add_to_diagonal(&assembled.symbolic, *unknown, diagonal[*unknown]);
    }
    let n = assembled.symbolic.n_unknowns();
    let mut columns = vec![0.0; n * cases.len()];
    for (case, column) in cases.iter().zip(columns.chunks_exact_mut(n.max(1))) {
        let mut f = applied_forces(model, mass, case)?;
        loads_on_nothing(model, &reduction, &assembled, &weak, case, &f)?;
        if let Some(body) = &body {
            let before = largest(&f);
            let balance = body.balance(case.subcase, mass, &mut f);
            if largest(&f) <= 1e-9 * before && before > 0.0 {
                findings.push(Finding::new(
                    Severity::Warning,
                    "load-is-inertia-only",
                    format!("subcase {}", case.subcase),
                    "the loads only accelerate the free structure as a rigid body (gravity, say): its strain is zero",
                    "hold the structure by an SPC set, or apply the forces that carry the weight",
                ));
            }
            report.balance.push(balance);
        }
        for (f, axes) in f.iter_mut().zip(&prepared.axes) {
            *f = to_local(axes, *f);
        }
        if !reduction.enforced.is_empty() {
            subtract_enforced(prepared, &reduction, &mut f)?;
        }
        assembled.numbering.pack(&reduction.gather(f), column);
    }
    if report.dofs < n {
        report.dofs = n;
        report.factor_nonzeros = assembled.symbolic.factor_nonzeros();
        report.ordering = Some(assembled.symbolic.method());
    }
    let Assembled {
        numbering,
        symbolic,
        stiffness,
        graph,
    } = assembled;
    let factor =
        Factor::new(&symbolic, &stiffness).map_err(|FactorError::NotANumber { unknown }| {
            let grid = &model.grids[numbering.dof_of(unknown, &start).0];
            FeError::NotANumber {
                grid: grid.id,
                at: grid.at,
            }
        })?;
    drop(stiffness);
    report.smallest_pivot = factor.smallest_pivot;
    if !factor.lost.is_empty() {
        return Err(mechanism(model, &factor.lost, &start, &numbering, &graph));
    }
    factor.solve(&mut columns);
    drop(factor);
    let mut all = Vec::with_capacity(cases.len());
    for column in columns.chunks_exact(n.max(1)) {
        let mut u = reduction.expand(&numbering.unpack(column));
        for (u, axes) in u.iter_mut().zip(&prepared.axes) {
            *u = to_basic(axes, *u);
        }
        if let (Some(body), Relief::Automatic) = (&body, case.relief) {
            body.take_out(mass, &mut u);
        }
        all.push(u);
    }
    Ok(all)
}

fn largest(f: &[[f64; 6]]) -> f64 {
    f.iter().flatten().fold(0.0, |a, v| a.max(v.abs()))
}

fn check_sets(model: &Model, cases: &[&LoadCase]) -> Result<(), FeError> {
    for case in cases {
        let missing = |kind, sid: Option<u32>, known: bool| match sid {
            Some(sid) if !known => Err(FeError::MissingSet {
                kind,
                sid,
                subcase: case.subcase,
            }),
            _ => Ok(()),
        };
        missing(
            "SPC",
            case.spc,
            model.spcs.iter().any(|s| Some(s.sid) == case.spc),
        )?;
        missing(
            "MPC",
            case.mpc,
            model.mpcs.iter().any(|s| Some(s.sid) == case.mpc),
        )?;
        for load in &case.loads {
            if let UnitLoad::Set(sid) = load {
                missing(
                    "LOAD",
                    Some(*sid),
                    model.load_sets.iter().any(|s| s.sid == *sid),
                )?;
            }
        }
    }
    Ok(())
}

fn applied_forces(model: &Model, mass: &Mass, case: &LoadCase) -> Result<Vec<[f64; 6]>, FeError> {
    let mut f = vec![[0.0; 6]; model.grids.len()];
    for load in &case.loads {
        match load {
            UnitLoad::AtGrid {
                grid,
                force,
                moment,
            } => {
                for i in 0..3 {
                    f[grid.us()][i] += force[i];
                    f[grid.us()][3 + i] += moment[i];
                }
            }
            UnitLoad::Set(sid) => {
                let set =
                    model
                        .load_sets
                        .iter()
                        .find(|s| s.sid == *sid)
                        .ok_or(FeError::MissingSet {
                            kind: "LOAD",
                            sid: *sid,
                            subcase: case.subcase,
                        })?;
                for (f, add) in f.iter_mut().zip(load_vector(model, mass, set)) {
                    f.iter_mut().zip(add).for_each(|(f, a)| *f += a);
                }
            }
        }
    }
    Ok(f)
}

/// Grids that belong to the structure: of an element, or tied to it.
fn touched(prepared: &Prepared<'_>, reduction: &Reduction) -> Vec<bool> {
    let mut touched = vec![false; prepared.model.grids.len()];
    for element in prepared.elements() {
        for g in prepared.grids(element) {
            touched[g.us()] = true;
        }
    }
    for (dof, state) in reduction.state.iter().enumerate() {
        if matches!(state, State::Dependent(_)) {
            touched[dof / 6] = true;
        }
    }
    touched
}

/// f - K u0 for enforced displacements, displacement frames.
fn subtract_enforced(
    prepared: &Prepared<'_>,
    reduction: &Reduction,
    f: &mut [[f64; 6]],
) -> Result<(), FeError> {
    let u0 = reduction.expand(&vec![[0.0; 6]; prepared.model.grids.len()]);
    for element in prepared.elements() {
        let grids = prepared.grids(element);
        if grids.iter().all(|g| u0[g.us()] == [0.0; 6]) {
            continue;
        }
        let mut k = prepared
            .stiffness(element)
            .map_err(|r| FeError::Refused(vec![r]))?;
        super::assembly::to_displacement_frames(&prepared.axes, &mut k);
        let local: Vec<f64> = k.grids.iter().flat_map(|g| u0[g.us()]).collect();
        for (g, v) in k.grids.iter().zip(k.times(&local).chunks_exact(6)) {
            f[g.us()].iter_mut().zip(v).for_each(|(f, v)| *f -= v);
        }
    }
    Ok(())
}

fn ties(prepared: &Prepared<'_>, assembled: &Assembled, body: &RigidBody) -> Option<Finding> {
    let diagonal = assembled.stiffness.diagonal_values(&assembled.symbolic);
    let mut worst = (0.0, 0);
    for column in 0..body.n_free() {
        let motion = body.packed(&prepared.axes, &assembled.numbering, column);
        let force = assembled.stiffness.times(&assembled.symbolic, &motion);
        for (i, (f, d)) in force.iter().zip(&diagonal).enumerate() {
            let share = f.abs() / d.max(f64::MIN_POSITIVE);
            if share > worst.0 && *d > 0.0 {
                worst = (share, i);
            }
        }
    }
    let limit = 1e-7;
    let (grid, dof) = assembled
        .numbering
        .dof_of(worst.1, assembled.symbolic.unknown_start());
    (worst.0 > limit).then(|| {
        Finding::new(
            Severity::Error,
            "tied-to-ground",
            format!("grid {}", prepared.model.grids[grid].id),
            format!("a rigid motion of the structure is resisted here (dof {}): something ties it to ground, and strain depends on it", dof + 1),
            "look for CELAS or CBUSH to ground, springs between grids that don't coincide, or MPC equations that forbid rigid motion",
        )
        .with_numbers(worst.0, limit)
    })
}

fn autospc_finding(model: &Model, assembled: &Assembled, weak: &[(usize, f64)]) -> Option<Finding> {
    let start = assembled.symbolic.unknown_start();
    let names: Vec<String> = weak
        .iter()
        .take(5)
        .map(|(unknown, _)| {
            let (g, dof) = assembled.numbering.dof_of(*unknown, start);
            format!("{}/{}", model.grids[g].id, dof + 1)
        })
        .collect();
    (!weak.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "autospc",
            format!("grid/dof {}", names.join(", ")),
            format!("{} dofs without stiffness were held (AUTOSPC)", weak.len()),
            "nothing, if no load is meant to act there",
        )
    })
}

fn loads_on_nothing(
    model: &Model,
    reduction: &Reduction,
    assembled: &Assembled,
    weak: &[(usize, f64)],
    case: &LoadCase,
    f: &[[f64; 6]],
) -> Result<(), FeError> {
    let fault = |g: usize, dof: usize| FeError::LoadOnNothing {
        grid: model.grids[g].id,
        dof: dof as u8 + 1,
        subcase: case.subcase,
        at: model.grids[g].at,
    };
    let limit = 1e-9 * largest(f);
    for (g, f) in f.iter().enumerate() {
        let loose = |i: usize| {
            reduction.state[6 * g + i] == State::Free && assembled.numbering.group[g].is_none()
        };
        if let Some(i) = (0..6).find(|&i| f[i].abs() > limit && loose(i)) {
            return Err(fault(g, i));
        }
    }
    for (unknown, _) in weak {
        let (g, dof) = assembled
            .numbering
            .dof_of(*unknown, assembled.symbolic.unknown_start());
        if f[g][dof].abs() > limit && reduction.is_plain(g) && model.grids[g].cd.0 == 0 {
            return Err(fault(g, dof));
        }
    }
    Ok(())
}

fn mechanism(
    model: &Model,
    lost: &[usize],
    start: &[usize],
    numbering: &super::assembly::Numbering,
    graph: &crate::linalg::sparse::BlockGraph,
) -> FeError {
    const SHOWN: usize = 8;
    let dofs = lost
        .iter()
        .take(SHOWN)
        .map(|&unknown| {
            let (g, dof) = numbering.dof_of(unknown, start);
            let grid = &model.grids[g];
            FreeDof {
                grid: grid.id,
                dof: dof as u8 + 1,
                hangs: what_hangs(model, crate::model::GridIx(g as u32)),
                at: grid.at,
            }
        })
        .collect();
    let (of, count) = graph.components();
    let mut sizes = vec![0_usize; count];
    of.iter().for_each(|c| sizes[*c as usize] += 1);
    let main = sizes.iter().copied().max().unwrap_or(0);
    let mut parts = Vec::new();
    for (c, size) in sizes
        .iter()
        .enumerate()
        .filter(|(_, s)| count > 1 && **s < main)
        .take(SHOWN)
    {
        let ids: Vec<String> = of
            .iter()
            .zip(&numbering.grid)
            .filter(|(o, _)| **o as usize == c)
            .take(3)
            .map(|(_, g)| model.grids[*g as usize].id.to_string())
            .collect();
        parts.push(format!(
            "a part of {size} grids (grid {} ..) is not joined to the rest",
            ids.join(", ")
        ));
    }
    FeError::Mechanism {
        dofs,
        count: lost.len(),
        parts,
    }
}
