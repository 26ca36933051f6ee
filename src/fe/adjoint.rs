//! Changes of strain readings by changes of the stiffness of some shells, to first order, at the cost of one solution.
//!
//! With `K u = f` and a reading `r = b' u`, let `K l = b` (the adjoint: the structure under the forces `b`). If the stiffness of shells
//! `e` is multiplied by `1 + d`, the reading changes by `-d sum_e l' K_e u` and terms of `d^2`. One factor serves loads and readings, and any
//! number of sets of shells costs no further solution.
//!
//! # Reference
//! E. J. Haug, K. K. Choi, V. Komkov, Design Sensitivity Analysis of Structural Systems, 1986, section 1.2 (adjoint variables).

use super::element::shell::{AnyShell, Parts, shell_matrices, surfaces};
use super::error::{FeError, Refusal};
use super::load_case::LoadCase;
use super::options::SolveOptions;
use super::prepared_model::PreparedModel;
use super::shell_frame::ShellPlace;
use super::solve::solve_displacements;
use super::strain_tensor::Surface;
use super::support::Support;
use super::{PlaneStrain, UnitLoad};
use crate::model::{ElementRef, GridIx, Model, ShellIx, Vec3};
use rayon::prelude::*;

/// A part of a reading: `coefficient . (exx, eyy, gxy)` of a shell, in the frame of its strain output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainTerm {
    /// Shell of the term.
    pub shell: ShellIx,
    /// Side.
    pub surface: Surface,
    /// Centre or corner.
    pub place: ShellPlace,
    /// Weights.
    pub coefficient: PlaneStrain,
}

/// Displacements under loads and under the adjoint forces of readings.
#[derive(Debug)]
pub struct Adjoint<'a> {
    prepared: PreparedModel<'a>,
    /// Forces of each load. Empty for temperatures, because their forces come from the elements and change with these.
    loads: Vec<Vec<[f64; 6]>>,
    /// Forces of each reading.
    readings: Vec<Vec<[f64; 6]>>,
}

impl<'a> Adjoint<'a> {
    /// Solves `loads` and `readings` on one factor.
    ///
    /// # Errors
    /// See [`FeError`].
    pub fn solve(
        model: &'a Model,
        support: Support,
        loads: &[UnitLoad],
        readings: &[Vec<StrainTerm>],
        options: &SolveOptions,
    ) -> Result<Self, FeError> {
        let prepared = PreparedModel::new(model);
        let mut cases = support.unit_cases(model, loads);
        let Some(first) = cases.first().cloned() else {
            return Err(FeError::Empty);
        };
        for terms in readings {
            let forces = forces_of(&prepared, terms).map_err(|r| FeError::Refused(vec![r]))?;
            let acts = |(grid, f): &(GridIx, [f64; 6])| UnitLoad::AtGrid {
                grid: *grid,
                force: Vec3::new(f[0], f[1], f[2]),
                moment: Vec3::new(f[3], f[4], f[5]),
            };
            cases.push(LoadCase {
                subcase: u32::try_from(cases.len() + 1).unwrap_or(u32::MAX),
                loads: forces.iter().map(acts).collect(),
                ..first.clone()
            });
        }
        let mut solved = solve_displacements(model, &cases, options)?.displacements;
        let readings = solved.split_off(loads.len());
        for (u, load) in solved.iter_mut().zip(loads) {
            if matches!(load, UnitLoad::Temperature { .. }) {
                u.clear();
            }
        }
        Ok(Self {
            prepared,
            loads: solved,
            readings,
        })
    }

    /// Returns the model.
    pub fn model(&self) -> &Model {
        self.prepared.model
    }

