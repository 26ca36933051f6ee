//! The records that are asked for: files as they are, folders with all records below them, patterns, lists of paths.

use super::name::NameForm;
use crate::finding::list_few;
use crate::host::fault::{Fault, Faults};
use glob::{MatchOptions, Pattern, glob_with};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Returns the paths of a list with one path in each line. Blank lines are skipped.
///
/// # Errors
/// A list without a record. An empty list is a mistake of its author, not a request to merge stored results.
pub fn paths_of_list(shown: &str, text: &str) -> Result<Vec<PathBuf>, Fault> {
    let lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines();
    let paths: Vec<PathBuf> = (lines.map(str::trim).filter(|l| !l.is_empty()))
        .map(PathBuf::from)
        .collect();
    match paths.is_empty() {
        true => Err(Fault::new(
            shown,
            "--files",
            "the list contains no record",
            "write one path in each line, or omit --files to merge the stored results",
        )),
        false => Ok(paths),
    }
}

/// Returns the requested records, each once and in order. A folder gives the files below it whose path has the form. A pattern (`*`, `?`, `[0-9]`,
/// `**` for any folders) gives the files that match. A path that exists is used as it is, even if it contains such characters.
///
/// # Errors
/// A fault for each folder without such a file, each invalid pattern or pattern without a match, and each folder that can't be read.
pub fn records_of(asked: &[PathBuf], form: &NameForm) -> Result<Vec<PathBuf>, Faults> {
    let mut found = BTreeSet::new();
    let mut faults = Vec::new();
    for path in asked {
        let shown = path.display().to_string();
        let of = if path.is_dir() {
            find_records_in(path, form)
        } else if !path.exists() && is_pattern(&shown) {
            find_matching_files(&shown)
        } else {
            Ok(vec![path.clone()])
        };
        match of {
            Ok(some) => found.extend(some),
            Err((wrong, remedy)) => faults.push(Fault::new(shown, "files", wrong, remedy)),
        }
    }
    Faults::check(faults)?;
    Ok(found.into_iter().collect())
}

type ProblemAndRemedy = (String, &'static str);

fn is_pattern(path: &str) -> bool {
    path.contains(['*', '?', '['])
}

/// The records below a folder.
fn find_records_in(folder: &Path, form: &NameForm) -> Result<Vec<PathBuf>, ProblemAndRemedy> {
    let files = all_matching(&format!(
        "{}/**/*",
        Pattern::escape(&folder.display().to_string())
    ))?;
    let (records, others): (Vec<PathBuf>, Vec<PathBuf>) =
        (files.into_iter()).partition(|p| form.read(&p.display().to_string()).is_some());
    if !records.is_empty() {
        return Ok(records);
    }
    let others: Vec<String> = others.iter().map(|p| p.display().to_string()).collect();
    let held = match others.is_empty() {
        true => "contains no file".to_owned(),
        false => format!("contains {}", list_few(&others)),
    };
    Err((
        format!(
            "no file below the folder matches the form of [fleet] file_name: the folder {held}"
        ),
        "name another folder, or change file_name",
    ))
}

/// The files that a pattern matches.
fn find_matching_files(pattern: &str) -> Result<Vec<PathBuf>, ProblemAndRemedy> {
    match all_matching(pattern)? {
        files if files.is_empty() => Err((
            "no file matches the pattern".to_owned(),
            "check the path; patterns are relative to the working folder",
        )),
        files => Ok(files),
    }
}

/// Returns the files that a pattern matches, possibly none. Names that begin with a point are left out, as a shell leaves them out.
fn all_matching(pattern: &str) -> Result<Vec<PathBuf>, ProblemAndRemedy> {
    let options = MatchOptions {
        require_literal_separator: true,
        require_literal_leading_dot: true,
        ..MatchOptions::default()
    };
    let paths = glob_with(pattern, options).map_err(|e| {
        (
            format!("the pattern is not valid ({})", e.msg),
            "write it as data/*.parquet",
        )
    })?;
    let mut files = Vec::new();
    for path in paths {
        let path = path.map_err(|e| {
            let wrong = format!("`{}` can't be read ({})", e.path().display(), e.error());
            (wrong, "check the permissions of the folder")
        })?;
        if path.is_file() {
            files.push(path);
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str, files: &[&str]) -> PathBuf {
        let folder = std::env::temp_dir().join(format!(
            "strainbridge-records-{name}-{}",
            std::process::id()
        ));
        let _ = std::fs::remove_dir_all(&folder);
        for f in files {
            let path = folder.join(f);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "x").unwrap();
        }
        folder
    }

    fn names(folder: &Path, found: &[PathBuf]) -> Vec<String> {
        found
            .iter()
            .map(|p| {
                p.strip_prefix(folder)
                    .unwrap()
                    .display()
                    .to_string()
                    .replace('\\', "/")
            })
            .collect()
    }

    #[test]
    fn a_folder_gives_the_records_below_it_and_a_pattern_what_it_matches() {
        let of = [
            "a/T1_1.csv",
            "a/b/T1_2.csv",
            "a/notes.txt",
            "a/.T1_3.csv",
            "[a]_1.csv",
        ];
        let folder = folder("tree", &of);
        let form = NameForm::parse("{vehicle}_{day}.csv").unwrap();
        let found = |asked: &[&str]| {
            let asked: Vec<PathBuf> = asked.iter().map(|p| folder.join(p)).collect();
            records_of(&asked, &form).map(|f| names(&folder, &f))
        };
        assert_eq!(found(&["a"]).unwrap(), ["a/T1_1.csv", "a/b/T1_2.csv"]);
        // A record that is requested twice is read once.
        assert_eq!(found(&["a", "a/T1_1.csv"]).unwrap(), found(&["a"]).unwrap());
        assert_eq!(found(&["*/*.csv"]).unwrap(), ["a/T1_1.csv"]);
        assert_eq!(found(&["**/*_2.csv"]).unwrap(), ["a/b/T1_2.csv"]);
        // The name of an existing file is not a pattern. A missing file is reported when the record is read.
        assert_eq!(found(&["[a]_1.csv"]).unwrap(), ["[a]_1.csv"]);
        assert_eq!(found(&["a/T9_9.csv"]).unwrap(), ["a/T9_9.csv"]);
        let wrong = found(&["*.mf4", "a/b/*.txt"]).unwrap_err().into_list();
        assert_eq!(wrong.len(), 2);
        assert!(
            wrong
                .iter()
                .all(|f| f.wrong == "no file matches the pattern")
        );
        let other = NameForm::parse("{vehicle}-{day}.mf4").unwrap();
        let wrong = records_of(std::slice::from_ref(&folder), &other).unwrap_err();
        assert!(wrong.into_list()[0].wrong.contains("notes.txt"));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_list_is_a_path_a_line_and_never_empty() {
        let list = paths_of_list("l.txt", "\u{feff}a.csv\r\n\n  b c.csv \n").unwrap();
        assert_eq!(list, [PathBuf::from("a.csv"), PathBuf::from("b c.csv")]);
        assert!(paths_of_list("l.txt", " \n").is_err());
    }
}
