//! Decks in `result.json` and as text.

use crate::fe::{check_shapes, contradictions, held_dependents};
use crate::finding::Finding;
use crate::host::fault::FaultList;
use crate::host::words::{count_of, format_number};
use crate::host::work::Work;
use crate::job::Job;
use crate::model::{Model, UnsupportedCard};
use crate::strain_chain::deck::{DeckModel, model_of_deck, moduli_and_densities};
use crate::strain_chain::job_deck::against_suggested_units;
use crate::strain_chain::repeated_subcases::find_repeated_subcases;
use crate::units::{Quantity, Unit, UnitSystem, factor, likely_system};
use nastran::bdf::vocabulary::{Effect, effect_of_card};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

/// Elements of any kind, with and without a struct of their own; masses, rigid elements and plot elements aren't counted.
const ELEMENTS: [&str; 53] = [
    "CBAR", "CBEAM", "CBEAM3", "CBEND", "CBUSH", "CBUSH1D", "CBUSH2D", "CDAMP1", "CDAMP2",
    "CDAMP3", "CDAMP4", "CDAMP5", "CELAS1", "CELAS2", "CELAS3", "CELAS4", "CFAST", "CGAP", "CHEXA",
    "CPENTA", "CPYRAM", "CTETRA", "CONROD", "CQUAD", "CQUAD4", "CQUAD8", "CQUADR", "CQUADX",
    "CQUADX4", "CQUADX8", "CROD", "CTUBE", "CSHEAR", "CTRIA3", "CTRIA6", "CTRIAR", "CTRIAX",
    "CTRIAX6", "CTRAX3", "CTRAX6", "CVISC", "CRAC2D", "CRAC3D", "CWELD", "CSEAM", "CPLSTN3",
    "CPLSTN4", "CPLSTN6", "CPLSTN8", "CPLSTS3", "CPLSTS4", "CPLSTS6", "CPLSTS8",
];

/// One deck.
#[derive(Serialize)]
pub struct DeckEntry {
    path: String,
    /// Number of cards by name.
    cards: BTreeMap<String, usize>,
    /// Number of cards without influence on linear statics, mass and modes, by reason.
    without_influence: BTreeMap<&'static str, usize>,
    grids: usize,
    elements: usize,
    /// WTMASS applied.
    mass: f64,
    cg: [f64; 3],
    solution: Option<String>,
    subcases: Vec<u32>,
    wtmass: f64,
    property_names: BTreeMap<u32, String>,
    faults: usize,
    /// Units of mass and centre of gravity for people; `None` where neither a job nor the materials show them.
    #[serde(skip)]
    shown: Option<ShownUnits>,
    #[serde(skip)]
    pub(super) model: Option<Model>,
}

/// Units in which people read mass and centre of gravity.
#[derive(Clone, Copy)]
struct ShownUnits {
    /// Units of the deck.
    system: UnitSystem,
    /// Unit of lengths.
    length: Unit,
    /// Whether a job states them; else the materials suggest them.
    is_stated: bool,
}

pub(super) fn check_deck(
    work: &mut Work,
    base: &Path,
    given: &str,
    bytes: &[u8],
) -> (DeckEntry, FaultList) {
    let mut read = model_of_deck(&mut work.inputs, base, given, bytes);
    // The warning `card-not-solved` lists these cards. The commands that need them refuse the deck.
    let not_carried = std::mem::take(&mut read.not_carried);
    let named: HashSet<String> = not_carried.iter().map(ToString::to_string).collect();
    if !named.is_empty() {
        read.faults.retain(|f| !named.contains(&f.to_string()));
    }
    work.findings.extend(read.findings.iter().cloned());
    work.findings.extend(find_repeated_subcases(&read));
    work.findings.extend(check_shapes(&read.model));
    let held = supports(&read);
    work.findings.extend(
        held.into_iter()
            .filter_map(|s| contradictions(&read.model, Some(s))),
    );
    let both = sets(&read).into_iter().filter_map(|(spc, mpc)| {
        let finding = held_dependents(&read.model, spc, mpc)?;
        Some((spc, finding))
    });
    work.findings
        .extend(both.collect::<BTreeMap<_, _>>().into_values());
    let faults = read.faults.clone();
    (DeckEntry::from_deck(read), faults)
}

/// Returns the SPC sets that case control selects, or all SPC sets of the deck if it selects none.
fn supports(read: &DeckModel) -> BTreeSet<u32> {
    let case_control = &read.deck.case_control;
    let all = std::iter::once(&case_control.global).chain(&case_control.subcases);
    let selected: BTreeSet<u32> = all.filter_map(|c| c.spc).collect();
    match selected.is_empty() {
        true => read.model.spcs.iter().map(|s| s.sid).collect(),
        false => selected,
    }
}

/// Returns the pairs of SPC and MPC sets of the subcases. If case control selects no SPC set, each SPC set of the deck counts.
fn sets(read: &DeckModel) -> BTreeSet<(Option<u32>, Option<u32>)> {
    let subcases = read.deck.case_control.effective_subcases();
    let selected: BTreeSet<_> = subcases.iter().map(|s| (s.spc, s.mpc)).collect();
    match selected.iter().any(|s| s.0.is_some()) {
        true => selected,
        false => {
            let mpc = read.model.mpc;
            let all = supports(read).into_iter().map(|spc| (Some(spc), mpc));
            all.chain([(None, mpc)]).collect()
        }
    }
}

