//! `init`: a commented job from the analyst's own files.

use super::cases::from_folder;
use super::context::Context;
use super::deck::{DeckModel, moduli_and_densities, read_model};
use super::fault::{Fault, Faults};
use super::outcome::{Answer, Outcome, StatedUnits};
use super::work::Work;
use crate::fe::from_results::{Displacements, ReadOptions, solution_from_file};
use crate::finding::{Finding, Severity};
use crate::model::{Load, Model, RigidKind};
use crate::units::UnitSystem;
use nastran::results::ResultsFile;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A load that the job proposes.
struct Proposed {
    name: String,
    what: String,
    applied: f64,
    subcase: Option<u32>,
    result: Option<String>,
    expected: f64,
}

/// Loads proposed at most where nothing but grids is known.
const MOST_GRIDS: usize = 24;

/// A commented job made from an analyst's files.
#[derive(Serialize)]
pub struct Proposal {
    /// Name of the job's file.
    pub job: &'static str,
    /// Names of the loads proposed.
    pub loads: Vec<String>,
    /// The job itself.
    #[serde(skip)]
    pub text: String,
}

impl Answer for Proposal {
    const COMMAND: &'static str = "init";
}

/// The file of a proposed job.
pub const JOB: &str = "job.toml";

/// A commented job from a deck and its results, to stand in `folder`.
///
/// # Errors
/// Files that can't be read; a job that is there already.
pub fn init(
    deck_path: &Path,
    results: &[PathBuf],
    folder: &Path,
    cx: &Context,
) -> Result<Outcome<Proposal>, Faults> {
    let mut work = Work::new(cx);
    let target = folder.join(JOB);
    if cx.files.load(&target).is_ok() {
        return Err(Faults::from(Fault::of(
            target.display().to_string(),
            JOB,
            "there is one already, and it is not overwritten",
            "move it away, or name another folder with `--out`",
        )));
    }
    let given = deck_path.display().to_string();
    let deck = work.stage("read deck", |s| {
        read_model(&mut s.inputs, Path::new(""), &given)
    })?;
    work.findings.extend(deck.findings.iter().cloned());
    if !deck.faults.is_empty() {
        let n = deck.faults.len();
        let first = deck
            .faults
            .first()
            .map(ToString::to_string)
            .unwrap_or_default();
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "deck-has-faults",
                &given,
                format!("{n} faults in the deck, the first: {first}"),
                "run `check` on it",
            )
            .with_numbers(n as f64, 0.0),
        );
    }
    let mut strained: Vec<(String, BTreeSet<u32>)> = Vec::new();
    for path in results {
        let name = path.display().to_string();
        let bytes = work
            .inputs
            .read(Path::new(""), &name)
            .map_err(Faults::from)?;
        let options = ReadOptions {
            displacements: Displacements::Leave,
            ..ReadOptions::default()
        };
        let solution = work
            .stage("read results", |_| {
                ResultsFile::read(&bytes, &name)
                    .map(|f| solution_from_file(&deck.model, &name, &f, &options))
            })
            .map_err(|e| {
                Faults::from(Fault::of(
                    &*name,
                    "results",
                    e.to_string(),
                    "give an OP2, punch or HDF5 file of a static run",
                ))
            })?;
        work.findings.extend(solution.findings.iter().cloned());
        let cases = solution
            .cases
            .iter()
            .filter(|c| !c.shells.elements.is_empty())
            .map(|c| c.subcase)
            .collect();
        strained.push((name, cases));
    }
    let system = units_of(&deck.model);
    let loads = propose(&deck, &strained, system);
    if loads.is_empty() {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-loads-found",
            &given,
            "neither subcases with loads nor points where loads could act were found: the job holds an example to be filled in",
            "write one [[load]] for each load",
        ));
    }
    let text = job_text(&deck, (deck_path, results), folder, system, &loads);
    let answer = Proposal {
        job: JOB,
        loads: loads.into_iter().map(|l| l.name).collect(),
        text,
    };
    Ok(work.finish(StatedUnits::default(), answer))
}

