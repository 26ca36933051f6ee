//! Two load cases of a wing box solved by MSC, 64-bit OP2, skewed shells.

use super::command::{csv, run, scratch, shared};

const JOB: &str = r#"
units = "in-lbf-s"
[model]
deck = "DECK"
results = ["OP2"]
[[load]]
name = "A"
load_set = SETA
subcase = SUBA
expected = 1.0
[[load]]
name = "B"
load_set = SETB
subcase = SUBB
expected = 1.0
[candidates]
surfaces = ["top", "bottom"]
angle_step_deg = 15
[placement]
gauges = 6
"#;

#[test]
fn two_load_cases_with_the_same_strain_everywhere_are_refused_as_inseparable() {
    let Some(case) = shared("nastran/msc64_two_cases") else {
        return;
    };
    let folder = scratch("wing");
    let deck_bytes = std::fs::read(case.join("d173.bdf")).unwrap();
    let deck = nastran::bdf::read_deck(
        "d173.bdf",
        deck_bytes,
        &mut nastran::bdf::MemoryLoader::default(),
    );
    let subcases: Vec<(u32, u32)> = deck
        .case_control
        .effective_subcases()
        .iter()
        .filter_map(|s| Some((s.id, s.load?)))
        .collect();
    assert_eq!(subcases.len(), 2);
    let path = |f: &str| case.join(f).display().to_string().replace('\\', "/");
    let text = JOB
        .replace("DECK", &path("d173.bdf"))
        .replace("OP2", &path("d173.op2"))
        .replace("SUBA", &subcases[0].0.to_string())
        .replace("SETA", &subcases[0].1.to_string())
        .replace("SUBB", &subcases[1].0.to_string())
        .replace("SETB", &subcases[1].1.to_string());
    let job = folder.join("job.toml");
    std::fs::write(&job, &text).unwrap();
    let placed = run(&["place", job.to_str().unwrap()], &folder.join("placed"));
    // Both subcases put the same strain into every shell of this file (`raw_shell_strain` of the oracle is the same to the last digit):
    // no layout separates them, and the program must say so instead of inverting rounding.
    assert_eq!(placed.code, 2, "{}", placed.stderr);
    assert!(
        placed.stderr.contains("separate the 2 loads"),
        "{}",
        placed.stderr
    );
    let sensitivity = run(&["sensitivity", job.to_str().unwrap()], &folder.join("s"));
    assert_eq!(sensitivity.code, 1, "{}", sensitivity.stderr);
    assert_eq!(sensitivity.result["rank"], 1);
    // 100 CQUAD4 and 16 CTRIA3, two surfaces, twelve angles.
    let (_, rows) = csv(&folder.join("s/sensitivity.csv"));
    assert_eq!(rows.len(), 116 * 2 * 12);
}
