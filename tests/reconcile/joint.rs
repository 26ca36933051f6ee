//! A joint half as stiff as modelled, hidden in a structure of our own, found through the solver and put into the deck. The readings
//! come from a mesh three times as fine, in which the middle bush has half its stiffness.

use super::strips::{GAUGES, MEASURED, Mesh, measured, result, run, sensitivity, workplace};

#[test]
fn a_joint_of_half_its_stiffness_is_named_and_the_extended_deck_strains_as_the_true_structure() {
    let (folder, write) = workplace("reconcile_joint");
    write("true/deck.bdf", &Mesh(3).deck(0.5, None));
    write("true/job.toml", &Mesh(3).job(""));
    let truth = sensitivity(&run("sensitivity", &folder.join("true/job.toml")));
    let [strain, runs] = measured(&truth, |_| vec![0.0; GAUGES.len()]);
    write("model/strain.csv", &strain);
    write("model/runs.csv", &runs);
    write("model/deck.bdf", &Mesh(1).deck(1.0, None));
    write("model/job.toml", &Mesh(1).job(MEASURED));
    let out = run("reconcile", &folder.join("model/job.toml"));
    let found = result(&out);
    assert_eq!(
        found["named"],
        serde_json::json!(["joint_stiffness:9002"]),
        "{}",
        found["best_attempt"]
    );
    // Natural log times 100 of one half.
    let number = |key: &str| found["effects"][0][key].as_f64().expect("a number");
    assert!(
        (number("size") + 69.3).abs() < 3.0 * number("sigma").max(1.0),
        "{}",
        number("size")
    );
    assert!(
        found["gap"]["explained_share"].as_f64().expect("a share") > 0.7,
        "{}",
        found["gap"]
    );
    // On the same mesh the extended deck strains as one with the true stiffness does; the unchanged one does not.
    write("right/deck.bdf", &Mesh(1).deck(0.5, None));
    write("right/job.toml", &Mesh(1).job(""));
    let right = sensitivity(&run("sensitivity", &folder.join("right/job.toml")));
    let off = |s: &[Vec<f64>]| -> f64 {
        let pairs = s.iter().flatten().zip(right.iter().flatten());
        pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    let extended = out.join("job_extended.toml");
    let after = off(&sensitivity(&run("sensitivity", &extended)));
    let before = off(&sensitivity(&run(
        "sensitivity",
        &folder.join("model/job.toml"),
    )));
    assert!(after < 0.15 * before, "{before} {after}");
    run("solve", &extended);
    run("recover", &extended);
}
