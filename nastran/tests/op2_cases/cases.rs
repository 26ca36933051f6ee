//! Walks the shared folder.

use nastran::op2::Op2;
use serde_json::Value;
use std::path::Path;

/// Calls `check` with name, file and oracle of every case that has an OP2.
pub fn each_op2(mut check: impl FnMut(&str, &Op2<'_>, &Value)) {
    let Some(shared) = crate::support::shared("nastran") else {
        return;
    };
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
        check(&label, &op2, &expected);
    }
}

fn json(path: &Path) -> Option<Value> {
    serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()
}
