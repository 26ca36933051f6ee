//! Inputs that are cut, are devices, or are not decks. Every command that reads them ends with 2 and a message.

#[path = "../nastran/tests/support/mod.rs"]
mod support;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn find_nastran_folder() -> Option<PathBuf> {
    support::find_shared_path("nastran")
}

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn strainbridge(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .output()
        .unwrap()
}

fn files(folder: &Path, ends: &[&str]) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| {
            p.extension()
                .is_some_and(|e| ends.contains(&e.to_str().unwrap()))
        })
        .collect();
    found.sort();
    found
}

/// Returns each OP2 with its deck, if one exists that is not an include file. `None` if the reference material is
/// absent.
fn sets() -> Option<Vec<(PathBuf, Option<PathBuf>)>> {
    let mut folders: Vec<PathBuf> = std::fs::read_dir(find_nastran_folder()?)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.is_dir())
        .collect();
    folders.sort();
    let sets = folders
        .iter()
        .flat_map(|f| {
            let deck = files(f, &["bdf", "dat", "nas"]).pop();
            files(f, &["op2"])
                .into_iter()
                .map(move |o| (o, deck.clone()))
        })
        .collect();
    Some(sets)
}

#[test]
fn every_command_that_reads_a_cut_op2_reports_it_and_ends_with_2() {
    let Some(sets) = sets() else { return };
    let folder = scratch("cut_op2");
    let (mut cut_short, mut without_grids) = (0, 0);
    for (op2, deck) in sets {
        let bytes = std::fs::read(&op2).unwrap();
        // Decks that write matrices and have no model. `init` reports this before it opens the results.
        let has_model = |d: &PathBuf| !d.ends_with("wrt_test_op2_files.dat");
        let lacks_grids = !deck.as_ref().is_none_or(has_model);
        for percent in (5..100).step_by(5) {
            let cut = folder.join("cut.op2");
            std::fs::write(&cut, &bytes[..bytes.len() * percent / 100]).unwrap();
            let cut = cut.to_str().unwrap();
            let deck = deck.as_ref().map_or(cut, |d| d.to_str().unwrap());
            let out = folder.join("out");
            let out = out.to_str().unwrap();
            for arguments in [
                vec!["check", cut],
                vec!["strains", deck, cut, "--out", out],
                vec!["strains", cut, "--out", out],
                vec!["init", deck, cut, "--out", out],
                vec!["solve", cut, "--out", out],
            ] {
                let done = strainbridge(&arguments);
                let printed = String::from_utf8_lossy(&done.stderr);
                let at = format!(
                    "{arguments:?} on {} at {percent} %: {printed}",
                    op2.display()
                );
                assert_eq!(done.status.code(), Some(2), "{at}");
                if arguments[0] == "init" && lacks_grids {
                    assert!(printed.contains("contains no grid"), "{at}");
                    without_grids += 1;
                } else {
                    assert!(printed.contains("cut short"), "{at}");
                    cut_short += 1;
                }
            }
        }
    }
    println!("{cut_short} runs on cut files, {without_grids} on decks without grids");
    assert!(
        cut_short > 20 * without_grids,
        "{cut_short} {without_grids}"
    );
}

#[test]
fn a_job_whose_results_are_cut_names_the_cut() {
    let Some(shared) = find_nastran_folder() else {
        return;
    };
    let folder = scratch("cut_job");
    let frame = shared.join("mystran_frame_units");
    let bytes = std::fs::read(frame.join("frame.op2")).unwrap();
    std::fs::write(folder.join("cut.op2"), &bytes[..bytes.len() * 985 / 1000]).unwrap();
    let deck = frame
        .join("frame.bdf")
        .display()
        .to_string()
        .replace('\\', "/");
    let job = folder.join("job.toml");
    std::fs::write(
        &job,
        format!(
            "title = \"t\"\nunits = \"m-kg-s\"\n[model]\ndeck = \"{deck}\"\nresults = [\"cut.op2\"]\n\
             [[load]]\nname = \"A\"\ngrid = 101\ncomponent = \"FZ\"\nsubcase = 1\nexpected = 1000.0\n\
             [candidates]\n[placement]\ngauges = 2\nspacing = 0.05\nnoise_microstrain = 1.0\n"
        ),
    )
    .unwrap();
    let job = job.to_str().unwrap();
    for command in ["sensitivity", "place", "check"] {
        let done = strainbridge(&[command, job]);
        let printed = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{command}: {printed}");
        assert!(printed.contains("cut"), "{command}: {printed}");
    }
}

