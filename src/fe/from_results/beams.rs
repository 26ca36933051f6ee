//! Bar and beam rows of one subcase.

use super::ids::Ids;
use super::tally::{Met, Tally};
use crate::fe::BeamField;
use crate::model::{BeamIx, MaterialKind, Model};
use nastran::results::columns;
use nastran::results::{Block, Quantity, Rows};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A station: x/xb and the strain at C D E F.
type Station = (f64, [f64; 4]);

/// Collects the bar and beam rows of one subcase, block by block.
pub(super) struct BeamCollector<'m> {
    model: &'m Model,
    stations: BTreeMap<BeamIx, Vec<Station>>,
}

impl<'m> BeamCollector<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            stations: BTreeMap::new(),
        }
    }

    /// Whether the rows are those of bars or beams.
    pub(super) fn takes(rows: &Rows) -> bool {
        [columns::BAR, columns::BAR_STATION, columns::BEAM].contains(&rows.columns)
    }

    /// Adds a block of strain or stress rows.
    ///
    /// CBAR rows hold bending alone at C D E F, and the axial part once: it is added. CBEAM rows hold the sum. The rows of a CBAR with
    /// stations state the sum or bending alone, told apart by their own largest value.
    pub(super) fn add(&mut self, block: &Block, rows: &Rows, tally: &mut Tally) {
        let mut ids = Ids::new(&self.model.beams, |b| b.id);
        let mut last: Option<u32> = None;
        for (i, id) in rows.ids.iter().enumerate() {
            let new = last.replace(id.entity) != Some(id.entity);
            // Elements that the model lacks are told of by `deck_result_consistency`.
            let Some(ix) = ids.find(id.entity) else {
                continue;
            };
            let scale = match block.quantity {
                Quantity::Stress => {
                    let e = modulus(self.model, ix);
                    if new {
                        tally.add(
                            if e.is_some() {
                                Met::BeamFromStress
                            } else {
                                Met::NotIsotropic
                            },
                            id.entity,
                        );
                    }
                    match e {
                        Some(e) => 1.0 / e,
                        None => continue,
                    }
                }
                _ => 1.0,
            };
            let mut found = stations(rows.columns, rows.row(i));
            found
                .iter_mut()
                .for_each(|(_, s)| *s = s.map(|v| v * scale));
            let Ok(ix) = u32::try_from(ix) else { continue };
            let list = self.stations.entry(BeamIx(ix)).or_default();
            if new {
                list.clear();
            }
            list.extend(found);
        }
    }

    /// The field, elements and stations ascending.
    pub(super) fn finish(self) -> BeamField {
        let (elements, mut stations): (Vec<_>, Vec<Vec<Station>>) =
            self.stations.into_iter().unzip();
        stations
            .iter_mut()
            .for_each(|s| s.sort_by(|a, b| a.0.total_cmp(&b.0)));
        BeamField {
            elements: Arc::new(elements),
            stations,
        }
    }
}

/// Stations of one row.
fn stations(names: &[&str], row: &[f64]) -> Vec<Station> {
    match *row {
        // s1a s2a s3a s4a axial smaxa smina mst s1b s2b s3b s4b smaxb sminb msc.
        [a1, a2, a3, a4, axial, _, _, _, b1, b2, b3, b4, _, _, _] if names == columns::BAR => {
            vec![
                (0.0, [a1, a2, a3, a4].map(|s| s + axial)),
                (1.0, [b1, b2, b3, b4].map(|s| s + axial)),
            ]
        }
        // x_xb s1 s2 s3 s4 axial smax smin ms.
        [x, s1, s2, s3, s4, axial, smax, _, _] if names == columns::BAR_STATION => {
            let points = [s1, s2, s3, s4];
            let largest = points.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let bending_alone = (largest + axial - smax).abs() < (largest - smax).abs();
            vec![(
                x,
                if bending_alone {
                    points.map(|s| s + axial)
                } else {
                    points
                },
            )]
        }
        // x_xb sxc sxd sxe sxf smax smin mst msc.
        [x, c, d, e, f, ..] if names == columns::BEAM => vec![(x, [c, d, e, f])],
        _ => Vec::new(),
    }
}

fn modulus(model: &Model, beam: usize) -> Option<f64> {
    let property = model
        .beam_properties
        .get(model.beams.get(beam)?.property.us())?;
    match model.materials.get(property.material.us())?.kind {
        MaterialKind::Isotropic { e, .. } => Some(e),
        _ => None,
    }
}
