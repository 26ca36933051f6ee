use super::{bulk, fault_texts};

#[test]
fn every_fault_is_reported_with_line_and_field() {
    let text = "\
GRID    1               1.      A.      3.
GRID            0       1.      2.      3.
PSHELL  1       1       thick
CQUAD4  5       1       1       2       3       0
FORCE   1       5       0       1       0.      0.      1.
SPC1    1       1237    5       6
this is no card
CTRIA3,7,1,1,2
";
    let deck = bulk(text);
    let lines: Vec<(u32, Option<u32>)> = deck
        .faults
        .iter()
        .map(|f| (f.at.line, f.field.map(|x| x.number)))
        .collect();
    let expected = [
        (1, Some(5)),
        (2, Some(2)),
        (3, Some(4)),
        (4, Some(7)),
        (5, Some(5)),
        (6, Some(3)),
        (7, None),
        (8, Some(6)),
    ];
    assert_eq!(lines, expected, "{:#?}", fault_texts(&deck));
    assert_eq!(
        fault_texts(&deck)[0],
        "test.bdf:1: `GRID` field 5 (X2): a real number is needed, found: A.: write a number such as 1.5 or 1.5-3, and check that the value is in its own field: between commas, or in columns 9, 17, 25 .. on"
    );
}

#[test]
fn fields_of_continuations_count_on_from_12() {
    let deck = bulk("PSHELL,1,1,.1\n,x,.2\n");
    assert_eq!(
        deck.faults[0].field.map(|f| (f.number, f.name)),
        Some((12, "Z1"))
    );
}

#[test]
fn a_card_without_its_id_is_left_out_and_the_others_stay() {
    let deck = bulk("GRID,,,1.,2.,3.\nGRID,2,,1.,2.,3.\nGRID,-3\n");
    assert_eq!(deck.cards.grids.len(), 1);
    assert_eq!((deck.faults.len(), deck.counts["GRID"]), (2, 3));
}

#[test]
fn shifted_columns_do_not_pass_as_numbers() {
    // The digits 12 and 3 in one field are two numbers, not 123.
    let deck = bulk("CQUAD4  1       1       12 3    4       5       6\n");
    assert_eq!(deck.faults.len(), 1);
}