/// The unit system that Young's moduli and densities speak for; metres where nothing speaks.
fn units_of(model: &Model) -> UnitSystem {
    if let Some(s) = model
        .params
        .unitsys
        .as_deref()
        .and_then(UnitSystem::from_unitsys)
    {
        return s;
    }
    let (moduli, densities) = moduli_and_densities(model);
    let typical = |mut v: Vec<f64>| {
        v.retain(|x| *x > 0.0);
        v.sort_by(f64::total_cmp);
        v.get(v.len() / 2).copied()
    };
    let e = typical(moduli.into_iter().map(|m| m.1).collect());
    let rho = typical(densities.into_iter().map(|m| m.1).collect());
    // Steel, aluminium, titanium, plastics: nearest on a logarithmic scale to 100 GPa and 5000 kg/m^3.
    UnitSystem::ALL
        .into_iter()
        .min_by(|a, b| {
            let far = |s: &UnitSystem| {
                let stress = s.si(crate::units::Quantity::Stress);
                let density = s.mass_kg() / s.length_m().powi(3);
                let d = |x: Option<f64>, unit: f64, usual: f64| {
                    x.map_or(0.0, |x| (x * unit / usual).ln().abs())
                };
                d(e, stress, 100e9) + d(rho, density, 5000.0)
            };
            far(a).total_cmp(&far(b))
        })
        .unwrap_or(UnitSystem::MKgS)
}

/// Loads of the results' subcases; else of the deck's; else at points that rigid elements spread or constraints hold.
fn propose(
    deck: &DeckModel,
    strained: &[(String, BTreeSet<u32>)],
    system: UnitSystem,
) -> Vec<Proposed> {
    let subcases = deck.deck.case_control.effective_subcases();
    let mut loads = Vec::new();
    let mut used: BTreeMap<String, usize> = BTreeMap::new();
    let mut sets = BTreeSet::new();
    for sc in subcases.iter().filter(|s| s.load.is_some()) {
        let source = strained.iter().find(|(_, c)| c.contains(&sc.id));
        if source.is_none() && !strained.is_empty() {
            continue;
        }
        let Some(sid) = sc.load else { continue };
        if !sets.insert(sid) {
            continue;
        }
        let (what, name, applied) = single(&deck.model, sid)
            .unwrap_or_else(|| (format!("load_set = {sid}"), format!("set{sid}"), 1.0));
        let name = sc
            .label
            .clone()
            .or_else(|| sc.subtitle.clone())
            .filter(|l| !l.trim().is_empty())
            .map_or(name, |l| clean(&l));
        loads.push(Proposed {
            name: unique(&mut used, name),
            what,
            applied,
            subcase: source.map(|_| sc.id),
            result: source.filter(|_| strained.len() > 1).map(|s| s.0.clone()),
            expected: if applied == 1.0 {
                1.0
            } else {
                10.0 * applied.abs()
            },
        });
    }
    // A bare mesh, or results whose loads are not in the deck: subcases by their numbers.
    if loads.is_empty() {
        for (file, cases) in strained {
            for id in cases {
                let label = subcases
                    .iter()
                    .find(|s| s.id == *id)
                    .and_then(|s| s.label.clone());
                let sid = deck.model.load_sets.first().map_or(1, |s| s.sid);
                loads.push(Proposed {
                    name: unique(&mut used, label.map_or(format!("subcase{id}"), |l| clean(&l))),
                    what: format!("load_set = {sid}                       # replace: what acts in this subcase"),
                    applied: 1.0,
                    subcase: Some(*id),
                    result: (strained.len() > 1).then(|| file.clone()),
                    expected: 1.0,
                });
            }
        }
    }
    if loads.is_empty() {
        // A load of 10 kN on each point: the size of a wheel of a light truck.
        let force = 1e4 / system.si(crate::units::Quantity::Force);
        for (grid, why) in points(deck).into_iter().take(MOST_GRIDS) {
            let name = format!("{why}{grid}");
            loads.push(Proposed {
                name: unique(&mut used, format!("{name}.FZ")),
                what: format!("grid = {grid}\ncomponent = \"FZ\""),
                applied: 1.0,
                subcase: None,
                result: None,
                expected: force,
            });
        }
    }
    loads
}

