//! The loads whose signatures a deck's model is solved for, and what their strain is in the frame.

use super::deck_thermal::{NOTHING, UnitTemperatureModel};
use super::influence::payload_grid;
use super::model_part::{ModelPart, nominal_x_m, nominal_y_m};
use crate::fe::UnitLoad;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::{Component, Job, LoadActs, LoadRole};
use crate::model::{GridIx, Model, Vec3};
use crate::reconcile::strain::{MassSignature, NuisanceLoad};
use crate::strain_chain::unit_loads;
use crate::units::KILO;

/// Side loads and moments that a wheel may transmit in addition to the wanted load.
const SIDE_COMPONENTS: [Component; 5] = [
    Component::FX,
    Component::FY,
    Component::MX,
    Component::MY,
    Component::MZ,
];

/// Loads to solve for: columns of the influence matrix, side loads, masses, heat, nuisance loads.
pub(super) struct SignatureLoads {
    /// All loads, in the order of the columns.
    pub(super) loads: Vec<UnitLoad>,
    /// Loads that are columns of S. They are the first of `loads`.
    pub(super) columns: Vec<UnitLoad>,
    /// Name and grid of each wanted load.
    wheels: Vec<(String, GridIx)>,
    /// Names of the side loads.
    besides: Vec<String>,
    /// Names of the places of masses.
    places: Vec<String>,
    first_heat: usize,
    first_nuisance: usize,
    nuisance: Vec<JobNuisance>,
    /// Whether no nuisance load of the job is the temperature set.
    heat_is_missing: bool,
}

