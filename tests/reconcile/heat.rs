//! Sun on one half of a structure.
//!
//! The pattern is a temperature set of the deck, and the temperature of each run is unknown. The readings come from a
//! mesh three times as fine.

use super::strips::{
    GAUGES, MEASURED, Mesh, result, run, sensitivity, simulate_measured_tables, workplace,
};

/// The first strip is one degree warmer than the second and has a gradient of 0.2 degrees per millimetre. It bows, and
/// the bushes resist.
const WARM: [f64; 3] = [0.0, 1.0, 0.2];

/// Table `[[load]]` of the temperature set, in degrees.
const HEAT: &str = "[[load]]\nname = \"HEAT\"\nload_set = 31\n";

#[test]
fn a_warm_part_by_the_decks_temperature_set_is_named_and_its_strain_comes_from_the_model() {
    let (folder, write) = workplace("reconcile_heat");
    write("true/deck.bdf", &Mesh(3).deck(1.0, Some(WARM)));
    write("true/job.toml", &Mesh(3).job(HEAT));
    let truth = sensitivity(&run("sensitivity", &folder.join("true/job.toml")));
    let per_degree: Vec<f64> = truth.iter().map(|row| row[6]).collect();
    let forces: Vec<Vec<f64>> = truth.iter().map(|row| row[..6].to_vec()).collect();
    let hottest = per_degree.iter().fold(0.0, |a: f64, s| a.max(s.abs()));
    assert!(hottest > 0.1, "microstrain a degree: {per_degree:?}");
    // Between 4 and 20 degrees, depending on the run.
    let degrees = |r: usize| 12.0 + 8.0 * (2.4 * r as f64).sin();
    let [strain, runs] = simulate_measured_tables(&forces, |r| {
        per_degree.iter().map(|s| s * degrees(r)).collect()
    });
    write("model/strain.csv", &strain);
    write("model/runs.csv", &runs);
    // The set of the deck starts at 20 degrees and is twice as large. Only its pattern matters.
    write(
        "model/deck.bdf",
        &Mesh(1).deck(1.0, Some([20.0, 22.0, 0.4])),
    );
    let told = format!("{MEASURED}temperature_set = 31\n");
    write("model/job.toml", &Mesh(1).job(&told));
    let out = run("reconcile", &folder.join("model/job.toml"));
    let found = result(&out);
    assert_eq!(
        found["named"],
        serde_json::json!(["thermal_gradient"]),
        "{}",
        found["best_attempt"]
    );
    let share = found["gap"]["explained_share"].as_f64().expect("a share");
    assert!(share > 0.7, "{}", found["gap"]);
    // The extended job recovers the forces with the heat as a nuisance load. The original job cannot separate them.
    assert_eq!(GAUGES.len(), per_degree.len());
    let extended = std::fs::read_to_string(out.join("job_extended.toml")).expect("the job");
    assert!(
        extended.contains("load_set = 31") && extended.contains("nuisance"),
        "{extended}"
    );
    run("sensitivity", &out.join("job_extended.toml"));
    run("recover", &out.join("job_extended.toml"));
}

#[test]
fn a_temperature_set_that_is_missing_or_even_is_refused_with_line_and_remedy() {
    let (folder, write) = workplace("reconcile_heat_faults");
    let [strain, runs] = simulate_measured_tables(&vec![vec![0.0; 6]; GAUGES.len()], |_| {
        vec![0.0; GAUGES.len()]
    });
    write("strain.csv", &strain);
    write("runs.csv", &runs);
    write("deck.bdf", &Mesh(1).deck(1.0, Some([20.0, 20.0, 0.0])));
    for (sid, words) in [(31, "is uniform"), (32, "no temperature set 32")] {
        let told = format!("{MEASURED}temperature_set = {sid}\n");
        write("job.toml", &Mesh(1).job(&told));
        let done = std::process::Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args(["reconcile".as_ref(), folder.join("job.toml").as_os_str()])
            .output()
            .expect("the program runs");
        let printed = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{printed}");
        assert!(
            printed.contains(words) && printed.contains("temperature_set"),
            "{printed}"
        );
    }
}