#[test]
fn strains_and_init_on_a_cut_deck_end_with_2() {
    let Some(shared) = find_nastran_folder() else {
        return;
    };
    let folder = scratch("cut_decks");
    let out = folder.join("out").display().to_string();
    let cut = folder.join("cut.bdf").display().to_string();
    for (set, deck, op2) in [
        ("mystran_frame_units", "frame.bdf", "frame.op2"),
        ("msc_plate", "plate.bdf", "plate.op2"),
        ("msc_contact_plate", "contact.bdf", "contact.op2"),
        ("msc64_two_cases", "d173.bdf", "d173.op2"),
    ] {
        let bytes = std::fs::read(shared.join(set).join(deck)).unwrap();
        let op2 = shared.join(set).join(op2).display().to_string();
        for percent in [60, 80, 95] {
            let part = &bytes[..bytes.len() * percent / 100];
            let lines = part.iter().rposition(|b| *b == b'\n').unwrap() + 1;
            // Cut within a line, and at the end of a line.
            for part in [part, &part[..lines]] {
                std::fs::write(&cut, part).unwrap();
                for command in ["strains", "init"] {
                    let done = strainbridge(&[command, &cut, &op2, "--out", &out]);
                    let printed = String::from_utf8_lossy(&done.stderr);
                    assert_eq!(
                        done.status.code(),
                        Some(2),
                        "{command} {set} {percent} %: {printed}"
                    );
                    assert!(
                        printed.contains("ENDDATA"),
                        "{command} {set} {percent} %: {printed}"
                    );
                }
            }
        }
    }
}

/// Content of a deck of the reference material, counted by hand.
struct Holds<'a> {
    /// Deck and results.
    files: &'a [&'a str],
    /// Lines of the job that name its loads: sets of the subcases, or corners of the mesh for a pressure that no
    /// subcase scales.
    loads: &'a [&'a str],
    /// CQUAD4 and CTRIA3 by property, if gauges can determine the loads.
    shells: Option<&'a [(u32, usize)]>,
    /// Message of `init` if gauges cannot determine the loads.
    says: &'a str,
}

