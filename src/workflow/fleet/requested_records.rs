//! Records requested by the runs into a folder, and the requested records that are missing when results are merged.

use super::day::FileHead;
use super::name::Shard;
use crate::finding::{Finding, Severity, list_few};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Last part of the names of these files in the folder of the stored results.
pub const ASKED: &str = "asked";

/// Records requested by a run. All parts (shards) of one run request the same records.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RequestedRecords {
    /// Digest of the inputs that the result of a record depends on, without the bytes of the record.
    pub job: String,
    /// Number of parts (shards) of the run.
    pub parts: usize,
    /// Paths of all requested records, sorted.
    pub files: Vec<String>,
    /// Path of this file.
    #[serde(skip)]
    pub place: String,
}

impl RequestedRecords {
    /// Whether this run requests all records of another run of the same job.
    pub fn holds(&self, other: &Self) -> bool {
        let own = |f: &String| self.files.binary_search(f).is_ok();
        self.job == other.job && other.files.iter().all(own)
    }

    /// Returns an error finding with the requested records, and their parts, that have no stored result.
    pub fn find_missing_results(&self, held: &[FileHead]) -> Option<Finding> {
        let held: BTreeSet<&str> = held.iter().map(|f| f.path.as_str()).collect();
        let is_missing = |f: &(usize, &String)| !held.contains(f.1.as_str());
        let missing: Vec<(usize, &String)> =
            self.files.iter().enumerate().filter(is_missing).collect();
        let paths: Vec<&str> = missing.iter().map(|m| m.1.as_str()).collect();
        let of = self.parts;
        let lacks = |number: &usize| {
            let shard = Shard {
                number: *number,
                of,
            };
            missing.iter().any(|m| shard.holds(m.0))
        };
        let parts: Vec<String> = (1..=of)
            .filter(lacks)
            .map(|n| format!("{n}/{of}"))
            .collect();
        let in_parts = match of {
            0 | 1 => String::new(),
            _ => format!(" (shard {})", list_few(&parts)),
        };
        (!missing.is_empty()).then(|| {
            Finding::new(
                Severity::Error,
                "fleet-records-missing",
                list_few(&paths),
                format!(
                    "of {} requested records {} have no stored result{in_parts}: their hours and damage are not in this merge",
                    self.files.len(),
                    missing.len()
                ),
                format!(
                    "run them into this folder; if they are no longer wanted, delete `{}`",
                    self.place
                ),
            )
            .with_numbers(missing.len() as f64, 0.0)
        })
    }
}
