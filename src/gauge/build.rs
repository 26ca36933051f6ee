//! From a description to arms.

use super::arms::Gauge;
use super::beam::{BeamSeat, on_beam, point_on_axis};
use super::error::GaugeError;
use super::grid::{Seat, Site, laid_onto, rotate_about};
use super::grid_average::POINTS;
use super::spec::{CornerRows, GaugePlace, GaugeSpec};
use super::surface::{Foot, centre, from_skins, nearest_skin, to_side};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::finding::{Finding, Severity};
use crate::model::{Mat3, Model, Shell, Vec3};

/// Places a gauge on the model, and returns its channels (three for a rosette) with findings.
///
/// A channel is a linear functional of the strain at the places of its arms; [`gauge_reading`](super::gauge_reading) evaluates it in a load case.
///
/// # Errors
/// Returns the reason why the gauge cannot be placed on the model.
///
/// # Example
/// A square plate under tension along x reads `e`, `-nu e`, and `e (1 - nu) / 2` at 45 degrees:
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
/// use strainbridge::fe::{LoadCase, solve_cases};
/// use strainbridge::gauge::{CornerRows, GaugeSpec, build, gauge_reading};
/// use strainbridge::model::Model;
///
/// # const DECK: &str = "SOL 101\nCEND\nSPC = 1\nLOAD = 2\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,10.,0.,0.\nGRID,3,,10.,10.,0.
/// # GRID,4,,0.,10.,0.\nCQUAD4,1,1,1,2,3,4\nPSHELL,1,1,1.,1,,1\nMAT1,1,1000.,,.25\nSPC1,1,13456,1,4\nSPC1,1,2,1\nSPC1,1,345,2,3
/// # FORCE,2,2,,5.,1.,0.,0.\nFORCE,2,3,,5.,1.,0.,0.\nENDDATA\n";
/// let deck = read_deck("plate.bdf", DECK.into(), &mut MemoryLoader::default());
/// let (model, _) = Model::from_deck(&deck);
/// let subcases = deck.case_control.effective_subcases();
/// let case = LoadCase::of_subcase(&model, &subcases[0], "tension".to_owned());
/// let (solution, _) = solve_cases(&model, &[case], &Default::default())?;
///
/// let shell = model.shell_ix(1).unwrap();
/// let e = 10.0 / 10.0 / 1000.0; // force over area over modulus
/// for (degrees, expected) in [(0.0_f64, e), (90.0, -0.25 * e), (45.0, e * 0.75 / 2.0)] {
///     let spec = GaugeSpec { angle_rad: degrees.to_radians(), ..GaugeSpec::place_on_shell("G1", shell) };
///     let (channels, _) = build(&model, &spec, CornerRows::Present)?;
///     let strain = gauge_reading(&channels[0], &solution.cases[0]).unwrap();
///     assert!((strain - expected).abs() < 1e-9 * e);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build(
    model: &Model,
    spec: &GaugeSpec,
    corners: CornerRows,
) -> Result<(Vec<Gauge>, Vec<Finding>), GaugeError> {
    build_by(model, spec, corners, |x| {
        nearest_skin(model, x, spec.surface)
    })
}

/// Places a gauge like [`build`]. `nearest_to` finds the point of the shells.
pub(super) fn build_by(
    model: &Model,
    spec: &GaugeSpec,
    corners: CornerRows,
    nearest_to: impl Fn(Vec3) -> Option<Foot>,
) -> Result<(Vec<Gauge>, Vec<Finding>), GaugeError> {
    let mut findings = Vec::new();
    if let GaugePlace::Beam {
        beam,
        point,
        station,
    } = spec.place
    {
        let seat = BeamSeat {
            beam,
            point,
            station,
        };
        let gauge = on_beam(model, spec, seat)?;
        findings.extend(point_on_axis(model, spec, seat));
        return Ok((vec![gauge], findings));
    }
    let no_area = |element| GaugeError::NoArea {
        gauge: spec.name.clone(),
        element,
    };
    let (shell, foot) = match spec.place {
        GaugePlace::Nearest(x) => {
            let foot = nearest_to(x).ok_or_else(|| GaugeError::NoShells {
                gauge: spec.name.clone(),
            })?;
            (foot.shell, Some(foot))
        }
        GaugePlace::Shell(ix) => (ix, None),
        GaugePlace::Beam { .. } => {
            return Err(GaugeError::NoElement {
                gauge: spec.name.clone(),
            });
        }
    };
    let element = model
        .shells
        .get(shell.us())
        .ok_or_else(|| GaugeError::NoElement {
            gauge: spec.name.clone(),
        })?;
    let axes = shell_axes(model, element, ShellPlace::Centre).ok_or_else(|| no_area(element.id))?;
    let z = axes.row(2).transpose();
    let side = spec
        .surface
        .or(foot.map(|f| f.side))
        .unwrap_or(Surface::Top);
    let axis = axis_on(&axes, spec).ok_or_else(|| GaugeError::NormalDirection {
        gauge: spec.name.clone(),
        element: element.id,
    })?;
    let middle = centre(model, element).ok_or_else(|| no_area(element.id))?;
    let at = match foot {
        Some(f) if corners == CornerRows::Present => f.point,
        _ => middle,
    };
    if let (Some(f), GaugePlace::Nearest(x)) = (foot, spec.place) {
        let size = reach(model, element, middle);
        // The skin of a stated side may be the farther one.
        let distance = match from_skins(model, shell, x) {
            Some(skins) if side != f.side => skins[side.ix()],
            _ => f.distance,
        };
        let f = Foot { distance, ..f };
        findings.push(report_distance(spec, element.id, side, &f, corners, size));
    }
    let drawn = foot.map_or(middle, |f| f.point);
    let legs: Vec<(String, f64)> = match spec.rosette {
        Some(r) => r
            .legs()
            .iter()
            .zip(spec.leg_turns_rad)
            .map(|((leg, t), turn)| (format!("{}.{leg}", spec.name), t + turn))
            .collect(),
        None => vec![(spec.name.clone(), 0.0)],
    };
    let site = Site {
        model,
        corners,
        spec,
    };
    let here = Seat {
        shell,
        surface: side,
        at,
    };
    let mut gauges = Vec::new();
    let mut past_edge = 0.0_f64;
    for (name, turn) in legs {
        let axis = rotate_about(axis, z, turn);
        let direction_in = axes * axis;
        let laid = site.lay(here, axis, z)?;
        past_edge = past_edge.max(laid.past_edge);
        gauges.push(Gauge {
            name,
            arms: laid.arms,
            element: element.id,
            surface: side,
            position: drawn + z * to_side(model, element, side),
            direction: axis,
            normal: z,
            angle_rad: half_turn(direction_in.y.atan2(direction_in.x)),
        });
    }
    findings.extend(grid_past_edge(spec, element.id, past_edge));
    Ok((gauges, findings))
}