/// A load set that is one force or moment along an axis: what, a name, its size.
fn single(model: &Model, sid: u32) -> Option<(String, String, f64)> {
    let set = model.load_sets.iter().find(|s| s.sid == sid)?;
    let [(factor, load)] = set.loads.as_slice() else {
        return None;
    };
    let (grid, v, letter) = match load {
        Load::Force(g, v) => (g, v, 'F'),
        Load::Moment(g, v) => (g, v, 'M'),
        _ => return None,
    };
    let size = v.norm();
    let axis = (0..3).find(|&i| (v[i].abs() - size).abs() < 1e-6 * size)?;
    let component = format!("{letter}{}", ['X', 'Y', 'Z'][axis]);
    let id = model.grids.get(grid.us())?.id;
    Some((
        format!("grid = {id}\ncomponent = \"{component}\""),
        format!("{id}.{component}"),
        factor * v[axis],
    ))
}

/// Grids where loads are likely to enter: reference grids of RBE3, independent grids of rigid bodies, constrained grids.
fn points(deck: &DeckModel) -> Vec<(u32, &'static str)> {
    let m = &deck.model;
    let id = |g: crate::model::GridIx| m.grids.get(g.us()).map(|g| g.id);
    let mut out: Vec<(u32, &'static str)> = Vec::new();
    let mut add = |g: Option<u32>, why| {
        if let Some(g) = g
            && !out.iter().any(|o| o.0 == g)
        {
            out.push((g, why));
        }
    };
    for r in &m.rigids {
        if let RigidKind::Mean { reference, .. } = &r.kind {
            add(id(*reference), "rbe3_");
        }
    }
    for s in &m.spcs {
        s.terms.iter().for_each(|t| add(id(t.0), "support_"));
    }
    for r in &m.rigids {
        if let RigidKind::Body { independent, .. } = &r.kind {
            independent
                .iter()
                .take(1)
                .for_each(|t| add(id(t.0), "rigid_"));
        }
    }
    out
}

fn clean(name: &str) -> String {
    name.trim()
        .chars()
        .map(|c| {
            if c == '"' || c == '\\' || c == ',' || c.is_control() {
                '_'
            } else {
                c
            }
        })
        .collect()
}

fn unique(used: &mut BTreeMap<String, usize>, name: String) -> String {
    let n = used.entry(name.clone()).or_insert(0);
    *n += 1;
    if *n == 1 { name } else { format!("{name}_{n}") }
}

fn job_text(
    deck: &DeckModel,
    (deck_path, results): (&Path, &[PathBuf]),
    folder: &Path,
    system: UnitSystem,
    loads: &[Proposed],
) -> String {
    let path = |p: &Path| from_folder(folder, p);
    let units = system.name();
    let (force, moment) = match system {
        UnitSystem::InLbfS => ("lbf", "lbf in"),
        _ => ("kN", "kN m"),
    };
    let results: Vec<String> = results.iter().map(|p| format!("\"{}\"", path(p))).collect();
    let title = deck_path
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned())
        .unwrap_or_default();
    let mut t = format!(
        "# Written by `strainbridge init`. Read every line that says `check`: they are proposals from the deck.\n\
         title = \"{}\"\n\
         units = \"{units}\"                  # check: guessed from Young's moduli and densities; \"m-kg-s\", \"mm-t-s\", \"mm-kg-s\" or \"in-lbf-s\"\n\
         report_units = {{ force = \"{force}\", moment = \"{moment}\" }}\n\n\
         [model]\ndeck = \"{}\"\n",
        clean(&title),
        path(deck_path)
    );
    if results.is_empty() {
        t.push_str("# results = [\"unit_loads.op2\"]        # of the deck that `strainbridge cases job.toml` writes; left out: the built-in solver computes them\n");
    } else {
        t.push_str(&format!("results = [{}]\n", results.join(", ")));
    }
    t.push_str(&match deck.model.selected_spcs.as_slice() {
        [] => "# support = \"free\"                   # the deck selects no SPC set: inertia balances every load\n".to_owned(),
        [set] => format!("support = \"deck\"                     # check: SPC set {set} of the deck holds the structure while gauges are read; \"free\": inertia relief\n"),
        [set, ..] => format!("support = {set}                          # check: the deck's subcases select several SPC sets; \"free\": inertia relief\n"),
    });
    t.push_str("\n# One [[load]] for each load that acts while the gauges are read, those you don't ask for included (role = \"nuisance\").\n");
    for l in loads {
        t.push_str(&format!("\n[[load]]\nname = \"{}\"\n{}\n", l.name, l.what));
        t.push_str(&format!(
            "applied = {:?}                      # check: size in its subcase, signed\n",
            l.applied
        ));
        if let Some(r) = &l.result {
            t.push_str(&format!("result = \"{}\"\n", path(Path::new(r))));
        }
        if let Some(s) = l.subcase {
            t.push_str(&format!("subcase = {s}\n"));
        }
        t.push_str(&format!(
            "expected = {:?}                     # check: how large it gets, 1 sd\n",
            l.expected
        ));
    }
    if loads.is_empty() {
        t.push_str("\n[[load]]\nname = \"LF.FZ\"\ngrid = 1                              # fill in: the grid where it acts\ncomponent = \"FZ\"\nexpected = 10000.0\n");
    }
    let mut properties: BTreeMap<u32, usize> = BTreeMap::new();
    for s in &deck.model.shells {
        if let Some(p) = deck.model.shell_properties.get(s.property.us()) {
            *properties.entry(p.id).or_default() += 1;
        }
    }
    t.push_str("\n[candidates]                           # where `place` may put gauges\n");
    for (id, n) in &properties {
        let name = deck
            .model
            .property_names
            .iter()
            .find(|p| p.0 == *id)
            .map_or(String::new(), |p| format!(" ({})", p.1));
        t.push_str(&format!("# property {id}{name}: {n} shells\n"));
    }
    let ids: Vec<String> = properties.keys().map(u32::to_string).collect();
    if !ids.is_empty() && ids.len() <= 60 {
        t.push_str(&format!("properties = [{}]\n", ids.join(", ")));
    }
    let mm = 0.001 / system.length_m();
    let [spacing, clear, far, shift] = [50.0, 20.0, 100.0, 2.0].map(|v| v * mm);
    let (n, more) = (loads.len().max(1), 2 * loads.len().max(1));
    t.push_str(&format!(
        "surfaces = [\"top\", \"bottom\"]         # drop the side that can't be reached\n\
         angle_step_deg = 15                  # or \"continuous\"\n\
         # clear_of = {{ edges = {clear}, holes = {clear}, joints = {clear}, loads = {far}, attachments = {far} }}  # strain there is not to be trusted\n\n\
         [placement]\n\
         gauges = {}                           # twice the number of loads: some may fail\n\
         spacing = {spacing}                       # least distance between gauges: 50 mm\n\
         noise_microstrain = 1.0\n\
         angle_tolerance_deg = 2.0\n\
         # position_tolerance = {shift}         # 2 mm, 1 sd\n\
         # curve = [{n}, {more}]                     # what each of these numbers of gauges gives\n\
         # reserve = 2                        # gauges kept for validation\n\
         # loss = \"optimise\"                  # for what is left after the loss of any one gauge\n\n\
         # Once gauges are glued and read:\n\
         # [gauges]\n\
         # file = \"job.out/gauges.csv\"\n\
         # [measured]\n\
         # strain = \"strain.csv\"                # a column a gauge, microstrain; a row a run (`run`) or a sample (`time`)\n\
         # zero = \"zero.csv\"\n\
         # noise_microstrain = 1.0\n\
         # model_uncertainty_rel = 0.02\n",
        2 * loads.len().max(1)
    ));
    t
}
