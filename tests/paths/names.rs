//! Every name of bulk data and every word of case control has an effect, a reason, or a refusal.

use nastran::bdf::vocabulary::{CaseWord, Effect, all_cards, all_words, case_word, effect_of_card};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use strainbridge::Context;
use strainbridge::fe::SolveOptions;
use strainbridge::finding::Finding;
use strainbridge::host::context::InMemory;
use strainbridge::workflow::{check::check, solve::solve_deck};

/// Rod of length 2 with EA = 1e8, fixed at grid 1, with a force of 1000 at grid 2.
const ROD: &str = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCROD,1,1,1,2\nPROD,1,1,.01\nMAT1,1,1.+10,,.3,100.\n\
     FORCE,1,2,,1000.,1.,0.,0.\nSPC1,1,123456,1\nSPC1,1,23456,2\nTEMPD,3,20.\n";

/// Answers of `check` and `solve` for a deck.
struct Tried {
    faults: Vec<String>,
    findings: Vec<Finding>,
    /// Reasons of the cards without influence.
    idle: String,
    solved: Result<Vec<Finding>, String>,
}

fn check_and_solve(deck: &str) -> Tried {
    let files = InMemory::default().with_file("rod.bdf", deck);
    let cx = Context::new(&files);
    let looked = check(&[PathBuf::from("rod.bdf")], &cx).unwrap();
    let solved = solve_deck(Path::new("rod.bdf"), SolveOptions::default(), &cx);
    Tried {
        faults: looked.faults.iter().map(ToString::to_string).collect(),
        findings: looked.findings.0.clone(),
        idle: looked.decks.iter().map(|d| d.text()).collect(),
        solved: match solved {
            Ok(o) => Ok(o.findings.0),
            Err(f) => Err(f.to_string()),
        },
    }
}

fn rod(case_control: &str, bulk: &str) -> String {
    format!("SOL 101\nCEND\nSPC = 1\nLOAD = 1\n{case_control}BEGIN BULK\n{ROD}{bulk}ENDDATA\n")
}

/// Line of the card after the rod, and line of the case control statement.
const CARD_LINE: usize = 15;
const STATEMENT_LINE: usize = 5;

/// Reason of a card that acts only together with an item that this deck lacks.
const UNUSED: &str = "acts on no element of this deck 1";

fn warns_of(t: &Tried, name: &str) -> bool {
    let of = |f: &&Finding| f.code == "card-not-solved" && f.message.contains(name);
    t.findings.iter().any(|f| of(&f))
}

/// Returns whether `solve` refuses with name and line.
fn refuses(t: &Tried, name: &str, line: usize) -> bool {
    let place = format!("rod.bdf:{line}: {name}");
    t.solved.as_ref().is_err_and(|e| e.contains(&place))
}

#[test]
fn every_name_of_bulk_data_is_read_or_reported() {
    let mut silent = Vec::new();
    for (name, effect) in all_cards() {
        if ["BEGIN", "INCLUDE", "ENDDATA"].contains(&name) {
            continue;
        }
        let heat = if name.starts_with("TEMP") {
            "TEMP(LOAD) = 3\n"
        } else {
            ""
        };
        let line = CARD_LINE + usize::from(!heat.is_empty());
        let set = if heat.is_empty() { 1 } else { 3 };
        let t = check_and_solve(&rod(heat, &format!("{name},{set}\n")));
        let is_reported = match effect {
            Effect::None(reason) => t.idle.contains(&format!("{reason} ")) && t.solved.is_ok(),
            Effect::Acts => warns_of(&t, name) && refuses(&t, name, line),
            Effect::Load => {
                let elsewhere = check_and_solve(&rod(heat, &format!("{name},77\n")));
                warns_of(&t, name) && refuses(&t, name, line) && elsewhere.solved.is_ok()
            }
            Effect::ActsWith(_) => t.idle.contains(UNUSED) && t.solved.is_ok(),
            // The reader reads the card, or reports its missing fields.
            Effect::Carried | Effect::Request => true,
            Effect::Executive | Effect::ExecutiveActs => true,
        };
        if !is_reported {
            silent.push((name, effect, t.solved.err()));
        }
    }
    assert!(silent.is_empty(), "{silent:?}");
}