/// Returns a warning for a grid that reaches past the edge of the part farther than the outermost point at which its strain is taken.
fn grid_past_edge(spec: &GaugeSpec, element: u32, past_edge: f64) -> Option<Finding> {
    let allowed = 0.5 * (1.0 - POINTS[POINTS.len() - 1].0) * spec.grid_length;
    (past_edge > allowed).then(|| {
        Finding::new(
            Severity::Warning,
            "gauge-off-structure",
            &spec.name,
            format!(
                "gauge `{}` on element {element}: an end of its grid of {} is {past_edge:.4} past the edge of the part. The strain at the \
                 edge is used there",
                spec.name, spec.grid_length
            ),
            "check `grid_length` and the gauge's place, or move the gauge away from the edge",
        )
        .with_numbers(past_edge, allowed)
    })
}

/// Returns the largest distance from an element's skin at which a place on it may be stated. It is the distance between its corners, which
/// exceeds the height of a curved skin over its chord, plus offset and thickness.
fn reach(model: &Model, element: &Shell, middle: Vec3) -> f64 {
    let corners = super::surface::corners(model, element);
    let far = |x: f64, c: &Vec3| x.max((c - middle).norm());
    let across = 2.0 * corners.iter().flatten().fold(0.0, far);
    let sides = [Surface::Bottom, Surface::Top].map(|s| to_side(model, element, s).abs());
    across + sides[0].max(sides[1])
}

/// Multiple of the largest distance of a place on the skin, beyond which no rounding of a drawing explains the distance.
const FAR: f64 = 5.0;

fn report_distance(
    spec: &GaugeSpec,
    element: u32,
    side: Surface,
    f: &Foot,
    corners: CornerRows,
    reach: f64,
) -> Finding {
    if f.distance > reach {
        let severity = match f.distance > FAR * reach {
            true => Severity::Error,
            false => Severity::Warning,
        };
        return Finding::new(
            severity,
            "gauge-off-structure",
            &spec.name,
            format!(
                "gauge `{}` is stated {:.4} from the nearest shell, element {element}, which is more than the width of the element",
                spec.name, f.distance
            ),
            "check the unit of the position, its coordinate system and the origin of the deck",
        )
        .with_numbers(f.distance, reach);
    }
    let how = match corners {
        CornerRows::Present => "strain is interpolated there from the corner rows",
        CornerRows::Absent => {
            "the result has no corner rows, so the strain at the centre of the element is used"
        }
    };
    Finding::new(
        Severity::Info,
        "gauge-at-nearest-surface",
        &spec.name,
        format!(
            "gauge `{}` is on the {} of element {element}, {:.4} from the stated position; {how}",
            spec.name,
            side.word(),
            f.distance
        ),
        "state the element and the surface if you mean another one",
    )
}

/// The gauge's axis, a unit vector along the surface.
fn axis_on(axes: &Mat3, spec: &GaugeSpec) -> Option<Vec3> {
    let z = axes.row(2).transpose();
    let start = match spec.direction {
        Some(d) => laid_onto(d, z)?,
        None => axes.row(0).transpose(),
    };
    Some(rotate_about(start, z, spec.angle_rad))
}

/// An axis has no sense: its angle in (-pi/2, pi/2].
fn half_turn(t: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    if t > FRAC_PI_2 {
        t - PI
    } else if t <= -FRAC_PI_2 {
        t + PI
    } else {
        t
    }
}
