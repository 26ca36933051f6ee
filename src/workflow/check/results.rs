//! Result files in `result.json` and as text. Every block is decoded to find damage.

use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, FaultList};
use crate::host::files::FileBytes;
use crate::host::work::Work;
use nastran::results::{Block, ResultsFile, SalvagedFile};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// One result file.
#[derive(Serialize)]
pub struct ResultEntry {
    path: String,
    solver: String,
    word_bytes: usize,
    tables: Vec<TableEntry>,
    /// Every table of an OP2 by name, in file order, results or not.
    file_tables: Vec<String>,
    #[serde(skip)]
    pub(super) bytes: FileBytes,
    /// Whether a job names the file.
    #[serde(skip)]
    pub(super) is_of_job: bool,
}

/// One block of results.
#[derive(Serialize)]
struct TableEntry {
    name: String,
    quantity: &'static str,
    subcase: u32,
    analysis: &'static str,
    /// Card name, or the number of a type without name.
    element_type: Option<String>,
    rows: usize,
    /// Mode number or load step, 0 in statics.
    mode: i32,
    decoded: bool,
    #[serde(skip)]
    is_complex: bool,
}

impl ResultEntry {
    /// Returns the path as given.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// Returns the text for people: one line for each kind of table.
    pub fn text(&self) -> String {
        let mut kinds: BTreeMap<(&str, &str, String, bool), (Vec<u32>, usize)> = BTreeMap::new();
        for t in &self.tables {
            let key = (
                t.quantity,
                t.analysis,
                t.element_type.clone().unwrap_or_default(),
                t.is_complex,
            );
            let entry = kinds.entry(key).or_default();
            if !entry.0.contains(&t.subcase) {
                entry.0.push(t.subcase);
            }
            entry.1 += t.rows;
        }
        let mut out = format!(
            "results `{}`: {}{}",
            self.path,
            self.solver,
            // A text file has no word size.
            match self.word_bytes {
                0 => String::new(),
                n => format!(", {n} bytes a word"),
            }
        );
        for ((quantity, analysis, element, is_complex), (subcases, rows)) in kinds {
            let complex = if is_complex {
                " (complex, not read)"
            } else {
                ""
            };
            let on = if element.is_empty() {
                String::new()
            } else {
                format!(" of {element}")
            };
            let n = subcases.len();
            let plural = if n == 1 { "" } else { "s" };
            out.push_str(&format!(
                "\n  {quantity}{on}, {analysis}{complex}: {n} subcase{plural}, {rows} rows"
            ));
        }
        out
    }
}

pub(super) fn check_results(
    work: &mut Work,
    given: &str,
    bytes: FileBytes,
) -> (Option<ResultEntry>, FaultList) {
    match ResultsFile::salvage(&bytes, given) {
        Ok(read) => {
            let (entry, findings, faults) = describe(given, &bytes, &read);
            work.findings.extend(findings);
            (Some(entry), faults)
        }
        Err(e) => {
            let fault = Fault::new(given, "results", e.to_string(), "write the file again");
            (None, vec![fault])
        }
    }
}

fn describe(
    given: &str,
    bytes: &FileBytes,
    read: &SalvagedFile<ResultsFile>,
) -> (ResultEntry, Vec<Finding>, Vec<Fault>) {
    let file = &read.file;
    let mut faults: Vec<Fault> = read
        .damage
        .iter()
        .map(|d| damaged_file_fault(given, d.to_string()))
        .collect();
    let decoded: Vec<_> = (0..file.blocks().len())
        .into_par_iter()
        .map(|i| file.rows(i).map(|r| r.len()))
        .collect();
    let mut tables = Vec::with_capacity(decoded.len());
    let mut undecoded: BTreeMap<String, usize> = BTreeMap::new();
    for (block, rows) in file.blocks().iter().zip(decoded) {
        match &rows {
            Err(e) if e.is_damage() => faults.push(damaged_file_fault(given, e.to_string())),
            Err(e) => *undecoded.entry(e.to_string()).or_default() += 1,
            Ok(_) => {}
        }
        tables.push(entry(block, rows.ok()));
    }
    let mut findings: Vec<Finding> = file
        .notes()
        .iter()
        .map(|n| {
            Finding::new(
                Severity::Info,
                "table-skipped",
                format!("{given}: {}", n.subject),
                n.message.clone(),
                "",
            )
        })
        .collect();
    for (why, n) in undecoded {
        let message = format!(
            "{n} block{} cannot be decoded: {why}",
            if n == 1 { "" } else { "s" }
        );
        findings.push(Finding::new(
            Severity::Info,
            "block-not-decoded",
            given,
            message,
            "",
        ));
    }
    let mut file_tables = Vec::new();
    if let ResultsFile::Op2(op2) = file {
        file_tables = op2.tables.iter().map(|t| t.name.clone()).collect();
    }
    let entry = ResultEntry {
        path: given.to_owned(),
        solver: file.solver(),
        word_bytes: file.word_bytes(),
        tables,
        file_tables,
        bytes: bytes.clone(),
        is_of_job: false,
    };
    (entry, findings, faults)
}

fn damaged_file_fault(given: &str, what: String) -> Fault {
    Fault::new(
        given,
        "results",
        format!("cut short or damaged: {what}"),
        "write or copy the file again",
    )
}

fn entry(block: &Block, rows: Option<usize>) -> TableEntry {
    TableEntry {
        name: block.table.clone(),
        quantity: block.quantity.word(),
        subcase: block.subcase,
        analysis: block.analysis.word(),
        element_type: block
            .element
            .map(|e| e.name().map_or_else(|| e.0.to_string(), str::to_owned)),
        rows: rows.unwrap_or(block.entries),
        mode: block.mode,
        decoded: rows.is_some(),
        is_complex: block.complex,
    }
}