#[test]
fn model_parameters_are_counted_unless_they_act() {
    let idle = check_and_solve(&rod("", "MDLPRM,HDF5,1\nMDLPRM,QRSHEAR,1,SHRTOQ4,1\n"));
    assert!(idle.idle.contains(UNUSED), "{}", idle.idle);
    let acting = check_and_solve(&rod("", "MDLPRM,QRSHEAR,1,SHRTOQ4,1\n"));
    assert!(!acting.idle.contains("nothing"), "{}", acting.idle);
    assert!(
        refuses(&acting, "MDLPRM QRSHEAR", CARD_LINE),
        "{:?}",
        acting.solved
    );
}

#[test]
fn every_word_of_case_control_is_read_or_reported() {
    let mut silent = Vec::new();
    for (written, CaseWord { name, effect, .. }) in all_words() {
        // Below CEND, MODEL_CHECK is read as the word before the underscore.
        if ["BEGIN", "INCLUDE", "CEND", "ENDDATA", "MODEL_CHECK"].contains(&written) {
            continue;
        }
        let t = check_and_solve(&rod(&format!("{written} = 7\n"), ""));
        let is_reported = match effect {
            Effect::None(_) => t.faults.is_empty() && t.solved.is_ok(),
            Effect::Acts => warns_of(&t, name) && refuses(&t, name, STATEMENT_LINE),
            // Below CEND, this name is a word of case control.
            Effect::ExecutiveActs if name == "RESTART" => t.solved.is_ok(),
            Effect::Executive | Effect::ExecutiveActs => {
                t.faults.iter().any(|f| f.contains(":5: "))
            }
            _ => true,
        };
        if !is_reported {
            silent.push((written, effect, t.faults, t.solved.err()));
        }
    }
    assert!(silent.is_empty(), "{silent:?}");
}

/// Returns known words with one letter added, removed, replaced or exchanged. They are the same in each run of the
/// test.
fn misspelt(known: &[&str], longest: usize, count: usize) -> BTreeSet<String> {
    let mut state: u64 = 20;
    let mut draw = |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % n
    };
    let mut made = BTreeSet::new();
    while made.len() < count {
        let mut word: Vec<char> = known[draw(known.len())].chars().collect();
        let letter = char::from(b'A' + draw(26) as u8);
        let at = draw(word.len());
        match draw(4) {
            0 => word[at] = letter,
            1 => word.insert(at, letter),
            2 => drop(word.remove(at)),
            _ if at > 0 => word.swap(at - 1, at),
            _ => {}
        }
        let word: String = word.into_iter().collect();
        let is_name = word.len() <= longest && word.starts_with(|c: char| c.is_ascii_alphabetic());
        if is_name && !known.contains(&word.as_str()) {
            made.insert(word);
        }
    }
    made
}

#[test]
fn misspelt_names_of_bulk_data_are_refused_by_name_and_line() {
    let known: Vec<&str> = all_cards().map(|c| c.0).collect();
    for word in misspelt(&known, 8, 300) {
        assert_eq!(effect_of_card(&word), None);
        let t = check_and_solve(&rod("", &format!("{word},1\n")));
        let place = format!("rod.bdf:{CARD_LINE}: {word}: ");
        assert!(
            t.faults.iter().any(|f| f.starts_with(&place)),
            "{:?}",
            t.faults
        );
        assert!(
            refuses(&t, &word, CARD_LINE),
            "{word}: {:?}",
            t.solved.err()
        );
    }
}

#[test]
fn misspelt_words_of_case_control_are_refused() {
    let known: Vec<&str> = all_words().map(|w| w.0).collect();
    let mut refused = 0;
    for word in misspelt(&known, 20, 300) {
        let t = check_and_solve(&rod(&format!("{word} = 7\n"), ""));
        // Some results are the beginning of another word, an abbreviation, or the plural of an output request.
        if case_word(&word).is_none() {
            let place = format!("rod.bdf:{STATEMENT_LINE}: {word}: ");
            assert!(
                t.faults.iter().any(|f| f.starts_with(&place)),
                "{:?}",
                t.faults
            );
            assert!(t.solved.is_err(), "{word}");
            refused += 1;
        }
    }
    assert!(refused > 200, "{refused}");
}