impl SignatureLoads {
    /// # Errors
    /// Loads that cannot be applied to a model, or grids that the deck lacks.
    pub(super) fn from_job(job: &Job, heated: &UnitTemperatureModel) -> Result<Self, Faults> {
        let model = &heated.model;
        let JobLoads {
            wheels,
            columns,
            nuisance,
        } = job_loads(job, model)?;
        let mut loads = columns.clone();
        let mut besides = Vec::new();
        for (name, grid) in &wheels {
            // A side load that is a nuisance load of the job is not a missing effect.
            for c in SIDE_COMPONENTS
                .into_iter()
                .filter(|c| !has_nuisance(job, model, *grid, *c))
            {
                besides.push(format!(
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
        let known = |n: &JobNuisance| {
            Some(n.set) == reconcile.map(|r| r.temperature_set) && n.set.is_some()
        };
        Ok(Self {
            loads,
            columns,
            wheels,
            besides,
            places,
            first_heat,
            first_nuisance,
            heat_is_missing: !nuisance.iter().any(known),
            nuisance,
        })
    }

    /// Returns names, places and signatures of the loads. `column(c)` is the strain of load `c`. The caller adds gauges and influence.
    pub(super) fn part(
        &self,
        job: &Job,
        model: &Model,
        column: impl Fn(usize) -> Vec<f64>,
    ) -> ModelPart {
        let length_m = job.units.length_m();
        let place_of = |grid: &GridIx| {
            let x = model.grids.get(grid.us()).map_or(Vec3::zeros(), |g| g.x);
            [x[0] * length_m, x[1] * length_m]
        };
        let at_grid = payload_grid(job, model).map_or([0.0; 2], |g| place_of(&g));
        let first_beside = self.columns.len();
        let first_mass = first_beside + self.besides.len();
        let besides = self.besides.iter().enumerate();
        let masses = self.places.iter().enumerate();
        let nuisance = self.nuisance.iter().enumerate();
        ModelPart {
            load_names: self.wheels.iter().map(|w| w.0.clone()).collect(),
            load_positions: Some(self.wheels.iter().map(|w| place_of(&w.1)).collect()),
            payload_origin: [
                nominal_x_m(job).unwrap_or(at_grid[0]),
                nominal_y_m(job).unwrap_or(at_grid[1]),
            ],
            other_loads: besides
                .map(|(k, n)| (n.clone(), column(first_beside + k)))
                .collect(),
            masses: masses
                .map(|(k, place)| MassSignature {
                    place: place.clone(),
                    per_kg: column(first_mass + k),
                })
                .collect(),
            nuisance: nuisance
                .map(|(k, n)| NuisanceLoad {
                    name: n.name.clone(),
                    per_unit: column(self.first_nuisance + k)
                        .iter()
                        .map(|v| v / n.applied)
                        .collect(),
                    size: n.size,
                })
                .collect(),
            ..ModelPart::default()
        }
    }

    /// Returns the strain per degree in microstrain, for an even temperature and for the deck's temperature pattern. It is the mechanical strain of
    /// the model plus the apparent strain of the gauge (`apparent`). `rises` is the temperature of the pattern at each gauge.
    pub(super) fn thermal_strain(
        &self,
        heated: &UnitTemperatureModel,
        apparent: &[f64],
        rises: &[f64],
        column: impl Fn(usize) -> Vec<f64>,
    ) -> [Option<Vec<f64>>; 2] {
        let mechanical = |load: &Option<UnitLoad>, c: usize| load.as_ref().map(|_| column(c));
        let even: Vec<f64> = match mechanical(&heated.even, self.first_heat) {
            Some(m) => m.iter().zip(apparent).map(|(m, a)| m + a).collect(),
            None => apparent.to_vec(),
        };
        let pattern = self.first_heat + usize::from(heated.even.is_some());
        let along = mechanical(&heated.pattern, pattern)
            .filter(|_| self.heat_is_missing)
            .map(|m| {
                let besides = apparent.iter().zip(rises);
                m.iter().zip(besides).map(|(m, (a, t))| m + a * t).collect()
            });
        let shows = even.iter().any(|v| v.abs() > NOTHING);
        [shows.then_some(even), along]
    }
}

fn grid_of(job: &Job, model: &Model, id: u32) -> Result<GridIx, Faults> {
    let wrong = || {
        Faults::from(Fault::new(
            &*job.file,
            "grid",
            format!("the deck has no grid {id}"),
            "correct the id",
        ))
    };
    model.grid_ix(id).ok_or_else(wrong)
}

/// Returns the unit load of `size` kN or kN m at a grid, in the deck's units.
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

/// Loads of the job.
struct JobLoads {
    /// Name and grid of each wanted load.
    wheels: Vec<(String, GridIx)>,
    /// Columns of the influence matrix: each of these loads per kN or kN m, then the payload per kg. The payload columns are its weight, and the
    /// moments of a move by a metre (W dx about y, -W dy about x). Positive is forward and to the left.
    columns: Vec<UnitLoad>,
    nuisance: Vec<JobNuisance>,
}

/// A nuisance load of the job.
struct JobNuisance {
    name: String,
    /// Load of size `applied`.
    load: UnitLoad,
    applied: f64,
    /// One standard deviation, in the units of `applied`.
    size: f64,
    /// Id of the load set, if the load is a set of the deck.
    set: Option<u32>,
}

/// Returns the loads of the job in the axes of `cid`, as in every command. Loads at the payload's grid are left out, because the runs file records
/// the payload.
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
            (
                LoadActs::AtGrid {
                    grid, component, ..
                },
                LoadRole::Wanted,
            ) => {
                out.wheels
                    .push((l.name.clone(), grid_of(job, model, *grid)?));
                out.columns.push(scale_load(
                    &load,
                    KILO / (l.applied * job.units.si(component.quantity())),
                ));
            }
            (LoadActs::Set(sid), LoadRole::Wanted) => faults.push(Fault::with_line(
                &*job.file,
                l.line,
                "load.load_set",
                format!(
                    "load `{}` is load set {sid}, and `reconcile` does not accept load sets",
                    l.name
                ),
                "give the load as a grid and a component, or role = \"nuisance\"",
            )),
            (LoadActs::AtGrid { grid, .. }, LoadRole::Nuisance)
                if payload.is_some() && model.grid_ix(*grid) == payload => {}
            (LoadActs::Named, LoadRole::Wanted) => faults.push(Fault::with_line(
                &*job.file,
                l.line,
                "load.grid",
                format!(
                    "load `{}` has a name only: its place on the model is not stated",
                    l.name
                ),
                "state `grid` and `component`",
            )),
            (acts, LoadRole::Nuisance) => out.nuisance.push(JobNuisance {
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
    // Without a payload grid, the payload columns have no meaning and are blanked.
    let first = out.wheels.first().map_or(GridIx(0), |w| w.1);
    let at = payload.unwrap_or(first);
    out.columns.push(unit(job, at, Component::FZ, -weight));
    out.columns.push(unit(job, at, Component::MY, weight));
    out.columns.push(unit(job, at, Component::MX, -weight));
    // Bending is linear in the place. The column of the product term has no meaning and is blanked.
    out.columns.push(unit(job, at, Component::MX, -weight));
    Ok(out)
}

/// A load times `factor`; sets stay as they are.
fn scale_load(load: &UnitLoad, factor: f64) -> UnitLoad {
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

/// Returns whether the job has a nuisance load of this component at the grid, in the basic frame.
fn has_nuisance(job: &Job, model: &Model, at: GridIx, component: Component) -> bool {
    job.loads.iter().any(|l| match l.acts {
        LoadActs::AtGrid {
            grid,
            component: c,
            cid: 0,
        } => l.role == LoadRole::Nuisance && c == component && model.grid_ix(grid) == Some(at),
        _ => false,
    })
}
