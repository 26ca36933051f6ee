//! Loads of a job compared with the forces and moments of the subcases whose results they name.

use crate::fe::{CaseResult, UnitLoad};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::words::short;
use crate::job::{Job, JobLoad, LoadActs};
use crate::model::{Load, Model, Vec3};
use crate::strain_chain::deck::DeckModel;
use crate::strain_chain::solved::{is_combination, label_of};

/// Relative difference of forces and moments up to which job and deck agree: cards and jobs state four digits or more.
const AGREES: f64 = 1e-3;

/// Force, and moment about a point.
#[derive(Clone, Copy)]
struct Resultant {
    force: Vec3,
    moment: Vec3,
}

/// Refuses loads whose grid, component or size differ from the FORCE and MOMENT cards of their subcase: the result would belong to another load.
///
/// Compared are the force and the moment about the job's grid, so that a couple may stand for a moment. A subcase with other kinds of loads is
/// not compared, nor one whose label differs in the results: they are of another deck then.
///
/// # Errors
/// Every such load.
pub(super) fn check_deck_loads<'a>(
    job: &Job,
    deck: &DeckModel,
    units: &[UnitLoad],
    cases: impl Iterator<Item = &'a CaseResult>,
) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    for ((load, unit), case) in job.loads.iter().zip(units).zip(cases) {
        let UnitLoad::AtGrid {
            grid,
            force,
            moment,
        } = unit
        else {
            continue;
        };
        let Some(about) = deck.model.grids.get(grid.us()).map(|g| g.x) else {
            continue;
        };
        let stated = Resultant {
            force: *force,
            moment: *moment,
        };
        let Some((sid, of_deck)) = deck_resultant(deck, case, about) else {
            continue;
        };
        if !agree(&deck.model, stated, of_deck) {
            faults.push(contradiction(job, load, (case.subcase, sid), of_deck));
        }
    }
    Faults::check(faults)
}

/// Returns the load set of a case's subcase and its resultant about a point; `None` where the deck says nothing of it, or more than forces and
/// moments at grids.
fn deck_resultant(deck: &DeckModel, case: &CaseResult, about: Vec3) -> Option<(u32, Resultant)> {
    let subcases = deck.deck.case_control.effective_subcases();
    let subcase = subcases.iter().find(|s| s.id == case.subcase)?;
    if is_combination(subcase) || !may_be_of(&label_of(subcase), &case.label) {
        return None;
    }
    let sid = subcase.load?;
    let set = deck.model.load_sets.iter().find(|s| s.sid == sid)?;
    let mut sum = Resultant {
        force: Vec3::zeros(),
        moment: Vec3::zeros(),
    };
    for (factor, load) in &set.loads {
        match load {
            Load::Force(grid, v) => {
                let arm = deck.model.grids.get(grid.us())?.x - about;
                sum.force += v * *factor;
                sum.moment += arm.cross(v) * *factor;
            }
            Load::Moment(_, v) => sum.moment += v * *factor,
            _ => return None,
        }
    }
    (!set.loads.is_empty()).then_some((sid, sum))
}

/// Whether results with this label may be those of a subcase with that one; programs write a label of their own where the deck has none.
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

fn contradiction(
    job: &Job,
    load: &JobLoad,
    (subcase, sid): (u32, u32),
    of_deck: Resultant,
) -> Fault {
    let vector = |v: Vec3| format!("({}, {}, {})", short(v.x), short(v.y), short(v.z));
    let place = match load.acts {
        LoadActs::AtGrid {
            grid, component, ..
        } => format!("{} at grid {grid}", component.name()),
        _ => String::new(),
    };
    Fault::at(
        &*job.file,
        load.line,
        "load.subcase",
        format!(
            "job-contradicts-deck: load `{}` is {place}, applied = {}; subcase {subcase} of the deck (LOAD = {sid}) has force {} and moment {} about that grid",
            load.name,
            short(load.applied),
            vector(of_deck.force),
            vector(of_deck.moment)
        ),
        "correct `subcase`, `grid`, `component` or `applied` of the load, or name the deck that was run",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::context::InMemory;
    use crate::host::files::Inputs;
    use crate::strain_chain::deck::read_model;
    use crate::strain_chain::unit_loads;
    use std::path::Path;

    /// A force of 1000 along y at the tip of a bar of 2 m, a moment of 50 as a couple of the ends, and a subcase with gravity.
    const DECK: &str = "SOL 101\nCEND\nSUBCASE 1\nLABEL = tip\nLOAD = 1\nSUBCASE 2\nLABEL = couple\nLOAD = 2\nSUBCASE 3\nLOAD = 3\n\
        BEGIN BULK\nPBAR,1,1,.01,1.-5,1.-5,1.-5\nMAT1,1,1.+10,,.3,100.\nGRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCBAR,1,1,1,2,0.,1.,0.\n\
        FORCE,1,2,,1000.,0.,1.,0.\nFORCE,2,2,,25.,0.,1.,0.\nFORCE,2,1,,-25.,0.,1.,0.\nGRAV,3,,9.81,0.,0.,-1.\nENDDATA\n";

    /// The faults of a load with these keys, its strain taken from the case of a subcase with a label.
    fn faults(keys: &str, subcase: u32, label: &str) -> Vec<String> {
        let text = format!(
            "units = \"m-kg-s\"\n[model]\ndeck = \"bar.bdf\"\nresults = [\"bar.op2\"]\n[[load]]\nname = \"F\"\n{keys}\nsubcase = {subcase}\n"
        );
        let files = InMemory::default()
            .with("bar.bdf", DECK)
            .with("job.toml", text);
        let deck = read_model(&mut Inputs::of(&files), Path::new(""), "bar.bdf").unwrap();
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
    fn subcases_of_other_kinds_of_loads_and_results_of_other_decks_are_not_compared() {
        let wrong = "grid = 1\ncomponent = \"FX\"\napplied = 3.0";
        // Gravity, no such subcase, a label that the deck does not have.
        assert!(faults(wrong, 3, "").is_empty());
        assert!(faults(wrong, 4, "").is_empty());
        assert!(faults(wrong, 1, "front left").is_empty());
        // A program's own label says nothing of the deck.
        assert_eq!(faults(wrong, 1, "SUBCASE 1").len(), 1);
        assert_eq!(faults(wrong, 1, "").len(), 1);
    }
}
