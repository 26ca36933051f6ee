//! The static frame of a job with a deck: signatures of loads, masses, stiffness and gauge angles from the built-in solver.

use super::background::{Axis, ENTRY_SHARE, background, gradients};
use super::deck_thermal::{Heated, NOTHING};
use super::finer::Finer;
use super::frame_columns::FrameColumns;
use super::influence::{influence, payload_grid, readings};
use super::model_part::{ModelPart, facts, nominal_x_m, nominal_y_m};
use super::region::Region;
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::{Component, Job, JobLoad, LoadActs, Role};
use crate::app::solved::{support_of_job, unit_loads_kept};
use crate::app::strain::{Fields, Prepared, lay_gauges, prepare, unit_loads};
use crate::app::work::Work;
use crate::fe::UnitLoad;
use crate::finding::{Finding, Severity};
use crate::gauge::Gauge;
use crate::model::{GridIx, Model, Vec3};
use crate::reconcile::strain::{MassSignature, NuisanceLoad, PlaneStrainRow, Wiring};
use crate::stop::Stop;
use crate::units::KILO;

/// The model with everything needed to solve it again.
pub(super) struct DeckFrame {
    pub(super) fields: Fields,
    pub(super) gauges: Vec<Gauge>,
    pub(super) columns: Vec<UnitLoad>,
    /// Influence on the mesh as it stands, by the built-in solver.
    pub(super) base: Vec<f64>,
    /// Small regions whose stiffness is tried.
    pub(super) regions: Vec<Region>,
    /// Stops the solutions of changed models between two of them.
    pub(super) stop: Stop,
}

