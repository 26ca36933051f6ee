//! Two load cases of a wing box solved by MSC: 64-bit OP2, skewed shells.

use super::command::{csv, find_shared_path, run, scratch};

const JOB: &str = r#"
units = "mm-t-s"
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
    let Some(case) = find_shared_path("nastran/msc64_two_cases") else {
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
    // Both subcases give the same strain in every shell of this file (`raw_shell_strain` of the oracle agrees to the
    // last digit). No layout separates them. The program reports it, and still gives the best layout for the remaining
    // combination.
    assert_eq!(placed.code, 1, "{}", placed.stderr);
    assert!(
        placed.stderr.contains("separate the 2 loads"),
        "{}",
        placed.stderr
    );
    assert_eq!(placed.result["gauges"].as_array().unwrap().len(), 6);
    assert!(placed.result["condition_number"].is_null());
    let sensitivity = run(&["sensitivity", job.to_str().unwrap()], &folder.join("s"));
    assert_eq!(sensitivity.code, 1, "{}", sensitivity.stderr);
    assert_eq!(sensitivity.result["rank"], 1);
    // 100 CQUAD4 and 16 CTRIA3, two surfaces, twelve angles.
    let (_, rows) = csv(&folder.join("s/sensitivity.csv"));
    assert_eq!(rows.len(), 116 * 2 * 12);
}

#[test]
fn a_known_multiple_of_a_load_comes_back_from_the_files_own_strain() {
    let Some(case) = find_shared_path("nastran/msc64_two_cases") else {
        return;
    };
    let folder = scratch("wing_one");
    let path = |f: &str| case.join(f).display().to_string().replace('\\', "/");
    // Only the first load, from skewed quads in 64 bits.
    let second = JOB.find("[[load]]\nname = \"B\"").unwrap();
    let rest = JOB.find("[candidates]").unwrap();
    let text = format!("{}{}", &JOB[..second], &JOB[rest..])
        .replace("DECK", &path("d173.bdf"))
        .replace("OP2", &path("d173.op2"))
        .replace("SUBA", "1")
        .replace("SETA", "203");
    let place = folder.join("place.toml");
    std::fs::write(&place, &text).unwrap();
    let placed = run(&["place", place.to_str().unwrap()], &folder.join("placed"));
    assert_eq!(placed.code, 0, "{}", placed.stderr);
    // Strain of a gauge with direction n on a surface, from the tensor in the basic frame that `strains` writes: n' E
    // n.
    let strains = run(
        &["strains", &path("d173.bdf"), &path("d173.op2")],
        &folder.join("strains"),
    );
    assert_eq!(strains.code, 0, "{}", strains.stderr);
    let (head, rows) = csv(&folder.join("strains/strains.csv"));
    let column = |name: &str| head.iter().position(|h| h == name).unwrap();
    let mut names = String::from("run");
    let mut values = String::from("R1");
    assert!(!placed.result["gauges"].as_array().unwrap().is_empty());
    for g in placed.result["gauges"].as_array().unwrap() {
        let is = |r: &Vec<String>, name: &str, what: &str| r[column(name)] == what;
        let element = g["element"].as_u64().unwrap().to_string();
        let row = rows
            .iter()
            .find(|r| {
                is(r, "subcase", "1")
                    && is(r, "element", &element)
                    && is(r, "location", "centre")
                    && is(r, "surface", g["surface"].as_str().unwrap())
            })
            .unwrap();
        let e = |name: &str| row[column(name)].parse::<f64>().unwrap();
        let n: Vec<f64> = (0..3)
            .map(|i| g["direction"][i].as_f64().unwrap())
            .collect();
        let strain = n[0] * n[0] * e("Exx")
            + n[1] * n[1] * e("Eyy")
            + n[2] * n[2] * e("Ezz")
            + 2.0 * (n[0] * n[1] * e("Exy") + n[1] * n[2] * e("Eyz") + n[2] * n[0] * e("Ezx"));
        names.push_str(&format!(",{}", g["name"].as_str().unwrap()));
        values.push_str(&format!(",{}", 2.5 * strain));
    }
    std::fs::write(folder.join("strain.csv"), format!("{names}\n{values}\n")).unwrap();
    let job = folder.join("recover.toml");
    let gauges = folder
        .join("placed/gauges.csv")
        .display()
        .to_string()
        .replace('\\', "/");
    std::fs::write(
        &job,
        format!("{text}[gauges]\nfile = \"{gauges}\"\n[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n"),
    )
    .unwrap();
    let recovered = run(
        &["recover", job.to_str().unwrap()],
        &folder.join("recovered"),
    );
    let load = &recovered.result["loads"][0];
    let value = load["value"].as_f64().unwrap();
    assert!(
        (value - 2.5).abs() < 2.5e-6,
        "{value}: {}",
        recovered.stderr
    );
}
