//! Reading a 55 MB OP2: the result tables of one real file, once for each of 50 subcases (as `make_big_op2.py` of the shared set
//! makes it). Skips where the shared set is not here.

use divan::{Bencher, counter::BytesCount};
use nastran::op2::Op2;
use nastran::results::Rows;
use rayon::prelude::*;

const FILE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../shared/nastran/msc_large_stress/test_model_cfast.op2"
);
const COPIES: u32 = 50;

fn main() {
    divan::main();
}

/// The file with its result tables repeated; `None` where it is not here.
fn big_file() -> Option<Vec<u8>> {
    let bytes = std::fs::read(FILE).ok()?;
    let op2 = Op2::read(&bytes).ok()?;
    let starts: Vec<usize> = op2.tables.iter().map(|t| t.offset).collect();
    // the file closes with a key 0 of 12 bytes
    let end = bytes.len() - 12;
    let piece = |i: usize| &bytes[starts[i]..starts.get(i + 1).copied().unwrap_or(end)];
    let is_result = |i: usize| op2.tables[i].name.starts_with('O');
    let mut big = bytes[..starts[0]].to_vec();
    (0..starts.len())
        .filter(|i| !is_result(*i))
        .for_each(|i| big.extend_from_slice(piece(i)));
    for subcase in 1..=COPIES {
        for i in (0..starts.len()).filter(|i| is_result(*i)) {
            let from = big.len();
            big.extend_from_slice(piece(i));
            number(&mut big[from..], subcase);
        }
    }
    big.extend_from_slice(&bytes[end..]);
    Some(big)
}

/// Sets the subcase, word 4, of every identification record (146 words of 4 bytes).
fn number(table: &mut [u8], subcase: u32) {
    let mut at = 0;
    while at + 8 <= table.len() {
        let n = u32::from_le_bytes(table[at..at + 4].try_into().unwrap()) as usize;
        if n == 584 {
            table[at + 16..at + 20].copy_from_slice(&subcase.to_le_bytes());
        }
        at += 8 + n;
    }
}

fn sum(rows: &Rows) -> usize {
    rows.len() * rows.columns.len()
}

#[divan::bench]
fn index_only(bencher: Bencher<'_, '_>) {
    let Some(big) = big_file() else { return };
    bencher
        .counter(BytesCount::new(big.len()))
        .bench(|| Op2::read(&big).unwrap().blocks.len());
}

#[divan::bench]
fn every_block_one_after_the_other(bencher: Bencher<'_, '_>) {
    let Some(big) = big_file() else { return };
    bencher.counter(BytesCount::new(big.len())).bench(|| {
        let op2 = Op2::read(&big).unwrap();
        (0..op2.blocks.len())
            .map(|b| sum(&op2.rows(b).unwrap()))
            .sum::<usize>()
    });
}

#[divan::bench]
fn every_block_in_parallel(bencher: Bencher<'_, '_>) {
    let Some(big) = big_file() else { return };
    bencher.counter(BytesCount::new(big.len())).bench(|| {
        let op2 = Op2::read(&big).unwrap();
        (0..op2.blocks.len())
            .into_par_iter()
            .map(|b| sum(&op2.rows(b).unwrap()))
            .sum::<usize>()
    });
}

#[divan::bench]
fn every_block_kept(bencher: Bencher<'_, '_>) {
    let Some(big) = big_file() else { return };
    bencher.counter(BytesCount::new(big.len())).bench(|| {
        let op2 = Op2::read(&big).unwrap();
        (0..op2.blocks.len())
            .map(|b| op2.rows(b).unwrap())
            .collect::<Vec<Rows>>()
            .len()
    });
}
