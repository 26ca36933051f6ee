use super::{clean, shown};

/// A PSHELL with Z1, Z2.
fn fibres(text: &str) -> (Option<f64>, Option<f64>) {
    let deck = clean(text);
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
    let deck = clean(text);
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
        shown(&deck),
        [
            "test.bdf:1: the continuation belongs to no card: B1: put the continuation below its card, or give both the same name in columns 73-80 and 1-8"
        ]
    );
    assert_eq!(deck.cards.grids.len(), 1);
}

#[test]
fn a_continuation_with_another_name_stays_with_the_card_above_and_is_noted() {
    let head = "PSHELL  4       1       .25     1               1                       ";
    let deck = super::bulk(&format!("{head}+P4\n+P5     -.1     .2\n"));
    assert_eq!(deck.cards.pshells[0].z1, Some(-0.1));
    assert_eq!((deck.faults.len(), deck.notes.len()), (0, 1));
}

#[test]
fn chunks_of_a_large_deck_are_cut_between_cards() {
    // cards of three lines, more than a chunk's worth, with comments and trailing commas at the seams
    let mut text = String::new();
    for i in 1..=20_000 {
        text.push_str(&format!(
            "RBE2,{i},1,123,2,3,4,5,6,\n$ between\n7,8,9\n,10,11\n"
        ));
    }
    let deck = clean(&text);
    assert_eq!(deck.cards.rbe2s.len(), 20_000);
    for (i, rbe2) in deck.cards.rbe2s.iter().enumerate() {
        assert_eq!((rbe2.id as usize, rbe2.dependent.len()), (i + 1, 10));
        assert_eq!(rbe2.at.line as usize, 4 * i + 1);
    }
}
