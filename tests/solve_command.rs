//! `solve` as a user sees it: faulty models are reported with file and line, and solutions are stored.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn strainbridge(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .env("STRAINBRIDGE_CACHE", kept_beside(arguments))
        .output()
        .unwrap()
}

/// Returns a folder for stored solutions next to the file of the command, so that every test has a separate one.
fn kept_beside(arguments: &[&str]) -> PathBuf {
    let file = Path::new(arguments.get(1).copied().unwrap_or_default());
    file.with_file_name("kept")
}

fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("solve_command")
        .join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// Returns the text of a stream, with further lines of a finding joined to the first.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace("\n    ", " ")
}

/// Returns a free strip of 8 x 2 quadrilaterals of 20 mm with grids 1 to 27. A pair of forces is load 1. `cards` are
/// appended.
fn strip(cards: &str) -> String {
    let mut deck = String::from(
        "SOL 101\nCEND\nSUBCASE 1\n  LOAD = 1\nBEGIN BULK\nPARAM,INREL,-2\n\
         MAT1,1,210000.,,.3,7.85-9\nPSHELL,1,1,2.0,1,,1\n\
         FORCE,1,1,0,100.,0.,0.,1.\n",
    );
    for i in 0..9 {
        for j in 0..3 {
            let _ = writeln!(deck, "GRID,{},,{}.,{}.,0.", 3 * i + j + 1, 20 * i, 20 * j);
        }
    }
    for i in 0..8 {
        for j in 0..2 {
            let a = 3 * i + j + 1;
            let _ = writeln!(
                deck,
                "CQUAD4,{},1,{a},{},{},{}",
                2 * i + j + 1,
                a + 3,
                a + 4,
                a + 1
            );
        }
    }
    deck.push_str(cards);
    deck.push_str("ENDDATA\n");
    deck
}

/// Runs `solve` on a deck. Returns exit code, standard error and folder.
fn solve(name: &str, deck: &str) -> (i32, String, PathBuf) {
    let dir = folder(name);
    let path = dir.join("model.bdf");
    std::fs::write(&path, deck).unwrap();
    let out = strainbridge(&["solve", path.to_str().unwrap()]);
    (out.status.code().unwrap_or(-1), text(&out.stderr), dir)
}

/// Returns the line of the first card that starts with `card`, from 1.
fn line_of(deck: &str, card: &str) -> usize {
    1 + deck.lines().position(|l| l.starts_with(card)).unwrap()
}

/// Fails unless the deck is refused with a message that has the line of the card and contains all of `words`.
#[track_caller]
fn assert_deck_refused(name: &str, deck: &str, card: &str, words: &[&str]) {
    let (code, err, dir) = solve(name, deck);
    assert_eq!(code, 2, "{name}: {err}");
    let place = format!("model.bdf:{}:", line_of(deck, card));
    let line = err
        .lines()
        .find(|l| l.contains(&place) && words.iter().all(|w| l.contains(w)));
    assert!(line.is_some(), "{name}: {place} {words:?} not in\n{err}");
    assert!(
        !dir.join("model.out").join("results.op2").exists(),
        "{name}"
    );
}

#[test]
fn a_sound_free_strip_is_solved() {
    let (code, err, dir) = solve("sound", &strip(""));
    assert_eq!(code, 0, "{err}");
    for file in ["result.json", "results.op2", "results.vtu", "report.html"] {
        assert!(dir.join("model.out").join(file).exists(), "{file}");
    }
}

