use super::super::vocabulary::{Effect, all_cards, case_word, effect_of_card};
use super::{bulk, fault_texts, read_clean_deck};

/// Tests that the names with a struct are the names that the table marks as carried.
#[test]
fn names_that_are_not_carried_have_no_struct() {
    for (name, effect) in all_cards().filter(|c| c.1 != Effect::Carried) {
        let deck = bulk(&format!("BEGIN BULK\nGRID,1\n{name},1\nENDDATA\n"));
        assert!(
            deck.others.iter().any(|c| c.name == name),
            "{name} {effect:?}"
        );
    }
}

#[test]
fn words_of_case_control_are_read_in_full_or_abbreviated() {
    let read = |word: &str| case_word(word).map(|w| w.name);
    for (word, full) in [
        ("DISPLACEMENT", "DISPLACEMENT"),
        ("DISP", "DISPLACEMENT"),
        ("SPCFORCE", "SPCFORCES"),
        ("SPCF", "SPCFORCES"),
        ("ELFO", "FORCE"),
        ("SUBC", "SUBCASE"),
        ("TEMP", "TEMPERATURE"),
        ("LOAD", "LOAD"),
        ("LOADSET", "LOADSET"),
        ("ESE", "ESE"),
        ("STRESSES", "STRESS"),
        ("LINES", "LINE"),
        ("SUPORT", "SUPORT1"),
    ] {
        assert_eq!(read(word), Some(full), "{word}");
    }
    for word in [
        "SPCC", "LAOD", "FOOBAR", "DIS", "ES", "", "METHDO", "SUBCSAE", "LOADSTE", "LOADBET",
        "MODCOM", "CONTACT",
    ] {
        assert_eq!(read(word), None, "{word}");
    }
}

#[test]
fn an_unknown_name_is_one_fault_with_its_count() {
    let deck = bulk("BEGIN BULK\nGRID,1\nFORCEE,1,1\nFORCEE,2,1\nCQDMEM,9,1,1\nENDDATA\n");
    let [fault] = &fault_texts(&deck)[..] else {
        panic!("{:?}", fault_texts(&deck))
    };
    assert!(
        fault.starts_with("test.bdf:3: `FORCEE`: Nastran has no card of this name (2 cards)"),
        "{fault}"
    );
    assert_eq!(effect_of_card("CQDMEM"), Some(Effect::Acts));
}

#[test]
fn the_statement_autospc_is_the_parameter() {
    let deck =
        read_clean_deck("SOL 101\nCEND\nAUTOSPC(NOPRINT) = NO\nBEGIN BULK\nGRID,1\nENDDATA\n");
    assert_eq!(deck.param("AUTOSPC").map(|p| p.values.len()), Some(1));
}

#[test]
fn a_line_of_case_control_without_a_word_is_a_fault() {
    let deck = bulk("SOL 101\nCEND\nLOAD = 1\n-7, 8\nBEGIN BULK\nGRID,1\nENDDATA\n");
    assert_eq!(fault_texts(&deck).len(), 1, "{:?}", fault_texts(&deck));
}

#[test]
fn a_line_above_cend_that_no_statement_begins_is_a_fault() {
    let with = |lines: &str| {
        bulk(&format!(
            "{lines}SOL 101\nCEND\nBEGIN BULK\nGRID,1\nENDDATA\n"
        ))
    };
    for (lines, says) in [
        (
            "ID A,B\nTIMEE 10\n",
            "test.bdf:2: `TIMEE`: Nastran has no card of this name, did you mean `TIME`?",
        ),
        (
            "SPC = 1\n",
            "test.bdf:1: `SPC`: case control begins below CEND",
        ),
        (
            "ALTER 2\nOUTPUT2 A,B//0/30 $\nENDALTER\nFOO 1\n",
            "test.bdf:4: `FOO`",
        ),
    ] {
        let found = fault_texts(&with(lines));
        assert!(
            found.len() == 1 && found[0].starts_with(says),
            "{lines}: {found:?}"
        );
    }
    for lines in [
        "nastran system(442)=-1,\n  buffsize=65537\nassign output2='a.op2',\n  unit=12\ndiag 8, 56\ntime 100\nECHO = NONE\n",
        "COMPILE SEDISP\nALTER 'CALL SUPER1'\nMESSAGE //'text' $\nENDALTER\nINIT MASTER(S)\n",
        "APP DISP\nCHKPNT YES\nID,STAND,BEAM\nMODEL_CHECK MAT_DENSITY=OFF\n",
    ] {
        assert_eq!(fault_texts(&with(lines)), Vec::<String>::new(), "{lines}");
    }
}
