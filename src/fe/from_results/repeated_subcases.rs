//! Subcases whose results are in a file, or in several files, more than once with different values.

use super::blocks::{is_bar, is_shell_or_bar};
use crate::finding::{Finding, Severity};
use nastran::results::{Analysis, Block, Quantity, ResultsFile, RowId, Rows, ShellForm};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Errors of rounding, in units of the relative rounding of both files, up to which two values are one.
const ROUNDINGS: f64 = 4.0;
/// Share of the largest value of a table up to which two values are one: results of one run on two machines differ by less.
const SHARE: f64 = 1e-6;

/// Remedy for a file that contains a subcase more than once.
pub const HOLD_ONCE: &str = "export results that contain each subcase once; of an optimisation, export the design that the deck describes";

/// A subcase that occurs more than once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RepeatedSubcase {
    /// Id of the subcase.
    pub subcase: u32,
    /// Quantity whose values differ.
    pub quantity: Quantity,
    /// Number of each file that contains the subcase, with the number of occurrences.
    pub files: Vec<(usize, usize)>,
}

/// Key of tables whose rows are comparable: subcase, quantity, card of the elements, form, table of vectors.
type Key = (u32, Quantity, u32, Option<u8>, String);

/// Returns the static subcases whose strain or displacement occurs more than once with different values. `wanted` limits the search to some subcases.
/// Stress replaces strain if there is no strain. Elements that are spread over several tables or files are not a repetition, and neither are equal
/// values.
pub fn find_repeated_results(
    files: &[&ResultsFile],
    wanted: Option<&BTreeSet<u32>>,
) -> Vec<RepeatedSubcase> {
    let mut groups: BTreeMap<Key, Vec<(usize, usize)>> = BTreeMap::new();
    let mut strained: BTreeSet<(u32, bool)> = BTreeSet::new();
    for (f, file) in files.iter().enumerate() {
        for (b, block) in file.blocks().iter().enumerate() {
            let is_wanted = wanted.is_none_or(|w| w.contains(&block.subcase));
            if let Some(key) = key_of(block).filter(|_| is_wanted) {
                if block.quantity == Quantity::Strain {
                    strained.insert((block.subcase, is_bar(block)));
                }
                groups.entry(key).or_default().push((f, b));
            }
        }
    }
    let mut found: BTreeMap<(u32, Quantity), BTreeMap<usize, usize>> = BTreeMap::new();
    for ((subcase, quantity, ..), blocks) in groups {
        let block = |(f, b): (usize, usize)| files.get(f)?.blocks().get(b);
        let is_bar = blocks.first().and_then(|at| block(*at)).is_some_and(is_bar);
        let is_read = quantity != Quantity::Stress || !strained.contains(&(subcase, is_bar));
        if blocks.len() < 2 || !is_read {
            continue;
        }
        let mut times: BTreeMap<usize, usize> = BTreeMap::new();
        for at in find_conflicting_files(files, &blocks) {
            *times.entry(at).or_default() += 1;
        }
        let entry = found.entry((subcase, quantity)).or_default();
        for (file, n) in times {
            let most = entry.entry(file).or_default();
            *most = n.max(*most);
        }
    }
    found.retain(|_, files| !files.is_empty());
    // One finding is enough for a subcase whose strain and displacements are both repeated.
    let strained = found.keys().filter(|k| k.1 != Quantity::Displacement);
    let strained: BTreeSet<u32> = strained.map(|k| k.0).collect();
    found.retain(|k, _| k.1 != Quantity::Displacement || !strained.contains(&k.0));
    found
        .into_iter()
        .map(|((subcase, quantity), files)| RepeatedSubcase {
            subcase,
            quantity,
            files: files.into_iter().collect(),
        })
        .collect()
}

fn key_of(block: &Block) -> Option<Key> {
    let is_plain = block.analysis == Analysis::Statics && !block.complex && !block.sort2;
    let table = match block.quantity {
        Quantity::Strain | Quantity::Stress if is_shell_or_bar(block) => String::new(),
        Quantity::Displacement => block.table.clone(),
        _ => return None,
    };
    // Element types of the same card, with and without corners, get the same number.
    let element = match block.element.map_or(0, |e| e.0) {
        144 => 33,
        228 => 82,
        227 => 70,
        other => other,
    };
    let form = block.form.map(|f| u8::from(f == ShellForm::Curvature));
    is_plain.then_some((block.subcase, block.quantity, element, form, table))
}

