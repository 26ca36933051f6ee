//! Unit-load decks of three real decks. The reader of the project reads them again, and pyNastran too if Python has it.

use super::command::{Outcome, find_shared_path, run, scratch};
use crate::support::skip;
use nastran::bdf::{Deck, IncludeRequest, LoadedFile, Loader, read_deck};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Deck of the reference material.
struct Source {
    case: &'static str,
    units: &'static str,
    /// Grid for each of two loads.
    grids: [u32; 2],
    /// Exit code, and codes of errors. The program writes the cases in spite of these errors.
    code: i32,
    errors: &'static [&'static str],
    /// Expected warnings about the deck.
    warnings: &'static [&'static str],
}

/// Decks with unusual units.
///
/// Densities of d173 are in kg/mm3, a thousand times those in t/mm3. The densities of the ring (0.5) and of the
/// satellite (0.101) are weights without WTMASS. The modulus of the ring is 1000 psi.
const DECKS: [Source; 3] = [
    Source {
        case: "msc64_two_cases",
        units: "mm-t-s",
        grids: [5, 20],
        code: 0,
        errors: &[],
        warnings: &["units-density"],
    },
    Source {
        case: "n95_inertia_relief_ring",
        units: "in-lbf-s",
        grids: [1, 13],
        code: 1,
        errors: &["units-modulus"],
        warnings: &["units-density"],
    },
    Source {
        case: "deck_satellite_includes",
        units: "in-lbf-s",
        grids: [2, 3388],
        code: 0,
        errors: &[],
        warnings: &["units-density"],
    },
];

struct Folder(PathBuf);

impl Loader for Folder {
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String> {
        let path = self.0.join(&request.name);
        let bytes = std::fs::read(&path).map_err(|e| e.to_string())?;
        Ok(LoadedFile {
            path: path.display().to_string(),
            bytes,
            differing_path: None,
        })
    }
}

/// Returns the file name of the deck of a case.
fn deck_of(folder: &Path) -> String {
    let text = std::fs::read(folder.join("case.json")).unwrap();
    let case: Value = serde_json::from_slice(&text).unwrap();
    case["bdf"].as_str().unwrap().to_owned()
}

fn write_cases(case: &str, units: &str, grids: [u32; 2]) -> Option<(Deck, Outcome, PathBuf, Deck)> {
    let source = find_shared_path(&format!("nastran/{case}"))?;
    let folder = scratch(&format!("cases_{case}"));
    let deck = source.join(deck_of(&source));
    let path = deck.display().to_string().replace('\\', "/");
    let job = format!(
        "units = \"{units}\"\n[model]\ndeck = \"{path}\"\nmesh_error = false\nsupport = \"free\"\n\
         [[load]]\nname = \"A\"\ngrid = {}\ncomponent = \"FZ\"\napplied = -250.0\n\
         [[load]]\nname = \"B\"\ngrid = {}\ncomponent = \"MX\"\n",
        grids[0], grids[1]
    );
    std::fs::write(folder.join("job.toml"), job).unwrap();
    let out = folder.join("out");
    let got = run(&["cases", folder.join("job.toml").to_str().unwrap()], &out);
    let read = |path: &Path| {
        let bytes = std::fs::read(path).unwrap_or_default();
        let mut loader = Folder(path.parent().unwrap().to_owned());
        read_deck(&path.display().to_string(), bytes, &mut loader)
    };
    let written = read(&out.join("unit_loads.bdf"));
    Some((written, got, out.join("unit_loads.bdf"), read(&deck)))
}

#[test]
fn three_decks_come_back_with_one_load_a_subcase_and_the_analysts_model_untouched() {
    for expected in DECKS {
        let (case, grids) = (expected.case, expected.grids);
        let Some((deck, got, path, original)) = write_cases(case, expected.units, grids) else {
            return;
        };
        assert_eq!(got.code, expected.code, "{case}: {}", got.stderr);
        assert_eq!(got.codes("error"), expected.errors, "{case}");
        assert_eq!(got.codes("warning"), expected.warnings, "{case}");
        let faults: Vec<String> = deck.faults.iter().map(|f| f.what.message()).collect();
        assert_eq!(
            deck.faults.len(),
            original.faults.len(),
            "{case}: {faults:?}"
        );
        assert_eq!(deck.sol, Some(101), "{case}");
        assert_eq!(deck.cards.grids.len(), original.cards.grids.len(), "{case}");
        assert_eq!(
            deck.cards.shells.len(),
            original.cards.shells.len(),
            "{case}"
        );
        assert_eq!(
            deck.case_control.mpc_of_structure(),
            original.case_control.mpc_of_structure(),
            "{case}"
        );
        let subcases = deck.case_control.effective_subcases();
        assert_eq!(subcases.len(), 2, "{case}");
        for s in &subcases {
            assert_eq!(s.spc, None, "{case}: the structure is free");
        }
        let acting = |sid: u32| {
            let all = deck.cards.forces.iter().chain(&deck.cards.moments);
            all.filter(move |f| f.sid == sid).collect::<Vec<_>>()
        };
        let (a, b) = (
            acting(subcases[0].load.unwrap()),
            acting(subcases[1].load.unwrap()),
        );
        assert_eq!((a.len(), b.len()), (1, 1), "{case}");
        assert_eq!((a[0].grid, b[0].grid), (grids[0], grids[1]), "{case}");
        assert_eq!(
            (a[0].cid, a[0].n.map(|v| v * a[0].scale)),
            (0, [0.0, 0.0, -250.0]),
            "{case}"
        );
        assert_eq!(
            (b[0].cid, b[0].n.map(|v| v * b[0].scale)),
            (0, [1.0, 0.0, 0.0]),
            "{case}"
        );
        by_the_other_reader(case, &path, grids, deck.cards.grids.len());
    }
}

/// Compares with pyNastran, using the interpreter in STRAINBRIDGE_PYTHON, or `python3`.
fn by_the_other_reader(case: &str, path: &Path, grids: [u32; 2], n_grids: usize) {
    let python = std::env::var("STRAINBRIDGE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python/read_cases.py");
    let Ok(done) = Command::new(python).arg(script).arg(path).output() else {
        skip("no Python here");
        return;
    };
    if done.status.code() == Some(77) {
        skip(String::from_utf8_lossy(&done.stdout).trim());
        return;
    }
    let text = String::from_utf8_lossy(&done.stdout);
    // pyNastran may print warnings before the last line.
    let last = text.lines().last().unwrap_or_default();
    let read: Value = serde_json::from_str(last)
        .unwrap_or_else(|e| panic!("{case}: {e}: {}", String::from_utf8_lossy(&done.stderr)));
    assert_eq!(read["sol"], 101, "{case}");
    assert_eq!(
        read["params"],
        serde_json::json!({ "POST": -1, "INREL": -2 }),
        "{case}"
    );
    assert_eq!(read["grids"], n_grids, "{case}");
    let expected = [
        (
            "A",
            serde_json::json!([["FORCE", grids[0], [0.0, 0.0, -250.0]]]),
        ),
        (
            "B",
            serde_json::json!([["MOMENT", grids[1], [1.0, 0.0, 0.0]]]),
        ),
    ];
    for (number, (label, loads)) in ["1", "2"].into_iter().zip(expected) {
        let s = &read["subcases"][number];
        assert_eq!(s["label"], label, "{case}");
        assert_eq!(s["spc"], false, "{case}");
        assert_eq!(
            s["strain"],
            serde_json::json!(["FIBER", "CENTER"]),
            "{case}"
        );
        assert_eq!(s["loads"], loads, "{case}");
    }
}
