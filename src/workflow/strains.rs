//! `strains`: shell and bar strain of every static subcase, in the element and the basic frame.

use crate::fe::Solution;
use crate::fe::from_results::{
    Displacements, ReadOptions, other_element_types, solution_from_results,
};
use crate::fe::strain_rows::{n_rows, without_normal_strain};
use crate::finding::{Finding, Severity, list_few};
use crate::host::context::Context;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::FileBytes;
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::model::Model;
use crate::strain_chain::deck::{looks_like_op2, read_model};
use crate::strain_chain::repeated_subcases::find_repeated_subcases;
use nastran::results::ResultsFile;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Strain of every static subcase of results.
#[derive(Serialize)]
pub struct Strains {
    /// Rows of `strains.csv`.
    pub rows: usize,
    /// Number of static subcases.
    pub subcases: usize,
    /// Ids of the subcases.
    pub subcase_ids: Vec<u32>,
    /// The deck as given.
    #[serde(skip)]
    pub given: String,
    /// Model of the deck.
    #[serde(skip)]
    pub model: Model,
    /// The strain.
    #[serde(skip)]
    pub solution: Solution,
}

impl Answer for Strains {
    const COMMAND: &'static str = "strains";
    const RESULT: &'static str = "The strain";

    fn verdict(&self) -> String {
        format!(
            "{} of strain in {}, from {}.",
            count_of(self.rows, "row"),
            count_of(self.subcases, "static subcase"),
            self.solution.source
        )
    }
}

