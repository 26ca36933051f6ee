//! Linear statics: load cases in, strain fields out.

use super::element::Prepared;
use super::error::FeError;
use super::load::load_vector;
use super::mass::{Mass, MassProperties};
use super::relief::Balance;
use super::shell_strain::{Corners, shell_fields};
use super::system::System;
use super::{CaseResult, Solution, UnitLoad};
use crate::finding::{Finding, Severity};
use crate::linalg::sparse::OrderingMethod;
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
            mpc: model.mpc,
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
        let shells = shell_fields(&prepared, &solved, options.corners)?;
        let beams = super::beam_strain::beam_fields(&prepared, &solved)?;
        for ((((i, case), u), shells), beams) in
            group.iter().zip(members).zip(solved).zip(shells).zip(beams)
        {
            results[*i] = Some(CaseResult {
                subcase: case.subcase,
                label: case.label.clone(),
                shells,
                beams,
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
    let mut system = System::new(prepared, mass, (case.spc, case.mpc), case.relief, findings)?;
    let n = system.symbolic.n_unknowns();
    let mut columns = vec![0.0; n * cases.len()];
    for (case, column) in cases.iter().zip(columns.chunks_exact_mut(n.max(1))) {
        let mut f = applied_forces(model, mass, case)?;
        system.loads_on_nothing(model, case.subcase, &f)?;
        if let Some(body) = &system.body {
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
        system.pack(prepared, f, column)?;
    }
    if report.dofs < n {
        report.dofs = n;
        report.factor_nonzeros = system.symbolic.factor_nonzeros();
        report.ordering = Some(system.symbolic.method());
    }
    let stiffness = std::mem::take(&mut system.stiffness);
    let factor = system.factor(model, &stiffness)?;
    drop(stiffness);
    report.smallest_pivot = factor.smallest_pivot;
    factor
        .solve(&mut columns)
        .map_err(|e| system.refused(model, e))?;
    drop(factor);
    let mut all = Vec::with_capacity(cases.len());
    for column in columns.chunks_exact(n.max(1)) {
        let mut u = system.unpack(prepared, column);
        if let (Some(body), Relief::Automatic) = (&system.body, case.relief) {
            body.take_out(mass, &mut u);
        }
        all.push(u);
    }
    Ok(all)
}

pub(super) fn largest(f: &[[f64; 6]]) -> f64 {
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

/// The stiffness of the free structure, supported determinately, as its order and the lower triangle by row, column, value: for
/// comparing factorisations with other programs.
///
/// # Errors
/// See [`FeError`].
pub fn supported_stiffness(model: &Model) -> Result<(usize, Vec<(usize, usize, f64)>), FeError> {
    let prepared = Prepared::new(model);
    let mass = Mass::new(&prepared).map_err(FeError::Refused)?;
    let system = System::new(
        &prepared,
        &mass,
        (None, None),
        Relief::Automatic,
        &mut Vec::new(),
    )?;
    Ok((
        system.symbolic.n_unknowns(),
        system.stiffness.lower_triplets(&system.symbolic),
    ))
}
