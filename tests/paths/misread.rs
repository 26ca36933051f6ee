//! Decks, results and jobs that are easily misread. Each gives the correct number, or a refusal that names the
//! unsupported item.

use crate::support::find_shared_path;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use strainbridge::fe::SolveOptions;
use strainbridge::{Context, Disk, Faults, Job, Outcome, Severity};

/// Displacements of grids: grid, component, value.
type Moves = &'static [(u32, usize, f64)];

/// Deck, displacements, and a word of the refusal that is accepted as well.
const DECKS: [(&str, Moves, Option<&str>); 16] = [
    // A name that is unknown in Nastran is an error at its line.
    ("case_control_typo/deck.bdf", &[], Some("SPCC")),
    ("unknown_card_typo/deck.bdf", &[], Some("FORCEE")),
    // F L / (E A) with offsets that make the bar 3 long.
    (
        "continuation_by_name/deck.bdf",
        &[(2, 0, 2.142_857e-6)],
        None,
    ),
    (
        "continuation_names_that_begin_with_plus/deck.bdf",
        &[(2, 0, 1.5e-5)],
        None,
    ),
    // A spring: F / k.
    ("deqatn_continuation/deck.bdf", &[(9, 2, 1.0)], None),
    ("implicit_spoint/deck.bdf", &[(9, 2, 1.0)], Some("CMASS3")),
    ("ese_list/deck.bdf", &[(2, 0, 2.0e-5)], None),
    // F / k at the spring, and F L / (E A) more at the other end.
    (
        "held_by_springs_alone/deck.bdf",
        &[(1, 0, 1.0e-3), (2, 0, 1.02e-3)],
        None,
    ),
    (
        "held_by_springs_alone/massless.bdf",
        &[(1, 0, 1.0e-3), (2, 0, 1.02e-3)],
        None,
    ),
    ("include_bare_name/main.bdf", &[(2, 0, 2.0e-5)], None),
    // The modulus from the table at the temperature is twice that of MAT1.
    ("matt1_ignored/deck.bdf", &[(3, 0, 5.0e-6)], Some("MATT1")),
    // The areas are .01 + .01 + .02.
    (
        "nastran95_elements_ignored/deck.bdf",
        &[(2, 0, 1.0e-5)],
        Some("CQDMEM"),
    ),
    (
        "nastran95_elements_ignored/crigd1.bdf",
        &[(3, 0, 2.0e-5)],
        Some("CRIGD1"),
    ),
    ("p2g_ignored/deck.bdf", &[(3, 0, 4.0e-5)], Some("P2G")),
    // A force of 1000 N, and pi^2 2 N from the rotating mass.
    (
        "rforce1_ignored/deck.bdf",
        &[(2, 0, 2.039_48e-5)],
        Some("RFORCE1"),
    ),
    (
        "unsupported_property_called_missing/deck.bdf",
        &[],
        Some("PBCOMP"),
    ),
];

/// Files contain single precision values, or six digits of a closed form.
const DIGITS: f64 = 2e-6;

fn cases(of: &str) -> Option<PathBuf> {
    find_shared_path(&format!("cases/{of}"))
}

