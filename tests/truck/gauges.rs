//! Gauges on the trucks: candidates, layouts, and readings on this model and on the other model.

use crate::world::{Lot, Truck, analyst_truck};
use std::sync::OnceLock;
use strainbridge::fe::CaseResult;
use strainbridge::gauge::{CornerRows, Gauge, GaugePlace, GaugeSpec, build, gauge_reading};
use strainbridge::linalg::Matrix;
use strainbridge::model::{Model, ShellIx, Vec3};
use strainbridge::placement::candidates::{Angles, Candidates, Scatter};
use strainbridge::placement::sites::{Site, candidates};
use strainbridge::placement::{Layout, Spec, place};
use strainbridge::sensitivity::{Load, LoadCaseOf, Sensitivity, from_cases};

pub const MICRO: f64 = 1e-6;
/// Expected size of a wheel load, N.
pub const EXPECTED: f64 = 25_000.0;

/// Returns the rails and cross members, where gauges can be glued.
pub fn sites(model: &Model) -> Vec<Site> {
    use strainbridge::fe::strain_tensor::Surface;
    let allowed =
        |id: u32| (11..=15).contains(&id) || (21..=25).contains(&id) || (31..=37).contains(&id);
    let joints = joints(model);
    let clear = |x: Vec3| joints.iter().all(|j| (j - x).norm() > CLEARANCE);
    let mut out = Vec::new();
    for (i, s) in model.shells.iter().enumerate() {
        let x = strainbridge::gauge::centre(model, s).unwrap();
        if allowed(model.shell_properties[s.property.us()].id) && clear(x) {
            out.extend([Surface::Bottom, Surface::Top].map(|side| (ShellIx(i as u32), side)));
        }
    }
    out
}

/// Least distance of a gauge from a joint, mm. Close to it, the rigid elements of a joint strain the plate differently
/// from a bolt.
pub const CLEARANCE: f64 = 110.0;

/// Returns the grids of bolts and brackets (rigid elements). Wide RBE3 elements of masses and payload are omitted, as
/// each grid takes little force.
fn joints(model: &Model) -> Vec<Vec3> {
    model
        .rigids
        .iter()
        .filter_map(|r| match &r.kind {
            strainbridge::model::RigidKind::Body { dependent, .. } => Some(dependent),
            strainbridge::model::RigidKind::Mean { .. }
            | strainbridge::model::RigidKind::Equations { .. } => None,
        })
        .flatten()
        .map(|d| model.grids[d.0.us()].x)
        .collect()
}

/// Returns the columns of S: cases with names and sizes.
pub fn columns<'a>(cases: &'a [CaseResult], names: &[&str], expected: f64) -> Vec<LoadCaseOf<'a>> {
    cases
        .iter()
        .zip(names)
        .map(|(case, name)| LoadCaseOf {
            load: Load {
                name: (*name).to_owned(),
                expected: Some(expected),
                wanted: true,
                quantity: None,
            },
            applied: 1.0,
            case,
        })
        .collect()
}

/// Returns the six vertical wheel loads of a truck.
pub fn vertical_load_cases(truck: &Truck) -> Vec<LoadCaseOf<'_>> {
    columns(&truck.standing.contacts, &crate::world::NAMES, EXPECTED)
}

/// Returns the candidates of a truck for given columns, in microstrain at the expected loads divided by 1 microstrain
/// of noise.
pub fn candidates_of(
    truck: &Truck,
    loads: &[LoadCaseOf],
    scatter: Scatter,
) -> (Vec<Site>, Candidates) {
    let sites = sites(&truck.model);
    let scales: Vec<f64> = loads.iter().map(|l| l.load.expected.unwrap()).collect();
    let mut scatter = scatter;
    if scatter.angle_sd > 0.0 {
        scatter.extra = sites
            .iter()
            .map(|s| unevenness(loads, &scales, *s))
            .collect();
    }
    let angles = Angles::Grid(
        (0..12)
            .map(|i| (15.0 * f64::from(i)).to_radians())
            .collect(),
    );
    let c = candidates(&truck.model, &sites, loads, &scales, angles, scatter);
    (sites, c)
}

/// Returns the variance of a reading for changes within an element, microstrain squared.
///
/// A fifth of the rms difference between corners and centre accounts for a position error of two millimetres and for
/// the mesh.
fn unevenness(loads: &[LoadCaseOf], scales: &[f64], (shell, side): Site) -> f64 {
    loads
        .iter()
        .zip(scales)
        .map(|(l, f)| {
            let field = &l.case.shells;
            let row = field.elements.binary_search(&shell).unwrap();
            let centre = field.centre[row][side.ix()];
            let squares = field.corners[row].iter().flat_map(|c| {
                (0..3)
                    .map(|i| (c[side.ix()][i] - centre[i]).powi(2))
                    .collect::<Vec<_>>()
            });
            let known: Vec<f64> = squares.filter(|v| v.is_finite()).collect();
            0.04 * known.iter().sum::<f64>() / 4.0 * (f / MICRO / l.applied).powi(2)
        })
        .sum()
}

/// Returns the scatter from gluing and from the model: 1 degree, and 5 % of the contribution of every load. A reading
/// that is a small difference of large contributions then has little weight.
pub fn conservative_scatter() -> Scatter {
    Scatter {
        noise: 1.0,
        angle_sd: 1.0_f64.to_radians(),
        model_rel: 0.05,
        extra: Vec::new(),
        forms: Vec::new(),
    }
}