/// Solves all signatures. `channels` are the gauges in the order of the strain file.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    channels: &[String],
) -> Result<(ModelPart, DeckFrame), Faults> {
    let Prepared {
        sensitivity,
        fields: Some(fields),
        gauges,
        ..
    } = prepare(work, job)?
    else {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "model",
            "S comes from no model",
            "name the deck in [model]",
        )));
    };
    let gauges = in_order(job, gauges, channels)?;
    let s = FrameColumns::of(job, sensitivity, channels)?;
    // The same gauges turned: what they read at three angles holds their in-plane strain.
    let noted = work.findings.len();
    let mut turned = Vec::new();
    for degrees in [45.0, 90.0] {
        let mut other = job.clone();
        other.gauges.iter_mut().for_each(|g| g.angle_deg += degrees);
        turned.push(in_order(job, lay_gauges(work, &other, &fields)?, channels)?);
    }
    work.findings.truncate(noted);
    let model = fields.model();
    let heated = Heated::of(job, model)?;
    let model = &heated.model;
    let JobLoads {
        wheels,
        columns,
        nuisance,
    } = job_loads(job, model)?;
    let mut loads = columns.clone();
    let components = [
        Component::FX,
        Component::FY,
        Component::MX,
        Component::MY,
        Component::MZ,
    ];
    let mut other_names = Vec::new();
    for (name, grid) in &wheels {
        // A side load that the job has as a nuisance load is no effect that is missing.
        for c in components
            .into_iter()
            .filter(|c| !has_nuisance(job, model, *grid, *c))
        {
            other_names.push(format!(
                "{}_{}",
                c.name(),
                name.split('.').next().unwrap_or(name)
            ));
            loads.push(unit(job, *grid, c, 1.0));
        }
    }
    let reconcile = job.reconcile.as_ref();
    let gravity = job.gravity_m_s2();
    let mut places = Vec::new();
    for (place, id) in reconcile.iter().flat_map(|r| &r.places) {
        let grid = grid_of(job, model, *id)?;
        places.push(place.clone());
        loads.push(unit(job, grid, Component::FZ, -gravity / KILO));
    }
    let first_heat = loads.len();
    loads.extend(heated.loads());
    let first_nuisance = loads.len();
    loads.extend(nuisance.iter().map(|n| n.load.clone()));
    let support = support_of_job(job, model)?;
    // Signatures come from a mesh half as wide, where that can be made: what the mesh makes is computed, not guessed.
    let laid = [&gauges, &turned[0], &turned[1]];
    let finer = work.stage("refine", |_| Finer::of(model, laid));
    if let Err(why) = &finer {
        work.findings.push(mesh_unknown(job, why));
    }
    let finer = finer.ok();
    let heat = format!("temperature set {:?}", reconcile.map(|r| r.temperature_set));
    let solution = work.stage("solve signatures", |w| match &finer {
        Some(f) => {
            let made = format!("mesh half as wide, {heat}");
            unit_loads_kept(
                w,
                (&fields.deck, &made),
                (&f.refined.model, support),
                &loads,
            )
        }
        None => unit_loads_kept(w, (&fields.deck, &heat), (model, support), &loads),
    })?;
    let n_c = columns.len();
    let [seen, seen_45, seen_90] = match &finer {
        Some(f) => f.laid.each_ref(),
        None => laid,
    };
    let table = influence(job, model, seen, &solution, n_c);
    let at_45 = influence(job, model, seen_45, &solution, n_c);
    let at_90 = influence(job, model, seen_90, &solution, n_c);
    let own = work.stage("solve signatures", |w| {
        unit_loads_kept(w, (&fields.deck, &heat), (model, support), &columns)
    })?;
    let mut base = influence(job, model, &gauges, &own, n_c);
    let n_g = gauges.len();
    // S is that of the job: where its results are Nastran's, the built-in solver has the rest.
    for (c, (_, column)) in s.wanted_columns().iter().enumerate() {
        for (row, v) in base.chunks_exact_mut(n_c).zip(column) {
            row[c] = *v;
        }
    }
    let mut table = table;
    let from_results = job.model.as_ref().is_some_and(|m| !m.results.is_empty());
    if from_results && finer.is_none() {
        table.clone_from(&base);
    }
    let plane = |g: usize| -> PlaneStrainRow {
        let one = |c: usize| {
            let i = g * n_c + c;
            [table[i], at_90[i], 2.0 * at_45[i] - table[i] - at_90[i]]
        };
        (0..n_c).map(one).collect()
    };
    let column = |c: usize| readings(seen, &solution, c..c + 1);
    let length_m = job.units.length_m();
    let place_of = |grid: &GridIx| {
        let x = model.grids.get(grid.us()).map_or(Vec3::zeros(), |g| g.x);
        [x[0] * length_m, x[1] * length_m]
    };
    let at_grid = payload_grid(job, model).map_or([0.0; 2], |g| place_of(&g));
    let mut part = ModelPart {
        gauges: channels.iter().map(|c| facts(job, c)).collect(),
        load_names: wheels.iter().map(|w| w.0.clone()).collect(),
        load_positions: Some(wheels.iter().map(|w| place_of(&w.1)).collect()),
        influence: table.clone(),
        tensors: (0..n_g).map(plane).collect(),
        payload_origin: [
            nominal_x_m(job).unwrap_or(at_grid[0]),
            nominal_y_m(job).unwrap_or(at_grid[1]),
        ],
        ..ModelPart::default()
    };
    for (g, laid) in part.gauges.iter_mut().zip(&gauges) {
        // In-plane strain is in the axes of the gauge itself, its wiring included.
        g.angle_deg = 0.0;
        g.wiring = Wiring::Quarter;
        g.position = Some([0, 1, 2].map(|k| laid.position[k] * length_m));
    }
    part.other_loads = other_names
        .into_iter()
        .enumerate()
        .map(|(k, n)| (n, column(n_c + k)))
        .collect();
    let first_mass = n_c + part.other_loads.len();
    part.masses = places
        .into_iter()
        .enumerate()
        .map(|(k, place)| MassSignature {
            place,
            per_kg: column(first_mass + k),
        })
        .collect();
    part.nuisance = nuisance
        .iter()
        .enumerate()
        .map(|(k, n)| NuisanceLoad {
            name: n.name.clone(),
            per_unit: column(first_nuisance + k)
                .iter()
                .map(|v| v / n.applied)
                .collect(),
            size: n.size,
        })
        .collect();
    // Microstrain a degree: mechanical strain from the model, and what the gauge shows of heat besides.
    let apparent: Vec<f64> = channels.iter().map(|c| apparent(job, c)).collect();
    let mechanical = |load: &Option<UnitLoad>, c: usize| load.as_ref().map(|_| column(c));
    let even = mechanical(&heated.even, first_heat);
    let even: Vec<f64> = match even {
        Some(m) => m.iter().zip(&apparent).map(|(m, a)| m + a).collect(),
        None => apparent.clone(),
    };
    part.thermal_uniform = even.iter().any(|v| v.abs() > NOTHING).then_some(even);
    let pattern = first_heat + usize::from(heated.even.is_some());
    let known =
        |n: &JobNuisance| Some(n.set) == reconcile.map(|r| r.temperature_set) && n.set.is_some();
    let missing = !nuisance.iter().any(known);
    part.thermal_gradient = mechanical(&heated.pattern, pattern)
        .filter(|_| missing)
        .map(|m| {
            let besides = apparent.iter().zip(heated.rises(&gauges));
            m.iter().zip(besides).map(|(m, (a, t))| m + a * t).collect()
        });
    let along = gradients(job, model, &gauges, &own, n_c, Axis::Along);
    let across = gradients(job, model, &gauges, &own, n_c, Axis::Across);
    part.scatter = background(
        job,
        &part,
        finer.is_some().then_some(&base),
        [&along, &across],
    );
    part.per_mm = Some(along);
    part.as_modelled = finer.is_some().then(|| base.clone());
    let own = influence(job, model, &gauges, &own, n_c);
    let deck = DeckFrame {
        fields,
        gauges,
        columns,
        base: own,
        regions: vec![],
        stop: work.cx.progress.stop(),
    };
    part.stiffness = work.stage("solve zones", |_| deck.signatures(job))?;
    // Tables count in microstrain per unit of the job, as sensitivity.csv does.
    let wanted = job.loads.iter().filter(|l| l.role == Role::Wanted);
    let per = |l: &JobLoad| match l.acts {
        LoadActs::AtGrid { component, .. } => KILO / job.units.si(component.quantity()),
        LoadActs::Set(_) | LoadActs::Named => 1.0,
    };
    let known: Vec<(String, f64)> = wanted.map(|l| (l.name.clone(), per(l))).collect();
    let described = deck.described(&mut work.inputs, job, channels, &known)?;
    part.stiffness.extend(described);
    Ok((part, deck))
}

