//! `[model]` and `[[load]]`.

use super::super::faults::Collector;
use super::super::raw_job::{RawLoad, RawModel, S};
use super::super::shapes::NumberOrWord;
use super::super::spanned_value::SpannedValue;
use super::super::suggest;
use super::super::types::*;
use crate::fe::SupportChoice;
use crate::host::fault::Fault;

pub(super) fn model(c: &mut Collector, raw: Option<&SpannedValue<RawModel>>) -> Option<ModelFiles> {
    let section = raw?;
    let raw = section.value();
    c.require(&raw.deck, section, "model.deck", "deck = \"truck.bdf\"")?;
    let results = raw
        .results
        .iter()
        .map(|r| c.named_at(r, "model.results"))
        .collect();
    Some(ModelFiles {
        deck: c.named_file(&raw.deck, "model.deck")?,
        results,
        support: support(c, &raw.support),
        support_line: match &raw.support {
            Some(s) => c.line(s),
            None => c.line(section),
        },
        mesh_error: raw.mesh_error.as_ref().map(|m| *m.value()),
    })
}

/// `"deck"`, `"free"`, or the id of an SPC set.
fn support(c: &mut Collector, raw: &S<NumberOrWord>) -> SupportChoice {
    let Some(at) = raw else {
        return SupportChoice::Deck;
    };
    match at.value() {
        NumberOrWord::Word(w) if w == "deck" => return SupportChoice::Deck,
        NumberOrWord::Word(w) if w == "free" => return SupportChoice::Free,
        NumberOrWord::Number(n) if n.fract() == 0.0 && *n >= 1.0 && *n <= f64::from(u32::MAX) => {
            return SupportChoice::Set(*n as u32);
        }
        NumberOrWord::Number(n) => {
            let wrong = format!("`{n}` is not an id of an SPC set");
            c.fault(at, "model.support", wrong, SUPPORT_REMEDY);
        }
        NumberOrWord::Word(w) => {
            let wrong = format!("`{w}`, expected \"deck\", \"free\" or the id of an SPC set");
            c.fault(at, "model.support", wrong, SUPPORT_REMEDY);
        }
    }
    SupportChoice::Deck
}

const SUPPORT_REMEDY: &str = "write \"deck\" for the set that case control selects, \"free\" for inertia relief, or the set's id";

/// Source of the strain by the loads of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Behind {
    /// A model: a load acts at a place of it.
    Model,
    /// A given S: the name of a load is sufficient.
    Table,
}

pub(super) fn loads(
    c: &mut Collector,
    raw: &[SpannedValue<RawLoad>],
    behind: Behind,
) -> Vec<JobLoad> {
    let mut out: Vec<JobLoad> = Vec::new();
    for (i, section) in raw.iter().enumerate() {
        let number = i as u32 + 1;
        let Some(load) = load(c, section, number, behind) else {
            continue;
        };
        if let Some(first) = out.iter().find(|l| l.name == load.name) {
            let wrong = format!(
                "load `{}` occurs twice, first on line {}",
                load.name, first.line
            );
            c.fault(
                section,
                "load.name",
                wrong,
                "give every load a separate name",
            );
        }
        out.push(load);
    }
    out
}

fn load(
    c: &mut Collector,
    section: &SpannedValue<RawLoad>,
    number: u32,
    behind: Behind,
) -> Option<JobLoad> {
    let raw = section.value();
    let name = c.require(&raw.name, section, "load.name", "name = \"LF.FZ\"");
    let acts = acts(c, section, behind);
    let applied = c.number(&raw.applied, "load.applied", "a number other than 0", |x| {
        x != 0.0
    });
    let role = c.choose(
        &raw.role,
        "load.role",
        &[
            ("wanted", LoadRole::Wanted),
            ("nuisance", LoadRole::Nuisance),
        ],
        LoadRole::Wanted,
    );
    let expected = c.positive_number(&raw.expected, "load.expected");
    Some(JobLoad {
        name: name?,
        acts: acts?,
        applied: applied.unwrap_or(1.0),
        result: c.named_file(&raw.result, "load.result"),
        subcase: raw.subcase.as_ref().map(|s| *s.value()),
        number,
        role,
        expected,
        weight: c.positive_number(&raw.weight, "load.weight").unwrap_or(1.0),
        line: c.line(section),
    })
}

fn acts(c: &mut Collector, section: &SpannedValue<RawLoad>, behind: Behind) -> Option<LoadActs> {
    let raw = section.value();
    let only_with_grid = |c: &mut Collector, key: &str, at: &SpannedValue<u32>| {
        c.fault(
            at,
            key,
            "needs `grid`",
            "delete it, or give `grid` and `component` instead of `load_set`",
        );
    };
    match (&raw.grid, &raw.load_set) {
        (Some(g), None) => {
            let word: S<String> = raw.component.clone();
            if word.is_none() {
                c.require(&word, section, "load.component", "component = \"FZ\"")?;
            }
            let choices: Vec<(&str, Component)> =
                Component::ALL.into_iter().map(|k| (k.name(), k)).collect();
            let component = c.choose_at(word.as_ref()?, "load.component", &choices)?;
            Some(LoadActs::AtGrid {
                grid: *g.value(),
                component,
                cid: raw.cid.as_ref().map_or(0, |v| *v.value()),
            })
        }
        (None, Some(set)) => {
            if let Some(cid) = &raw.cid {
                only_with_grid(c, "load.cid", cid);
            }
            if let Some(component) = &raw.component {
                c.fault(
                    component,
                    "load.component",
                    "a load set has no component",
                    "delete it, or give `grid` instead of `load_set`",
                );
            }
            Some(LoadActs::Set(*set.value()))
        }
        (Some(_), Some(set)) => {
            c.fault(
                set,
                "load.load_set",
                "the load states `grid` as well",
                "keep one of them",
            );
            None
        }
        (None, None) if behind == Behind::Table => Some(LoadActs::Named),
        (None, None) => {
            c.fault(
                section,
                "load.grid",
                "the load has neither `grid` nor `load_set`",
                "add `grid = 101` and `component = \"FZ\"`, or `load_set = 12`",
            );
            None
        }
    }
}

/// Checks that the results file of each load is a results file of the model.
pub(super) fn check_results(c: &mut Collector, model: Option<&ModelFiles>, loads: &[JobLoad]) {
    let Some(model) = model else { return };
    for load in loads {
        let Some(result) = &load.result else { continue };
        if !model.results.iter().any(|r| r.given == result.given) {
            let names: Vec<&str> = model.results.iter().map(|r| r.given.as_str()).collect();
            let wrong = format!("`{}` is not one of `model.results`", result.given);
            let remedy = if names.is_empty() {
                "add it to `model.results`".into()
            } else {
                suggest::remedy(&result.given, names)
            };
            c.faults.push(Fault::with_line(
                c.file,
                result.line,
                "load.result",
                wrong,
                remedy,
            ));
        }
    }
}
