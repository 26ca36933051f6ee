use super::super::MemoryLoader;
use super::{bulk, read_clean_deck};
use crate::cards::{CoordDefinition, MaterialAngle, Orientation};

const X: [f64; 3] = [1.25, -2.5e-3, 30.0];

#[test]
fn small_large_free_and_tabbed_fields_give_the_same_grid() {
    let forms = [
        "GRID    7       2       1.25    -2.5-3  30.     3       126     \n",
        "GRID*                  7               2            1.25          -2.5-3+G1\n*G1                  30.               3             126\n",
        "GRID*   7               2               1.25            -.0025\n*       30.             3               126\n",
        "GRID   *7               2               1.25            -.0025          \n*       3.+1            3               126\n",
        "GRID,7,2,1.25,-2.5-3,30.,3,126\n",
        "grid, 7 ,2, 1.25, -2.5E-3 , 30. ,3 ,126 $ a comment\n",
        "GRID*,7,2,1.25,-2.5-3\n*,30.,3,126\n",
        "GRID*,7,2,1.25,-2.5-3,*G\n*G,30.,3,126\n",
        "GRID\t7\t2\t1.25\t-2.5-3\t30.\t3\t126\n",
        "GRID\t7\t2       1.25\t-2.5-3\t  30.\t3\t126\n",
        "  GRID  7       2       1.25    -2.5-3  30.     3       126\n",
        "  GRID,7,2,1.25,-2.5-3,30.,3,126\n",
        "Grid    7       2       1.25    -2.5-3  30.     3       126     \r\n",
        "\u{feff}GRID    7       2       1.25    -2.5-3  30.     3       126$comment",
        "GRID,7,2,1.25,-2.5-3,30.,3,126\r$ old line ends\rENDDATA",
    ];
    for form in forms {
        let deck = read_clean_deck(form);
        let grid = &deck.cards.grids[0];
        assert_eq!(
            (grid.id, grid.cp, grid.x, grid.cd),
            (7, Some(2), X, Some(3)),
            "{form}"
        );
        assert_eq!(
            grid.ps.map(|p| p.to_string()).as_deref(),
            Some("126"),
            "{form}"
        );
    }
}

#[test]
fn numbers_may_fill_their_fields_without_a_gap() {
    let deck = read_clean_deck("GRID           1        112.001664.7919323.51444\n");
    assert_eq!(deck.cards.grids[0].x, [112.0016, 64.79193, 23.51444]);
}

#[test]
fn columns_behind_80_are_ignored_in_fixed_fields() {
    let deck = read_clean_deck(
        "GRID    1               1.      2.      3.                              99999999\n",
    );
    assert_eq!(deck.cards.grids[0].x, [1.0, 2.0, 3.0]);
}

#[test]
fn a_free_line_with_more_than_eight_fields_goes_on_by_itself() {
    let deck = read_clean_deck("CORD2C,1,0, 0.,0.,0., 0.,0.,1., 0.,1.,0.\n");
    let CoordDefinition::Points { c, .. } = deck.cards.coords[0].definition else {
        panic!()
    };
    assert_eq!(c, [0.0, 1.0, 0.0]);
    let named = read_clean_deck("CORD2C,1,0, 0.,0.,0., 0.,0.,1.,+C1\n+C1, 0.,1.,0.\n");
    assert_eq!(
        named.cards.coords[0].definition,
        deck.cards.coords[0].definition
    );
}

#[test]
fn data_may_go_on_behind_a_trailing_comma() {
    let deck = read_clean_deck(
        "SPC1,1,123,\n5,6,7,\n8,THRU,\n12\nGRID,1,,0.,0.,0.,,,\nGRID,2,,0.,0.,0.,,,,\n",
    );
    let parts: Vec<String> = deck
        .cards
        .spc1s
        .iter()
        .map(|s| format!("{:?}", s.grids))
        .collect();
    assert_eq!(parts, ["Each([5, 6, 7])", "Thru(8, 12)"]);
    assert_eq!(deck.cards.grids.len(), 2);
}

