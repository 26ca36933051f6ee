//! Tables of all bulk data names and case control commands, with their effects on linear statics, mass and modes.

mod effect;
mod lookup;
mod spelling;
mod table;

pub use effect::{CaseWord, Effect};
pub use lookup::{
    all_cards, all_words, case_word, changes_program, effect_of_card, nearest_card,
    nearest_parameter, nearest_word, request_of,
};
pub(super) use lookup::{executive_word, nearest_executive};