fn words(faults: &Faults) -> String {
    let lines: Vec<String> = faults.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

/// Fails with every wrong line.
fn all_right(wrong: &[String]) {
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the codes of the findings of a severity.
fn codes<A>(outcome: &Outcome<A>, severity: Severity) -> Vec<String> {
    let findings = outcome.findings.iter().filter(|f| f.severity == severity);
    findings.map(|f| f.code.to_string()).collect()
}

fn is_within_tolerance(got: f64, right: f64, tolerance: f64) -> bool {
    (got - right).abs() <= tolerance * right.abs()
}

/// Returns the misread part of the solution of a deck.
fn misread(path: &Path, moves: Moves, refusal: Option<&str>) -> Option<String> {
    let solved = strainbridge::solve_deck(path, SolveOptions::default(), &Context::new(&Disk));
    let solved = match (solved, refusal) {
        (Err(faults), Some(word)) => {
            let text = words(&faults);
            let names = text.contains(word) && !text.contains("is missing");
            return (!names).then_some(text);
        }
        (Err(faults), None) => return Some(words(&faults)),
        (Ok(solved), _) => solved,
    };
    if moves.is_empty() {
        return Some("not refused".to_owned());
    }
    let errors = codes(&solved, Severity::Error);
    if !errors.is_empty() {
        return Some(format!("{errors:?}"));
    }
    moves.iter().find_map(|(grid, component, right)| {
        let grid = solved.deck.model.grid_ix(*grid)?;
        let got = solved.solution.cases[0].displacement[grid.us()][*component];
        (!is_within_tolerance(got, *right, DIGITS)).then(|| format!("{got:e} for {right:e}"))
    })
}

#[test]
fn decks_give_the_right_displacement_or_are_refused_by_name() {
    let Some(folder) = cases("decks") else { return };
    let row = |(deck, moves, refusal): &(&str, Moves, Option<&str>)| {
        misread(&folder.join(deck), moves, *refusal).map(|w| format!("{deck}: {w}"))
    };
    let wrong: Vec<String> = DECKS.iter().filter_map(row).collect();
    all_right(&wrong);
}

/// A material with yielding under SOL 106 with large displacements. It is refused, or a finding names all three.
#[test]
fn a_nonlinear_deck_is_not_solved_as_a_linear_one_in_silence() {
    let Some(folder) = cases("decks/nonlinear_solved_linear") else {
        return;
    };
    let path = folder.join("deck.bdf");
    let solved = strainbridge::solve_deck(&path, SolveOptions::default(), &Context::new(&Disk));
    let text = match &solved {
        Err(faults) => words(faults),
        Ok(s) => s
            .findings
            .iter()
            .map(|f| format!("{} {}\n", f.subject, f.message))
            .collect(),
    };
    let named = ["106", "LGDISP", "MATS1"]
        .iter()
        .filter(|w| text.contains(**w));
    let enough = if solved.is_err() { 1 } else { 3 };
    assert!(named.count() >= enough, "{text}");
}

fn check_files(files: &[PathBuf]) -> (serde_json::Value, Vec<String>) {
    let outcome = strainbridge::check(files, &Context::new(&Disk));
    let outcome = outcome.unwrap_or_else(|e| panic!("{e}"));
    let warnings = codes(&outcome, Severity::Warning);
    (serde_json::to_value(&outcome.answer).unwrap(), warnings)
}

#[test]
fn check_counts_mass_of_elements_and_reads_names_of_properties() {
    let Some(folder) = cases("decks") else { return };
    let deck = |name: &str| {
        let (found, _) = check_files(&[folder.join(name)]);
        found["decks"][0].clone()
    };
    // 20 on each element, and 3 on each of 2.
    let mass = deck("nsm_element_not_in_mass/deck.bdf")["mass"].clone();
    let names =
        ["n.bdf", "p.bdf"].map(|f| deck(&format!("property_names/{f}"))["property_names"].clone());
    let mut wrong = Vec::new();
    if !mass
        .as_f64()
        .is_some_and(|m| is_within_tolerance(m, 46.0, DIGITS))
    {
        wrong.push(format!("mass {mass}"));
    }
    let rails = serde_json::json!({ "1": "RailLeft", "2": "RailRight" });
    let mut all = rails.clone();
    all["3"] = "Cross".into();
    for (got, right) in names.into_iter().zip([all, rails]) {
        if got != right {
            wrong.push(format!("names {got} for {right}"));
        }
    }
    all_right(&wrong);
}

#[test]
fn a_subcase_that_is_twice_in_results_is_named_and_refused_where_s_comes_from_it() {
    let Some(folder) = cases("decks/subcase_twice_in_op2") else {
        return;
    };
    let at = |name: &str| folder.join(name);
    let cx = Context::new(&Disk);
    let mut wrong = Vec::new();
    let (_, warnings) = check_files(&[at("deck.bdf"), at("twice.op2")]);
    if !warnings.iter().any(|c| c == "subcase-ambiguous") {
        wrong.push(format!("check: {warnings:?}"));
    }
    let strains = strainbridge::strains(&at("deck.bdf"), &[at("twice.op2")], &cx);
    let warnings = strains.map(|s| codes(&s, Severity::Warning));
    if !warnings
        .as_ref()
        .is_ok_and(|w| w.iter().any(|c| c == "subcase-ambiguous"))
    {
        wrong.push(format!("strains: {warnings:?}"));
    }
    let jobs = ["case.toml", "job2.toml"].map(|job| ("decks/subcase_twice_in_op2", job));
    let overlaps = ["ov_first.toml", "ov_second.toml"].map(|job| ("jobs/overlap", job));
    for (folder, job) in jobs.into_iter().chain(overlaps) {
        match rows(folder, job) {
            Err(text) if text.contains("result") => {}
            other => wrong.push(format!("{job}: {other:?}")),
        }
    }
    all_right(&wrong);
}

/// Returns microstrain per job unit of the first load by channel, or the text of the refusal.
fn rows(folder: &str, job: &str) -> Result<BTreeMap<String, Vec<f64>>, String> {
    let path = cases(folder).unwrap_or_default().join(job);
    let job = Job::read(path.display().to_string(), &Disk).map_err(|e| words(&e))?;
    let sensed = strainbridge::sensitivity(&job, &Context::new(&Disk)).map_err(|e| words(&e))?;
    let s = &sensed.prepared.sensitivity;
    let row = |g: usize| -> Vec<f64> { s.values.row(g).iter().map(|v| 1e6 * v).collect() };
    let named = s.gauges.iter().enumerate();
    Ok(named.map(|(g, name)| (name.clone(), row(g))).collect())
}

/// Job, word of an accepted refusal, and readings for the first load.
type Readings = (
    &'static str,
    Option<&'static str>,
    &'static [(&'static str, f64)],
);

