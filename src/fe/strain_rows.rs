//! Strain of a solution place by place, in the element frame and as a tensor in the basic frame.

use super::shell_frame::{ShellPlace, shell_axes};
use super::strain_tensor::{Surface, basic_tensor, normal_strain_ratio};
use super::{CaseResult, PlaneStrain};
use crate::model::{BeamIx, Mat3, Model, ShellIx, Vec3};
use std::ops::Range;

/// Strain at one place of one element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainRow {
    /// Element id.
    pub element: u32,
    /// Card name: `CQUAD4`, `CBAR` ..
    pub card: &'static str,
    /// Place along or on the element.
    pub location: Location,
    /// Face or recovery point.
    pub point: Point,
    /// Element frame: exx, eyy, gxy (engineering shear). Bars: exx along the bar; eyy and gxy are NaN.
    pub local: PlaneStrain,
    /// Basic frame, tensor shear: xx, yy, zz, xy, yz, zx. Shells include the normal strain of plane stress. If the material does not give it
    /// ([`without_normal_strain`]), the tensor has only the strain in the surface, which is all that a gauge measures. Bars: exx along the axis
    /// alone, no lateral contraction.
    pub basic: [f64; 6],
}

/// Place along or on an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Location {
    /// Centre of a shell.
    Centre,
    /// A corner or an end.
    Grid(u32),
    /// Between the ends of a bar: x/xb.
    Station(f64),
}

/// A face of a shell, or a stress recovery point of a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Point {
    /// Bottom (Z1) or top (Z2).
    Surface(Surface),
    /// C, D, E, F (0 to 3).
    Recovery(usize),
}

/// Returns the number of elements with strain in a case: shells plus bars.
pub fn n_elements(case: &CaseResult) -> usize {
    case.shells.elements.len() + case.beams.elements.len()
}

/// Returns the number of rows that [`each_row`] gives for a whole case.
pub fn n_rows(model: &Model, case: &CaseResult) -> usize {
    let known = |strain: &[PlaneStrain; 2]| !strain.iter().flatten().all(|v| v.is_nan());
    let shells = case.shells.elements.iter().enumerate().map(|(i, ix)| {
        let Some(shell) = model.shells.get(ix.us()) else {
            return 0;
        };
        let centre = case.shells.centre.get(i).is_some_and(known);
        let corners = case.shells.corners.get(i).map_or(0, |corners| {
            let corners = corners.iter().zip(&shell.grids);
            let corners = corners.take(shell.shape.n_corners());
            corners
                .filter(|(strain, g)| known(strain) && model.grids.get(g.us()).is_some())
                .count()
        });
        2 * (usize::from(centre) + corners)
    });
    let beams = case.beams.elements.iter().zip(&case.beams.stations);
    let beams = beams.map(|(ix, stations)| match model.beams.get(ix.us()) {
        Some(_) => stations.iter().map(|(_, points)| points.len()).sum(),
        None => 0,
    });
    shells.sum::<usize>() + beams.sum::<usize>()
}

/// Calls `each` with the rows of the elements `range` of a case, numbered as in [`n_elements`].
///
/// Shells come first by id, then bars by id. A shell has its centre, then its corners G1 to G4, bottom before top. A bar has its stations from A to
/// B, each with points C, D, E, F. Places without strain are left out.
pub fn each_row(
    model: &Model,
    case: &CaseResult,
    range: Range<usize>,
    mut each: impl FnMut(&StrainRow),
) {
    for i in range {
        match i.checked_sub(case.shells.elements.len()) {
            None => shell_rows(model, case, i, &mut each),
            Some(beam) => beam_rows(model, case, beam, &mut each),
        }
    }
}

fn shell_rows(model: &Model, case: &CaseResult, i: usize, each: &mut impl FnMut(&StrainRow)) {
    let field = &case.shells;
    let Some(&ShellIx(ix)) = field.elements.get(i) else {
        return;
    };
    let Some(shell) = model.shells.get(ix as usize) else {
        return;
    };
    let ratio = Surface::BOTH.map(|s| {
        let property = model.shell_properties.get(shell.property.us());
        property
            .and_then(|p| normal_strain_ratio(model, p, s))
            .unwrap_or(0.0)
    });
    let mut put = |place: ShellPlace, location: Location, strain: &[PlaneStrain; 2]| {
        if strain.iter().flatten().all(|v| v.is_nan()) {
            return;
        }
        let axes = shell_axes(model, shell, place).unwrap_or_else(|| Mat3::repeat(f64::NAN));
        for (surface, &local) in Surface::BOTH.into_iter().zip(strain) {
            let ezz = ratio[surface.ix()] * (local[0] + local[1]);
            let basic = components(&basic_tensor(local, ezz, &axes));
            let point = Point::Surface(surface);
            each(&StrainRow {
                element: shell.id,
                card: shell.shape.card(),
                location,
                point,
                local,
                basic,
            });
        }
    };
    if let Some(strain) = field.centre.get(i) {
        put(ShellPlace::Centre, Location::Centre, strain);
    }
    let Some(corners) = field.corners.get(i) else {
        return;
    };
    for (c, strain) in corners.iter().enumerate().take(shell.shape.n_corners()) {
        if let Some(grid) = shell.grids.get(c).and_then(|g| model.grids.get(g.us())) {
            put(ShellPlace::Corner(c), Location::Grid(grid.id), strain);
        }
    }
}

