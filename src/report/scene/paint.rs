//! Strain and stress values at the drawn vertices.

use super::part::{Owner, Part};
use super::types::FieldValues;
use crate::fe::CaseResult;
use crate::fe::strain_tensor::{largest_in_plane, largest_principal};
use crate::model::Model;

/// Values by element at bottom and top. For strain it is the largest principal strain by magnitude, signed; `NaN` without a value.
pub(super) struct Values {
    shells: Vec<[f64; 2]>,
    solids: Vec<[f64; 2]>,
}

impl Values {
    /// Returns the values of a field, in the order of the model's shells and solids.
    pub(super) fn of_field(model: &Model, values: &FieldValues) -> Self {
        match values {
            FieldValues::Strain(case) => Self::from_case(model, case),
            FieldValues::Magnitudes(of_shells) => {
                let mut shells = of_shells.clone();
                shells.resize(model.shells.len(), [f64::NAN; 2]);
                let solids = vec![[f64::NAN; 2]; model.solids.len()];
                Self { shells, solids }
            }
        }
    }

    /// Returns the strain of a load case: in the plane for shells, at the centre for solids (equal on both sides).
    pub(super) fn from_case(model: &Model, case: &CaseResult) -> Self {
        let mut shells = vec![[f64::NAN; 2]; model.shells.len()];
        for (ix, strain) in case.shells.elements.iter().zip(&case.shells.centre) {
            if let Some(slot) = shells.get_mut(ix.us()) {
                *slot = strain.map(largest_in_plane);
            }
        }
        let mut solids = vec![[f64::NAN; 2]; model.solids.len()];
        for (i, strain) in case.solids.elements.iter().zip(&case.solids.centre) {
            if let Some(slot) = solids.get_mut(*i) {
                *slot = [largest_principal(strain); 2];
            }
        }
        Self { shells, solids }
    }

    fn strain_of_owner(&self, owner: Owner) -> [f64; 2] {
        match owner {
            Owner::Shell(i) => self.shells[i],
            Owner::Solid(i) => self.solids[i],
            Owner::Panel => [f64::NAN; 2],
        }
    }

    /// Returns the strain at the vertices of a part, bottom and top. The value at a grid is the mean of its elements. A vertex takes, from the grids
    /// that it represents, the value with the largest magnitude.
    pub(super) fn strain_at_vertices(&self, part: &Part) -> [Vec<f64>; 2] {
        [0, 1].map(|side| {
            let mut sums = vec![(0.0, 0_u32); part.grids.len()];
            for (owner, corners) in &part.faces {
                let v = self.strain_of_owner(*owner)[side];
                let n = if corners[2] == corners[3] { 3 } else { 4 };
                for c in corners.iter().take(n).filter(|_| v.is_finite()) {
                    sums[*c as usize].0 += v;
                    sums[*c as usize].1 += 1;
                }
            }
            let mut out = vec![f64::NAN; part.drawn.vertices.len()];
            for ((sum, n), vertex) in sums.iter().zip(&part.drawn.vertex_of) {
                let slot = &mut out[*vertex as usize];
                let mean = sum / f64::from(*n);
                if *n > 0 && !(mean.abs() <= slot.abs()) {
                    *slot = mean;
                }
            }
            out
        })
    }
}
