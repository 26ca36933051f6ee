//! Lists what an OP2 holds and decodes every block: `cargo run -p nastran --example list_op2 -- model.op2`.
//!
//! A solver writes one block of rows for each table, subcase, step and element type, behind a record that identifies the block. Reading the
//! file finds the blocks; a block's rows are decoded only when asked for, so that a file of many gigabytes costs no more memory
//! than its largest block.
#![allow(clippy::print_stdout, reason = "an example shows what it finds")]

use nastran::op2::Op2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("give the path of an OP2")?;
    let bytes = std::fs::read(path)?;
    let op2 = Op2::read(&bytes)?;
    println!(
        "{:?}, label {:?}, {} bytes a word",
        op2.solver, op2.version_label, op2.word_bytes
    );
    for (i, block) in op2.blocks.iter().enumerate() {
        let what = block.element.and_then(|e| e.name()).unwrap_or("grids");
        match op2.rows(i) {
            Ok(rows) => println!(
                "{} subcase {}: {} {what}, {} rows",
                block.table,
                block.subcase,
                block.quantity.word(),
                rows.len()
            ),
            Err(why) => println!("{} subcase {}: {why}", block.table, block.subcase),
        }
    }
    for note in &op2.notes {
        println!("note: {}: {}", note.subject, note.message);
    }
    Ok(())
}
