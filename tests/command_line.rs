//! The command line as a user sees it: exit codes, standard output, standard error, files.

#[path = "../nastran/tests/support/mod.rs"]
mod support;

#[cfg(feature = "open")]
#[path = "open/mod.rs"]
mod open;

use std::path::PathBuf;
use std::process::{Command, Output};

/// Runs the program.
fn strainbridge(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .output()
        .unwrap()
}

/// Creates an empty folder for one test.
fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("command_line")
        .join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_bad_job_exits_with_2_and_lists_every_fault_with_file_and_line() {
    let dir = folder("bad_job");
    let job = dir.join("job.toml");
    std::fs::write(&job, "unit = \"m-kg-s\"\n[placement]\ngauges = \"ten\"\n").unwrap();
    let out = strainbridge(&["check", job.to_str().unwrap()]);
    assert_eq!(out.status.code(), Some(2));
    assert!(out.stdout.is_empty());
    let err = text(&out.stderr);
    let name = job.display().to_string();
    assert!(
        err.contains(&format!("{name}:1: unit: ")) && err.contains("did you mean `units`?"),
        "{err}"
    );
    assert!(
        err.contains(&format!("{name}:3: placement.gauges: ")),
        "{err}"
    );
}

#[test]
fn a_missing_file_is_bad_input() {
    let out = strainbridge(&["check", "no-such-file.bdf", "neither.toml"]);
    assert_eq!(out.status.code(), Some(2));
    let err = text(&out.stderr);
    assert!(
        err.contains("no-such-file.bdf:1: file: no such file") && err.contains("neither.toml"),
        "{err}"
    );
}

/// The finding appears for a deck alone, and not only for its job. A set that no subcase selects does not count.
#[test]
fn a_deck_that_holds_a_grid_at_two_values_or_has_a_solid_inside_out_gets_a_finding() {
    let dir = folder("contradicting");
    let deck = dir.join("solid.bdf");
    let text_of = |selected: u32| {
        format!(
            "SOL 101\nCEND\nSPC = {selected}\nBEGIN BULK\nMAT1,1,210000.,,.3,7.85-9\nPSOLID,1,1\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\n\
             GRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nCTETRA,7,1,1,3,2,4\nSPC1,1,123,1,2,3\nSPC,2,1,3,0.\nSPC,2,1,3,.5\nENDDATA\n"
        )
    };
    for (selected, code) in [(1, 0), (2, 1)] {
        std::fs::write(&deck, text_of(selected)).unwrap();
        let out = strainbridge(&["check", deck.to_str().unwrap()]);
        let err = text(&out.stderr);
        assert_eq!(out.status.code(), Some(code), "{err}");
        assert!(err.contains("[inverted-solid]"), "{err}");
        assert_eq!(err.contains("[contradicting-spc]"), code == 1, "{err}");
    }
}