/// Returns whether `init` recommends `place` as the next step. Its lines are wrapped.
fn recommends_place(stdout: &[u8]) -> bool {
    let text = String::from_utf8_lossy(stdout);
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").contains("then run `strainbridge place ")
}

#[test]
fn init_recommends_place_only_if_shells_of_the_deck_separate_its_loads() {
    let Some(shared) = find_nastran_folder() else {
        return;
    };
    // Subcases 1 and 2 of d173 have LOAD = 203 and 205.
    let wing = Holds {
        files: &["msc64_two_cases/d173.bdf", "msc64_two_cases/d173.op2"],
        loads: &["load_set = 203", "load_set = 205"],
        shells: Some(&[(1, 3), (2, 2), (6, 5), (24, 6), (62, 5)]),
        says: "",
    };
    // A sector of a shell under pressure with 15 CQUAD4 and a CTRIA3 in SOL 106, which the built-in solver refuses.
    let sector = |files| Holds {
        files,
        loads: &[],
        shells: None,
        says: "`SOL 106` affects the solution, and the built-in solver does not support it",
    };
    // Pressures on a membrane, a PSHELL without MID2. Nothing supports its grids in the normal direction.
    let element = Holds {
        files: &["nx_unit_loads_quad4/cquad4.bdf"],
        loads: &[],
        shells: None,
        says: "loads dof 3, which no element holds",
    };
    // A single CBAR, and nine CBEAM with five CONM2.
    let [bar, beams] = [
        "msc_bar_strain/pbarl_bar_100.bdf",
        "nx_opg_1/rdop2opg_1.dat",
    ];
    let of_bars = |files| Holds {
        files,
        loads: &[],
        shells: None,
        says: "There is no surface for gauges",
    };
    let buckling = [
        "msc_buckling_tabs/sbuckl2a.bdf",
        "msc_buckling_tabs/sbuckl2a.op2",
    ];
    for deck in [
        wing,
        sector(&buckling),
        sector(&buckling[..1]),
        element,
        of_bars(&[bar]),
        of_bars(&[beams]),
    ] {
        let names = deck.files;
        let folder = scratch("init_place");
        let out = folder.display().to_string();
        let files: Vec<String> = names
            .iter()
            .map(|n| shared.join(n).display().to_string())
            .collect();
        let mut arguments = vec!["init"];
        arguments.extend(files.iter().map(String::as_str));
        arguments.extend(["--out", &out]);
        let done = strainbridge(&arguments);
        // Further lines of a finding are indented.
        let printed = String::from_utf8_lossy(&done.stderr).replace("\n    ", " ");
        assert_eq!(done.status.code(), Some(0), "{names:?}: {printed}");
        let recommended = recommends_place(&done.stdout);
        assert_eq!(recommended, deck.shells.is_some(), "{names:?}: {printed}");
        let job = folder.join("job.toml");
        let placed = strainbridge(&["place", job.to_str().unwrap()]);
        let errors = String::from_utf8_lossy(&placed.stderr);
        let code = if recommended { 0 } else { 2 };
        assert_eq!(placed.status.code(), Some(code), "{names:?}: {errors}");
        let Some(shells) = deck.shells else {
            assert!(printed.contains(deck.says), "{names:?}: {printed}");
            continue;
        };
        let text = std::fs::read_to_string(job).unwrap();
        let loads: Vec<&str> = text
            .lines()
            .filter(|l| l.starts_with("load_set") || l.starts_with("component"))
            .collect();
        assert_eq!(loads, deck.loads, "{names:?}");
        for (property, n) in shells {
            // The line has the name of the property between id and number, if the deck states one.
            let (head, end) = (format!("# property {property}"), format!(": {n} shells"));
            let is_line = |l: &str| l.starts_with(&head) && l.ends_with(&end);
            assert!(text.lines().any(is_line), "{names:?} {property}: {text}");
        }
    }
}

/// Largest file that is solved in a second or two. `STRAINBRIDGE_ALL_CUTS` solves all.
const SMALL_SET: u64 = 500_000;

#[test]
fn on_every_set_the_quick_start_gives_an_answer_or_init_states_the_reason() {
    let Some(sets) = sets() else { return };
    let all = std::env::var("STRAINBRIDGE_ALL_CUTS").is_ok();
    let folder = scratch("quick_start");
    let mut inputs: Vec<Vec<String>> = Vec::new();
    for (op2, deck) in sets {
        let Some(deck) = deck else { continue };
        let size = |p: &Path| std::fs::metadata(p).unwrap().len();
        if !all && size(&op2) + size(&deck) > SMALL_SET {
            continue;
        }
        let [deck, op2] = [deck, op2].map(|p| p.display().to_string());
        if !inputs.contains(&vec![deck.clone()]) {
            inputs.push(vec![deck.clone()]);
        }
        inputs.push(vec![deck, op2]);
    }
    let (mut answered, mut told, mut neither) = (0, 0, Vec::new());
    for files in &inputs {
        let _ = std::fs::remove_dir_all(&folder);
        let out = folder.display().to_string();
        let mut arguments = vec!["init"];
        arguments.extend(files.iter().map(String::as_str));
        arguments.extend(["--out", &out]);
        let done = strainbridge(&arguments);
        if !recommends_place(&done.stdout) {
            // A fault, or a job with the reason why no gauge can be placed.
            assert!(!done.stderr.is_empty(), "{files:?}: nothing is reported");
            told += 1;
            continue;
        }
        let job = folder.join("job.toml");
        let placed = strainbridge(&["place", job.to_str().unwrap(), "--no-cache"]);
        match placed.status.code() {
            Some(0) => answered += 1,
            _ => neither.push((files, String::from_utf8_lossy(&placed.stderr).into_owned())),
        }
    }
    println!(
        "{answered} of {} answered, {told} with a reason, neither {neither:?}",
        inputs.len()
    );
    // At least nine of ten must have one of both.
    assert!(
        answered > 0 && told > 0 && 10 * neither.len() <= inputs.len(),
        "{neither:?}"
    );
}

/// Returns the first grid and the first shell in the text files of a deck's folder.
fn ids(deck: &Path) -> Option<[u32; 2]> {
    let texts: Vec<String> = files(deck.parent()?, &["bdf", "dat", "nas", "inc"])
        .iter()
        .map(|f| String::from_utf8_lossy(&std::fs::read(f).unwrap()).into_owned())
        .collect();
    let first = |cards: &[&str]| -> Option<u32> {
        let lines = texts.iter().flat_map(|t| t.lines());
        let mut lines = lines.filter(|l| cards.iter().any(|c| l.starts_with(c)));
        lines.find_map(|line| {
            let rest = line.trim_start_matches(|c: char| c.is_ascii_alphanumeric() || c == '*');
            let id = rest.trim_start_matches([' ', ',']);
            let end = id.find(|c: char| !c.is_ascii_digit()).unwrap_or(id.len());
            id.get(..end)?.parse().ok()
        })
    };
    Some([first(&["GRID"])?, first(&["CQUAD4", "CTRIA3", "CQUADR"])?])
}

/// Returns a job for every command, with its results.
fn job_of_all(deck: &Path, results: &str) -> String {
    let [grid, element] = ids(deck).unwrap_or([1, 1]);
    let deck = deck.display().to_string().replace('\\', "/");
    format!(
        "title = \"t\"\nunits = \"mm-t-s\"\n[model]\ndeck = \"{deck}\"\nresults = [\"{results}\"]\n\
         [[load]]\nname = \"A\"\ngrid = {grid}\ncomponent = \"FZ\"\nsubcase = 1\nexpected = 1000.0\n\
         [[gauge]]\nname = \"g1\"\nelement = {element}\nsurface = \"top\"\ndirection = [1, 0.1, 0.2]\n\
         [candidates]\n[placement]\ngauges = 2\nspacing = 0.05\nnoise_microstrain = 1.0\n\
         [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n\
         [runs]\nfile = \"runs.csv\"\nunits = {{ force = \"N\", mass = \"t\" }}\nnoise = {{ force = 1.0 }}\n\
         [ballast]\nmasses = 1\nregion = [[0.0, 1.0], [0.0, 1.0]]\nrun = \"R1\"\n[payload]\ngrid = {grid}\nposition = \"known\"\n[respond]\nhottest = 3\n\
         [study]\nlayouts = [\"D\"]\ngauges = [1]\nerrors = [{{ kind = \"relative-uniform\", size = 0.1 }}]\ntrials = 10\nseed = 1\n\
         [reconcile]\npath = \"static\"\n"
    )
}

/// With `STRAINBRIDGE_ALL_CUTS` (`.ci/long`), every OP2 of the set is cut at 5, 10 .. 95 %. Otherwise a few smaller
/// ones are cut at three places.
#[test]
fn every_command_on_a_job_whose_results_are_cut_ends_with_2() {
    const COMMANDS: [&str; 12] = [
        "check",
        "cases",
        "solve",
        "modes",
        "ballast",
        "sensitivity",
        "place",
        "recover",
        "respond",
        "payload",
        "study",
        "reconcile",
    ];
    let Some(sets) = sets() else { return };
    let all = std::env::var("STRAINBRIDGE_ALL_CUTS").is_ok();
    let folder = scratch("cut_jobs");
    std::fs::write(folder.join("strain.csv"), "run,g1\nR1,10\nR2,20\nR3,31\n").unwrap();
    std::fs::write(
        folder.join("runs.csv"),
        "run,A,payload_mass\nR1,1,0\nR2,2,1\nR3,3,2\n",
    )
    .unwrap();
    let job = folder.join("job.toml");
    let (mut tried, mut named) = (0, 0);
    let mut taken = 0;
    for (op2, deck) in sets {
        let Some(deck) = deck else { continue };
        let bytes = std::fs::read(&op2).unwrap();
        let has_shells = ids(&deck).is_some();
        // For these decks, every command reads the results. For others, some commands end before that because the deck
        // is incomplete.
        let comes_there = has_shells && bytes.len() <= 60_000 && taken < 4;
        if !all && !comes_there {
            continue;
        }
        taken += usize::from(comes_there);
        std::fs::write(&job, job_of_all(&deck, "cut.op2")).unwrap();
        for percent in (5..100).step_by(if all { 5 } else { 30 }) {
            std::fs::write(
                folder.join("cut.op2"),
                &bytes[..bytes.len() * percent / 100],
            )
            .unwrap();
            for command in COMMANDS {
                let done = strainbridge(&[command, job.to_str().unwrap(), "--no-cache"]);
                let printed = String::from_utf8_lossy(&done.stderr);
                let at = format!("{command} on {} at {percent} %: {printed}", op2.display());
                let code = done.status.code();
                if comes_there {
                    assert_eq!(code, Some(2), "{at}");
                    assert!(printed.contains("cut short"), "{at}");
                } else {
                    // An incomplete deck may also cause an error of an answer that needs no results.
                    assert!(matches!(code, Some(1 | 2)), "{at}");
                }
                if has_shells {
                    tried += 1;
                    named += usize::from(printed.contains("cut short"));
                }
            }
        }
    }
    println!("{tried} runs on jobs with shells and cut results, {named} name them");
    assert!(
        taken == 4 && tried > 0 && named * 2 > tried,
        "{named} of {tried}"
    );
}

#[test]
fn devices_folders_and_texts_are_refused_as_input() {
    let folder = scratch("no_files");
    let deck = |name: &str, include: &str| {
        let path = folder.join(name);
        let text = format!("SOL 101\nCEND\nSUBCASE 1\nBEGIN BULK\nINCLUDE '{include}'\nENDDATA\n");
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    std::fs::write(folder.join("secret.txt"), "root:secret:0:0\nmore secret\n").unwrap();
    std::fs::write(folder.join("hello.bdf"), "hello\n").unwrap();
    std::fs::write(folder.join("empty.bdf"), "").unwrap();
    let path = |name: &str| folder.join(name).display().to_string();
    let mut inputs = vec![
        path(""),
        path("hello.bdf"),
        path("empty.bdf"),
        deck("folder.bdf", &path("")),
        deck("text.bdf", &path("secret.txt")),
        deck("gone.bdf", "gone.inc"),
    ];
    if cfg!(unix) {
        inputs.push("/dev/zero".to_owned());
        inputs.push(deck("device.bdf", "/dev/zero"));
    }
    for input in &inputs {
        for command in ["check", "solve", "strains", "init"] {
            let out = folder.join("out").display().to_string();
            let done = strainbridge(&[command, input, "--out", &out]);
            let printed = String::from_utf8_lossy(&done.stderr);
            assert_eq!(done.status.code(), Some(2), "{command} {input}: {printed}");
            assert!(!printed.contains("secret:"), "{command} {input}: {printed}");
        }
    }
}

#[test]
fn a_missing_include_of_case_or_executive_control_stops_every_command() {
    let folder = scratch("missing_include");
    for (name, text) in [
        (
            "case.bdf",
            "SOL 101\nCEND\nINCLUDE 'gone.inc'\nBEGIN BULK\nGRID,1\nENDDATA\n",
        ),
        (
            "exec.bdf",
            "SOL 101\nINCLUDE 'gone.inc'\nCEND\nBEGIN BULK\nGRID,1\nENDDATA\n",
        ),
    ] {
        let deck = folder.join(name);
        std::fs::write(&deck, text).unwrap();
        for command in ["check", "solve", "strains", "init"] {
            let out = folder.join("out").display().to_string();
            let done = strainbridge(&[command, deck.to_str().unwrap(), "--out", &out]);
            let printed = String::from_utf8_lossy(&done.stderr);
            assert_eq!(done.status.code(), Some(2), "{command} {name}: {printed}");
            assert!(printed.contains("gone.inc"), "{command} {name}: {printed}");
        }
    }
}