/// Apparent strain of a channel's wiring, microstrain a degree.
fn apparent(job: &Job, channel: &str) -> f64 {
    let bridge = job
        .gauges
        .iter()
        .find(|g| g.name == channel)
        .map_or("quarter", |g| g.bridge.name());
    let given = job.reconcile.as_ref();
    given
        .and_then(|r| r.thermal_microstrain_per_degc.get(bridge).copied())
        .unwrap_or(0.0)
}

/// Channels in the order of the strain file.
fn in_order(job: &Job, laid: Vec<Gauge>, channels: &[String]) -> Result<Vec<Gauge>, Faults> {
    let find = |name: &String| {
        laid.iter()
            .find(|g| g.name == *name)
            .cloned()
            .ok_or_else(|| {
                let wrong = format!("the strain file has a column `{name}`, the job no such gauge");
                Fault::of(&*job.file, "gauge", wrong, "name the gauges as the columns")
            })
    };
    let (mut out, mut faults) = (Vec::new(), FaultList::new());
    for name in channels {
        match find(name) {
            Ok(g) => out.push(g),
            Err(f) => faults.push(f),
        }
    }
    Faults::check(faults)?;
    Ok(out)
}

fn grid_of(job: &Job, model: &Model, id: u32) -> Result<GridIx, Faults> {
    let wrong = || {
        Faults::from(Fault::of(
            &*job.file,
            "grid",
            format!("the deck has no grid {id}"),
            "correct the id",
        ))
    };
    model.grid_ix(id).ok_or_else(wrong)
}

/// `size` kN or kN m at a grid, in the deck's units.
pub(super) fn unit(job: &Job, grid: GridIx, component: Component, size: f64) -> UnitLoad {
    let v = Vec3::from(component.vector(size * KILO / job.units.si(component.quantity())));
    let (force, moment) = if component.is_force() {
        (v, Vec3::zeros())
    } else {
        (Vec3::zeros(), v)
    };
    UnitLoad::AtGrid {
        grid,
        force,
        moment,
    }
}

/// What the job says of its loads.
struct JobLoads {
    /// Name and grid of each load that is asked for.
    wheels: Vec<(String, GridIx)>,
    /// Columns of the influence matrix: each of these loads per kN or kN m, then the payload per kg: its weight, and the moments that
    /// moving it by a metre forward and to the left brings (W dx about y, -W dy about x).
    columns: Vec<UnitLoad>,
    nuisance: Vec<JobNuisance>,
}

