//! Changes of strain readings on models that differ in the stiffness of some elements, from one factor.

use super::UnitLoad;
use super::adjoint::{StrainTerm, forces_of};
use super::element::ElementMatrix;
use super::error::FeError;
use super::load_case::LoadCase;
use super::mass::Mass;
use super::options::SolveOptions;
use super::prepared_model::PreparedModel;
use super::solve::{go_on, prepare};
use super::support::Support;
use super::variants::{Base, changed_elements, dot, system_of};
use crate::linalg::DMatrix;
use crate::model::{ElementRef, GridIx, Model};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Computes the changes of readings (strain) on variants of `base`: by variant, `n_readings x n_loads` by rows. The changes are exact if only bushes
/// differ, else to first order.
///
/// With `K u = f`, a reading `r = b' u` and `K l = b`, a small change of K, f and b changes the reading by `(db)' u + l' (df - dK u)`. The error is
/// of the second order in the change. Bushes act between few dofs V, where their stiffness changes by the matrix W. The change of the reading is then
/// exactly `-l' V (1 + W V' K^-1 V)^-1 W V' u` (Woodbury). One factor of K serves all variants.
///
/// Returns `None` if variants differ from `base` in more than shells and bushes, have a motion without support, or if the loads have different
/// supports.
///
/// # Errors
/// See [`FeError`].
///
/// # References
/// E. J. Haug, K. K. Choi, V. Komkov, Design Sensitivity Analysis of Structural Systems, 1986, section 1.2 (adjoint variables). M. A. Akgun,
/// J. H. Garcelon, R. T. Haftka, Fast exact linear and non-linear structural reanalysis and the Sherman-Morrison-Woodbury formulas, Int. J. Numer.
/// Meth. Eng. 50 (2001).
pub fn reading_changes(
    base: &Model,
    support: Support,
    loads: &[UnitLoad],
    readings: &[Vec<StrainTerm>],
    variants: impl ExactSizeIterator<Item = Model>,
    options: &SolveOptions,
) -> Result<Option<Vec<Vec<f64>>>, FeError> {
    let cases = support.unit_cases(base, loads);
    let prepared = prepare(base, &cases)?;
    let mass = Mass::new(&prepared);
    let Some(mut system) = system_of(&prepared, &mass, &cases)? else {
        return Ok(None);
    };
    let matrix = std::mem::take(&mut system.stiffness);
    go_on(options)?;
    let base = Base::new(&prepared, &mass, &system, matrix, &cases)?;
    let forces = base.forces_of_readings(&prepared, readings)?;
    let mut moved = forces.clone();
    base.factor.solve(&mut moved);
    let mut adjoint = AdjointReadings {
        base: &base,
        forces,
        moved,
        dofs: BTreeMap::new(),
    };
    let mut out = Vec::new();
    for variant in variants {
        go_on(options)?;
        let Some(elements) = changed_elements(base.model, &variant) else {
            return Ok(None);
        };
        let prepared = prepare(&variant, &cases)?;
        let is_bush = |e: &ElementRef| matches!(e, ElementRef::Bush(_));
        let change = match !elements.is_empty() && elements.iter().all(is_bush) {
            true => adjoint.change_by_bushes(&base.change(&prepared, &elements)?)?,
            false => Some(adjoint.small_change(&prepared, &elements, &cases, readings)?),
        };
        let Some(change) = change else {
            return Ok(None);
        };
        out.push(change);
    }
    Ok(Some(out))
}

/// Unit forces at dofs of a grid, and the displacements that they cause, at the unknowns: a column a dof.
type GridColumns = (Vec<f64>, Vec<f64>);

/// Adjoint forces of readings and the displacements that they cause, at the unknowns, one column per reading.
struct AdjointReadings<'a> {
    base: &'a Base<'a>,
    forces: Vec<f64>,
    moved: Vec<f64>,
    /// By grid at which stiffness changes.
    dofs: BTreeMap<GridIx, GridColumns>,
}