/// Bending strain at the skin of the cantilever with offsets.
const SKIN: f64 = 9.245_976_5;

const READINGS: [Readings; 9] = [
    // Radial strain of a plate in tension.
    (
        "element_gauge_cyl/case.toml",
        None,
        &[
            ("el1", 8.75),
            ("el4", 8.75),
            ("el6", 8.75),
            ("el7", 8.75),
            ("el10", 8.75),
            ("el16", 8.75),
        ],
    ),
    // The lower skin is in compression, the upper one in tension.
    (
        "position_zoffs/half.toml",
        None,
        &[("pos_z0.0", -SKIN), ("pos_z4.0", SKIN)],
    ),
    (
        "position_zoffs/ten.toml",
        None,
        &[("pos_z8.0", -SKIN), ("pos_z12.0", SKIN)],
    ),
    (
        "position_zoffs/minus.toml",
        None,
        &[("pos_z-12.0", -SKIN), ("pos_z-8.0", SKIN)],
    ),
    (
        "position_zoffs/pcomp.toml",
        None,
        &[("pos_z0.0", -SKIN), ("pos_z4.0", SKIN)],
    ),
    // M y / I about the centroid.
    (
        "pbarl_recovery/tee.toml",
        None,
        &[("C", -11.406), ("E", 30.598)],
    ),
    // M = w (L - x)^2 / 2.
    (
        "pload1_station/udl_CBAR.toml",
        Some("station"),
        &[
            ("g0", -158.730_16),
            ("g25", -89.285_71),
            ("g50", -39.682_54),
            ("g75", -9.920_635),
        ],
    ),
    // M = F (0.4 L - x), and zero beyond the force.
    (
        "pload1_station/pt_CBAR.toml",
        Some("station"),
        &[
            ("g0", -3.174_603),
            ("g25", -1.190_476),
            ("g50", 0.0),
            ("g75", 0.0),
        ],
    ),
    // M c / (E I) with I growing from 1 to 2.
    (
        "taper_station/tapM.toml",
        Some("station"),
        &[
            ("g0", -15.873_016),
            ("g25", -12.698_41),
            ("g50", -10.582_01),
            ("g100", -7.936_508),
        ],
    ),
];