#[test]
fn a_misspelt_name_comes_with_the_name_that_is_meant() {
    for (card, meant) in [
        ("FORCEE", "FORCE"),
        ("CRODD", "CROD"),
        ("SUPPORT", "SUPORT"),
        ("PSHLEL", "PSHELL"),
    ] {
        let t = check_and_solve(&rod("", &format!("{card},1,2,,3000.\n")));
        let [fault] = &t.faults[..] else {
            panic!("{card}: {:?}", t.faults)
        };
        assert!(
            fault.contains(&format!("did you mean `{meant}`?")),
            "{fault}"
        );
    }
    let t = check_and_solve(&rod("", "FOOBAR,1\n"));
    assert!(t.faults[0].contains("FOOBAR") && !t.faults[0].contains("did you mean"));
    for (statement, meant) in [("SPCC = 1", "SPC"), ("LAOD = 1", "LOAD")] {
        let t = check_and_solve(&rod(&format!("{statement}\n"), ""));
        assert!(
            t.faults[0].contains(&format!("did you mean `{meant}`?")),
            "{:?}",
            t.faults
        );
    }
}

#[test]
fn sections_that_are_not_bulk_data_have_words_of_their_own() {
    let plots = "DISP = ALL\nSTRESSES(PLOT) = ALL\nOUTPUT(PLOT)\nPLOTFOO 7\nSPCC = 1\n";
    let deck = format!(
        "NASTRAN SYSTEM(1)=2\nINIT MASTER(S)\nID A,B\nASSIGN OUTPUT2='a.op2'\nDOMAINSOLVER ACMS\nDIAG 8\nTIME 5\nGEOMCHECK NONE\n\
         SOL 101\nCEND\nECHO = NONE\nSPC = 1\nLOAD = 1\n{plots}BEGIN BULK\nPARAM,MYPARAM,3\n{ROD}ENDDATA\nwords behind it\n"
    );
    let t = check_and_solve(&deck);
    assert_eq!(t.faults, Vec::<String>::new());
    assert!(t.solved.is_ok(), "{:?}", t.solved.err());
}

#[test]
fn changes_of_the_solution_sequence_are_refused_by_line() {
    for (statements, named, line) in [
        ("SOL 101\nCOMPILE SEMG\nALTER 5\nFOO A/B $\n", "COMPILE", 2),
        ("SOL 101\nalter 5 $\nFOO A/B $\nENDALTER\n", "ALTER", 2),
        ("RESTART VERSION=1,KEEP\nSOL 101\n", "RESTART", 1),
        ("SOL 101\nMALTER 'AFTER','1'\n", "MALTER", 2),
        ("ID A,B\nAPP DMAP\nSOL 101\n", "APP DMAP", 2),
    ] {
        let deck = rod("", "").replacen("SOL 101\n", statements, 1);
        let t = check_and_solve(&deck);
        assert_eq!(t.faults, Vec::<String>::new(), "{statements}");
        assert!(warns_of(&t, named), "{statements}: {:?}", t.findings);
        assert!(
            refuses(&t, named, line),
            "{statements}: {:?}",
            t.solved.err()
        );
    }
}

#[test]
fn a_misspelt_parameter_is_reported() {
    let noted = |case_control: &str, bulk: &str| {
        let t = check_and_solve(&rod(case_control, bulk));
        assert!(t.faults.is_empty() && t.solved.is_ok(), "{:?}", t.faults);
        let note = t.findings.into_iter().find(|f| f.code == "deck-note");
        note.map_or(String::new(), |n| n.message)
    };
    for (name, meant) in [
        ("WTMAS", "WTMASS"),
        ("GRDPTN", "GRDPNT"),
        ("COUPMAS", "COUPMASS"),
    ] {
        let printed =
            format!("line {CARD_LINE}: PARAM,{name} is not read: did you mean `{meant}`?");
        assert!(noted("", &format!("PARAM,{name},1\n")).contains(&printed));
    }
    let printed = noted("PARAM,INRELL,-1\n", "");
    assert!(
        printed.contains("line 5: PARAM,INRELL is not read: did you mean `INREL`?"),
        "{printed}"
    );
    for other in ["AUTOSPCR", "POSTU", "MYPARAM", "PRGPST", "WTMASS"] {
        assert_eq!(noted("", &format!("PARAM,{other},1\n")), "", "{other}");
    }
}

