//! The scene of a job: the job's unit loads as strain and arrows, gauges, recovered loads.

use super::types::{Arrow, ArrowSet, Field, FieldValues, Mark, PickTargets, Places, Scene, Twist};
use crate::fe::{LoadCase, Solution, UnitLoad};
use crate::job::{Job, LoadActs};
use crate::model::{GridIx, Load, Model, Vec3};
use crate::placement::Role;
use crate::reconcile::ChannelGap;
use crate::report::page::number;
use crate::report::strain::RecoveredRun;
use crate::strain_chain::{Fields, JobSensitivity, LoadUnits, load_units};
use crate::units::Quantity;
use crate::workflow::place::PlacedGauge;

/// Load cases to choose from, and runs.
const MOST_FIELDS: usize = 24;
const MOST_RUNS: usize = 100;
/// Arrows of one load set.
const MOST_OF_SET: usize = 60;

/// Returns the scene of a job with a model, its gauges and its unit loads.
pub fn scene_of_job<'a>(job: &Job, prepared: &'a JobSensitivity) -> Option<Scene<'a>> {
    let fields = prepared.fields.as_ref()?;
    let mark = |g| Mark::from_gauge(g, String::new());
    Some(scene_of(
        job,
        fields,
        prepared.gauges.iter().map(mark).collect(),
    ))
}

/// Returns the scene of a job's model with these gauges.
pub fn scene_of<'a>(job: &Job, fields: &'a Fields, marks: Vec<Mark>) -> Scene<'a> {
    Scene {
        marks,
        fields: fields_of(job, fields),
        caption: "Colour shows the strain that one unit load causes: a gauge on a darker place reads more of this load, which is better."
            .to_owned(),
        ..scene_of_loads(job, fields.model())
    }
}

/// Returns the scene of a model with the loads of a job, before any strain is known.
pub fn scene_of_loads<'a>(job: &Job, model: &'a Model) -> Scene<'a> {
    let arrows = job.loads.iter().flat_map(|l| match l.acts {
        LoadActs::Set(sid) => arrows_of_set(model, sid),
        LoadActs::Named => Vec::new(),
        LoadActs::AtGrid { grid, .. } => {
            let label = format!("{}, grid {grid}", l.name);
            let arrow = locate_load(job, model, &l.name).map(|(at, along, twist)| Arrow {
                at,
                along,
                twist,
                value: 1.0,
                label,
            });
            arrow.into_iter().collect()
        }
    });
    Scene {
        model,
        marks: Vec::new(),
        fields: Vec::new(),
        arrows: list_unless_empty(ArrowSet {
            name: "all unit loads".into(),
            arrows: arrows.collect(),
        }),
        length: job.units.unit(Quantity::Length).name,
        pointing: PickTargets::Nothing,
        caption: "Arrows show where the loads of the job act and their directions: an arrow in a wrong place makes every result wrong."
            .to_owned(),
    }
}

fn list_unless_empty(set: ArrowSet) -> Vec<ArrowSet> {
    if set.arrows.is_empty() {
        Vec::new()
    } else {
        vec![set]
    }
}

/// Returns the strain per unit load, microstrain per report unit.
pub fn fields_of<'a>(job: &Job, fields: &'a Fields) -> Vec<Field<'a>> {
    let names: Vec<String> = job.loads.iter().map(|l| l.name.clone()).collect();
    let units: Vec<LoadUnits> = load_units(job, &names);
    fields
        .load_cases(job)
        .into_iter()
        .zip(units)
        .take(MOST_FIELDS)
        .map(|(l, u)| Field {
            name: l.load.name,
            unit: if u.name.is_empty() {
                "µε".into()
            } else {
                format!("µε per {}", u.name)
            },
            values: FieldValues::Strain(l.case),
            scale: 1e6 / l.applied / u.factor,
        })
        .collect()
}

/// Returns the place of load `name`, its unit vector in the basic frame and its kind. `None` for a load set.
fn locate_load(job: &Job, model: &Model, name: &str) -> Option<(Vec3, Vec3, Twist)> {
    let load = job.loads.iter().find(|l| l.name == name)?;
    let LoadActs::AtGrid {
        grid,
        component,
        cid,
    } = load.acts
    else {
        return None;
    };
    let at = model.grids.get(model.grid_ix(grid)?.us())?.x;
    let frame = model.frames.get(model.frame_ix(cid)?.us())?;
    let v = component.vector(1.0);
    let twist = if component.is_force() {
        Twist::Force
    } else {
        Twist::Moment
    };
    Some((at, frame.vector_to_basic(v, at), twist))
}

/// Meaning of the three numbers of a recovered load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadRange {
    /// Lower end of the interval, value, upper end: a set of arrows a run.
    Interval,
    /// Smallest, mean, largest of a history: a set of arrows each.
    Extremes,
}