#[test]
fn each_kind_of_bad_model_has_a_message_of_its_own_at_its_line() {
    assert_deck_refused(
        "missing_property",
        &strip("CQUAD4,90,77,1,4,5,2\n"),
        "CQUAD4,90",
        &["CQUAD4 90", "77", "missing"],
    );
    assert_deck_refused(
        "missing_material",
        &strip("PSHELL,5,44,1.0\nCQUAD4,90,5,1,4,5,2\n"),
        "PSHELL,5",
        &["PSHELL 5", "44", "missing"],
    );
    assert_deck_refused(
        "zero_length_bar",
        &strip("PBAR,9,1,10.,100.,100.,200.\nGRID,60,,0.,0.,0.\nCBAR,90,9,1,60,0.,0.,1.\n"),
        "CBAR,90",
        &["CBAR 90", "length"],
    );
    assert_deck_refused(
        "negative_thickness",
        &strip("PSHELL,5,1,-1.0\nCQUAD4,90,5,1,4,5,2\n"),
        "PSHELL,5",
        &["PSHELL 5", "thickness"],
    );
    assert_deck_refused(
        "duplicate_element",
        &strip("CQUAD4,90,1,1,4,5,2\nCQUAD4,90,1,4,7,8,5\n"),
        "CQUAD4,90,1,4",
        &["CQUAD4 90", "twice"],
    );
    assert_deck_refused(
        "duplicate_grid",
        &strip("GRID,4,,1.,2.,3.\n"),
        "GRID,4,,1.,2.,3.",
        &["GRID 4", "twice"],
    );
    assert_deck_refused(
        "missing_grid",
        &strip("CQUAD4,90,1,1,4,5,555\n"),
        "CQUAD4,90",
        &["CQUAD4 90", "555", "missing"],
    );
    assert_deck_refused(
        "rbe3_on_a_line",
        &strip("GRID,60,,20.,0.,50.\nRBE3,91,,60,123456,1.0,123,1,4,\n,7\n"),
        "RBE3,91",
        &["RBE3 91", "line"],
    );
    assert_deck_refused(
        "dependent_twice",
        &strip("RBE2,91,1,123456,20\nRBE2,92,2,123456,20\n"),
        "RBE2,92",
        &["92", "grid 20", "dependent already"],
    );
    assert_deck_refused(
        "no_set",
        &strip("").replace("LOAD = 1", "LOAD = 8"),
        "  LOAD = 8",
        &["LOAD = 8"],
    );
}

#[test]
fn mechanisms_are_named_before_anything_is_solved() {
    // A hinge about the axis of a bar and across it connects the bar to the strip. Nothing resists its rotation.
    let hinge =
        strip("PBAR,9,1,10.,100.,100.,200.\nGRID,60,,-80.,0.,0.\nCBAR,90,9,1,60,0.,0.,1.,\n,456\n");
    assert_deck_refused(
        "hinge",
        &hinge,
        "GRID,60",
        &["grid 60", "is not held", "CBAR 90"],
    );
    // A second strip without any connection.
    let island = strip(
        "GRID,61,,0.,0.,99.\nGRID,62,,20.,0.,99.\nGRID,63,,20.,20.,99.\nCTRIA3,90,1,61,62,63\n",
    );
    let (code, err, _) = solve("island", &island);
    assert_eq!(code, 2, "{err}");
    assert!(
        err.contains("grid 61") && err.contains("not joined"),
        "{err}"
    );
    // An SPC set that leaves the strip free to slide.
    let sliding = strip("SPC1,5,3456,1,THRU,27\n")
        .replace("LOAD = 1", "LOAD = 1\n  SPC = 5")
        .replace("PARAM,INREL,-2\n", "");
    let (code, err, _) = solve("sliding", &sliding);
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("is not held"), "{err}");
    // The message names the set and the motions: the strip slides along x and along y.
    let printed = err.lines().find(|l| l.contains("SPC set 5")).unwrap();
    assert!(
        printed.contains("motions remain")
            && printed.contains("dof 1")
            && printed.contains("dof 2"),
        "{printed}"
    );
    // If no set is selected, the message states it.
    let (_, err, _) = solve("hinge_again", &hinge);
    assert!(
        err.contains("no SPC set is selected") && err.contains("grid 60 dof 3"),
        "{err}"
    );
}

#[test]
fn a_grid_in_no_element_is_a_note_and_a_load_on_it_an_error() {
    let (code, err, _) = solve("unattached", &strip("GRID,60,,0.,0.,50.\n"));
    assert_eq!(code, 0, "{err}");
    assert!(
        err.contains("GRID 60") && err.contains("no element uses it"),
        "{err}"
    );
    assert_deck_refused(
        "loaded_unattached",
        &strip("GRID,60,,0.,0.,50.\nFORCE,1,60,0,1.,0.,0.,1.\n"),
        "GRID,60",
        &["grid 60", "no element holds"],
    );
}

