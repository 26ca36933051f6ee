//! The ladder frame of MYSTRAN: 20 gauges, 12 runs with known loads.

use super::command::{csv, find_shared_path, run, scratch};
use std::path::PathBuf;

const CASE: &str = "nastran/mystran_frame_units";

/// Writes the job, changed by `edit`, to a separate folder. Its paths refer to the case.
fn job(name: &str, edit: impl Fn(String) -> String) -> Option<(PathBuf, PathBuf)> {
    let case = find_shared_path(CASE)?;
    let folder = scratch(name);
    let text = std::fs::read_to_string(case.join("job.toml")).unwrap();
    let base = case.display().to_string().replace('\\', "/");
    let text = [
        "frame.bdf",
        "frame.op2",
        "measured/gauges.csv",
        "measured/strain.csv",
    ]
    .iter()
    .fold(text, |t, f| {
        t.replace(&format!("\"{f}\""), &format!("\"{base}/{f}\""))
    });
    let path = folder.join("job.toml");
    std::fs::write(&path, edit(text)).unwrap();
    Some((path, folder))
}

/// Returns the true loads in kN and kN m, with the payload force along the basic z axis.
fn truth() -> (Vec<String>, Vec<Vec<f64>>) {
    let (header, rows) = csv(&find_shared_path(CASE)
        .unwrap()
        .join("measured/loads_truth.csv"));
    let names: Vec<String> = header[2..]
        .iter()
        .map(|h| h.rsplit_once('_').unwrap().0.to_owned())
        .collect();
    let values = rows
        .iter()
        .map(|r| {
            r[2..]
                .iter()
                .zip(&names)
                .map(|(v, n)| {
                    v.parse::<f64>().unwrap() * if n == "payload.FZ" { -1.0 } else { 1.0 }
                })
                .collect()
        })
        .collect();
    (names, values)
}

#[test]
fn nine_loads_come_out_within_a_tenth_of_a_kilonewton_and_inside_their_intervals() {
    let Some((job, folder)) = job("frame_recover", |t| t) else {
        return;
    };
    let got = run(&["recover", job.to_str().unwrap()], &folder.join("out"));
    assert_eq!(got.code, 0, "{}", got.stderr);
    let (names, truth) = truth();
    let (header, rows) = csv(&folder.join("out/loads.csv"));
    let (mut square, mut covered, mut worst) = (0.0, 0, 0.0_f64);
    let loads = got.result["loads"].as_array().unwrap();
    for (r, row) in rows.iter().enumerate() {
        for (l, name) in names.iter().enumerate() {
            let at = header.iter().position(|h| h == name).unwrap();
            let v: Vec<f64> = row[at..at + 3].iter().map(|x| x.parse().unwrap()).collect();
            let error = v[0] - truth[r][l];
            if name.ends_with(".FZ") && !name.starts_with("payload") {
                square += error * error;
            }
            covered += usize::from(v[1] <= truth[r][l] && truth[r][l] <= v[2]);
            let entry = loads
                .iter()
                .find(|e| e["run"] == row[0] && e["name"] == *name)
                .unwrap();
            worst = worst.max((error / entry["sigma"].as_f64().unwrap()).abs());
        }
    }
    assert!(
        (square / 72.0).sqrt() <= 0.10,
        "wheel error {} kN rms",
        (square / 72.0).sqrt()
    );
    assert!((98..=107).contains(&covered), "{covered} of 108");
    assert!(worst < 4.0, "{worst} sigma");
}

#[test]
fn with_the_sensitivity_of_another_solver_and_its_error_stated_nine_intervals_in_ten_hold_the_truth()
 {
    // The readings come from strain of MYSTRAN. Without `results`, the built-in solver computes S on the same mesh.
    let edit = |t: String| {
        let lines: Vec<&str> = t.lines().filter(|l| !l.starts_with("results")).collect();
        lines
            .join("\n")
            .replace("[measured]", "[measured]\nmodel_uncertainty_rel = 0.01")
    };
    let Some((job, folder)) = job("frame_other_solver", edit) else {
        return;
    };
    let got = run(&["recover", job.to_str().unwrap()], &folder.join("out"));
    assert_eq!(got.code, 0, "{}", got.stderr);
    let (names, truth) = truth();
    let (header, rows) = csv(&folder.join("out/loads.csv"));
    let mut covered = 0;
    for (row, truth) in rows.iter().zip(&truth) {
        for (name, truth) in names.iter().zip(truth) {
            let at = header.iter().position(|h| h == name).unwrap();
            let v: Vec<f64> = row[at..at + 3].iter().map(|x| x.parse().unwrap()).collect();
            covered += usize::from(v[1] <= *truth && *truth <= v[2]);
        }
    }
    assert!(covered >= 98, "{covered} of 108");
}

