//! The static workflow on cases whose hidden effect is known, and on seeded ones of our own.

use super::hidden;
use super::hidden::generator::{Background, EFFECTS, STRANGERS, hide};
use super::hidden::judge::{Answer, judge};
use strainbridge::reconcile::effect::{Member, library};
use strainbridge::reconcile::strain::{StrainFrame, examine, predict};
use strainbridge::reconcile::{Outcome, Verdict};

fn case(name: &str) -> Option<(StrainFrame, serde_json::Value)> {
    let Some(dir) = hidden::shared() else {
        eprintln!("skipped: ../shared/hidden_effects is absent");
        return None;
    };
    let truth = std::fs::read_to_string(dir.join("truth").join(format!("{name}.json"))).ok()?;
    let frame = hidden::frame_of(&dir.join("static").join(name));
    Some((frame, serde_json::from_str(&truth).ok()?))
}

/// Ids with places, as the truth of a case has them.
fn expected(truth: &serde_json::Value) -> Vec<String> {
    let ids = truth["truth"].as_array().cloned().unwrap_or_default();
    let with_place = |id: &str| match truth["location"][id].as_str() {
        Some(place) => format!("{id}:{place}"),
        None => id.to_owned(),
    };
    ids.iter()
        .filter_map(|i| i.as_str())
        .map(with_place)
        .collect()
}

fn named(outcome: &Outcome) -> Vec<String> {
    match outcome.verdict {
        Verdict::Named => outcome.effects.iter().map(|e| e.id.clone()).collect(),
        Verdict::Unknown => vec!["unknown".into()],
        _ => vec!["none".into()],
    }
}

#[test]
fn hidden_effects_of_the_shared_static_cases_are_named_and_the_held_out_gap_closes() {
    for name in ["dev-s1", "dev-s2", "dev-s3", "dev-s4"] {
        let Some((frame, truth)) = case(name) else {
            return;
        };
        let outcome = examine(&frame, &[]);
        assert_eq!(named(&outcome), expected(&truth), "{name}");
        // Readings that four digits of the tables round: the gap of the analyst's model is that of the case's author.
        let before = truth["gap_before"].as_f64().unwrap_or(f64::NAN);
        assert!(
            (outcome.gap.before - before).abs() < 1e-3 * before,
            "{name}"
        );
        if outcome.verdict == Verdict::Named {
            assert!(
                outcome.gap.explained_share() > 0.7,
                "{name}: {:?}",
                outcome.gap
            );
            assert!(
                outcome.gauges_off.is_empty(),
                "{name}: {:?}",
                outcome.gauges_off
            );
        }
    }
}

#[test]
fn seeded_controls_with_and_without_background_get_no_name() {
    let Some((base, _)) = case("dev-s1") else {
        return;
    };
    for background in [Background::Clean, Background::Messy] {
        for seed in [1000, 1002, 1004] {
            let hidden = hide(&base, "none", 0.0, background, seed);
            assert_eq!(
                named(&examine(&hidden.frame, &[])),
                ["none"],
                "{background:?} {seed}"
            );
        }
    }
}

#[test]
fn a_drifted_zero_is_found_to_a_few_microstrain_and_a_swap_by_its_two_gauges() {
    let Some((base, _)) = case("dev-s1") else {
        return;
    };
    let drift = hide(&base, "zero_drift", 40.0, Background::Clean, 300);
    let outcome = examine(&drift.frame, &[]);
    assert_eq!(named(&outcome), drift.truth);
    // Noise of 2 microstrain at most over ten runs leaves 0.6; three sigma.
    assert!((outcome.effects[0].size[0].abs() - 40.0).abs() < 2.0);
    let swap = hide(&base, "gauge_swap", 1.0, Background::Clean, 100);
    assert_eq!(named(&examine(&swap.frame, &[])), swap.truth);
}

#[test]
fn every_effect_of_the_library_at_its_fourth_size_is_named_on_an_exact_model() {
    let Some((base, _)) = case("dev-s2") else {
        return;
    };
    for (effect, sizes) in EFFECTS {
        let hidden = hide(&base, effect, sizes[3], Background::Clean, 302);
        assert!(hidden.signal > 0.5, "{effect} is hidden in the noise");
        let outcome = examine(&hidden.frame, &[]);
        // A rival that the program itself lists as not to be told apart counts.
        let answer = judge(&hidden, &outcome);
        assert!(
            matches!(answer, Answer::Hit | Answer::Alias),
            "{effect}: {answer:?} {:?} for {:?}",
            named(&outcome),
            hidden.truth
        );
    }
}

#[test]
fn what_no_effect_of_the_library_makes_is_called_unknown_and_described() {
    let Some((base, _)) = case("dev-s1") else {
        return;
    };
    for stranger in STRANGERS {
        let hidden = hide(&base, stranger, 1.0, Background::Messy, 5200);
        let outcome = examine(&hidden.frame, &[]);
        assert_eq!(named(&outcome), ["unknown"], "{stranger}");
        assert!(!outcome.remains.is_empty(), "{stranger}");
    }
}

#[test]
fn a_payload_moved_in_the_runs_strains_as_the_offset_that_was_found() {
    let Some((frame, _)) = case("dev-s1") else {
        return;
    };
    // Forward and to the left, where the library tries both at once.
    let (dx, dy) = (0.17, -0.08);
    let both = library(&frame, &["payload_offset".into()])
        .into_iter()
        .find(|c| c.effect.id() == "payload_offset" && c.effect.parameters().len() == 2)
        .expect("an offset both ways");
    let effect = both.effect.as_ref();
    let found = predict(
        &frame,
        &[Member {
            effect,
            parameters: &[dx, dy],
        }],
    );
    let mut moved = frame.clone();
    for p in &mut moved.payload {
        *p = [p[0], p[1] + dx, p[2] + dy];
    }
    let written = predict(&moved, &[]);
    let size = found.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    for (a, b) in found.iter().zip(&written) {
        assert!((a - b).abs() < 1e-9 * size, "{a} {b}");
    }
}