#[test]
fn gauges_read_what_closed_forms_give() {
    if cases("jobs").is_none() {
        return;
    }
    let mut wrong = Vec::new();
    for (job, refusal, readings) in READINGS {
        let (folder, file) = job.split_once('/').unwrap();
        let rows = match (rows(&format!("jobs/{folder}"), file), refusal) {
            (Err(text), Some(word)) if text.contains(word) => continue,
            (Err(text), _) => {
                wrong.push(format!("{job}: {text}"));
                continue;
            }
            (Ok(rows), _) => rows,
        };
        for (gauge, right) in readings {
            let got = rows[*gauge][0];
            // The reference has five digits. A millionth of the other values counts as zero.
            if (got - right).abs() > 5e-5 * right.abs().max(0.02) {
                wrong.push(format!("{job} {gauge}: {got} for {right}"));
            }
        }
    }
    all_right(&wrong);
}

/// Returns the difference between rows that must be equal.
fn differ(what: &str, a: &[f64], b: &[f64]) -> Option<String> {
    let largest = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let off = a
        .iter()
        .zip(b)
        .any(|(a, b)| !((a - b).abs() <= 1e-9 * largest));
    off.then(|| format!("{what}: {b:?} for {a:?}"))
}

#[test]
fn rows_do_not_depend_on_the_numbering_of_shells_or_the_form_of_a_table() {
    if cases("jobs").is_none() {
        return;
    }
    let mut wrong = Vec::new();
    let pairs = [
        ("jobs/grid_over_flipped", "same.toml", "flipped.toml"),
        ("jobs/grid_over_flipped", "m_same.toml", "m_flipped.toml"),
        ("jobs/grid_over_flipped", "c_same.toml", "c_flipped.toml"),
        // The gluing sheet states the same place for every gauge.
        ("jobs/gauge_columns", "g1.toml", "g2.toml"),
    ];
    for (folder, a, b) in pairs {
        match (rows(folder, a), rows(folder, b)) {
            (Ok(a), Ok(b)) => {
                wrong.extend(a.iter().filter_map(|(g, row)| differ(g, row, b.get(g)?)));
                wrong.extend((a.len() != b.len()).then(|| format!("{folder}: {} rows", b.len())));
            }
            (a, b) => wrong.push(format!("{folder}: {:?} {:?}", a.err(), b.err())),
        }
    }
    // Without `surface2`, the second pair is on the other side. The program does not ignore `surface2` without
    // `element2`.
    match rows("jobs/surface2_default", "s2.toml") {
        Err(text) if text.contains("surface2") => {}
        Err(text) => wrong.push(text),
        Ok(rows) => {
            let half = &rows["t_hb_bot"];
            wrong.extend(differ("element2", half, &rows["t_hb_bot_el2same"]));
            let one_side = &rows["t_hb_top_s2top"];
            if one_side.iter().any(|v| v.abs() > 1e-9) {
                wrong.push(format!("surface2 = surface: {one_side:?}"));
            }
        }
    }
    // `G6.a` is a gauge and a leg of the rosette `G6`.
    match rows("jobs/gauge_twice", "d1.toml") {
        Err(text) if text.contains("G6.a") => {}
        other => wrong.push(format!("{:?}", other.map(|r| r.len()))),
    }
    all_right(&wrong);
}

fn recover_job(
    job: &str,
) -> Result<Outcome<strainbridge::workflow::recover::RecoveredLoads>, String> {
    let path = cases("jobs").unwrap_or_default().join(job);
    let job = Job::read(path.display().to_string(), &Disk).map_err(|e| words(&e))?;
    strainbridge::recover(&job, &Context::new(&Disk)).map_err(|e| words(&e))
}

/// Returns the value of a load in the first run.
fn load_of(got: &Outcome<strainbridge::workflow::recover::RecoveredLoads>, name: &str) -> f64 {
    let runs = got.runs().expect("runs");
    let load = runs.loads.iter().find(|l| l.name == name);
    load.expect("the load").value
}

