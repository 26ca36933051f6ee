//! SNORM: normals of shells at grids.

use super::build::Builder;
use super::fault::FaultKind;
use super::frame::unit;
use super::types::*;
use nastran::cards::CoordKind;
use std::collections::HashMap;

impl Builder<'_> {
    pub(super) fn normals(&mut self) {
        let cards = self.cards;
        let mut first = HashMap::new();
        for s in &cards.snorms {
            let name = format!("SNORM {}", s.grid);
            let (Some(grid), Some(f)) = (
                self.grid(s.grid, &name, "GID", s.at),
                self.frame(s.cid.into(), &name, "CID", s.at),
            ) else {
                continue;
            };
            if let Some(first) = first.insert(grid, s.at) {
                let what = "normal of the grid";
                self.fault(name, "GID", s.at, FaultKind::Duplicate { what, first });
                continue;
            }
            let Some(frame) = self.model.frames.get(f.us()) else {
                continue;
            };
            if frame.kind != CoordKind::Rectangular {
                let kind = FaultKind::Unsupported {
                    what: "a normal in a curved coordinate system".to_owned(),
                    remedy: "give the normal in a rectangular system",
                };
                self.fault(name, "CID", s.at, kind);
                continue;
            }
            match unit(frame.axes.tr_mul(&Vec3::from(s.n))) {
                Some(n) => self.model.normals.push(GridNormal { grid, n, at: s.at }),
                None => {
                    let kind = FaultKind::Degenerate { what: "direction" };
                    self.fault(name, "N1", s.at, kind);
                }
            }
        }
        self.model.normals.sort_by_key(|n| n.grid);
    }
}
