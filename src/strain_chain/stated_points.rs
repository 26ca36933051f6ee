//! Stated points of gauges, compared with the element and the side that are stated for the same gauge.

use crate::estimate::NORMAL_95;
use crate::fe::strain_tensor::Surface;
use crate::finding::{Finding, Severity};
use crate::gauge::{
    BetweenSkins, between_skins, distance_to_beam, distance_to_shell, nearest_skin,
};
use crate::host::words::format_number;
use crate::job::{Job, JobGauge, StatedPlace};
use crate::model::{Model, ShellIx, Vec3};
use crate::units::Quantity;

/// Returns the findings on the points that the gauges of a job state.
pub fn point_findings(model: &Model, job: &Job) -> Vec<Finding> {
    let mut out = off_their_elements(model, job);
    out.extend(
        job.gauges
            .iter()
            .filter_map(|g| side_finding(model, job, g)),
    );
    out
}

/// Returns the possible locations, in the basic frame, of the point stated for a gauge. If an element is stated as well, the point may be in the axes
/// of `cid`, like the direction, or in the basic axes.
fn stated_points(model: &Model, g: &JobGauge) -> impl Iterator<Item = Vec3> + use<> {
    let frame = model
        .frame_ix(g.cid)
        .and_then(|ix| model.frames.get(ix.us()));
    let of = |x: [f64; 3]| {
        let basic = Some(Vec3::from(x)).filter(|_| {
            matches!(
                g.place,
                StatedPlace::Element(_) | StatedPlace::BeamPoint { .. }
            )
        });
        [basic, frame.map(|f| f.to_basic(x))]
    };
    g.position.map(of).into_iter().flatten().flatten()
}

/// Returns the shell of a gauge with a stated point, and the position of the point relative to the skins of the shell.
fn at_skins(model: &Model, g: &JobGauge) -> Option<(ShellIx, BetweenSkins)> {
    let on_element = |ix: ShellIx| {
        stated_points(model, g)
            .filter_map(|x| Some((distance_to_shell(model, ix, x)?.distance, x)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, x)| x)
    };
    let (ix, x) = match g.place {
        StatedPlace::Element(id) => {
            let ix = model.shell_ix(id)?;
            (ix, on_element(ix)?)
        }
        StatedPlace::Position(..) => {
            let x = stated_points(model, g).next()?;
            let stated = g.surface_stated.then_some(g.surface);
            (nearest_skin(model, x, stated)?.shell, x)
        }
        StatedPlace::BeamPoint { .. } | StatedPlace::Unstated => return None,
    };
    Some((ix, between_skins(model, ix, x)?))
}

/// Returns the side of a gauge on an element. This is the stated side, else the side of the skin nearest to the stated point, else the top.
pub fn side_of(model: &Model, g: &JobGauge) -> Surface {
    if g.surface_stated {
        return g.surface;
    }
    at_skins(model, g).map_or(g.surface, |(_, skins)| skins.nearer_side())
}

