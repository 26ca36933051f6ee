//! `gauge_swap`: two channels exchanged.

use super::{Extension, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{Part, StrainFrame};

/// Channel a reads what b feels, and the other way round.
#[derive(Clone, Debug)]
pub struct GaugeSwap {
    /// The two gauges.
    pub pair: [usize; 2],
    /// `a+b`.
    pub name: String,
}

impl GaugeSwap {
    /// Every pair that is no pair of legs of one rosette.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        let n = frame.n_gauges();
        let mut out = Vec::new();
        for a in 0..n {
            let legs = frame.rosette(a);
            for b in (a + 1..n).filter(|b| !legs.contains(b)) {
                out.push(Self {
                    pair: [a, b],
                    name: format!("{}+{}", gauge_name(frame, a), gauge_name(frame, b)),
                });
            }
        }
        out
    }
}

impl StrainEffect for GaugeSwap {
    fn id(&self) -> &'static str {
        "gauge_swap"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Reading
    }
    fn read(
        &self,
        _frame: &StrainFrame,
        _parameters: &[f64],
        _run: usize,
        row: &mut [f64],
        _part: Part,
    ) {
        let [a, b] = self.pair;
        if a < row.len() && b < row.len() {
            row.swap(a, b);
        }
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::Channel {
            id: self.id(),
            gauge: self.name.clone(),
            size: 1.0,
            unit: "1",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "warm one of the gauges {} with a hand and see which channel moves",
            self.name.replace('+', " and ")
        )
    }
    fn gauges(&self) -> Vec<usize> {
        self.pair.to_vec()
    }
}
