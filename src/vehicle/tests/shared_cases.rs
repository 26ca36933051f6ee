//! Generated cases with their truth in `../shared/hidden_effects`.

use super::*;

fn case(name: &str) -> Option<(Channels, Channels, serde_json::Value)> {
    let truth = crate::support::bytes(&format!("hidden_effects/truth/{name}.json"))?;
    let root = crate::support::find_shared_path("hidden_effects")?;
    let read = |file: &str| {
        read_csv(
            &std::fs::read(root.join("dynamics").join(name).join(file)).unwrap(),
            Some(500.0),
        )
        .unwrap()
    };
    Some((
        read("data.csv"),
        read("holdout.csv"),
        serde_json::from_slice(&truth).unwrap(),
    ))
}

fn relative_error(id: &Identification, truth: &serde_json::Value, name: &str) -> f64 {
    (id.value(name).unwrap() / truth["true_params"][name].as_f64().unwrap() - 1.0).abs()
}

fn misfit(id: &Identification, channel: &str) -> f64 {
    id.fit
        .iter()
        .find(|f| f.channel == channel)
        .unwrap()
        .relative_rms
}

#[test]
fn the_control_case_gives_masses_and_stiffness_within_half_a_per_cent_and_wheel_force_within_one() {
    let Some((data, holdout, truth)) = case("dev-d1") else {
        return;
    };
    let id = identify(
        &task("front2", &["k_s", "c_s"], (0.7, 20.0)),
        &data,
        Some(&holdout),
    )
    .unwrap();
    for name in ["m_b", "m_f", "k_s"] {
        assert!(
            relative_error(&id, &truth, name) < 0.005,
            "{name}: {}",
            relative_error(&id, &truth, name)
        );
    }
    assert!(relative_error(&id, &truth, "c_s") < 0.01);
    assert!(misfit(&id, "f_wheel") < 0.01);
    assert!((id.mass_closure.unwrap().ratio - 1.0).abs() < 0.01);
    assert!(
        id.unidentifiable.is_empty() && id.findings.is_empty(),
        "{:?} {:?}",
        id.unidentifiable,
        id.findings
    );
}

#[test]
fn the_right_nonlinear_term_brings_stiffness_and_wheel_force_back() {
    for (name, term, truth_key, symbol) in [
        ("dev-d2", "coulomb_friction", "Fc", "fc_s"),
        ("dev-d3", "cubic_stiffness", "k3", "k3_s"),
    ] {
        let Some((data, holdout, truth)) = case(name) else {
            return;
        };
        let without = identify(
            &task("front2", &["k_s", "c_s"], (0.7, 20.0)),
            &data,
            Some(&holdout),
        )
        .unwrap();
        let with = identify(
            &task("front2", &["k_s", "c_s", term], (0.7, 20.0)),
            &data,
            Some(&holdout),
        )
        .unwrap();
        for p in ["m_b", "m_f", "k_s"] {
            assert!(
                relative_error(&with, &truth, p) < 0.005,
                "{name} {p}: {}",
                relative_error(&with, &truth, p)
            );
        }
        let hidden = truth["hidden_params"][truth_key].as_f64().unwrap();
        assert!((with.value(symbol).unwrap() / hidden - 1.0).abs() < 0.02);
        assert!(misfit(&with, "f_wheel") < 0.01);
        assert!(misfit(&with, "a_body") < 0.2 * misfit(&without, "a_body"));
    }
}

#[test]
fn without_a_wheel_force_ratios_are_determined_and_the_lost_factor_is_reported() {
    let Some((mut data, _, truth)) = case("dev-d1") else {
        return;
    };
    data.list.retain(|c| !c.name.starts_with("f_"));
    let q = task("front2", &["k_s", "c_s"], (0.7, 20.0));
    let id = identify(&q, &data, None).unwrap();
    let t = |n: &str| truth["true_params"][n].as_f64().unwrap();
    let ratio = |n: &str| id.parameters.iter().find(|p| p.name == n).unwrap();
    let k = ratio("k_s/m_b");
    assert!(
        (k.value.unwrap() / (t("k_s") / t("m_b")) - 1.0).abs() < 0.005 && k.identifiable,
        "{k:?}"
    );
    assert!((ratio("c_s/m_b").value.unwrap() / (t("c_s") / t("m_b")) - 1.0).abs() < 0.01);
    assert!(
        ["m_b", "m_f", "k_s", "c_s"]
            .iter()
            .all(|n| !ratio(n).identifiable && ratio(n).value.is_none())
    );
    assert!(
        id.unidentifiable[0].contains("one common factor") && id.unidentifiable[0].contains("m_b")
    );
    assert!(
        id.unidentifiable
            .iter()
            .any(|s| s.starts_with("m_f ") && s.contains("f_wheel"))
    );
    assert_eq!(
        id.parameters,
        identify(&q, &data, None).unwrap().parameters,
        "run twice, one answer"
    );
    let known = IdentifyTask {
        known: [("m_b".to_owned(), t("m_b"))].into(),
        ..q
    };
    let id = identify(&known, &data, None).unwrap();
    assert!(relative_error(&id, &truth, "k_s") < 0.005);
}

#[test]
fn declared_tolerances_widen_the_intervals() {
    let Some((data, _, _)) = case("dev-d1") else {
        return;
    };
    let q = task("front2", &["k_s", "c_s"], (0.7, 20.0));
    let sigma = |q: &IdentifyTask, n: &str| {
        let id = identify(q, &data, None).unwrap();
        let p = id.parameters.into_iter().find(|p| p.name == n).unwrap();
        p.sigma.unwrap() / p.value.unwrap()
    };
    let tight = sigma(&q, "m_b");
    let loose = IdentifyTask {
        gain_tolerance: 0.01,
        sync_tolerance_s: 4e-4,
        ..q
    };
    // An error of one per cent on the body channel or on the force channel moves m_b by one per cent.
    assert!(
        tight < 1e-3 && (0.008..0.03).contains(&sigma(&loose, "m_b")),
        "{tight} {}",
        sigma(&loose, "m_b")
    );
}
