//! Solves variants of a model with a different stiffness of some elements, using the factor of the model.
//!
//! With K factored, the changed structure is `(K + D) u = f'`, where D is zero except at the changed elements. Conjugate gradients with K as
//! preconditioner solve it. The eigenvalues of `K^-1 (K + D)` are between 1 and the factors by which the elements' stiffness changed. Halved or
//! doubled stiffness therefore takes ten steps whatever the size of the model. A step is one substitution and one product with D; K itself is never
//! multiplied, as `K p` follows from the residuals.
//!
//! # References
//! M. R. Hestenes, E. Stiefel, Methods of conjugate gradients for solving linear systems, J. Res. NBS 49 (1952). U. Kirsch, Combined
//! approximations, Struct. Optim. 20 (2000): the same subspace as reanalysis.

use super::applied_loads::{check_sets, enforced_of};
use super::element::ElementMatrix;
use super::error::FeError;
use super::load_case::{LoadCase, Relief};
use super::load_checks::check_finite;
use super::mass::Mass;
use super::options::SolveOptions;
use super::prepared_model::PreparedModel;
use super::report::{DisplacementSolution, SolveReport};
use super::scalar_points::follow_grids;
use super::solve::{displacements, form_case_loads, go_on, prepare};
use super::strain_of_cases::with_strain;
use super::support::Support;
use super::system::System;
use super::{Solution, UnitLoad};
use crate::linalg::sparse::{BlockMatrix, Factor};
use crate::model::{Bush, ElementRef, MaterialIx, Model, ShellKind};
use rayon::prelude::*;

/// Error of a change of displacements over the change, in the norm of the energy.
const TOLERANCE: f64 = 1e-8;
/// Number of steps after which a variant gets a separate factor: stiffness that changed a hundredfold.
const MOST_STEPS: usize = 40;

/// Solves unit loads on each variant of `base` and calls `read` with the variant and its solution, one variant after the other.
///
/// Variants that differ only in the stiffness of shells or bushes share the factor of `base`. Any other variant has its own factor, and so has a
/// single variant. In the energy norm, displacements agree with the displacements from a separate factor to 1e-8 of the change.
///
/// # Errors
/// See [`FeError`].
pub fn solve_variants<T>(
    base: &Model,
    support: Support,
    loads: &[UnitLoad],
    variants: impl ExactSizeIterator<Item = Model>,
    options: &SolveOptions,
    mut read: impl FnMut(&Model, &Solution) -> T,
) -> Result<Vec<T>, FeError> {
    let cases = support.unit_cases(base, loads);
    let prepared = prepare(base, &cases)?;
    let mass = Mass::new(&prepared);
    let mut system = match variants.len() {
        0 | 1 => None,
        _ => system_of(&prepared, &mass, &cases)?,
    };
    let matrix = system.as_mut().map(|s| std::mem::take(&mut s.stiffness));
    let base = match (&system, matrix) {
        (Some(system), Some(matrix)) => {
            go_on(options)?;
            Some(Base::new(&prepared, &mass, system, matrix, &cases)?)
        }
        _ => None,
    };
    let mut out = Vec::new();
    for variant in variants {
        go_on(options)?;
        let prepared = prepare(&variant, &cases)?;
        let solved = match &base {
            Some(base) => base.displacements(&prepared, &cases, options)?,
            None => None,
        };
        let solved = match solved {
            Some(solved) => solved,
            None => displacements(&prepared, &cases, options)?,
        };
        let (solution, _) = with_strain(&prepared, &cases, solved, options)?;
        out.push(read(&variant, &solution));
    }
    Ok(out)
}

/// Returns the constrained stiffness that all cases share. `None` if the cases have different constraints, if a displacement is enforced, or if no
/// dof is free.
pub(super) fn system_of(
    prepared: &PreparedModel<'_>,
    mass: &Mass,
    cases: &[LoadCase],
) -> Result<Option<System>, FeError> {
    let Some(first) = cases.first() else {
        return Ok(None);
    };
    check_sets(prepared.model, &cases.iter().collect::<Vec<_>>())?;
    let alike = |c: &LoadCase| {
        (c.spc, c.mpc, c.relief) == (first.spc, first.mpc, first.relief)
            && enforced_of(prepared.model, c).is_empty()
    };
    if !cases.iter().all(alike) {
        return Ok(None);
    }
    let sets = (first.spc, first.mpc, [].as_slice());
    let system = System::new(prepared, mass, sets, first.relief, &mut Vec::new())?;
    let shared = system.reduction.enforced.is_empty() && system.symbolic.n_unknowns() > 0;
    Ok(shared.then_some(system))
}