/// The file of each of these blocks that shares rows with another one and has other values there.
fn find_conflicting_files(files: &[&ResultsFile], blocks: &[(usize, usize)]) -> Vec<usize> {
    let decoded = blocks.iter().filter_map(|(f, b)| {
        let file = files.get(*f)?;
        Some((*f, file.precision(), file.rows(*b).ok()?))
    });
    let decoded: Vec<(usize, f64, Rows)> = decoded.collect();
    let largest = decoded
        .iter()
        .flat_map(|d| rows_to_compare(&d.2).flat_map(|r| r.1));
    let largest = largest.fold(0.0_f64, |most, v| {
        if v.is_finite() {
            most.max(v.abs())
        } else {
            most
        }
    });
    let mut first: HashMap<(RowId, usize), (usize, &[f64])> = HashMap::new();
    let mut conflict = vec![false; decoded.len()];
    for (at, (_, precision, rows)) in decoded.iter().enumerate() {
        for (key, values) in rows_to_compare(rows) {
            let Some((other, before)) = first.get(&key).copied() else {
                first.insert(key, (at, values));
                continue;
            };
            let both = precision + decoded.get(other).map_or(0.0, |d| d.1);
            let differs = |(a, b): (&f64, &f64)| {
                let equal = ROUNDINGS * both * a.abs().max(b.abs()) + SHARE * largest;
                (a - b).abs() > equal
            };
            if values.iter().zip(before).any(differs) {
                for i in [at, other] {
                    if let Some(c) = conflict.get_mut(i) {
                        *c = true;
                    }
                }
            }
        }
    }
    let marked = decoded.iter().zip(&conflict).filter(|(_, c)| **c);
    marked.map(|(d, _)| d.0).collect()
}

/// Rows with what they are compared by: id and number among rows of one id (stations of beams), values without derived ones.
fn rows_to_compare(rows: &Rows) -> impl Iterator<Item = ((RowId, usize), &[f64])> {
    // Rows of shells begin with the fibre distance; angle and principal values follow the components.
    let columns = match rows.columns.first() {
        Some(&"fiber") => 1..4,
        _ => 0..rows.columns.len(),
    };
    let mut before: Option<(RowId, usize)> = None;
    rows.ids.iter().enumerate().map(move |(i, id)| {
        let number = match before {
            Some((last, n)) if last == *id => n + 1,
            _ => 0,
        };
        before = Some((*id, number));
        let values = rows.row(i).get(columns.clone()).unwrap_or_default();
        ((*id, number), values)
    })
}

impl RepeatedSubcase {
    /// Returns whether the strain of gauges depends on the repeated quantity.
    pub fn is_of_strain(&self) -> bool {
        self.quantity != Quantity::Displacement
    }

    /// Returns whether a single file contains the subcase more than once.
    pub fn is_in_one_file(&self) -> bool {
        self.files.iter().any(|(_, times)| *times > 1)
    }

    /// Returns a description of the repeated results and their places, for messages.
    pub fn words(&self, names: &[&str]) -> String {
        let file = |(f, times): &(usize, usize)| {
            let name = names.get(*f).copied().unwrap_or_default();
            match times {
                1 => format!("in `{name}`"),
                2 => format!("twice in `{name}`"),
                n => format!("{n} times in `{name}`"),
            }
        };
        let files: Vec<String> = self.files.iter().map(file).collect();
        format!(
            "subcase {} is {} with different {}",
            self.subcase,
            files.join(" and "),
            self.quantity.word()
        )
    }

    /// Returns the warning that names the subcase, the files and which results are used.
    pub fn finding(&self, names: &[&str]) -> Finding {
        let files = self.files.iter();
        let files = files.filter_map(|(f, _)| names.get(*f).copied());
        let subject = files.collect::<Vec<_>>().join(", ");
        let (used, remedy) = match (self.is_in_one_file(), self.files.len()) {
            (true, 1) => ("the last one in the file is used", HOLD_ONCE),
            (true, _) => ("of each file the last one is used", HOLD_ONCE),
            (false, _) => (
                "the results of each file are kept, in file order",
                "name the file of each load in the job: result = \"..\"",
            ),
        };
        let times: usize = self.files.iter().map(|f| f.1).sum();
        Finding::new(
            Severity::Warning,
            "subcase-ambiguous",
            subject,
            format!("{}: {used}", self.words(names)),
            remedy,
        )
        .with_numbers(times as f64, 1.0)
    }
}

#[cfg(test)]
mod tests;
