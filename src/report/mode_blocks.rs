//! Modes as blocks of a result file.

use super::result_blocks::{PlannedBlock, rows_of_block};
use crate::fe::ModalSolution;
use crate::model::Model;
use nastran::results::{Analysis, Block, Quantity, Rows};

/// Returns a planned block of the strain of modes, and its rows. The block contains eigenvectors instead of displacements. All modes are in subcase 1
/// and differ by mode number and eigenvalue.
pub fn rows_of_mode_block(
    model: &Model,
    solution: &ModalSolution,
    plan: PlannedBlock,
) -> (Block, Rows) {
    let (mut block, rows) = rows_of_block(model, &solution.strain, plan);
    let mode = block.subcase;
    let frequency = solution
        .modes
        .get(mode.saturating_sub(1) as usize)
        .map_or(0.0, |m| m.frequency);
    block.analysis = Analysis::Modes;
    block.subcase = 1;
    block.mode = mode as _;
    block.step = (std::f64::consts::TAU * frequency).powi(2);
    if block.quantity == Quantity::Displacement {
        block.quantity = Quantity::Eigenvector;
    }
    (block, rows)
}
