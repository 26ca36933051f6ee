//! Decks and models: INCLUDE from the file system, the model of a deck or of an OP2 that contains the mesh.

use crate::fe::mass_moved;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, FaultList};
use crate::host::files::{Inputs, why_unreadable};
use crate::host::what_is::binary_kind;
pub use crate::host::what_is::looks_like_op2;
use crate::model::{
    FaultKind, FaultWeight, Material, MaterialKind, Model, ModelFault, Vec3, Weight,
};
use crate::series::record::format_of;
use crate::strain_chain::not_solved::{not_solved, not_solved_of_op2};
use nastran::bdf::{Deck, IncludeRequest, LoadedFile, Loader, read_deck};
use nastran::op2::Op2;
use std::path::{Component, Path, PathBuf};

/// A deck with its model.
pub struct DeckModel {
    /// Path as given.
    pub given: String,
    /// Deck. Empty for an OP2.
    pub deck: Deck,
    /// Model of the deck.
    pub model: Model,
    /// Files from which the deck was read: the deck, then its INCLUDEs.
    pub files: Vec<PathBuf>,
    /// All faults: in cards, then in the model.
    pub faults: FaultList,
    /// Faults among [`Self::faults`] that come from unsupported cards: `check` warns of the cards (`card-not-solved`).
    pub not_carried: FaultList,
    /// Findings on the deck.
    pub findings: Vec<Finding>,
}

/// Reads the deck `given` (relative to `base`) with its INCLUDEs, or the mesh of an OP2, and builds the model.
///
/// # Errors
/// A fault if the file cannot be read at all. Faults in its content are in [`DeckModel::faults`].
pub fn read_model(inputs: &mut Inputs, base: &Path, given: &str) -> Result<DeckModel, Fault> {
    let bytes = inputs.read(base, given)?;
    if let Some(fault) = no_deck(given, &bytes) {
        return Err(fault);
    }
    if looks_like_op2(&bytes) {
        let mut read = model_of_op2(given, &bytes)?;
        read.files = vec![base.join(given)];
        Ok(read)
    } else {
        Ok(model_of_deck(inputs, base, given, &bytes))
    }
}

/// Returns the fault of a file that is neither a deck nor an OP2.
pub(crate) fn no_deck(given: &str, bytes: &[u8]) -> Option<Fault> {
    let kind = binary_kind(bytes).filter(|_| !looks_like_op2(bytes))?;
    let remedy = match format_of(bytes) {
        Some(_) => {
            "name a Nastran deck; a record is named in a job, as `[measured] strain` or `[vehicle] data`"
        }
        None => "name a Nastran deck (text) or an OP2 that contains the mesh",
    };
    Some(Fault::new(
        given,
        "deck",
        format!("it is {kind}, not a Nastran deck"),
        remedy,
    ))
}

/// Reads the deck, and returns it with the files that it was read from.
fn deck_and_files(
    inputs: &mut Inputs,
    base: &Path,
    given: &str,
    bytes: &[u8],
) -> (Deck, Vec<PathBuf>) {
    let main = base.join(given);
    let path = main.display().to_string();
    let mut loader = FileLoader {
        inputs,
        files: vec![main],
    };
    let deck = read_deck(&path, bytes.to_vec(), &mut loader);
    (deck, loader.files)
}

/// Reads the deck in `bytes` and builds its model.
pub fn model_of_deck(inputs: &mut Inputs, base: &Path, given: &str, bytes: &[u8]) -> DeckModel {
    let (deck, files) = deck_and_files(inputs, base, given, bytes);
    let (model, model_faults) = Model::from_deck(&deck);
    let mut faults = deck_faults(&deck);
    let mut findings = notes_of(&deck, given);
    let file_of = |f: &ModelFault| deck.path(f.at).to_owned();
    let not_carried = sort_out(&model_faults, &file_of, &mut faults, &mut findings, given);
    faults.extend(mass_beyond(&model, given));
    findings.extend(not_solved(&deck, &model, given));
    DeckModel {
        given: given.to_owned(),
        deck,
        model,
        files,
        faults,
        not_carried,
        findings,
    }
}

/// Returns the fault of a model whose mass, centre of gravity or moments of inertia exceed the range of numbers.
fn mass_beyond(model: &Model, given: &str) -> Option<Fault> {
    let about_origin = model.rigid_body_mass(Vec3::zeros());
    let centre =
        Weight::from_mass_matrix(&about_origin, Vec3::zeros()).map_or_else(Vec3::zeros, |w| w.cg);
    let about_centre = mass_moved(&about_origin, -centre);
    let mut numbers = about_origin.iter().chain(about_centre.iter());
    // Inertia relief and its checks multiply two of these numbers.
    (!numbers.all(|v| (v * v).is_finite())).then(|| {
        Fault::new(
            given,
            "mass",
            "the mass of the model, its centre of gravity or moments of inertia exceed the range of numbers",
            "check for a density, thickness, area or CONM2 with a wrong exponent",
        )
    })
}

