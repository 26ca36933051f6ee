//! Strain of bars and beams: at the stations of a result, and between them where that is determined.

use super::element::beam::{BeamForces, LineLoad, StationStrain, strain_at};
use crate::model::{BeamIx, Section};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// Stations nearer to each other than this share of the length are one.
const SAME_STATION: f64 = 1e-6;
/// Stations at which the strain of a bar with loads between its ends is computed, in addition to its own.
const INNER: [f64; 3] = [0.25, 0.5, 0.75];

/// Axial strain of bars and beams at the stress recovery points C D E F.
#[derive(Clone, Debug, Default)]
pub struct BeamField {
    /// Elements with strain, ascending.
    pub elements: Arc<Vec<BeamIx>>,
    /// Stations (x/xb ascending) by element, each with the strain at C D E F, axial strain included.
    pub stations: Vec<Vec<(f64, [f64; 4])>>,
    /// Strain of the neutral axis (without bending) by element and station; NaN where the result does not determine it.
    pub axial: Vec<Vec<f64>>,
    /// Section forces of solved elements; `None` for strain of result files.
    pub(crate) solved: Option<SolvedBeams>,
    /// Elements of result files whose strain between stations is not determined, because loads act between the ends or the section changes along the
    /// element.
    pub(crate) stations_alone: BTreeSet<BeamIx>,
}

/// Section forces and sections of solved elements. They determine the strain at every station. The rows have the order of [`BeamField::elements`].
#[derive(Clone, Debug)]
pub(crate) struct SolvedBeams {
    pub(crate) shapes: Arc<Vec<BeamShape>>,
    pub(crate) forces: Vec<BeamForces>,
    /// Loads between the ends of elements, by row.
    pub(crate) loads: HashMap<usize, Vec<LineLoad>>,
}

/// Sections along an element.
#[derive(Clone, Debug)]
pub(crate) struct BeamShape {
    pub(crate) sections: Arc<Vec<(f64, Section)>>,
    pub(crate) e: f64,
    pub(crate) length: f64,
}

impl BeamField {
    /// Returns the strain of a bar or beam at a station: at C, D, E, F, and on the neutral axis. `None` if the field does not determine it.
    ///
    /// For solved elements, the strain follows from the section forces at the station, including loads between the ends, and from the section there.
    /// For result files, it is the strain at the station. Between two stations, it is linear if the bar is uniform without loads between its ends.
    pub fn strain_at(&self, beam: BeamIx, station: f64) -> Option<([f64; 4], f64)> {
        let row = self.elements.binary_search(&beam).ok()?;
        let stations = self.stations.get(row)?;
        let at = |i: usize| Some((stations.get(i)?.1, *self.axial.get(row)?.get(i)?));
        let same = |s: &(f64, [f64; 4])| (s.0 - station).abs() <= SAME_STATION;
        if let Some(i) = stations.iter().position(same) {
            return at(i);
        }
        if let Some(solved) = &self.solved {
            return solved
                .station_strain(row, station)
                .map(|s| (s.points, s.axial));
        }
        if self.stations_alone.contains(&beam) {
            return None;
        }
        let after = stations
            .iter()
            .position(|s| s.0 >= station)
            .unwrap_or(stations.len().saturating_sub(1));
        let before = after.saturating_sub(1);
        let (x0, x1) = (stations.get(before)?.0, stations.get(after)?.0);
        let ((p0, a0), (p1, a1)) = (at(before)?, at(after)?);
        if x1 <= x0 {
            return Some((p1, a1));
        }
        let share = ((station - x0) / (x1 - x0)).clamp(0.0, 1.0);
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Some((std::array::from_fn(|i| mix(p0[i], p1[i])), mix(a0, a1)))
    }

    /// Returns the stations between the ends where strain may exceed the strain at the element's own stations. Empty without loads between the ends.
    pub fn inner_stations(&self, beam: BeamIx) -> &'static [f64] {
        let row = self.elements.binary_search(&beam).ok();
        let loaded = row.zip(self.solved.as_ref());
        match loaded.is_some_and(|(row, solved)| solved.loads.contains_key(&row)) {
            true => &INNER,
            false => &[],
        }
    }

    /// Returns whether the result states the strain of this bar or beam only at its stations, not between them.
    pub fn is_at_stations_alone(&self, beam: BeamIx) -> bool {
        self.stations_alone.contains(&beam)
    }

    /// Marks bars and beams with loads between their ends. The result does not determine their strain between stations.
    pub fn mark_loaded(&mut self, beams: impl IntoIterator<Item = BeamIx>) {
        self.stations_alone.extend(beams);
    }
}

impl SolvedBeams {
    fn station_strain(&self, row: usize, station: f64) -> Option<StationStrain> {
        let (shape, forces) = (self.shapes.get(row)?, self.forces.get(row)?);
        let loads = self.loads.get(&row).map_or(&[][..], Vec::as_slice);
        let along = (shape.sections.as_slice(), shape.e, shape.length);
        Some(strain_at(along, forces, loads, station))
    }
}
