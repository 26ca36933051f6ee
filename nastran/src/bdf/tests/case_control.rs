use super::super::{Selection, SubcaseKind};
use super::{bulk, fault_texts, read_clean_deck};

const DECK: &str = "\
NASTRAN SYSTEM(442)=-1
ID A,B
SOL SESTATIC $ statics
TIME 5
CEND
TITLE = Truck, frame
  ECHO = NONE
SPC = 1
SET 1 = 1, 5 THRU 9 EXCEPT 6,7, 20,
        30 THRU 40 BY 5
SET 2 = ALL EXCEPT 3
STRAIN(PLOT,FIBER) = ALL
DISP(PLOT)=2
TEMP(INIT)=4
PARAM,POST,-1
SUBCASE 11 $ front left
  SUBTITLE=front
  LABEL = LF.FZ
  LOAD=101
  STRAIN(PLOT,STRCUR,CORNER) = 1
  spcforces = none
SUBCASE 12
  LOAD 102
  SPC=2
  SET 1 = 99
  MPC = 7
  SUPORT1 = 3
  TEMPERATURE(LOAD) = 8
  DEFORM = 9
SUBCOM 20
  SUBSEQ = 1., -1.
OUTPUT(PLOT)
  SET 1=ALL EXCEPT PLOTEL
  PLOT SET 1
BEGIN BULK
GRID,1
ENDDATA
";

#[test]
fn subcases_hold_what_they_select() {
    let deck = read_clean_deck(DECK);
    assert_eq!(
        (deck.sol, deck.sol_text.as_deref()),
        (Some(101), Some("SESTATIC"))
    );
    let case = &deck.case_control;
    assert_eq!(case.global.title.as_deref(), Some("Truck, frame"));
    let [a, b, c] = case.subcases.as_slice() else {
        panic!("{:?}", case.subcases)
    };
    assert_eq!(
        (
            a.id,
            a.load,
            a.spc,
            a.subtitle.as_deref(),
            a.label.as_deref()
        ),
        (11, Some(101), None, Some("front"), Some("LF.FZ"))
    );
    assert_eq!(
        (b.id, b.load, b.spc, b.mpc, b.suport1),
        (12, Some(102), Some(2), Some(7), Some(3))
    );
    assert_eq!(
        (b.temperature_load, b.temperature_initial, b.deform),
        (Some(8), None, Some(9))
    );
    assert_eq!(
        (c.id, c.kind, c.sequence.as_slice()),
        (20, SubcaseKind::Subcom, [1.0, -1.0].as_slice())
    );
    assert_eq!(deck.cards.grids.len(), 1);
}

#[test]
fn a_subcase_inherits_what_it_does_not_state() {
    let deck = read_clean_deck(DECK);
    let case = &deck.case_control;
    let a = case.effective_subcase(&case.subcases[0]);
    assert_eq!(
        (a.spc, a.temperature_initial, a.title.as_deref()),
        (Some(1), Some(4), Some("Truck, frame"))
    );
    let strain = a.request("STRAIN").unwrap();
    assert_eq!(strain.value, Selection::Set(1));
    assert!(strain.has("STRCUR") && !strain.has("FIBER"));
    assert_eq!(a.request("DISPLACEMENT").unwrap().value, Selection::Set(2));
    assert_eq!(a.request("SPCFORCES").unwrap().value, Selection::None);
    let b = case.effective_subcase(&case.subcases[1]);
    assert_eq!(b.spc, Some(2));
    assert!(b.request("STRAIN").unwrap().has("FIBER"));
    assert!(b.sets[&1].has(99) && !b.sets[&1].has(5));
    assert_eq!(deck.param("POST").unwrap().values[0].as_f64(), Some(-1.0));
}

#[test]
fn sets_list_ids_ranges_and_exceptions() {
    let deck = read_clean_deck(DECK);
    let one = &deck.case_control.global.sets[&1];
    let have: Vec<u32> = (0..50).filter(|&id| one.has(id)).collect();
    assert_eq!(have, [1, 5, 8, 9, 20, 30, 35, 40]);
    let two = &deck.case_control.global.sets[&2];
    assert!(two.has(1) && !two.has(3));
}

