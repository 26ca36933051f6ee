use super::super::tests::{block, shell};
use super::*;

fn strain(subcase: u32, id: u32, exx: f64) -> String {
    let rows = shell([-0.2, 0.2], [exx, 0.0, 0.0], [2.0 * exx, 0.0, 0.0]);
    let id = format!("{id:>10}");
    block(subcase, "ELEMENT STRAINS", "33 QUAD4", &[(&id, rows)])
}

fn find_repeated(texts: &[String]) -> Vec<RepeatedSubcase> {
    let files: Vec<ResultsFile> = texts
        .iter()
        .map(|t| ResultsFile::read(t.as_bytes(), "run.pch").unwrap())
        .collect();
    find_repeated_results(&files.iter().collect::<Vec<_>>(), None)
}

#[test]
fn a_subcase_with_other_values_in_a_second_table_is_there_twice() {
    // An optimisation writes its first and last design like this.
    let text = strain(1, 11, 1e-4) + &strain(2, 11, 5e-4) + &strain(1, 11, 1.8e-4);
    let expected = RepeatedSubcase {
        subcase: 1,
        quantity: Quantity::Strain,
        files: vec![(0, 2)],
    };
    assert_eq!(
        find_repeated(std::slice::from_ref(&text)),
        std::slice::from_ref(&expected)
    );
    assert!(expected.is_in_one_file());
    assert_eq!(
        expected.words(&["run.pch"]),
        "subcase 1 is twice in `run.pch` with different strain"
    );
    let third = text + &strain(1, 11, 2e-4);
    assert_eq!(find_repeated(&[third])[0].files, [(0, 3)]);
}

#[test]
fn other_elements_and_equal_values_are_no_repetition() {
    let spread = strain(1, 11, 1e-4) + &strain(1, 12, 5e-4) + &strain(1, 13, 7e-4);
    assert_eq!(find_repeated(&[spread]), []);
    let equal = strain(1, 11, 1e-4) + &strain(1, 11, 1e-4);
    assert_eq!(find_repeated(&[equal]), []);
    // A punch file has seven digits.
    let rounded = [strain(1, 11, 1.234_567_4e-4), strain(1, 11, 1.234_567e-4)];
    assert_eq!(find_repeated(&rounded), []);
}

#[test]
fn two_files_with_other_values_hold_a_subcase_once_each() {
    let two = find_repeated(&[strain(1, 11, 1e-4), strain(1, 11, 1.01e-4)]);
    assert_eq!(two.len(), 1);
    assert_eq!(two[0].files, [(0, 1), (1, 1)]);
    assert!(!two[0].is_in_one_file());
}

#[test]
fn stress_counts_where_there_is_no_strain() {
    let stress = |sxx: f64| {
        let rows = shell([-0.2, 0.2], [sxx, 0.0, 0.0], [sxx, 0.0, 0.0]);
        block(1, "ELEMENT STRESSES", "33 QUAD4", &[("        11", rows)])
    };
    let twice = stress(10.0) + &stress(20.0);
    assert_eq!(
        find_repeated(std::slice::from_ref(&twice))[0].quantity,
        Quantity::Stress
    );
    assert_eq!(find_repeated(&[twice + &strain(1, 11, 1e-4)]), []);
}