/// Reads shell and bar strain of every static subcase, in element and basic frame. `strains.csv` contains the rows.
///
/// # Errors
/// Returns files that can't be read, or that are not a deck and its results.
///
/// # Example
/// The strain of a bar in a punch file of Nastran:
/// ```
/// use std::path::Path;
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, strains};
///
/// # const DECK: &str = "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.\nCBAR,1,1,1,2,0.,0.,1.
/// # PBAR,1,1,600.,2.+4,8.+4,1.+4\n,10.,0.\nMAT1,1,210000.,,.3,7.85-9\nSPC1,1,123456,1\nENDDATA\n";
/// # let head = ["$TITLE   = BAR", "$SUBTITLE=", "$LABEL   =", "$ELEMENT STRAINS", "$REAL OUTPUT",
/// #     "$SUBCASE ID =           1", "$ELEMENT TYPE =          34  BAR"].map(|l| format!("{l:<72}{:>8}\n", 1));
/// let words = [-2.5e-4, 0.0, 0.0, 0.0, 1e-5, 1e-5, -2.4e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-5, 1e-5, 0.0];
/// # let lines = words.chunks(3).enumerate().map(|(i, three)| {
/// #     let slots: String = three.iter().map(|v| format!("{v:>18.6E}")).collect();
/// #     format!("{:<72}{:>8}\n", format!("{:<18}{slots}", if i == 0 { "         1" } else { "-CONT-" }), 1)
/// # });
/// # let punch = head.concat() + &lines.collect::<String>();
/// let files = InMemory::default().with_file("bar.bdf", DECK).with_file("bar.pch", punch);
/// let found = strains(Path::new("bar.bdf"), &["bar.pch".into()], &Context::new(&files))?;
/// assert_eq!(found.subcase_ids, [1]);
/// let bar = found.model.beam_ix(1).unwrap();
/// let (points, axial) = found.solution.cases[0].beams.strain_at(bar, 0.0).unwrap();
/// // Recovery point C at end A: bending and axial strain together.
/// assert!((points[0] - (-2.5e-4 + 1e-5)).abs() < 1e-12);
/// assert!((axial - 1e-5).abs() < 1e-12);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn strains(deck: &Path, results: &[PathBuf], cx: &Context) -> Result<Outcome<Strains>, Faults> {
    let mut work = Work::new(cx);
    let given = deck.display().to_string();
    let deck = work.stage("deck", |s| read_model(&mut s.inputs, Path::new(""), &given))?;
    Faults::check(deck.unread_part_faults())?;
    work.findings.extend(deck.findings.iter().cloned());
    work.findings.extend(find_repeated_subcases(&deck));
    // Without elements, strain has no place, so every fault is an error. Otherwise the solver could run the deck, and a fault elsewhere (for example
    // an unused set) is a warning.
    if deck.model.shells.is_empty() && deck.model.beams.is_empty() {
        Faults::check(deck.faults.clone())?;
    }
    let warn = |f: &Fault| {
        Finding::new(
            Severity::Warning,
            "deck-fault",
            given.as_str(),
            f.to_string(),
            "see `check`; the mesh is used unchanged",
        )
    };
    work.findings.extend(deck.faults.iter().map(warn));
    let files = work.stage("read", |s| result_bytes(results, &given, s))?;
    let (mut opened, mut faults) = (Vec::new(), FaultList::new());
    for (name, bytes) in &files {
        match ResultsFile::read(bytes, name) {
            Ok(file) => opened.push((name.as_str(), file)),
            Err(e) => faults.push(Fault::new(
                name,
                "results",
                e.to_string(),
                "give a result file of this deck",
            )),
        }
    }
    Faults::check(faults)?;
    let options = ReadOptions {
        displacements: Displacements::Leave,
        ..ReadOptions::default()
    };
    let named: Vec<(&str, &ResultsFile)> =
        opened.iter().map(|(name, file)| (*name, file)).collect();
    let mut solution = work.stage("strain", |_| {
        solution_from_results(&deck.model, &named, &options)
    });
    if let Some(cut) = deck.find_truncation(&solution.findings) {
        return Err(cut.into());
    }
    if let Some(other) = other_element_types(&solution.findings) {
        let fault = Fault::from_finding(&*other.subject, "results", other);
        return Err(fault.into());
    }
    work.findings.append(&mut solution.findings);
    let silent = without_normal_strain(&deck.model, &solution.cases);
    if !silent.is_empty() {
        let ids: Vec<String> = silent.iter().map(u32::to_string).collect();
        work.findings.push(Finding::new(
            Severity::Info,
            "normal-strain-unknown",
            format!("properties {}", list_few(&ids)),
            "the strain along their thickness is unknown: the basic-frame tensor contains only the part in the surface",
            "",
        ));
    }
    let subcase_ids: Vec<u32> = solution.cases.iter().map(|c| c.subcase).collect();
    let rows = solution.cases.iter().map(|c| n_rows(&deck.model, c)).sum();
    if rows == 0 {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-strain-rows",
            given.as_str(),
            "the results contain neither strain nor stress of shells, bars or beams in a static subcase",
            "ask for STRAIN(FIBER) = ALL in every subcase, or let `solve` on the deck compute it",
        ));
    }
    let answer = Strains {
        rows,
        subcases: subcase_ids.len(),
        subcase_ids,
        given,
        model: deck.model,
        solution,
    };
    Ok(work.finish(StatedUnits::default(), answer))
}

/// Returns name and bytes of every result file. This is the deck itself if it is an OP2 and no other file is given.
fn result_bytes(
    results: &[PathBuf],
    deck: &str,
    work: &mut Work,
) -> Result<Vec<(String, FileBytes)>, Faults> {
    let mut names: Vec<String> = results.iter().map(|p| p.display().to_string()).collect();
    let from_deck = names.is_empty();
    if from_deck {
        names.push(deck.to_owned());
    }
    let (mut files, mut faults) = (Vec::new(), FaultList::new());
    for name in names {
        match work.inputs.read(Path::new(""), &name) {
            Ok(bytes) if from_deck && !looks_like_op2(&bytes) => {
                faults.push(Fault::new(
                    &name,
                    "results",
                    "no result file given",
                    "name the OP2, punch or H5 file after the deck, or let `solve` on the deck write one",
                ));
            }
            Ok(bytes) => files.push((name, bytes)),
            Err(fault) => faults.push(fault),
        }
    }
    Faults::check(faults)?;
    Ok(files)
}
