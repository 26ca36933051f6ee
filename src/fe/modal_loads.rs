//! Modal loads: work of load cases on the shapes of modes.

use super::applied_loads::applied_forces;
use super::error::FeError;
use super::load_case::LoadCase;
use super::mass::Mass;
use super::prepared_model::PreparedModel;
use crate::model::Model;

/// Returns the work of every case's loads on every mode's shape (by grid, basic frame), `phi_j' f`: by case, then by mode.
///
/// # Errors
/// Load sets that the deck lacks; elements that can't be formed.
pub fn modal_loads(
    model: &Model,
    cases: &[LoadCase],
    shapes: &[Vec<[f64; 6]>],
) -> Result<Vec<Vec<f64>>, FeError> {
    let prepared = PreparedModel::new(model);
    let mass = Mass::new(&prepared);
    let of_case = |case: &LoadCase| {
        let forces = applied_forces(&prepared, &mass, case)?;
        let work = |shape: &Vec<[f64; 6]>| -> f64 {
            let grids = shape.iter().flatten();
            grids.zip(forces.iter().flatten()).map(|(u, f)| u * f).sum()
        };
        Ok(shapes.iter().map(work).collect())
    };
    cases.iter().map(of_case).collect()
}
