//! `place` on the ladder frame of MYSTRAN's unit loads: criteria, places, kept gauges, bridges, pairs, sheets.

use crate::command::{Outcome, csv, find_shared_path, run, scratch};
use std::path::PathBuf;

const CASE: &str = "nastran/mystran_frame_units";

/// Writes the job of the case with another `[candidates]` and `[placement]`.
fn job(name: &str, candidates: &str, placement: &str) -> Option<(PathBuf, PathBuf)> {
    let case = find_shared_path(CASE)?;
    let folder = scratch(name);
    let text = std::fs::read_to_string(case.join("job.toml")).unwrap();
    let base = case.display().to_string().replace('\\', "/");
    let head = &text[..text.find("[candidates]").unwrap()];
    let files = [
        "frame.bdf",
        "frame.op2",
        "measured/gauges.csv",
        "measured/strain.csv",
    ];
    let head = files.iter().fold(head.to_owned(), |t, f| {
        t.replace(&format!("\"{f}\""), &format!("\"{base}/{f}\""))
    });
    let text = format!(
        "{head}[candidates]\n{candidates}\n[placement]\nspacing = 50.0\nnoise_microstrain = 1.0\n{placement}\n"
    );
    let path = folder.join("job.toml");
    std::fs::write(&path, text).unwrap();
    Some((path, folder))
}

/// Runs `place`, which must end without an error.
fn place_without_fault(
    name: &str,
    candidates: &str,
    placement: &str,
) -> Option<(Outcome, PathBuf)> {
    let (got, folder) = run_place(name, candidates, placement)?;
    assert_eq!(got.code, 0, "{}", got.stderr);
    Some((got, folder))
}

fn run_place(name: &str, candidates: &str, placement: &str) -> Option<(Outcome, PathBuf)> {
    let (job, folder) = job(name, candidates, placement)?;
    let got = run(&["place", job.to_str().unwrap()], &folder.join("out"));
    Some((got, folder))
}

fn vector(g: &serde_json::Value, key: &str) -> Vec<f64> {
    let list = g[key].as_array().unwrap();
    list.iter().map(|v| v.as_f64().unwrap()).collect()
}

fn gauges(got: &Outcome) -> Vec<serde_json::Value> {
    got.result["gauges"].as_array().unwrap().clone()
}

fn sigmas(v: &serde_json::Value) -> Vec<f64> {
    let list = v.as_array().unwrap();
    list.iter().map(|l| l["sigma"].as_f64().unwrap()).collect()
}

const WIDE: &str = "angle_step_deg = 30";

#[test]
fn criterion_a_gives_smaller_variances_and_d_a_larger_determinant() {
    let Some((d, _)) = place_without_fault("place_d", WIDE, "gauges = 14\ncriterion = \"D\"")
    else {
        return;
    };
    let (a, _) = place_without_fault("place_a", WIDE, "gauges = 14\ncriterion = \"A\"").unwrap();
    let expected = [10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 30.0, 10.0, 10.0];
    let spread = |o: &Outcome| -> f64 {
        let s = sigmas(&o.result["load_sigma"]);
        s.iter().zip(expected).map(|(s, e)| (s / e).powi(2)).sum()
    };
    assert!(spread(&a) < spread(&d), "{} {}", spread(&a), spread(&d));
    // The value of criterion A is -k ln of that sum.
    let value = -9.0 * spread(&a).ln();
    assert!((a.number("log_det") - value).abs() < 1e-6, "{value}");
    // The bound of the relaxation is loose if there are few gauges more than loads. A ratio of variances is looser than
    // the ninth root of a ratio of determinants.
    for (o, least) in [(&a, 0.85), (&d, 0.9)] {
        let e = o.number("efficiency_bound");
        assert!(e > least && e <= 1.0, "{e}");
    }
}

