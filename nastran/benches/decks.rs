//! Speed of reading decks: `cargo bench -p nastran --bench decks [FILE ..]`.
//!
//! Without files: the two timing decks of `../shared/nastran`. The ratio to pyNastran is taken with its
//! `time_pynastran.py` on the same machine.

use std::path::{Path, PathBuf};

use divan::Bencher;
use divan::counter::BytesCount;
use nastran::bdf::{MemoryLoader, read_deck};

fn main() {
    divan::main();
}

/// The timing decks, and more where STRAINBRIDGE_BENCH_DECKS names them (separated by `;`).
fn decks() -> Vec<String> {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/nastran");
    let mut list: Vec<PathBuf> = vec![
        shared.join("deck_slot_large/slot.bdf"),
        shared.join("deck_isat_deployed/ISat_Dploy_Sm.dat"),
    ];
    if let Ok(more) = std::env::var("STRAINBRIDGE_BENCH_DECKS") {
        list.extend(more.split(';').map(PathBuf::from));
    }
    list.into_iter()
        .filter(|p| p.is_file())
        .map(|p| p.to_string_lossy().into_owned())
        .collect()
}

#[divan::bench(args = decks())]
fn read(bencher: Bencher, path: &String) {
    let bytes = std::fs::read(path).unwrap_or_default();
    bencher
        .counter(BytesCount::of_slice(&bytes))
        .with_inputs(|| bytes.clone())
        .bench_values(|bytes| read_deck(path, bytes, &mut MemoryLoader::default()));
}
