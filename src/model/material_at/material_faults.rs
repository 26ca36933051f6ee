//! Refused cards and faults of temperature dependent materials.

use crate::model::fault::ModelFault;
use crate::model::types::UnsupportedCard;
use nastran::place::Place;

/// Unsupported cards, and faults.
#[derive(Debug, Default)]
pub(in crate::model) struct MaterialFaults {
    pub refused: Vec<UnsupportedCard>,
    pub faults: Vec<ModelFault>,
}

impl MaterialFaults {
    pub(super) fn refuse(&mut self, card: String, id: Option<u32>, at: Place) {
        self.refused.push(UnsupportedCard { card, id, at });
    }
}
