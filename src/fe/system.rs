//! The constrained stiffness of a model, ready to be factored: what statics and free modes share.

use super::applied_loads::largest_component;
use super::assembly::{AssembledStiffness, Numbering, assemble};
use super::autospc::{EPZERO, Weak, autospc_finding, held_loads, load_sizes, weak_unknowns};
use super::constraint::{Reduction, Sets, State, reduce};
use super::error::{FeError, FreeDof};
use super::free_motions::find_structure_grids;
use super::grid_frames::{to_basic, to_local};
use super::load_case::Relief;
use super::mass::Mass;
use super::negative::negative_springs;
use super::prepared_model::PreparedModel;
use super::relief::RigidBody;
use super::what_hangs::what_hangs;
use crate::finding::{Finding, LISTED, Severity};
use crate::linalg::sparse::{BlockGraph, BlockMatrix, Factor, FactorError, Symbolic};
use crate::model::{GridIx, Mat3, Model};
use rayon::prelude::*;

/// Equations of a model: reduction, numbering and assembled stiffness, ready for the factor.
pub(super) struct System {
    pub(super) reduction: Reduction,
    numbering: Numbering,
    graph: BlockGraph,
    pub(super) symbolic: Symbolic,
    pub(super) stiffness: BlockMatrix,
    /// The free rigid motions, if inertia balances the loads.
    pub(super) body: Option<RigidBody>,
    weak: Vec<Weak>,
    /// SPC set, and the balance of loads that it does not take.
    support: (Option<u32>, Relief),
}

