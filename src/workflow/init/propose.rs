//! Loads for a job: of the results' subcases, else of the deck's, else at points where loads are likely to enter.

use super::plain_name::plain_name;
use super::points::{LoadPoint, Rank, load_points};
use super::round::round;
use crate::job::Component;
use crate::model::{Load, LoadSet, Model};
use crate::strain_chain::deck::DeckModel;
use crate::units::{Quantity, UnitSystem, is_unit_load, typical_load};
use std::collections::BTreeMap;

/// Largest number of proposed loads if only grids are known.
const MOST_GRIDS: usize = 24;

/// A load that the job proposes.
#[derive(Clone)]
pub(super) struct ProposedLoad {
    pub name: String,
    /// Lines of the job that state where the load acts.
    pub what: String,
    pub applied: f64,
    pub subcase: Option<u32>,
    pub result: Option<String>,
    pub expected: f64,
    /// Note on the unit and source of `expected`, for the comment of its line.
    pub expected_is: String,
}

/// A load or subcase that a job does not propose.
#[derive(Clone)]
pub(super) struct LeftOutLoad {
    pub name: String,
    /// Load to write as a comment; `None` for a subcase without a load.
    pub load: Option<ProposedLoad>,
    pub why: String,
}

/// Source of the strain of a proposal's loads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StrainFrom {
    Results,
    Solver,
}

/// Loads that belong together.
#[derive(Clone)]
pub(super) struct Proposal {
    pub loads: Vec<ProposedLoad>,
    pub left_out: Vec<LeftOutLoad>,
    pub from: StrainFrom,
    /// Whether the loads come from the user's files. A job must then have all of them.
    pub stated: bool,
}

/// A result file and its static subcases with strain of shells, each with its LABEL.
pub(super) type StrainResultFile = (String, BTreeMap<u32, String>);

/// Returns every proposal that the files allow, the best first. The list is empty without grids. Loads that the files state are never replaced by
/// other loads.
pub(super) fn proposals(
    deck: &DeckModel,
    strained: &[StrainResultFile],
    system: Option<UnitSystem>,
) -> Vec<Proposal> {
    let stated = |from, (loads, left_out)| Proposal {
        loads,
        left_out,
        from,
        stated: true,
    };
    let (results, solver) = (StrainFrom::Results, StrainFrom::Solver);
    let own = of_results(deck, strained, system);
    let unnamed = match own.0.is_empty() {
        true => by_number(deck, strained, system),
        false => Vec::new(),
    };
    let mut all = vec![
        stated(results, own),
        stated(results, (unnamed, Vec::new())),
        stated(solver, of_subcases(deck, system)),
        stated(solver, of_load_sets(&deck.model, system)),
    ];
    all.retain(|p| !p.loads.is_empty());
    if let Some(first) = all.first() {
        // The proposals with the same loads from the built-in solver remain, in case the results can't be used.
        let names: Vec<String> = first.loads.iter().map(|l| l.name.clone()).collect();
        all.retain(|p| p.loads.iter().map(|l| &l.name).eq(names.iter()));
        return all;
    }
    at_points(deck, system)
}

/// Returns the subcases of the deck that have strain in the results.
fn of_results(
    deck: &DeckModel,
    strained: &[StrainResultFile],
    system: Option<UnitSystem>,
) -> (Vec<ProposedLoad>, Vec<LeftOutLoad>) {
    let (all, mut left_out) = of_subcases(deck, system);
    let mut loads = Vec::new();
    for mut l in all {
        let holds = |s: &&StrainResultFile| l.subcase.is_some_and(|id| s.1.contains_key(&id));
        match strained.iter().find(holds) {
            Some(source) => {
                l.result = (strained.len() > 1).then(|| source.0.clone());
                loads.push(l);
            }
            None => left_out.push(LeftOutLoad {
                name: l.name.clone(),
                load: Some(l),
                why: "the results have no strain of shells for its subcase".to_owned(),
            }),
        }
    }
    (loads, left_out)
}

