//! Inputs that are cut, devices or no decks at all: every command that reads them ends in a sentence and not with 0.

#[path = "../nastran/tests/support/mod.rs"]
mod support;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn shared() -> Option<PathBuf> {
    support::shared("nastran")
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

/// Folder, OP2, and the deck beside it where there is one that is no part of another.
fn sets() -> Vec<(PathBuf, Option<PathBuf>)> {
    let Some(shared) = shared() else {
        return Vec::new();
    };
    let mut folders: Vec<PathBuf> = std::fs::read_dir(shared)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.is_dir())
        .collect();
    folders.sort();
    folders
        .iter()
        .flat_map(|f| {
            let deck = files(f, &["bdf", "dat", "nas"]).pop();
            files(f, &["op2"])
                .into_iter()
                .map(move |o| (o, deck.clone()))
        })
        .collect()
}

#[test]
fn no_command_that_reads_a_cut_op2_ends_with_0() {
    let folder = scratch("cut_op2");
    let mut tried = 0;
    for (op2, deck) in sets() {
        let bytes = std::fs::read(&op2).unwrap();
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
                tried += 1;
                let done = strainbridge(&arguments);
                let said = String::from_utf8_lossy(&done.stderr);
                assert!(
                    matches!(done.status.code(), Some(1 | 2)),
                    "{arguments:?} on {} at {percent} %: {:?}\n{said}",
                    op2.display(),
                    done.status
                );
            }
        }
    }
    println!("{tried} runs on cut files");
}

#[test]
fn a_job_whose_results_are_cut_names_the_cut() {
    let Some(shared) = shared() else { return };
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
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains("cut"), "{command}: {said}");
    }
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
            let said = String::from_utf8_lossy(&done.stderr);
            let refused = matches!(done.status.code(), Some(1 | 2));
            assert!(
                refused || command == "init" && said.contains("warning"),
                "{command} {input}: {said}"
            );
            assert!(!said.contains("secret:"), "{command} {input}: {said}");
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
        for command in ["check", "solve"] {
            let done = strainbridge(&[command, deck.to_str().unwrap()]);
            let said = String::from_utf8_lossy(&done.stderr);
            assert_eq!(done.status.code(), Some(2), "{command} {name}: {said}");
            assert!(said.contains("gone.inc"), "{command} {name}: {said}");
        }
    }
}