/// A nuisance load of the job.
struct JobNuisance {
    name: String,
    /// Of size `applied`.
    load: UnitLoad,
    applied: f64,
    /// One standard deviation, in the units of `applied`.
    size: f64,
    /// Its set, where it is one of the deck.
    set: Option<u32>,
}

/// The loads as every command has them, in the axes of `cid`; those at the payload's grid are left out, since the runs note the payload.
fn job_loads(job: &Job, model: &Model) -> Result<JobLoads, Faults> {
    let mut out = JobLoads {
        wheels: Vec::new(),
        columns: Vec::new(),
        nuisance: Vec::new(),
    };
    let mut faults = FaultList::new();
    if let Some(id) = job.payload_grid() {
        grid_of(job, model, id)?;
    }
    let payload = payload_grid(job, model);
    for (l, load) in job.loads.iter().zip(unit_loads(job, model)?) {
        match (&l.acts, l.role) {
            (LoadActs::AtGrid { grid, component, .. }, Role::Wanted) => {
                out.wheels.push((l.name.clone(), grid_of(job, model, *grid)?));
                out.columns.push(scaled(&load, KILO / (l.applied * job.units.si(component.quantity()))));
            }
            (LoadActs::Set(sid), Role::Wanted) => faults.push(Fault::at(
                &*job.file,
                l.line,
                "load.load_set",
                format!("load `{}` is load set {sid}: how much of a set acts in a run, `reconcile` does not read", l.name),
                "give the load as a grid and a component, or role = \"nuisance\"",
            )),
            (LoadActs::AtGrid { grid, .. }, Role::Nuisance) if payload.is_some() && model.grid_ix(*grid) == payload => {}
            (LoadActs::Named, Role::Wanted) => faults.push(Fault::at(
                &*job.file,
                l.line,
                "load.grid",
                format!("load `{}` is a name alone: where it acts on the model is not said", l.name),
                "state `grid` and `component`",
            )),
            (acts, Role::Nuisance) => out.nuisance.push(JobNuisance {
                name: l.name.clone(),
                load,
                applied: l.applied,
                size: l.expected.unwrap_or(l.applied.abs()),
                set: match acts {
                    LoadActs::Set(sid) => Some(*sid),
                    LoadActs::AtGrid { .. } | LoadActs::Named => None,
                },
            }),
        }
    }
    Faults::check(faults)?;
    let weight = job.gravity_m_s2() / KILO;
    // Without a payload grid its columns stand for nothing and are blanked.
    let first = out.wheels.first().map_or(GridIx(0), |w| w.1);
    let at = payload.unwrap_or(first);
    out.columns.push(unit(job, at, Component::FZ, -weight));
    out.columns.push(unit(job, at, Component::MY, weight));
    out.columns.push(unit(job, at, Component::MX, -weight));
    // Bending is linear in the place: the product term stands for nothing and is blanked.
    out.columns.push(unit(job, at, Component::MX, -weight));
    Ok(out)
}

/// A load times `factor`; sets stay as they are.
fn scaled(load: &UnitLoad, factor: f64) -> UnitLoad {
    match load {
        UnitLoad::AtGrid {
            grid,
            force,
            moment,
        } => UnitLoad::AtGrid {
            grid: *grid,
            force: force * factor,
            moment: moment * factor,
        },
        other => other.clone(),
    }
}

/// Has the job a nuisance load of this component at the grid, in the basic frame?
fn has_nuisance(job: &Job, model: &Model, at: GridIx, component: Component) -> bool {
    job.loads.iter().any(|l| match l.acts {
        LoadActs::AtGrid {
            grid,
            component: c,
            cid: 0,
        } => l.role == Role::Nuisance && c == component && model.grid_ix(grid) == Some(at),
        _ => false,
    })
}

/// No finer mesh was solved: what is assumed instead.
fn mesh_unknown(job: &Job, why: &str) -> Finding {
    let stated = job
        .measured
        .as_ref()
        .map_or(0.0, |m| m.model_uncertainty_rel);
    Finding::new(
        Severity::Warning,
        "mesh-not-checked",
        "model",
        format!(
            "what the mesh makes of the strain is not known, since no finer mesh was solved: {why}. Each influence coefficient is taken to err by {:.2} % (1 sd), {:.0} % of the stated model uncertainty",
            100.0 * ENTRY_SHARE * stated,
            100.0 * ENTRY_SHARE
        ),
        "compare the strain at the gauges with that of a finer mesh, and state `model_uncertainty_rel` accordingly",
    )
}
