//! Rigid motions of a model that neither its constraints nor springs to ground resist.
//!
//! A held dof and a spring to ground each resist the rigid motions that move them. Each gives a row of six numbers, of the order of one. The motions
//! that no row moves are free. Only whether a stiffness is zero matters, so that a soft spring counts like a stiff one.

use super::constraint::{Reduction, State, reduce};
use super::grid_frames::{grid_axes, to_local};
use super::ground::{Ground, anchors, grounds, to_anchors};
use super::rigid_motion::rigid_displacement;
use crate::finding::list_few;
use crate::linalg::{DMatrix, DVector, Matrix6, Vector6};
use crate::model::{ElementRef, GridIx, Mat3, Model, Vec3};
use std::ops::Range;

/// Largest resistance to a free rigid motion, as a share of the resistance to the motion that is resisted most.
const FREE_MOTION: f64 = 1e-10;

/// Returns the grids that belong to the structure: grids of elements, and grids tied to such grids.
pub(super) fn find_structure_grids(model: &Model, reduction: &Reduction) -> Vec<bool> {
    let mut touched = vec![false; model.grids.len()];
    for element in model.elements() {
        for g in model.element_grids(element) {
            touched[g.us()] = true;
        }
    }
    for (dof, state) in reduction.state.iter().enumerate() {
        if let State::Dependent(r) = state {
            touched[dof / 6] = true;
            for (held, _) in &reduction.rows[*r as usize].held {
                touched[(*held / 6) as usize] = true;
            }
        }
    }
    touched
}

/// Least motion of a dof under a unit motion that it can hold.
const LEAST_MOTION: f64 = 1e-6;

/// The structure that moves, and what may resist its rigid motions.
pub(super) struct RigidStructure<'a> {
    pub(super) model: &'a Model,
    pub(super) axes: &'a [Option<Mat3>],
    pub(super) reduction: &'a Reduction,
    /// Grids that belong to the structure, scalar points left out.
    pub(super) touched: &'a [bool],
    /// Point about which the motions rotate.
    pub(super) centre: Vec3,
    /// Largest distance of a grid from the centre.
    pub(super) size: f64,
}

impl RigidStructure<'_> {
    /// Returns the motions that nothing resists, one in each column: three translations, three rotations about the centre.
    pub(super) fn free_motions(&self) -> DMatrix<f64> {
        let mut resisted = self.by_constraints();
        self.add_springs(&mut resisted);
        self.null_space(resisted)
    }

    /// Returns how many of the motions that constraints leave free are resisted by springs to ground.
    pub(super) fn held_by_springs(&self) -> usize {
        let constrained = self.null_space(self.by_constraints()).ncols();
        constrained - self.free_motions().ncols().min(constrained)
    }

    /// Sum of the products of the rows of held dofs.
    fn by_constraints(&self) -> Matrix6<f64> {
        let anchors = anchors(self.model, self.reduction);
        let mut resisted = Matrix6::zeros();
        for g in (0..self.touched.len()).filter(|g| self.touched[*g] && !anchors[*g]) {
            for i in 0..6 {
                let held = match self.reduction.state[6 * g + i] {
                    State::Held => true,
                    State::Dependent(r) => self.reduction.rows[r as usize].free.is_empty(),
                    State::Free => false,
                };
                if held {
                    add(&mut resisted, self.row(g, i));
                }
            }
        }
        resisted
    }

    /// Adds the rows of springs to ground, and to grids that represent ground.
    fn add_springs(&self, resisted: &mut Matrix6<f64>) {
        for ground in self.springs() {
            match ground {
                Ground::Spring(spring, end, _) => {
                    if let Some((g, dof)) = self.model.springs[spring].ends[end] {
                        add(resisted, self.follow(g, usize::from(dof).min(5)));
                    }
                }
                Ground::Bush(i) => {
                    let bush = &self.model.bushes[i];
                    for (c, k) in bush.k.iter().enumerate() {
                        if *k != 0.0 {
                            add(
                                resisted,
                                self.displacement_at(&bush.location, &Some(bush.axes), c),
                            );
                        }
                    }
                }
            }
        }
    }

    /// Returns springs and bushes to ground, and to grids that represent ground.
    fn springs(&self) -> Vec<Ground> {
        let mut all = grounds(self.model, self.reduction);
        all.extend(to_anchors(self.model, self.reduction));
        all
    }

    /// Row of a dof of a grid, or of a scalar point that follows grids.
    fn follow(&self, g: GridIx, dof: usize) -> Vector6<f64> {
        let of = 6 * g.us() + dof;
        if !self.model.grids[g.us()].is_scalar() {
            return self.row(g.us(), dof);
        }
        let State::Dependent(r) = self.reduction.state[of] else {
            return Vector6::zeros();
        };
        let (mut sum, mut size) = (Vector6::zeros(), 0.0_f64);
        for (dof, share) in &self.reduction.rows[r as usize].free {
            let (g, i) = ((*dof / 6) as usize, (*dof % 6) as usize);
            if !self.model.grids[g].is_scalar() {
                sum += self.row(g, i) * *share;
                size = size.max(share.abs());
            }
        }
        sum / size.max(f64::MIN_POSITIVE)
    }

    fn row(&self, grid: usize, dof: usize) -> Vector6<f64> {
        self.displacement_at(&self.model.grids[grid].x, &self.axes[grid], dof)
    }

    /// Displacement in one component of a frame at a point, by motion; lengths counted in the size of the structure.
    fn displacement_at(&self, x: &Vec3, axes: &Option<Mat3>, component: usize) -> Vector6<f64> {
        let scale = if component >= 3 { self.size } else { 1.0 };
        Vector6::from_fn(|mode, _| {
            let moved = to_local(axes, rigid_displacement(mode, x, &self.centre))[component];
            moved * scale / if mode >= 3 { self.size } else { 1.0 }
        })
    }

    fn determinate_dofs(&self) -> Vec<(GridIx, u8)> {
        let basis = self.free_motions();
        let scaled = DMatrix::from_fn(6, basis.ncols(), |r, c| {
            basis[(r, c)] * if r >= 3 { self.size } else { 1.0 }
        });
        let mut held: Vec<DVector<f64>> = Vec::new();
        let mut chosen = Vec::new();
        while chosen.len() < basis.ncols() {
            let farthest = |dofs: Range<usize>| {
                let mut best = (LEAST_MOTION, None);
                for g in (0..self.touched.len()).filter(|g| self.touched[*g]) {
                    for i in dofs.clone() {
                        if self.reduction.state[6 * g + i] != State::Free {
                            continue;
                        }
                        let mut row = scaled.transpose() * self.row(g, i);
                        for h in &held {
                            row -= h * h.dot(&row);
                        }
                        if row.norm() > best.0 {
                            best = (row.norm(), Some((g, i, row)));
                        }
                    }
                }
                best.1
            };
            let Some((g, i, row)) = farthest(0..3).or_else(|| farthest(3..6)) else {
                break;
            };
            held.push(row.normalize());
            chosen.push((GridIx(g as u32), i as u8 + 1));
        }
        chosen
    }

    fn null_space(&self, resisted: Matrix6<f64>) -> DMatrix<f64> {
        let eigen = resisted.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        if largest == 0.0 {
            return DMatrix::identity(6, 6);
        }
        let free: Vec<usize> = (0..6)
            .filter(|&i| eigen.eigenvalues[i] <= FREE_MOTION * largest)
            .collect();
        DMatrix::from_fn(6, free.len(), |r, c| {
            eigen.eigenvectors[(r, free[c])] / if r >= 3 { self.size } else { 1.0 }
        })
    }
}

