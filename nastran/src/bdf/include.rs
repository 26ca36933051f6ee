//! INCLUDE: the paths that a file name may mean, and the loader of the files.

use std::collections::BTreeMap;

/// An INCLUDE statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IncludeRequest {
    /// The name as written, without quotes, lines joined.
    pub name: String,
    /// Path of the first deck.
    pub first_deck: String,
    /// Path of the file that holds the statement.
    pub includer: String,
}

/// A file as the loader found it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadedFile {
    /// Path; the same file must always get the same path.
    pub path: String,
    /// Bytes of the file.
    pub bytes: Vec<u8>,
    /// Path of another file that the name may mean, with other contents.
    pub differing_path: Option<String>,
}

/// Loads included files for [`super::read_deck`], which opens no file itself.
pub trait Loader {
    /// Returns the file, or the reason why it cannot be loaded.
    ///
    /// # Errors
    ///
    /// A short reason for the message of the fault.
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String>;
}

impl IncludeRequest {
    /// Returns the paths to try, in order. A bare file name is searched in the folder of the including file, then in the folder of the main deck. A
    /// path with folders is searched in the opposite order. Then both are tried with `\` replaced by `/`.
    ///
    /// `symbol` gives the value of a logical symbol or environment variable, which is used in `SYMBOL:path`, `$SYMBOL/path`, `${SYMBOL}/path` and
    /// `%SYMBOL%/path`.
    ///
    /// # Errors
    ///
    /// The name of the symbol that has no value.
    pub fn candidates(
        &self,
        symbol: impl Fn(&str) -> Option<String>,
    ) -> Result<Vec<String>, String> {
        let name = expand(self.name.trim(), &symbol)?;
        let mut paths = Vec::new();
        let mut push = |p: String| {
            if !paths.contains(&p) {
                paths.push(p);
            }
        };
        for name in [name.clone(), name.replace('\\', "/")] {
            if is_absolute(&name) {
                push(name);
            } else {
                let mut folders = [&self.first_deck, &self.includer];
                if !name.contains(['/', '\\']) {
                    folders.reverse();
                }
                for file in folders {
                    push(join(file, &name));
                }
            }
        }
        Ok(paths)
    }
}

/// Returns whether the path is absolute: `/x`, `\x`, `C:\x`, `C:/x`.
fn is_absolute(name: &str) -> bool {
    let b = name.as_bytes();
    matches!(b, [b'/' | b'\\', ..])
        || matches!(b, [d, b':', b'/' | b'\\', ..] if d.is_ascii_alphabetic())
}

/// Returns the path of `name` in the folder of another file.
fn join(from: &str, name: &str) -> String {
    match from.rfind(['/', '\\']) {
        Some(i) => format!("{}{name}", from.get(..=i).unwrap_or_default()),
        None => name.to_owned(),
    }
}

fn expand(name: &str, symbol: &impl Fn(&str) -> Option<String>) -> Result<String, String> {
    let value = |s: &str| {
        symbol(s)
            .or_else(|| symbol(&s.to_ascii_uppercase()))
            .ok_or_else(|| s.to_owned())
    };
    let with_slash = |mut head: String, tail: &str| {
        if !head.ends_with(['/', '\\']) && !tail.starts_with(['/', '\\']) && !tail.is_empty() {
            head.push('/');
        }
        head + tail
    };
    if let Some(rest) = name.strip_prefix("${")
        && let Some((s, tail)) = rest.split_once('}')
    {
        return Ok(value(s)? + tail);
    }
    if let Some(rest) = name.strip_prefix('$') {
        let end = rest
            .find(|c: char| !c.is_ascii_alphanumeric() && c != '_')
            .unwrap_or(rest.len());
        let (s, tail) = rest.split_at(end);
        return Ok(value(s)? + tail);
    }
    if let Some(rest) = name.strip_prefix('%')
        && let Some((s, tail)) = rest.split_once('%')
    {
        return Ok(value(s)? + tail);
    }
    // A single letter before the colon is a drive.
    if let Some((s, tail)) = name.split_once(':')
        && s.len() > 1
        && s.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    {
        return Ok(with_slash(value(s)?, tail));
    }
    Ok(name.to_owned())
}

/// Loader of included files from memory, by path. Programs that do not read the file system give their files to [`super::read_deck`] with it.
///
/// # Example
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
///
/// let mut loader = MemoryLoader::default();
/// loader.files.insert("model/parts/rail.bdf".to_owned(), b"GRID,1,,0.,0.,0.\n".to_vec());
/// let text = "CEND\nBEGIN BULK\nINCLUDE 'parts/rail.bdf'\nINCLUDE 'parts/none.bdf'\nENDDATA\n";
/// let deck = read_deck("model/main.bdf", text.into(), &mut loader);
/// assert_eq!(deck.path(deck.cards.grids[0].at), "model/parts/rail.bdf");
/// // The missing file is a fault of the line that includes it.
/// assert_eq!(deck.faults.iter().map(|f| f.at.line).collect::<Vec<_>>(), [4]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct MemoryLoader {
    /// Path and bytes; `..` in requests is resolved.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Values of symbols.
    pub symbols: BTreeMap<String, String>,
}

impl Loader for MemoryLoader {
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String> {
        let paths = request
            .candidates(|s| self.symbols.get(s).cloned())
            .map_err(|s| format!("the symbol {s} has no value"))?;
        let paths = paths.iter().map(|p| without_dots(p));
        let mut found = paths.filter_map(|p| Some((self.files.get(&p)?, p)));
        let (bytes, path) = found.next().ok_or("no such file")?;
        Ok(LoadedFile {
            differing_path: found.find(|other| other.0 != bytes).map(|other| other.1),
            path,
            bytes: bytes.clone(),
        })
    }
}

/// Returns the path with `.` and `a/..` removed.
fn without_dots(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "." => {}
            ".." if parts.last().is_some_and(|p| *p != ".." && !p.is_empty()) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.join("/")
}