    /// Returns the derivative of every reading under every load by the design variable `d`, `n_readings x n_loads` by rows, strain per unit load.
    /// Temperatures contribute zero.
    ///
    /// # Errors
    /// Shells that can't be formed.
    pub fn change(&self, shells: &[usize]) -> Result<Vec<f64>, FeError> {
        let (n_r, n_l) = (self.readings.len(), self.loads.len());
        let mut out = vec![0.0; n_r * n_l];
        for &s in shells {
            let k = self.prepared.stiffness(ElementRef::Shell(s));
            let k = k.map_err(|r| FeError::Refused(vec![r]))?;
            let n = k.n();
            let local =
                |u: &[[f64; 6]]| -> Vec<f64> { k.grids.iter().flat_map(|g| u[g.us()]).collect() };
            let force = |u: &Vec<[f64; 6]>| -> Option<Vec<f64>> {
                let u = (!u.is_empty()).then(|| local(u))?;
                let row = |row: &[f64]| row.iter().zip(&u).map(|(a, b)| a * b).sum();
                Some(k.values.chunks_exact(n).map(row).collect())
            };
            let forces: Vec<Option<Vec<f64>>> = self.loads.iter().map(force).collect();
            for (row, l) in out.chunks_exact_mut(n_l.max(1)).zip(&self.readings) {
                let l = local(l);
                for (cell, f) in row.iter_mut().zip(&forces) {
                    let work = |f: &Vec<f64>| f.iter().zip(&l).map(|(a, b)| a * b).sum::<f64>();
                    *cell -= f.as_ref().map_or(0.0, work);
                }
            }
        }
        Ok(out)
    }

    /// [`Self::change`] of many sets of shells, on all threads.
    ///
    /// # Errors
    /// Shells that can't be formed.
    pub fn changes(&self, sets: &[&[usize]]) -> Result<Vec<Vec<f64>>, FeError> {
        sets.par_iter().map(|set| self.change(set)).collect()
    }
}

/// Returns the adjoint forces of a reading: the derivative of the reading by the displacement of each grid of its shells.
pub(super) fn forces_of(
    prepared: &PreparedModel<'_>,
    terms: &[StrainTerm],
) -> Result<Vec<(GridIx, [f64; 6])>, Refusal> {
    let mut out = Vec::new();
    for t in terms {
        let Some(shell) = prepared.model.shells.get(t.shell.us()) else {
            continue;
        };
        let fibres = prepared.model.fibres(shell);
        let z = fibres.distances_at(match t.place {
            ShellPlace::Centre => None,
            ShellPlace::Corner(k) => Some(k),
        });
        let free = [[0.0; 3]; 2];
        let matrices = shell_matrices(prepared, t.shell.us(), Parts::WithoutStiffness, None)?;
        let strain = |u: &[f64]| -> [PlaneStrain; 2] {
            match (&matrices, t.place) {
                (AnyShell::Quad(m), place) => {
                    let u: [f64; 24] = std::array::from_fn(|i| u[i]);
                    match place {
                        ShellPlace::Centre => surfaces(&m.centre, z, &u, &free),
                        ShellPlace::Corner(k) => surfaces(&m.corners[k.min(3)], z, &u, &free),
                    }
                }
                (AnyShell::Tria(m), _) => {
                    let u: [f64; 18] = std::array::from_fn(|i| u[i]);
                    // The solution gives every corner of a triangle the strain of the triangle's centre.
                    surfaces(&m.centre, fibres.centre, &u, &free)
                }
                (AnyShell::Many(m), ShellPlace::Centre) => m.centre.surfaces(z, u, &free),
                (AnyShell::Many(m), ShellPlace::Corner(k)) => {
                    m.corners.get(k).unwrap_or(&m.centre).surfaces(z, u, &free)
                }
            }
        };
        let grids: Vec<GridIx> = match &matrices {
            AnyShell::Quad(_) => shell.grids[..4].to_vec(),
            AnyShell::Tria(_) => shell.grids[..3].to_vec(),
            AnyShell::Many(_) => shell.all_grids().to_vec(),
        };
        let mut unit = vec![0.0; 6 * grids.len()];
        for (g, grid) in grids.iter().enumerate() {
            let mut force = [0.0; 6];
            for (dof, force) in force.iter_mut().enumerate() {
                unit[6 * g + dof] = 1.0;
                let e = strain(&unit)[t.surface.ix()];
                *force = e.iter().zip(t.coefficient).map(|(e, c)| e * c).sum();
                unit[6 * g + dof] = 0.0;
            }
            out.push((*grid, force));
        }
    }
    Ok(out)
}
