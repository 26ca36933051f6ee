//! `cases`: the analyst's deck with one unit-load subcase a load, ready for Nastran.

mod includes;

pub(crate) use includes::from_folder;
pub(crate) use includes::relocate_deck;

use crate::fe::{Relief, Support, determinate_dofs};
use crate::finding::{Finding, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::{Component, Job, JobLoad, LoadActs};
use crate::model::{Grid, Model};
use crate::strain_chain::built_in_solver::support_of_job;
use crate::strain_chain::job_deck::read_deck;
use crate::strain_chain::named_results::{MissingResults, check_named};
use crate::strain_chain::repeated_subcases::refuse_repeated_subcases;
use nastran::bdf::{Deck, Edits, Field, format_card, write_edited};
use nastran::cards::Force;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

/// Case control statements that would load, support or restrict the unit-load run, or request other strain.
const UNWANTED: [&str; 22] = [
    "LOAD",
    "LOADSET",
    "DLOAD",
    "SPC",
    "SUPORT1",
    "TEMPERATURE",
    "TEMP",
    "DEFORM",
    "CLOAD",
    "STRAIN",
    "ANALYSIS",
    "METHOD",
    "CMETHOD",
    "FREQUENCY",
    "TSTEP",
    "TSTEPNL",
    "NLPARM",
    "SDAMPING",
    "STATSUB",
    "IC",
    "BCONTACT",
    "NLSTEP",
];

/// A deck with one unit-load subcase for each load.
#[derive(Serialize)]
pub struct UnitLoadDeck {
    /// Description of the support of the structure.
    pub support: String,
    /// Subcase and applied load of each load.
    pub subcases: Vec<Value>,
    /// Deck with the edits.
    #[serde(skip)]
    pub edited: EditedDeck,
    /// Title of the job.
    #[serde(skip)]
    pub title: String,
    /// Model of the deck.
    #[serde(skip)]
    pub model: Model,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for UnitLoadDeck {
    const COMMAND: &'static str = "cases";
    const RESULT: &'static str = "The deck of unit loads";

    fn verdict(&self) -> String {
        format!(
            "{} written for Nastran; the structure is {}.",
            count_of(self.subcases.len(), "unit-load subcase"),
            self.support
        )
    }
}

/// The original deck, and the files of the edited deck.
pub struct EditedDeck {
    deck: Deck,
    edits: Edits,
}

impl EditedDeck {
    /// Returns name and bytes of every file of the edited deck. Paths of INCLUDEs are relative to `folder`. The first file is `unit_loads.bdf`.
    pub fn files(&self, folder: &Path) -> Vec<(String, Vec<u8>)> {
        edited_files(&self.deck, &self.edits, folder, "unit_loads")
    }
}

/// Returns name and bytes of every file of a deck after these edits. Paths of INCLUDEs are relative to `folder`. The first file is `<stem>.bdf`.
pub fn edited_files(
    deck: &Deck,
    edits: &Edits,
    folder: &Path,
    stem: &str,
) -> Vec<(String, Vec<u8>)> {
    includes::relocate_deck(deck, write_edited(deck, edits), folder, stem)
}

/// Makes the deck of a job with one unit-load subcase for each load, ready for Nastran. All other lines of the deck stay unchanged.
///
/// # Errors
/// Returns every fault of the job and its deck, or entries that can't be edited.
///
/// # Example
/// ```
/// use std::path::Path;
/// use strainbridge::{Context, Disk, Job, cases};
///
/// let job = Job::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/place.toml"), &Disk)?;
/// let made = cases(&job, &Context::new(&Disk))?;
/// assert_eq!(made.subcases.len(), job.loads.len());
///
/// let (name, deck) = &made.edited.files(Path::new("out"))[0];
/// let deck = String::from_utf8_lossy(deck);
/// assert_eq!(name, "unit_loads.bdf");
/// assert_eq!(deck.lines().filter(|l| l.trim_start().starts_with("SUBCASE")).count(), 6);
/// let given = std::fs::read_to_string(job.folder.join("frame.bdf"))?;
/// assert!(given.lines().filter(|l| l.starts_with("CQUAD4")).all(|l| deck.contains(l)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cases(job: &Job, cx: &Context) -> Result<Outcome<UnitLoadDeck>, Faults> {
    let mut work = Work::of_job(cx, job);
    let fault = |field: &str, wrong: &str, remedy: &str| {
        Faults::from(Fault::new(&*job.file, field, wrong, remedy))
    };
    let Some(files) = &job.model else {
        return Err(fault(
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        ));
    };
    if job.loads.is_empty() {
        return Err(fault(
            "load",
            "the job has no [[load]]",
            "name the loads, one [[load]] each",
        ));
    }
    // Results of the deck that is written here do not exist yet.
    check_named(&work, job, MissingResults::ToCome)?;
    let read = work.stage("read deck", |s| read_deck(s, job, files))?;
    refuse_repeated_subcases(&read)?;
    if read.deck.sources.is_empty() {
        return Err(fault(
            "model.deck",
            "an OP2 is not a deck, and cannot be run again",
            "name the deck",
        ));
    }
    let mut faults = crate::strain_chain::unit_loads(job, &read.model)
        .err()
        .map_or_else(Vec::new, Faults::into_list);
    for l in &job.loads {
        if let LoadActs::Set(sid) = l.acts
            && !load_ids(&read.deck).contains(&sid)
        {
            let wrong = format!("load `{}`: the deck has no load set {sid}", l.name);
            faults.push(Fault::with_line(
                &*job.file,
                l.line,
                "load.load_set",
                wrong,
                "correct the id",
            ));
        }
    }
    Faults::check(faults)?;
    let support = support_of_job(job, &read.model)?;
    let (edits, subcases) = edits_of(&mut work, job, (&read.deck, &read.model, support))?;
    let answer = UnitLoadDeck {
        subcases,
        support: support.words(),
        edited: EditedDeck {
            deck: read.deck,
            edits,
        },
        title: job.title.clone(),
        model: read.model,
        job: job.clone(),
    };
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Returns the ids of all load sets.
pub fn load_ids(deck: &Deck) -> Vec<u32> {
    let c = &deck.cards;
    let mut ids: Vec<u32> = c
        .forces
        .iter()
        .chain(&c.moments)
        .map(|f| f.card.sid)
        .collect();
    ids.extend(c.loads.iter().map(|l| l.card.sid));
    ids.extend(c.forces_along.iter().map(|l| l.card.sid));
    ids.extend(c.sloads.iter().map(|l| l.card.sid));
    ids.extend(c.ploads.iter().map(|l| l.card.sid));
    ids.extend(c.pload1s.iter().map(|l| l.card.sid));
    ids.extend(c.pload2s.iter().map(|l| l.card.sid));
    ids.extend(c.pload4s.iter().map(|l| l.card.sid));
    ids.extend(c.gravs.iter().map(|l| l.card.sid));
    ids.extend(c.rforces.iter().map(|l| l.card.sid));
    ids.extend(c.accels.iter().map(|l| l.card.sid));
    ids.extend(c.accel1s.iter().map(|l| l.card.sid));
    ids.extend(c.temps.iter().map(|l| l.card.sid));
    ids.extend(c.tempds.iter().map(|l| l.card.sid));
    ids.extend(c.tempp1s.iter().map(|l| l.card.sid));
    ids.extend(c.temprbs.iter().map(|l| l.card.sid));
    ids.extend(c.spcds.iter().map(|l| l.card.sid));
    ids
}

/// Cards of dynamic load sets and of tables. `recover` writes such cards for a history, so their ids must not be used twice.
const DYNAMIC: [&str; 14] = [
    "ACSRCE", "DAREA", "DLOAD", "LSEQ", "RLOAD1", "RLOAD2", "TABLED1", "TABLED2", "TABLED3",
    "TABLED4", "TABLED5", "TLOAD1", "TLOAD2", "RANDPS",
];

/// Returns the ids of dynamic loads and tables of a deck.
pub fn dynamic_ids(deck: &Deck) -> Vec<u32> {
    let cards = deck.others.iter();
    let of_kind = cards.filter(|c| DYNAMIC.contains(&c.name.as_str()));
    of_kind.filter_map(|c| c.first).collect()
}

/// Returns the card of a load at a grid. At a scalar point, which has one dof and no frame, it is an SLOAD.
pub fn load_card(model: Option<&Model>, load: &Force, component: Component) -> String {
    let point = model.and_then(|m| m.grids.get(m.grid_ix(load.grid)?.us()));
    if point.is_some_and(Grid::is_scalar) {
        let size = load.scale * load.n[0];
        let fields = [load.sid.into(), load.grid.into(), Field::Real(size)];
        return format_card("SLOAD", &fields);
    }
    if component.is_force() {
        load.to_force_card()
    } else {
        load.to_moment_card()
    }
}

/// Returns the edits that turn the deck into a deck of unit loads, and the subcases that they write.
fn edits_of(
    work: &mut Work,
    job: &Job,
    (deck, model, support): (&Deck, &Model, Support),
) -> Result<(Edits, Vec<Value>), Faults> {
    let mut edits = Edits::default();
    drop_unwanted(&mut edits, deck);
    if drop_relief(&mut edits, job, deck)? > 0 {
        work.findings.push(Finding::new(
            Severity::Info,
            "suport-dropped",
            "SUPORT",
            "the written deck has no SUPORT entries: neither its inertia relief nor a supported structure needs them",
            "",
        ));
    }
    let mut case = String::from(
        "$ Unit loads, one subcase each, in the order of the job\nSTRAIN(FIBER,CENTER) = ALL\n",
    );
    select_structure(&mut case, work, (deck, model, support));
    let mut bulk = String::from("$ Unit loads\nPARAM,POST,-1\n");
    bulk.push_str(&relief_cards(model, support));
    let mut rows = Vec::new();
    let first = load_ids(deck).into_iter().max().unwrap_or(0).max(1000) + 1;
    for (sid, l) in (first..).zip(&job.loads) {
        bulk.push_str(&cards_of(model, l, sid));
        case.push_str(&format!(
            "SUBCASE {}\n  LABEL = {}\n  LOAD = {sid}\n",
            l.number,
            label(&l.name)
        ));
        rows.push(
            json!({ "subcase": l.number, "load": l.name, "load_set": sid, "applied": l.applied }),
        );
    }
    edits.insert_case_end(deck, &case);
    edits.insert_cards(deck, &bulk);
    Ok((edits, rows))
}

/// Returns the cards of inertia relief. PARAM,INREL,-2 treats all six rigid motions as free. If springs to ground resist some rigid motions, SUPORT
/// names dofs that hold the other motions.
fn relief_cards(model: &Model, support: Support) -> String {
    match (support.relief, support.by_springs) {
        (Relief::None, _) => String::new(),
        (_, 0) => "PARAM,INREL,-2\n".to_owned(),
        _ => {
            let mut cards = String::from("PARAM,INREL,-1\n");
            for (grid, dof) in determinate_dofs(model) {
                let id = model.grids.get(grid.us()).map_or(0, |g| g.id);
                cards.push_str(&format_card("SUPORT", &[id.into(), u32::from(dof).into()]));
            }
            cards
        }
    }
}

/// Removes the subcases and the other requests of case control from the deck, and makes its solution static.
fn drop_unwanted(edits: &mut Edits, deck: &Deck) {
    edits.remove_subcases(deck);
    edits.remove_case_lines(deck, |l| {
        let stated = l.text.to_ascii_uppercase();
        let param =
            l.name.starts_with("PARAM") && ["POST", "INREL"].iter().any(|p| stated.contains(p));
        let word = l.name.split('(').next().unwrap_or_default();
        l.subcase.is_none() && !l.in_packet && (param || UNWANTED.contains(&word))
    });
    if deck.sol.is_some_and(|s| s != 101) || (deck.sol.is_none() && deck.sol_text.is_some()) {
        edits.replace_sol(deck, "101\n");
    }
}

/// Takes out the deck's own inertia relief; how many SUPORT entries that were.
fn drop_relief(edits: &mut Edits, job: &Job, deck: &Deck) -> Result<usize, Faults> {
    let refused = |e: nastran::bdf::EditError| {
        Faults::from(Fault::new(
            &*job.file,
            "model.deck",
            e.to_string(),
            "write PARAM and SUPORT entries once, without replication",
        ))
    };
    for p in deck
        .cards
        .params
        .iter()
        .filter(|p| ["POST", "INREL"].contains(&p.card.name.as_str()))
    {
        edits.remove_card(deck, p.at).map_err(refused)?;
    }
    for s in &deck.cards.suports {
        edits.remove_card(deck, s.at).map_err(refused)?;
    }
    Ok(deck.cards.suports.len())
}

/// Selects MPC, SPC and NSM sets and the temperatures of materials above all subcases. The subcases of the deck are left out, but their selections
/// for the structure itself remain.
fn select_structure(
    case: &mut String,
    work: &mut Work,
    (deck, model, support): (&Deck, &Model, Support),
) {
    let first = deck.case_control.subcases.first();
    if let (None, Some(nsm)) = (deck.case_control.global.nsm, first.and_then(|s| s.nsm)) {
        case.push_str(&format!("NSM = {nsm}\n"));
    }
    if let Some(set) = model.material_temperature {
        case.push_str(&format!("TEMPERATURE(MATERIAL) = {set}\n"));
    }
    let kept: std::collections::BTreeSet<u32> = deck
        .case_control
        .subcases
        .iter()
        .filter_map(|c| c.mpc)
        .collect();
    if deck.case_control.global.mpc.is_none()
        && let Some(mpc) = deck.case_control.mpc_of_structure()
    {
        case.push_str(&format!("MPC = {mpc}\n"));
    }
    if kept.len() > 1 {
        work.findings.push(Finding::new(
            Severity::Warning,
            "several-mpc-sets",
            "MPC",
            format!(
                "the deck's subcases select several MPC sets: the unit loads use {}",
                kept.first().copied().unwrap_or_default()
            ),
            "correct MPC in unit_loads.bdf if another set applies while gauges are read",
        ));
    }
    if let Some(spc) = support.spc {
        case.push_str(&format!("SPC = {spc}\n"));
    }
}

/// Cards of a load as load set `sid`.
fn cards_of(model: &Model, l: &JobLoad, sid: u32) -> String {
    match l.acts {
        LoadActs::AtGrid {
            grid,
            component,
            cid,
        } => {
            let card = Force {
                sid,
                grid,
                cid,
                scale: l.applied.abs(),
                n: component.vector(l.applied.signum()),
            };
            load_card(Some(model), &card, component)
        }
        // A job without a model has no cases.
        LoadActs::Named => String::new(),
        LoadActs::Set(set) => {
            let fields = [
                Field::from(sid),
                Field::Real(1.0),
                Field::Real(l.applied),
                Field::from(set),
            ];
            format_card("LOAD", &fields)
        }
    }
}

/// Returns a load's name as a case control label: one line of at most 60 characters.
fn label(name: &str) -> String {
    name.chars()
        .filter(|c| !c.is_control() && *c != '$')
        .take(60)
        .collect()
}
