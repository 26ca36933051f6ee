//! Bar and beam rows of one subcase.

use super::ids::Ids;
use super::tally::{Irregularity, Tally};
use crate::fe::BeamField;
use crate::fe::element::beam::section_at;
use crate::linalg::{Matrix, dense};
use crate::model::{BeamIx, MaterialKind, Model, Section};
use nastran::results::columns;
use nastran::results::{Block, Quantity, Rows};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Strain at a station.
#[derive(Clone, Copy)]
struct Station {
    /// x/xb.
    at: f64,
    /// Strain at C D E F.
    points: [f64; 4],
    /// Strain of the neutral axis; NaN if the rows do not contain it.
    axial: f64,
}

/// Collector of the bar and beam rows of one subcase, block by block.
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

    /// Returns whether the rows belong to bars or beams.
    pub(super) fn takes(rows: &Rows) -> bool {
        [columns::BAR, columns::BAR_STATION, columns::BEAM].contains(&rows.columns)
    }

    /// Adds a block of strain or stress rows.
    ///
    /// CBAR rows contain the bending strain at C D E F, and the axial strain once. The two are added. CBEAM rows contain the sum. The rows of a CBAR
    /// with stations contain the sum or bending alone; their largest value shows which.
    pub(super) fn add(&mut self, block: &Block, rows: &Rows, tally: &mut Tally) {
        let mut ids = Ids::new(&self.model.beams, |b| b.id);
        let mut last: Option<u32> = None;
        for (i, id) in rows.ids.iter().enumerate() {
            let new = last.replace(id.entity) != Some(id.entity);
            // `deck_result_consistency` reports elements that the model lacks.
            let Some(ix) = ids.find(id.entity) else {
                continue;
            };
            let scale = match block.quantity {
                Quantity::Stress => {
                    let e = modulus(self.model, ix);
                    if new {
                        tally.add(
                            if e.is_some() {
                                Irregularity::BeamFromStress
                            } else {
                                Irregularity::NotIsotropic
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
            for s in &mut found {
                s.points = s.points.map(|v| v * scale);
                s.axial *= scale;
                if s.axial.is_nan() {
                    s.axial = axial_between(self.model, ix, s.at, s.points);
                }
            }
            let Ok(ix) = u32::try_from(ix) else { continue };
            let list = self.stations.entry(BeamIx(ix)).or_default();
            if new {
                list.clear();
            }
            list.extend(found);
        }
    }

    /// Returns the field with ascending elements and stations.
    pub(super) fn finish(self) -> BeamField {
        let (elements, mut stations): (Vec<_>, Vec<Vec<Station>>) =
            self.stations.into_iter().unzip();
        stations
            .iter_mut()
            .for_each(|s| s.sort_by(|a, b| a.at.total_cmp(&b.at)));
        let all = stations.iter();
        let model = self.model;
        let tapered = elements.iter().filter(|ix| is_tapered(model, **ix));
        BeamField {
            stations_alone: tapered.copied().collect(),
            elements: Arc::new(elements),
            axial: all
                .clone()
                .map(|b| b.iter().map(|s| s.axial).collect())
                .collect(),
            stations: all
                .map(|b| b.iter().map(|s| (s.at, s.points)).collect())
                .collect(),
            solved: None,
        }
    }
}

/// Returns whether strain along a bar without loads between its ends is not a straight line, because its section changes.
fn is_tapered(model: &Model, beam: BeamIx) -> bool {
    let beam = model.beams.get(beam.us());
    let property = beam.and_then(|b| model.beam_properties.get(b.property.us()));
    property.is_some_and(|p| {
        p.sections.windows(2).any(|w| {
            let of = |s: &Section| ([s.area, s.i1, s.i2, s.i12], s.recovery, s.neutral);
            of(&w[0].1) != of(&w[1].1)
        })
    })
}

/// Computes the strain of the neutral axis from the strain of four points, with the plane through them.
///
/// The result is the weighted mean whose weights put the points' centre onto the axis. NaN if no such weights exist (points on a line that misses the
/// axis).
fn axial_between(model: &Model, beam: usize, station: f64, points: [f64; 4]) -> f64 {
    /// Misses of the axis below this share of the points' spread are rounding.
    const ON_AXIS: f64 = 1e-9;
    let property = model
        .beams
        .get(beam)
        .and_then(|b| model.beam_properties.get(b.property.us()));
    let Some(section) = property.map(|p| section_at(&p.sections, station)) else {
        return f64::NAN;
    };
    let off = section
        .recovery
        .map(|p| [p[0] - section.neutral[0], p[1] - section.neutral[1]]);
    let size = off.iter().flatten().fold(0.0_f64, |a, v| a.max(v.abs()));
    if size == 0.0 {
        return points[0];
    }
    // Least squares of w with sum w = 1, sum w y = 0, sum w z = 0: w = A' (A A')^+ b.
    let a = Matrix::from_fn(3, 4, |r, c| match r {
        0 => 1.0,
        r => off[c][r - 1] / size,
    });
    let Some(weights) = dense::shortest_solution(&a, &[1.0, 0.0, 0.0], ON_AXIS) else {
        return f64::NAN;
    };
    let missed = (0..3).any(|r| {
        let sum: f64 = (0..4).map(|c| a[(r, c)] * weights[c]).sum();
        (sum - if r == 0 { 1.0 } else { 0.0 }).abs() > ON_AXIS
    });
    match missed {
        true => f64::NAN,
        false => weights.iter().zip(points).map(|(w, e)| w * e).sum(),
    }
}

/// Stations of one row.
fn stations(names: &[&str], row: &[f64]) -> Vec<Station> {
    match *row {
        // s1a s2a s3a s4a axial smaxa smina mst s1b s2b s3b s4b smaxb sminb msc.
        [a1, a2, a3, a4, axial, _, _, _, b1, b2, b3, b4, _, _, _] if names == columns::BAR => {
            vec![
                Station {
                    at: 0.0,
                    points: [a1, a2, a3, a4].map(|s| s + axial),
                    axial,
                },
                Station {
                    at: 1.0,
                    points: [b1, b2, b3, b4].map(|s| s + axial),
                    axial,
                },
            ]
        }
        // x_xb s1 s2 s3 s4 axial smax smin ms.
        [x, s1, s2, s3, s4, axial, smax, _, _] if names == columns::BAR_STATION => {
            let points = [s1, s2, s3, s4];
            let largest = points.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let bending_alone = (largest + axial - smax).abs() < (largest - smax).abs();
            let points = match bending_alone {
                true => points.map(|s| s + axial),
                false => points,
            };
            vec![Station {
                at: x,
                points,
                axial,
            }]
        }
        // x_xb sxc sxd sxe sxf smax smin mst msc.
        [x, c, d, e, f, ..] if names == columns::BEAM => vec![Station {
            at: x,
            points: [c, d, e, f],
            axial: f64::NAN,
        }],
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
