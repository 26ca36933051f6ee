//! A joint with half of its modelled stiffness, found through the solver and written to the deck.
//!
//! The readings come from a mesh three times as fine, in which the middle bush has half of its stiffness.

use super::strips::{
    GAUGES, MEASURED, Mesh, ends, result, run, sensitivity, simulate_measured_tables, workplace,
};

#[test]
fn a_joint_of_half_its_stiffness_is_named_and_the_extended_deck_strains_as_the_true_structure() {
    let (folder, write) = workplace("reconcile_joint");
    write("true/deck.bdf", &Mesh(3).deck(0.5, None));
    write("true/job.toml", &Mesh(3).job(""));
    let truth = sensitivity(&run("sensitivity", &folder.join("true/job.toml")));
    let [strain, runs] = simulate_measured_tables(&truth, |_| vec![0.0; GAUGES.len()]);
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
    // The page marks the joint with the factor of its stiffness, about one half.
    let page = std::fs::read_to_string(out.join("report.html")).expect("the page");
    assert!(page.contains("stiffness times 0."), "no joint is marked");
    // 100 times the natural logarithm of one half.
    let number = |key: &str| found["effects"][0][key].as_f64().expect("a number");
    let (size, sigma) = (number("size"), number("sigma"));
    // The mesh causes an error of a hundredth. The bushes carry the force between the strips, which determines their
    // stiffness within a tenth.
    assert!((size + 69.3).abs() < 3.0 * sigma.max(1.0), "{size} {sigma}");
    assert!(sigma < 10.0, "{sigma}");
    assert!(
        found["gap"]["explained_share"].as_f64().expect("a share") > 0.7,
        "{}",
        found["gap"]
    );
    // On the same mesh, the extended deck has the strain of a deck with the true stiffness. The unchanged deck does
    // not.
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
    // The residual of the mesh exceeds the stated model error of half a per cent. An error therefore states that the
    // loads are not explained.
    let (_, printed) = ends("recover", &extended, 1);
    assert!(
        printed.contains("error [strain-not-explained]"),
        "{printed}"
    );
}

/// The user's hypothesis is a quarter of the stiffness. The truth is half, the square root of a quarter, so the
/// hypothesis has half of its size. The bushes are in a separate file.
#[test]
fn an_edit_of_ones_own_goes_into_the_deck_through_its_includes_and_leaves_the_job() {
    let (folder, write) = workplace("reconcile_own_edit");
    write("true/deck.bdf", &Mesh(3).deck(0.5, None));
    write("true/job.toml", &Mesh(3).job(""));
    let truth = sensitivity(&run("sensitivity", &folder.join("true/job.toml")));
    let [strain, runs] = simulate_measured_tables(&truth, |_| vec![0.0; GAUGES.len()]);
    write("model/strain.csv", &strain);
    write("model/runs.csv", &runs);
    let deck = Mesh(1).deck(1.0, None);
    let is_bush = |l: &&str| l.starts_with("CBUSH") || l.starts_with("PBUSH");
    let (bushes, others): (Vec<&str>, Vec<&str>) = deck.lines().partition(is_bush);
    write("model/bushes.inc", &(bushes.join("\n") + "\n"));
    let others = others.join("\n");
    let main = others.replace("ENDDATA", "INCLUDE 'bushes.inc'\nENDDATA\n");
    write("model/deck.bdf", &main);
    let own = "effects = [\"bush_loose\", \"sign_flip\"]\n[[reconcile.effect]]\nid = \"bush_loose\"\n\
        edit = { cbush = 9002, stiffness_scale = 0.25 }\nprior = 1.0\n";
    write("model/job.toml", &Mesh(1).job(&format!("{MEASURED}{own}")));
    let out = run("reconcile", &folder.join("model/job.toml"));
    let found = result(&out);
    assert_eq!(
        found["named"],
        serde_json::json!(["bush_loose"]),
        "{}",
        found["best_attempt"]
    );
    let number = |key: &str| found["effects"][0][key].as_f64().expect("a number");
    let (size, sigma) = (number("size"), number("sigma"));
    // The mesh causes an error of a hundredth. A tenth of the stiffness, as above, is .07 of this size.
    assert!((size - 0.5).abs() < 3.0 * sigma.max(0.01), "{size} {sigma}");
    assert!(sigma < 0.07, "{sigma}");
    let lines = std::fs::read_to_string(out.join("deck_extended.bdf")).expect("the deck");
    let lines: Vec<&str> = lines.lines().collect();
    for card in ["CBUSH", "PBUSH"] {
        let noted = lines
            .windows(2)
            .any(|w| w[0].starts_with("$ reconcile: joint 9002") && w[1].starts_with(card));
        assert!(noted, "{card}");
    }
    assert!(lines.iter().any(|l| l.starts_with("$ was: INCLUDE")));
    assert!(!lines.iter().any(|l| l.starts_with("INCLUDE")));
    let added = &found["added"][0];
    assert!(
        added["path"]
            .as_str()
            .is_some_and(|p| p.contains("PBUSH of CBUSH 9002"))
    );
    let extended = out.join("job_extended.toml");
    let text = std::fs::read_to_string(&extended).expect("the extended job");
    assert!(!text.contains("id = \"bush_loose\""), "{text}");
    let again = result(&run("reconcile", &extended));
    assert_eq!(again["verdict"], "none", "{}", again["best_attempt"]);
}