/// Counts the cards without influence by reason; `model` lists the cards that act and are not carried.
fn without_influence(
    cards: &BTreeMap<String, usize>,
    model: &Model,
) -> BTreeMap<&'static str, usize> {
    // The field `card` starts with the name of the card, as in `MDLPRM OFFDEF`.
    let acting = |name: &str| {
        let of_name = |u: &&UnsupportedCard| u.card.split(' ').next() == Some(name);
        let acting = model.unsupported_cards.iter().filter(of_name);
        acting.map(|u| u.at).collect::<BTreeSet<_>>().len()
    };
    let mut counted = BTreeMap::new();
    for (name, n) in cards {
        let (reason, n) = match effect_of_card(name) {
            Some(Effect::None(reason)) => (reason, n - acting(name).min(*n)),
            Some(Effect::ActsWith(_)) => {
                ("acts on no element of this deck", n - acting(name).min(*n))
            }
            _ => continue,
        };
        if n > 0 {
            *counted.entry(reason).or_default() += n;
        }
    }
    counted
}

/// The units that the materials of a deck suggest.
fn suggest_units(model: &Model) -> Option<ShownUnits> {
    let (moduli, densities) = moduli_and_densities(model);
    let system = likely_system(model.params.unitsys.as_deref(), &moduli, &densities)?;
    Some(ShownUnits {
        system,
        length: system.unit(Quantity::Length),
        is_stated: false,
    })
}

impl DeckEntry {
    pub(super) fn from_deck(d: DeckModel) -> Self {
        let cards = d.deck.counts.clone();
        let weight = d.model.weight();
        let m = &d.model;
        let in_mesh = m.n_elements() - m.masses.len() - m.scalar_masses.len() - m.rigids.len();
        let counted: usize = ELEMENTS.iter().filter_map(|e| cards.get(*e)).sum();
        Self {
            path: d.given,
            grids: m.grids.iter().filter(|g| !g.is_scalar()).count(),
            // A mesh from an OP2 file has no cards to count.
            elements: if cards.is_empty() { in_mesh } else { counted },
            without_influence: without_influence(&cards, &d.model),
            cards,
            mass: weight.mass,
            cg: weight.cg.into(),
            solution: d.deck.sol_text.clone(),
            subcases: d.deck.case_control.subcases.iter().map(|s| s.id).collect(),
            wtmass: m.params.wtmass,
            property_names: m.property_names.iter().cloned().collect(),
            faults: d.faults.len(),
            shown: suggest_units(m),
            model: Some(d.model),
        }
    }

    /// Returns what contradicts the units that the materials suggest. A deck of a job is tested against the units of the job.
    pub(super) fn contradictions_of_suggested_units(&self) -> Vec<Finding> {
        match (&self.model, self.shown) {
            (Some(model), Some(shown)) if !shown.is_stated => {
                against_suggested_units(shown.system, model)
            }
            _ => Vec::new(),
        }
    }

    /// Applies the units that a job states.
    pub(super) fn state_units(&mut self, job: &Job) {
        self.shown = Some(ShownUnits {
            system: job.units,
            length: job.report_units.length,
            is_stated: true,
        });
    }

    /// Returns mass and centre of gravity as text.
    fn weight(&self) -> String {
        // The mass must be finite in kilogrammes, too.
        let scale = self.shown.map_or(1.0, |u| u.system.mass_kg());
        if !(self.mass * scale).is_finite() || self.cg.iter().any(|v| !v.is_finite()) {
            return "beyond the range of numbers".to_owned();
        }
        let wtmass = match self.wtmass == 1.0 {
            true => String::new(),
            false => format!(" (PARAM,WTMASS,{} applied)", self.wtmass),
        };
        /// Share of the largest coordinate below which another one is rounding.
        const ROUNDING: f64 = 1e-12;
        let largest = self.cg.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        let plain = |v: f64| if v.abs() < ROUNDING * largest { 0.0 } else { v };
        let at = |scale: f64| self.cg.map(|v| format_number(plain(v) * scale)).join(", ");
        match self.shown {
            None => format!(
                "{}{wtmass}, centre of gravity {}, units of the deck",
                format_number(self.mass),
                at(1.0)
            ),
            Some(u) => {
                let mass = format_number(self.mass * u.system.mass_kg());
                let cg = at(factor(u.system, u.length));
                let guess = match u.is_stated {
                    true => String::new(),
                    false => format!(", if the deck is in {}", u.system.name()),
                };
                let length = u.length.name;
                format!("{mass} kg{wtmass}, centre of gravity {cg} {length}{guess}")
            }
        }
    }

    /// Returns the path as given.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// Returns the mesh.
    pub fn model(&self) -> Option<&Model> {
        self.model.as_ref()
    }

    /// Returns the line about cards without influence; empty if there are no such cards.
    fn describe_idle_cards(&self) -> String {
        let counted = self.without_influence.iter();
        let parts: Vec<String> = counted.map(|(why, n)| format!("{why} {n}")).collect();
        match parts.is_empty() {
            true => String::new(),
            false => format!("  without influence: {}\n", parts.join("; ")),
        }
    }

    /// Returns the number of grids and of elements.
    pub fn counts(&self) -> [usize; 2] {
        [self.grids, self.elements]
    }

    /// Returns the content of the deck as text.
    pub fn text(&self) -> String {
        let cards: Vec<String> = self.cards.iter().map(|(k, n)| format!("{k} {n}")).collect();
        let solution = self
            .solution
            .as_ref()
            .map_or(String::new(), |s| format!(", SOL {s}"));
        format!(
            "deck `{}`: {}, {}, {}{solution}\n  mass {}\n  cards: {}\n{}  faults: {}",
            self.path,
            count_of(self.grids, "grid"),
            count_of(self.elements, "element"),
            count_of(self.subcases.len(), "subcase"),
            self.weight(),
            cards.join(", "),
            self.describe_idle_cards(),
            self.faults
        )
    }
}
