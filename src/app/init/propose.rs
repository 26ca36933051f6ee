//! Loads for a job: of the results' subcases, else of the deck's, else at points where loads are likely to enter.

use super::points::load_points;
use super::round::round;
use crate::app::deck::DeckModel;
use crate::model::{Load, Model};
use crate::units::{Quantity, UnitSystem};
use std::collections::{BTreeMap, BTreeSet};

/// Loads proposed at most where nothing but grids is known.
const MOST_GRIDS: usize = 24;
/// A load of 10 kN on a point: the size of a wheel of a light truck.
const POINT_LOAD_N: f64 = 1e4;

/// A load that the job proposes.
#[derive(Clone)]
pub(super) struct ProposedLoad {
    pub name: String,
    /// Its lines of the job: where it acts.
    pub what: String,
    pub applied: f64,
    pub subcase: Option<u32>,
    pub result: Option<String>,
    pub expected: f64,
}

/// Where the strain of a proposal's loads comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StrainFrom {
    Results,
    Solver,
}

/// Loads that belong together.
#[derive(Clone)]
pub(super) struct Proposal {
    pub loads: Vec<ProposedLoad>,
    pub from: StrainFrom,
}

/// A result file and its static subcases with strain of shells.
pub(super) type Strained = (String, BTreeSet<u32>);

/// Every proposal that the files allow, the best first; none without grids.
pub(super) fn proposals(
    deck: &DeckModel,
    strained: &[Strained],
    system: Option<UnitSystem>,
) -> Vec<Proposal> {
    let results = |loads| Proposal {
        loads,
        from: StrainFrom::Results,
    };
    let solver = |loads| Proposal {
        loads,
        from: StrainFrom::Solver,
    };
    // Without elements and their materials in a deck, there is nothing to solve.
    let all = [
        results(of_results(deck, strained)),
        results(by_number(deck, strained)),
        solver(of_subcases(deck)),
        solver(of_load_sets(&deck.model)),
        solver(at_points(deck, system)),
    ];
    all.into_iter().filter(|p| !p.loads.is_empty()).collect()
}

/// Subcases of the deck that the results hold with strain.
fn of_results(deck: &DeckModel, strained: &[Strained]) -> Vec<ProposedLoad> {
    let mut loads = of_subcases(deck);
    loads.retain_mut(|l| {
        let source = strained
            .iter()
            .find(|(_, c)| l.subcase.is_some_and(|s| c.contains(&s)));
        l.result = source.filter(|_| strained.len() > 1).map(|s| s.0.clone());
        source.is_some()
    });
    loads
}

/// Subcases of results whose loads the deck doesn't tell.
fn by_number(deck: &DeckModel, strained: &[Strained]) -> Vec<ProposedLoad> {
    const REPLACE: &str = "# replace: what acts in this subcase";
    let subcases = deck.deck.case_control.effective_subcases();
    let grid = deck.model.grids.first().map_or(1, |g| g.id);
    let what = deck.model.load_sets.first().map_or_else(
        || format!("grid = {grid}                           {REPLACE}\ncomponent = \"FZ\""),
        |s| format!("load_set = {}                       {REPLACE}", s.sid),
    );
    let mut used = BTreeMap::new();
    let mut loads = Vec::new();
    for (file, cases) in strained {
        for id in cases {
            let label = subcases
                .iter()
                .find(|s| s.id == *id)
                .and_then(|s| s.label.clone());
            let name = label.map_or(format!("subcase{id}"), |l| clean(&l));
            loads.push(ProposedLoad {
                name: unique(&mut used, name),
                what: what.clone(),
                applied: 1.0,
                subcase: Some(*id),
                result: (strained.len() > 1).then(|| file.clone()),
                expected: 1.0,
            });
        }
    }
    loads
}

/// Subcases of the deck, each load set once.
fn of_subcases(deck: &DeckModel) -> Vec<ProposedLoad> {
    let mut used = BTreeMap::new();
    let mut sets = BTreeSet::new();
    let mut loads = Vec::new();
    for sc in deck.deck.case_control.effective_subcases() {
        let Some(sid) = sc.load.filter(|sid| *sid > 0 && sets.insert(*sid)) else {
            continue;
        };
        let label = [&sc.label, &sc.subtitle]
            .into_iter()
            .flatten()
            .find(|l| !l.trim().is_empty())
            .map(|l| clean(l));
        loads.push(ProposedLoad {
            subcase: Some(sc.id),
            ..of_set(&deck.model, sid, label, &mut used)
        });
    }
    loads
}

/// Load sets of a deck without subcases that select them.
fn of_load_sets(model: &Model) -> Vec<ProposedLoad> {
    let mut used = BTreeMap::new();
    let sets = model.load_sets.iter().filter(|s| !s.loads.is_empty());
    sets.take(MOST_GRIDS)
        .map(|s| of_set(model, s.sid, None, &mut used))
        .collect()
}

/// A load of its own at each point.
fn at_points(deck: &DeckModel, system: Option<UnitSystem>) -> Vec<ProposedLoad> {
    let force = system.map_or(POINT_LOAD_N, |s| POINT_LOAD_N / s.si(Quantity::Force));
    load_points(deck)
        .into_iter()
        .take(MOST_GRIDS)
        .map(|(grid, why)| ProposedLoad {
            name: format!("{why}{grid}.FZ"),
            what: format!("grid = {grid}\ncomponent = \"FZ\""),
            applied: 1.0,
            subcase: None,
            result: None,
            expected: round(force),
        })
        .collect()
}

fn of_set(
    model: &Model,
    sid: u32,
    label: Option<String>,
    used: &mut BTreeMap<String, usize>,
) -> ProposedLoad {
    let (what, name, applied) = single(model, sid)
        .unwrap_or_else(|| (format!("load_set = {sid}"), format!("set{sid}"), 1.0));
    ProposedLoad {
        name: unique(used, label.unwrap_or(name)),
        what,
        applied,
        subcase: None,
        result: None,
        expected: round(applied.abs()),
    }
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

/// A name that needs no care in a job or a table.
pub(super) fn clean(name: &str) -> String {
    name.trim()
        .chars()
        .map(|c| match c {
            '"' | '\\' | ',' => '_',
            c if c.is_control() => '_',
            c => c,
        })
        .collect()
}

fn unique(used: &mut BTreeMap<String, usize>, name: String) -> String {
    let n = used.entry(name.clone()).or_insert(0);
    *n += 1;
    if *n == 1 { name } else { format!("{name}_{n}") }
}
