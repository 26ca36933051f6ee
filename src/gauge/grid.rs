//! Grids of a gauge as arms: the place of each grid, and the strain along it averaged over its length.

use super::arms::{Arm, Spot};
use super::error::GaugeError;
use super::grid_average::{Landing, POINTS, about_centre, place_at};
use super::side::{opposite_side, same_side, shell_normal};
use super::spec::{Bridge, CornerRows, GaugeSpec};
use super::surface::{centre, foot_on};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, ShellIx, Vec3};

/// Poisson's ratio of the bar on which makers calibrate the gauge factor.
const CALIBRATION_POISSON: f64 = 0.285;

/// Sine of the angle to the normal under which a direction counts as normal to the surface.
const ALONG: f64 = 1e-3;

pub(super) fn laid_onto(d: Vec3, z: Vec3) -> Option<Vec3> {
    let d = d.try_normalize(0.0)?;
    let flat = d - z * d.dot(&z);
    if flat.norm() < ALONG {
        None
    } else {
        flat.try_normalize(0.0)
    }
}

/// Returns `d`, which is normal to `z`, rotated right-handed about `z`.
pub(super) fn rotate_about(d: Vec3, z: Vec3, angle: f64) -> Vec3 {
    d * angle.cos() + z.cross(&d) * angle.sin()
}

/// A place on a side of a shell; `at` is on the reference surface.
#[derive(Clone, Copy)]
pub(super) struct Seat {
    pub(super) shell: ShellIx,
    pub(super) surface: Surface,
    pub(super) at: Vec3,
}

/// Grid of a gauge: its place, its unit direction along the surface there, and its weight in the reading.
struct Grid {
    seat: Seat,
    direction: Vec3,
    weight: f64,
}

/// Arms of a gauge, and the largest distance by which its grids extend past the edge of the part.
pub(super) struct PlacedArms {
    pub(super) arms: Vec<Arm>,
    pub(super) past_edge: f64,
}

/// Tangent of the largest angle by which the surface may turn away under half a grid. Beyond it the grid is no longer on the part.
const TURNS_AWAY: f64 = 0.577_350_269_189_625_8;
/// Share of the grid length up to which lengths count as equal, to allow for rounding.
const SAME_LENGTH: f64 = 1e-6;

pub(super) struct Site<'m> {
    pub(super) model: &'m Model,
    pub(super) corners: CornerRows,
    pub(super) spec: &'m GaugeSpec,
}

