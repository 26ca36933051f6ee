//! The guide in `docs/`: every command in a `sh` box is run, in order, in one folder; files that a page names are there afterwards.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Pages in order of their numbers.
fn pages() -> Vec<(String, String)> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let mut pages: Vec<PathBuf> = std::fs::read_dir(docs)
        .unwrap()
        .flatten()
        .map(|e| e.path())
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.sort();
    pages
        .iter()
        .map(|p| {
            let name = p.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(p).unwrap())
        })
        .collect()
}

/// Lines of the boxes of one kind, one text a box.
fn boxes(page: &str, kind: &str) -> Vec<String> {
    let fence = format!("```{kind}");
    let mut out = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if line == fence {
            let inside = lines.by_ref().take_while(|l| *l != "```");
            out.push(inside.map(|l| format!("{l}\n")).collect());
        }
    }
    out
}

/// Runs one line; the exit code is that of its comment (`# exit code 1`), else 0.
fn run(line: &str, folder: &Path) {
    let (command, comment) = line.split_once(" #").unwrap_or((line, ""));
    let (command, target) = command.split_once(" > ").unwrap_or((command, ""));
    let mut words = command.split_whitespace();
    assert_eq!(words.next(), Some("strainbridge"), "{line}");
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(words)
        .current_dir(folder)
        .output()
        .unwrap();
    let expected = comment
        .split_once("exit code ")
        .map_or(0, |(_, n)| n.trim().parse().unwrap());
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(expected), "{line}\n{error}");
    if !target.trim().is_empty() {
        std::fs::write(folder.join(target.trim()), &done.stdout).unwrap();
    }
}

/// Puts the files of a folder of `examples/` beside the commands.
fn copy_example(name: &str, folder: &Path) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name);
    let to = folder.join(name);
    std::fs::create_dir_all(&to).unwrap();
    for file in std::fs::read_dir(from).unwrap().flatten() {
        std::fs::copy(file.path(), to.join(file.file_name())).unwrap();
    }
}

/// Paths in backticks that lead into a folder and end in a file.
fn named_files(page: &str) -> Vec<&str> {
    let spans = page.split('`').skip(1).step_by(2);
    spans
        .filter(|s| {
            s.contains('/')
                && !s.contains(' ')
                && s.rsplit('/').next().is_some_and(|f| f.contains('.'))
        })
        .collect()
}

#[test]
fn every_command_of_the_guide_works_and_the_files_it_names_are_written() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("guide");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let pages = pages();
    assert_eq!(pages.len(), 6);
    for example in ["bridge", "onboard"] {
        copy_example(example, &folder);
    }
    for (name, page) in &pages {
        let commands = boxes(page, "sh").concat();
        assert!(!commands.is_empty(), "{name}");
        commands.lines().for_each(|line| run(line, &folder));
        for file in named_files(page) {
            assert!(folder.join(file).exists(), "{name}: `{file}` is not there");
        }
        for toml in boxes(page, "toml") {
            assert!(toml.parse::<toml::Table>().is_ok(), "{name}: {toml}");
        }
    }
}
