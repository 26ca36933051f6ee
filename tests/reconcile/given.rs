//! The static workflow on cases with a known hidden effect, and on seeded cases.

use super::hidden;
use super::hidden::generator::{Background, EFFECTS, UNMODELLED, hide};
use super::hidden::judge::{Answer, judge};
use strainbridge::reconcile::effect::{Member, library};
use strainbridge::reconcile::strain::{
    ReestimatedUnknowns, StrainFrame, examine, predict, proof_residuals,
};
use strainbridge::reconcile::{GapBasis, Outcome, Verdict};

fn case(name: &str) -> Option<(StrainFrame, serde_json::Value)> {
    let dir = hidden::find_shared_folder()?;
    let truth = std::fs::read_to_string(dir.join("truth").join(format!("{name}.json"))).ok()?;
    let frame = hidden::frame_of(&dir.join("static").join(name));
    Some((frame, serde_json::from_str(&truth).ok()?))
}

/// Returns effect ids with places, in the form of the truth of a case.
fn list_expected_effects(truth: &serde_json::Value) -> Vec<String> {
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

fn list_named_effects(outcome: &Outcome) -> Vec<String> {
    match outcome.verdict {
        Verdict::Named => outcome.effects.iter().map(|e| e.id.clone()).collect(),
        Verdict::Unknown => vec!["unknown".into()],
        _ => vec!["none".into()],
    }
}

#[test]
fn hidden_effects_of_the_shared_static_cases_are_named_and_the_held_out_gap_closes() {
    for name in [
        "dev-s1", "dev-s2", "dev-s3", "dev-s4", "dev-s5", "dev-s6", "dev-s7", "dev-s8", "dev-s9",
    ] {
        let Some((frame, truth)) = case(name) else {
            return;
        };
        let outcome = examine(&frame, &[]);
        let sorted = |mut ids: Vec<String>| {
            ids.sort();
            ids
        };
        // The order does not matter, as the set is one explanation.
        assert_eq!(
            sorted(list_named_effects(&outcome)),
            sorted(list_expected_effects(&truth)),
            "{name}"
        );
        // The tables round readings to four digits. The gap of the original model must agree with that of the author of
        // the case.
        if let Some(before) = truth["gap_before"].as_f64() {
            assert!(
                (outcome.gap.before - before).abs() < 1e-3 * before,
                "{name}"
            );
        }
        if outcome.verdict == Verdict::Named {
            // The gap contains the errors of the wheel scales before and after. If an effect hardly exceeds them, it
            // closes only a part of the gap.
            let (share, gap) = (outcome.gap.explained_share(), outcome.gap);
            assert!(share > 0.5 && share < 1.1, "{name}: {gap:?}");
            let found = gap.loads_found.expect("both pairs");
            assert!(found.after < found.before, "{name}: {gap:?}");
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
                list_named_effects(&examine(&hidden.frame, &[])),
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
    assert_eq!(list_named_effects(&outcome), drift.truth);
    // Noise of 2 microstrain at most over ten runs leaves a sigma of 0.6. The limit is three sigma.
    assert!((outcome.effects[0].size[0].abs() - 40.0).abs() < 2.0);
    let swap = hide(&base, "gauge_swap", 1.0, Background::Clean, 100);
    assert_eq!(list_named_effects(&examine(&swap.frame, &[])), swap.truth);
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
        // An alternative explanation that the program lists as indistinguishable is a correct answer too.
        let answer = judge(&hidden, &outcome);
        assert!(
            matches!(answer, Answer::Hit | Answer::Alias),
            "{effect}: {answer:?} {:?} for {:?}",
            list_named_effects(&outcome),
            hidden.truth
        );
    }
}

#[test]
fn what_no_effect_of_the_library_makes_is_called_unknown_and_described() {
    let Some((base, _)) = case("dev-s1") else {
        return;
    };
    for form in UNMODELLED {
        let hidden = hide(&base, form, 1.0, Background::Messy, 5200);
        let outcome = examine(&hidden.frame, &[]);
        assert_eq!(list_named_effects(&outcome), ["unknown"], "{form}");
        assert!(!outcome.remains.is_empty(), "{form}");
    }
}

#[test]
fn an_effect_of_size_zero_explains_nothing_of_the_gap() {
    for name in ["dev-s1", "dev-s3", "dev-s4", "dev-s5"] {
        let Some((frame, _)) = case(name) else {
            return;
        };
        for c in library(
            &frame,
            &[
                "gauge_gain".into(),
                "wheel_scale".into(),
                "global_scale".into(),
            ],
        ) {
            let effect = c.effect.as_ref();
            if effect.discrepancy().is_some() {
                continue;
            }
            let neutral: Vec<f64> = effect.parameters().iter().map(|p| p.neutral).collect();
            let member = [Member {
                effect,
                parameters: &neutral,
            }];
            for anew in [
                ReestimatedUnknowns::Amplitudes,
                ReestimatedUnknowns::AmplitudesAndLoads,
            ] {
                let gap = proof_residuals(&frame, &member, &[], anew)
                    .expect("a covariance")
                    .numbers();
                // Another order of summation of equal numbers.
                assert!(
                    (gap.after - gap.before).abs() < 1e-9,
                    "{name} {} {gap:?}",
                    effect.id()
                );
            }
        }
    }
}

#[test]
fn without_held_out_runs_the_gap_is_cross_validated_and_called_that() {
    let Some((mut frame, _)) = case("dev-s3") else {
        return;
    };
    frame.observations.held_out.fill(false);
    let outcome = examine(&frame, &[]);
    assert_eq!(list_named_effects(&outcome), ["sign_flip:G08"]);
    assert_eq!(outcome.gap.basis, GapBasis::CrossValidated);
    assert!(outcome.gap.after < outcome.gap.before, "{:?}", outcome.gap);
}

#[test]
fn noise_half_above_what_is_stated_brings_no_name_and_no_unknown() {
    let Some((base, _)) = case("dev-s1") else {
        return;
    };
    for seed in 1000..1006 {
        let hidden = hide(&base, "none", 0.0, Background::Noisy, seed);
        let outcome = examine(&hidden.frame, &[]);
        assert_eq!(list_named_effects(&outcome), ["none"], "{seed}");
        assert!(
            (outcome.noise_factor - 1.5).abs() < 0.2,
            "{seed}: {}",
            outcome.noise_factor
        );
    }
}

#[test]
fn a_payload_moved_in_the_runs_strains_as_the_offset_that_was_found() {
    let Some((frame, _)) = case("dev-s1") else {
        return;
    };
    // Offsets forward and to the left. The library tries both together.
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

#[test]
fn a_gauge_that_sits_elsewhere_is_named_where_the_gradient_along_it_is_known() {
    let Some((base, _)) = case("dev-s1") else {
        return;
    };
    let mut frame = hide(&base, "none", 0.0, Background::Clean, 310).frame;
    // Two per cent of the influence per millimetre, with either sign. No gain and no angle resembles it.
    let mut numbers = hidden::drawn::Numbers(11);
    let along = frame.influence.iter().map(|a| 0.02 * numbers.next() * a);
    frame.per_mm = Some(along.collect());
    let n_g = frame.n_gauges();
    let clean = predict(&frame, &[]);
    let strength = |g: usize| {
        clean
            .iter()
            .skip(g)
            .step_by(n_g)
            .map(|v| v * v)
            .sum::<f64>()
    };
    let strongest = (0..n_g)
        .max_by(|a, b| strength(*a).total_cmp(&strength(*b)))
        .expect("a gauge");
    let name = format!("gauge_position:{}", frame.gauges[strongest].name);
    let all = library(&frame, std::slice::from_ref(&name));
    let effect = all
        .iter()
        .find(|c| c.effect.id() == "gauge_position")
        .expect("the effect")
        .effect
        .as_ref();
    let parameters = &[20.0][..];
    let moved = predict(&frame, &[Member { effect, parameters }]);
    let values = frame.observations.values.iter_mut();
    values
        .zip(moved.iter().zip(&clean))
        .for_each(|(v, (a, b))| *v += a - b);
    let outcome = examine(&frame, &[]);
    assert_eq!(
        list_named_effects(&outcome),
        [name],
        "{:?}",
        outcome.best_attempt
    );
    let (size, sigma) = (outcome.effects[0].size[0], outcome.effects[0].sigma[0]);
    assert!((size - 20.0).abs() < 4.0 * sigma, "{size} +- {sigma}");
}