impl Site<'_> {
    /// Returns all arms of a channel with the axis `axis`. The weights include the bridge factor. `z` is the normal at the gauge.
    ///
    /// # Errors
    /// A pair on a missing shell or normal to its axis; a grid longer than the part.
    pub(super) fn lay(&self, here: Seat, axis: Vec3, z: Vec3) -> Result<PlacedArms, GaugeError> {
        let (mut arms, mut past_edge) = (Vec::new(), 0.0_f64);
        for grid in self.grids(here, axis, z)? {
            past_edge = past_edge.max(self.past_edge(&grid)?);
            arms.extend(self.average(&grid));
        }
        Ok(PlacedArms {
            arms: merge_arms(arms),
            past_edge,
        })
    }

    /// Returns the grids of the wiring.
    fn grids(&self, here: Seat, axis: Vec3, z: Vec3) -> Result<Vec<Grid>, GaugeError> {
        let diagonal = |sign: f64| rotate_about(axis, z, sign * std::f64::consts::FRAC_PI_4);
        let along = |weight: f64| vec![(axis, weight)];
        let across = || vec![(diagonal(1.0), 1.0), (diagonal(-1.0), -1.0)];
        let (first, second) = match self.spec.bridge {
            Bridge::Quarter => (along(1.0), Vec::new()),
            Bridge::HalfBending => (along(1.0), along(-1.0)),
            Bridge::FullBending => (along(2.0), along(-2.0)),
            Bridge::Shear if self.spec.pair.is_some() => (across(), across()),
            Bridge::Shear => (across(), Vec::new()),
        };
        let factor = self.spec.bridge_factor;
        let grid = |seat: Seat, direction: Vec3, weight: f64| Grid {
            seat,
            direction,
            weight: weight / factor,
        };
        let mut out: Vec<Grid> = first
            .into_iter()
            .map(|(direction, weight)| grid(here, direction, weight))
            .collect();
        for (direction, weight) in second {
            let (seat, direction) = self.on_pair(here, direction)?;
            out.push(grid(seat, direction, weight));
        }
        Ok(out)
    }

    /// Returns the place of the second pair, and the direction there of a grid that has `direction` in the first pair.
    fn on_pair(&self, here: Seat, direction: Vec3) -> Result<(Seat, Vec3), GaugeError> {
        let Some(pair) = self.spec.pair else {
            let surface = opposite_side(here.surface);
            return Ok((Seat { surface, ..here }, direction));
        };
        let gauge = || self.spec.name.clone();
        let shell = self.model.shells.get(pair.shell.us());
        let shell = shell.ok_or_else(|| GaugeError::NoElement { gauge: gauge() })?;
        let element = shell.id;
        let flat = centre(self.model, shell).zip(shell_normal(self.model, pair.shell));
        let (at, z) = flat.ok_or_else(|| GaugeError::NoArea {
            gauge: gauge(),
            element,
        })?;
        let direction =
            laid_onto(pair.turn * direction, z).ok_or_else(|| GaugeError::NormalDirection {
                gauge: gauge(),
                element,
            })?;
        let seat = Seat {
            shell: pair.shell,
            surface: pair.surface,
            at,
        };
        Ok((seat, direction))
    }

    /// Returns how far an end of a grid is past the edge of the part; 0 for an end on the part.
    ///
    /// # Errors
    /// The part is shorter than the grid along its axis, or turns away under it.
    fn past_edge(&self, grid: &Grid) -> Result<f64, GaugeError> {
        let length = self.spec.grid_length;
        if length <= 0.0 {
            return Ok(0.0);
        }
        let land = |along: f64| self.land(grid, along);
        let off = |l: &Landing| match l.foot.distance > TURNS_AWAY * 0.5 * length {
            true => l.past_edge.max(l.foot.distance - TURNS_AWAY * 0.5 * length),
            false => l.past_edge,
        };
        let ends = [-0.5, 0.5].map(|half| land(half * length).map_or(0.0, |l| off(&l)));
        let worst = ends[0].max(ends[1]);
        if worst <= SAME_LENGTH * length {
            return Ok(0.0);
        }
        let reach = |sign: f64| {
            let foot = land(sign * length).map_or(grid.seat.at, |l| l.foot.point);
            (sign * (foot - grid.seat.at).dot(&grid.direction)).clamp(0.0, length)
        };
        let part = reach(-1.0) + reach(1.0);
        if part < (1.0 - SAME_LENGTH) * length {
            return Err(GaugeError::GridBeyondPart {
                gauge: self.spec.name.clone(),
                element: self
                    .model
                    .shells
                    .get(grid.seat.shell.us())
                    .map_or(0, |s| s.id),
                grid_length: length,
                part,
            });
        }
        Ok(worst)
    }

    /// Returns the place under a point of a grid, `along` its axis from its middle.
    fn land(&self, grid: &Grid, along: f64) -> Option<Landing> {
        let at = grid.seat.at + grid.direction * along;
        place_at(self.model, (grid.seat.shell, grid.seat.surface), at)
    }

    /// Returns the arms of one grid, averaged over its length.
    fn average(&self, grid: &Grid) -> Vec<Arm> {
        let (length, direction) = (self.spec.grid_length, grid.direction);
        if length <= 0.0 {
            return self.point(grid.seat, direction, grid.weight, Reach::Point);
        }
        POINTS
            .iter()
            .flat_map(|(x, w)| {
                let along = 0.5 * length * x;
                let at = grid.seat.at + direction * along;
                let seat = self.land(grid, along).map_or(grid.seat, |l| Seat {
                    shell: l.foot.shell,
                    surface: l.foot.side,
                    // Past the edge, the grid has the strain at the edge.
                    at: if l.past_edge > SAME_LENGTH * length {
                        l.foot.point
                    } else {
                        at
                    },
                });
                self.point(seat, direction, grid.weight * w, Reach::Grid)
            })
            .collect()
    }

    /// The strain along `direction` at one point of a shell.
    fn point(&self, seat: Seat, direction: Vec3, weight: f64, reach: Reach) -> Vec<Arm> {
        let spots: Vec<(ShellIx, ShellPlace, f64)> = if self.corners == CornerRows::Present {
            let weights = foot_on(self.model, seat.shell, seat.at).map(|f| f.weights);
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
        spots
            .into_iter()
            .filter(|(_, _, w)| *w != 0.0)
            .filter_map(|(shell, place, w)| {
                let axes = shell_axes(self.model, self.model.shells.get(shell.us())?, place)?;
                let d = laid_onto(direction, axes.row(2).transpose())?;
                let local = axes * d;
                let (c, s) = (local.x, local.y);
                let surface = same_side(self.model, (seat.shell, seat.surface), shell)?;
                let kt = self.spec.transverse_sensitivity;
                let scale = weight * w / (1.0 - CALIBRATION_POISSON * kt);
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

/// Whether a point is a gauge without length or belongs to a grid of some length.
#[derive(Clone, Copy, PartialEq)]
enum Reach {
    Point,
    Grid,
}

/// Arms at the same spot added up.
fn merge_arms(arms: Vec<Arm>) -> Vec<Arm> {
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