#[test]
fn a_blank_field_is_distinguished_from_zero() {
    let deck = read_clean_deck(
        "GRID    1               1.      2.      3.\nGRID    2       0       1.      2.      3.      0       0\n",
    );
    assert_eq!(
        (deck.cards.grids[0].cp, deck.cards.grids[0].cd),
        (None, None)
    );
    assert_eq!(
        (deck.cards.grids[1].cp, deck.cards.grids[1].cd),
        (Some(0), Some(0))
    );
    assert!(deck.cards.grids[1].ps.is_some_and(|p| p.is_empty()));
}

#[test]
fn theta_is_real_and_mcid_is_an_integer() {
    let deck = read_clean_deck(
        "CQUAD4,1,1,1,2,3,4,30.\nCQUAD4,2,1,1,2,3,4,30\nCQUAD4,3,1,1,2,3,4\nCQUAD4,4,1,1,2,3,4,0\n",
    );
    let angles: Vec<MaterialAngle> = deck.cards.shells.iter().map(|s| s.angle).collect();
    let expected = [
        MaterialAngle::Theta(30.0),
        MaterialAngle::Mcid(30),
        MaterialAngle::Theta(0.0),
        MaterialAngle::Mcid(0),
    ];
    assert_eq!(angles, expected);
}

#[test]
fn a_lone_integer_as_orientation_is_a_grid() {
    let deck = read_clean_deck(
        "CBAR,1,1,1,2,5\nCBAR,2,1,1,2,0.,0.,1.\nCBAR,3,1,1,2,,1.\nCBAR,4,1,1,2,,,,GOO\n",
    );
    let v: Vec<Orientation> = deck.cards.bars.iter().map(|b| b.orientation).collect();
    let expected = [
        Orientation::Grid(5),
        Orientation::Vector([0.0, 0.0, 1.0]),
        Orientation::Vector([0.0, 1.0, 0.0]),
        Orientation::Blank,
    ];
    assert_eq!(v, expected);
    assert_eq!(deck.cards.bars[3].offt, Some(*b"GOO"));
}

#[test]
fn bytes_that_are_no_utf8_are_kept_in_comments() {
    let mut bytes = b"$ Tr\xe4ger \xff\nGRID,1,,0.,0.,0.\n".to_vec();
    let deck = super::super::read_deck("test.bdf", bytes.clone(), &mut MemoryLoader::default());
    assert!(deck.faults.is_empty());
    assert_eq!(deck.cards.grids.len(), 1);
    assert_eq!(
        super::super::write_deck(&deck)[0].1,
        std::mem::take(&mut bytes)
    );
}

#[test]
fn cards_without_a_struct_are_kept_word_for_word() {
    let text = "EIGRL    1       0.              10      0 $ modes\nGRID,1\nTABLED1 42 \n$ inside\n+       0.0     0.0     5.      100.    ENDT\nGRID,2\n";
    let deck = read_clean_deck(text);
    let texts: Vec<String> = deck.others.iter().map(|o| deck.text(o)).collect();
    assert_eq!(
        texts[0],
        "EIGRL    1       0.              10      0 $ modes"
    );
    assert_eq!(
        texts[1],
        "TABLED1 42 \n$ inside\n+       0.0     0.0     5.      100.    ENDT"
    );
    assert_eq!(
        (
            deck.counts["EIGRL"],
            deck.counts["TABLED1"],
            deck.counts["GRID"]
        ),
        (1, 1, 2)
    );
}

#[test]
fn text_behind_enddata_is_not_read() {
    let deck = read_clean_deck("GRID,1\nENDDATA 58e050da\nGRID,2\n");
    assert_eq!(deck.cards.grids.len(), 1);
    assert_eq!(deck.counts["ENDDATA"], 1);
}

#[test]
fn superelement_bulk_data_is_kept_and_reported() {
    let deck = bulk("SOL 101\nCEND\nBEGIN BULK\nGRID,1\nBEGIN SUPER=2\nGRID,2\nENDDATA\n");
    assert_eq!(deck.cards.grids.len(), 1);
    assert!(
        deck.notes
            .iter()
            .any(|n| n.text.contains("BEGIN SUPER=2") && n.at.line == 5)
    );
}