#[test]
fn with_gravity_as_reference_gauges_at_zero_mean_the_wheels_carry_the_models_weight() {
    let Some((job, folder)) = job("frame_gravity", |t| {
        let text = t.replace("[measured]", "[measured]\nreference = \"gravity\"");
        let at = text.find("/measured/strain.csv").unwrap();
        let from = text[..at].rfind('"').unwrap();
        format!(
            "{}\"zeros.csv\"{}",
            &text[..from],
            &text[at + "/measured/strain.csv\"".len()..]
        )
    }) else {
        return;
    };
    let (header, _) = csv(&find_shared_path(CASE).unwrap().join("measured/strain.csv"));
    let zeros = vec!["0"; header.len() - 1].join(",");
    std::fs::write(
        folder.join("zeros.csv"),
        format!("{}\nstanding,{zeros}\n", header.join(",")),
    )
    .unwrap();
    let got = run(&["recover", job.to_str().unwrap()], &folder.join("out"));
    let deck = find_shared_path(CASE).unwrap().join("frame.bdf");
    let checked = run(&["check", deck.to_str().unwrap()], &folder.join("check"));
    let about = &checked.result["decks"][0];
    let weight = about["mass"].as_f64().unwrap() * 9806.65 / 1000.0;
    let cg: Vec<f64> = (0..2).map(|i| about["cg"][i].as_f64().unwrap()).collect();
    let read = nastran::bdf::read_deck(
        "frame.bdf",
        std::fs::read(&deck).unwrap(),
        &mut nastran::bdf::MemoryLoader::default(),
    );
    let (mut sum, mut moment) = (0.0, [0.0; 2]);
    assert!(!got.result["loads"].as_array().unwrap().is_empty());
    for load in got.result["loads"].as_array().unwrap() {
        let name = load["name"].as_str().unwrap();
        let value = load["value"].as_f64().unwrap();
        if name.starts_with("payload") {
            assert!(value.abs() < 1e-6 * weight, "{name} {value}");
            continue;
        }
        let id = 9001
            + ["LF.FZ", "RF.FZ", "LM.FZ", "RM.FZ", "LR.FZ", "RR.FZ"]
                .iter()
                .position(|n| *n == name)
                .unwrap() as u32;
        let x = read.cards.grids.iter().find(|g| g.id == id).unwrap().x;
        sum += value;
        (0..2).for_each(|i| moment[i] += value * (x[i] - cg[i]));
    }
    assert!(
        (sum - weight).abs() < 1e-6 * weight,
        "{sum} of {weight}: {}",
        got.stderr
    );
    // About the centre of gravity, in kN mm. The wheels are metres away from it.
    assert!(moment.iter().all(|m| m.abs() < 1e-3 * weight), "{moment:?}");
}

#[test]
fn six_wheel_loads_alone_end_with_an_error_finding() {
    let edit = |t: String| {
        let (head, tail) = (
            t.find("[[load]]\nname = \"payload.FZ\"").unwrap(),
            t.find("[gauges]").unwrap(),
        );
        format!("{}{}", &t[..head], &t[tail..])
    };
    let Some((job, folder)) = job("frame_six", edit) else {
        return;
    };
    let got = run(&["recover", job.to_str().unwrap()], &folder.join("out"));
    assert_eq!(got.code, 1, "{}", got.stderr);
    assert!(
        got.codes("error")
            .contains(&"strain-not-explained".to_owned())
    );
}

#[test]
fn sensitivities_at_the_gauges_are_those_of_the_op2() {
    let Some((job, folder)) = job("frame_sensitivity", |t| t) else {
        return;
    };
    let got = run(&["sensitivity", job.to_str().unwrap()], &folder.join("out"));
    assert_eq!(got.code, 0, "{}", got.stderr);
    assert_eq!(got.result["rank"], 9);
    let (_, ours) = csv(&folder.join("out/sensitivity.csv"));
    let (header, theirs) = csv(&find_shared_path(CASE)
        .unwrap()
        .join("measured/sensitivity_truth.csv"));
    assert!(!theirs.is_empty() && ours.len() == theirs.len());
    for (a, b) in ours.iter().zip(&theirs) {
        assert_eq!(a[0], b[0]);
        let row: Vec<f64> = b[1..].iter().map(|v| v.parse().unwrap()).collect();
        for (l, name) in header[1..].iter().enumerate() {
            // The reference is per kN and kN m with the payload force down. S is per N and N mm with the force along
            // the axis.
            let unit = if name.ends_with("FZ") { 1e3 } else { 1e6 };
            let sign = if name == "payload.FZ" { -1.0 } else { 1.0 };
            let v: f64 = a[l + 1].parse::<f64>().unwrap() * unit * sign;
            assert!(
                (v - row[l]).abs() <= 2e-4 * row[l].abs() + 2e-4,
                "{} {name}: {v} against {}",
                a[0],
                row[l]
            );
        }
    }
}

