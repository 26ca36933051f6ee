//! Compares jobs with their deck, and with the labels and element types of their results.

use strainbridge::host::context::InMemory;
use strainbridge::{Context, Faults, Job, Severity, strains};

/// Returns a plate fixed at x = 0, with unit forces at grid 3.
fn deck(case_control: &str, bulk: &str) -> String {
    format!(
        "SOL 101\nCEND\n{case_control}BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,10.,0.,0.\nGRID,3,,10.,10.,0.\nGRID,4,,0.,10.,0.\n\
         CQUAD4,5,1,1,2,3,4\nPSHELL,1,1,5.\nMAT1,1,70000.,,.3,2.7-9\nSPC1,1,123456,1,4\nSPC1,2,123456,1,2\n\
         FORCE,1001,3,,1.,1.,0.,0.\nFORCE,1002,3,,1.,0.,0.,1.\n{bulk}ENDDATA\n"
    )
}

const CASES: &str =
    "SPC = 1\nSUBCASE 1\nLABEL = FX\nLOAD = 1001\nSUBCASE 2\nLABEL = FZ\nLOAD = 1002\n";
const FX: &str = "[[load]]\nname = \"FX\"\ngrid = 3\ncomponent = \"FX\"\n";
const FZ: &str = "[[load]]\nname = \"FZ\"\ngrid = 3\ncomponent = \"FZ\"\n";

/// Returns strain of element 5 as a punch file, from subcases with labels and from the element type.
fn punch(subcases: &[(u32, &str)], element: &str) -> String {
    let mut lines = Vec::new();
    for (id, label) in subcases {
        lines.extend([
            "$TITLE   =".to_owned(),
            "$SUBTITLE=".to_owned(),
            format!("$LABEL   = {label}"),
            "$ELEMENT STRAINS".to_owned(),
            "$REAL OUTPUT".to_owned(),
            format!("$SUBCASE ID = {id:11}"),
            format!("$ELEMENT TYPE = {element}"),
            "         5             -2.500000E+00      1.000000E-04      2.000000E-05".to_owned(),
            "-CONT-                  3.000000E-05      1.027802E+01      1.027200E-04".to_owned(),
            "-CONT-                  1.727998E-05      6.350853E-05      2.500000E+00".to_owned(),
            "-CONT-                 -1.000000E-04     -2.000000E-05      5.000000E-05".to_owned(),
            "-CONT-                  7.399731E+01     -1.283009E-05     -1.071699E-04".to_owned(),
            "-CONT-                  6.757712E-05".to_owned(),
        ]);
    }
    let numbered = (1..).zip(&lines).map(|(n, l)| format!("{l:<72}{n:8}\n"));
    numbered.collect()
}

const QUAD: &str = "  33  QUAD4";

/// Returns the warnings of `sensitivity`, or its faults.
fn collect_warnings(deck: &str, results: &str, job: &str) -> Result<Vec<String>, String> {
    let text = format!(
        "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\nresults = [\"plate.pch\"]\n{job}[[gauge]]\nname = \"T\"\nelement = 5\n"
    );
    let files = InMemory::default()
        .with_file("plate.bdf", deck)
        .with_file("plate.pch", results)
        .with_file("job.toml", text);
    let words = |faults: Faults| {
        let faults: Vec<String> = faults.into_iter().map(|f| f.to_string()).collect();
        faults.join("\n")
    };
    let job = Job::read("job.toml", &files).map_err(words)?;
    let made = strainbridge::sensitivity(&job, &Context::new(&files)).map_err(words)?;
    let findings = made.findings.0.iter();
    let warnings = findings.filter(|f| f.severity == Severity::Warning);
    Ok(warnings
        .map(|f| format!("{}: {}", f.code, f.message))
        .collect())
}

fn punch_both_cases() -> String {
    punch(&[(1, "FX"), (2, "FZ")], QUAD)
}

fn has_support_warning(warnings: &[String]) -> bool {
    warnings.iter().any(|w| w.starts_with("support:"))
}

#[test]
fn the_unit_loads_of_a_cases_export_are_read() {
    let loads = format!("{FX}{FZ}");
    let warnings = collect_warnings(&deck(CASES, ""), &punch_both_cases(), &loads).unwrap();
    assert!(!has_support_warning(&warnings), "{warnings:?}");
    let stated = collect_warnings(
        &deck(CASES, ""),
        &punch_both_cases(),
        &format!("support = 1\n{loads}"),
    )
    .unwrap();
    assert!(!has_support_warning(&stated), "{stated:?}");
}

