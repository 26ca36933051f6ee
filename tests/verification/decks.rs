//! Reads decks of `../shared` into models.

use nastran::bdf::{IncludeRequest, LoadedFile, Loader, read_deck};
use strainbridge::model::Model;

pub use crate::support::find_shared_path;

struct Files;

impl Loader for Files {
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String> {
        for path in request.candidates(|_| None)? {
            if let Ok(bytes) = std::fs::read(&path) {
                return Ok(LoadedFile {
                    path,
                    bytes,
                    differing_path: None,
                });
            }
        }
        Err("not found".to_owned())
    }
}

/// Returns the model of a deck and its case control. Faults of weight error fail the test.
pub fn model_of(path: &std::path::Path) -> (Model, nastran::bdf::CaseControl) {
    let bytes = std::fs::read(path).unwrap();
    let deck = read_deck(&path.to_string_lossy(), bytes, &mut Files);
    let (model, _) = Model::from_cards(&deck.cards);
    (model, deck.case_control)
}

/// Returns the model of a deck and its case control, and prints the faults.
///
/// The model contains the unsupported cards. A solver refuses them.
pub fn faulty_model_of(path: &std::path::Path) -> (Model, nastran::bdf::CaseControl) {
    let bytes = std::fs::read(path).unwrap();
    let deck = read_deck(&path.to_string_lossy(), bytes, &mut Files);
    let (model, faults) = Model::from_deck(&deck);
    for fault in &faults {
        eprintln!("{}: {fault}", path.display());
    }
    (model, deck.case_control)
}
