//! Grids with other coordinates.

use crate::finding::{Finding, Severity};
use crate::model::Model;

/// Share of the model's size by which coordinates may differ: the rounding of single precision geometry blocks, with room.
const COORDINATE_TOLERANCE: f64 = 1e-5;

/// Returns a finding if grids with one id have different coordinates in the deck and in the geometry of the result file `name`.
pub fn check_coordinates(model: &Model, name: &str, geometry: &Model) -> Vec<Finding> {
    let size = size(model);
    let limit = COORDINATE_TOLERANCE * size;
    let (mut count, mut worst) = (0_usize, (0.0_f64, 0_u32));
    for grid in &geometry.grids {
        let Ok(ix) = model.grids.binary_search_by_key(&grid.id, |g| g.id) else {
            continue;
        };
        let distance = model.grids.get(ix).map_or(0.0, |g| (g.x - grid.x).norm());
        if distance > limit {
            count += 1;
            if distance > worst.0 {
                worst = (distance, grid.id);
            }
        }
    }
    if count == 0 {
        return Vec::new();
    }
    let message = format!(
        "{count} grids have other coordinates in the results than in the deck; grid {} differs by {:.3e}",
        worst.1, worst.0
    );
    let remedy = "give the deck of this run, or run the deck again";
    vec![
        Finding::new(Severity::Error, "coordinates-differ", name, message, remedy)
            .with_numbers(worst.0, limit),
    ]
}

/// The diagonal of the box around all grids.
fn size(model: &Model) -> f64 {
    let mut grids = model.grids.iter().map(|g| g.x);
    let Some(first) = grids.next() else {
        return 0.0;
    };
    let (low, high) = grids.fold((first, first), |(l, h), x| (l.inf(&x), h.sup(&x)));
    (high - low).norm()
}
