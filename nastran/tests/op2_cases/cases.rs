//! Reads all cases of the shared folder.

use nastran::op2::Op2;
use serde_json::Value;
use std::path::Path;

/// Least number of cases with an OP2 in the set (28 in November 2026).
const LEAST: usize = 25;

/// Calls `check` with name, file and oracle of every case with an OP2. Returns the number of comparisons, or `None` if the set is absent.
pub fn each_op2(mut check: impl FnMut(&str, &Op2<'_>, &Value) -> usize) -> Option<usize> {
    let shared = crate::support::find_shared_path("nastran")?;
    let (mut cases, mut compared) = (0, 0);
    let folders = std::fs::read_dir(shared).unwrap();
    let mut folders: Vec<_> = folders.flatten().map(|f| f.path()).collect();
    folders.sort();
    for folder in folders {
        let (Some(case), Some(expected)) = (
            json(&folder.join("case.json")),
            json(&folder.join("expected.json")),
        ) else {
            continue;
        };
        let Some(name) = case["op2"].as_str() else {
            continue;
        };
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let label = folder.file_name().unwrap().to_string_lossy().into_owned();
        let op2 = Op2::read(&bytes).unwrap_or_else(|e| panic!("{label}: {e}"));
        compared += check(&label, &op2, &expected);
        cases += 1;
    }
    assert!(cases >= LEAST, "{cases} cases with an OP2");
    Some(compared)
}

/// Calls `check` for every case.
///
/// It fails if there are fewer comparisons than the set is known to contain, so that a test cannot pass without any comparison.
pub fn at_least(least: usize, check: impl FnMut(&str, &Op2<'_>, &Value) -> usize) {
    let compared = each_op2(check);
    assert!(compared.is_none_or(|n| n >= least), "{compared:?} compared");
}

fn json(path: &Path) -> Option<Value> {
    serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()
}
