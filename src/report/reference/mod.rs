//! The reference as pages, made from the code: keys of a job, fields and columns of results, findings.

use crate::finding::explain::codes;
use crate::job::schema::keys;
use std::fmt::Write;

/// Fields of `result.json`: command, field, unit, meaning.
const FIELDS: &str = include_str!("fields.txt");
/// Columns of tables: command, file, column, unit, meaning.
const COLUMNS: &str = include_str!("columns.txt");
/// The line under the title of each page.
const MADE: &str = "Made from the code by `strainbridge explain --reference docs/reference`: edit the tables there.\n\n";

/// Returns the file name and text of each page.
pub fn pages() -> [(&'static str, String); 3] {
    [
        ("job-keys.md", key_page()),
        ("results.md", result_page()),
        ("findings.md", finding_page()),
    ]
}

/// Returns the fields of `result.json` by command. The command `*` stands for every command.
pub fn fields() -> Vec<[&'static str; 4]> {
    rows(FIELDS)
}

/// Returns the columns of tables by command and file.
pub fn columns() -> Vec<[&'static str; 5]> {
    rows(COLUMNS)
}

/// Lines of a table in parts.
fn rows<const N: usize>(table: &'static str) -> Vec<[&'static str; N]> {
    let lines = table.lines().filter(|l| !l.starts_with('#'));
    let parts = |l: &'static str| l.split(" | ").collect::<Vec<_>>().try_into().ok();
    lines.filter_map(parts).collect()
}

/// A row of a table in Markdown.
fn row(cells: &[&str]) -> String {
    let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

fn head(cells: &[&str]) -> String {
    format!("{}|{}\n", row(cells), "---|".repeat(cells.len()))
}

/// A blank for what a table calls `-`.
fn or_blank(word: &str) -> &str {
    if word == "-" { "" } else { word }
}

fn key_page() -> String {
    let mut out = format!("# Keys of a job\n\n{MADE}");
    out.push_str("Names of lists of sections, such as `load`, are in double brackets in the job: `[[load]]`. Lengths, forces and masses are in the \
     job's `units` unless a unit is stated. Every key exists since version 0.1.\n");
    let mut section = "";
    for k in keys() {
        let first = k.path.split('.').next().unwrap_or_default();
        if first != section {
            section = first;
            let _ = write!(out, "\n## `{section}`\n\n");
            out.push_str(&head(&["key", "meaning", "unit", "default", "words"]));
        }
        let words: Vec<String> = k.words.iter().map(|w| format!("`{w}`")).collect();
        let path = format!("`{}`", k.path);
        let cells = [
            &*path,
            k.meaning,
            k.unit.unwrap_or_default(),
            k.default.unwrap_or_default(),
            &words.join(" "),
        ];
        out.push_str(&row(&cells));
    }
    out
}

fn result_page() -> String {
    let mut out = format!("# Fields of `result.json` and columns of tables\n\n{MADE}");
    out.push_str("A dot leads into an object or into each object of a list; `*` represents any name. For `report force` and the like, `units` of the \
     same file states the unit; `job force` and the like are units of the job's system. Columns `<load>` and `<gauge>` have the names of \
     the job. Strain is always in microstrain. A number that does not exist is null, and an empty cell of a table.\n");
    let (fields, columns) = (fields(), columns());
    let mut commands: Vec<&str> = fields.iter().map(|f| f[0]).collect();
    commands.sort_unstable();
    commands.dedup();
    for command in commands {
        let title = match command {
            "*" => "Every command".to_owned(),
            name => format!("`{name}`"),
        };
        let _ = write!(out, "\n## {title}\n\n");
        out.push_str(&head(&["field", "unit", "meaning"]));
        for [_, field, unit, meaning] in fields.iter().filter(|f| f[0] == command) {
            out.push_str(&row(&[&format!("`{field}`"), or_blank(unit), meaning]));
        }
        let of_command = || columns.iter().filter(|c| c[0] == command);
        if of_command().next().is_some() {
            out.push('\n');
            out.push_str(&head(&["file", "column", "unit", "meaning"]));
        }
        for [_, file, column, unit, meaning] in of_command() {
            out.push_str(&row(&[
                &format!("`{file}`"),
                &format!("`{column}`"),
                or_blank(unit),
                meaning,
            ]));
        }
    }
    out
}

fn finding_page() -> String {
    let mut out = format!("# Findings\n\n{MADE}");
    out.push_str("A finding assesses a result. `error`: the result is not reliable, exit code 1; `warning`: the result is usable with the stated \
     limits; `info`: for information. `strainbridge explain CODE` prints an entry, `strainbridge explain --list --json` all of them.\n\n## \
     Exit codes\n\n");
    out.push_str(&head(&["code", "meaning"]));
    for (code, meaning) in EXIT_CODES {
        out.push_str(&row(&[code, meaning]));
    }
    for c in codes() {
        let _ = write!(
            out,
            "\n## {}\n\n{}; from: {}.\n\n- cause: {}\n- limit: {}\n- remedy: {}\n- example: {}\n",
            c.code,
            c.severities(),
            c.said_by,
            c.cause,
            c.limit,
            c.remedy,
            c.example
        );
    }
    out
}

/// Exit codes of the program.
pub const EXIT_CODES: [(&str, &str); 4] = [
    ("0", "done"),
    (
        "1",
        "done, but a finding of severity `error` states that the result is not reliable",
    ),
    (
        "2",
        "bad input, nothing written: every fault listed as `file:line: field: what is wrong: what to do`; with `--json` also `{\"faults\": [{\"file\", \"line\", \"field\", \"wrong\", \"remedy\"}]}` on standard output",
    ),
    ("130", "stopped by Ctrl-C: no incomplete file remains"),
];
