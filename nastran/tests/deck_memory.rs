//! Small decks that request much memory do not get it.

use std::collections::BTreeMap;

use nastran::bdf::{MemoryLoader, read_deck};

/// Returns the peak resident memory of this process in bytes, or `None` if the system does not report it.
fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kib: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib << 10)
}

fn twice(name: &str) -> Vec<u8> {
    format!("INCLUDE '{name}'\nINCLUDE '{name}'\n").into_bytes()
}

#[test]
fn small_decks_never_take_more_than_64_mib() {
    let before = peak();
    let mut doubling: BTreeMap<String, Vec<u8>> = (0..30)
        .map(|i| (format!("f{i}"), twice(&format!("f{}", i + 1))))
        .collect();
    doubling.insert("f30".to_owned(), b"GRID,1\n".to_vec());
    let wide: String = (0..2_000)
        .map(|i| format!("RBE2,{},1,123,1,THRU,99999999\n", i + 1))
        .collect();
    let sets: String = (0..500)
        .map(|i| format!("SET {} = 1 THRU 99999999 BY 2\n", i + 1))
        .collect();
    let decks = [
        "GRID,1,,0.,0.,0.\n=,*1,==\n=(1000000000)\n".to_owned(),
        "GRID,1,,0.,0.,0.\n=,*1,==\n=(100000)\n=(100000)\n=(100000)\n=(100000)\n=(100000)\n"
            .to_owned(),
        "SPC1,1,123,1,3,THRU,99999999,BY,2\nSPCADD,1,1,THRU,99999999\n".to_owned(),
        "SPOINT,1,THRU,99999999\n".to_owned(),
        wide,
        format!("SOL 101\nCEND\n{sets}BEGIN BULK\n"),
        "INCLUDE 'f0'\n".to_owned(),
    ];
    for text in decks {
        let mut loader = MemoryLoader {
            files: doubling.clone(),
            ..MemoryLoader::default()
        };
        let deck = read_deck("main.bdf", text.into_bytes(), &mut loader);
        assert!(deck.faults.len() <= 2_100);
        drop(deck);
    }
    if let (Some(before), Some(after)) = (before, peak()) {
        assert!(after - before < 64 << 20, "{} MiB", (after - before) >> 20);
    }
}