fn beam_rows(model: &Model, case: &CaseResult, i: usize, each: &mut impl FnMut(&StrainRow)) {
    let field = &case.beams;
    let (Some(&BeamIx(ix)), Some(stations)) = (field.elements.get(i), field.stations.get(i)) else {
        return;
    };
    let Some(beam) = model.beams.get(ix as usize) else {
        return;
    };
    let axis: Vec3 = beam.axes.row(0).transpose();
    let end = |e: usize| {
        beam.grids
            .get(e)
            .and_then(|g| model.grids.get(g.us()))
            .map(|g| Location::Grid(g.id))
    };
    let card = if beam.is_beam { "CBEAM" } else { "CBAR" };
    for &(x_xb, points) in stations {
        let location = match x_xb {
            0.0 => end(0),
            1.0 => end(1),
            _ => None,
        };
        let location = location.unwrap_or(Location::Station(x_xb));
        for (p, exx) in points.into_iter().enumerate() {
            let basic = components(&(axis * axis.transpose() * exx));
            let local = [exx, f64::NAN, f64::NAN];
            each(&StrainRow {
                element: beam.id,
                card,
                location,
                point: Point::Recovery(p),
                local,
                basic,
            });
        }
    }
}

/// Returns the largest strain in any direction of the surface, or along the bar, without sign: `|m| + r` of Mohr's circle.
pub fn largest_strain(row: &StrainRow) -> f64 {
    let [exx, eyy, gxy] = row.local;
    match row.point {
        Point::Recovery(_) => exx.abs(),
        Point::Surface(_) => ((exx + eyy) / 2.0).abs() + ((exx - eyy) / 2.0).hypot(gxy / 2.0),
    }
}

/// Returns the `n` rows of a case with the largest strain ([`largest_strain`]), the largest first. Each element has at most one row: the centre of a
/// shell, or an end of a bar.
pub fn largest_strain_rows(model: &Model, case: &CaseResult, n: usize) -> Vec<StrainRow> {
    let mut best: Vec<StrainRow> = Vec::new();
    for i in 0..n_elements(case) {
        let mut top: Option<StrainRow> = None;
        each_row(model, case, i..i + 1, |row| {
            let corner = matches!(
                (row.point, row.location),
                (Point::Surface(_), Location::Grid(_))
            );
            let larger = |t: &StrainRow| largest_strain(row) > largest_strain(t);
            if !corner && top.as_ref().is_none_or(larger) {
                top = Some(*row);
            }
        });
        best.extend(top.filter(|t| largest_strain(t).is_finite()));
        if best.len() >= 4 * n.max(256) {
            keep_largest(&mut best, n);
        }
    }
    keep_largest(&mut best, n);
    best
}

fn keep_largest(rows: &mut Vec<StrainRow>, n: usize) {
    rows.sort_by(|a, b| largest_strain(b).total_cmp(&largest_strain(a)));
    rows.truncate(n);
}

/// Returns the ids of the shell properties with strain whose material does not determine the strain along the thickness (MAT2, MAT8, MAT9).
pub fn without_normal_strain(model: &Model, cases: &[CaseResult]) -> Vec<u32> {
    let mut seen = vec![false; model.shell_properties.len()];
    for case in cases {
        for &ShellIx(ix) in case.shells.elements.iter() {
            let shell = model.shells.get(ix as usize);
            if let Some(s) = shell.and_then(|s| seen.get_mut(s.property.us())) {
                *s = true;
            }
        }
    }
    let silent = |p: &&crate::model::ShellProperty| {
        Surface::BOTH
            .iter()
            .any(|s| normal_strain_ratio(model, p, *s).is_none())
    };
    let used = model.shell_properties.iter().zip(seen);
    used.filter_map(|(p, seen)| seen.then_some(p))
        .filter(silent)
        .map(|p| p.id)
        .collect()
}

/// Returns xx, yy, zz, xy, yz, zx of a symmetric tensor.
pub fn components(e: &Mat3) -> [f64; 6] {
    [
        e[(0, 0)],
        e[(1, 1)],
        e[(2, 2)],
        e[(0, 1)],
        e[(1, 2)],
        e[(2, 0)],
    ]
}