/// Solution of the structure from which the variants differ.
pub(super) struct Base<'a> {
    pub(super) model: &'a Model,
    pub(super) prepared: &'a PreparedModel<'a>,
    pub(super) system: &'a System,
    pub(super) factor: Factor<'a>,
    /// Balanced loads at the unknowns, one column for each case.
    pub(super) forces: Vec<f64>,
    /// Displacements at the unknowns.
    pub(super) moved: Vec<f64>,
}

impl<'a> Base<'a> {
    pub(super) fn new(
        prepared: &'a PreparedModel<'a>,
        mass: &Mass,
        system: &'a System,
        matrix: BlockMatrix,
        cases: &[LoadCase],
    ) -> Result<Self, FeError> {
        let factor = system.factor(prepared, mass, matrix)?;
        let mut base = Self {
            model: prepared.model,
            prepared,
            system,
            factor,
            forces: Vec::new(),
            moved: Vec::new(),
        };
        base.forces = base.forces_on(prepared, mass, cases)?.0;
        base.moved = base.forces.clone();
        base.factor.solve(&mut base.moved);
        Ok(base)
    }

    /// Returns the loads of cases on a variant at the unknowns, and the report on these loads.
    pub(super) fn forces_on(
        &self,
        variant: &PreparedModel<'_>,
        mass: &Mass,
        cases: &[LoadCase],
    ) -> Result<(Vec<f64>, VariantLoadReport), FeError> {
        let relief = cases.first().map_or(Relief::None, |c| c.relief);
        let body = self.system.body_of(variant, mass, relief)?;
        let x: Vec<_> = variant.model.grids.iter().map(|g| g.x).collect();
        let weight = mass.properties(&x);
        let all: Vec<_> = cases
            .par_iter()
            .map(|case| {
                let system = (self.system, body.as_ref());
                form_case_loads(variant, mass, system, weight.as_ref(), case)
            })
            .collect::<Result<_, FeError>>()?;
        let n = self.system.symbolic.n_unknowns();
        let mut columns = vec![0.0; n * cases.len()];
        let mut report = SolveReport {
            grids: variant.model.grids.len(),
            mass: weight,
            ..SolveReport::default()
        };
        let mut findings = Vec::new();
        for (column, acting) in columns.chunks_exact_mut(n).zip(all) {
            self.system.pack(variant, acting.forces, column)?;
            report.balance.extend(acting.balance);
            findings.extend(acting.findings);
        }
        let loaded = VariantLoadReport {
            body,
            report,
            findings,
        };
        Ok((columns, loaded))
    }

    /// Displacements of a variant; `None` where this factor doesn't serve it.
    fn displacements(
        &self,
        variant: &PreparedModel<'_>,
        cases: &[LoadCase],
        options: &SolveOptions,
    ) -> Result<Option<DisplacementSolution>, FeError> {
        let Some(elements) = changed_elements(self.model, variant.model) else {
            return Ok(None);
        };
        let change = self.change(variant, &elements)?;
        let mass = Mass::new(variant);
        let (forces, loaded) = self.forces_on(variant, &mass, cases)?;
        let Some(columns) = self.iterate_to_convergence(&change, &forces, options)? else {
            return Ok(None);
        };
        let n = self.system.symbolic.n_unknowns();
        let fields = columns
            .par_chunks_exact(n)
            .zip(cases)
            .map(|(column, case)| {
                let mut u = self.system.unpack(variant, column);
                if let (Some(body), Relief::Automatic) = (&loaded.body, case.relief) {
                    body.take_out(&mass, &mut u);
                    follow_grids(variant, &self.system.reduction, &mut u);
                }
                check_finite(case.subcase, "displacements", u.iter().flatten().copied())?;
                Ok(u)
            });
        Ok(Some(DisplacementSolution {
            displacements: fields.collect::<Result<_, FeError>>()?,
            report: loaded.report,
            findings: loaded.findings,
        }))
    }

