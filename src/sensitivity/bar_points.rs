//! Recovery points of a CBAR with a PBARL section in results of another program.
//!
//! A CBAR has its neutral axis and its shear centre on one line. Nastran measures the points C to F of a PBARL from the shear centre of the section.
//! For a section with one axis of symmetry (T, CHAN, HAT, L), bending then causes strain as if the centroid were at the shear centre. The built-in
//! solver measures the points from the centroid.

use super::LoadCaseOf;
use crate::finding::{Finding, Severity};
use crate::gauge::{Gauge, Spot};
use crate::linalg::{Matrix2, Vector2};
use crate::model::{BeamIx, BeamProperty, Model};
use crate::units::MICROSTRAIN;

/// Centroids nearer to the shear centre than this share of the farthest point are rounding.
const APART: f64 = 1e-6;
/// Share of the sum of the second moments of the points below which a second moment is rounding. The points are then on a line.
const SINGULAR: f64 = 1e-12;
/// Differences of strain below this share of the strain of the points are rounding of single precision.
const DIFFERENT: f64 = 1e-4;

/// Returns a warning for each gauge on a point whose strain in the results is measured from the shear centre. It states both values under the load
/// with the largest difference.
pub fn bar_points(model: &Model, gauges: &[Gauge], loads: &[LoadCaseOf]) -> Vec<Finding> {
    gauges
        .iter()
        .filter_map(|gauge| {
            let (beam, point, station) = gauge.arms.iter().find_map(|arm| match arm.spot {
                Spot::Beam {
                    beam,
                    point,
                    station,
                } => Some((beam, point, station)),
                _ => None,
            })?;
            let property = property_of(model, beam)?;
            let values = loads.iter().filter_map(|l| {
                let values = stated_and_centroid_strain(property, l, (beam, point, station))?;
                Some((values, l))
            });
            let apart = |v: &[f64; 2]| (v[0] - v[1]).abs();
            let ([stated, right], load) =
                values.max_by(|a, b| apart(&a.0).total_cmp(&apart(&b.0)))?;
            Some(warning(gauge, property, (stated, right), load))
        })
        .collect()
}

fn warning(
    gauge: &Gauge,
    property: &BeamProperty,
    (stated, right): (f64, f64),
    load: &LoadCaseOf,
) -> Finding {
    let micro = |e: f64| format!("{:.4}", e / MICROSTRAIN);
    Finding::new(
        Severity::Warning,
        "bar-point-from-shear-centre",
        &gauge.name,
        format!(
            "gauge `{}` on CBAR {} (PBARL {}, section {}): the results state {} microstrain at its point under load `{}`. Nastran measures \
             the point from the shear centre of the section. Measured from the centroid the strain is {} microstrain",
            gauge.name,
            gauge.element,
            property.id,
            property.section_type,
            micro(stated),
            load.load.name,
            micro(right)
        ),
        "model the bar by CBEAM and PBEAML, or by a PBAR with points from the centroid. Or delete `results`, so that the built-in solver \
         computes the strain",
    )
}

/// Returns the property of a CBAR if the centroid of its section is off the shear centre.
fn property_of(model: &Model, beam: BeamIx) -> Option<&BeamProperty> {
    let property = model
        .beam_properties
        .get(model.beams.get(beam.us())?.property.us())?;
    let section = property.sections.first()?.1;
    let size = section
        .recovery
        .iter()
        .flatten()
        .fold(0.0_f64, |a, v| a.max(v.abs()));
    let off = property.bar_centroid[0].hypot(property.bar_centroid[1]);
    (off > APART * size).then_some(property)
}

/// Returns the strain at a point as stated in the results, and as measured from the centroid. `None` if the results measure from the centroid, or if
/// both values are equal.
fn stated_and_centroid_strain(
    property: &BeamProperty,
    load: &LoadCaseOf,
    (beam, point, station): (BeamIx, usize, f64),
) -> Option<[f64; 2]> {
    let (points, axial) = load.case.beams.strain_at(beam, station)?;
    let bending = points.map(|e| e - axial);
    let from_centroid = property.sections.first()?.1.recovery;
    let [yc, zc] = property.bar_centroid;
    let from_shear_centre = from_centroid.map(|[y, z]| [y + yc, z + zc]);
    let largest = bending.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    let (curvature, missed) = fit(&from_shear_centre, &bending)?;
    // Results of this program measure from the centroid.
    if let Some((_, other)) = fit(&from_centroid, &bending)
        && other < missed
        && missed > DIFFERENT * largest
    {
        return None;
    }
    let shift = yc * curvature.x + zc * curvature.y;
    (shift.abs() > DIFFERENT * largest).then(|| [points[point], points[point] - shift])
}

/// Slopes of strain along y and z with `bending = slope . point`, by least squares, and the largest miss.
fn fit(points: &[[f64; 2]; 4], bending: &[f64; 4]) -> Option<(Vector2<f64>, f64)> {
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for (p, e) in points.iter().zip(bending) {
        let p = Vector2::from(*p);
        normal += p * p.transpose();
        right += p * *e;
    }
    let cutoff = SINGULAR * normal.trace();
    let slope = normal.svd(true, true).solve(&right, cutoff).ok()?;
    let missed = points.iter().zip(bending);
    let missed = missed.map(|(p, e)| (slope.dot(&Vector2::from(*p)) - e).abs());
    Some((slope, missed.fold(0.0, f64::max)))
}
