//! Dependencies of a program that uses the library without its features.

use super::root;
use std::collections::BTreeSet;
use std::process::Command;

/// Crates that draw, print, parse arguments or read optional formats. The library without its features uses none of
/// them.
const OF_FEATURES: [&str; 12] = [
    "calamine",
    "clap",
    "clap_complete",
    "clap_mangen",
    "ctrlc",
    "falcon_mdf",
    "indicatif",
    "maud",
    "parquet",
    "plotly",
    "rust_xlsxwriter",
    "typst",
];

#[test]
fn the_library_without_features_builds_no_terminal_pages_or_spreadsheets() {
    // CARGO is unset if this file is compiled alone.
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let done = Command::new(cargo)
        .args(["tree", "-e", "normal", "--no-default-features"])
        .args(["-p", "strainbridge", "--offline", "--locked"])
        .args(["--prefix", "none", "--format", "{p}"])
        .current_dir(root())
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{error}");
    let tree = String::from_utf8(done.stdout).unwrap();
    let crates: BTreeSet<&str> = tree.lines().filter_map(|l| l.split(' ').next()).collect();
    // If the tree could not be read, it would contain no forbidden crate either.
    assert!(crates.contains("strainbridge") && crates.contains("nastran"));
    let found: Vec<&str> = OF_FEATURES
        .into_iter()
        .filter(|name| crates.contains(name))
        .collect();
    assert!(found.is_empty(), "make these part of a feature: {found:?}");
}