fn add(resisted: &mut Matrix6<f64>, row: Vector6<f64>) {
    *resisted += row * row.transpose();
}

/// Rigid motions of a model without a selected SPC set, grouped by what resists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HeldMotions {
    /// Motions that nothing resists.
    pub(super) free: usize,
    /// Motions that springs to ground resist, but no constraint of a grid.
    pub(super) by_springs: usize,
}

/// Calls `with` with the structure of a model that selects no SPC set. Returns `None` if the model's equations contradict each other; the solver
/// refuses such a model.
fn with_structure<T>(model: &Model, with: impl FnOnce(&RigidStructure<'_>) -> T) -> Option<T> {
    let axes = grid_axes(model);
    let reduction = reduce(model, &axes, (None, model.mpc, &[])).ok()?;
    let mut touched = find_structure_grids(model, &reduction);
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for (t, g) in touched.iter_mut().zip(&model.grids) {
        *t &= !g.is_scalar();
        if *t {
            (low, high) = (low.inf(&g.x), high.sup(&g.x));
        }
    }
    let size = (high - low).norm() / 2.0;
    Some(with(&RigidStructure {
        model,
        axes: &axes,
        reduction: &reduction,
        touched: &touched,
        centre: (low + high) / 2.0,
        size: if size > 0.0 && size.is_finite() {
            size
        } else {
            1.0
        },
    }))
}

/// Returns which rigid motions of a model are resisted by its springs to ground and by the permanent constraints of its grids.
pub(super) fn held_motions(model: &Model) -> HeldMotions {
    let unheld = HeldMotions {
        free: 6,
        by_springs: 0,
    };
    let held = model.grids.iter().any(|g| !g.ps.is_empty());
    if !held && model.springs.is_empty() && model.bushes.is_empty() {
        return unheld;
    }
    let held = with_structure(model, |structure| HeldMotions {
        free: structure.free_motions().ncols(),
        by_springs: structure.held_by_springs(),
    });
    held.unwrap_or(unheld)
}

/// Returns the grids and dofs (1 to 6) that hold the free motions of a model without an SPC set statically determinate. Each step takes the
/// translation that moves most under the motions not yet held, or a rotation if no translation moves.
pub fn determinate_dofs(model: &Model) -> Vec<(GridIx, u8)> {
    with_structure(model, |s| s.determinate_dofs()).unwrap_or_default()
}

/// Returns the names of a model's springs to ground as text (`CBUSH 2, CELAS2 7`).
pub(crate) fn springs_in_words(model: &Model) -> String {
    let all = with_structure(model, |s| s.springs()).unwrap_or_default();
    let named = all.iter().map(|ground| {
        let element = match ground {
            Ground::Spring(i, ..) => ElementRef::Spring(*i),
            Ground::Bush(i) => ElementRef::Bush(*i),
        };
        format!(
            "{} {}",
            model.element_word(element),
            model.element_id(element)
        )
    });
    list_few(&named.collect::<Vec<_>>())
}
