//! INCLUDE statements of a deck that is written to another folder.
//!
//! Files that change, and files with relative INCLUDEs, are written into the folder of the new deck. Every INCLUDE in them names the same file as
//! before, by a path from that folder. All other files remain in their folders.

use nastran::bdf::Deck;
use std::path::{Component, Path, PathBuf};

/// Longest line of an INCLUDE; Nastran reads 72 columns.
const WIDTH: usize = 70;

struct Statement {
    /// Byte range of the statement's lines.
    start: usize,
    end: usize,
    /// The name, lines joined.
    name: String,
}

/// Returns the files to write into `folder`, each with name and bytes. The first is the deck as `<stem>.bdf`. `edited` contains the files of the deck
/// in order.
pub(crate) fn relocate_deck(
    deck: &Deck,
    edited: Vec<(String, Vec<u8>)>,
    folder: &Path,
    stem: &str,
) -> Vec<(String, Vec<u8>)> {
    let first = edited.first().map(|f| f.0.clone()).unwrap_or_default();
    let statements: Vec<Vec<Statement>> = edited.iter().map(|f| includes(&f.1)).collect();
    let changed = |i: usize| deck.sources.get(i).is_none_or(|s| s.bytes != edited[i].1);
    let copied: Vec<bool> = (0..edited.len())
        .map(|i| i == 0 || changed(i) || statements[i].iter().any(|s| !is_fixed(&s.name)))
        .collect();
    let name_of = |i: usize| -> String {
        if i == 0 {
            return format!("{stem}.bdf");
        }
        let file = Path::new(&edited[i].0)
            .file_name()
            .map(|n| n.to_string_lossy().into_owned())
            .unwrap_or_default();
        format!("{stem}_{i}_{file}")
    };
    let mut out = Vec::new();
    for i in (0..edited.len()).filter(|i| copied[*i]) {
        let (path, bytes) = &edited[i];
        let mut text = Vec::with_capacity(bytes.len());
        let mut at = 0;
        for s in &statements[i] {
            let target = edited.iter().position(|f| {
                names(&s.name, &first, path)
                    .iter()
                    .any(|p| is_same_path(p, Path::new(&f.0)))
            });
            let new = match target {
                Some(t) if copied[t] => name_of(t),
                Some(t) => from_folder(folder, Path::new(&edited[t].0)),
                None if is_fixed(&s.name) => continue,
                None => from_folder(folder, &path_in_folder_of(&first, &s.name)),
            };
            text.extend_from_slice(&bytes[at..s.start]);
            text.extend_from_slice(statement(&new).as_bytes());
            at = s.end;
        }
        text.extend_from_slice(&bytes[at..]);
        out.push((name_of(i), text));
    }
    out
}

/// Returns the INCLUDE statements of a file.
fn includes(bytes: &[u8]) -> Vec<Statement> {
    let mut out = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let end = line_end(bytes, at);
        let line = &bytes[at..end];
        let trimmed = line.trim_ascii_start();
        if trimmed.len() > 7
            && trimmed[..7].eq_ignore_ascii_case(b"INCLUDE")
            && !trimmed[7].is_ascii_alphanumeric()
        {
            let rest = String::from_utf8_lossy(&trimmed[7..]).into_owned();
            let rest = rest
                .trim_start()
                .trim_start_matches('=')
                .trim_start()
                .to_owned();
            let quote = rest.chars().next().filter(|c| matches!(c, '\'' | '"'));
            let (mut name, mut stop) = (rest, end);
            if let Some(q) = quote {
                while name.matches(q).count() < 2 && stop < bytes.len() {
                    let next = line_end(bytes, stop);
                    name = format!(
                        "{}{}",
                        name.trim_end(),
                        String::from_utf8_lossy(&bytes[stop..next]).trim_start()
                    );
                    stop = next;
                }
                name = name.split(q).nth(1).unwrap_or_default().to_owned();
            } else {
                name = name
                    .split(['$', ' ', '\t', '\r', '\n'])
                    .next()
                    .unwrap_or_default()
                    .to_owned();
            }
            out.push(Statement {
                start: at,
                end: stop,
                name: name.trim().to_owned(),
            });
            at = stop;
        } else {
            at = end;
        }
    }
    out
}

fn line_end(bytes: &[u8], from: usize) -> usize {
    bytes[from..]
        .iter()
        .position(|b| *b == b'\n')
        .map_or(bytes.len(), |n| from + n + 1)
}

/// Returns whether a name means the same file from any folder: it is absolute, or contains a symbol.
fn is_fixed(name: &str) -> bool {
    name.starts_with(['/', '\\', '$', '%']) || name.contains(':')
}

/// Returns the possible paths of a name.
fn names(name: &str, first: &str, includer: &str) -> Vec<PathBuf> {
    let symbol = name
        .split_once(':')
        .filter(|(s, _)| s.len() > 1)
        .and_then(|(s, rest)| {
            std::env::var(s)
                .ok()
                .map(|v| Path::new(&v).join(rest.trim_start_matches('/')))
        });
    [name.to_owned(), name.replace('\\', "/")]
        .iter()
        .flat_map(|n| [path_in_folder_of(first, n), path_in_folder_of(includer, n)])
        .chain(symbol)
        .collect()
}

fn path_in_folder_of(file: &str, name: &str) -> PathBuf {
    Path::new(file).parent().unwrap_or(Path::new("")).join(name)
}

fn is_same_path(a: &Path, b: &Path) -> bool {
    normalize_path(a) == normalize_path(b)
}

/// Returns a path without `.` and `folder/..`.
fn normalize_path(p: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for c in p.components() {
        match c {
            Component::CurDir => {}
            Component::ParentDir
                if matches!(out.components().next_back(), Some(Component::Normal(_))) =>
            {
                out.pop();
            }
            c => out.push(c),
        }
    }
    out
}

/// Returns the path from a folder to a file, with forward slashes. The path is absolute if there is no relative path.
pub(crate) fn from_folder(folder: &Path, file: &Path) -> String {
    let full = |p: &Path| {
        std::path::absolute(p)
            .map(|p| normalize_path(&p))
            .unwrap_or_else(|_| normalize_path(p))
    };
    let (from, to) = (full(folder), full(file));
    let a: Vec<Component> = from.components().collect();
    let b: Vec<Component> = to.components().collect();
    let shared = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let text = if shared == 0 || (shared == 1 && a.len() > 1) {
        to.display().to_string()
    } else {
        let mut path = PathBuf::new();
        a[shared..].iter().for_each(|_| path.push(".."));
        b[shared..].iter().for_each(|c| path.push(c));
        path.display().to_string()
    };
    text.replace('\\', "/")
}

/// Returns the statement, on as many lines as it needs.
fn statement(name: &str) -> String {
    let mut text = String::from("INCLUDE '");
    let mut used = text.len();
    for part in name.split_inclusive('/') {
        if used + part.len() + 1 > WIDTH && used > 9 {
            text.push('\n');
            used = 0;
        }
        text.push_str(part);
        used += part.len();
    }
    text.push_str("'\n");
    text
}
