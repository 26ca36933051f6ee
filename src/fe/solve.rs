//! Linear statics: load cases in, strain fields out.

use super::element::Prepared;
use super::error::FeError;
use super::line_load::Between;
use super::load::load_vector;
use super::mass::{Mass, MassProperties};
use super::relief::Balance;
use super::shell_strain::{Corners, shell_fields};
use super::system::System;
use super::temperature::{Temperatures, thermal_forces};
use super::{CaseResult, Solution, UnitLoad};
use crate::finding::{Finding, Severity};
use crate::linalg::sparse::OrderingMethod;
use crate::model::{GridIx, Load, Model};
use nastran::bdf::Subcase;
use nastran::cards::{Dofs, ShellShape};
use rayon::prelude::*;

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

/// What of the strain of a heated structure is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum HeatedStrain {
    /// Total less thermal, as Nastran gives it: what a gauge compensated for its material reads.
    #[default]
    Mechanical,
    /// Thermal expansion included, the strain of the displacements: the apparent strain of a gauge that compensates nothing.
    Total,
}

/// Settings of the solver.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct SolveOptions {
    /// Strain at the corners, too.
    pub corners: Corners,
    /// With thermal expansion or without.
    pub heated: HeatedStrain,
    /// Elastic modes wanted of a structure that inertia balances, from the factor of the static solution.
    pub modes: usize,
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
    /// Nastran's epsilon of the worst case, |u'(f - K u)| / |u'f|, as substituted and after iterative refinement.
    pub epsilon: [f64; 2],
    /// Balance of every case solved by inertia relief.
    pub balance: Vec<Balance>,
    /// Mass and centre of gravity.
    pub mass: Option<MassProperties>,
    /// Frequencies of the lowest elastic modes, cycles per unit of time, ascending: as many as were asked for, where the
    /// structure is free.
    pub modes: Vec<f64>,
    /// Wall seconds by step.
    pub seconds: Vec<(String, f64)>,
}

/// Solutions whose epsilon is larger are refined by one step: below, rounding of a million unknowns leaves little to gain.
const REFINED_ABOVE: f64 = 1e-7;
/// Above this after refinement, digits that a gauge reads may be lost: the analyst is told (Nastran's users are told to worry at 1e-3).
const INACCURATE_ABOVE: f64 = 1e-6;

/// Times the steps of a solution.
struct Clock(std::time::Instant);

impl Clock {
    fn start() -> Self {
        Self(std::time::Instant::now())
    }

    /// Adds the time since the last note to a step.
    fn note(&mut self, report: &mut SolveReport, step: &str) {
        let seconds = std::mem::replace(&mut self.0, std::time::Instant::now()).elapsed();
        match report.seconds.iter_mut().find(|s| s.0 == step) {
            Some(s) => s.1 += seconds.as_secs_f64(),
            None => report
                .seconds
                .push((step.to_owned(), seconds.as_secs_f64())),
        }
    }
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

/// What acts in a subcase of a deck: its LOAD and TEMPERATURE(LOAD).
///
/// TEMPERATURE without an option stands for both; it loads, and thermal strain counts from TREF.
pub fn loads_of_subcase(s: &Subcase) -> Vec<UnitLoad> {
    let temperature = s.temperature_load.map(|set| UnitLoad::Temperature {
        set,
        initial: s.temperature_initial.filter(|initial| *initial != set),
    });
    s.load
        .into_iter()
        .map(UnitLoad::Set)
        .chain(temperature)
        .collect()
}

/// What a solution is made of before strain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// Displacements by case and grid, basic frame.
    pub displacements: Vec<Vec<[f64; 6]>>,
    /// What the solver has to say.
    pub report: SolveReport,
    /// What was noticed.
    pub findings: Vec<Finding>,
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
    solve_cases(model, &unit_cases(model, loads), options)
}

