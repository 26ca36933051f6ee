//! Gauge at its installed position, a short distance from its nominal position.

use super::arms::Gauge;
use super::build::build_by;
use super::grid_average::SMOOTH;
use super::side::same_side;
use super::spec::{CornerRows, GaugePlace, GaugeSpec};
use super::surface::{centre, corners, nearest_of, to_side};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::model::{Model, ShellIx, Vec3};

/// Offset of a gauge from its nominal position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offset {
    /// Offset along the axis of the gauge, length of the deck.
    pub along: f64,
    /// Offset across the axis: along normal x axis, with the normal of the element.
    pub across: f64,
    /// Turned, right-handed about the element's normal, radians.
    pub angle_rad: f64,
}

impl Offset {
    /// Creates an offset along the axis of the gauge.
    pub fn shift_along(length: f64) -> Self {
        Self {
            along: length,
            ..Self::default()
        }
    }

    /// Creates an offset across the axis of the gauge.
    pub fn shift_across(length: f64) -> Self {
        Self {
            across: length,
            ..Self::default()
        }
    }
}

/// Share of a step by which a foot may be off the requested point: `sin^2 20` on a smooth shell, at 20 degrees. An edge stopped a foot that is
/// farther off.
const MAX_STEP_MISS_REL: f64 = 1.0 - SMOOTH * SMOOTH;

/// Number of times that a step is halved if edges stop it on both sides.
const HALVINGS: usize = 8;

/// Gauge on shells at its nominal position, with the shells that it may be on.
#[derive(Clone, Debug)]
pub struct NominalGauge<'m> {
    model: &'m Model,
    spec: GaugeSpec,
    gauge: Gauge,
    corners: CornerRows,
    near: Vec<ShellIx>,
    /// On the reference surface.
    at: Vec3,
}

impl<'m> NominalGauge<'m> {
    /// Returns a channel of `spec` with the shells within `reach` of it. `None` for gauges on bars.
    pub fn new(
        model: &'m Model,
        spec: &GaugeSpec,
        gauge: &Gauge,
        corner_rows: CornerRows,
        reach: f64,
    ) -> Option<Self> {
        if matches!(spec.place, GaugePlace::Beam { .. }) {
            return None;
        }
        let home = model.shell_ix(gauge.element)?;
        let side = to_side(model, model.shells.get(home.us())?, gauge.surface);
        let at = gauge.position - gauge.normal * side;
        let close = |ix: &ShellIx| -> Option<bool> {
            let shell = model.shells.get(ix.us())?;
            let (p, c) = (corners(model, shell)?, centre(model, shell)?);
            let radius = p.iter().map(|q| (q - c).norm()).fold(0.0, f64::max);
            if (c - at).norm() > radius + reach {
                return Some(false);
            }
            let axes = shell_axes(model, shell, ShellPlace::Centre)?;
            Some(axes.row(2).transpose().dot(&gauge.normal).abs() >= SMOOTH)
        };
        let all = (0..model.shells.len() as u32).map(ShellIx);
        Some(Self {
            model,
            spec: spec.clone(),
            gauge: gauge.clone(),
            corners: corner_rows,
            near: all.filter(|ix| close(ix) == Some(true)).collect(),
            at,
        })
    }

    /// Returns the gauge at its nominal position.
    pub fn spec(&self) -> &GaugeSpec {
        &self.spec
    }

    /// Returns the gauge at an offset, with its point on the reference surface. The result equals the gauge of a job with this position and
    /// direction. If the offset is past the edge of the surface, the gauge is on the edge.
    pub fn gauge_at_offset(&self, offset: Offset) -> Option<(Gauge, Vec3)> {
        let axis = self.gauge.direction;
        let across = self.gauge.normal.cross(&axis);
        // Without corner rows, a gauge at any position on its shell reads the middle of the shell.
        let x = match self.corners {
            CornerRows::Present => self.at + axis * offset.along + across * offset.across,
            CornerRows::Absent => self.at,
        };
        let foot = nearest_of(self.model, x, self.near.iter().copied())?;
        let home = (self.model.shell_ix(self.gauge.element)?, self.gauge.surface);
        let (sin, cos) = offset.angle_rad.sin_cos();
        let spec = GaugeSpec {
            name: self.gauge.name.clone(),
            place: GaugePlace::Nearest(foot.point),
            surface: Some(same_side(self.model, home, foot.shell)?),
            direction: Some(axis * cos + across * sin),
            angle_rad: 0.0,
            rosette: None,
            ..self.spec.clone()
        };
        let (built, _) = build_by(self.model, &spec, self.corners, |_| Some(foot)).ok()?;
        Some((built.into_iter().next()?, foot.point))
    }

    /// Returns the change of `read` per unit of length of an offset of the gauge along `way`. It is the central difference over `step` in both
    /// directions. If an edge of the surface stops the gauge on one side, it is the difference on the other side. `None` if edges stop the gauge on
    /// both sides for any `step`, or if `read` returns nothing.
    pub fn slope(
        &self,
        way: fn(f64) -> Offset,
        step: f64,
        read: impl Fn(&Gauge) -> Option<Vec<f64>>,
    ) -> Option<Vec<f64>> {
        // Distance by which the gauge really moves along `way`, and its reading there.
        let end = |asked: f64| -> Option<(f64, Vec<f64>)> {
            let (gauge, x) = self.gauge_at_offset(way(asked))?;
            let unit = way(1.0);
            let axis = self.gauge.direction;
            let across = self.gauge.normal.cross(&axis);
            let off = x - self.at;
            let (a, c) = (off.dot(&axis), off.dot(&across));
            let miss = (a - unit.along * asked).hypot(c - unit.across * asked);
            if miss > MAX_STEP_MISS_REL * asked.abs() {
                return None;
            }
            Some((a * unit.along + c * unit.across, read(&gauge)?))
        };
        let here = end(0.0)?;
        (0..HALVINGS).find_map(|n| {
            let step = step * 0.5_f64.powi(n as i32);
            let (from, to) = match (end(-step), end(step)) {
                (None, None) => return None,
                (from, to) => (
                    from.unwrap_or_else(|| here.clone()),
                    to.unwrap_or_else(|| here.clone()),
                ),
            };
            let span = to.0 - from.0;
            let change = to.1.iter().zip(&from.1).map(|(b, a)| (b - a) / span);
            Some(change.collect())
        })
    }
}
