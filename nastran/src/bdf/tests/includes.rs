use super::super::{Deck, IncludeRequest, MemoryLoader, read_deck};
use super::fault_texts;

fn loader(files: &[(&str, &str)]) -> MemoryLoader {
    let files = files
        .iter()
        .map(|(p, t)| ((*p).to_owned(), t.as_bytes().to_vec()))
        .collect();
    MemoryLoader {
        files,
        symbols: [("BULKDIR".to_owned(), "a".to_owned())].into(),
    }
}

fn read(main: &str, files: &[(&str, &str)]) -> Deck {
    read_deck(
        "jobs/run/main.bdf",
        main.as_bytes().to_vec(),
        &mut loader(files),
    )
}

#[test]
fn include_names_are_quoted_or_not_and_may_take_two_lines() {
    let statements = [
        "INCLUDE 'a/b.inc'\n",
        "include \"a/b.inc\" $ note\n",
        "INCLUDE a/b.inc\n",
        "INCLUDE a/b.inc $ note\n",
        "INCLUDE 'a/\nb.inc'\n",
        "INCLUDE 'a/\r\n  b.inc'\r\n",
        "  INCLUDE='a\\b.inc'\n",
        "INCLUDE 'BULKDIR:b.inc'\n",
        "INCLUDE '$BULKDIR/b.inc'\n",
        "INCLUDE '%BULKDIR%/b.inc'\n",
        "INCLUDE '${BULKDIR}/b.inc'\n",
    ];
    for statement in statements {
        let deck = read(
            &format!("GRID,1\n{statement}GRID,3\n"),
            &[("jobs/run/a/b.inc", "GRID,2\n")],
        );
        assert_eq!(fault_texts(&deck), Vec::<String>::new(), "{statement}");
        let ids: Vec<u32> = deck.cards.grids.iter().map(|g| g.id).collect();
        assert_eq!(ids, [1, 2, 3], "{statement}");
        assert_eq!(deck.cards.grids[1].at.source.0, 1);
    }
}

#[test]
fn a_bare_name_is_looked_for_in_the_folder_of_the_including_file_and_a_path_in_that_of_the_first_deck()
 {
    let files = [
        (
            "jobs/run/sub/one.inc",
            "INCLUDE 'two.inc'\nINCLUDE 'parts/six.inc'\n",
        ),
        ("jobs/run/two.inc", "GRID,1\n"),
        ("jobs/run/sub/two.inc", "GRID,2\n"),
        ("jobs/run/parts/six.inc", "GRID,6\n"),
        ("jobs/run/sub/parts/six.inc", "GRID,7\n"),
    ];
    let ids = |deck: &Deck| -> Vec<u32> { deck.cards.grids.iter().map(|g| g.id).collect() };
    let deck = read("INCLUDE 'sub/one.inc'\n", &files);
    assert_eq!(ids(&deck), [2, 6]);
    let notes: Vec<(u32, &str)> = deck
        .notes
        .iter()
        .map(|n| (n.at.line, n.text.as_str()))
        .collect();
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(
        notes[0].0 == 1
            && notes[0].1.starts_with(
                "INCLUDE reads `jobs/run/sub/two.inc`, and not `jobs/run/two.inc`, whose contents differ"
            ),
        "{notes:?}"
    );
    let alone = read("INCLUDE 'sub/one.inc'\n", &[files[0], files[1], files[4]]);
    assert_eq!((ids(&alone), alone.notes.len()), (vec![1, 7], 0));
    // A file with equal contents gives no note.
    let copies = [
        files[0],
        files[1],
        ("jobs/run/sub/two.inc", files[1].1),
        files[3],
    ];
    assert!(read("INCLUDE 'sub/one.inc'\n", &copies).notes.is_empty());
}

