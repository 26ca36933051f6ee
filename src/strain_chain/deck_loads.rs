//! Loads of a job compared with the loads of the subcases whose results they name.

use crate::fe::{CaseResult, UnitLoad};
use crate::finding::list_few;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::words::format_number;
use crate::job::{Job, JobLoad, LoadActs};
use crate::model::{Load, Model, Vec3};
use crate::strain_chain::built_in_solver::{is_combination, label_of};
use crate::strain_chain::combined_subcases::read_combination;
use crate::strain_chain::deck::DeckModel;
use crate::strain_chain::other_loads::{OtherLoad, moved_supports, other_loads, thermal_loads};
use nastran::bdf::Subcase;

/// Relative difference of forces and moments up to which job and deck agree: cards and jobs state four digits or more.
const AGREES: f64 = 1e-3;

/// Force, and moment about a point.
#[derive(Clone, Copy)]
struct Resultant {
    force: Vec3,
    moment: Vec3,
}

/// Refuses loads whose subcase in the deck contains another load: the strain would belong to the other load.
///
/// For a load at a grid, force and moment about the grid are compared, so that a couple may represent a moment. Pressures, accelerations,
/// temperatures and enforced displacements in its subcase are refused. A load set is compared with the LOAD of the subcase. A combination is the sum
/// of its subcases. A subcase whose label differs in the results is not compared, since the results are from another deck.
///
/// # Errors
/// Every such load.
pub(super) fn check_deck_loads<'a>(
    job: &Job,
    deck: &DeckModel,
    units: &[UnitLoad],
    cases: impl Iterator<Item = &'a CaseResult>,
) -> Result<(), Faults> {
    let subcases = deck.deck.case_control.effective_subcases();
    let mut faults = FaultList::new();
    for ((load, unit), case) in job.loads.iter().zip(units).zip(cases) {
        let Some(at) = subcase_of(&subcases, case) else {
            continue;
        };
        let terms = match terms_of(deck, &subcases, at) {
            Ok(terms) => terms,
            Err(of_combination) => {
                faults.extend(of_combination);
                continue;
            }
        };
        let compared = DeckLoadCheck {
            job,
            deck,
            load,
            subcase: &subcases[at],
            terms,
        };
        faults.extend(compared.fault(unit));
    }
    Faults::check(faults)
}

/// Returns the index of the subcase of the deck whose results a case contains; `None` if the deck lacks it, or its label differs.
pub(super) fn subcase_of(subcases: &[Subcase], case: &CaseResult) -> Option<usize> {
    let at = subcases.iter().position(|s| s.id == case.subcase)?;
    may_be_of(&label_of(&subcases[at]), &case.label).then_some(at)
}

/// Returns a subcase with the factor 1, or the subcases that a combination adds up.
///
/// # Errors
/// A combination that states no sum of subcases.
fn terms_of<'a>(
    deck: &DeckModel,
    subcases: &'a [Subcase],
    at: usize,
) -> Result<Vec<(f64, &'a Subcase)>, Faults> {
    let (above, subcase) = (&subcases[..at], &subcases[at]);
    if !is_combination(subcase) {
        return Ok(vec![(1.0, subcase)]);
    }
    let single = |(i, s): (usize, &Subcase)| (!is_combination(s)).then_some(i);
    let solved: Vec<Option<usize>> = above.iter().enumerate().map(single).collect();
    let combined = read_combination(deck, subcase, (above, &solved), at)?;
    let terms = combined.terms().iter();
    Ok(terms.map(|(factor, i)| (*factor, &above[*i])).collect())
}

/// Load of a job with the subcase of the deck that belongs to its results.
struct DeckLoadCheck<'a> {
    job: &'a Job,
    deck: &'a DeckModel,
    load: &'a JobLoad,
    subcase: &'a Subcase,
    /// Factors and subcases without combinations.
    terms: Vec<(f64, &'a Subcase)>,
}

