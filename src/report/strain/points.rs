//! `gauges.vtu`.

use crate::gauge::Gauge;
use crate::model::Vec3;
use crate::report::{PointValues, write_points_vtu};
use crate::workflow::place::PlacedGauge;
use std::io::{Result, Write};

/// Writes gauges as points: axis, outward normal, leverage, expected strain.
/// # Errors
/// Errors of `w`.
pub fn gauges_vtu(w: &mut dyn Write, placed: &[PlacedGauge]) -> Result<()> {
    let three = |v: Vec3| [v.x, v.y, v.z];
    let vectors = |of: &dyn Fn(&Gauge) -> Vec3| {
        PointValues::Vectors(placed.iter().map(|p| three(of(&p.gauge))).collect())
    };
    let points: Vec<[f64; 3]> = placed.iter().map(|p| three(p.gauge.position)).collect();
    let arrays = [
        (
            "gauge".to_owned(),
            PointValues::Ids((1..).take(placed.len()).collect()),
        ),
        (
            "element".to_owned(),
            PointValues::Ids(placed.iter().map(|p| p.gauge.element).collect()),
        ),
        ("axis".to_owned(), vectors(&|g| g.direction)),
        ("outward".to_owned(), vectors(&Gauge::outward)),
        (
            "leverage".to_owned(),
            PointValues::Scalars(placed.iter().map(|p| p.leverage).collect()),
        ),
        (
            "expected strain, microstrain".to_owned(),
            PointValues::Scalars(placed.iter().map(|p| p.expected_microstrain).collect()),
        ),
    ];
    write_points_vtu(&points, &arrays, w)
}
