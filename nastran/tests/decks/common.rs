//! Common code of the tests: the real cases, and a loader that reads their files.

#![allow(dead_code)] // each test binary uses its part

use std::path::{Path, PathBuf};

use nastran::bdf::{Deck, IncludeRequest, LoadedFile, Loader, read_deck};

/// Returns the folder of real cases, if it is present.
pub(crate) fn cases_folder() -> Option<PathBuf> {
    crate::support::find_shared_path("nastran")
}

/// A case with its folder, `case.json` and `expected.json`.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) folder: PathBuf,
    pub(crate) case: serde_json::Value,
    pub(crate) expected: serde_json::Value,
}

/// Returns every case of the folder, or `None` if the folder is absent.
fn cases() -> Option<Vec<Case>> {
    let folder = cases_folder()?;
    let mut list = Vec::new();
    for entry in std::fs::read_dir(folder).expect("readable folder") {
        let folder = entry.expect("readable entry").path();
        let json = |name: &str| {
            let text = std::fs::read_to_string(folder.join(name)).ok()?;
            serde_json::from_str(&text).ok()
        };
        if let Some(case) = json("case.json") {
            let name = folder
                .file_name()
                .map(|n| n.to_string_lossy().into_owned())
                .unwrap_or_default();
            list.push(Case {
                name,
                expected: json("expected.json").unwrap_or_default(),
                case,
                folder,
            });
        }
    }
    list.sort_by(|a, b| a.name.cmp(&b.name));
    Some(list)
}

/// Least number of cases with a deck in the folder (28 in November 2026).
const LEAST: usize = 25;

/// Calls `check` for every case with a deck and adds up the number of comparisons.
///
/// It fails if there are fewer comparisons than the folder is known to contain, so that a test cannot pass without any comparison. It does nothing if
/// the folder is absent.
pub(crate) fn at_least(least: usize, mut check: impl FnMut(&Case, &Deck) -> usize) {
    let Some(cases) = cases() else { return };
    let (mut decks, mut compared) = (0, 0);
    for case in &cases {
        if let Some(deck) = case.deck() {
            compared += check(case, &deck);
            decks += 1;
        }
    }
    assert!(decks >= LEAST, "{decks} decks");
    assert!(compared >= least, "{compared} compared");
}

impl Case {
    /// Returns the path of the case's deck.
    pub(crate) fn deck_path(&self) -> Option<PathBuf> {
        Some(self.folder.join(self.case["bdf"].as_str()?))
    }

    /// Returns the case's deck.
    pub(crate) fn deck(&self) -> Option<Deck> {
        self.deck_path().map(|p| read_file(&p))
    }
}

/// Reads included files from disk.
pub(crate) struct Disk;

impl Loader for Disk {
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String> {
        let paths = request
            .candidates(|s| std::env::var(s).ok())
            .map_err(|s| format!("no value: {s}"))?;
        paths
            .into_iter()
            .find_map(|path| {
                std::fs::read(&path).ok().map(|bytes| LoadedFile {
                    path,
                    bytes,
                    differing_path: None,
                })
            })
            .ok_or_else(|| "no such file".to_owned())
    }
}

/// Reads a deck from disk.
pub(crate) fn read_file(path: &Path) -> Deck {
    let bytes = std::fs::read(path).expect("readable deck");
    read_deck(&path.to_string_lossy(), bytes, &mut Disk)
}
