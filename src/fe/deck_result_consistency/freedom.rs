//! Reactions in a job that should have none.

use crate::finding::{Finding, Severity};
use crate::model::{Load, Model};
use nastran::results::{Analysis, Quantity, ResultsFile, Rows};

/// Supports of the run that produced the results, as the caller states them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Supports {
    /// Free if PARAM,INREL requests inertia relief.
    #[default]
    AsDeck,
    /// Free: unit loads under inertia relief.
    Free,
}

/// Reactions up to this share of the largest applied load are rounding.
const REACTION_TOLERANCE: f64 = 1e-3;

/// Returns a finding if a run that should be free has SPC forces that carry load.
///
/// Measured: the largest SPC force of all subcases. Limit: 1e-3 of the largest applied force (the file's OLOAD output, else the deck's
/// FORCE cards).
pub fn check_free(
    model: &Model,
    name: &str,
    file: &ResultsFile,
    supports: Supports,
) -> Vec<Finding> {
    if supports == Supports::AsDeck && model.params.inrel == 0 {
        return Vec::new();
    }
    let mut reaction = (0.0_f64, 0_u32, 0_u32);
    let mut applied = 0.0_f64;
    for (ix, block) in file.blocks().iter().enumerate() {
        if block.analysis != Analysis::Statics
            || !matches!(block.quantity, Quantity::SpcForce | Quantity::AppliedLoad)
        {
            continue;
        }
        let Ok(rows) = file.rows(ix) else { continue };
        let (force, grid) = largest_force(&rows);
        if block.quantity == Quantity::AppliedLoad {
            applied = applied.max(force);
        } else if force > reaction.0 {
            reaction = (force, grid, block.subcase);
        }
    }
    if applied == 0.0 {
        let forces = model.load_sets.iter().flat_map(|s| &s.loads);
        applied = forces
            .filter_map(|(w, l)| {
                if let Load::Force(_, f) = l {
                    Some((f * *w).norm())
                } else {
                    None
                }
            })
            .fold(0.0, f64::max);
    }
    let limit = REACTION_TOLERANCE * applied;
    if reaction.0 <= limit {
        return Vec::new();
    }
    let message = format!(
        "the structure should be free, but its supports carry load: {:.4e} at grid {} in subcase {}; a free structure has other strain near the supports",
        reaction.0, reaction.1, reaction.2
    );
    let remedy = "run with inertia relief (SUPORT and PARAM,INREL,-1, or INREL,-2) and without other constraints";
    vec![
        Finding::new(Severity::Warning, "not-free", name, message, remedy)
            .with_numbers(reaction.0, limit),
    ]
}

/// Largest force (not moment) of nodal rows and its grid.
fn largest_force(rows: &Rows) -> (f64, u32) {
    let mut largest = (0.0, 0);
    for (i, id) in rows.ids.iter().enumerate() {
        if let [x, y, z, ..] = rows.row(i) {
            let force = x.hypot(*y).hypot(*z);
            if force > largest.0 {
                largest = (force, id.entity);
            }
        }
    }
    largest
}
