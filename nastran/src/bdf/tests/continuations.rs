use super::{fault_texts, read_clean_deck};

/// Returns Z1 and Z2 of a PSHELL.
fn fibres(text: &str) -> (Option<f64>, Option<f64>) {
    let deck = read_clean_deck(text);
    let p = &deck.cards.pshells[0];
    (p.z1, p.z2)
}

#[test]
fn continuations_may_be_named_blank_or_marked() {
    let head = "PSHELL  4       1       .25     1               1               ";
    let forms = [
        format!("{head}        +P4\n+P4     -.1     .2\n"),
        format!("{head}        +P4     \n+P4     -.1     .2\n"),
        format!("{head}\n        -.1     .2\n"),
        format!("{head}\n+       -.1     .2\n"),
        format!("{head}        +\n+       -.1     .2\n"),
        format!("{head}        +       \n+,-.1,.2\n"),
        format!("{head}\n,-.1,.2\n"),
        format!("{head}\n\t-.1\t.2\n"),
        format!("{head}\n$ a comment\n\n+       -.1     .2\n"),
        format!("{head}\n*                    -.1              .2\n"),
        format!("{head}        note\n+       -.1     .2\n"),
        format!("{head}        ABC\n+BC     -.1     .2\n"),
        "PSHELL,4,1,.25,1,,1\n,-.1,.2\n".to_owned(),
        "PSHELL,4,1,.25,1,,1,,,+\n+,-.1,.2\n".to_owned(),
        "PSHELL,4,1,.25,1,,1,,,\n+,-.1,.2\n".to_owned(),
        "PSHELL*,4,1,.25,1\n*,,1,,\n*,-.1,.2\n".to_owned(),
        "PSHELL*                4               1             .25               1+ \n*                                      1                                + \n*                    -.1              .2                                + \n* \n".to_owned(),
    ];
    for form in forms {
        assert_eq!(fibres(&form), (Some(-0.1), Some(0.2)), "{form}");
    }
}

#[test]
fn named_continuations_are_found_in_a_sorted_deck() {
    let text = "\
+P1     -.1     .2
+C1     1.      0.      1.
CBAR    1       1       1       2                               1       +A1
CORD2R  1       0       0.      0.      0.      0.      0.      1.      +C1
PSHELL  4       1       .25     1               1                       +P1
+A1                     -1.0    .0      .0      -1.0    .0      .0
RBE2    9       1       123     2       3       4       5       6       +R1
+R2     15
+R1     7       8       9       10      11      12      13      14      +R2
";
    let deck = read_clean_deck(text);
    assert_eq!(deck.cards.pshells[0].z2, Some(0.2));
    assert_eq!(deck.cards.bars[0].offsets[0], [-1.0, 0.0, 0.0]);
    assert_eq!(
        deck.cards.rbe2s[0].dependent,
        (2..=15).collect::<Vec<u32>>()
    );
}

#[test]
fn a_continuation_without_a_card_is_a_fault() {
    let deck = super::bulk("+B1     -1.0    .0      .0      -1.0    .0      .0\nGRID,1\n");
    assert_eq!(
        fault_texts(&deck),
        [
            "test.bdf:1: the continuation belongs to no card: B1: put the continuation below its card, or give both the same name in columns 73-80 and 1-8"
        ]
    );
    assert_eq!(deck.cards.grids.len(), 1);
}

#[test]
fn a_continuation_with_another_name_belongs_to_no_card() {
    let head = "PSHELL  4       1       .25     1               1                       ";
    let asked = fault_texts(&super::bulk(&format!("{head}+P4\n+P5     -.1     .2\n")));
    assert_eq!(asked.len(), 2, "{asked:?}");
    assert!(
        asked[0].starts_with("test.bdf:2: the continuation belongs to no card: P5"),
        "{asked:?}"
    );
    assert!(
        asked[1]
            .starts_with("test.bdf:1: the card refers to a continuation that does not exist: P4"),
        "{asked:?}"
    );
    // A continuation below a card that asks for no continuation is an orphan, even if other cards are between.
    for text in [
        format!("{head}\n+P5     -.1     .2\n"),
        format!("{head}\nGRID,9\n+P5     -.1     .2\n"),
    ] {
        let found = fault_texts(&super::bulk(&text));
        assert!(
            found.len() == 1 && found[0].contains("belongs to no card: P5"),
            "{found:?}"
        );
    }
    // The beginning of a name is a different name.
    let other = fault_texts(&super::bulk(&format!(
        "{head}+P\nGRID,9\n+P5     -.1     .2\n"
    )));
    assert_eq!(other.len(), 2, "{other:?}");
}