#[test]
fn a_layout_is_placed_next_to_the_installed_one_and_its_file_serves_as_a_jobs_gauges() {
    let Some((job_path, folder)) = job("frame_place", |t| t) else {
        return;
    };
    let got = run(&["place", job_path.to_str().unwrap()], &folder.join("out"));
    assert_eq!(got.code, 0, "{}", got.stderr);
    let gauges = got.result["gauges"].as_array().unwrap();
    assert_eq!(gauges.len(), 20);
    let at = |g: &serde_json::Value| -> Vec<f64> {
        g["position"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect()
    };
    for (i, a) in gauges.iter().enumerate() {
        for b in &gauges[..i] {
            let d: f64 = at(a)
                .iter()
                .zip(at(b))
                .map(|(x, y)| (x - y).powi(2))
                .sum::<f64>()
                .sqrt();
            assert!(d >= 50.0 - 1e-6, "{d} mm apart");
        }
    }
    let efficiency = got.number("efficiency_bound");
    assert!(efficiency > 0.9 && efficiency <= 1.0, "{efficiency}");
    assert!(
        got.number("log_det") > got.result["installed"]["log_det"].as_f64().unwrap(),
        "better than the installed one"
    );
    // The written file gives the same S if the job uses it.
    let placed = folder
        .join("out/gauges.csv")
        .display()
        .to_string()
        .replace('\\', "/");
    let installed = find_shared_path(CASE)
        .unwrap()
        .join("measured/gauges.csv")
        .display()
        .to_string()
        .replace('\\', "/");
    let (again, folder2) = job("frame_again", |t| t.replace(&installed, &placed)).unwrap();
    let second = run(
        &["sensitivity", again.to_str().unwrap()],
        &folder2.join("out"),
    );
    assert_eq!(second.code, 0, "{}", second.stderr);
    let (a, b) = (
        got.number("condition_number"),
        second.number("condition_number"),
    );
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
}

#[test]
fn the_unit_load_deck_reads_back_with_its_loads_and_requests() {
    let Some((job, folder)) = job("frame_cases", |t| t) else {
        return;
    };
    let got = run(&["cases", job.to_str().unwrap()], &folder.join("out"));
    assert_eq!(got.code, 0, "{}", got.stderr);
    assert_eq!(got.result["subcases"].as_array().unwrap().len(), 9);
    let bytes = std::fs::read(folder.join("out/unit_loads.bdf")).unwrap();
    let deck = nastran::bdf::read_deck(
        "unit_loads.bdf",
        bytes,
        &mut nastran::bdf::MemoryLoader::default(),
    );
    assert!(deck.faults.is_empty(), "{:?}", deck.faults.len());
    let subcases = deck.case_control.effective_subcases();
    assert_eq!(
        subcases.iter().map(|s| s.id).collect::<Vec<_>>(),
        (1..=9).collect::<Vec<_>>()
    );
    for (s, name) in subcases.iter().zip([
        "LF.FZ",
        "RF.FZ",
        "LM.FZ",
        "RM.FZ",
        "LR.FZ",
        "RR.FZ",
        "payload.FZ",
        "payload.MX",
        "payload.MY",
    ]) {
        assert_eq!(s.label.as_deref(), Some(name));
        assert_eq!(s.spc, None);
        let sid = s.load.unwrap();
        let acting = deck
            .cards
            .forces
            .iter()
            .chain(&deck.cards.moments)
            .filter(|f| f.sid == sid)
            .count();
        assert_eq!(acting, 1, "one load in {name}");
        let strain = s.request("STRAIN").unwrap();
        assert!(format!("{strain:?}").contains("FIBER"), "{strain:?}");
    }
    let down = deck
        .cards
        .forces
        .iter()
        .find(|f| f.grid == 9101 && f.sid > 1000)
        .unwrap();
    assert_eq!(down.scale * down.n[2], -1000.0);
    assert!(deck.param("POST").is_some() && deck.param("INREL").is_some());
}

#[test]
fn a_new_user_gets_a_layout_from_a_deck_and_an_op2_in_two_commands() {
    let Some(case) = find_shared_path(CASE) else {
        return;
    };
    let folder = scratch("frame_init");
    let (deck, op2) = (case.join("frame.bdf"), case.join("frame.op2"));
    let first = run(
        &["init", deck.to_str().unwrap(), op2.to_str().unwrap()],
        &folder,
    );
    assert_eq!(first.code, 0, "{}", first.stderr);
    let text = std::fs::read_to_string(folder.join("job.toml")).unwrap();
    assert!(
        text.contains("units = \"mm-t-s\"")
            && text.contains("grid = 9001")
            && text.contains("subcase = 39"),
        "{text}"
    );
    let checked = run(
        &["sensitivity", folder.join("job.toml").to_str().unwrap()],
        &folder.join("out"),
    );
    assert_ne!(checked.code, 2, "{}", checked.stderr);
}