/// Returns the recovered loads as arrows.
pub fn run_arrows(
    job: &Job,
    model: &Model,
    runs: &[RecoveredRun],
    shown: LoadRange,
) -> Vec<ArrowSet> {
    let set = |name: String, run: &RecoveredRun, k: usize| ArrowSet {
        name,
        arrows: run
            .loads
            .iter()
            .filter_map(|(name, v, unit)| {
                let (at, along, twist) = locate_load(job, model, name)?;
                let value = v[k];
                let label = match shown {
                    LoadRange::Interval => format!(
                        "{name}: {} {unit} ({} to {})",
                        number(value),
                        number(v[0]),
                        number(v[2])
                    ),
                    LoadRange::Extremes => format!("{name}: {} {unit}", number(value)),
                };
                value.is_finite().then_some(Arrow {
                    at,
                    along,
                    twist,
                    value,
                    label,
                })
            })
            .collect(),
    };
    let runs = runs.iter().take(MOST_RUNS);
    runs.flat_map(|run| match shown {
        LoadRange::Interval => vec![set(format!("run {}", run.run), run, 1)],
        LoadRange::Extremes => [(2, "largest"), (1, "mean"), (0, "smallest")]
            .map(|(k, word)| set(format!("{word} of the record"), run, k))
            .to_vec(),
    })
    .filter(|s| !s.arrows.is_empty())
    .collect()
}

/// Forces and moments of a load set of the deck.
fn arrows_of_set(model: &Model, sid: u32) -> Vec<Arrow> {
    let sets = model.load_sets.iter().filter(|s| s.sid == sid);
    let all: Vec<(GridIx, Vec3, Twist)> = sets
        .flat_map(|s| &s.loads)
        .filter_map(|(scale, load)| match load {
            Load::Force(g, v) => Some((*g, *scale * *v, Twist::Force)),
            Load::Moment(g, v) => Some((*g, *scale * *v, Twist::Moment)),
            _ => None,
        })
        .collect();
    let stride = all.len().div_ceil(MOST_OF_SET).max(1);
    all.into_iter()
        .step_by(stride)
        .filter_map(|(grid, v, twist)| arrow_at(model, grid, v, twist))
        .collect()
}

fn arrow_at(model: &Model, grid: GridIx, v: Vec3, twist: Twist) -> Option<Arrow> {
    let g = model.grids.get(grid.us())?;
    Some(Arrow {
        at: g.x,
        along: v.try_normalize(0.0)?,
        twist,
        value: v.norm(),
        label: format!("{} at grid {}", number(v.norm()), g.id),
    })
}

/// Returns the scene of a solution: strain and loads of every case, in the deck's units.
pub fn scene_of_solution<'a>(
    model: &'a Model,
    cases: &[LoadCase],
    solution: &'a Solution,
) -> Scene<'a> {
    let name = |subcase: u32, label: &str| format!("{subcase} {label}").trim().to_owned();
    let fields = solution.cases.iter().take(MOST_FIELDS).map(|c| Field {
        name: name(c.subcase, &c.label),
        unit: "µε".into(),
        values: FieldValues::Strain(c),
        scale: 1e6,
    });
    let arrows = cases.iter().take(MOST_FIELDS).flat_map(|case| {
        let arrows = case.loads.iter().flat_map(|load| match load {
            UnitLoad::AtGrid {
                grid,
                force,
                moment,
            } => [(force, Twist::Force), (moment, Twist::Moment)]
                .into_iter()
                .filter_map(|(v, twist)| arrow_at(model, *grid, *v, twist))
                .collect(),
            UnitLoad::Set(sid) => arrows_of_set(model, *sid),
            UnitLoad::Temperature { .. } => Vec::new(),
        });
        list_unless_empty(ArrowSet {
            name: name(case.subcase, &case.label),
            arrows: arrows.collect(),
        })
    });
    Scene {
        model,
        marks: Vec::new(),
        fields: fields.collect(),
        arrows: arrows.collect(),
        length: "",
        pointing: PickTargets::Nothing,
        caption: "Colour shows the strain of one load case: gauges on darker places read more, which is better.".to_owned(),
    }
}

/// Returns the scene of a model alone, to plan where gauges may go.
pub fn scene_of_model<'a>(model: &'a Model, places: Places) -> Scene<'a> {
    Scene {
        model,
        marks: Vec::new(),
        fields: Vec::new(),
        arrows: Vec::new(),
        length: "",
        pointing: PickTargets::Places(places),
        caption: "The structure as the deck describes it: a part that is absent or detached here makes every result wrong.".to_owned(),
    }
}

/// Returns a gauge of a plan.
pub fn placed_mark(p: &PlacedGauge) -> Mark {
    let kept = if p.role == Role::Validation {
        ", for validation"
    } else {
        ""
    };
    let note = format!(
        "{:.1}° as seen, {}{kept}, leverage {:.3}, {:.0} µε under the expected loads",
        p.angle_seen_deg, p.bridge, p.leverage, p.expected_microstrain
    );
    Mark::from_gauge(&p.gauge, note)
}

/// Returns the mark of a gauge with its gap.
pub fn mark_of_gap(at: Vec3, gap: &ChannelGap) -> Mark {
    Mark {
        name: gap.channel.clone(),
        at,
        axes: None,
        surface: None,
        note: format!(
            "gap {} µε before, {} after, floor {}",
            number(gap.before),
            number(gap.after),
            number(gap.floor)
        ),
        gap: Some([gap.before, gap.after]),
    }
}