#[test]
fn the_last_of_several_continuations_is_missed_too() {
    let head = "RBE2    9       1       123     2       3       4       5       6       +R1\n";
    let rest = "+R1     7       8       9       10      11      12      13      14      +R2\n";
    for between in ["", "GRID,99\n"] {
        let found = fault_texts(&super::bulk(&[head, between, rest].concat()));
        assert!(
            found.len() == 1 && found[0].contains("that does not exist: R2"),
            "{between}: {found:?}"
        );
    }
}

#[test]
fn names_of_continuations_are_equal_in_both_cases() {
    let head = "PSHELL  4       1       .25     1               1                       ";
    for between in ["", "GRID,9\n"] {
        let text = format!("{head}+ab\n{between}+AB     -.1     .2\n");
        assert_eq!(fibres(&text), (Some(-0.1), Some(0.2)), "{between}");
    }
}

#[test]
fn a_name_that_two_cards_ask_for_is_refused_though_one_has_it_below() {
    let head = |id| {
        format!("PSHELL  {id}       1       .25     1               1                       +A\n")
    };
    let rest = "+A      -.1     .2\n";
    let text = [&head(4), &head(5), rest, rest].concat();
    let found = fault_texts(&super::bulk(&text));
    assert!(
        found
            .iter()
            .any(|f| f.contains("lines 1 and 2 both name it")),
        "{found:?}"
    );
}

#[test]
fn chunks_of_a_large_deck_are_cut_between_cards() {
    // The deck has cards of three lines, more than one chunk can contain, with comments and trailing commas at the chunk boundaries.
    let mut text = String::new();
    for i in 1..=20_000 {
        text.push_str(&format!(
            "RBE2,{i},1,123,2,3,4,5,6,\n$ between\n7,8,9\n,10,11\n"
        ));
    }
    let deck = read_clean_deck(&text);
    assert_eq!(deck.cards.rbe2s.len(), 20_000);
    for (i, rbe2) in deck.cards.rbe2s.iter().enumerate() {
        assert_eq!((rbe2.id as usize, rbe2.dependent.len()), (i + 1, 10));
        assert_eq!(rbe2.at.line as usize, 4 * i + 1);
    }
}

/// Returns offsets, stress points and end of a bar whose cards are in any order.
fn bar(text: &str) -> (f64, f64) {
    let deck = read_clean_deck(text);
    (
        deck.cards.bars[0].offsets[0][0],
        deck.cards.pbars[0].recovery[0][0],
    )
}

#[test]
fn a_continuation_goes_to_the_card_that_names_it_also_below_a_card_without_a_name() {
    let cbar = "CBAR          11       5       1       2      0.      1.      0.        +Q1\n";
    let rest_of_cbar = "+Q1                         -1.5      0.      0.      .5      0.      0.\n";
    let pbar = "PBAR           5       6     .02   1.-5    1.-5    1.-5                 +Q2\n";
    let rest_of_pbar = "+Q2          .25     .25\n";
    let grids = [
        "GRID           1              0.      0.      0.\n",
        "GRID           2              2.      0.      0.\n",
    ];
    let forms = [
        [cbar, grids[0], pbar, grids[1], rest_of_cbar, rest_of_pbar].concat(),
        [grids[1], rest_of_pbar, cbar, pbar, grids[0], rest_of_cbar].concat(),
        [grids[0], rest_of_cbar, rest_of_pbar, grids[1], pbar, cbar].concat(),
        // Large field, and names whose column 73 is not part of the name.
        [
            "CBAR*                 11               5               1               2*Q1\n",
            grids[0],
            "*Q1                   0.              1.              0.                *Q1B\n",
            pbar,
            grids[1],
            "*Q1B                                                -1.5              0.\n",
            rest_of_pbar,
        ]
        .concat(),
        [
            &cbar.replace("        +Q1", "        XQ1"),
            grids[0],
            pbar,
            grids[1],
            rest_of_pbar,
            grids[0],
            rest_of_cbar,
        ]
        .concat(),
        // Free field.
        [
            "CBAR,11,5,1,2,0.,1.,0.,,+Q1\n",
            grids[0],
            "PBAR,5,6,.02,1.-5,1.-5,1.-5,,,+Q2\n",
            grids[1],
            "+Q2,.25,.25\n",
            grids[1],
            "+Q1,,,-1.5,0.,0.,.5,0.,0.\n",
        ]
        .concat(),
    ];
    for form in forms {
        assert_eq!(bar(&form), (-1.5, 0.25), "{form}");
    }
}