/// Unit loads on the free structure as load cases, subcases numbered 1 .. n.
pub fn unit_cases(model: &Model, loads: &[UnitLoad]) -> Vec<LoadCase> {
    let relief = relief_of(model, None, None);
    (1..)
        .zip(loads)
        .map(|(subcase, load)| LoadCase {
            subcase,
            label: String::new(),
            loads: vec![load.clone()],
            spc: None,
            mpc: model.mpc,
            relief,
        })
        .collect()
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
    let prepared = prepare(model, cases)?;
    let solved = displacements(&prepared, cases, options)?;
    with_strain(&prepared, cases, solved, options)
}

/// Displacements of load cases, without strain: what is worth keeping of a solution.
///
/// # Errors
/// See [`FeError`].
pub fn solve_displacements(
    model: &Model,
    cases: &[LoadCase],
    options: &SolveOptions,
) -> Result<Solved, FeError> {
    displacements(&prepare(model, cases)?, cases, options)
}

/// The strain of solved load cases.
///
/// # Errors
/// See [`FeError`].
pub fn solution_of(
    model: &Model,
    cases: &[LoadCase],
    solved: Solved,
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    with_strain(&prepare(model, cases)?, cases, solved, options)
}

fn prepare<'a>(model: &'a Model, cases: &[LoadCase]) -> Result<Prepared<'a>, FeError> {
    let refused = super::unsupported::unsupported(model, cases);
    if refused.is_empty() {
        Ok(Prepared::new(model))
    } else {
        Err(FeError::Refused(refused))
    }
}

fn displacements(
    prepared: &Prepared<'_>,
    cases: &[LoadCase],
    options: &SolveOptions,
) -> Result<Solved, FeError> {
    let model = prepared.model;
    let mass = Mass::new(prepared);
    let x: Vec<_> = model.grids.iter().map(|g| g.x).collect();
    let mut report = SolveReport {
        grids: model.grids.len(),
        mass: mass.properties(&x),
        ..SolveReport::default()
    };
    let mut findings = formulations(model);
    let mut fields: Vec<Vec<[f64; 6]>> = vec![Vec::new(); cases.len()];
    let mut done = vec![false; cases.len()];
    for first in 0..cases.len() {
        if done[first] {
            continue;
        }
        let key = |c: &LoadCase| (c.spc, c.mpc, c.relief, enforced_of(model, c));
        let group: Vec<usize> = (first..cases.len())
            .filter(|&i| key(&cases[i]) == key(&cases[first]))
            .collect();
        group.iter().for_each(|&i| done[i] = true);
        let members: Vec<&LoadCase> = group.iter().map(|&i| &cases[i]).collect();
        let solved = solve_group(
            prepared,
            &mass,
            &members,
            options,
            &mut report,
            &mut findings,
        )?;
        for (i, u) in group.into_iter().zip(solved) {
            fields[i] = u;
        }
    }
    Ok(Solved {
        displacements: fields,
        report,
        findings,
    })
}

fn with_strain(
    prepared: &Prepared<'_>,
    cases: &[LoadCase],
    solved: Solved,
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    let u = solved.displacements;
    let temperatures = match options.heated {
        HeatedStrain::Mechanical => temperatures_of(prepared.model, cases)?,
        HeatedStrain::Total => vec![None; cases.len()],
    };
    let between: Vec<Between<'_>> = cases
        .iter()
        .zip(&temperatures)
        .map(|(case, t)| Between::new(prepared.model, case, t.as_ref()))
        .collect();
    let shells = shell_fields(prepared, &u, &temperatures, options.corners)?;
    let beams = super::beam_strain::beam_fields(prepared, &u, &between)?;
    let solids = super::solid_fields::solid_fields(prepared, &u, &temperatures)?;
    let results = cases.iter().zip(u).zip(shells).zip(beams).zip(solids);
    Ok((
        Solution {
            cases: results
                .map(
                    |((((case, displacement), shells), beams), solids)| CaseResult {
                        subcase: case.subcase,
                        label: case.label.clone(),
                        shells,
                        beams,
                        solids,
                        displacement,
                    },
                )
                .collect(),
            source: concat!("strainbridge ", env!("CARGO_PKG_VERSION")).to_owned(),
            findings: solved.findings,
        },
        solved.report,
    ))
}