impl DeckLoadCheck<'_> {
    /// Returns the fault of a load that is not the one of its subcase.
    fn fault(&self, unit: &UnitLoad) -> Option<Fault> {
        match unit {
            UnitLoad::AtGrid {
                grid,
                force,
                moment,
            } => {
                let stated = Resultant {
                    force: *force,
                    moment: *moment,
                };
                let about = self.deck.model.grids.get(grid.us()).map(|g| g.x)?;
                self.other_than_a_force()
                    .or_else(|| self.other_force(stated, about))
            }
            UnitLoad::Set(set) => self.other_set(*set).or_else(|| {
                let thermal =
                    self.collect_loads(|deck, s| match s.temperature_load == Some(*set) {
                        true => Vec::new(),
                        false => thermal_loads(deck, s),
                    });
                self.of_others(&thermal, None)
            }),
            UnitLoad::Temperature { set, .. } => self.other_temperature(*set),
        }
    }

    fn collect_loads(&self, of: impl Fn(&DeckModel, &Subcase) -> Vec<OtherLoad>) -> Vec<OtherLoad> {
        let terms = self.terms.iter().filter(|t| t.0 != 0.0);
        terms.flat_map(|(_, s)| of(self.deck, s)).collect()
    }

    fn other_than_a_force(&self) -> Option<Fault> {
        let mut others = self.collect_loads(other_loads);
        let beyond_load = self.collect_loads(|deck, s| {
            let mut all = thermal_loads(deck, s);
            all.extend(moved_supports(deck, s));
            all
        });
        // `load_set` can state only the set that LOAD selects.
        let set = match (beyond_load.is_empty(), self.sids().as_slice()) {
            (true, &[sid]) => Some(sid),
            _ => None,
        };
        others.extend(beyond_load);
        self.of_others(&others, set)
    }

    /// Returns the fault of a subcase that contains these loads too; `set` is the load set that contains them and the load.
    fn of_others(&self, others: &[OtherLoad], set: Option<u32>) -> Option<Fault> {
        if others.is_empty() {
            return None;
        }
        let words: Vec<String> = others.iter().map(|o| o.words(self.deck)).collect();
        let wrong = format!(
            "{} of the deck also contains {}, so its strain is not the strain of the load alone",
            self.subcase_in_words(),
            list_few(&words)
        );
        let remedy = match set {
            Some(sid) => format!(
                "solve a subcase with the unit load alone; or state load_set = {sid} if the load is this whole set"
            ),
            None => "solve a subcase with the load alone".to_owned(),
        };
        Some(self.contradiction(wrong, &remedy))
    }

    fn other_force(&self, stated: Resultant, about: Vec3) -> Option<Fault> {
        let of_deck = self.resultant(about)?;
        if agree(&self.deck.model, stated, of_deck) {
            return None;
        }
        let vector = |v: Vec3| {
            format!(
                "({}, {}, {})",
                format_number(v.x),
                format_number(v.y),
                format_number(v.z)
            )
        };
        let wrong = format!(
            "{} of the deck has force {} and moment {} about that grid",
            self.subcase_in_words(),
            vector(of_deck.force),
            vector(of_deck.moment)
        );
        Some(self.contradiction(
            wrong,
            "correct `subcase`, `grid`, `component` or `applied` of the load, or name the deck that was run",
        ))
    }

    /// Returns the forces and moments at grids about a point; `None` if the deck selects no load set that it contains.
    fn resultant(&self, about: Vec3) -> Option<Resultant> {
        let mut sum = Resultant {
            force: Vec3::zeros(),
            moment: Vec3::zeros(),
        };
        let mut loads = self.loads().peekable();
        loads.peek()?;
        for (factor, load) in loads {
            match load {
                Load::Force(grid, v) => {
                    let arm = self.deck.model.grids.get(grid.us())?.x - about;
                    sum.force += v * factor;
                    sum.moment += arm.cross(v) * factor;
                }
                Load::Moment(_, v) => sum.moment += v * factor,
                _ => {}
            }
        }
        Some(sum)
    }

    /// Returns the loads of the load sets with their factors.
    fn loads(&self) -> impl Iterator<Item = (f64, &Load)> {
        let sets = &self.deck.model.load_sets;
        self.terms.iter().flat_map(move |(factor, s)| {
            let set = sets.iter().filter(|set| Some(set.sid) == s.load);
            let loads = set.flat_map(|set| &set.loads);
            loads.map(move |(f, load)| (factor * f, load))
        })
    }

    fn other_set(&self, set: u32) -> Option<Fault> {
        let sids = self.sids();
        let is_plain = matches!(self.terms.as_slice(), [(1.0, _)]);
        if sids.is_empty() || (is_plain && sids == [set]) {
            return None;
        }
        let stated = self.deck.model.load_sets.iter().find(|s| s.sid == set);
        // If the deck lacks the load set, the results are from another deck and are not compared.
        let stated = stated?.loads.iter().map(|(f, load)| (*f, load));
        let acts = |l: &(f64, &Load)| l.0 != 0.0;
        if stated.filter(acts).eq(self.loads().filter(acts)) {
            return None;
        }
        Some(self.contradiction(
            format!("{} of the deck has other loads", self.subcase_in_words()),
            "correct `subcase` or `load_set` of the load, or name the deck that was run",
        ))
    }

    fn other_temperature(&self, set: u32) -> Option<Fault> {
        let selected = |s: &Subcase| s.load.is_some() || s.temperature_load.is_some();
        let is_it = |(factor, s): &(f64, &Subcase)| {
            *factor == 1.0 && (s.temperature_load, s.load) == (Some(set), None)
        };
        let [term] = self.terms.as_slice() else {
            return None;
        };
        if is_it(term) || !selected(term.1) {
            return None;
        }
        let heated = term.1.temperature_load.unwrap_or(0);
        Some(self.contradiction(
            format!(
                "{} of the deck has TEMPERATURE(LOAD) = {heated}",
                self.subcase_in_words()
            ),
            "correct `subcase` or `load_set` of the load, or solve a subcase with these temperatures alone",
        ))
    }

    /// Returns the load sets that the subcase selects.
    fn sids(&self) -> Vec<u32> {
        let sids = self.terms.iter().filter_map(|(_, s)| s.load);
        // `LOAD = NONE` is read as set 0.
        sids.filter(|sid| *sid != 0).collect()
    }

    /// Returns the subcase as text, such as `subcase 2 (LOAD = 77)`.
    fn subcase_in_words(&self) -> String {
        let terms = self.terms.iter();
        let sets: Vec<String> = terms
            .filter_map(|(factor, s)| {
                let sid = s.load?;
                Some(match *factor {
                    1.0 => format!("LOAD = {sid}"),
                    factor => format!("{} of LOAD = {sid}", format_number(factor)),
                })
            })
            .collect();
        match sets.is_empty() {
            true => format!("subcase {}", self.subcase.id),
            false => format!("subcase {} ({})", self.subcase.id, sets.join(", ")),
        }
    }

    fn contradiction(&self, of_deck: String, remedy: &str) -> Fault {
        let load = self.load;
        let stated = match load.acts {
            LoadActs::AtGrid {
                grid, component, ..
            } => format!(
                "{} at grid {grid}, applied = {}",
                component.name(),
                format_number(load.applied)
            ),
            LoadActs::Set(set) => format!("load set {set}"),
            LoadActs::Named => "named alone".to_owned(),
        };
        Fault::with_line(
            &*self.job.file,
            load.line,
            "load.subcase",
            format!(
                "job-contradicts-deck: load `{}` is {stated}; {of_deck}",
                load.name
            ),
            remedy,
        )
    }
}