/// Returns the gauges of a layout.
pub fn glue_gauges(model: &Model, sites: &[Site], layout: &Layout) -> Vec<Gauge> {
    layout
        .gauges
        .iter()
        .enumerate()
        .map(|(i, g)| {
            let (shell, surface) = sites[g.place as usize];
            let spec = GaugeSpec {
                surface: Some(surface),
                angle_rad: g.angle,
                ..GaugeSpec::place_on_shell(format!("P{:02}", i + 1), shell)
            };
            build(model, &spec, CornerRows::Absent).unwrap().0.remove(0)
        })
        .collect()
}

/// Returns the D-optimal layout of `n` gauges from all candidates for the six vertical loads, 60 mm apart.
pub fn find_best_layout(n: usize) -> (Vec<Gauge>, Layout) {
    best_with(n, conservative_scatter())
}

/// Returns the D-optimal layout with the given scatter.
pub fn best_with(n: usize, scatter: Scatter) -> (Vec<Gauge>, Layout) {
    let truck = analyst_truck();
    let (sites, c) = candidates_of(truck, &vertical_load_cases(truck), scatter);
    let mut spec = Spec::new(n, 6);
    spec.spacing = 60.0;
    let layout = place(&c, &spec).unwrap();
    (glue_gauges(&truck.model, &sites, &layout), layout)
}

/// Returns the ten best gauges.
pub fn best_ten() -> &'static [Gauge] {
    static GAUGES: OnceLock<Vec<Gauge>> = OnceLock::new();
    GAUGES.get_or_init(|| find_best_layout(10).0)
}

/// Returns S of gauges for given columns.
pub fn sensitivity(gauges: &[Gauge], loads: &[LoadCaseOf]) -> Sensitivity {
    from_cases(gauges, loads).unwrap()
}

/// Returns the gauges on another truck, with gluing errors of 2 mm along both surface directions and 1 degree.
pub fn on_other(other: &Truck, gauges: &[Gauge], lot: &mut Lot) -> Vec<Gauge> {
    gauges
        .iter()
        .map(|g| {
            let across = g.normal.cross(&g.direction);
            let shift =
                g.direction * (2.0 * lot.draw_normal()) + across * (2.0 * lot.draw_normal());
            let spec = GaugeSpec {
                place: GaugePlace::Nearest(g.position + shift),
                surface: Some(side_like(other, g, shift)),
                direction: Some(g.direction),
                angle_rad: lot.draw_normal().to_radians(),
                ..GaugeSpec::place_on_shell(g.name.clone(), ShellIx(0))
            };
            build(&other.model, &spec, CornerRows::Present)
                .unwrap()
                .0
                .remove(0)
        })
        .collect()
}

/// Returns the side of the shell of the other truck that faces in the direction of the gauge.
fn side_like(other: &Truck, g: &Gauge, shift: Vec3) -> strainbridge::fe::strain_tensor::Surface {
    use strainbridge::fe::strain_tensor::Surface;
    let foot = strainbridge::gauge::nearest_skin(&other.model, g.position + shift, None).unwrap();
    let probe = GaugeSpec {
        surface: Some(Surface::Top),
        direction: Some(g.direction),
        ..GaugeSpec::place_on_shell("probe", foot.shell)
    };
    let normal = build(&other.model, &probe, CornerRows::Absent)
        .unwrap()
        .0
        .remove(0)
        .normal;
    let outward = if g.surface == Surface::Top {
        g.normal
    } else {
        -g.normal
    };
    if normal.dot(&outward) > 0.0 {
        Surface::Top
    } else {
        Surface::Bottom
    }
}

/// Returns the strain of gauges under loads, by superposition.
pub fn strain(gauges: &[Gauge], cases: &[CaseResult], loads: &[f64]) -> Vec<f64> {
    gauges
        .iter()
        .map(|g| {
            cases
                .iter()
                .zip(loads)
                .map(|(c, f)| f * gauge_reading(g, c).unwrap())
                .sum()
        })
        .collect()
}

/// Adds an error of 1 % of gain and 1 microstrain of noise.
pub fn simulate_readings(lot: &mut Lot, clean: &[f64]) -> Vec<f64> {
    clean
        .iter()
        .map(|e| e * (1.0 + 0.01 * lot.draw_normal()) + MICRO * lot.draw_normal())
        .collect()
}

/// Returns the least squares loads.
pub fn solve_least_squares(s: &Matrix, y: &[f64]) -> Vec<f64> {
    let y = strainbridge::linalg::Vector::from_column_slice(y);
    s.clone()
        .svd(true, true)
        .solve(&y, 1e-14)
        .unwrap()
        .iter()
        .copied()
        .collect()
}

/// Returns relative errors, in percent.
pub fn percent(found: &[f64], truth: &[f64]) -> Vec<f64> {
    found
        .iter()
        .zip(truth)
        .map(|(f, t)| 100.0 * (f / t - 1.0).abs())
        .collect()
}

pub fn mean(v: &[f64]) -> f64 {
    v.iter().sum::<f64>() / v.len() as f64
}

pub fn largest_value(v: &[f64]) -> f64 {
    v.iter().copied().fold(0.0, f64::max)
}
