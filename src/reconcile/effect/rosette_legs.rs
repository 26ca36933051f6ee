//! `rosette_legs`: the legs of a rosette connected in another order.

use super::{Extension, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{Part, StrainFrame};

/// Channel i of the rosette reads leg `order[i]`.
#[derive(Clone, Debug)]
pub struct RosetteLegs {
    /// The channels, in file order.
    pub legs: Vec<usize>,
    /// Which leg each of them reads.
    pub order: Vec<usize>,
    /// Name of the first leg.
    pub name: String,
}

impl RosetteLegs {
    /// Every other order of two or three legs at one place.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        const ORDERS: [[usize; 3]; 5] = [[1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
        let mut out = Vec::new();
        for first in 0..frame.n_gauges() {
            let legs = frame.rosette(first);
            if legs.first() != Some(&first) {
                continue;
            }
            let name = gauge_name(frame, first);
            match legs.len() {
                2 => out.push(Self {
                    order: vec![legs[1], legs[0]],
                    legs,
                    name,
                }),
                3 => out.extend(ORDERS.iter().map(|o| Self {
                    order: o.iter().map(|&i| legs[i]).collect(),
                    legs: legs.clone(),
                    name: name.clone(),
                })),
                _ => {}
            }
        }
        out
    }
}

impl StrainEffect for RosetteLegs {
    fn id(&self) -> &'static str {
        "rosette_legs"
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
        let read: Vec<f64> = self
            .order
            .iter()
            .map(|&g| row.get(g).copied().unwrap_or(f64::NAN))
            .collect();
        for (&leg, value) in self.legs.iter().zip(read) {
            if let Some(cell) = row.get_mut(leg) {
                *cell = value;
            }
        }
    }
    fn extension(&self, frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        let order: Vec<String> = self.order.iter().map(|&g| gauge_name(frame, g)).collect();
        Extension::Channel {
            id: self.id(),
            gauge: order.join("+"),
            size: 1.0,
            unit: "1",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "follow the leads of the rosette at {}, or shunt one leg and see which channel moves",
            self.name
        )
    }
    fn gauges(&self) -> Vec<usize> {
        self.legs.clone()
    }
}