/// Returns the model in the geometry blocks of an OP2.
///
/// # Errors
/// A fault if the file is not an OP2 or contains no geometry.
pub fn model_of_op2(given: &str, bytes: &[u8]) -> Result<DeckModel, Fault> {
    let op2 = Op2::read(bytes)
        .map_err(|e| Fault::new(given, "OP2", e.to_string(), "write the file again"))?;
    let (cards, notes) = op2.cards();
    if cards.grids.is_empty() {
        return Err(Fault::new(
            given,
            "mesh",
            "the OP2 contains no geometry",
            "give the deck, or solve with PARAM,OGEOM,YES",
        ));
    }
    let (model, model_faults) = Model::from_cards(&cards);
    let mut faults = FaultList::new();
    let mut findings: Vec<Finding> = notes
        .iter()
        .map(|n| {
            Finding::new(
                Severity::Info,
                "geometry-note",
                format!("{given}: {}", n.subject),
                n.message.clone(),
                "",
            )
        })
        .collect();
    let not_carried = sort_out(
        &model_faults,
        &|_| given.to_owned(),
        &mut faults,
        &mut findings,
        given,
    );
    findings.extend(not_solved_of_op2(&model, given));
    Ok(DeckModel {
        given: given.to_owned(),
        deck: Deck::default(),
        model,
        files: Vec::new(),
        faults,
        not_carried,
        findings,
    })
}

/// Returns the notes of the reader, one finding for each deck: superelements that are kept but not read, a missing ENDDATA, an ambiguous INCLUDE.
fn notes_of(deck: &Deck, given: &str) -> Vec<Finding> {
    if deck.notes.is_empty() {
        return Vec::new();
    }
    let shown: Vec<String> = deck
        .notes
        .iter()
        .map(|n| format!("`{}` line {}: {}", deck.path(n.at), n.at.line, n.text))
        .collect();
    let message = list_few(&shown);
    let remedy = "check how these lines were read, and whether the deck is complete";
    let finding = Finding::new(Severity::Info, "deck-note", given, message, remedy);
    vec![finding.with_numbers(deck.notes.len() as f64, 0.0)]
}

/// Returns the faults of a deck's cards.
pub fn deck_faults(deck: &Deck) -> FaultList {
    deck.faults.iter().map(|f| fault_of(deck, f)).collect()
}

fn fault_of(deck: &Deck, f: &nastran::bdf::Fault) -> Fault {
    let field = match (f.card.as_str(), f.field) {
        ("", _) => "deck".to_owned(),
        (card, None) => card.to_owned(),
        (card, Some(field))
            if matches!(f.what, nastran::bdf::DeckFaultKind::NoSuchField { .. }) =>
        {
            format!("{card} field {}", field.number)
        }
        (card, Some(field)) => format!("{card} {}", field.name),
    };
    Fault::with_line(
        deck.path(f.at),
        f.at.line,
        field,
        f.what.message(),
        f.what.remedy(),
    )
}

impl DeckModel {
    /// Returns the faults of parts of the deck that were not read: it is cut, or an INCLUDE is missing. Without ENDDATA the deck may be cut, and its
    /// other faults may come from that, so they are returned too.
    pub fn unread_part_faults(&self) -> FaultList {
        let cut = self.deck.faults.iter().filter(|f| f.what.is_incomplete());
        let mut faults: FaultList = cut.map(|f| fault_of(&self.deck, f)).collect();
        if faults.is_empty() && self.ends_open() && !self.faults.is_empty() {
            faults.push(self.open_end("it has faults"));
            faults.extend(self.faults.iter().cloned());
        }
        faults
    }

    /// Returns a fault if results contain elements that this deck lacks, and no ENDDATA shows that the deck is complete.
    pub fn find_truncation(&self, findings: &[Finding]) -> Option<Fault> {
        let lacking = findings.iter().find(|f| f.code == "element-not-in-deck")?;
        self.ends_open().then(|| self.open_end(lacking.clause()))
    }

    fn open_end(&self, and: &str) -> Fault {
        Fault::new(
            &*self.given,
            "ENDDATA",
            format!("the deck ends without ENDDATA, and {and}: it may be cut"),
            "copy the deck again, or close it with ENDDATA",
        )
    }