/// Displacements (basic frame) of cases with the same constraints.
fn solve_group(
    prepared: &Prepared<'_>,
    mass: &Mass,
    cases: &[&LoadCase],
    options: &SolveOptions,
    report: &mut SolveReport,
    findings: &mut Vec<Finding>,
) -> Result<Vec<Vec<[f64; 6]>>, FeError> {
    let model = prepared.model;
    let Some(case) = cases.first() else {
        return Ok(Vec::new());
    };
    check_sets(model, cases)?;
    let mut clock = Clock::start();
    let mut system = System::new(
        prepared,
        mass,
        (case.spc, case.mpc, &enforced_of(model, case)),
        case.relief,
        findings,
    )?;
    clock.note(report, "assemble");
    let n = system.symbolic.n_unknowns();
    let mut columns = vec![0.0; n * cases.len()];
    let packed: Vec<(Option<Balance>, Option<Finding>)> = columns
        .par_chunks_exact_mut(n.max(1))
        .zip(cases)
        .map(|(column, case)| load_column(prepared, mass, &system, case, column))
        .collect::<Result<_, FeError>>()?;
    for (balance, finding) in packed {
        report.balance.extend(balance);
        findings.extend(finding);
    }
    clock.note(report, "loads");
    if report.dofs < n {
        report.dofs = n;
        report.factor_nonzeros = system.symbolic.factor_nonzeros();
        report.ordering = Some(system.symbolic.method());
    }
    let stiffness = std::mem::take(&mut system.stiffness);
    let factor = system.factor(prepared, mass, stiffness)?;
    clock.note(report, "factor");
    report.smallest_pivot = factor.smallest_pivot;
    let refined = factor.solve_refined(&mut columns, REFINED_ABOVE);
    clock.note(report, "substitute");
    for (case, refined) in cases.iter().zip(refined) {
        report.epsilon[0] = report.epsilon[0].max(refined.first);
        report.epsilon[1] = report.epsilon[1].max(refined.last);
        findings.extend(inaccurate(case.subcase, refined.last));
    }
    if system.body.is_some() && options.modes > 0 && report.modes.is_empty() {
        let modes = super::modes::modes_of(prepared, mass, &system, &factor, options.modes)?;
        report.modes = modes.iter().map(|m| m.frequency).collect();
        clock.note(report, "modes");
    }
    drop(factor);
    Ok(columns
        .par_chunks_exact(n.max(1))
        .map(|column| {
            let mut u = system.unpack(prepared, column);
            if let (Some(body), Relief::Automatic) = (&system.body, case.relief) {
                body.take_out(mass, &mut u);
            }
            u
        })
        .collect())
}

fn inaccurate(subcase: u32, epsilon: f64) -> Option<Finding> {
    (!(epsilon <= INACCURATE_ABOVE)).then(|| {
        Finding::new(
            Severity::Warning,
            "inaccurate-solution",
            format!("subcase {subcase}"),
            "after a step of iterative refinement the equations are not satisfied to six digits: stiffnesses of very different size meet",
            "look for springs or bars that are many orders stiffer than what they join, and make them rigid elements",
        )
        .with_numbers(epsilon, INACCURATE_ABOVE)
    })
}

