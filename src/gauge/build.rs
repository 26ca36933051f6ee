//! From a description to arms.

use super::arms::{Arm, Gauge, Spot};
use super::beam::{BeamSeat, on_beam};
use super::error::GaugeError;
use super::grid_average::{POINTS, about_centre, place_at};
use super::spec::{Bridge, GaugePlace, GaugeSpec};
use super::surface::{Foot, centre, nearest, to_side};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::finding::{Finding, Severity};
use crate::model::{Mat3, Model, Shell, ShellIx, Vec3};

/// Whether the result has strain at the corners of shells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum CornerRows {
    Present,
    Absent,
}

/// Poisson's ratio of the bar on which makers calibrate the gauge factor.
const CALIBRATION_POISSON: f64 = 0.285;

/// The channels of a gauge (three for a rosette) and what there is to say of them.
///
/// # Errors
/// Where it can't be laid onto the model.
pub fn build(
    model: &Model,
    spec: &GaugeSpec,
    corners: CornerRows,
) -> Result<(Vec<Gauge>, Vec<Finding>), GaugeError> {
    build_by(model, spec, corners, |x| nearest(model, x, |_| true))
}

/// [`build`] with a point of the shells found by `nearest_to`.
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
        return Ok((vec![on_beam(model, spec, seat)?], findings));
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
    if let Some(f) = foot {
        let size = reach(model, element, middle);
        findings.push(found(spec, element.id, side, &f, corners, size));
    }
    let drawn = foot.map_or(middle, |f| f.point);
    let legs: Vec<(String, f64)> = match spec.rosette {
        Some(r) => r
            .legs()
            .iter()
            .map(|(leg, t)| (format!("{}.{leg}", spec.name), *t))
            .collect(),
        None => vec![(spec.name.clone(), 0.0)],
    };
    let site = Site {
        model,
        corners,
        grid_length: spec.grid_length,
        kt: spec.transverse_sensitivity,
    };
    let here = Seat {
        shell,
        surface: side,
        at,
    };
    let gauges = legs
        .into_iter()
        .map(|(name, turn)| {
            let axis = rotated(axis, z, turn);
            let direction_in = axes * axis;
            Gauge {
                name,
                arms: merged(site.arms(spec, here, axis, z)),
                element: element.id,
                surface: side,
                position: drawn + z * to_side(model, element, side),
                direction: axis,
                normal: z,
                angle_rad: half_turn(direction_in.y.atan2(direction_in.x)),
            }
        })
        .collect();
    Ok((gauges, findings))
}

/// How far from an element's reference surface a place on its skin may be stated: as far as its corners are from each other, which the chord of
/// a curved skin is not, and its offset and thickness.
fn reach(model: &Model, element: &Shell, middle: Vec3) -> f64 {
    let corners = super::surface::corners(model, element);
    let far = |x: f64, c: &Vec3| x.max((c - middle).norm());
    let across = 2.0 * corners.iter().flatten().fold(0.0, far);
    let sides = [Surface::Bottom, Surface::Top].map(|s| to_side(model, element, s).abs());
    across + sides[0].max(sides[1])
}

/// Distances, in those that a place on the skin may have, beyond which no rounding of a drawing explains it.
const FAR: f64 = 5.0;

fn found(
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
                "gauge `{}` is stated {:.4} from the nearest shell, element {element}, which is farther than that is wide",
                spec.name, f.distance
            ),
            "check the position's unit, its coordinate system and the deck's origin",
        )
        .with_numbers(f.distance, reach);
    }
    let how = match corners {
        CornerRows::Present => "strain is interpolated there from the corner rows",
        CornerRows::Absent => {
            "the result has no corner rows, so that strain is taken at the element's centre"
        }
    };
    Finding::new(
        Severity::Info,
        "gauge-at-nearest-surface",
        &spec.name,
        format!(
            "gauge `{}` sits on the {} of element {element}, {:.4} from the stated position (to the element's reference surface); {how}",
            spec.name,
            side.word(),
            f.distance
        ),
        "name the element and the surface if another one is meant",
    )
}

/// The gauge's axis, a unit vector along the surface.
fn axis_on(axes: &Mat3, spec: &GaugeSpec) -> Option<Vec3> {
    let z = axes.row(2).transpose();
    let start = match spec.direction {
        Some(d) => laid_onto(d, z)?,
        None => axes.row(0).transpose(),
    };
    Some(rotated(start, z, spec.angle_rad))
}

/// Sine of the angle to the normal under which a direction counts as normal to the surface.
const ALONG: f64 = 1e-3;

fn laid_onto(d: Vec3, z: Vec3) -> Option<Vec3> {
    let d = d.try_normalize(0.0)?;
    let flat = d - z * d.dot(&z);
    if flat.norm() < ALONG {
        None
    } else {
        flat.try_normalize(0.0)
    }
}

/// `d`, normal to `z`, turned right-handed about `z`.
fn rotated(d: Vec3, z: Vec3, angle: f64) -> Vec3 {
    d * angle.cos() + z.cross(&d) * angle.sin()
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

#[derive(Clone, Copy)]
struct Seat {
    shell: ShellIx,
    surface: Surface,
    at: Vec3,
}

struct Site<'m> {
    model: &'m Model,
    corners: CornerRows,
    grid_length: f64,
    kt: f64,
}