#[test]
fn an_exception_ends_outside_its_range() {
    let read = |list: &str| {
        let deck = read_clean_deck(&format!(
            "SOL 101\nCEND\nSET 1 = {list}\nBEGIN BULK\nGRID,1\n"
        ));
        let set = &deck.case_control.global.sets[&1];
        (0..400).filter(|&id| set.has(id)).collect::<Vec<u32>>()
    };
    let ids = |ranges: &[std::ops::RangeInclusive<u32>]| -> Vec<u32> {
        ranges.iter().cloned().flatten().collect()
    };
    for (list, have) in [
        (
            "1 THRU 10 EXCEPT 5,7,\n 11 THRU 13 EXCEPT 12,40",
            ids(&[1..=4, 6..=6, 8..=11, 13..=13, 40..=40]),
        ),
        (
            "1 THRU 10 EXCEPT 5, 20 THRU 22",
            ids(&[1..=4, 6..=10, 20..=22]),
        ),
        (
            "5, 10 THRU 55 EXCEPT 15,16,77,100 THRU 300",
            ids(&[5..=5, 10..=14, 17..=55, 77..=77, 100..=300]),
        ),
        // An id below the range is outside the range, too.
        ("10 THRU 12 EXCEPT 11, 3", ids(&[3..=3, 10..=10, 12..=12])),
        (
            "1 THRU 9 BY 2 EXCEPT 5, 10 THRU 14 BY 4",
            vec![1, 3, 7, 9, 10, 14],
        ),
    ] {
        assert_eq!(read(list), have, "{list}");
    }
}

#[test]
fn thru_in_a_list_behind_except_is_a_fault() {
    // MSC Nastran Quick Reference Guide, SET: "a THRU may not be within an EXCEPT"
    for list in [
        "1 THRU 12 EXCEPT 3 THRU 10",
        "1 THRU 12 EXCEPT 3 THRU 10, 20",
        "1 THRU 10 EXCEPT 5, 8 THRU 12",
        "1 THRU 10 EXCEPT 5, 3 THRU 12",
        "1 THRU 10 EXCEPT 5, 8 THRU 6",
        "1 THRU 10 EXCEPT THRU 6",
    ] {
        let text = format!("SOL 101\nCEND\nSET 1 = {list}\nBEGIN BULK\nGRID,1\n");
        let faults = fault_texts(&bulk(&text));
        assert!(
            faults.len() == 1 && faults[0].contains("SET"),
            "{list}: {faults:?}"
        );
    }
}

#[test]
fn a_deck_without_subcases_has_one() {
    let deck = read_clean_deck("SOL 101\nCEND\nLOAD=5\nBEGIN BULK\nGRID,1\n");
    let all = deck.case_control.effective_subcases();
    assert_eq!((all.len(), all[0].id, all[0].load), (1, 1, Some(5)));
}

#[test]
fn bulk_data_alone_is_recognised() {
    let deck =
        read_clean_deck("$ from a mesher\nGRID,1,,0.,0.,0.\nLOAD,5,1.,1.,2\nPARAM,POST,-1\n");
    assert_eq!(
        (
            deck.cards.grids.len(),
            deck.cards.loads.len(),
            deck.cards.params.len()
        ),
        (1, 1, 1)
    );
    assert_eq!(deck.sol, None);
}

#[test]
fn a_deck_may_begin_with_begin_bulk() {
    let deck = read_clean_deck("BEGIN BULK\nGRID,1\nENDDATA\n");
    assert_eq!(deck.cards.grids.len(), 1);
}

#[test]
fn faults_of_case_control_name_the_statement() {
    let deck = bulk("SOL 101\nCEND\nLOAD = FIVE\nSUBCASE\nSET 3 = 1 THRU X\nBEGIN BULK\n");
    assert_eq!(fault_texts(&deck).len(), 3);
    assert!(fault_texts(&deck)[0].starts_with("test.bdf:3: `LOAD`: a set number is needed: FIVE"));
}

#[test]
fn requests_may_list_ids_and_unread_ones_may_hold_anything() {
    let deck = read_clean_deck(
        "SOL 101\nCEND\nESE = 1,2\nEKE(THRESH=.01) = 1 THRU 5,\n 9\nGPFORCE = TIME1\nSTRAIN(CORNER) = 4, 7 THRU 9 EXCEPT 8\nBEGIN BULK\n",
    );
    let strain = deck.case_control.global.request("STRAIN").unwrap();
    let Selection::Ids(ids) = &strain.value else {
        panic!("{strain:?}")
    };
    let have: Vec<u32> = (0..20).filter(|&id| ids.has(id)).collect();
    assert_eq!(have, [4, 7, 9]);
    assert!(strain.has("CORNER"));
    assert_eq!(
        fault_texts(&bulk("SOL 101\nCEND\nSTRAIN = SOME\nBEGIN BULK\n")).len(),
        1
    );
}