#[test]
fn a_pressure_or_gravity_in_addition_to_the_unit_load_is_refused_with_its_line() {
    let cases = CASES.replace("1002", "77");
    for (card, name) in [
        ("PLOAD4,78,5,.01\n", "PLOAD4 78"),
        ("GRAV,78,0,9810.,0.,0.,-1.\n", "GRAV 78"),
        ("ACCEL1,78,,9810.,0.,0.,-1.\n+,2,3\n", "ACCEL1 78"),
    ] {
        let deck = deck(&cases, &format!("LOAD,77,1.,1.,1002,1.,78\n{card}"));
        let fault = collect_warnings(&deck, &punch_both_cases(), &format!("{FX}{FZ}")).unwrap_err();
        let line = deck
            .lines()
            .position(|l| l.starts_with(&card[..7]))
            .unwrap()
            + 1;
        let place = format!("{name} (`plate.bdf`:{line})");
        assert!(
            fault.contains("job-contradicts-deck") && fault.contains(&place),
            "{fault}"
        );
        // The user may mean the whole set.
        let set = format!("{FX}[[load]]\nname = \"P\"\nload_set = 77\n");
        collect_warnings(&deck, &punch_both_cases(), &set).unwrap();
    }
}

#[test]
fn supports_that_differ_from_the_job_or_between_loads_are_reported() {
    let loads = format!("{FX}{FZ}");
    let two = CASES.replace("LOAD = 1002", "LOAD = 1002\nSPC = 2");
    for (cases, support) in [
        (two.as_str(), ""),
        (CASES, "support = \"free\"\n"),
        (CASES, "support = 2\n"),
    ] {
        let job = format!("{support}{loads}");
        let warnings = collect_warnings(&deck(cases, ""), &punch_both_cases(), &job).unwrap();
        assert!(has_support_warning(&warnings), "{support} {warnings:?}");
    }
}

#[test]
fn a_load_that_takes_the_subcase_of_another_load_by_its_number_is_refused() {
    // The deck has no subcases, so only labels connect loads and results.
    let deck = deck("SPC = 1\n", "");
    let swapped = collect_warnings(&deck, &punch_both_cases(), &format!("{FZ}{FX}")).unwrap_err();
    assert!(swapped.contains("job-contradicts-deck"), "{swapped}");
    assert!(swapped.contains("state subcase = 2"), "{swapped}");
    let dropped = collect_warnings(&deck, &punch_both_cases(), FZ).unwrap_err();
    assert!(
        dropped.contains("whose label in the results is `FX`"),
        "{dropped}"
    );
    collect_warnings(
        &deck,
        &punch_both_cases(),
        &format!("{FZ}subcase = 2\n{FX}subcase = 1\n"),
    )
    .unwrap();
    // A label that is not a load name is free text. The same applies to a label that all subcases share.
    for labels in [[(1, "tip along x"), (2, "tip up")], [(1, "FX"), (2, "FX")]] {
        collect_warnings(&deck, &punch(&labels, QUAD), &format!("{FZ}{FX}")).unwrap();
    }
}

#[test]
fn results_of_another_element_type_are_refused() {
    let triangle = punch(&[(1, "FX"), (2, "FZ")], "  74  TRIA3");
    let deck = deck(CASES, "");
    let fault = collect_warnings(&deck, &triangle, &format!("{FX}{FZ}")).unwrap_err();
    assert!(
        fault.contains("another element type") && fault.contains("elements (1): 5"),
        "{fault}"
    );
    let files = InMemory::default()
        .with_file("plate.bdf", deck)
        .with_file("plate.pch", triangle);
    let made = strains(
        "plate.bdf".as_ref(),
        &["plate.pch".into()],
        &Context::new(&files),
    );
    assert!(made.is_err());
}

#[test]
fn a_load_set_that_the_deck_lacks_is_a_fault_of_the_job() {
    let job = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n[[load]]\nname = \"P\"\nload_set = 44\n[[gauge]]\nname = \"T\"\nelement = 5\n";
    let files = InMemory::default()
        .with_file("plate.bdf", deck("SPC = 1\n", ""))
        .with_file("job.toml", job);
    let job = Job::read("job.toml", &files).unwrap();
    let faults = strainbridge::sensitivity(&job, &Context::new(&files))
        .err()
        .unwrap();
    let faults: Vec<String> = faults.into_iter().map(|f| f.to_string()).collect();
    assert!(
        faults[0].starts_with("job.toml:4") && faults[0].contains("no load set 44"),
        "{faults:?}"
    );
}