/// Returns the finding if the stated point does not determine the side of a gauge, or contradicts the stated side.
fn side_finding(model: &Model, job: &Job, g: &JobGauge) -> Option<Finding> {
    let (ix, skins) = at_skins(model, g)?;
    let element = model.shells.get(ix.us())?.id;
    let unit = job.units.unit(Quantity::Length).name;
    if !g.surface_stated {
        let [bottom, top] = skins.distance;
        let side = skins.nearer_side().word();
        let why = match skins.is_within_bulge() {
            true => format!(
                "is between the flat element {element} and the curved surface through its neighbours, {} {unit} away",
                format_number(skins.bulge.abs())
            ),
            false => format!(
                "is about as far from the bottom ({} {unit}) as from the top ({} {unit}) of element {element}",
                format_number(bottom),
                format_number(top)
            ),
        };
        let undecided = || {
            Finding::new(
                Severity::Warning,
                "gauge-side-assumed",
                &g.name,
                format!(
                    "{}:{}: the point stated for gauge `{}` {why}. Strain is taken on the {side}; on the other side the bending strain has \
                     the opposite sign",
                    g.file, g.line, g.name
                ),
                "state `surface`, or a point on the skin",
            )
            .with_numbers((bottom - top).abs(), skins.thickness)
        };
        return skins.is_undecided().then(undecided);
    }
    let contradicted = || {
        let severity = match skins.is_on_other_skin(g.surface) {
            true => Severity::Error,
            false => Severity::Warning,
        };
        let [here, other] = skins.skin_distances(g.surface);
        Finding::new(
            severity,
            "gauge-side-contradicted",
            &g.name,
            format!(
                "{}:{}: the point stated for gauge `{}` is {} {unit} from the {} of element {element}, the stated surface, and {} {unit} \
                 from its other side. Strain is taken on the {}",
                g.file, g.line, g.name, format_number(here), g.surface.word(), format_number(other), g.surface.word()
            ),
            "correct `surface` or the point, or state one of the two alone",
        )
        .with_numbers(here - other, 0.0)
    };
    skins.contradicts(g.surface).then(contradicted)
}

/// Error of a point that is read from a drawing and rounded, m. A gauge and its tabs are some 5 mm wide.
const READ_OFF_M: f64 = 5e-3;

/// Returns how far a gauge's stated point may be beyond the faces of its element, job units. It is the 95 % limit of the gauge's position tolerance
/// in the job, plus the error of reading a drawing.
fn point_tolerance(job: &Job) -> f64 {
    let in_mm = job.reconcile.as_ref().and_then(|r| r.position_tolerance_mm);
    let stated = [
        job.placement.position_tolerance,
        job.calibration.position_tolerance,
        in_mm.unwrap_or(0.0) * 1e-3 / job.units.length_m(),
    ];
    NORMAL_95 * stated.into_iter().fold(0.0, f64::max) + READ_OFF_M / job.units.length_m()
}

/// Returns the findings on gauges whose stated point is off their stated element. One of the two is wrong. The finding is an error if their distance
/// exceeds the size of the element, else a warning. The strain of the element is used.
fn off_their_elements(model: &Model, job: &Job) -> Vec<Finding> {
    let distance_of = |g: &JobGauge, x: Vec3| match g.place {
        StatedPlace::Element(id) => distance_to_shell(model, model.shell_ix(id)?, x),
        StatedPlace::BeamPoint { element, .. } => {
            distance_to_beam(model, model.beam_ix(element)?, x)
        }
        StatedPlace::Position(..) | StatedPlace::Unstated => None,
    };
    let unit = job.units.unit(Quantity::Length).name;
    let tolerance = point_tolerance(job);
    let of = |g: &JobGauge| {
        let found = stated_points(model, g)
            .filter_map(|x| distance_of(g, x))
            .min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        let element = match g.place {
            StatedPlace::Element(id) | StatedPlace::BeamPoint { element: id, .. } => id,
            StatedPlace::Position(..) | StatedPlace::Unstated => return None,
        };
        // Without recovery points, the depth of a bar is unknown.
        let near = found.faces.map_or(found.size, |faces| faces + tolerance);
        let (severity, limit) = match found.distance > found.size.max(near) {
            true => (Severity::Error, found.size.max(near)),
            false => (Severity::Warning, near),
        };
        (found.distance > limit).then(|| {
            Finding::new(
                severity,
                "point-off-element",
                &g.name,
                format!(
                    "{}:{}: the point stated for gauge `{}` is {} {unit} from its element {element}, which is {} {unit} large. Strain is \
                     taken at the element",
                    g.file, g.line, g.name, format_number(found.distance), format_number(found.size)
                ),
                "correct the point or the element, or state one of the two alone",
            )
            .with_numbers(found.distance, limit)
        })
    };
    job.gauges.iter().filter_map(of).collect()
}