#[test]
fn gravity_alone_on_a_free_structure_is_reported_as_without_strain() {
    let deck = strip("GRAV,7,,9810.,0.,0.,-1.\n").replace("LOAD = 1", "LOAD = 7");
    let (code, err, dir) = solve("gravity", &deck);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("strain is zero"), "{err}");
    let json = std::fs::read(dir.join("model.out/result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let applied = result["balance"][0]["applied"][2].as_f64().unwrap();
    // 160 x 40 x 2 mm of steel.
    let weight = -9810.0 * 7.85e-9 * 160.0 * 40.0 * 2.0;
    assert!((applied / weight - 1.0).abs() < 1e-9, "{applied} {weight}");
    let page = std::fs::read_to_string(dir.join("model.out/report.html")).unwrap();
    assert!(
        page.contains("Balance") && page.contains("Inertia"),
        "{page}"
    );
}

/// Returns `result.json` without times and memory of the run.
fn answer(dir: &Path) -> String {
    let json = std::fs::read_to_string(dir.join("result.json")).unwrap();
    json.lines()
        .take_while(|l| !l.contains("\"seconds\""))
        .filter(|l| !l.contains("peak_memory_bytes"))
        .map(|l| format!("{l}\n"))
        .collect()
}

fn list_kept_files(dir: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(dir.join("kept"))
        .map(|list| list.map(|e| e.unwrap().path()).collect())
        .unwrap_or_default()
}

#[test]
fn a_kept_solution_gives_the_same_answer_and_nothing_is_kept_next_to_the_deck() {
    let (code, first, dir) = solve("kept", &strip(""));
    assert_eq!(code, 0, "{first}");
    assert!(!first.contains("cache"), "{first}");
    let [file] = list_kept_files(&dir).try_into().unwrap();
    assert!(!dir.join("model.cache").exists());
    let deck = dir.join("model.bdf");
    let run = |out: &str, extra: &[&str]| {
        let out = dir.join(out);
        let mut arguments = vec![
            "solve",
            deck.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ];
        arguments.extend(extra);
        let done = strainbridge(&arguments);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        (out, text(&done.stderr))
    };
    let (again, err) = run("again", &[]);
    assert!(err.contains("a stored solution is used"), "{err}");
    let base = dir.join("model.out");
    assert_eq!(answer(&base), answer(&again));
    for name in ["results.op2", "results.vtu"] {
        let read = |d: &Path| std::fs::read(d.join(name)).unwrap();
        assert!(read(&base) == read(&again), "{name}");
    }
    // A damaged file is ignored, reported and replaced.
    let mut bytes = std::fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&file, &bytes).unwrap();
    let (repaired, err) = run("repaired", &[]);
    assert!(
        err.contains("solved again") && err.contains("damaged"),
        "{err}"
    );
    assert_eq!(answer(&base), answer(&repaired));
    // --no-cache neither reads nor writes.
    std::fs::remove_file(&file).unwrap();
    let (_, err) = run("without", &["--no-cache"]);
    assert!(!err.contains("cache"), "{err}");
    assert!(list_kept_files(&dir).is_empty());
}

#[test]
fn a_changed_deck_is_solved_again() {
    let (_, _, dir) = solve("changed", &strip(""));
    let deck = dir.join("model.bdf");
    std::fs::write(&deck, strip("").replace("PSHELL,1,1,2.0", "PSHELL,1,1,3.0")).unwrap();
    let done = strainbridge(&["solve", deck.to_str().unwrap()]);
    assert_eq!(done.status.code(), Some(0));
    let err = text(&done.stderr);
    assert!(!err.contains("a stored solution is used"), "{err}");
    assert_eq!(list_kept_files(&dir).len(), 2);
}

