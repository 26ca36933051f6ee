//! Result files: the solution of the unit loads of a job as an OP2.

use crate::answers::{expect_answer, read};
use nastran::op2::{EncodedBlock, Op2Writer};
use strainbridge::Context;
use strainbridge::fe::SolveOptions;
use strainbridge::host::context::InMemory;
use strainbridge::report::{planned_blocks, rows_of_block};

/// Adds `unit.op2` to the files, with the strain of the loads of `unit.toml`.
pub fn with_results(files: InMemory) -> InMemory {
    let job = read(&files, "unit.toml");
    let solved = strainbridge::solve(&job, SolveOptions::default(), &Context::new(&files));
    let solved = expect_answer("solve", solved);
    let (model, solution) = (&solved.deck.model, &solved.solution);
    let mut op2 = Op2Writer::new(Vec::new(), [1, 1, 2000]).expect("a header");
    for plan in planned_blocks(model, solution) {
        let (block, rows) = rows_of_block(model, solution, plan);
        let block = EncodedBlock::new(&block, &rows).expect("a block");
        op2.write_encoded(&block).expect("a block written");
    }
    files.with_file("unit.op2", op2.finish().expect("a file"))
}