/// The balanced loads of a case at the unknowns.
fn load_column(
    prepared: &Prepared<'_>,
    mass: &Mass,
    system: &System,
    case: &LoadCase,
    column: &mut [f64],
) -> Result<(Option<Balance>, Option<Finding>), FeError> {
    let model = prepared.model;
    let mut f = applied_forces(prepared, mass, case)?;
    system.loads_on_nothing(model, &prepared.axes, case.subcase, &f)?;
    let (mut balanced, mut finding) = (None, None);
    if let Some(body) = &system.body {
        let before = largest(&f);
        balanced = Some(body.balance(case.subcase, mass, &mut f));
        if largest(&f) <= 1e-9 * before && before > 0.0 {
            finding = Some(Finding::new(
                Severity::Warning,
                "load-is-inertia-only",
                format!("subcase {}", case.subcase),
                "the loads only accelerate the free structure as a rigid body (gravity, say): its strain is zero",
                "hold the structure by an SPC set, or apply the forces that carry the weight",
            ));
        }
    }
    system.pack(prepared, f, column)?;
    Ok((balanced, finding))
}

pub(super) fn largest(f: &[[f64; 6]]) -> f64 {
    f.iter().flatten().fold(0.0, |a, v| a.max(v.abs()))
}

/// Says where an element stands for another than its card names.
fn formulations(model: &Model) -> Vec<Finding> {
    let told: [(&[ShellShape], &str, &str); 2] = [
        (
            &[ShellShape::QuadR, ShellShape::TriaR],
            "CQUADR, CTRIAR",
            "solved as CQUAD4 and CTRIA3 whose sides bend with the rotation about the normal (Allman 1984)",
        ),
        (
            &[ShellShape::Quad8, ShellShape::Tria6],
            "CQUAD8, CTRIA6",
            "solved as one quadrilateral a corner around a point in the middle, on the curved surface through the grids",
        ),
    ];
    told.into_iter()
        .filter_map(|(shapes, cards, what)| {
            let n = model.shells.iter().filter(|s| shapes.contains(&s.shape)).count();
            (n > 0).then(|| {
                Finding::new(
                    Severity::Info,
                    "formulation",
                    cards,
                    format!("{n} elements: {what}"),
                    "nothing for meshes of several elements a side; solve with Nastran where single elements carry the answer",
                )
            })
        })
        .collect()
}

/// What SPCD enforces in a case.
fn enforced_of(model: &Model, case: &LoadCase) -> Vec<(GridIx, Dofs, f64)> {
    let mut all = Vec::new();
    for load in &case.loads {
        let UnitLoad::Set(sid) = load else { continue };
        for set in model.load_sets.iter().filter(|s| s.sid == *sid) {
            all.extend(set.loads.iter().filter_map(|(factor, l)| match l {
                Load::Enforced { grid, dofs, value } => Some((*grid, *dofs, factor * value)),
                _ => None,
            }));
        }
    }
    all
}

/// The temperatures of every case; `None` for those without.
fn temperatures_of(
    model: &Model,
    cases: &[LoadCase],
) -> Result<Vec<Option<Temperatures>>, FeError> {
    cases.iter().map(|c| Temperatures::of(model, c)).collect()
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

fn applied_forces(
    prepared: &Prepared<'_>,
    mass: &Mass,
    case: &LoadCase,
) -> Result<Vec<[f64; 6]>, FeError> {
    let model = prepared.model;
    let mut f = vec![[0.0; 6]; model.grids.len()];
    if let Some(t) = Temperatures::of(model, case)? {
        thermal_forces(prepared, &t, &mut f)?;
    }
    for load in &case.loads {
        match load {
            UnitLoad::Temperature { .. } => {}
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

/// A matrix as its order and entries of its lower triangle: row, column, value.
pub type Triplets = (usize, Vec<(usize, usize, f64)>);

/// The stiffness of the free structure, supported determinately: for comparing factorisations with other programs.
///
/// # Errors
/// See [`FeError`].
pub fn supported_stiffness(model: &Model) -> Result<Triplets, FeError> {
    let prepared = Prepared::new(model);
    let mass = Mass::new(&prepared);
    let system = System::new(
        &prepared,
        &mass,
        (None, None, &[]),
        Relief::Automatic,
        &mut Vec::new(),
    )?;
    Ok((
        system.symbolic.n_unknowns(),
        system.stiffness.lower_triplets(&system.symbolic),
    ))
}