/// Returns a job with two loads and three gauges on the strip.
fn job(measured: &str) -> String {
    let mut job =
        String::from("units = \"mm-t-s\"\n[model]\ndeck = \"model.bdf\"\nmesh_error = false\n");
    for (name, grid) in [("A", 13), ("B", 27)] {
        let _ = write!(
            job,
            "[[load]]\nname = \"{name}\"\ngrid = {grid}\ncomponent = \"FZ\"\n"
        );
    }
    for element in [5, 8, 12] {
        let _ = write!(
            job,
            "[[gauge]]\nname = \"g{element}\"\nelement = {element}\nsurface = \"top\"\ndirection = [1, 0, 0]\n"
        );
    }
    job + measured
}

#[test]
fn recover_takes_the_solution_of_sensitivity_and_warns_of_content_near_the_first_mode() {
    let dir = folder("recover");
    std::fs::write(dir.join("model.bdf"), strip("")).unwrap();
    // 60 Hz is far below the first mode of a strip of 160 mm in 2 mm steel (about 400 Hz).
    let slow = job("[measured]\nstrain = \"slow.csv\"\nnoise_microstrain = 1e-4\n");
    let fast = slow.replace("slow.csv", "fast.csv");
    std::fs::write(dir.join("job.toml"), &slow).unwrap();
    for (name, hz) in [("slow.csv", 60.0), ("fast.csv", 300.0)] {
        let mut csv = String::from("time,g5,g8,g12\n");
        for i in 0..4096 {
            let t = f64::from(i) / 2000.0;
            let v = 10.0 * (std::f64::consts::TAU * hz * t).sin();
            let _ = writeln!(csv, "{t},{v},{},{}", 0.5 * v, 0.2 * v);
        }
        std::fs::write(dir.join(name), csv).unwrap();
    }
    let path = dir.join("job.toml");
    let run = |command: &str| {
        let done = strainbridge(&[command, path.to_str().unwrap(), "-v"]);
        let err = text(&done.stderr);
        // No load gives this ratio of the readings of three gauges.
        let is_wrong = command == "recover";
        let code = i32::from(is_wrong);
        assert_eq!(done.status.code(), Some(code), "{command}: {err}");
        assert_eq!(err.contains("[strain-not-explained]"), is_wrong, "{err}");
        err
    };
    assert!(!run("sensitivity").contains("a stored solution is used"));
    let err = run("recover");
    assert!(err.contains("a stored solution is used"), "{err}");
    assert!(!err.contains("first elastic mode"), "{err}");
    std::fs::write(&path, fast).unwrap();
    let err = run("recover");
    assert!(err.contains("a stored solution is used"), "{err}");
    assert!(err.contains("first elastic mode"), "{err}");
    let json = std::fs::read(dir.join("job.out/result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_slice(&json).unwrap();
    // A free uniform beam has 4.73^2 / 2 pi sqrt(EI / (m L^4)) = 410 Hz. A plate strip is slightly stiffer across.
    let first = result["first_elastic_mode_hz"].as_f64().unwrap();
    assert!((first / 415.0 - 1.0).abs() < 0.06, "{first}");
    let content = result["content_hz"][0].as_f64().unwrap();
    assert!((content - 300.0).abs() < 5.0, "{content}");
    // With strain from a results file, the modes are still solved for the record.
    let done = strainbridge(&["solve", path.to_str().unwrap()]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let with_results = std::fs::read_to_string(&path).unwrap().replace(
        "deck = \"model.bdf\"\n",
        "deck = \"model.bdf\"\nresults = [\"job.out/results.op2\"]\n",
    );
    let other = dir.join("with_results.toml");
    std::fs::write(&other, with_results).unwrap();
    let done = strainbridge(&["recover", other.to_str().unwrap()]);
    let err = text(&done.stderr);
    assert!(err.contains("first elastic mode"), "{err}");
    let json = std::fs::read(dir.join("with_results.out/result.json")).unwrap();
    let again: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let other = again["first_elastic_mode_hz"].as_f64().unwrap();
    assert!((other / first - 1.0).abs() < 1e-6, "{other} {first}");
}

/// Element types of a result file: 33 is CQUAD4 at the centre, 144 with corners (MSC Nastran Quick Reference Guide,
/// item codes).
#[test]
fn strain_is_written_where_the_deck_asks_for_it() {
    for (request, written) in [
        ("", 144),
        ("STRAIN(PLOT,FIBER) = ALL\n", 33),
        ("STRAIN(PLOT,FIBER,BILIN) = ALL\n", 144),
    ] {
        let deck = strip("").replacen("SUBCASE 1", &format!("{request}SUBCASE 1"), 1);
        let (code, err, dir) = solve("corners", &deck);
        assert_eq!(code, 0, "{err}");
        let bytes = std::fs::read(dir.join("model.out/results.op2")).unwrap();
        let file = nastran::op2::Op2::read(&bytes).unwrap();
        let strain = nastran::results::Quantity::Strain;
        let types: Vec<u32> = (file.blocks.iter())
            .filter(|b| b.quantity == strain)
            .filter_map(|b| b.element.map(|e| e.0))
            .collect();
        assert_eq!(types, [written], "{request}");
    }
}

/// Returns a cantilever plate of 1,000 x 100 x 10 mm with 40 x 4 quadrilaterals, clamped at x = 0 by SPC set 1. A force
/// of 100 N along z acts in the middle of its tip.
fn cantilever(case_control: &str) -> String {
    let mut deck = format!(
        "SOL 101\nCEND\n{case_control}SUBCASE 1\n  LOAD = 1\nBEGIN BULK\nMAT1,1,210000.,,.3,7.85-9\nPSHELL,1,1,10.,1,,1\n\
         FORCE,1,203,0,100.,0.,0.,1.\nSPC1,1,123456,1,THRU,5\n"
    );
    for i in 0..41 {
        for j in 0..5 {
            let _ = writeln!(deck, "GRID,{},,{}.,{}.,0.", 5 * i + j + 1, 25 * i, 25 * j);
        }
    }
    for i in 0..40 {
        for j in 0..4 {
            let (a, id) = (5 * i + j + 1, 4 * i + j + 1);
            let _ = writeln!(deck, "CQUAD4,{id},1,{a},{},{},{}", a + 5, a + 6, a + 1);
        }
    }
    deck.push_str("ENDDATA\n");
    deck
}

/// Writes a job with the tip load of 100 N and a gauge on element 21 (x = 137.5 mm), along the plate on top. `support`
/// is a line of [model].
fn on_support(name: &str, support: &str) -> PathBuf {
    let dir = folder(name);
    std::fs::write(dir.join("canti.bdf"), cantilever("SPC = 1\n")).unwrap();
    let job = format!(
        "title = \"c\"\nunits = \"mm-t-s\"\n[model]\ndeck = \"canti.bdf\"\nmesh_error = false\n{support}\n\
         [[load]]\nname = \"tip\"\ngrid = 203\ncomponent = \"FZ\"\napplied = 100.0\nexpected = 100.0\n\
         [[gauge]]\nname = \"a\"\nelement = 22\nsurface = \"top\"\ndirection = [1, 0, 0]\n"
    );
    let path = dir.join("job.toml");
    std::fs::write(&path, job).unwrap();
    path
}

fn json_of(command: &str, job: &Path) -> serde_json::Value {
    let out = strainbridge(&[command, job.to_str().unwrap(), "--json"]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    serde_json::from_slice(&out.stdout).unwrap()
}

/// Returns the microstrain of the gauge per newton at the tip, from sensitivity.csv.
fn sensitivity_of(job: &Path) -> f64 {
    json_of("sensitivity", job);
    let table = std::fs::read_to_string(job.with_file_name("job.out/sensitivity.csv")).unwrap();
    let row = table.lines().nth(1).unwrap();
    row.split(',').nth(1).unwrap().parse().unwrap()
}

#[test]
fn a_job_whose_deck_selects_supports_is_solved_on_them_and_free_if_it_states_free() {
    let job = on_support("held_job", "");
    // Beam theory: the strain at the surface under the tip load is M t / 2 / (E I) with I = b t^3 / 12.
    let exact = |x: f64| 1e6 * (1000.0 - x) * 5.0 / (210_000.0 * 100.0 * 1000.0 / 12.0);
    let held = sensitivity_of(&job);
    // The element of the gauge is at x = 137.5. The Poisson effect and shear lag of the plate are a few per cent.
    assert!((held.abs() / exact(137.5) - 1.0).abs() < 0.03, "{held}");
    let solved = json_of("solve", &job);
    assert_eq!(solved["support"], "held by SPC set 1");
    let total = solved["reactions"][0]["total"].as_array().unwrap();
    assert!(
        (total[2].as_f64().unwrap() + 100.0).abs() < 1e-6,
        "{total:?}"
    );
    // With the set named by its number, the result is the same. A free plate has hardly any strain.
    let named = sensitivity_of(&on_support("named_job", "support = 1"));
    assert_eq!(named, held);
    let free = sensitivity_of(&on_support("free_job", "support = \"free\""));
    assert!(free.abs() < 0.2 * held.abs(), "{free} {held}");
}

#[test]
fn a_payload_on_supports_is_weighed_by_strain_alone() {
    let job = on_support("payload_held", "");
    let dir = job.parent().unwrap();
    // By beam theory, 200 N and 500 N down at the tip put the upper side in tension. The plate agrees within 3 %.
    let exact = |newton: f64| 1e6 * newton * 862.5 * 5.0 / (210_000.0 * 100.0 * 1000.0 / 12.0);
    let rows = [("empty", 0.0), ("light", 200.0), ("heavy", 500.0)];
    let lines: Vec<String> = rows
        .iter()
        .map(|(run, n)| format!("{run},{}", exact(*n)))
        .collect();
    std::fs::write(
        dir.join("strain.csv"),
        format!("run,a\n{}\n", lines.join("\n")),
    )
    .unwrap();
    let text = std::fs::read_to_string(&job).unwrap()
        + "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.1\n\
           [payload]\ngrid = 203\nunloaded = \"empty\"\nposition = \"known\"\n";
    std::fs::write(&job, text).unwrap();
    let result = json_of("payload", &job);
    let found = result["payload"].as_array().unwrap();
    for (run, newton) in [("light", 200.0), ("heavy", 500.0)] {
        let row = found.iter().find(|r| r["run"] == run).unwrap();
        assert_eq!(row["unit"], "N");
        let force = row["force"].as_f64().unwrap();
        assert!((force / newton - 1.0).abs() < 0.03, "{run}: {row}");
    }
    let codes = result["findings"].as_array().unwrap();
    assert!(codes.iter().any(|f| f["code"] == "payload-on-supports"));
}

/// Writes a job of the plate on supports with a [payload]. The strain of the runs is that of beam theory for forces
/// down at the tip, times `unit`.
fn weighed_plate(name: &str, forces: &[f64], unit: f64, keys: &str) -> PathBuf {
    let job = on_support(name, "");
    let mut table = "run,a\n".to_owned();
    for (i, newton) in forces.iter().enumerate() {
        let strain = 1e6 * newton * 862.5 * 5.0 / (210_000.0 * 100.0 * 1000.0 / 12.0);
        let _ = writeln!(table, "R{},{}", i + 1, strain * unit);
    }
    std::fs::write(job.with_file_name("strain.csv"), table).unwrap();
    let text = std::fs::read_to_string(&job).unwrap()
        + "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 5\n[payload]\ngrid = 203\n"
        + keys;
    std::fs::write(&job, text).unwrap();
    job
}

#[test]
fn a_refused_payload_states_the_reason_in_its_row_and_leaves_the_others_alone() {
    let job = weighed_plate("payload_refused", &[200.0, -300.0, 500.0], 1.0, "");
    let out = strainbridge(&["payload", job.to_str().unwrap()]);
    assert_eq!(out.status.code(), Some(1), "{}", text(&out.stderr));
    let table = std::fs::read_to_string(job.with_file_name("job.out/payload.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|l| l.splitn(10, ',').collect()).collect();
    assert_eq!(rows[0][9], "refused");
    for (row, newton) in [(1, 200.0), (3, 500.0)] {
        // Beam theory and the plate differ by 3 %.
        let force: f64 = rows[row][1].parse().unwrap();
        assert!((force / newton - 1.0).abs() < 0.03, "{table}");
        assert_eq!(rows[row][9], "");
    }
    assert_eq!(rows[2][1], "");
    assert!(rows[2][9].contains("cannot be negative"), "{table}");
    // 200 N are 0.0204 t.
    let printed = text(&out.stdout);
    assert!(
        printed.contains("0.020") || printed.contains("0.019"),
        "{printed}"
    );
}

#[test]
fn a_payload_from_readings_in_millistrain_is_an_error_as_for_recovered_loads() {
    let forces: Vec<f64> = (0..9).map(|i| 200.0 + 30.0 * f64::from(i)).collect();
    let job = weighed_plate("payload_milli", &forces, 1e-3, "");
    let out = strainbridge(&["payload", job.to_str().unwrap(), "--json"]);
    assert_eq!(out.status.code(), Some(1), "{}", text(&out.stderr));
    let result: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let findings = result["findings"].as_array().unwrap();
    let named = findings.iter().any(|f| f["code"] == "readings-below-noise");
    assert!(named, "{findings:?}");
}

#[test]
fn a_gravity_in_millimetres_is_refused_with_its_unit() {
    let job = weighed_plate("payload_gravity", &[200.0], 1.0, "gravity = 9806.65\n");
    let out = strainbridge(&["payload", job.to_str().unwrap()]);
    assert_eq!(out.status.code(), Some(2));
    let told = text(&out.stderr);
    assert!(
        told.contains("payload.gravity") && told.contains("m/s2"),
        "{told}"
    );
}

#[test]
fn a_support_that_the_deck_lacks_is_refused_with_the_line_of_the_job() {
    let job = on_support("missing_support", "support = 9");
    for command in ["solve", "place", "cases", "modes"] {
        let out = strainbridge(&[command, job.to_str().unwrap()]);
        assert_eq!(out.status.code(), Some(2), "{command}");
        let told = text(&out.stderr);
        assert!(
            told.contains("job.toml:6") && told.contains("SPC set 9"),
            "{told}"
        );
    }
    let job = on_support("odd_support", "support = \"floating\"");
    let out = strainbridge(&["solve", job.to_str().unwrap()]);
    assert_eq!(out.status.code(), Some(2));
}

#[test]
fn the_unit_load_deck_keeps_the_support_and_asks_for_no_relief() {
    let job = on_support("held_cases", "");
    json_of("cases", &job);
    let deck = std::fs::read_to_string(job.with_file_name("job.out/unit_loads.bdf")).unwrap();
    assert!(
        deck.contains("SPC = 1") && !deck.contains("INREL"),
        "{deck}"
    );
    let job = on_support("free_cases", "support = \"free\"");
    json_of("cases", &job);
    let deck = std::fs::read_to_string(job.with_file_name("job.out/unit_loads.bdf")).unwrap();
    assert!(
        !deck.contains("SPC = 1") && deck.contains("PARAM,INREL,-2"),
        "{deck}"
    );
}

/// E halves at 100 degrees, so gauges read twice the strain. The unit-load deck selects the same temperatures and
/// masses.
#[test]
fn a_job_takes_materials_at_the_temperatures_that_its_deck_selects() {
    let job = on_support("hot_job", "");
    let cold = sensitivity_of(&job);
    let selected = "  LOAD = 1\n  TEMP(MATERIAL) = 3\n  NSM = 8\n";
    let cards = "MATT1,1,9\nTABLEM1,9\n,0.,210000.,100.,105000.,ENDT\nTEMPD,3,100.\nNSM1,8,ELEMENT,1.-9,1\nENDDATA\n";
    let deck = cantilever("SPC = 1\n")
        .replace("  LOAD = 1\n", selected)
        .replace("ENDDATA\n", cards);
    std::fs::write(job.with_file_name("canti.bdf"), deck).unwrap();
    let hot = sensitivity_of(&job);
    // The table has six digits.
    assert!((hot / cold - 2.0).abs() < 1e-5, "{hot} {cold}");
    json_of("cases", &job);
    let deck = std::fs::read_to_string(job.with_file_name("job.out/unit_loads.bdf")).unwrap();
    assert!(deck.contains("TEMPERATURE(MATERIAL) = 3"), "{deck}");
    assert!(deck.contains("NSM = 8"), "{deck}");
}

#[test]
fn modes_of_a_held_deck_of_sol_103_are_those_of_the_clamped_beam() {
    let dir = folder("modes_deck");
    let path = dir.join("canti.bdf");
    let deck = cantilever("SPC = 1\n")
        .replace("SOL 101", "SOL 103")
        .replace("  LOAD = 1\n", "");
    std::fs::write(&path, deck).unwrap();
    let out = strainbridge(&["modes", path.to_str().unwrap(), "--modes", "3", "--json"]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let result: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let hz = result["modes"][0]["hz"].as_f64().unwrap();
    // Euler: 1.8751^2 / (2 pi l^2) sqrt(E t^2 / (12 rho)). A strip with a width of a tenth of its length is stiffer by
    // less than 1 %.
    let exact = 1.875_104_f64.powi(2) / (std::f64::consts::TAU * 1e6)
        * (210_000.0 * 100.0 / (12.0 * 7.85e-9_f64)).sqrt();
    assert!((hz / exact - 1.0).abs() < 0.01, "{hz} {exact}");
    assert_eq!(result["rigid_motions"], 0);
    assert!((result["modes"][0]["generalised_mass"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    for file in ["modes.csv", "modes.op2", "modes.vtu", "report.html"] {
        assert!(dir.join("canti.out").join(file).exists(), "{file}");
    }
    // The result file contains the shapes: eigenvectors of as many modes.
    let bytes = std::fs::read(dir.join("canti.out/modes.op2")).unwrap();
    let file = nastran::results::ResultsFile::read(&bytes, "modes.op2").unwrap();
    let shapes = file
        .blocks()
        .iter()
        .filter(|b| b.quantity == nastran::results::Quantity::Eigenvector);
    assert_eq!(shapes.count(), 3);
}

#[test]
fn a_free_deck_without_relief_reports_that_relief_was_assumed() {
    let deck = strip("").replace("PARAM,INREL,-2\n", "");
    let (code, told, _) = solve("assumed_relief", &deck);
    assert_eq!(code, 0, "{told}");
    assert!(told.contains("Nastran would stop"), "{told}");
}

#[test]
fn check_warns_of_a_shell_property_that_is_not_carried_and_solve_refuses_it() {
    let dir = folder("property_not_carried");
    let path = dir.join("model.bdf");
    let deck = strip("PCOMPP,9\nCQUAD4,90,9,1,4,5,2\n");
    std::fs::write(&path, deck).unwrap();
    let given = path.to_str().unwrap();
    let checked = strainbridge(&["check", given]);
    let told = text(&checked.stderr);
    assert_eq!(checked.status.code(), Some(0), "{told}");
    assert_eq!(told.matches("card-not-solved").count(), 1, "{told}");
    let solved = strainbridge(&["solve", given]);
    assert_eq!(solved.status.code(), Some(2), "{}", text(&solved.stderr));
}

#[test]
fn a_set_that_the_deck_lacks_is_refused_at_the_statement_that_selects_it() {
    for (statement, selects) in [
        ("MPC = 7", "MPC = 7"),
        ("TEMP(LOAD) = 7", "TEMPERATURE = 7"),
    ] {
        let deck = strip("").replace("  LOAD = 1\n", &format!("  LOAD = 1\n  {statement}\n"));
        assert_deck_refused("set_missing", &deck, &format!("  {statement}"), &[selects]);
    }
}

#[test]
fn relief_that_is_stated_for_a_structure_that_supports_hold_is_reported() {
    let deck = strip("SPC1,1,123456,1\n").replace("CEND\n", "CEND\nSPC = 1\n");
    let (code, told, _) = solve("idle_relief", &deck);
    assert_eq!(code, 0, "{told}");
    assert!(told.contains("inertia-relief-unused"), "{told}");
}