#[test]
fn sets_list_types_of_elements_and_exceptions() {
    let deck = read_clean_deck(
        "SOL 101\nCEND\nSET 2 = QUAD4 TRIA3 EXCEPT 21\nSET 3 = ALL EXCEPT CTRIA3, 30 THRU 40\nSET 4 = SHEAR, INCLUDE ELEMENTS 5, GRID POINTS 6 THRU 9\nSET 10 BAR, EXCEPT 7\nBEGIN BULK\n",
    );
    let sets = &deck.case_control.global.sets;
    let has = |set: u32, id: u32, card: &str| sets[&set].has_element(id, card);
    assert!(has(2, 20, "CQUAD4") && has(2, 22, "CTRIA3"));
    assert!(!has(2, 21, "CQUAD4") && !has(2, 20, "CBAR"));
    assert!(has(3, 20, "CQUAD4") && !has(3, 20, "CTRIA3") && !has(3, 35, "CQUAD4"));
    assert!(has(4, 1, "CSHEAR") && has(4, 5, "CBAR") && !has(4, 6, "CBAR"));
    assert!(has(10, 8, "CBAR") && !has(10, 7, "CBAR"));
}

#[test]
fn an_exception_from_single_ids_is_refused() {
    // EXCEPT follows a range, ALL or types.
    for items in ["1, 2, 3 EXCEPT 2", "EXCEPT 2"] {
        let deck = bulk(&format!("SOL 101\nCEND\nSET 1 = {items}\nBEGIN BULK\n"));
        assert_eq!(fault_texts(&deck).len(), 1, "{items}");
    }
}

#[test]
fn statements_between_skip_on_and_skip_off_are_not_carried_out() {
    for [on, off] in [
        ["SKIP ON", "SKIP OFF"],
        ["SKIPON", "SKIPOFF"],
        ["SKIP=ON", "SKIP = OFF"],
    ] {
        let text = format!(
            "SOL 101\nCEND\nLOAD = 1\n{on}\nLOAD = 2\nSUBCASE 7\nLOAD = 3\n{off}\nSPC = 4\nBEGIN BULK\nGRID,1\nENDDATA\n"
        );
        let case = read_clean_deck(&text).case_control;
        assert_eq!(
            (case.global.load, case.global.spc),
            (Some(1), Some(4)),
            "{on}"
        );
        assert!(case.subcases.is_empty(), "{on}");
    }
}

#[test]
fn options_and_values_that_nastran_does_not_know_are_refused_with_their_line() {
    let read = |line: &str| {
        bulk(&format!(
            "SOL 101\nCEND\n{line}\nBEGIN BULK\nGRID,1\nENDDATA\n"
        ))
    };
    for line in [
        "TEMP(INTI) = 4",
        "TEMP(BOHT) = 4",
        "TEMPERATURE(LAOD) = 4",
        "LOAD(2) = 1",
        "METHOD(FLIUD) = 3",
        "ANALYSIS = STATCS",
        "RIGID = FOO",
    ] {
        let found = fault_texts(&read(line));
        assert!(
            found.len() == 1 && found[0].starts_with("test.bdf:3: "),
            "{line}: {found:?}"
        );
    }
    for line in [
        "TEMP(INIT) = 4",
        "TEMP(MATE) = 4",
        "TEMP(BOTH) = 4",
        "METHOD(STRUCT) = 3",
        "ANALYSIS = STATICS",
        "ANALYSIS MODES",
        "RIGID = LAGR",
    ] {
        assert_eq!(fault_texts(&read(line)), Vec::<String>::new(), "{line}");
    }
}

#[test]
fn a_missing_or_misspelt_statement_between_sections_is_one_fault() {
    let bulk_data = "GRID,1\nCROD,1,1,1,1\nFORCE,1,1,,1.,0.,0.,1.\n";
    for (sections, starts) in [
        (
            "SOL 101\nLOAD = 1\nBEGIN BULK\n",
            "test.bdf:3: `CEND`: CEND",
        ),
        (
            "SOL 101\nCEND\nLOAD = 1\n",
            "test.bdf:4: `BEGIN BULK`: BEGIN BULK",
        ),
        (
            "SOL 101\nCEND\nBEGIN BLUK\n",
            "test.bdf:3: `BEGIN`: no part",
        ),
    ] {
        let found = fault_texts(&bulk(&format!("{sections}{bulk_data}ENDDATA\n")));
        assert!(
            found.len() == 1 && found[0].starts_with(starts),
            "{sections}: {found:?}"
        );
    }
}