#[test]
fn absolute_paths_of_both_systems_are_tried_as_they_are() {
    for name in ["/abs/x.inc", "C:\\abs\\x.inc", "C:/abs/x.inc"] {
        let request = IncludeRequest {
            name: name.to_owned(),
            first_deck: "d/main.bdf".to_owned(),
            includer: "e/sub.bdf".to_owned(),
        };
        assert_eq!(request.candidates(|_| None).unwrap()[0], name);
    }
    let request = IncludeRequest {
        name: "NOWHERE:x".to_owned(),
        first_deck: String::new(),
        includer: String::new(),
    };
    assert_eq!(request.candidates(|_| None), Err("NOWHERE".to_owned()));
}

#[test]
fn a_missing_file_is_a_fault_in_every_section() {
    let deck = read(
        "SOL 101\nINCLUDE 'dmap.alt'\nCEND\nINCLUDE 'case.inc'\nBEGIN BULK\nINCLUDE 'gone.inc'\nGRID,1\nENDDATA\n",
        &[],
    );
    let faults = fault_texts(&deck);
    for (fault, (line, name)) in
        faults
            .iter()
            .zip([(2, "dmap.alt"), (4, "case.inc"), (6, "gone.inc")])
    {
        let start = format!(
            "jobs/run/main.bdf:{line}: `INCLUDE`: the included file cannot be read: {name}"
        );
        assert!(fault.starts_with(&start), "{fault}");
    }
    assert_eq!(faults.len(), 3);
    assert_eq!(deck.cards.grids.len(), 1);
}

#[test]
fn a_deck_that_ends_within_a_line_is_cut_and_one_without_enddata_may_be() {
    let whole = "SOL 101\nCEND\nBEGIN BULK\nGRID,1\nGRID,21\nENDDATA\n";
    assert!(fault_texts(&read(whole, &[])).is_empty());
    let within = fault_texts(&read(&whole[..whole.len() - 10], &[]));
    assert_eq!(within.len(), 1);
    assert!(
        within[0].contains(":5: `ENDDATA`: the deck ends within a line"),
        "{within:?}"
    );
    let between = read(&whole[..whole.len() - 8], &[]);
    assert!(fault_texts(&between).is_empty());
    assert!(between.notes[0].text.contains("without ENDDATA"));
    // Bulk data alone needs no ENDDATA.
    let bulk = read("GRID,1\nGRID,21", &[]);
    assert!(fault_texts(&bulk).is_empty() && bulk.notes.is_empty());
}

#[test]
fn a_file_that_includes_itself_is_a_fault() {
    let deck = read(
        "INCLUDE 'a.inc'\nGRID,1\n",
        &[
            ("jobs/run/a.inc", "GRID,2\nINCLUDE 'b.inc'\n"),
            ("jobs/run/b.inc", "INCLUDE 'a.inc'\n"),
        ],
    );
    assert_eq!(deck.faults.len(), 1);
    assert!(
        fault_texts(&deck)[0]
            .contains("jobs/run/b.inc:1: `INCLUDE`: the file includes itself: a.inc")
    );
    assert_eq!(deck.cards.grids.len(), 2);
}

#[test]
fn executive_case_and_bulk_may_each_be_included() {
    let files = [
        ("jobs/run/exec.inc", "SOL 101\nCEND\n"),
        ("jobs/run/case.inc", "SPC = 3\nSUBCASE 1\n LOAD = 4\n"),
        ("jobs/run/bulk.inc", "GRID,1\nENDDATA\n"),
    ];
    let deck = read(
        "INCLUDE 'exec.inc'\nINCLUDE 'case.inc'\nBEGIN BULK\nINCLUDE 'bulk.inc'\nGRID,2\n",
        &files,
    );
    assert_eq!(fault_texts(&deck), Vec::<String>::new());
    assert_eq!(
        (
            deck.sol,
            deck.case_control.subcases[0].load,
            deck.cards.grids.len()
        ),
        (Some(101), Some(4), 1)
    );
    assert!(
        deck.notes
            .iter()
            .any(|n| n.text.contains("ENDDATA of an included file"))
    );
}

#[test]
fn an_unclosed_name_is_a_fault() {
    let deck = read("GRID,1\nINCLUDE 'a.inc\nGRID,2\n", &[]);
    assert!(!deck.faults.is_empty());
    assert_eq!(deck.cards.grids[0].id, 1);
}
