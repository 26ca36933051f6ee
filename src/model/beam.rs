//! CBAR and CBEAM: axes, offsets, pins.

use super::build::Builder;
use super::fault::FaultKind;
use super::frame::unit;
use super::types::*;
use nastran::cards::{Bar, BarDefaults, Orientation};
use nastran::place::PlacedCard;
use std::collections::HashMap;

/// Sine of the angle between orientation vector and element under which they count as parallel.
const PARALLEL: f64 = 1e-6;

impl Builder<'_> {
    pub(super) fn beams(&mut self) {
        let (properties, ix) = self.beam_properties();
        self.model.beam_properties = properties;
        let cards = self.cards;
        let mut out = Vec::with_capacity(cards.bars.len() + cards.beams.len());
        let bars = cards
            .bars
            .iter()
            .map(|b| (b.at, &b.card, "CBAR", &cards.baror, [None; 2]));
        let beams = cards
            .beams
            .iter()
            .map(|b| (b.at, &b.card.bar, "CBEAM", &cards.beamor, b.card.warping));
        for (at, bar, card, defaults, points) in bars.chain(beams) {
            if !self.element(bar.id, card, at) {
                continue;
            }
            let placed = PlacedCard { card: *bar, at };
            let Some(mut beam) = self.beam(&placed, card, defaults.as_ref().map(|d| &d.card), &ix)
            else {
                continue;
            };
            (beam.warping, beam.idle_points) = match self.find_warping_points(&beam, points) {
                Some((stated, true)) => (Some(stated), false),
                Some((_, false)) => (None, true),
                None => (None, false),
            };
            out.push(beam);
        }
        out.sort_by_key(|b: &Beam| b.id);
        self.model.beams = out;
    }

    fn beam(
        &mut self,
        b: &PlacedCard<Bar>,
        card: &'static str,
        defaults: Option<&BarDefaults>,
        ix: &HashMap<(bool, u32), BeamPropertyIx>,
    ) -> Option<Beam> {
        let name = format!("{card} {}", b.id);
        let at = b.at;
        let pid = b.pid.or(defaults.and_then(|d| d.pid)).unwrap_or(b.id);
        let property = ix.get(&(card == "CBEAM", pid)).copied();
        if property.is_none() && !self.refused_properties.contains(&(card == "CBEAM", pid)) {
            let what = if card == "CBAR" {
                "bar property"
            } else {
                "beam property"
            };
            self.fault(
                name.clone(),
                "PID",
                at,
                FaultKind::Missing {
                    what,
                    id: pid.into(),
                },
            );
        }
        let ga = self.grid(b.grids[0], &name, "GA", at);
        let gb = self.grid(b.grids[1], &name, "GB", at);
        let (ga, gb) = (ga?, gb?);
        let offt = b.offt.or(defaults.and_then(|d| d.offt)).unwrap_or(*b"GGG");
        if !(matches!(offt[0], b'G' | b'B') && offt[1..].iter().all(|c| matches!(c, b'G' | b'O'))) {
            let found = String::from_utf8_lossy(&offt).into_owned();
            let kind = FaultKind::Unsupported {
                what: format!("OFFT {found}"),
                remedy: "use G, B for the vector and G, O for the offsets",
            };
            self.fault(name.clone(), "OFFT", at, kind);
        }
        let orientation = match b.orientation {
            Orientation::Blank => defaults.map_or(Orientation::Blank, |d| d.orientation),
            stated => stated,
        };
        let (xa, xb) = (self.x(ga), self.x(gb));
        let v = match orientation {
            Orientation::Vector(v) if offt[0] == b'B' => Some(Vec3::from(v)),
            Orientation::Vector(v) => Some(self.cd_axes(ga).tr_mul(&Vec3::from(v))),
            Orientation::Grid(g0) => self.grid(g0, &name, "G0", at).map(|g0| self.x(g0) - xa),
            Orientation::Blank => {
                self.fault(name.clone(), "X1", at, FaultKind::Orientation);
                None
            }
        }?;
        let mut offsets = [Vec3::zeros(); 2];
        for (i, (w, g)) in b.offsets.iter().zip([ga, gb]).enumerate() {
            if *w == [0.0; 3] {
                continue;
            }
            let axes = match offt[i + 1] {
                b'O' => line_axes(xa, xb, v).unwrap_or_else(Mat3::identity),
                _ => self.cd_axes(g),
            };
            offsets[i] = axes.tr_mul(&Vec3::from(*w));
        }
        let (a, e) = (xa + offsets[0], xb + offsets[1]);
        let length = (e - a).norm();
        let scale = xa.norm().max(xb.norm());
        if !(length > 1e-12 * scale && length > 0.0) {
            self.fault(name, "GB", at, FaultKind::ZeroLength { length });
            return None;
        }
        let Some(axes) = line_axes(a, e, v) else {
            self.fault(name, "X1", at, FaultKind::Orientation);
            return None;
        };
        Some(Beam {
            id: b.id,
            is_beam: card == "CBEAM",
            grids: [ga, gb],
            property: property?,
            offsets,
            axes,
            pins: b.pins,
            warping: None,
            idle_points: false,
            at,
        })
    }

    /// The warping points of a CBEAM, SA and SB together, and whether its property has a warping constant.
    fn find_warping_points(
        &mut self,
        beam: &Beam,
        points: [Option<u32>; 2],
    ) -> Option<([GridIx; 2], bool)> {
        let name = format!("CBEAM {}", beam.id);
        let [Some(a), Some(b)] = points.map(|p| p.filter(|p| *p > 0)) else {
            if points.iter().flatten().any(|p| *p > 0) {
                let kind = FaultKind::Unsupported {
                    what: "a warping point at one end alone".into(),
                    remedy: "give SA and SB, or neither",
                };
                self.fault(name, "SA", beam.at, kind);
            }
            return None;
        };
        let (a, b) = (
            self.grid(a, &name, "SA", beam.at)?,
            self.grid(b, &name, "SB", beam.at)?,
        );
        if !(self.is_scalar(a) && self.is_scalar(b)) {
            let kind = FaultKind::Unsupported {
                what: "a warping point that is a grid".into(),
                remedy: "name SPOINTs as SA and SB",
            };
            self.fault(name, "SA", beam.at, kind);
            return None;
        }
        let property = self.model.beam_properties.get(beam.property.us())?;
        let warps = property.warping.iter().any(|cw| *cw != 0.0);
        Some(([a, b], warps))
    }
}

/// Returns the axes of a line element by rows: x from A to B, z = x cross v, y = z cross x. `None` if v is parallel to the line.
pub(super) fn line_axes(a: Vec3, b: Vec3, v: Vec3) -> Option<Mat3> {
    let x = unit(b - a)?;
    let v = unit(v)?;
    let z = x.cross(&v);
    if !(z.norm() > PARALLEL) {
        return None;
    }
    let z = unit(z)?;
    let y = z.cross(&x);
    Some(Mat3::from_rows(&[
        x.transpose(),
        y.transpose(),
        z.transpose(),
    ]))
}