#[test]
fn the_marks_of_columns_1_and_73_are_no_part_of_a_name() {
    let deck = read_clean_deck(
        "\
PBAR    5       6       .02     1.-5    1.-5    1.-5                     +000007
++000007.25     0.      -.25    0.      0.      .25     0.      -.25     +000008
++0000080.      .5
PSHELL* 7               6               .1              6               *+000009
*+000009
",
    );
    let p = &deck.cards.pbars[0];
    assert_eq!((p.recovery[3], p.k), ([0.0, -0.25], [Some(0.0), Some(0.5)]));
    assert_eq!(deck.cards.pshells[0].mid2, Some(6));
}

#[test]
fn a_continuation_that_two_cards_name_is_refused_with_both_lines() {
    let card = |id: u32| {
        format!("PBAR    {id:<8}6       .02     1.-5    1.-5    1.-5                    +Q1\n")
    };
    let [grid, rest] = ["GRID    1\n", "+Q1     .25     .25\n"];
    let deck = |parts: &[&str]| fault_texts(&super::bulk(&parts.concat()));
    let [five, six] = [card(5), card(6)];
    let apart = deck(&[&five, grid, &six, grid, rest]);
    assert_eq!(apart.len(), 1, "{apart:?}");
    assert!(
        apart[0].starts_with(
            "test.bdf:5: the continuation can belong to more than one card, because lines 1 and 3 both name it: Q1"
        ),
        "{apart:?}"
    );
    let below_one = deck(&[&five, grid, &six, rest]);
    assert!(
        below_one.len() == 1 && below_one[0].contains("lines 1 and 3 both name it"),
        "{below_one:?}"
    );
    let twice = deck(&[&five, grid, rest, grid, rest]);
    assert!(
        twice.len() == 1 && twice[0].contains("its name is also on line 3"),
        "{twice:?}"
    );
    // Names may occur several times if each continuation is below its card.
    assert!(deck(&[&five, rest, &six, rest]).is_empty());
}

#[test]
fn names_of_included_files_are_their_own() {
    let part = |id: u32, z: &str| {
        format!(
            "PSHELL  {id:<8}1       .25     1               1                       +P\nGRID    {id}\n+P      {z}\n"
        )
    };
    let files = [("a.inc", part(5, "-.5")), ("b.inc", part(6, "-.6"))];
    let files = files.map(|(name, text)| (name.to_owned(), text.into_bytes()));
    let mut loader = super::super::MemoryLoader {
        files: files.into(),
        ..Default::default()
    };
    let text = b"INCLUDE 'a.inc'\nINCLUDE 'b.inc'\n".to_vec();
    let deck = super::super::read_deck("test.bdf", text, &mut loader);
    assert_eq!(fault_texts(&deck), Vec::<String>::new());
    let z1 = |id: u32| deck.cards.pshells.iter().find(|p| p.id == id)?.z1;
    assert_eq!((z1(5), z1(6)), (Some(-0.5), Some(-0.6)));
}

#[test]
fn commas_behind_a_blank_field_are_text_of_the_card_above() {
    let cards = [
        "DEQATN  4       F(A,B)=A+MAX(A,B,\n        2.0*A,B)+\n        A,B\n",
        "DEQATN  4       F(A,B)=A+MAX(A,B,\n\t2.0*A,B)\n",
        "ADAPT   4       3       1\n        PART=SKIN,ELSET=7\n",
        "OUTPUT  4\n        TYPE=DISP,PART=SKIN\n",
        "DEQATN,4,F(A,B)=A+B\n",
    ];
    for card in cards {
        let deck = read_clean_deck(&format!("{card}GRID,1\n            GRID,2\nGRID,3\n"));
        assert_eq!(deck.others.len(), 1, "{card}");
        let ids: Vec<u32> = deck.cards.grids.iter().map(|g| g.id).collect();
        assert_eq!(ids, [1, 2, 3], "{card}");
    }
    // A leading comma means an empty field 1.
    let deck = read_clean_deck(
        "RBE3    9               1       123     1.      123     1\n        ,2,3\n",
    );
    assert_eq!(deck.cards.rbe3s.len(), 1);
}