    fn ends_open(&self) -> bool {
        !self.deck.sources.is_empty() && !self.deck.counts.contains_key("ENDDATA")
    }
}

/// Converts errors to faults, and notes to findings, one for each kind. Returns the faults that come from unsupported cards.
fn sort_out(
    model_faults: &[ModelFault],
    file_of: &dyn Fn(&ModelFault) -> String,
    faults: &mut FaultList,
    findings: &mut Vec<Finding>,
    given: &str,
) -> FaultList {
    let mut not_carried = FaultList::new();
    for f in model_faults
        .iter()
        .filter(|f| f.weight() != FaultWeight::Note)
    {
        let fault = Fault::with_line(
            file_of(f),
            f.at.line,
            format!("{} {}", f.card, f.field),
            f.kind.to_string(),
            f.remedy(),
        );
        if f.weight() == FaultWeight::NotCarried {
            not_carried.push(fault.clone());
        }
        faults.push(fault);
    }
    let notes = |pick: fn(&FaultKind) -> bool| -> Vec<&ModelFault> {
        model_faults
            .iter()
            .filter(|f| f.weight() == FaultWeight::Note && pick(&f.kind))
            .collect()
    };
    for (code, list) in [
        (
            "grid-unattached",
            notes(|k| matches!(k, FaultKind::Unattached)),
        ),
        (
            "element-id-shared",
            notes(|k| matches!(k, FaultKind::SharedId { .. })),
        ),
        (
            "card-repeated",
            notes(|k| matches!(k, FaultKind::Repeated { .. })),
        ),
        (
            "set-missing",
            notes(|k| matches!(k, FaultKind::Missing { what: "set", .. })),
        ),
    ] {
        let Some(first) = list.first() else { continue };
        let more = if list.len() > 1 {
            format!(" (and {} more)", list.len() - 1)
        } else {
            String::new()
        };
        let message = format!("`{}` line {}: {first}{more}", file_of(first), first.at.line);
        let mut finding = Finding::new(Severity::Info, code, given, message, first.remedy());
        finding.measured = Some(list.len() as f64);
        findings.push(finding);
    }
    not_carried
}

/// Returns Young's modulus by material id, and density times WTMASS, for the plausibility of units.
pub fn moduli_and_densities(model: &Model) -> (Vec<(u32, f64)>, Vec<(u32, f64)>) {
    let modulus = |m: &Material| match m.kind {
        MaterialKind::Isotropic { e, .. } => Some((m.id, e)),
        MaterialKind::Orthotropic { e1, .. } => Some((m.id, e1)),
        _ => None,
    };
    let moduli = model.materials.iter().filter_map(modulus).collect();
    (
        moduli,
        model
            .materials
            .iter()
            .map(|m| (m.id, m.rho * model.params.wtmass))
            .collect(),
    )
}

/// Opens included files; symbols are environment variables.
struct FileLoader<'a, 'f> {
    inputs: &'a mut Inputs<'f>,
    files: Vec<PathBuf>,
}

impl Loader for FileLoader<'_, '_> {
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String> {
        let paths = request.candidates(|s| std::env::var(s).ok()).map_err(|s| {
            format!("the symbol `{s}` has no value: define it as an environment variable")
        })?;
        let mut why = "no such file".to_owned();
        let mut paths: Vec<PathBuf> = paths.iter().map(|p| without_dots(Path::new(p))).collect();
        paths.dedup();
        for (k, path) in paths.iter().enumerate() {
            let name = path.display().to_string();
            match self.inputs.load(path) {
                Ok(bytes) if let Some(kind) = binary_kind(&bytes) => {
                    return Err(format!("it is {kind}"));
                }
                Ok(bytes) => {
                    self.files.push(path.clone());
                    self.inputs.record(&name, path.clone(), &bytes);
                    let others = paths.iter().skip(k + 1).filter(|p| *p != path);
                    let differs = |p: &&PathBuf| self.inputs.load(p).is_ok_and(|b| *b != *bytes);
                    return Ok(LoadedFile {
                        differing_path: others
                            .into_iter()
                            .find(differs)
                            .map(|p| p.display().to_string()),
                        path: name,
                        bytes: bytes.to_vec(),
                    });
                }
                Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
                Err(e) => why = why_unreadable(&e).0,
            }
        }
        Err(why)
    }
}

/// Returns the path without `.` and `folder/..`, so that one file has one name.
pub(crate) fn without_dots(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir
                if matches!(out.components().next_back(), Some(Component::Normal(_))) =>
            {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}
