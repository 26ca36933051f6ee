//! Manifest of a folder: the files that each command wrote. The next run of a command removes files that it no longer writes.
//!
//! The file `.strainbridge` in the folder has a line for each file: the command, a tab and the name. For a file that a person may edit, a tab and the
//! SHA-256 of its bytes follow. Files of other commands are left alone, because one command's tables are often another's input. No command writes
//! over a file that is not listed, or that has changed since.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

/// File name of the manifest.
pub(crate) const NAME: &str = ".strainbridge";

/// Command and name of each file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Manifest {
    entries: BTreeSet<(String, String)>,
    /// SHA-256 of the bytes as they were written, by name.
    digests: BTreeMap<String, String>,
}

impl Manifest {
    /// Reads the manifest of a folder; empty if the folder has no manifest.
    pub(crate) fn read(folder: &Path) -> Self {
        let text = std::fs::read_to_string(folder.join(NAME)).unwrap_or_default();
        let mut out = Self::default();
        for line in text.lines() {
            let mut fields = line.split('\t');
            if let (Some(command), Some(name)) = (fields.next(), fields.next())
                && is_plain(name)
            {
                out.entries.insert((command.to_owned(), name.to_owned()));
                let digest = fields.next().map(|d| (name.to_owned(), d.to_owned()));
                out.digests.extend(digest);
            }
        }
        out
    }

    /// Returns the SHA-256 of a file as written by its command; `None` if it is not known.
    pub(crate) fn digest(&self, name: &str) -> Option<&str> {
        self.digests.get(name).map(String::as_str)
    }

    /// Adds the SHA-256 of files in their written state.
    pub(crate) fn state_digests(&mut self, digests: impl IntoIterator<Item = (String, String)>) {
        self.digests.extend(digests);
    }

    /// Returns the files of a command.
    pub(crate) fn names_of(&self, command: &str) -> BTreeSet<String> {
        let own = self.entries.iter().filter(|e| e.0 == command);
        own.map(|e| e.1.clone()).collect()
    }

    /// Returns whether a command wrote a file of this name.
    pub(crate) fn holds(&self, name: &str) -> bool {
        self.entries.iter().any(|e| e.1 == name)
    }

    /// Returns the command that wrote a file.
    pub(crate) fn writer(&self, name: &str) -> Option<&str> {
        let found = self.entries.iter().find(|e| e.1 == name);
        found.map(|e| e.0.as_str())
    }

    /// Returns the files of every other command. For files that a command writes before its answer, the key is the command, a blank and a word.
    pub(crate) fn of_others(&self, command: &str) -> BTreeMap<&str, Vec<&str>> {
        let of_other = |by: &str| by.split(' ').next() != Some(command);
        let mut out: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (by, name) in self.entries.iter().filter(|e| of_other(&e.0)) {
            out.entry(by).or_default().push(name);
        }
        out
    }

    /// Adds files to the list of a command.
    pub(crate) fn add(&mut self, command: &str, names: &[String]) {
        self.entries.retain(|e| !names.contains(&e.1));
        self.digests.retain(|name, _| !names.contains(name));
        let added = names.iter().map(|n| (command.to_owned(), n.clone()));
        self.entries.extend(added);
    }

    /// Replaces the list of files of a command. Returns earlier files of the command that no command writes now.
    pub(crate) fn replace(&mut self, command: &str, names: &[String]) -> Vec<PathBuf> {
        let (before, others): (BTreeSet<_>, BTreeSet<_>) = std::mem::take(&mut self.entries)
            .into_iter()
            .partition(|e| e.0 == command);
        self.entries = others;
        // A file that several commands wrote belongs to the last of them.
        self.add(command, names);
        let gone = before.into_iter().map(|e| e.1);
        gone.filter(|n| !self.holds(n)).map(PathBuf::from).collect()
    }

    /// Returns the manifest as text.
    pub(crate) fn text(&self) -> String {
        let line = |(command, name): &(String, String)| match self.digest(name) {
            Some(digest) => format!("{command}\t{name}\t{digest}\n"),
            None => format!("{command}\t{name}\n"),
        };
        self.entries.iter().map(line).collect()
    }
}

/// Returns whether a name leads to a file of the folder itself.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!(
        (parts.next(), parts.next()),
        (Some(Component::Normal(_)), None)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_gives_up_what_it_no_longer_writes_and_nothing_of_others() {
        let mut m = Manifest::default();
        let names = |list: &[&str]| list.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
        assert!(
            m.replace("place", &names(&["gauges.csv", "report.html"]))
                .is_empty()
        );
        assert!(
            m.replace(
                "recover",
                &names(&["loads.csv", "loads.bin", "report.html"])
            )
            .is_empty()
        );
        let gone = m.replace("recover", &names(&["loads.csv", "report.html"]));
        assert_eq!(gone, [PathBuf::from("loads.bin")]);
        assert!(m.text().contains("place\tgauges.csv\n"));
        assert!(m.holds("loads.csv") && !m.holds("loads.bin"));
        assert_eq!(m.of_others("recover")["place"], ["gauges.csv"]);
        m.add("place inputs", &names(&["place.toml"]));
        assert!(m.of_others("place").keys().all(|k| *k == "recover"));
        // `report.html` belongs to `recover` now.
        assert!(m.replace("place", &names(&["gauges.csv"])).is_empty());
    }

    #[test]
    fn names_that_lead_out_of_the_folder_are_no_names() {
        for name in ["../x", "/etc/x", "a/b", "..", ""] {
            assert!(!is_plain(name), "{name}");
        }
        assert!(is_plain("loads.csv"));
    }
}
