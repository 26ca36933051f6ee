//! Reference material next to the repository (`../shared`), for the tests of both crates.
//!
//! If a file is absent, its test is skipped, and the skip is counted by a line in the file that `STRAINBRIDGE_SKIPPED` names. With
//! `STRAINBRIDGE_SHARED=required`, an absent file fails the test.
#![allow(dead_code, clippy::panic, clippy::print_stderr)]

use std::io::Write;
use std::path::{Path, PathBuf};

/// Returns a file or folder of the reference material, or `None` if it is absent.
pub fn find_shared_path(path: &str) -> Option<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = if own.ends_with("nastran") {
        own.parent().unwrap_or(own)
    } else {
        own
    };
    let full = root.join("../shared").join(path);
    // The path must not contain `..`, because decks resolve their INCLUDE statements relative to it.
    if let Ok(found) = std::fs::canonicalize(&full) {
        return Some(found);
    }
    let required = std::env::var("STRAINBRIDGE_SHARED").is_ok_and(|v| v == "required");
    assert!(!required, "../shared/{path} is absent, and required");
    eprintln!("skipped: ../shared/{path} is absent");
    count_skip(path);
    None
}

/// Prints and counts that a program or a package is missing. With `STRAINBRIDGE_TESTS=required` it fails the test.
pub fn skip(absent: &str) {
    let required = std::env::var("STRAINBRIDGE_TESTS").is_ok_and(|v| v == "required");
    assert!(!required, "{absent}, and required");
    eprintln!("skipped: {absent}");
    count_skip(absent);
}

/// Appends the reason of a skip to the file that `STRAINBRIDGE_SKIPPED` names.
pub fn count_skip(absent: &str) {
    let list = std::env::var("STRAINBRIDGE_SKIPPED").ok();
    let list = list.and_then(|list| {
        let mut open = std::fs::OpenOptions::new();
        open.create(true).append(true).open(list).ok()
    });
    if let Some(mut list) = list {
        let _ = writeln!(list, "{absent}");
    }
}

/// Returns the bytes of a file of the reference material.
pub fn bytes(path: &str) -> Option<Vec<u8>> {
    std::fs::read(find_shared_path(path)?).ok()
}

/// Returns the text of a file of the reference material.
pub fn text(path: &str) -> Option<String> {
    std::fs::read_to_string(find_shared_path(path)?).ok()
}