    /// Returns the change of the stiffness of each element in a variant, basic frame.
    pub(super) fn change(
        &self,
        variant: &PreparedModel<'_>,
        elements: &[ElementRef],
    ) -> Result<Vec<ElementMatrix>, FeError> {
        let of = |e: &ElementRef| {
            let (old, mut new) = (self.prepared.stiffness(*e)?, variant.stiffness(*e)?);
            let both = new.values.iter_mut().zip(&old.values);
            both.for_each(|(new, old)| *new -= old);
            Ok(new)
        };
        let all: Result<_, _> = elements.par_iter().map(of).collect();
        all.map_err(|r| FeError::Refused(vec![r]))
    }

    /// Returns the displacements at the unknowns under `forces`, a column for each case. `None` if they do not converge in [`MOST_STEPS`], or the
    /// variant has a motion without support.
    fn iterate_to_convergence(
        &self,
        change: &[ElementMatrix],
        forces: &[f64],
        options: &SolveOptions,
    ) -> Result<Option<Vec<f64>>, FeError> {
        let n = self.system.symbolic.n_unknowns();
        let mut x = self.moved.clone();
        let mut r = self.product(change, &x)?;
        let left = r.par_iter_mut().zip(forces).zip(&self.forces);
        left.for_each(|((r, new), old)| *r = new - old - *r);
        let mut z = r.clone();
        self.factor.solve(&mut z);
        let mut work = dots(&r, &z, n);
        let enough: Vec<f64> = work.iter().map(|w| w * TOLERANCE * TOLERANCE).collect();
        // `p` is the search direction, `kp` is K times `p`.
        let (mut p, mut kp) = (z.clone(), r.clone());
        for _ in 0..MOST_STEPS {
            if work.iter().zip(&enough).all(|(w, e)| w <= e) {
                return Ok(Some(x));
            }
            go_on(options)?;
            let mut q = self.product(change, &p)?;
            q.par_iter_mut().zip(&kp).for_each(|(q, k)| *q += k);
            let resisted = dots(&p, &q, n);
            let open = || work.iter().zip(&enough).map(|(w, e)| w > e);
            if open().zip(&resisted).any(|(open, pq)| open && !(*pq > 0.0)) {
                return Ok(None);
            }
            let share = |open: bool, a: f64, b: f64| if open { a / b } else { 0.0 };
            let alpha: Vec<f64> = open()
                .zip(work.iter().zip(&resisted))
                .map(|(open, (w, pq))| share(open, *w, *pq))
                .collect();
            add(&mut x, &alpha, &p, n);
            let back: Vec<f64> = alpha.iter().map(|a| -a).collect();
            add(&mut r, &back, &q, n);
            z.copy_from_slice(&r);
            self.factor.solve(&mut z);
            let next = dots(&r, &z, n);
            let beta: Vec<f64> = open()
                .zip(next.iter().zip(&work))
                .map(|(open, (new, old))| share(open, *new, *old))
                .collect();
            follow(&mut p, &beta, &z, n);
            follow(&mut kp, &beta, &r, n);
            work = next;
        }
        Ok(None)
    }

    /// Returns the product `D u` for columns of unknowns.
    pub(super) fn product(&self, change: &[ElementMatrix], u: &[f64]) -> Result<Vec<f64>, FeError> {
        let n = self.system.symbolic.n_unknowns();
        let mut out = vec![0.0; u.len()];
        let columns = out.par_chunks_exact_mut(n).zip(u.par_chunks_exact(n));
        columns.try_for_each(|(out, u)| {
            let u = self.system.unpack(self.prepared, u);
            let mut f = vec![[0.0; 6]; u.len()];
            for k in change {
                let own: Vec<f64> = k.grids.iter().flat_map(|g| u[g.us()]).collect();
                for (g, force) in k.grids.iter().zip(k.times(&own).chunks_exact(6)) {
                    f[g.us()].iter_mut().zip(force).for_each(|(f, v)| *f += v);
                }
            }
            self.system.pack(self.prepared, f, out)
        })?;
        Ok(out)
    }
}

