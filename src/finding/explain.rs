//! Cause, limit, remedy and example of every code of a finding. This is the only list of codes.
//!
//! The tables are in `codes/*.txt`: four fields for each code below the line `code | severities | commands`. A test compares them with the codes
//! of the program. It fails for a code without an entry, and for an entry without a code.

use super::severity::Severity;
use serde::Serialize;
use std::sync::LazyLock;

/// Tables of codes, one for each subject of the checks.
const TABLES: [&str; 4] = [
    include_str!("codes/model.txt"),
    include_str!("codes/layout.txt"),
    include_str!("codes/strain.txt"),
    include_str!("codes/vehicle.txt"),
];

/// Meaning of the code of a finding.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Code {
    /// The code, such as `loads-not-separable`.
    pub code: &'static str,
    /// Possible severities, the mildest first.
    pub severity: Vec<Severity>,
    /// Commands that report the finding.
    pub said_by: &'static str,
    /// Cause, with its consequence for the answer.
    pub cause: &'static str,
    /// Limit that the measured number is compared with, or `None.`
    pub limit: &'static str,
    /// Text for the measured number `{m}` and the limit `{l}`, with `%` for a share in percent. It is empty if the message contains the numbers.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub numbers: &'static str,
    /// Remedy, as an imperative.
    pub remedy: &'static str,
    /// Example of the finding.
    pub example: &'static str,
}

impl Code {
    /// Returns the severities as text, such as `warning or error`.
    pub fn severities(&self) -> String {
        let names: Vec<&str> = self.severity.iter().map(|s| s.name()).collect();
        names.join(" or ")
    }
}

static CODES: LazyLock<Vec<Code>> = LazyLock::new(|| {
    let mut codes: Vec<Code> = TABLES.iter().flat_map(|t| read_table(t)).collect();
    codes.sort_by_key(|c| c.code);
    codes
});

/// Returns all codes, sorted by name.
pub fn codes() -> &'static [Code] {
    &CODES
}

/// Former codes, each with the one that means the same today.
const RENAMED: [(&str, &str); 31] = [
    ("as-glued-untold", "installed-positions-uncertain"),
    ("dead_channel", "gauge-silent"),
    ("flat-floor", "flat-floor-assumed"),
    ("gauge-missing", "gauge-without-strain"),
    ("gauge-wired-backwards", "input-sign-reversed"),
    ("gauge_swap", "inputs-exchanged"),
    ("gauges-exchanged", "inputs-exchanged"),
    ("hot-at-a-joint", "hot-spot-at-joint"),
    ("inertia-relief-idle", "inertia-relief-unused"),
    ("known-from-model-only", "loads-from-model-only"),
    ("known-loads-sign", "input-sign-reversed"),
    ("known-loads-unchecked", "known-loads-unit-untested"),
    ("known-loads-uneven", "known-loads-unit-doubtful"),
    ("known-loads-unit", "input-unit"),
    ("load-moved", "load-changed-by-effect"),
    ("loads-unlike-known-runs", "loads-unlike-calibration-runs"),
    ("mesh-error-not-weighed", "mesh-error-unknown"),
    ("model-error-learnt", "model-error-estimated"),
    ("no-element-in-deck", "element-not-in-deck"),
    ("no-gauge-may-fail", "no-spare-gauge"),
    ("no-grid-in-deck", "grid-not-in-deck"),
    ("payload-elsewhere", "payload-place-differs"),
    ("payload-vague", "payload-uncertain"),
    ("readings-all-alike", "readings-all-equal"),
    ("record-stands-still", "record-constant"),
    ("run-far-off", "run-deviates"),
    ("states-left-out", "load-states-skipped"),
    ("stress-not-formed", "stress-not-computed"),
    ("stress-not-turned-to-strain", "stress-not-converted"),
    ("vibration-taken-out", "vibration-removed"),
    ("zero-followed", "zero-interpolated"),
];

/// Returns the entry of a code, or of the code that replaced it; `None` if no finding has the code.
pub fn code(name: &str) -> Option<&'static Code> {
    let today = RENAMED.iter().find(|r| r.0 == name);
    let name = today.map_or(name, |r| r.1);
    let i = CODES.binary_search_by(|c| c.code.cmp(name)).ok()?;
    CODES.get(i)
}

/// The entries of a table.
fn read_table(table: &'static str) -> Vec<Code> {
    let mut codes: Vec<Code> = Vec::new();
    for line in table.lines().filter(|l| !l.starts_with('#')) {
        let Some(field) = line.strip_prefix("  ") else {
            codes.extend(read_head(line));
            continue;
        };
        let (Some((name, words)), Some(entry)) = (field.split_once(": "), codes.last_mut()) else {
            continue;
        };
        match name {
            "cause" => entry.cause = words,
            "limit" => entry.limit = words,
            "numbers" => entry.numbers = words,
            "remedy" => entry.remedy = words,
            "example" => entry.example = words,
            _ => {}
        }
    }
    codes
}

/// Reads the head of an entry without its texts; `None` for an empty line.
fn read_head(line: &'static str) -> Option<Code> {
    let mut parts = line.split(" | ");
    let (code, severity, said_by) = (parts.next()?, parts.next()?, parts.next()?);
    Some(Code {
        code,
        severity: severity
            .split(", ")
            .filter_map(Severity::parse_name)
            .collect(),
        said_by,
        cause: "",
        limit: "",
        numbers: "",
        remedy: "",
        example: "",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_is_whole_and_is_unique() {
        for c in codes() {
            let words = [c.said_by, c.cause, c.limit, c.remedy, c.example];
            assert!(words.iter().all(|w| !w.is_empty()), "{}", c.code);
            assert!(!c.severity.is_empty(), "{}", c.code);
            let both = c.numbers.contains("{m") && c.numbers.contains("{l");
            assert!(c.numbers.is_empty() || both, "{}", c.code);
            assert_eq!(code(c.code), Some(c));
        }
        assert!(codes().windows(2).all(|w| w[0].code < w[1].code));
        let heads = TABLES
            .iter()
            .flat_map(|t| t.lines())
            .filter(|l| l.contains(" | "));
        assert_eq!(heads.count(), codes().len());
        for (former, today) in RENAMED {
            assert_eq!(code(former).map(|c| c.code), Some(today));
        }
    }
}