#[test]
fn a_layout_for_the_condition_number_has_a_smaller_one_than_d_and_states_the_least_found() {
    let Some((d, _)) = place_without_fault("place_d12", WIDE, "gauges = 12\ncriterion = \"D\"")
    else {
        return;
    };
    let words = "gauges = 12\ncriterion = \"condition\"";
    let (got, _) = place_without_fault("place_condition", WIDE, words).unwrap();
    let own = got.number("condition_number_scaled");
    let least = got.number("least_condition_number_scaled");
    assert!(own < d.number("condition_number_scaled"), "{own}");
    // S of the result includes gauge length and transverse sensitivity. S of the search is that of points.
    assert!(own <= 1.2 * least, "{own} {least}");
    assert_eq!(gauges(&got).len(), 12);
    assert!(got.number("log_det") <= d.number("upper_bound") + 1e-9);
    assert!(got.number("efficiency_bound") <= 1.0);
    // This search does not support pairs, and the error reports it.
    let words = "gauges = 12\ncriterion = \"condition\"\nsymmetric = \"y\"";
    let (job, folder) = job("place_condition_pairs", WIDE, words).unwrap();
    let got = run(&["place", job.to_str().unwrap()], &folder.join("out"));
    assert_eq!(got.code, 2);
    assert!(got.stderr.contains("placement.criterion"), "{}", got.stderr);
}

#[test]
fn with_five_gauges_for_nine_loads_of_known_size_every_sigma_is_below_that_size() {
    let Some((got, _)) = run_place(
        "place_bayes",
        WIDE,
        "gauges = 5\ncriterion = \"Bayesian-D\"",
    ) else {
        return;
    };
    assert_eq!(got.code, 1, "{}", got.stderr);
    assert_eq!(gauges(&got).len(), 5);
    assert!(
        got.codes("error")
            .contains(&"fewer-gauges-than-loads".to_owned())
    );
    let expected = [10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 30.0, 10.0, 10.0];
    let sigmas = sigmas(&got.result["load_sigma"]);
    assert_eq!(sigmas.len(), expected.len());
    for (s, e) in sigmas.iter().zip(expected) {
        assert!(*s <= e, "{s} {e}");
    }
}

#[test]
fn kept_gauges_count_and_new_ones_keep_away_from_them() {
    let Some((got, _)) = place_without_fault("place_keep", WIDE, "gauges = 4\nkeep = \"all\"")
    else {
        return;
    };
    let (header, rows) = csv(&find_shared_path(CASE).unwrap().join("measured/gauges.csv"));
    assert_eq!(got.result["kept"].as_array().unwrap().len(), rows.len());
    assert!(got.number("log_det") > got.result["installed"]["log_det"].as_f64().unwrap());
    let s = sigmas(&got.result["load_sigma"]);
    let before = sigmas(&got.result["installed"]["load_sigma"]);
    assert!(s.iter().zip(before).all(|(a, b)| *a <= b * (1.0 + 1e-9)));
    let new = gauges(&got);
    assert_eq!(new.len(), 4);
    let x = header.iter().position(|h| h == "x_m").unwrap();
    for g in &new {
        let at = vector(g, "position");
        for row in &rows {
            let d: f64 = (0..3)
                .map(|c| (1000.0 * row[x + c].parse::<f64>().unwrap() - at[c]).powi(2))
                .sum::<f64>()
                .sqrt();
            // A kept gauge counts at the centre of its 40 mm element, up to 28 mm from the stated point.
            assert!(d >= 50.0 - 30.0, "{d}");
        }
    }
}