/// Inertia, report and findings of a variant's load cases, without their forces.
pub(super) struct VariantLoadReport {
    body: Option<super::relief::RigidBody>,
    report: SolveReport,
    findings: Vec<crate::finding::Finding>,
}

/// Returns `a' b`, column by column.
fn dots(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let columns = a.par_chunks_exact(n).zip(b.par_chunks_exact(n));
    columns.map(dot).collect()
}

pub(super) fn dot((a, b): (&[f64], &[f64])) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Adds `factor * more` to `to`, column by column.
fn add(to: &mut [f64], factors: &[f64], more: &[f64], n: usize) {
    let columns = to.par_chunks_exact_mut(n).zip(more.par_chunks_exact(n));
    columns.zip(factors).for_each(|((to, more), f)| {
        to.iter_mut().zip(more).for_each(|(t, m)| *t += f * m);
    });
}

/// Column by column `to = more + factor * to`.
fn follow(to: &mut [f64], factors: &[f64], more: &[f64], n: usize) {
    let columns = to.par_chunks_exact_mut(n).zip(more.par_chunks_exact(n));
    columns.zip(factors).for_each(|((to, more), f)| {
        to.iter_mut().zip(more).for_each(|(t, m)| *t = m + f * *t);
    });
}

/// Returns the shells and bushes whose stiffness differs. `None` if a variant changes anything else that stiffness, constraints or numbering depend
/// on.
pub(super) fn changed_elements(a: &Model, b: &Model) -> Option<Vec<ElementRef>> {
    let material = |m: MaterialIx| a.materials.get(m.us()) == b.materials.get(m.us());
    let same = a.grids == b.grids
        && a.frames == b.frames
        && (&a.beams, &a.beam_properties) == (&b.beams, &b.beam_properties)
        && (&a.rods, &a.joints, &a.springs) == (&b.rods, &b.joints, &b.springs)
        && (&a.scalar_masses, &a.normals) == (&b.scalar_masses, &b.normals)
        && (&a.solids, &a.solid_properties) == (&b.solids, &b.solid_properties)
        && (&a.shear_panels, &a.rigids) == (&b.shear_panels, &b.rigids)
        && (&a.mpcs, &a.spcs, &a.suports) == (&b.mpcs, &b.spcs, &b.suports)
        && (&a.params, a.mpc) == (&b.params, b.mpc)
        && a.beam_properties.iter().all(|p| material(p.material))
        && a.rods.iter().all(|r| material(r.material))
        && a.solid_properties.iter().all(|p| material(p.material))
        && a.shear_panels.iter().all(|p| material(p.material))
        && (a.shells.len(), a.bushes.len()) == (b.shells.len(), b.bushes.len());
    if !same {
        return None;
    }
    let properties: Vec<bool> = a
        .shell_properties
        .iter()
        .zip(&b.shell_properties)
        .map(|(p, q)| p == q && materials_of(&p.kind).into_iter().all(material))
        .collect();
    let mut out = Vec::new();
    for (i, (old, new)) in a.shells.iter().zip(&b.shells).enumerate() {
        if (old.shape, old.grids) != (new.shape, new.grids) {
            return None;
        }
        if old != new || properties.get(old.property.us()) != Some(&true) {
            out.push(ElementRef::Shell(i));
        }
    }
    for (i, (old, new)) in a.bushes.iter().zip(&b.bushes).enumerate() {
        let placed = |b: &Bush| (b.grids, b.axes, b.location, b.rigid);
        if placed(old) != placed(new) {
            return None;
        }
        if old != new {
            out.push(ElementRef::Bush(i));
        }
    }
    Some(out)
}

fn materials_of(kind: &ShellKind) -> Vec<MaterialIx> {
    match kind {
        ShellKind::Homogeneous {
            membrane,
            bending,
            shear,
            coupling,
            ..
        } => [membrane, bending, shear, coupling]
            .into_iter()
            .flatten()
            .copied()
            .collect(),
        ShellKind::Laminate { plies, .. } => plies.iter().map(|p| p.material).collect(),
    }
}