#[test]
fn json_prints_the_result_and_nothing_else() {
    let dir = folder("json");
    let job = dir.join("job.toml");
    std::fs::write(&job, "units = \"m-kg-s\"\n").unwrap();
    let out = strainbridge(&["check", job.to_str().unwrap(), "--json"]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let result: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    for key in [
        "command", "version", "units", "inputs", "findings", "seconds", "decks", "results",
    ] {
        assert!(result.get(key).is_some(), "{key} in {result}");
    }
    // SHA-256 of `units = "m-kg-s"` and a line feed, by sha256sum.
    let expected = "a3e0fc98c56fd9dcc4d3f3f1d1888b26ca71269bd9af4fa73aaa9fe6defa5846";
    assert_eq!(result["inputs"][0]["sha256"], expected);
    assert!(
        std::fs::read_dir(&dir).unwrap().count() == 1,
        "check writes only with --out"
    );
}

#[test]
fn two_runs_write_the_same_bytes_but_for_the_seconds() {
    let dir = folder("same_bytes");
    let job = dir.join("job.toml");
    std::fs::write(&job, "units = \"m-kg-s\"\n").unwrap();
    let run = |out: &str| {
        let out = dir.join(out);
        let done = strainbridge(&[
            "check",
            job.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        let json = std::fs::read_to_string(out.join("result.json")).unwrap();
        assert_eq!(
            std::fs::read_dir(&out)
                .unwrap()
                .filter(
                    |e| text(e.as_ref().unwrap().file_name().as_encoded_bytes()).ends_with(".part")
                )
                .count(),
            0
        );
        json.split("\"seconds\"").next().unwrap().to_owned()
    };
    assert_eq!(run("a"), run("b"));
}

const PLATE: &str = "SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\n\
    MAT1,1,2.+11,,.3,7850.\nPSHELL,1,1,.01,1,,1\nCQUAD4,9,1,1,2,3,4\nENDDATA\n";

#[test]
fn check_and_strains_write_a_page_next_to_their_result() {
    use nastran::op2::write_blocks;
    use nastran::results::{
        Analysis, Block, ElementType, Quantity, RowId, Rows, ShellForm, columns,
    };
    let dir = folder("pages");
    let path = |name: &str| dir.join(name).to_str().unwrap().to_owned();
    std::fs::write(path("plate.bdf"), PLATE).unwrap();
    let block = Block {
        table: String::new(),
        quantity: Quantity::Strain,
        analysis: Analysis::Statics,
        subcase: 3,
        mode: 0,
        step: 0.0,
        element: Some(ElementType(33)),
        form: Some(ShellForm::Fiber),
        von_mises: true,
        complex: false,
        sort2: false,
        num_wide: 0,
        entries: 0,
        titles: Default::default(),
    };
    // Fibre distance, exx, eyy, gxy, and values derived from them: 1000 microstrain along x at the top, half of it at
    // the bottom.
    let n = columns::SHELL_STRAIN.len();
    let mut values = vec![0.0; 2 * n];
    let place = |name: &str| {
        columns::SHELL_STRAIN
            .iter()
            .position(|c| *c == name)
            .unwrap()
    };
    values[place("fiber")] = -0.005;
    values[n + place("fiber")] = 0.005;
    values[place("exx")] = 0.0005;
    values[n + place("exx")] = 0.001;
    let rows = Rows {
        columns: columns::SHELL_STRAIN,
        ids: [1, 2]
            .map(|layer| RowId {
                entity: 9,
                at: 0,
                layer,
            })
            .to_vec(),
        values,
        labels: Vec::new(),
    };
    std::fs::write(
        path("plate.op2"),
        write_blocks([(&block, &rows)], [11, 21, 2026]).unwrap(),
    )
    .unwrap();

    let out = strainbridge(&[
        "strains",
        &path("plate.bdf"),
        &path("plate.op2"),
        "--out",
        &path("s"),
    ]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let page = std::fs::read_to_string(dir.join("s/report.html")).unwrap();
    // The surface of element 9 with the larger strain.
    assert!(
        page.contains("<td>top</td>") && page.contains("<td>1000</td>"),
        "{page}"
    );
    let csv = std::fs::read_to_string(dir.join("s/strains.csv")).unwrap();
    assert_eq!(csv.lines().count(), 3, "{csv}");
    // A strain of a thousandth is 1000 microstrain.
    assert!(
        csv.lines()
            .any(|l| l.contains("top,1.0000000") && l.contains("e3,")),
        "{csv}"
    );

    let out = strainbridge(&[
        "check",
        &path("plate.bdf"),
        &path("plate.op2"),
        "--out",
        &path("c"),
    ]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let page = std::fs::read_to_string(dir.join("c/report.html")).unwrap();
    assert!(
        page.contains("CQUAD4 1") && page.contains("plate.op2"),
        "{page}"
    );
}

#[test]
fn every_shell_gets_completions_that_name_the_commands() {
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let out = strainbridge(&["completions", shell]);
        assert_eq!(out.status.code(), Some(0), "{shell}");
        let script = text(&out.stdout);
        assert!(
            script.contains("reconcile") && script.contains("no-cache"),
            "{shell}"
        );
    }
}

#[test]
fn help_of_every_command_shows_an_example_of_it() {
    let help = text(&strainbridge(&["--help"]).stdout);
    let mut seen = 0;
    for line in help.lines().skip_while(|l| *l != "Commands:").skip(1) {
        let Some(name) = line
            .strip_prefix("  ")
            .and_then(|l| l.split_whitespace().next())
        else {
            break;
        };
        // Further lines of a description are indented.
        if name == "help" || line.starts_with("   ") {
            continue;
        }
        seen += 1;
        let page = text(&strainbridge(&[name, "--help"]).stdout);
        assert!(
            page.contains("Example:") && page.contains(&format!("  strainbridge {name}")),
            "{page}"
        );
    }
    assert!(seen >= 17, "{help}");
}

/// Collects the keys of a TOML value that a schema does not contain.
fn unknown_keys(schema: &serde_json::Value, value: &toml::Value, at: &str, out: &mut Vec<String>) {
    match value {
        toml::Value::Table(t) => {
            for (key, below) in t {
                let known = &schema["properties"][key];
                let other = &schema["additionalProperties"];
                let here = format!("{at}.{key}");
                match (known.is_object(), other.is_object()) {
                    (true, _) => unknown_keys(known, below, &here, out),
                    (false, true) => unknown_keys(other, below, &here, out),
                    _ => out.push(here),
                }
            }
        }
        toml::Value::Array(list) if list.iter().any(toml::Value::is_table) => {
            list.iter()
                .for_each(|v| unknown_keys(&schema["items"], v, at, out));
        }
        _ => {}
    }
}

#[test]
fn the_schema_knows_every_key_of_a_job_and_no_misspelt_one() {
    let out = strainbridge(&["schema"]);
    assert_eq!(out.status.code(), Some(0));
    let schema: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let unknown = |job: &str| {
        let mut list = Vec::new();
        unknown_keys(
            &schema,
            &job.parse::<toml::Table>().unwrap().into(),
            "",
            &mut list,
        );
        list
    };
    let job = "units = \"mm-t-s\"\n[model]\ndeck = \"a.bdf\"\n[[load]]\ngrid = 1\nfroce = 2\n[vehicle]\nknown = { m_b = 1.0 }\n";
    assert_eq!(unknown(job), [".load.froce"]);
    let mut jobs = Vec::new();
    for folder in ["static", "deck", "dynamics"] {
        let Some(shared) = support::find_shared_path(&format!("hidden_effects/{folder}")) else {
            return;
        };
        let cases = std::fs::read_dir(shared).unwrap().flatten();
        jobs.extend(
            cases
                .map(|c| c.path().join("job.toml"))
                .filter(|j| j.exists()),
        );
    }
    assert!(!jobs.is_empty());
    for path in jobs {
        let list = unknown(&std::fs::read_to_string(&path).unwrap());
        assert!(list.is_empty(), "{}: {list:?}", path.display());
    }
}

#[test]
fn explain_states_the_meaning_of_a_finding_and_suggests_a_similar_code() {
    let out = strainbridge(&["explain", "loads-not-separable"]);
    assert_eq!(out.status.code(), Some(0));
    let printed = text(&out.stdout);
    for word in ["cause", "limit", "remedy", "example"] {
        assert!(printed.contains(word), "{printed}");
    }
    let out = strainbridge(&["explain", "loads-not-seperable"]);
    assert_eq!(out.status.code(), Some(2));
    assert!(text(&out.stderr).contains("did you mean `loads-not-separable`?"));
    let out = strainbridge(&["explain", "--list", "--json"]);
    let list: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let list = list.as_array().unwrap();
    assert!(list.len() > 150);
    for entry in list {
        for key in [
            "code", "severity", "said_by", "cause", "limit", "remedy", "example",
        ] {
            assert!(!entry[key].is_null(), "{entry}");
        }
    }
}

#[test]
fn faults_are_json_where_that_is_asked_for() {
    let dir = folder("fault_json");
    let job = dir.join("job.toml");
    std::fs::write(&job, "units = \"m-kg-s\"\n[placement]\ngauges = \"ten\"\n").unwrap();
    let out = strainbridge(&["place", job.to_str().unwrap(), "--json"]);
    assert_eq!(out.status.code(), Some(2));
    let printed: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let faults = printed["faults"].as_array().unwrap();
    assert_eq!(faults[0]["line"], 3);
    for key in ["file", "field", "wrong", "remedy"] {
        assert!(faults[0][key].is_string(), "{printed}");
    }
    assert!(!dir.join("job.out").exists());
}

#[test]
fn a_deck_given_as_a_job_is_one_fault_that_names_init() {
    let dir = folder("deck_as_job");
    let deck = dir.join("plate.bdf");
    std::fs::write(&deck, PLATE).unwrap();
    let out = strainbridge(&["place", deck.to_str().unwrap()]);
    assert_eq!(out.status.code(), Some(2));
    let err = text(&out.stderr);
    assert!(
        err.contains("this is a deck") && err.contains("strainbridge init"),
        "{err}"
    );
    assert!(err.contains("1 fault found"), "{err}");
}

#[test]
fn quiet_prints_errors_alone_and_verbose_prints_seconds() {
    let dir = folder("quiet");
    let deck = dir.join("plate.bdf");
    // Grids 11 to 13 belong to no element. One note states their place.
    let grids: String = (11..14)
        .map(|g| format!("GRID,{g},,5.,{g}.,0.\n"))
        .collect();
    let deck_text = PLATE.replace("ENDDATA", &format!("{grids}ENDDATA"));
    std::fs::write(&deck, deck_text).unwrap();
    let path = deck.to_str().unwrap();
    let plain = strainbridge(&["check", path]);
    let err = text(&plain.stderr);
    assert!(
        err.lines()
            .any(|l| l.starts_with(&format!("{path}:11: note [grid-unattached]"))),
        "{err}"
    );
    assert!(!err.contains('\u{1b}'), "colour without a terminal: {err}");
    let quiet = strainbridge(&["check", path, "-q"]);
    assert_eq!(quiet.status.code(), Some(0));
    assert!(quiet.stderr.is_empty() && quiet.stdout.is_empty());
    let json = strainbridge(&["check", path, "-q", "--json"]);
    assert!(serde_json::from_slice::<serde_json::Value>(&json.stdout).is_ok());
    let verbose = strainbridge(&["check", path, "-v"]);
    assert!(text(&verbose.stderr).contains("time: "));
}

#[test]
fn man_pages_are_written_for_the_program_and_each_command() {
    let dir = folder("man");
    let out = strainbridge(&["man", dir.to_str().unwrap()]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    for page in [
        "strainbridge.1",
        "strainbridge-place.1",
        "strainbridge-explain.1",
    ] {
        let page = std::fs::read_to_string(dir.join(page)).unwrap();
        assert!(page.contains(".TH") && page.contains("SYNOPSIS"), "{page}");
    }
}

#[test]
fn init_writes_a_job_for_a_purpose_whose_only_faults_are_files_to_be_named() {
    let frame = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame/frame.bdf");
    let frame = frame.to_str().unwrap();
    for (purpose, deck) in [
        ("payload", true),
        ("reconcile", true),
        ("calibrate", true),
        ("calibrate", false),
        ("identify", false),
    ] {
        let dir = folder(&format!("init_{purpose}_{deck}"));
        let out = dir.to_str().unwrap();
        let mut arguments = vec!["init"];
        arguments.extend(deck.then_some(frame));
        arguments.extend(["--for", purpose, "--out", out]);
        let done = strainbridge(&arguments);
        assert_eq!(
            done.status.code(),
            Some(0),
            "{purpose}: {}",
            text(&done.stderr)
        );
        let job = std::fs::read_to_string(dir.join("job.toml")).unwrap();
        assert!(job.contains("# check"), "{job}");
        // The keys are known and have the right type. `check` reports only missing files and values that the user must
        // fill in.
        let path = dir.join("job.toml");
        let checked = strainbridge(&["check", path.to_str().unwrap(), "--json"]);
        let printed: serde_json::Value = serde_json::from_slice(&checked.stdout).unwrap();
        assert!(!printed["faults"].as_array().unwrap().is_empty());
        for fault in printed["faults"].as_array().unwrap() {
            let wrong = fault.as_str().unwrap();
            let to_be_named = ["no such file", "payload.grid"];
            assert!(
                to_be_named.iter().any(|w| wrong.contains(w)),
                "{purpose}: {fault}"
            );
        }
    }
    let out = strainbridge(&["init", "--for", "payload"]);
    assert_eq!(out.status.code(), Some(2), "a payload needs a deck");
}

#[test]
fn clean_without_a_terminal_removes_nothing_but_with_yes() {
    for command in [&["clean"][..], &["cache", "clean"]] {
        cleans_with_yes_alone(command);
    }
}

fn cleans_with_yes_alone(command: &[&str]) {
    let dir = folder("clean_asks");
    let kept = dir.join("0123.solution");
    std::fs::write(&kept, [0_u8; 1000]).unwrap();
    let path = dir.to_str().unwrap();
    let refused = strainbridge(&[command, &[path]].concat());
    let err = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{err}");
    assert!(err.contains(path) && err.contains("--yes"), "{err}");
    assert!(kept.is_file());
    let done = strainbridge(&[command, &[path, "--yes"]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(!kept.exists());
}

#[test]
fn a_terminal_without_utf_8_gets_ascii_and_files_and_json_stay_utf_8() {
    let frame = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    let dir = folder("ascii");
    let run = |command: &str, json: bool| {
        let out = dir.join(command);
        let job = frame.join("place.toml");
        let mut words = vec![
            command,
            job.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
            "-v",
        ];
        words.extend(json.then_some("--json"));
        let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args(words)
            .env("LC_ALL", "C")
            .env("TERM", "dumb")
            .output()
            .unwrap();
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        (text(&done.stdout), text(&done.stderr))
    };
    for command in ["sensitivity", "place"] {
        let (out, err) = run(command, false);
        assert!(out.is_ascii() && err.is_ascii(), "{out}\n{err}");
    }
    let (json, _) = run("place", true);
    let written = std::fs::read_to_string(dir.join("place/result.json")).unwrap();
    let summary = |json: &str| -> serde_json::Value {
        serde_json::from_str::<serde_json::Value>(json).unwrap()["summary"].clone()
    };
    assert_eq!(summary(&json), summary(&written));
    assert!(summary(&json).as_str().unwrap().contains('±'));
}

#[test]
fn init_leaves_a_job_that_is_there() {
    let frame = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame/frame.bdf");
    let dir = folder("init_twice");
    let job = dir.join("job.toml");
    let gauges = dir.join("gauges.csv");
    std::fs::write(&job, "units = \"mm-t-s\"\n").unwrap();
    std::fs::write(&gauges, "name\nG1\n").unwrap();
    let done = strainbridge(&[
        "init",
        frame.to_str().unwrap(),
        "--out",
        dir.to_str().unwrap(),
    ]);
    assert_eq!(done.status.code(), Some(2));
    assert!(
        text(&done.stderr).contains("not overwritten"),
        "{}",
        text(&done.stderr)
    );
    assert_eq!(
        std::fs::read_to_string(&job).unwrap(),
        "units = \"mm-t-s\"\n"
    );
    std::fs::remove_file(&job).unwrap();
    let done = strainbridge(&[
        "init",
        frame.to_str().unwrap(),
        "--out",
        dir.to_str().unwrap(),
    ]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert_eq!(std::fs::read_to_string(&gauges).unwrap(), "name\nG1\n");
}

/// Folder unpacked from a Windows archive. Its name contains the letter as a single byte of code page 1252.
#[cfg(target_os = "linux")]
#[test]
fn a_name_that_is_not_utf_8_is_a_fault() {
    use std::os::unix::ffi::OsStrExt;
    let frame = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    let dir = folder("code_page").join(std::ffi::OsStr::from_bytes(b"Tr\xe4ger"));
    if std::fs::create_dir(&dir).is_err() {
        return;
    }
    for name in ["place.toml", "frame.bdf"] {
        std::fs::copy(frame.join(name), dir.join(name)).unwrap();
    }
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg("place")
        .arg(dir.join("place.toml"))
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(2));
    let printed = text(&done.stderr);
    assert!(
        printed.contains("is not UTF-8") && printed.contains("rename it"),
        "{printed}"
    );
    // The same letter in UTF-8 is a valid name, also for results.
    let named = folder("code_page_utf8").join("Träger");
    std::fs::create_dir(&named).unwrap();
    std::fs::copy(frame.join("frame.bdf"), named.join("Rähmen.bdf")).unwrap();
    let job = std::fs::read_to_string(frame.join("place.toml")).unwrap();
    std::fs::write(
        named.join("place.toml"),
        job.replace("frame.bdf", "Rähmen.bdf"),
    )
    .unwrap();
    let out = named.join("Plan µ");
    let job = named.join("place.toml");
    let done = strainbridge(&[
        "place",
        job.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(out.join("gauges.csv").is_file());
}