/// Subcases of results whose loads the deck does not state.
fn by_number(
    deck: &DeckModel,
    strained: &[StrainResultFile],
    system: Option<UnitSystem>,
) -> Vec<ProposedLoad> {
    const REPLACE: &str = "# replace: the load of this subcase";
    const NAMED: &str = "# check: the grid, from the name of the subcase";
    let subcases = deck.deck.case_control.effective_subcases();
    let first = deck.model.grids.first().map_or(1, |g| g.id);
    let points = load_points(deck);
    let mut used = BTreeMap::new();
    let mut loads = Vec::new();
    for (file, cases) in strained {
        for (id, title) in cases {
            let label = subcases.iter().find(|s| s.id == *id);
            let label = label.and_then(|s| s.label.as_deref()).unwrap_or(title);
            let name = match label.trim() {
                "" => format!("subcase{id}"),
                label => plain_name(label),
            };
            let (point, component) = name.rsplit_once('.').unwrap_or((&name, ""));
            let quantity = quantity_of(component);
            let component = quantity.map_or("FZ", |_| component);
            let named = points.iter().find(|p| p.name == point);
            let what = match (named, deck.model.load_sets.first()) {
                (Some(p), _) => format!("grid = {}                       {NAMED}", p.grid),
                (None, Some(s)) => format!("load_set = {}                       {REPLACE}", s.sid),
                (None, None) => format!("grid = {first}                           {REPLACE}"),
            };
            let what = match what.starts_with("grid") {
                true => format!("{what}\ncomponent = \"{component}\""),
                false => what,
            };
            let (expected, expected_is) = typical_size(system, quantity.unwrap_or(Quantity::Force));
            loads.push(ProposedLoad {
                name: unique_name(&mut used, name),
                what,
                applied: 1.0,
                subcase: Some(*id),
                result: (strained.len() > 1).then(|| file.clone()),
                expected,
                expected_is,
            });
        }
    }
    loads
}

/// Subcases of the deck, each load set once, with those that have no load of their own.
fn of_subcases(
    deck: &DeckModel,
    system: Option<UnitSystem>,
) -> (Vec<ProposedLoad>, Vec<LeftOutLoad>) {
    let mut used = BTreeMap::new();
    let mut sets: BTreeMap<u32, u32> = BTreeMap::new();
    let (mut loads, mut left_out) = (Vec::new(), Vec::new());
    for sc in deck.deck.case_control.effective_subcases() {
        let label = [&sc.label, &sc.subtitle]
            .into_iter()
            .flatten()
            .find(|l| !l.trim().is_empty())
            .map(|l| plain_name(l));
        let mut leave = |why: String| {
            let name = label.clone().unwrap_or_else(|| format!("subcase{}", sc.id));
            left_out.push(LeftOutLoad {
                name,
                load: None,
                why,
            });
        };
        let Some(sid) = sc.load.filter(|sid| *sid > 0) else {
            leave(format!("subcase {} selects no LOAD", sc.id));
            continue;
        };
        if let Some(first) = sets.get(&sid) {
            leave(format!(
                "subcase {} has the load set {sid} of subcase {first}",
                sc.id
            ));
            continue;
        }
        sets.insert(sid, sc.id);
        loads.push(ProposedLoad {
            subcase: Some(sc.id),
            ..of_set(&deck.model, sid, label, &mut used, system)
        });
    }
    (loads, left_out)
}

/// Returns the load sets of a deck without subcases that select them.
fn of_load_sets(
    model: &Model,
    system: Option<UnitSystem>,
) -> (Vec<ProposedLoad>, Vec<LeftOutLoad>) {
    let mut used = BTreeMap::new();
    let sets = model.load_sets.iter().filter(|s| !s.loads.is_empty());
    let of = |s: &LoadSet| of_set(model, s.sid, None, &mut used, system);
    let mut loads: Vec<ProposedLoad> = sets.map(of).collect();
    let others = loads.split_off(loads.len().min(MOST_GRIDS));
    let left_out = |l: ProposedLoad| LeftOutLoad {
        name: l.name.clone(),
        load: Some(l),
        why: format!("only the first {MOST_GRIDS} load sets are proposed"),
    };
    (loads, others.into_iter().map(left_out).collect())
}

/// Returns a proposal for each rank of points: wheels, hubs, grids of the mesh. A proposal has one load at each point of its rank. All other points
/// are in its left-out loads, from which the user can choose.
fn at_points(deck: &DeckModel, system: Option<UnitSystem>) -> Vec<Proposal> {
    let (expected, expected_is) = typical_size(system, Quantity::Force);
    let load = |p: &LoadPoint| ProposedLoad {
        name: format!("{}.FZ", p.name),
        what: format!("grid = {}\ncomponent = \"FZ\"", p.grid),
        applied: 1.0,
        subcase: None,
        result: None,
        expected,
        expected_is: expected_is.clone(),
    };
    let points = load_points(deck);
    let of_rank = |rank: Rank| {
        let (mut loads, mut left_out) = (Vec::new(), Vec::new());
        for p in &points {
            let full = loads.len() == MOST_GRIDS;
            if p.rank == rank && !full {
                loads.push(load(p));
                continue;
            }
            let why = match full {
                true => format!("only the first {MOST_GRIDS} points are proposed"),
                false => "other points where a load may act".to_owned(),
            };
            left_out.push(LeftOutLoad {
                name: format!("{}.FZ", p.name),
                load: Some(load(p)),
                why,
            });
        }
        Proposal {
            loads,
            left_out,
            from: StrainFrom::Solver,
            stated: false,
        }
    };
    let all = Rank::ALL.into_iter().map(of_rank);
    all.filter(|p| !p.loads.is_empty()).collect()
}