/// Returns whether results with the label `results` may be from a subcase with the label `deck`. If the deck has no label, other programs write their
/// own.
fn may_be_of(deck: &str, results: &str) -> bool {
    let (deck, results) = (deck.trim(), results.trim());
    let own = results.is_empty() || results.to_ascii_uppercase().starts_with("SUBCASE");
    match deck.is_empty() {
        true => own,
        false => own || results.starts_with(deck) || deck.starts_with(results),
    }
}

fn agree(model: &Model, a: Resultant, b: Resultant) -> bool {
    let mut ends = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
    for g in &model.grids {
        ends = [ends[0].inf(&g.x), ends[1].sup(&g.x)];
    }
    let size = (ends[1] - ends[0]).norm();
    let force = a.force.norm().max(b.force.norm());
    let moment = a.moment.norm().max(b.moment.norm()).max(force * size);
    let by_size = if size > 0.0 { moment / size } else { 0.0 };
    (a.force - b.force).norm() <= AGREES * force.max(by_size)
        && (a.moment - b.moment).norm() <= AGREES * moment
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::context::InMemory;
    use crate::host::files::Inputs;
    use crate::strain_chain::deck::read_model;
    use crate::strain_chain::unit_loads;
    use std::path::Path;

    /// Deck of a bar of 2 m. Its loads are a force of 1000 along y at the tip, a moment of 50 as a couple of the ends, and gravity.
    const DECK: &str = "SOL 101\nCEND\nSUBCASE 1\nLABEL = tip\nLOAD = 1\nSUBCASE 2\nLABEL = couple\nLOAD = 2\nSUBCASE 3\nLOAD = 3\n\
        SUBCASE 4\nLOAD = 1\nTEMPERATURE(LOAD) = 7\nSUBCASE 5\nLOAD = 1\nTEMPERATURE(LOAD) = 8\n\
        SUBCASE 6\nLOAD = 1\nSPC = 61\nSUBCOM 7\nSUBSEQ = 1., 0., 0., 0., 0., 0.\nSUBCOM 8\nSUBSEQ = 2., 1., 0., 0., 0., 0.\n\
        SUBCASE 11\nLOAD = 11\nSUBCASE 12\nLOAD = 12\nSUBCASE 13\nLOAD = 13\n\
        SUBCASE 14\nLOAD = 1\nTEMPERATURE(LOAD) = 8\nTEMPERATURE(INITIAL) = 8\n\
        BEGIN BULK\nPBAR,1,1,.01,1.-5,1.-5,1.-5\nMAT1,1,1.+10,,.3,100.,1.-5,20.\nTEMPD,7,20.\nTEMPD,8,120.\n\
        SPC,6,1,3,.01\nSPCADD,60,6\nSPCADD,61,60\nLOAD,11,1.,1.,1,1.,3\nLOAD,12,1.,1.,1,1.,22\nRFORCE,22,,,10.,0.,1.,0.\nLOAD,13,1.,1.,1,0.,3\nGRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCBAR,1,1,1,2,0.,1.,0.\n\
        FORCE,1,2,,1000.,0.,1.,0.\nFORCE,2,2,,25.,0.,1.,0.\nFORCE,2,1,,-25.,0.,1.,0.\nGRAV,3,,9.81,0.,0.,-1.\nENDDATA\n";

    /// Returns the faults of a load with these keys, with the strain of a subcase with a label.
    fn faults(keys: &str, subcase: u32, label: &str) -> Vec<String> {
        let text = format!(
            "units = \"m-kg-s\"\n[model]\ndeck = \"bar.bdf\"\nresults = [\"bar.op2\"]\n[[load]]\nname = \"F\"\n{keys}\nsubcase = {subcase}\n"
        );
        let files = InMemory::default()
            .with_file("bar.bdf", DECK)
            .with_file("job.toml", text);
        let deck = read_model(&mut Inputs::new(&files), Path::new(""), "bar.bdf").unwrap();
        let job = Job::read("job.toml", &files).unwrap();
        let units = unit_loads(&job, &deck.model).unwrap();
        let case = CaseResult {
            subcase,
            label: label.to_owned(),
            ..CaseResult::default()
        };
        match check_deck_loads(&job, &deck, &units, [&case].into_iter()) {
            Ok(()) => Vec::new(),
            Err(faults) => faults.into_iter().map(|f| f.to_string()).collect(),
        }
    }

    #[test]
    fn a_load_of_another_grid_component_or_size_than_the_forces_of_its_subcase_is_refused() {
        let tip = "grid = 2\ncomponent = \"FY\"\napplied = 1000.0";
        assert!(faults(tip, 1, "tip").is_empty());
        for wrong in [
            "grid = 1\ncomponent = \"FY\"\napplied = 1000.0",
            "grid = 2\ncomponent = \"FZ\"\napplied = 1000.0",
            "grid = 2\ncomponent = \"FY\"\napplied = 1.0",
            "grid = 2\ncomponent = \"FY\"\napplied = -1000.0",
        ] {
            let found = faults(wrong, 1, "tip");
            assert_eq!(found.len(), 1, "{wrong}");
            assert!(found[0].contains("job-contradicts-deck"), "{found:?}");
            assert!(found[0].contains("LOAD = 1"), "{found:?}");
        }
    }

    #[test]
    fn a_couple_is_a_moment_wherever_it_is_stated() {
        let moment = |grid: u32, size: f64| {
            let keys = format!("grid = {grid}\ncomponent = \"MZ\"\napplied = {size}");
            faults(&keys, 2, "couple").len()
        };
        assert_eq!([moment(1, 50.0), moment(2, 50.0)], [0, 0]);
        assert_eq!([moment(1, -50.0), moment(1, 55.0)], [1, 1]);
    }

    #[test]
    fn results_of_other_decks_are_not_compared() {
        let wrong = "grid = 1\ncomponent = \"FX\"\napplied = 3.0";
        // The deck does not have the subcase, or the label.
        assert!(faults(wrong, 99, "").is_empty());
        assert!(faults(wrong, 1, "front left").is_empty());
        // A label that another program wrote does not identify the deck.
        assert_eq!(faults(wrong, 1, "SUBCASE 1").len(), 1);
        assert_eq!(faults(wrong, 1, "").len(), 1);
    }

    #[test]
    fn a_subcase_in_which_more_acts_than_the_unit_load_is_refused() {
        let tip = "grid = 2\ncomponent = \"FY\"\napplied = 1000.0";
        for (subcase, card) in [
            (3, "GRAV 3"),
            (5, "TEMPERATURE(LOAD) = 8"),
            (6, "SPC 6"),
            (11, "GRAV 3"),
            (12, "RFORCE 22"),
        ] {
            let found = faults(tip, subcase, "");
            assert_eq!(found.len(), 1, "{subcase}");
            let named = found[0].contains(card) && found[0].contains("`bar.bdf`:");
            assert!(named && found[0].contains("alone"), "{found:?}");
        }
        // Three loads do not act: temperatures at the reference, equal temperatures before and after, and a set with the factor 0.
        for subcase in [4, 13, 14] {
            assert!(faults(tip, subcase, "").is_empty(), "{subcase}");
        }
    }

    #[test]
    fn a_combination_is_the_sum_of_its_subcases() {
        let tip = "grid = 2\ncomponent = \"FY\"\napplied = 1000.0";
        assert!(faults(tip, 7, "").is_empty());
        let found = faults(tip, 8, "");
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("2 of LOAD = 1"), "{found:?}");
    }

    #[test]
    fn a_load_set_is_the_one_of_its_subcase_with_all_that_it_contains() {
        assert!(faults("load_set = 11", 11, "").is_empty());
        assert!(faults("load_set = 3", 3, "").is_empty());
        assert!(faults("load_set = 1", 13, "").is_empty());
        let found = faults("load_set = 2", 1, "tip");
        assert_eq!(found.len(), 1);
        assert!(
            found[0].contains("load set 2") && found[0].contains("LOAD = 1"),
            "{found:?}"
        );
        assert_eq!(faults("load_set = 1", 5, "").len(), 1);
        assert!(faults("load_set = 1", 4, "").is_empty());
    }
}
