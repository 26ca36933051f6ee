//! PLOAD1.

use crate::model::build::Builder;
use crate::model::fault::FaultKind;
use crate::model::types::*;
use nastran::cards::Pload1;
use nastran::place::PlacedCard;

impl Builder<'_> {
    /// Returns the load along a bar or beam in element axes.
    ///
    /// # Reference
    /// MSC Nastran Quick Reference Guide, PLOAD1. LE and LEPR give positions as lengths, FR and FRPR as fractions. With the PR scales the intensity
    /// is per length projected across the load direction.
    pub(super) fn pload1(&mut self, p: &PlacedCard<Pload1>) -> Option<Load> {
        let name = format!("PLOAD1 {}", p.sid);
        let Some(beam) = self.model.beam_ix(p.element) else {
            let kind = FaultKind::Missing {
                what: "CBAR or CBEAM",
                id: p.element.into(),
            };
            self.fault(name, "EID", p.at, kind);
            return None;
        };
        let b = *self.model.beams.get(beam.us())?;
        let end = |i: usize| -> Option<Vec3> { Some(self.x(*b.grids.get(i)?) + b.offsets.get(i)?) };
        let length = (end(1)? - end(0)?).norm();
        let mut basic = Vec3::zeros();
        let axis = match p.kind[1] {
            b'X' => 0,
            b'Y' => 1,
            _ => 2,
        };
        basic[axis] = 1.0;
        let along_element = p.kind[2] == b'E';
        let direction = if along_element { basic } else { b.axes * basic };
        let projected = p.scale[2] == b'P';
        let factor = if projected && !along_element {
            (1.0 - direction.x * direction.x).max(0.0).sqrt()
        } else {
            1.0
        };
        let share = |x: f64| if p.scale[0] == b'L' { x / length } else { x };
        let from = share(p.x1);
        let to = p.x2.map_or(from, share);
        let values = if from == to {
            [p.p1, 0.0]
        } else {
            [p.p1, p.p2.unwrap_or(p.p1)].map(|v| v * factor)
        };
        // Tolerance for lengths that a deck states with few digits.
        const BEYOND: f64 = 1e-6;
        let inside = |x: f64| (-BEYOND..=1.0 + BEYOND).contains(&x);
        if !(inside(from) && inside(to) && from <= to) {
            let places = match p.x2 {
                Some(x2) => format!("from X1 {} to X2 {x2}", p.x1),
                None => format!("at X1 {}", p.x1),
            };
            let kind = FaultKind::Unsupported {
                what: format!("a load {places}, outside the element or from B to A,"),
                remedy: "give places on the element, X1 no farther than X2",
            };
            self.fault(name, "X1", p.at, kind);
            return None;
        }
        let vectors = values.map(|v| direction * v);
        let none = [Vec3::zeros(); 2];
        let (force, moment) = if p.kind[0] == b'F' {
            (vectors, none)
        } else {
            (none, vectors)
        };
        Some(Load::Line {
            beam,
            span: [from.clamp(0.0, 1.0), to.clamp(0.0, 1.0)],
            force,
            moment,
        })
    }
}