/// Returns the typical size to propose for a load whose size no file states, with its unit. Where the units are open, SI is taken: the line is to
/// be corrected with them.
fn typical_size(system: Option<UnitSystem>, quantity: Quantity) -> (f64, String) {
    let size = typical_load(system.unwrap_or(UnitSystem::MKgS), quantity);
    let unit = system.map_or(String::new(), |s| format!(" in {}", s.unit(quantity).name));
    (round(size.unwrap_or(1.0)), unit)
}

/// Returns the typical size to propose for a load of the size `applied` in the deck, with a note of its unit and source.
fn propose_size(system: Option<UnitSystem>, quantity: Quantity, applied: f64) -> (f64, String) {
    let (size, unit) = typical_size(system, quantity);
    match is_unit_load(system.unwrap_or(UnitSystem::MKgS), quantity, applied) {
        true => (size, format!("{unit} (the deck has a unit load)")),
        false => (round(applied.abs()), unit),
    }
}

/// Returns the quantity of a component by its name.
fn quantity_of(component: &str) -> Option<Quantity> {
    let found = Component::ALL.into_iter().find(|c| c.name() == component);
    found.map(Component::quantity)
}

fn of_set(
    model: &Model,
    sid: u32,
    label: Option<String>,
    used: &mut BTreeMap<String, usize>,
    system: Option<UnitSystem>,
) -> ProposedLoad {
    let (what, name, applied, (expected, expected_is)) = match find_single_load(model, sid) {
        Some((what, name, applied)) => {
            let component = name.rsplit('.').next().unwrap_or_default();
            let quantity = quantity_of(component).unwrap_or(Quantity::Force);
            let expected = propose_size(system, quantity, applied);
            (what, name, applied, expected)
        }
        None => {
            let times = (
                times_of_set(model, sid, system),
                " in multiples of the load set".to_owned(),
            );
            (format!("load_set = {sid}"), format!("set{sid}"), 1.0, times)
        }
    };
    ProposedLoad {
        name: unique_name(used, label.unwrap_or(name)),
        what,
        applied,
        subcase: None,
        result: None,
        expected,
        expected_is,
    }
}

/// Returns the factor from a load set to its expected size: for a set of unit size the factor to a typical load, else 1.
fn times_of_set(model: &Model, sid: u32, system: Option<UnitSystem>) -> f64 {
    let system = system.unwrap_or(UnitSystem::MKgS);
    let loads = model.load_sets.iter().filter(|s| s.sid == sid);
    let (mut total, mut largest) = ([0.0; 2], [0.0_f64; 2]);
    for (factor, load) in loads.flat_map(|s| &s.loads) {
        let (of, size) = match load {
            Load::Force(_, v) => (0, factor.abs() * v.norm()),
            Load::Moment(_, v) => (1, factor.abs() * v.norm()),
            _ => return 1.0,
        };
        total[of] += size;
        largest[of] = largest[of].max(size);
    }
    let of = usize::from(total[0] == 0.0);
    let quantity = [Quantity::Force, Quantity::Moment][of];
    // Forces of 1 N, and sets of forces with a sum of 1 N.
    let is_unit = [total[of], largest[of]]
        .into_iter()
        .any(|s| is_unit_load(system, quantity, s));
    match typical_load(system, quantity).filter(|_| is_unit) {
        Some(typical) => round(typical / total[of]),
        None => 1.0,
    }
}

/// Returns kind, name and size of a load set that is one force or moment along an axis.
fn find_single_load(model: &Model, sid: u32) -> Option<(String, String, f64)> {
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
    let size = factor * v[axis];
    if !(size != 0.0 && size.is_finite()) {
        return None;
    }
    let component = format!("{letter}{}", ['X', 'Y', 'Z'][axis]);
    let id = model.grids.get(grid.us())?.id;
    Some((
        format!("grid = {id}\ncomponent = \"{component}\""),
        format!("{id}.{component}"),
        size,
    ))
}

fn unique_name(used: &mut BTreeMap<String, usize>, name: String) -> String {
    let n = used.entry(name.clone()).or_insert(0);
    *n += 1;
    if *n == 1 { name } else { format!("{name}_{n}") }
}
