//! Additional loads of the extended job of a deck: side loads at the named wheels, and the payload, which strains the structure in every run.

use crate::job::{Component, Job, LoadActs};
use crate::reconcile::NamedEffect;
use crate::reconcile::effect::{Extension, Nuisance};
use crate::reconcile::strain::StrainFrame;
use crate::units::{KILO, number};
use nastran::bdf::{Field, format_card};
use toml::{Table, Value};

/// A load component at a grid, with its size in kN or kN m.
pub(super) struct SideLoad {
    name: String,
    grid: u32,
    component: Component,
    /// Usual size: one standard deviation before a run is seen.
    usual: f64,
    /// Root mean square over the runs; the usual size if the runs do not determine it.
    found: f64,
}

const COMPONENTS: [Component; 5] = [
    Component::FX,
    Component::FY,
    Component::MX,
    Component::MY,
    Component::MZ,
];
/// Moment of the payload per weight if no place is recorded: half a metre off its grid, one standard deviation.
const OFF_GRID_M: f64 = 0.5;
/// Error of a recorded payload mass, one standard deviation, as a share: two per cent of a vehicle's scale.
const RECORDED_MASS_REL: f64 = 0.02;
/// Error of a recorded payload place, m, one standard deviation.
const RECORDED_PLACE_M: f64 = 0.05;

/// Returns the side loads of the effects, by the grids of the job's wheels.
pub(super) fn side_loads(job: &Job, effects: &[NamedEffect]) -> Vec<SideLoad> {
    let mut out = Vec::new();
    for e in effects {
        let Extension::NuisanceLoads {
            source: Nuisance::SideLoads,
            loads,
            ..
        } = &e.extension
        else {
            continue;
        };
        for (name, usual) in loads {
            let Some((word, wheel)) = name.split_once('_') else {
                continue;
            };
            let kind = COMPONENTS.iter().position(|c| c.name() == word);
            let (Some(kind), Some(grid)) = (kind, grid_of_wheel(job, wheel)) else {
                continue;
            };
            let found = e.size.get(kind).copied().filter(|s| *s > 0.0);
            out.push(SideLoad {
                name: format!("{wheel}.{word}"),
                grid,
                component: COMPONENTS[kind],
                usual: *usual,
                found: found.unwrap_or(*usual),
            });
        }
    }
    out
}

/// Returns the sizes of side loads as text, one for each component.
pub(super) fn sizes_by_component(sizes: &[f64]) -> String {
    let word = |(c, size): (&Component, &f64)| {
        let unit = match c.is_force() {
            true => "kN",
            false => "kN m",
        };
        format!("{} {} {unit}", c.name(), number(*size))
    };
    let list: Vec<String> = COMPONENTS.iter().zip(sizes).map(word).collect();
    list.join(", ")
}

/// Returns the component at the beginning or end of a load's name. It is `FZ` if the name has none (a temperature).
pub(super) fn component_word(name: &str) -> &'static str {
    let has = |c: &Component| name.starts_with(c.name()) || name.ends_with(c.name());
    COMPONENTS
        .iter()
        .find(|c| has(c))
        .map_or("FZ", |c| c.name())
}

fn grid_of_wheel(job: &Job, wheel: &str) -> Option<u32> {
    job.loads.iter().find_map(|l| match l.acts {
        LoadActs::AtGrid { grid, .. } if l.name.split('.').next() == Some(wheel) => Some(grid),
        _ => None,
    })
}

/// Returns the `[[load]]` entries of the side loads and of the payload, `role = "nuisance"`.
pub(super) fn entries(job: &Job, frame: &StrainFrame, side: &[SideLoad]) -> Vec<Value> {
    let entry = |name: &str, grid: u32, component: Component, size: f64| {
        let mut t = Table::new();
        t.insert("name".into(), Value::String(name.into()));
        t.insert("grid".into(), Value::Integer(i64::from(grid)));
        t.insert("component".into(), Value::String(component.name().into()));
        t.insert("role".into(), Value::String("nuisance".into()));
        t.insert(
            "expected".into(),
            Value::Float(in_job_units(job, component, size)),
        );
        Value::Table(t)
    };
    let mut out: Vec<Value> = side
        .iter()
        .map(|s| entry(&s.name, s.grid, s.component, s.usual))
        .collect();
    let taken = |grid: u32| {
        job.loads
            .iter()
            .any(|l| matches!(l.acts, LoadActs::AtGrid { grid: g, .. } if g == grid))
    };
    let heaviest = frame.payload.iter().map(|p| p[0].abs()).fold(0.0, f64::max);
    if let Some(grid) = job.payload.as_ref().and_then(|p| p.grid)
        && heaviest > 0.0
        && !taken(grid)
    {
        // `recover` reads the payload of each run from the runs file. These sizes cover its remaining uncertainty.
        let weight = heaviest * job.gravity_m_s2() / KILO;
        let placed = frame.payload.iter().any(|p| p[1] != 0.0 || p[2] != 0.0);
        let off = if placed { RECORDED_PLACE_M } else { OFF_GRID_M };
        for (component, size) in [
            (Component::FZ, weight * RECORDED_MASS_REL),
            (Component::MX, weight * off),
            (Component::MY, weight * off),
        ] {
            let name = format!("payload.{}", component.name());
            out.push(entry(&name, grid, component, size));
        }
    }
    out
}

/// Returns the FORCE and MOMENT cards of load set `sid` with the sizes that were found.
pub(super) fn cards(job: &Job, sid: u32, side: &[SideLoad]) -> String {
    let mut out = String::new();
    for s in side {
        let dof = s.component.dof();
        let card = if dof < 3 { "FORCE" } else { "MOMENT" };
        let mut fields = vec![
            Field::from(sid),
            s.grid.into(),
            0u32.into(),
            in_job_units(job, s.component, s.found).into(),
        ];
        fields.extend((0..3).map(|k| Field::from(if k == dof % 3 { 1.0 } else { 0.0 })));
        out.push_str(&format_card(card, &fields));
    }
    out
}

fn in_job_units(job: &Job, component: Component, kilo: f64) -> f64 {
    kilo * KILO / job.units.si(component.quantity())
}
