//! MDLPRM: model parameters that change the structure.

use super::types::UnsupportedCard;
use nastran::bdf::{Deck, OtherCard};

/// Parameters without influence on linear statics, mass and modes, whatever their value: output, memory, pivoting, nonlinear analysis, splines,
/// damping and rotors. A name that ends with `*` means all names with this beginning.
///
/// # Reference
/// MSC Nastran 2022.4 Quick Reference Guide, MDLPRM, table of parameters.
const WITHOUT_INFLUENCE: [&str; 32] = [
    "BCSOL129", "BOLTCNEL", "BRTOBM", "BUSHRT", "COMPN1", "DBCTOLE", "GEV1417", "GMOVR*", "GNLSTN",
    "HDF5", "H5*", "IGNSHBDN", "INTOUT", "LMT2MPC", "LRGDHFLT", "MLTSPLIN", "MPCF129", "MXMNMEM",
    "NLDIFF", "NLRSTRTM", "NONUPIV", "NSGRDS4", "PEXTS4", "PIVTHRSH", "PRD*", "PRT*", "RDBOTH",
    "RELAXF", "RSTIGNDP", "SOLCTLBC", "SPBLNDX", "STREQCNT",
];

/// Parameters that act on one kind of element, or on nonlinear analysis alone, and their default.
const DEFAULTS: [(&str, &str); 7] = [
    ("OFFDEF", "ELMOFF"),
    ("QR6ROT", "0"),
    ("QRSHEAR", "0"),
    ("RMRBE3RT", "0"),
    ("SHEARP", "GARVEY"),
    ("SHRTOQ4", "0"),
    ("TWBRBML", "0"),
];

/// Returns the model parameters of an MDLPRM entry that act on the solution.
///
/// OFFDEF acts on elements with offsets. The solver supports the standard offset ELMOFF. Other values move thermal loads and masses, and use the
/// shell normal at each grid as direction. An unknown parameter counts as acting.
pub(super) fn find_acting_parameters(deck: &Deck, card: &OtherCard) -> Vec<UnsupportedCard> {
    let fields = deck.fields(card);
    let filled = fields.iter().map(String::as_str).filter(|w| !w.is_empty());
    let mut words = filled.peekable();
    let mut named = Vec::new();
    while let Some(name) = words.next() {
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            continue;
        }
        let is_value = |w: &&str| !is_parameter(w);
        let value = words.next_if(is_value).unwrap_or_default();
        if acts(deck, name, value) {
            named.push(UnsupportedCard {
                card: format!("MDLPRM {name}"),
                id: None,
                at: card.at,
            });
        }
    }
    named
}

fn is_parameter(word: &str) -> bool {
    is_without_influence(word) || DEFAULTS.iter().any(|(name, _)| *name == word)
}

fn is_without_influence(name: &str) -> bool {
    WITHOUT_INFLUENCE.iter().any(|w| match w.strip_suffix('*') {
        Some(beginning) => name.starts_with(beginning),
        None => *w == name,
    })
}

fn acts(deck: &Deck, name: &str, value: &str) -> bool {
    if is_without_influence(name) || DEFAULTS.contains(&(name, value)) {
        return false;
    }
    name != "OFFDEF" || has_offsets(deck)
}

/// Returns whether a shell, bar or beam of the deck has an offset.
fn has_offsets(deck: &Deck) -> bool {
    let cards = &deck.cards;
    let is_off = |offsets: &[[f64; 3]; 2]| offsets.iter().flatten().any(|v| *v != 0.0);
    cards
        .shells
        .iter()
        .any(|s| s.zoffs.is_some_and(|z| z != 0.0))
        || cards.bars.iter().any(|b| is_off(&b.offsets))
        || cards.beams.iter().any(|b| is_off(&b.bar.offsets))
}

#[cfg(test)]
mod tests {
    use crate::model::Model;
    use nastran::bdf::{MemoryLoader, read_deck};

    /// Returns the names of the unsupported cards in a model of one bar with `offset` at its first end.
    fn list_unsupported_names(offset: &str, entries: &str) -> Vec<String> {
        let text = format!(
            "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nCBAR,1,1,1,2,0.,0.,1.\n,,,0.,0.,{offset}\n\
             PBAR,1,1,.01,1.-4,1.-4,1.-4\nMAT1,1,2.+11,,.3\n{entries}\nENDDATA\n"
        );
        let deck = read_deck("deck.bdf", text.into_bytes(), &mut MemoryLoader::default());
        assert!(deck.faults.is_empty(), "{:?}", deck.faults);
        let cards = Model::from_deck(&deck).0.unsupported_cards;
        cards.into_iter().map(|c| c.card).collect()
    }

    #[test]
    fn model_parameters_that_act_are_refused_and_the_others_are_not() {
        for (entry, named) in [
            ("MDLPRM,HDF5,1", &[][..]),
            ("MDLPRM  HDF5           0PRDOOC         1", &[]),
            ("MDLPRM  HDF5           0OFFDEF  LROFF", &["MDLPRM OFFDEF"]),
            ("MDLPRM,OFFDEF,ELMOFF,HDF5,0", &[]),
            ("MDLPRM,OFFDEF,LROFF", &["MDLPRM OFFDEF"]),
            ("MDLPRM,HDF5,1,OFFDEF,NDMTZ,QR6ROT,0", &["MDLPRM OFFDEF"]),
            (
                "mdlprm,hdf5,1,nonupiv,1,h5info,1,\n,qrshear,1",
                &["MDLPRM QRSHEAR"],
            ),
            ("MDLPRM  HDF5    1       $ OFFDEF LROFF", &[]),
            (
                "MDLPRM* TWBRBML                        1",
                &["MDLPRM TWBRBML"],
            ),
            ("MDLPRM,DELELAS", &["MDLPRM DELELAS"]),
            (
                "MDLPRM,DELELAS,.05,SHEARP,HARDER",
                &["MDLPRM DELELAS", "MDLPRM SHEARP"],
            ),
            ("MDLPRM,NEWNAME,3", &["MDLPRM NEWNAME"]),
        ] {
            assert_eq!(list_unsupported_names(".1", entry), named, "{entry}");
        }
        assert!(list_unsupported_names("0.", "MDLPRM,OFFDEF,LROFF").is_empty());
    }
}