impl Site<'_> {
    /// All arms of a gauge, the bridge factor in them.
    fn arms(&self, spec: &GaugeSpec, here: Seat, axis: Vec3, z: Vec3) -> Vec<Arm> {
        let pair = |default: Option<Seat>| match spec.pair {
            Some((shell, surface)) => {
                let at = self
                    .model
                    .shells
                    .get(shell.us())
                    .and_then(|s| centre(self.model, s));
                at.map(|at| Seat { shell, surface, at })
            }
            None => default,
        };
        let other_side = Seat {
            surface: opposite(here.surface),
            ..here
        };
        let diagonal = |sign: f64| rotated(axis, z, sign * std::f64::consts::FRAC_PI_4);
        let grids: Vec<(Option<Seat>, Vec3, f64)> = match spec.bridge {
            Bridge::Quarter => vec![(Some(here), axis, 1.0)],
            Bridge::HalfBending => vec![
                (Some(here), axis, 1.0),
                (pair(Some(other_side)), axis, -1.0),
            ],
            Bridge::FullBending => vec![
                (Some(here), axis, 2.0),
                (pair(Some(other_side)), axis, -2.0),
            ],
            Bridge::Shear => {
                let second = pair(None);
                vec![
                    (Some(here), diagonal(1.0), 1.0),
                    (Some(here), diagonal(-1.0), -1.0),
                    (second, diagonal(1.0), 1.0),
                    (second, diagonal(-1.0), -1.0),
                ]
            }
        };
        grids
            .into_iter()
            .filter_map(|(seat, direction, sign)| {
                Some((seat?, direction, sign / spec.bridge_factor))
            })
            .flat_map(|(seat, direction, weight)| self.grid(seat, direction, weight))
            .collect()
    }

    /// One grid along `direction`, averaged over its length.
    fn grid(&self, seat: Seat, direction: Vec3, weight: f64) -> Vec<Arm> {
        if self.grid_length <= 0.0 {
            return self.point(seat, direction, weight, Reach::Point);
        }
        POINTS
            .iter()
            .flat_map(|(x, w)| {
                let at = seat.at + direction * (0.5 * self.grid_length * x);
                let shell = place_at(self.model, seat.shell, at).map_or(seat.shell, |f| f.shell);
                self.point(
                    Seat { shell, at, ..seat },
                    direction,
                    weight * w,
                    Reach::Grid,
                )
            })
            .collect()
    }

    /// The strain along `direction` at one point of a shell.
    fn point(&self, seat: Seat, direction: Vec3, weight: f64, reach: Reach) -> Vec<Arm> {
        let spots: Vec<(ShellIx, ShellPlace, f64)> = if self.corners == CornerRows::Present {
            let weights =
                super::surface::foot_on(self.model, seat.shell, seat.at).map(|f| f.weights);
            let n = self
                .model
                .shells
                .get(seat.shell.us())
                .map_or(0, |s| s.shape.n_corners());
            let centred =
                weights.is_none_or(|w| w[..n].iter().all(|v| (v - 1.0 / n as f64).abs() < 1e-9));
            match weights {
                Some(w) if !centred => (0..n)
                    .map(|i| (seat.shell, ShellPlace::Corner(i), w[i]))
                    .collect(),
                _ => vec![(seat.shell, ShellPlace::Centre, 1.0)],
            }
        } else if reach == Reach::Grid {
            about_centre(self.model, seat.shell, seat.at, direction)
                .into_iter()
                .map(|(ix, w)| (ix, ShellPlace::Centre, w))
                .collect()
        } else {
            vec![(seat.shell, ShellPlace::Centre, 1.0)]
        };
        let normal = |ix: ShellIx| {
            let s = self.model.shells.get(ix.us())?;
            shell_axes(self.model, s, ShellPlace::Centre).map(|a| a.row(2).transpose())
        };
        let home = normal(seat.shell);
        spots
            .into_iter()
            .filter(|(_, _, w)| *w != 0.0)
            .filter_map(|(shell, place, w)| {
                let axes = shell_axes(self.model, self.model.shells.get(shell.us())?, place)?;
                let d = laid_onto(direction, axes.row(2).transpose())?;
                let local = axes * d;
                let (c, s) = (local.x, local.y);
                let flipped = home
                    .zip(normal(shell))
                    .is_some_and(|(a, b)| a.dot(&b) < 0.0);
                let surface = if flipped {
                    opposite(seat.surface)
                } else {
                    seat.surface
                };
                let (kt, scale) = (self.kt, weight * w / (1.0 - CALIBRATION_POISSON * self.kt));
                let coefficient = [
                    scale * (c * c + kt * s * s),
                    scale * (s * s + kt * c * c),
                    scale * (1.0 - kt) * s * c,
                ];
                Some(Arm {
                    spot: Spot::Shell {
                        shell,
                        surface,
                        place,
                    },
                    coefficient,
                })
            })
            .collect()
    }
}

/// Whether a point stands for itself or belongs to a grid of some length.
#[derive(Clone, Copy, PartialEq)]
enum Reach {
    Point,
    Grid,
}

pub(super) fn opposite(s: Surface) -> Surface {
    match s {
        Surface::Top => Surface::Bottom,
        Surface::Bottom => Surface::Top,
    }
}

/// Arms at the same spot added up.
fn merged(arms: Vec<Arm>) -> Vec<Arm> {
    let mut out: Vec<Arm> = Vec::new();
    for a in arms {
        match out.iter_mut().find(|b| b.spot == a.spot) {
            Some(b) => b
                .coefficient
                .iter_mut()
                .zip(a.coefficient)
                .for_each(|(x, y)| *x += y),
            None => out.push(a),
        }
    }
    out
}
