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
fn six_gauges_on_the_wing_recover_a_known_mix_of_the_files_own_strain() {
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
    assert_ne!(placed.code, 2, "{}", placed.stderr);
    assert_eq!(placed.result["gauges"].as_array().unwrap().len(), 6);
    assert_eq!(placed.result["candidates"]["places"], 200);
    assert_eq!(placed.result["candidates"]["rows"], 2400);
    assert!(placed.number("efficiency_bound") > 0.95);
    // 3.5 A - 1.25 B, in the file's own strain.
    let (_, s) = csv(&folder.join("placed/sensitivity.csv"));
    let names: Vec<&str> = s.iter().map(|r| r[0].as_str()).collect();
    let mix: Vec<String> = s
        .iter()
        .map(|r| {
            (3.5 * r[1].parse::<f64>().unwrap() - 1.25 * r[2].parse::<f64>().unwrap()).to_string()
        })
        .collect();
    std::fs::write(
        folder.join("strain.csv"),
        format!("run,{}\nR1,{}\n", names.join(","), mix.join(",")),
    )
    .unwrap();
    let more = "[gauges]\nfile = \"placed/gauges.csv\"\n[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n";
    std::fs::write(&job, format!("{text}{more}")).unwrap();
    let got = run(&["recover", job.to_str().unwrap()], &folder.join("out"));
    assert_ne!(got.code, 2, "{}", got.stderr);
    let value = |name: &str| {
        let loads = got.result["loads"].as_array().unwrap();
        loads.iter().find(|l| l["name"] == name).unwrap()["value"]
            .as_f64()
            .unwrap()
    };
    assert!(
        (value("A") / 3.5 - 1.0).abs() < 1e-6 && (value("B") / -1.25 - 1.0).abs() < 1e-6,
        "{} {}",
        value("A"),
        value("B")
    );
}
