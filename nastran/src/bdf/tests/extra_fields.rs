use super::{bulk, fault_texts, read_clean_deck};

#[test]
fn a_value_beyond_the_last_field_is_a_fault_with_its_field() {
    // Lengths of the cards, from their formats in the MSC Nastran Quick Reference Guide.
    for (text, at) in [
        (
            "FORCE,1,2,,1.,0.,1.,0.,5.\n",
            "test.bdf:1: `FORCE` field 9 ",
        ),
        (
            "FORCE,1,2,,1.,0.,1.,0.\n,7.\n",
            "test.bdf:1: `FORCE` field 12 ",
        ),
        (
            "MOMENT,1,2,,1.,0.,0.,1.\n+,1,2\n",
            "test.bdf:1: `MOMENT` field 12 ",
        ),
        ("SPC,1,2,23456,0.\n,2,1,.5\n", "test.bdf:1: `SPC` field 12 "),
        ("GRID,1,,0.,0.,0.\n,5,5\n", "test.bdf:1: `GRID` field 12 "),
        ("CROD,1,1,1,2,3\n", "test.bdf:1: `CROD` field 6 "),
        ("PROD,1,1,.01\n,.02\n", "test.bdf:1: `PROD` field 12 "),
        ("MAT1,1,1.,,0.\n,,,\n,5.\n", "test.bdf:1: `MAT1` field 22 "),
        (
            "GRAV,1,,10.,1.,0.,0.\n,5.\n",
            "test.bdf:1: `GRAV` field 12 ",
        ),
        ("CONM2,9,2,,5.,,,,7.\n", "test.bdf:1: `CONM2` field 9 "),
        ("CQUAD4,1,1,1,2,3,4\n,7\n", "test.bdf:1: `CQUAD4` field 12 "),
        (
            "MPC,1,2,1,1.,3,1,-1.\n,9,4,1,1.\n",
            "test.bdf:1: `MPC` field 12 ",
        ),
    ] {
        let found = fault_texts(&bulk(text));
        assert!(
            found.len() == 1 && found[0].starts_with(at) && found[0].contains("no such field"),
            "{text}: {found:?}"
        );
    }
}

#[test]
fn a_second_card_of_defaults_is_a_fault() {
    for card in [
        "GRDSET,,,,,,,3",
        "BAROR,,,,,0.,1.,0.",
        "BEAMOR,,,,,0.,1.,0.",
    ] {
        assert_eq!(
            fault_texts(&bulk(&format!("GRID,1\n{card}\n"))).len(),
            0,
            "{card}"
        );
        let found = fault_texts(&bulk(&format!("GRID,1\n{card}\n{card}\n")));
        assert!(
            found.len() == 1 && found[0].contains("2 cards"),
            "{found:?}"
        );
    }
}

#[test]
fn blank_fields_beyond_the_last_are_none() {
    let deck =
        read_clean_deck("FORCE,1,2,,1.,0.,1.,0.,,,,\nMPC,1,2,1,1.,3,1,-1.\n,,4,1,1.\n,,5,1,1.\n");
    assert_eq!(deck.cards.forces.len(), 1);
    assert_eq!(deck.cards.mpcs[0].terms.len(), 4);
}