#[test]
fn gauges_stay_inside_boxes_and_clear_of_edges_joints_loads_and_attachments() {
    let rule = "angle_step_deg = 30\nboxes = [[[1500, 6500], [-500, 500]]]\nexclude_boxes = [[[3000, 4000], [0, 500]]]\n\
                clear_of = { edges = 30, joints = 30, loads = 300, attachments = 60 }";
    let Some((got, _)) = place_without_fault("place_clear", rule, "gauges = 14") else {
        return;
    };
    let read = nastran::bdf::read_deck(
        "frame.bdf",
        std::fs::read(find_shared_path(CASE).unwrap().join("frame.bdf")).unwrap(),
        &mut nastran::bdf::MemoryLoader::default(),
    );
    let (model, _) = strainbridge::model::Model::from_deck(&read);
    use strainbridge::placement::region::{attachments, free_edges, joints};
    let near = |x: &[f64], s: &[[strainbridge::model::Vec3; 2]]| -> f64 {
        // Distance to the middle and the ends. It is never less than the distance to the segment.
        let x = strainbridge::model::Vec3::new(x[0], x[1], x[2]);
        s.iter()
            .flat_map(|[a, b]| [*a, *b, (a + b) * 0.5])
            .map(|p| (p - x).norm())
            .fold(f64::INFINITY, f64::min)
    };
    for g in gauges(&got) {
        let x = vector(&g, "position");
        assert!(
            (1500.0..=6500.0).contains(&x[0]) && x[1].abs() <= 510.0,
            "{x:?}"
        );
        assert!(!((3000.0..=4000.0).contains(&x[0]) && x[1] > 10.0), "{x:?}");
        for (s, least) in [
            (free_edges(&model), 30.0),
            (joints(&model), 30.0),
            (attachments(&model), 60.0),
        ] {
            // Centres of elements keep the distance. Surfaces are half a thickness away from them.
            assert!(near(&x, &s) >= least - 4.0, "{x:?} {}", near(&x, &s));
        }
    }
}

#[test]
fn bridges_are_chosen_within_a_budget_and_their_file_serves_as_gauges() {
    let rule = "angle_step_deg = 45\nbridge = [\"quarter\", \"full-bending\", \"shear\"]";
    let Some((got, folder)) = place_without_fault(
        "place_bridges",
        rule,
        "gauges = 18\nbudget = 24\ncosts = { \"full-bending\" = 2, \"shear\" = 1.5 }",
    ) else {
        return;
    };
    assert!(got.number("cost") <= 24.0 + 1e-9);
    let list = gauges(&got);
    assert!(
        list.iter().any(|g| g["bridge"] != "quarter"),
        "some bridge is worth its cost"
    );
    let file = folder
        .join("out/gauges.csv")
        .display()
        .to_string()
        .replace('\\', "/");
    let (path, folder2) = job("place_bridges_again", rule, "").unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let at = text.find("[gauges]\nfile = \"").unwrap() + "[gauges]\nfile = \"".len();
    let end = at + text[at..].find('"').unwrap();
    std::fs::write(&path, format!("{}{file}{}", &text[..at], &text[end..])).unwrap();
    let again = run(
        &["sensitivity", path.to_str().unwrap()],
        &folder2.join("out"),
    );
    assert_eq!(again.code, 0, "{}", again.stderr);
    let (a, b) = (
        got.number("condition_number"),
        again.number("condition_number"),
    );
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
}

#[test]
fn pairs_mirror_each_other_and_rosettes_have_three_legs() {
    let Some((got, _)) = place_without_fault(
        "place_pairs",
        "angle_step_deg = 45",
        "gauges = 16\nsymmetric = \"y\"",
    ) else {
        return;
    };
    let list = gauges(&got);
    assert_eq!(list.len() % 2, 0);
    for pair in list.chunks(2) {
        let (a, b) = (vector(&pair[0], "position"), vector(&pair[1], "position"));
        let mirrored = [a[0], -a[1], a[2]];
        let d: f64 = (0..3)
            .map(|c| (mirrored[c] - b[c]).powi(2))
            .sum::<f64>()
            .sqrt();
        assert!(d < 1.0, "{a:?} {b:?}");
        let (u, v) = (vector(&pair[0], "direction"), vector(&pair[1], "direction"));
        let dot = u[0] * v[0] - u[1] * v[1] + u[2] * v[2];
        assert!(dot.abs() > 1.0 - 1e-6, "{u:?} {v:?}");
    }
    let (got, _) = place_without_fault(
        "place_rosettes",
        "angle_step_deg = 45\nrosette = \"rectangular\"",
        "gauges = 18\ncosts = { rosette = 1.5 }",
    )
    .unwrap();
    let names: Vec<String> = gauges(&got)
        .iter()
        .map(|g| g["name"].as_str().unwrap().to_owned())
        .collect();
    let legs = names.iter().filter(|n| n.ends_with(".b")).count();
    assert!(legs > 0, "at half the price rosettes win: {names:?}");
    assert!(got.number("efficiency_bound") > 0.8);
}