impl System {
    /// Assembles the stiffness under an SPC and an MPC set, with determinate supports if inertia balances the loads.
    ///
    /// Springs act as determinate supports, and at dofs without stiffness. Their stiffness has the size of the other stiffness at the grid. A
    /// balanced load causes no force in these springs, so the result equals the result of a rigid support.
    ///
    /// # Errors
    /// See [`FeError`].
    pub(super) fn new(
        prepared: &PreparedModel<'_>,
        mass: &Mass,
        sets: Sets<'_>,
        relief: Relief,
        findings: &mut Vec<Finding>,
    ) -> Result<Self, FeError> {
        let model = prepared.model;
        let support = (sets.0, relief);
        let reduction = reduce(model, &prepared.axes, sets)?;
        // The ordering of the unknowns leaves a thread idle. This thread computes the rigid body in the meantime.
        let (assembled, body) = rayon::join(
            || assemble(prepared, &reduction),
            || body(prepared, mass, &reduction, relief),
        );
        let (mut assembled, body) = (assembled?, body?);
        if let Some(body) = &body {
            findings.extend(ties(prepared, &assembled, body));
        }
        if body.is_none() && relief == Relief::Automatic && model.params.inrel == -2 {
            findings.push(relief_without_motion(sets.0));
        }
        let weak = weak_unknowns(&assembled, model.params.autospc);
        for w in &weak {
            assembled
                .stiffness
                .add_to_diagonal(&assembled.symbolic, w.unknown, w.k);
        }
        findings.extend(autospc_finding(model, &assembled, &weak));
        let supports = match (&body, relief) {
            (Some(body), Relief::Suport(set)) => {
                let dofs: Vec<_> = model
                    .suports
                    .iter()
                    .filter(|(sid, _)| sid.is_none() || *sid == set)
                    .flat_map(|(_, list)| list.iter().copied())
                    .collect();
                body.given_supports(
                    &prepared.axes,
                    &assembled.numbering,
                    assembled.symbolic.unknown_start(),
                    &dofs,
                )?
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
        let AssembledStiffness {
            numbering,
            graph,
            symbolic,
            stiffness,
        } = assembled;
        Ok(Self {
            reduction,
            numbering,
            graph,
            symbolic,
            stiffness,
            body,
            weak,
            support,
        })
    }

    /// Returns the free rigid motions of a structure with these constraints and its mass.
    ///
    /// # Errors
    /// See [`RigidBody::new`].
    pub(super) fn body_of(
        &self,
        prepared: &PreparedModel<'_>,
        mass: &Mass,
        relief: Relief,
    ) -> Result<Option<RigidBody>, FeError> {
        body(prepared, mass, &self.reduction, relief)
    }

    /// Factors the stiffness.
    ///
    /// # Errors
    /// Mechanisms, with each dof; entries that are not numbers; springs whose negative stiffness exceeds the remaining stiffness.
    pub(super) fn factor(
        &self,
        prepared: &PreparedModel<'_>,
        mass: &Mass,
        stiffness: BlockMatrix,
    ) -> Result<Factor<'_>, FeError> {
        let model = prepared.model;
        let diagonal = stiffness.diagonal_values(&self.symbolic);
        let negative = match diagonal.iter().all(|v| v.is_finite()) {
            true => negative_springs(model),
            false => Vec::new(),
        };
        let factor = match Factor::new(&self.symbolic, stiffness) {
            Ok(factor) => factor,
            // Negative stiffness can leave a pivot negative even with a spring at its unknown.
            Err(FactorError::NotANumber { .. }) if !negative.is_empty() => {
                return Err(FeError::Refused(negative));
            }
            Err(e) => return Err(self.translate_factor_error(model, e)),
        };
        if factor.lost.is_empty() {
            return Ok(factor);
        }
        let dofs = self.loose_dofs(prepared, mass, &factor);
        let mechanism = self.mechanism(model, &dofs);
        if negative.is_empty() {
            return Err(mechanism);
        }
        Err(FeError::Refused(
            negative.into_iter().chain(mechanism.faults()).collect(),
        ))
    }

    /// Returns the error for a mechanism: the dofs that nothing holds, and the parts that are not connected to the remaining structure.
    fn mechanism(&self, model: &Model, lost: &[(usize, usize)]) -> FeError {
        let dofs = lost
            .iter()
            .take(LISTED)
            .map(|&(g, dof)| {
                let grid = &model.grids[g];
                FreeDof {
                    grid: grid.id,
                    dof: dof as u8 + 1,
                    hangs: what_hangs(model, GridIx(g as u32)),
                    at: grid.at,
                }
            })
            .collect();
        let (of, count) = self.graph.components();
        let mut sizes = vec![0_usize; count];
        of.iter().for_each(|c| sizes[*c as usize] += 1);
        let main = sizes.iter().copied().max().unwrap_or(0);
        let mut parts = Vec::new();
        for (c, size) in sizes
            .iter()
            .enumerate()
            .filter(|(_, s)| count > 1 && **s < main)
            .take(LISTED)
        {
            let ids: Vec<String> = of
                .iter()
                .zip(&self.numbering.grid)
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
            spc: self.support.0,
            relief: self.support.1,
        }
    }

    /// Grid and dof (0 to 5) that move most in each mechanism.
    ///
    /// A spring holds every lost unknown, so a unit force there moves the structure in a mechanism. What it moves as a whole, where
    /// it is free, is taken out: the lighter part is left, and that is what hangs loose.
    fn loose_dofs(
        &self,
        prepared: &PreparedModel<'_>,
        mass: &Mass,
        factor: &Factor<'_>,
    ) -> Vec<(usize, usize)> {
        let n = self.symbolic.n_unknowns();
        let start = self.symbolic.unknown_start();
        let mut columns = vec![0.0; n * factor.lost.len()];
        for (column, &unknown) in columns.chunks_exact_mut(n.max(1)).zip(&factor.lost) {
            column[unknown] = 1.0;
        }
        let at_pivots = || factor.lost.iter().map(|u| self.numbering.dof_of(*u, start));
        factor.solve(&mut columns);
        let mut shapes: Vec<Vec<[f64; 6]>> = columns
            .par_chunks_exact(n.max(1))
            .map(|c| {
                let mut u = self.unpack(prepared, c);
                if let Some(body) = &self.body {
                    body.take_out(mass, &mut u);
                }
                u
            })
            .collect();
        let size = extent(prepared.model);
        let mut dofs = Vec::new();
        for (c, pivot) in at_pivots().enumerate() {
            let (found, rest) = shapes[c..].split_at_mut(1);
            let Some((g, dof)) = moves_most(&found[0], size) else {
                dofs.push(pivot);
                continue;
            };
            // Subtract this motion from the other motions, so that each gives the dof of a different motion.
            for other in rest {
                let share = other[g][dof] / found[0][g][dof];
                for (o, f) in other.iter_mut().zip(&found[0]) {
                    o.iter_mut().zip(f).for_each(|(o, f)| *o -= share * f);
                }
            }
            dofs.push((g, dof));
        }
        dofs
    }

    /// Translates an error of the factor to the grids and dofs of the model.
    pub(super) fn translate_factor_error(&self, model: &Model, error: FactorError) -> FeError {
        match error {
            FactorError::NotANumber { unknown } => {
                let start = self.symbolic.unknown_start();
                let grid = &model.grids[self.numbering.dof_of(unknown, start).0];
                FeError::NotANumber {
                    grid: grid.id,
                    at: grid.at,
                }
            }
            FactorError::TooLarge => FeError::TooLarge {
                unknowns: self.symbolic.n_unknowns(),
            },
        }
    }

    /// Computes `T' (f - K u0)` at the unknowns, from forces at all grids in the basic frame.
    ///
    /// # Errors
    /// Elements that can't be formed.
    pub(super) fn pack(
        &self,
        prepared: &PreparedModel<'_>,
        mut f: Vec<[f64; 6]>,
        out: &mut [f64],
    ) -> Result<(), FeError> {
        for (f, axes) in f.iter_mut().zip(&prepared.axes) {
            *f = to_local(axes, *f);
        }
        if !self.reduction.enforced.is_empty() {
            subtract_enforced(prepared, &self.reduction, &mut f)?;
        }
        self.numbering.pack(&self.reduction.gather(f), out);
        Ok(())
    }

    /// Returns the displacements of all grids, basic frame, from the unknowns.
    pub(super) fn unpack(&self, prepared: &PreparedModel<'_>, values: &[f64]) -> Vec<[f64; 6]> {
        let mut u = self.reduction.expand(&self.numbering.unpack(values));
        for (u, axes) in u.iter_mut().zip(&prepared.axes) {
            *u = to_basic(axes, *u);
        }
        u
    }

    /// # Errors
    /// A load on a dof that no element holds.
    pub(super) fn loads_on_nothing(
        &self,
        model: &Model,
        axes: &[Option<Mat3>],
        subcase: u32,
        f: &[[f64; 6]],
    ) -> Result<(), FeError> {
        let fault = |g: usize, dof: usize, softer: Option<f64>| FeError::LoadOnNothing {
            grid: model.grids[g].id,
            dof: dof as u8 + 1,
            subcase,
            softer,
            at: model.grids[g].at,
        };
        let limit = 1e-9 * largest_component(f);
        // Forces that rigid elements and averages transfer count at the dofs that receive them.
        let mut arrives = f.to_vec();
        for (f, axes) in arrives.iter_mut().zip(axes) {
            *f = to_local(axes, *f);
        }
        let arrives = self.reduction.gather(arrives);
        for (g, f) in arrives.iter().enumerate() {
            let unknown = |i: usize| {
                self.numbering.group[g]
                    .is_some_and(|group| self.numbering.free[group as usize] >> i & 1 == 1)
            };
            let loose = |i: usize| self.reduction.state[6 * g + i] == State::Free && !unknown(i);
            if let Some(i) = (0..6).find(|&i| f[i].abs() > limit && loose(i)) {
                return Err(fault(g, i, None));
            }
        }
        if self.weak.is_empty() {
            return Ok(());
        }
        let mut packed = vec![0.0; self.symbolic.n_unknowns()];
        self.numbering.pack(&arrives, &mut packed);
        for w in &self.weak {
            if w.load_along(&packed) > limit {
                let start = self.symbolic.unknown_start();
                let (g, dof) = self.numbering.dof_of(w.unknown, start);
                return Err(fault(g, dof, w.some.then_some(EPZERO)));
            }
        }
        Ok(())
    }

    /// Returns the sizes of loads at the unknowns that [`Self::held_loads`] compares with; `None` if AUTOSPC holds nothing.
    pub(super) fn sizes_of(&self, model: &Model, acting: &[f64]) -> Option<[f64; 2]> {
        (!self.weak.is_empty()).then(|| load_sizes(&self.numbering, acting, extent(model)))
    }

    /// Returns a finding if loads of these sizes act in directions that AUTOSPC holds; `moved` is at the unknowns.
    pub(super) fn held_loads(
        &self,
        model: &Model,
        subcase: u32,
        sizes: [f64; 2],
        moved: &[f64],
    ) -> Option<Finding> {
        let numbers = (&self.numbering, self.symbolic.unknown_start());
        held_loads(model, numbers, &self.weak, subcase, sizes, moved)
    }
}

/// The free rigid motions, where inertia balances loads.
fn body(
    prepared: &PreparedModel<'_>,
    mass: &Mass,
    reduction: &Reduction,
    relief: Relief,
) -> Result<Option<RigidBody>, FeError> {
    if relief == Relief::None {
        return Ok(None);
    }
    let touched = find_structure_grids(prepared.model, reduction);
    RigidBody::new(prepared.model, &prepared.axes, mass, reduction, &touched)
}

/// Returns the finding of PARAM,INREL,-2 on a structure whose supports leave no rigid motion free.
fn relief_without_motion(spc: Option<u32>) -> Finding {
    let held = spc.map_or("its supports".to_owned(), |set| format!("SPC set {set}"));
    Finding::new(
        Severity::Warning,
        "inertia-relief-unused",
        "PARAM,INREL",
        format!(
            "PARAM,INREL,-2 is stated, and {held} leaves no rigid motion free: inertia balances no load, and the supports take all of it"
        ),
        "delete PARAM,INREL if the structure is held, or select no SPC set if it is free",
    )
}

/// f - K u0 for enforced displacements, displacement frames.
fn subtract_enforced(
    prepared: &PreparedModel<'_>,
    reduction: &Reduction,
    f: &mut [[f64; 6]],
) -> Result<(), FeError> {
    let u0 = reduction.expand(&vec![[0.0; 6]; prepared.model.grids.len()]);
    for element in prepared.model.elements() {
        let grids = prepared.model.element_grids(element);
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

fn ties(
    prepared: &PreparedModel<'_>,
    assembled: &AssembledStiffness,
    body: &RigidBody,
) -> Option<Finding> {
    let diagonal = assembled.stiffness.diagonal_values(&assembled.symbolic);
    let worst = (0..body.n_free())
        .into_par_iter()
        .map(|column| {
            let motion = body.packed_motion(&prepared.axes, &assembled.numbering, column);
            let force = assembled.stiffness.times(&assembled.symbolic, &motion);
            let shares = force
                .iter()
                .zip(&diagonal)
                .map(|(f, d)| if *d > 0.0 { f.abs() / d } else { 0.0 });
            shares
                .zip(0..)
                .fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a })
        })
        .reduce(|| (0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
    let limit = 1e-7;
    let (grid, dof) = assembled
        .numbering
        .dof_of(worst.1, assembled.symbolic.unknown_start());
    (worst.0 > limit).then(|| {
        Finding::new(
            Severity::Error,
            "tied-to-ground",
            format!("grid {}", prepared.model.grids[grid].id),
            format!("a rigid motion of the structure is resisted here (dof {}), and no support or spring to ground is the cause: strain depends on it", dof + 1),
            "check for springs between grids that do not coincide, or MPC equations that forbid rigid motion",
        )
        .with_numbers(worst.0, limit)
    })
}

/// Largest side of the box around the grids.
fn extent(model: &Model) -> f64 {
    (0..3)
        .map(|i| {
            let along = model.grids.iter().map(|g| g.x[i]);
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            });
            high - low
        })
        .fold(0.0, f64::max)
}

/// The dof with the largest translation; where nothing but rotations move, that with the largest rotation.
fn moves_most(u: &[[f64; 6]], size: f64) -> Option<(usize, usize)> {
    let largest = |dofs: std::ops::Range<usize>| {
        let mut best = (0.0, None);
        for (g, u) in u.iter().enumerate() {
            for dof in dofs.clone() {
                if u[dof].is_finite() && u[dof].abs() > best.0 {
                    best = (u[dof].abs(), Some((g, dof)));
                }
            }
        }
        best
    };
    let (translation, rotation) = (largest(0..3), largest(3..6));
    if translation.0 > 1e-6 * rotation.0 * size {
        translation.1
    } else {
        rotation.1
    }
}
