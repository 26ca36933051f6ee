//! Linear statics: load cases in, strain fields out.

use super::applied_loads::{applied_forces, check_sets, enforced_of, largest_component};
use super::error::FeError;
use super::formulation::formulations;
use super::load_case::{LoadCase, Relief};
use super::load_checks::{check_finite, load_into_support, nothing_acts};
use super::mass::{Mass, MassProperties};
use super::modes::frequencies;
use super::options::SolveOptions;
use super::prepared_model::PreparedModel;
use super::reactions::{SolvedCase, reactions};
use super::relief::{Balance, RigidBody};
use super::report::{Clock, DisplacementSolution, SolveReport};
use super::scalar_points::{carry_to_grids, check_free_points, follow_grids};
use super::shape_checks::check_shapes;
use super::strain_of_cases::with_strain;
use super::support::{Support, contradictions};
use super::system::System;
use super::{Solution, UnitLoad};
use crate::finding::{Finding, Severity, list_few};
use crate::linalg::sparse::TreeWork;
use crate::model::Model;
use rayon::prelude::*;

/// Solutions whose epsilon is larger are refined by one step: below, rounding of a million unknowns leaves little to gain.
const REFINED_ABOVE: f64 = 1e-7;
/// Epsilon after refinement above which digits that a gauge reads may be lost, which a finding reports (the usual limit of Nastran users is 1e-3).
const INACCURATE_ABOVE: f64 = 1e-6;

/// Solves unit loads on the free structure, subcases numbered 1 .. n. Inertia balances each load.
///
/// # Errors
/// Returns every error of [`FeError`].
///
/// # Example
/// Two equal masses on a rod: a force `F` at one end accelerates both, so `F / 2` is the tension of the rod.
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
/// use strainbridge::fe::{UnitLoad, solve_unit_loads};
/// use strainbridge::model::{Model, Vec3};
///
/// # const DECK: &str = "SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.\nCBAR,1,1,1,2,0.,0.,1.
/// # PBAR,1,1,100.,2.+4,2.+4,1.+4\nMAT1,1,200000.,,.3\nCONM2,11,1,,1.\nCONM2,12,2,,1.\nENDDATA\n";
/// let deck = read_deck("rod.bdf", DECK.into(), &mut MemoryLoader::default());
/// let (model, _) = Model::from_deck(&deck);
/// let grid = model.grid_ix(2).unwrap();
/// let force = UnitLoad::AtGrid { grid, force: Vec3::x(), moment: Vec3::zeros() };
/// let (solution, report) = solve_unit_loads(&model, &[force], &Default::default())?;
///
/// let (bar, e, area) = (model.beam_ix(1).unwrap(), 200_000.0, 100.0);
/// let (_, axial) = solution.cases[0].beams.strain_at(bar, 0.5).unwrap();
/// assert!((axial / (0.5 / (e * area)) - 1.0).abs() < 1e-9);
/// assert!(report.balance[0].residual < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve_unit_loads(
    model: &Model,
    loads: &[UnitLoad],
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    solve_unit_loads_on(model, Support::without_spc(model), loads, options)
}

/// Solves unit loads on a structure with this support. Subcases are numbered 1 .. n.
///
/// # Errors
/// Returns every error of [`FeError`].
pub fn solve_unit_loads_on(
    model: &Model,
    support: Support,
    loads: &[UnitLoad],
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    solve_cases(model, &support.unit_cases(model, loads), options)
}

/// Solves load cases. Cases with equal constraints share one factor.
///
/// # Errors
/// Returns every error of [`FeError`].
pub fn solve_cases(
    model: &Model,
    cases: &[LoadCase],
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    let prepared = prepare(model, cases)?;
    let solved = displacements(&prepared, cases, options)?;
    with_strain(&prepared, cases, solved, options)
}

/// Solves load cases and returns their displacements without strain, the part of a solution worth storing.
///
/// # Errors
/// Returns every error of [`FeError`].
pub fn solve_displacements(
    model: &Model,
    cases: &[LoadCase],
    options: &SolveOptions,
) -> Result<DisplacementSolution, FeError> {
    displacements(&prepare(model, cases)?, cases, options)
}

/// Returns the strain of solved load cases.
///
/// # Errors
/// Returns every error of [`FeError`].
pub fn solution_of(
    model: &Model,
    cases: &[LoadCase],
    solved: DisplacementSolution,
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    with_strain(&prepare(model, cases)?, cases, solved, options)
}

pub(super) fn prepare<'a>(
    model: &'a Model,
    cases: &[LoadCase],
) -> Result<PreparedModel<'a>, FeError> {
    super::unsupported_cards::refuse(model, cases)?;
    Ok(PreparedModel::new(model))
}