#[test]
fn a_layout_for_the_worst_loss_keeps_more_after_it_and_the_curve_falls() {
    let Some((plain, folder)) = place_without_fault(
        "place_curve",
        WIDE,
        "gauges = 12\ncurve = [9, 10, 12, 15]\nreserve = 2\nreferences = { front = 9001, payload = 9101 }\n\
         angle_tolerance_deg = 2.0\nposition_tolerance = 3.0\ngauge_factor_rel = 0.01",
    ) else {
        return;
    };
    let (robust, _) = place_without_fault(
        "place_robust",
        WIDE,
        "gauges = 12\nloss = \"optimise\"\nangle_tolerance_deg = 2.0\nposition_tolerance = 3.0\ngauge_factor_rel = 0.01",
    )
    .unwrap();
    let left = |o: &Outcome| {
        o.number("log_det")
            + 9.0
                * o.result["worst_loss"]["efficiency_left"]
                    .as_f64()
                    .unwrap()
                    .ln()
    };
    assert!(
        left(&robust) > left(&plain),
        "{} {}",
        left(&robust),
        left(&plain)
    );
    let curve = plain.result["how_many"].as_array().unwrap();
    assert_eq!(curve.len(), 4);
    assert_eq!(
        curve[0]["worst_loss"], 0.0,
        "nine gauges for nine loads: nothing may fail"
    );
    for w in curve.windows(2) {
        let (a, b) = (sigmas(&w[0]["load_sigma"]), sigmas(&w[1]["load_sigma"]));
        let product = |s: &[f64]| s.iter().map(|v| v.ln()).sum::<f64>();
        assert!(product(&b) < product(&a));
        let step = w[1]["gauges"].as_f64().unwrap() - w[0]["gauges"].as_f64().unwrap();
        for (l, load) in w[1]["load_sigma"].as_array().unwrap().iter().enumerate() {
            let bought = load["less_by_a_gauge"].as_f64().unwrap();
            assert!((bought - (a[l] - b[l]) / step).abs() < 1e-9);
        }
    }
    assert_eq!(plain.result["reserved"].as_array().unwrap().len(), 2);
    let kept: Vec<_> = gauges(&plain)
        .into_iter()
        .filter(|g| g["role"] == "validation")
        .collect();
    assert_eq!(kept.len(), 2);
    // Tolerances add scatter, so no gauge has less than its noise.
    assert!(
        gauges(&plain)
            .iter()
            .all(|g| g["sd_microstrain"].as_f64().unwrap() > 1.0)
    );
    let (header, rows) = csv(&folder.join("out/gluing_sheet.csv"));
    let col = |n: &str| header.iter().position(|h| h == n).unwrap();
    let load = col("range_LF.FZ_microstrain");
    assert_eq!(rows.len(), gauges(&plain).len());
    for (row, g) in rows.iter().zip(gauges(&plain)) {
        assert!(
            row[col("from_grid")].starts_with("front (9001)")
                || row[col("from_grid")].starts_with("payload (9101)")
        );
        let strain = g["strain_by_load"][0]["microstrain"].as_f64().unwrap();
        assert!((row[load].parse::<f64>().unwrap() - strain.abs()).abs() < 0.051);
        assert!(row[col("angle_budget_deg")].parse::<f64>().unwrap() > 0.0);
    }
}