#[test]
fn a_suport1_set_that_the_deck_lacks_is_refused() {
    let of = |case_control: &str, bulk: &str| check_and_solve(&rod(case_control, bulk)).solved;
    for inrel in ["", "PARAM,INREL,-1\n", "PARAM,INREL,-2\n"] {
        let refused = of("SUPORT1 = 5\n", &format!("SUPORT1,6,1,1\n{inrel}"));
        let why = refused.expect_err(inrel);
        assert!(
            why.contains("SUPORT1 = 5") && why.contains("no set of this number"),
            "{why}"
        );
    }
    assert!(of("SUPORT1 = 6\n", "SUPORT1,6,1,1\n").is_ok());
}

/// Loads act only if case control selects them.
#[test]
fn what_is_not_selected_does_not_act() {
    let matrices = "DMIG,PX,0,9,1,0,,,1\nDMIG,PX,2,0,,2,1,3000.\nBCTSET,5,1,2\nMATT2,1,7\n";
    assert!(check_and_solve(&rod("", matrices)).solved.is_ok());
    assert!(
        check_and_solve(&rod("NLPARM = 0\nK2GG = NONE\n", matrices))
            .solved
            .is_ok()
    );
    for (statement, named) in [
        ("P2G = PX\n", "P2G"),
        ("BCSET = 5\n", "BCSET"),
        ("TEMPERATURE(MATERIAL) = 3\n", "MATT2"),
        ("ANALYSIS = HEAT\n", "ANALYSIS = HEAT"),
    ] {
        let t = check_and_solve(&rod(statement, matrices));
        assert!(warns_of(&t, named), "{statement}: {:?}", t.findings);
        assert!(t.solved.is_err_and(|e| e.contains(named)), "{statement}");
    }
}

#[test]
fn sequences_that_are_not_linear_are_refused() {
    let with = |sol: &str, more: &str| check_and_solve(&rod("", more).replacen("SOL 101", sol, 1));
    for sol in [
        "SOL 106",
        "SOL 400",
        "SOL 4",
        "SOL 129",
        "SOL 601,106",
        "SOL 701",
        "SOL 153",
        "SOL 159",
        "SOL 144",
        "SOL NLSTATIC",
        "SOL NONLIN",
        "APP HEAT\nSOL 1",
        "SOL 3333",
    ] {
        let t = with(sol, "");
        let name = sol.lines().next().unwrap();
        assert!(warns_of(&t, name), "{sol}: {:?}", t.findings);
        assert!(t.solved.is_err_and(|e| e.contains(name)), "{sol}");
    }
    for (more, name) in [
        ("PARAM,LGDISP,1\n", "PARAM LGDISP"),
        ("MATS1,1,,PLASTIC,1.+8,1,1,5.+4\n", "MATS1 1"),
    ] {
        assert!(
            with("SOL 106", more)
                .solved
                .is_err_and(|e| e.contains(name)),
            "{name}"
        );
    }
    assert!(with("SOL 101", "PARAM,LGDISP,-1\n").solved.is_ok());
    for (sol, printed) in [
        ("SOL 101", false),
        ("SOL 105", false),
        ("SOL 200", false),
        ("SOL 103", true),
        ("SOL 111", true),
    ] {
        let findings = with(sol, "").solved.unwrap();
        assert_eq!(
            findings.iter().any(|f| f.code == "solution-sequence"),
            printed,
            "{sol}"
        );
    }
}

#[test]
fn superelements_that_are_not_read_are_refused() {
    let t = check_and_solve(&rod("", "BEGIN SUPER=1\nGRID,7\n"));
    assert!(t.solved.is_err_and(|e| e.contains("BEGIN SUPER=1")));
    assert!(
        check_and_solve(&rod("", "BEGIN BULK AUXMODEL=1\nGRID,7\n"))
            .solved
            .is_ok()
    );
}

#[test]
fn suport_without_inrel_is_reported() {
    let printed = |deck: String| {
        let findings = check_and_solve(&deck).solved.unwrap();
        findings.iter().any(|f| f.code == "suport-without-inrel")
    };
    assert!(printed(rod("", "SUPORT,1,1\n")));
    assert!(!printed(rod("", "")));
}