impl AdjointReadings<'_> {
    /// The first-order change of all readings under all loads.
    fn small_change(
        &self,
        variant: &PreparedModel<'_>,
        elements: &[ElementRef],
        cases: &[LoadCase],
        readings: &[Vec<StrainTerm>],
    ) -> Result<Vec<f64>, FeError> {
        let base = self.base;
        let (forces, _) = base.forces_on(variant, &Mass::new(variant), cases)?;
        let mut acting = base.product(&base.change(variant, elements)?, &base.moved)?;
        let both = acting.par_iter_mut().zip(forces).zip(&base.forces);
        both.for_each(|((acting, new), old)| *acting = new - old - *acting);
        let mut changed = base.forces_of_readings(variant, readings)?;
        let both = changed.par_iter_mut().zip(&self.forces);
        both.for_each(|(new, old)| *new -= old);
        let n = base.system.symbolic.n_unknowns();
        let of_reading = |(b, l): (&[f64], &[f64])| -> Vec<f64> {
            let loads = base.moved.chunks_exact(n).zip(acting.chunks_exact(n));
            loads.map(|(u, f)| dot((b, u)) + dot((l, f))).collect()
        };
        let rows = changed
            .par_chunks_exact(n)
            .zip(self.moved.par_chunks_exact(n));
        let rows: Vec<Vec<f64>> = rows.map(of_reading).collect();
        Ok(rows.concat())
    }

    /// The change of all readings under all loads by another stiffness of bushes; `None` where the variant has a motion without support.
    fn change_by_bushes(&mut self, change: &[ElementMatrix]) -> Result<Option<Vec<f64>>, FeError> {
        let mut grids: Vec<GridIx> = change.iter().flat_map(|k| k.grids.clone()).collect();
        grids.sort_unstable();
        grids.dedup();
        for grid in &grids {
            if !self.dofs.contains_key(grid) {
                let columns = self.base.columns_of(*grid)?;
                self.dofs.insert(*grid, columns);
            }
        }
        let n = self.base.system.symbolic.n_unknowns();
        let known: Vec<&GridColumns> = grids.iter().filter_map(|g| self.dofs.get(g)).collect();
        let acting: Vec<&[f64]> = known.iter().flat_map(|c| c.0.chunks_exact(n)).collect();
        let caused: Vec<&[f64]> = known.iter().flat_map(|c| c.1.chunks_exact(n)).collect();
        let m = acting.len();
        let mut w = DMatrix::<f64>::zeros(m, m);
        for k in change {
            let at = |i: usize| {
                let grid = grids.binary_search(&k.grids[i / 6]).unwrap_or(0);
                6 * grid + i % 6
            };
            for (i, row) in k.values.chunks_exact(k.n()).enumerate() {
                for (j, v) in row.iter().enumerate() {
                    w[(at(i), at(j))] += v;
                }
            }
        }
        let products = |columns: &[f64]| -> DMatrix<f64> {
            let columns: Vec<&[f64]> = columns.chunks_exact(n).collect();
            DMatrix::from_fn(m, columns.len(), |i, c| dot((acting[i], columns[c])))
        };
        let compliance = DMatrix::from_fn(m, m, |i, j| dot((acting[i], caused[j])));
        let (of_readings, of_loads) = (products(&self.moved), products(&self.base.moved));
        let matrix = DMatrix::identity(m, m) + &w * compliance;
        let Some(solved) = matrix.lu().solve(&(w * of_loads)) else {
            return Ok(None);
        };
        let rows = -(of_readings.transpose() * solved);
        Ok(Some(rows.transpose().as_slice().to_vec()))
    }
}

impl Base<'_> {
    /// Returns the adjoint forces of readings on a variant, at the unknowns, one column per reading.
    fn forces_of_readings(
        &self,
        variant: &PreparedModel<'_>,
        readings: &[Vec<StrainTerm>],
    ) -> Result<Vec<f64>, FeError> {
        let n = self.system.symbolic.n_unknowns();
        let mut columns = vec![0.0; n * readings.len()];
        let both = columns.par_chunks_exact_mut(n).zip(readings);
        both.try_for_each(|(column, terms)| {
            let mut forces = vec![[0.0; 6]; variant.model.grids.len()];
            let acting = forces_of(variant, terms).map_err(|r| FeError::Refused(vec![r]))?;
            for (grid, force) in acting {
                let at = forces[grid.us()].iter_mut();
                at.zip(force).for_each(|(at, f)| *at += f);
            }
            self.system.pack(variant, forces, column)
        })?;
        Ok(columns)
    }

    /// Returns unit forces and moments at a grid, and the displacements that they cause.
    fn columns_of(&self, grid: GridIx) -> Result<GridColumns, FeError> {
        let n = self.system.symbolic.n_unknowns();
        let mut acting = vec![0.0; 6 * n];
        for (dof, column) in acting.chunks_exact_mut(n).enumerate() {
            let mut forces = vec![[0.0; 6]; self.model.grids.len()];
            forces[grid.us()][dof] = 1.0;
            self.system.pack(self.prepared, forces, column)?;
        }
        let mut caused = acting.clone();
        self.factor.solve(&mut caused);
        Ok((acting, caused))
    }
}
