//! `load_unit`: all wheel loads were noted in one unit and read in another.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState};

/// What a load reads of the true one, and which units do that: noted for read. kgf = 9.80665 N, lbf = 4.4482216 N (both exact by definition
/// but for the digits of the pound-force), kip = 1000 lbf.
const UNITS: [(f64, &str); 10] = [
    (1e3, "newton for kilonewton"),
    (1e-3, "kilonewton for newton"),
    (101.971_621_3, "kilogram for kilonewton"),
    (
        0.101_971_621_3,
        "tonne for kilonewton, or kilogram for newton",
    ),
    (9.806_65, "kilonewton for tonne, or newton for kilogram"),
    (0.009_806_65, "kilonewton for kilogram"),
    (224.808_943_1, "pound for kilonewton"),
    (0.224_808_943_1, "kip for kilonewton, or pound for newton"),
    (4.448_221_615, "kilonewton for kip, or newton for pound"),
    (0.004_448_221_615, "kilonewton for pound"),
];

/// Noted loads = factor times the loads that act.
#[derive(Clone, Debug)]
pub struct LoadUnit {
    factor: f64,
    /// The unit noted and the one it is read in.
    words: &'static str,
}

impl LoadUnit {
    /// One for each pair of units, where there are loads.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        if frame.loads.iter().all(|f| *f == 0.0) {
            return Vec::new();
        }
        let one = |(factor, words): (f64, &'static str)| Self { factor, words };
        UNITS.into_iter().map(one).collect()
    }
}

impl StrainEffect for LoadUnit {
    fn id(&self) -> &str {
        "load_unit"
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    fn alter(&self, frame: &StrainFrame, _parameters: &[f64], state: &mut StrainState) {
        let [_, _, n_c] = state.shape;
        for row in state.columns.chunks_exact_mut(n_c.max(1)) {
            row.iter_mut()
                .take(frame.n_loads())
                .for_each(|f| *f /= self.factor);
        }
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::LoadUnit {
            factor: self.factor,
            words: self.words,
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "look up the unit that the wheel loads were noted in, and state it: [runs] units = { force = \"kN\" }".into()
    }
}
