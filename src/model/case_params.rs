//! Parameters in case control. A parameter above the subcases counts; one inside subcases counts if all subcases agree.

use super::types::UnsupportedCard;
use nastran::bdf::Deck;
use nastran::cards::Param;

/// Parameters that change the structure, which is the same in all subcases.
pub(super) const OF_STRUCTURE: [&str; 8] = [
    "WTMASS", "GRDPNT", "INREL", "K6ROT", "SNORM", "AUTOSPC", "COUPMASS", "OMID",
];

/// Returns the parameters that apply to every subcase, and a refusal for each parameter that differs between subcases.
pub(super) fn params_of_case_control(deck: &Deck) -> (Vec<Param>, Vec<UnsupportedCard>) {
    let subcases = deck.case_control.effective_subcases();
    let Some((first, others)) = subcases.split_first() else {
        return (Vec::new(), Vec::new());
    };
    let mut refused = Vec::new();
    for name in OF_STRUCTURE {
        let of = |params: &[Param]| params.iter().rev().find(|p| p.name == name).cloned();
        let common = of(&first.params);
        if let Some(odd) = others.iter().find(|s| of(&s.params) != common) {
            refused.push(UnsupportedCard {
                card: format!("PARAM,{name} that differs between subcases"),
                id: None,
                at: odd.at,
            });
        }
    }
    (first.params.clone(), refused)
}

#[cfg(test)]
mod tests {
    use crate::model::Model;
    use nastran::bdf::{MemoryLoader, read_deck};

    fn model(case_control: &str) -> Model {
        let text = format!("SOL 101\nCEND\n{case_control}\nBEGIN BULK\nGRID,1\nENDDATA\n");
        let deck = read_deck("deck.bdf", text.into_bytes(), &mut MemoryLoader::default());
        Model::from_deck(&deck).0
    }

    #[test]
    fn a_parameter_in_every_subcase_holds_for_the_structure() {
        let one = model("SUBCASE 1\nPARAM,WTMASS,2.\n");
        assert_eq!(one.params.wtmass, 2.0);
        let both = model("SUBCASE 1\nPARAM,WTMASS,2.\nSUBCASE 2\nPARAM,WTMASS,2.\n");
        assert_eq!((both.params.wtmass, both.unsupported_cards.len()), (2.0, 0));
    }

    #[test]
    fn a_parameter_that_differs_between_subcases_is_not_carried() {
        let differs = model("SUBCASE 1\nPARAM,WTMASS,2.\nSUBCASE 2\nPARAM,POST,-1\n");
        let cards: Vec<&str> = differs
            .unsupported_cards
            .iter()
            .map(|c| c.card.as_str())
            .collect();
        assert_eq!(cards, ["PARAM,WTMASS that differs between subcases"]);
    }
}
