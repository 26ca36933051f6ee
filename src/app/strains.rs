//! `strains`: shell and bar strain of every static subcase, in the element and the basic frame.

use super::deck::{looks_like_op2, read_model};
use super::fault::{Fault, FaultList, Faults};
use super::files::FileBytes;
use super::{DeckArguments, Session};
use crate::fe::from_results::{Displacements, ReadOptions, solution_from_results};
use crate::fe::strain_rows::without_normal_strain;
use crate::finding::{Finding, Severity};
use crate::report::strain::strains_page;
use crate::report::write_strains;
use nastran::results::ResultsFile;
use std::path::Path;

/// Reads deck and results and writes `strains.csv`.
pub fn run(arguments: &DeckArguments, session: &mut Session) -> Result<(), Faults> {
    let given = arguments.deck.display().to_string();
    let deck = session
        .stage("deck", |s| read_model(&mut s.inputs, Path::new(""), &given))
        .map_err(Faults::from)?;
    session.findings.extend(deck.findings);
    // Without elements nothing can be placed. Else the run was possible, and a fault elsewhere (an unused set, say) is worth a warning.
    if deck.model.shells.is_empty() && deck.model.beams.is_empty() {
        Faults::check(deck.faults.clone())?;
    }
    let warn = |f: &Fault| {
        Finding::new(
            Severity::Warning,
            "deck-fault",
            given.as_str(),
            f.to_string(),
            "see `check`; the mesh is used as it is",
        )
    };
    session.findings.extend(deck.faults.iter().map(warn));
    let files = session.stage("read", |s| result_bytes(arguments, &given, s))?;
    let (mut opened, mut faults) = (Vec::new(), FaultList::new());
    for (name, bytes) in &files {
        match ResultsFile::read(bytes, name) {
            Ok(file) => opened.push((name.as_str(), file)),
            Err(e) => faults.push(Fault::of(
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
    let mut solution = session.stage("strain", |_| {
        solution_from_results(&deck.model, &named, &options)
    });
    session.findings.append(&mut solution.findings);
    let silent = without_normal_strain(&deck.model, &solution.cases);
    if !silent.is_empty() {
        let ids: Vec<String> = silent.iter().map(u32::to_string).collect();
        session.findings.push(Finding::new(
            Severity::Info,
            "normal-strain-unknown",
            format!("properties {}", ids.join(", ")),
            "their material does not give the strain along the thickness: the basic-frame tensor holds the part in the surface alone",
            "",
        ));
    }
    let mut rows = 0;
    session.stage("write", |s| -> Result<(), Faults> {
        let output = s.output_for(&arguments.deck)?;
        let write = |mut w: &mut dyn std::io::Write| {
            rows = write_strains(&deck.model, &solution, &mut w)?;
            Ok(())
        };
        output.write("strains.csv", write).map_err(Faults::from)?;
        let title = format!("Strain of {given}");
        let page = strains_page(&title, &deck.model, &solution, &s.findings);
        s.write_page(&arguments.deck, page)
    })?;
    let subcases: Vec<u32> = solution.cases.iter().map(|c| c.subcase).collect();
    session.say(format!(
        "{rows} rows of strain in {} static subcases, from {}",
        subcases.len(),
        solution.source
    ));
    session.put("rows", rows)?;
    session.put("subcases", subcases.len())?;
    session.put("subcase_ids", subcases)
}

/// Name and bytes of every result file; the deck itself where it is an OP2 and no other file is given.
fn result_bytes(
    arguments: &DeckArguments,
    deck: &str,
    session: &mut Session,
) -> Result<Vec<(String, FileBytes)>, Faults> {
    let mut names: Vec<String> = arguments
        .results
        .iter()
        .map(|p| p.display().to_string())
        .collect();
    let from_deck = names.is_empty();
    if from_deck {
        names.push(deck.to_owned());
    }
    let (mut files, mut faults) = (Vec::new(), FaultList::new());
    for name in names {
        match session.inputs.read(Path::new(""), &name) {
            Ok(bytes) if from_deck && !looks_like_op2(&bytes) => {
                faults.push(Fault::of(
                    &name,
                    "results",
                    "no result file given",
                    "name the OP2, punch or H5 file after the deck",
                ));
            }
            Ok(bytes) => files.push((name, bytes)),
            Err(fault) => faults.push(fault),
        }
    }
    Faults::check(faults)?;
    Ok(files)
}