pub(super) fn displacements(
    prepared: &PreparedModel<'_>,
    cases: &[LoadCase],
    options: &SolveOptions,
) -> Result<DisplacementSolution, FeError> {
    let model = prepared.model;
    let mass = Mass::new(prepared);
    let x: Vec<_> = model.grids.iter().map(|g| g.x).collect();
    let mut report = SolveReport {
        grids: model.grids.len(),
        mass: mass.properties(&x),
        ..SolveReport::default()
    };
    let mut findings = formulations(model);
    findings.extend(check_shapes(model));
    let mut fields: Vec<Vec<[f64; 6]>> = vec![Vec::new(); cases.len()];
    let mut done = vec![false; cases.len()];
    for first in 0..cases.len() {
        if done[first] {
            continue;
        }
        go_on(options)?;
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
    Ok(DisplacementSolution {
        displacements: fields,
        report,
        findings,
    })
}

/// Displacements (basic frame) of cases with the same constraints.
fn solve_group(
    prepared: &PreparedModel<'_>,
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
    findings.extend(contradictions(model, case.spc));
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
    let held = (&system, system.body.as_ref());
    let acting: Vec<CaseForces> = cases
        .par_iter()
        .map(|case| form_case_loads(prepared, mass, held, report.mass.as_ref(), case))
        .collect::<Result<_, FeError>>()?;
    let mut forces = Vec::with_capacity(cases.len());
    for acting in acting {
        report.balance.extend(acting.balance);
        findings.extend(acting.findings);
        forces.push(acting.forces);
    }
    columns
        .par_chunks_exact_mut(n.max(1))
        .zip(&forces)
        .try_for_each(|(column, f)| system.pack(prepared, f.clone(), column))?;
    clock.note(report, "loads");
    go_on(options)?;
    if report.dofs < n {
        report.dofs = n;
        report.factor_nonzeros = system.symbolic.factor_nonzeros();
        report.ordering = Some(system.symbolic.method());
    }
    // Cases with loads on springs of AUTOSPC. A finding already states why their reactions don't balance.
    let mut lost = Vec::new();
    if n == 0 {
        findings.push(nothing_free(cases));
    } else {
        let stiffness = std::mem::take(&mut system.stiffness);
        let factor = system.factor(prepared, mass, stiffness)?;
        clock.note(report, "factor");
        go_on(options)?;
        report.smallest_pivot = factor.smallest_pivot;
        let sizes: Vec<Option<[f64; 2]>> = columns
            .par_chunks_exact(n)
            .map(|acting| system.sizes_of(model, acting))
            .collect();
        let refined = factor.solve_refined(&mut columns, REFINED_ABOVE);
        clock.note(report, "substitute");
        go_on(options)?;
        for (case, refined) in cases.iter().zip(refined) {
            report.epsilon[0] = report.epsilon[0].max(refined.first);
            report.epsilon[1] = report.epsilon[1].max(refined.last);
            findings.extend(check_accuracy(case.subcase, refined.last));
        }
        for ((case, moved), sizes) in cases.iter().zip(columns.chunks_exact(n)).zip(sizes) {
            let Some(sizes) = sizes else { continue };
            let finding = system.held_loads(model, case.subcase, sizes, moved);
            lost.extend(finding.is_some().then_some(case.subcase));
            findings.extend(finding);
        }
        let still = system.reduction.enforced.is_empty() && report.mass.is_some();
        if options.modes > 0 && report.modes.is_empty() && still {
            report.modes = frequencies(
                prepared,
                mass,
                &system,
                &factor,
                (options.modes, &options.stop),
            )?;
            clock.note(report, "modes");
        }
    }
    let fields: Vec<Vec<[f64; 6]>> = (0..cases.len())
        .into_par_iter()
        .map(|i| {
            let mut u = system.unpack(prepared, &columns[n * i..n * (i + 1)]);
            if let (Some(body), Relief::Automatic) = (&system.body, case.relief) {
                body.take_out(mass, &mut u);
                follow_grids(prepared, &system.reduction, &mut u);
            }
            check_finite(
                cases[i].subcase,
                "displacements",
                u.iter().flatten().copied(),
            )?;
            Ok(u)
        })
        .collect::<Result<_, FeError>>()?;
    let answers: Vec<SolvedCase<'_>> = cases
        .iter()
        .zip(fields.iter().zip(&forces))
        .map(|(c, (u, f))| (c.subcase, u.as_slice(), f.as_slice()))
        .collect();
    let selected = |sid: u32| Some(sid) == case.mpc;
    let mpc = (model.mpcs.iter()).any(|s| selected(s.sid) && !s.equations.is_empty());
    let reactions = reactions(prepared, &system, &answers, mpc)?;
    if !reactions.is_empty() {
        clock.note(report, "reactions");
    }
    for (reactions, finding) in reactions {
        findings.extend(finding.filter(|_| !lost.contains(&reactions.subcase)));
        report.reactions.push(reactions);
    }
    Ok(fields)
}

/// Checks for cancellation.
pub(super) fn go_on(options: &SolveOptions) -> Result<(), FeError> {
    match options.stop.is_asked() {
        true => Err(FeError::Stopped),
        false => Ok(()),
    }
}

/// Returns the finding on a structure whose dofs are all held.
fn nothing_free(cases: &[&LoadCase]) -> Finding {
    let ids: Vec<String> = cases.iter().map(|c| c.subcase.to_string()).collect();
    Finding::new(
        Severity::Warning,
        "every-dof-held",
        format!("subcases {}", list_few(&ids)),
        "supports hold every degree of freedom, so that loads cause no strain",
        "hold the structure only where its supports are",
    )
}

fn check_accuracy(subcase: u32, epsilon: f64) -> Option<Finding> {
    (!(epsilon <= INACCURATE_ABOVE)).then(|| {
        Finding::new(
            Severity::Warning,
            "inaccurate-solution",
            format!("subcase {subcase}"),
            "after a step of iterative refinement the equations are not satisfied to six digits: stiffnesses of very different size are \
             connected, or the structure is a long chain of elements",
            "check for springs or bars that are many orders stiffer than the connected parts, and make them rigid elements; of a part a \
             hundred times as long as wide, coarsen the mesh along it",
        )
        .with_numbers(epsilon, INACCURATE_ABOVE)
    })
}

/// Forces on the structure in a case.
pub(super) struct CaseForces {
    /// Forces by grid, basic frame. They include inertia forces that balance the loads.
    pub(super) forces: Vec<[f64; 6]>,
    pub(super) balance: Option<Balance>,
    pub(super) findings: Vec<Finding>,
}

/// Returns the loads of a case, balanced by the inertia of `body` if there is one.
///
/// # Errors
/// Loads at dofs that no element holds; numbers that are too large; sets that the deck lacks.
pub(super) fn form_case_loads(
    prepared: &PreparedModel<'_>,
    mass: &Mass,
    (system, body): (&System, Option<&RigidBody>),
    weight: Option<&MassProperties>,
    case: &LoadCase,
) -> Result<CaseForces, FeError> {
    let model = prepared.model;
    let mut f = applied_forces(prepared, mass, case)?;
    check_finite(case.subcase, "loads", f.iter().flatten().copied())?;
    system.loads_on_nothing(model, &prepared.axes, case.subcase, &f)?;
    let mut findings: Vec<Finding> = nothing_acts(model, case, &f, weight).into_iter().collect();
    findings.extend(load_into_support(
        model,
        &prepared.axes,
        &system.reduction,
        case,
    ));
    carry_to_grids(prepared, &system.reduction, &mut f);
    let mut balance = None;
    if let Some(body) = body {
        check_free_points(model, &system.reduction, case.subcase, &f)?;
        let before = largest_component(&f);
        balance = Some(body.balance(case.subcase, mass, &mut f));
        if largest_component(&f) <= 1e-9 * before && before > 0.0 {
            findings.push(Finding::new(
                Severity::Warning,
                "load-is-inertia-only",
                format!("subcase {}", case.subcase),
                "the loads only accelerate the free structure as a rigid body, as gravity does: its strain is zero",
                "hold the structure by an SPC set, or apply the forces that carry the weight",
            ));
        }
    }
    Ok(CaseForces {
        forces: f,
        balance,
        findings,
    })
}

/// Returns the work of factoring the free structure, its longest chain, and the work of the busiest of 1, 2, 4, .. 64 threads. See
/// `Symbolic::tree_work`.
///
/// # Errors
/// Returns every error of [`FeError`].
pub fn factor_on_paper(model: &Model) -> Result<(TreeWork, Vec<(usize, f64)>), FeError> {
    let prepared = PreparedModel::new(model);
    let mass = Mass::new(&prepared);
    let sets = (None, None, [].as_slice());
    let system = System::new(&prepared, &mass, sets, Relief::Automatic, &mut Vec::new())?;
    let with = |e: u32| (1 << e, system.symbolic.work_with(1 << e));
    Ok((system.symbolic.tree_work(), (0..=6).map(with).collect()))
}

/// A matrix as its order and entries of its lower triangle: row, column, value.
pub type Triplets = (usize, Vec<(usize, usize, f64)>);

/// Returns the stiffness of the free structure with a statically determinate support, to compare factorisations with other programs.
///
/// # Errors
/// Returns every error of [`FeError`].
pub fn supported_stiffness(model: &Model) -> Result<Triplets, FeError> {
    let prepared = PreparedModel::new(model);
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