#[test]
fn loads_of_runs_count_corrections_references_units_and_roles() {
    if cases("jobs").is_none() {
        return;
    }
    let mut wrong = Vec::new();
    match recover_job("correction_rosette/k_ign.toml") {
        Err(text) => wrong.extend((!text.contains("G6")).then_some(text)),
        Ok(got) => {
            let gauges = &got.runs().unwrap().gauges;
            let used = gauges
                .iter()
                .any(|g| g.name.starts_with("G6.") && g.leverage > 0.0);
            wrong.extend(used.then(|| "G6 is ignored, and its legs are used".to_owned()));
        }
    }
    match recover_job("reference_subcase/rfdeck.toml") {
        Err(text) => wrong.extend((!text.contains("reference")).then_some(text)),
        Ok(got) => {
            // 10,000 N of the subcase of the deck plus the change.
            let a = load_of(&got, "a");
            wrong.extend(
                (!is_within_tolerance(a, 10_628.651, 1e-5)).then(|| format!("reference: a {a}")),
            );
        }
    }
    match recover_job("per_default/case.toml") {
        Err(text) => wrong.push(text),
        Ok(got) => {
            // Without `per`, S is in the units of the job: 3 N and 2 N.
            let loads = [("A", 3e-3), ("B", 2e-3)];
            let off = loads
                .iter()
                .find(|(l, right)| !is_within_tolerance(load_of(&got, l), *right, 1e-6));
            wrong.extend(off.map(|l| format!("per: {l:?}")));
        }
    }
    match recover_job("reserve_role/gr.toml") {
        Err(text) => wrong.push(text),
        Ok(got) => {
            // P08 is a validation gauge. Its reading changes no load.
            let n = load_of(&got, "N.FZ");
            wrong.extend((!is_within_tolerance(n, 1.0, 1e-3)).then(|| format!("role: N.FZ {n}")));
        }
    }
    all_right(&wrong);
}

#[test]
fn columns_of_runs_that_are_not_read_are_named() {
    let Some(folder) = cases("jobs/runs_columns") else {
        return;
    };
    let job = Job::read(folder.join("rc.toml").display().to_string(), &Disk);
    let job = job.unwrap_or_else(|e| panic!("{e}"));
    match strainbridge::payload(&job, &Context::new(&Disk)) {
        Err(faults) => assert!(words(&faults).contains("payload_X"), "{faults}"),
        Ok(got) => {
            let named = codes(&got, Severity::Warning)
                .iter()
                .any(|c| c == "column-not-read");
            // Its place is known: 1.9 m, in the column `payload_X`.
            let r04 = got.payload.iter().find(|p| p.run == "R04");
            let place = r04.and_then(|p| p.position[0]);
            let read = place.is_some_and(|x| is_within_tolerance(x, 1.9, 1e-9));
            assert!(named || read, "R04 {place:?}");
        }
    }
}

#[test]
fn records_have_the_times_that_their_files_state() {
    let Some(folder) = cases("jobs") else { return };
    let mut wrong = Vec::new();
    for (job, rate) in [
        ("parquet_ms/case.toml", 100.0),
        ("excel_serial_time/case.toml", 100.0),
    ] {
        match recover_job(job) {
            Err(text) => wrong.push(text),
            Ok(got) => {
                // The times 0, 10, 20 have no stated unit.
                if codes(&got, Severity::Error) == ["time-unit-doubtful"] {
                    continue;
                }
                let found = got.record().and_then(|r| r.sample_rate_hz);
                // Serial days with ten digits have errors of 5 microseconds.
                if !found.is_some_and(|f| is_within_tolerance(f, rate, 1e-3)) {
                    wrong.push(format!("{job}: {found:?} Hz"));
                }
            }
        }
    }
    // A channel that starts later than the others: the result uses common times, or a refusal names the channel.
    let tdms = [
        ("tdms_start/case.toml".to_owned(), "P05", 400, 399),
        (
            folder
                .join("../decks/tdms_start_offset/case.toml")
                .display()
                .to_string(),
            "P1",
            20,
            15,
        ),
    ];
    for (job, channel, all, common) in tdms {
        match recover_job(&job) {
            Err(text) => wrong.extend((!text.contains(channel)).then_some(text)),
            Ok(got) => {
                let n = got.record().map_or(0, |r| r.samples);
                let fewer = n <= common && n < all;
                wrong.extend((!fewer).then(|| format!("{job}: {n} samples")));
            }
        }
    }
    all_right(&wrong);
}
