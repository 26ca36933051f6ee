//! Entries of the geometry blocks of an OP2 that are not read. `check` names them with their count, and the solver
//! refuses the mesh.

use nastran::bdf::{MemoryLoader, read_deck};
use nastran::op2::Op2;
use std::path::{Path, PathBuf};
use strainbridge::Context;
use strainbridge::fe::{FeError, LoadCase, Relief, SolveOptions, UnitLoad, refuse, solve_cases};
use strainbridge::finding::Finding;
use strainbridge::host::context::InMemory;
use strainbridge::model::Model;
use strainbridge::workflow::{check::check, solve::solve_deck};

/// Bytes of an OP2 under construction.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn physical(&mut self, bytes: &[u8]) {
        let n = (bytes.len() as u32).to_le_bytes();
        self.0.extend(n);
        self.0.extend(bytes);
        self.0.extend(n);
    }

    fn key(&mut self, key: i32) {
        self.physical(&key.to_le_bytes());
    }

    fn words(&mut self, bytes: &[u8]) {
        self.key((bytes.len() / 4) as i32);
        self.physical(bytes);
    }

    fn ints(&mut self, values: &[i32]) {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.words(&bytes);
    }

    fn open_record(&mut self, number: i32) {
        self.key(-number);
        self.key(1);
        self.key(0);
    }

    fn table(&mut self, name: &str, records: &[Vec<i32>]) {
        let padded = format!("{name:8}");
        self.words(padded.as_bytes());
        self.key(-1);
        self.ints(&[101, 0, 0, 0, 0, 0, 0]);
        self.open_record(2);
        self.words(padded.as_bytes());
        for (number, record) in (3..).zip(records) {
            self.open_record(number);
            self.ints(record);
        }
        self.open_record(3 + records.len() as i32);
        self.key(0);
    }
}

fn encode_real(v: f32) -> i32 {
    v.to_bits() as i32
}

/// Returns a rod from grid 1 to 2 with a force in set 1, and further records of tables.
fn rod(more: &[(&str, Vec<i32>)]) -> Vec<u8> {
    let zero = encode_real(0.0);
    let grid = |id: i32, x: f32| [id, 0, encode_real(x), zero, zero, 0, 0, 0];
    let grids = [[4501, 45, 1].as_slice(), &grid(1, 0.0), &grid(2, 2.0)].concat();
    let rods = vec![3001, 30, 48, 1, 7, 1, 2];
    let force = vec![
        4201,
        42,
        18,
        1,
        2,
        0,
        encode_real(1000.0),
        encode_real(1.0),
        zero,
        zero,
    ];
    let prod = vec![902, 9, 29, 7, 3, encode_real(0.01), zero, zero, zero];
    let mut mat1 = vec![
        103,
        1,
        77,
        3,
        encode_real(1e10),
        encode_real(4e9),
        encode_real(0.25),
        encode_real(100.0),
    ];
    mat1.extend([zero; 6]);
    mat1.push(0);
    let tables = [
        ("GEOM1", grids),
        ("GEOM2", rods),
        ("GEOM3", force),
        ("GEOM4", vec![5601, 56, 14, 1, 123456]),
        ("EPT", prod),
        ("MPT", mat1),
    ];
    let mut out = Bytes::default();
    out.ints(&[1, 1, 26]);
    out.words(b"NASTRAN FORT TAPE ID CODE - ");
    out.words(b"XXXXXXXX");
    out.key(-1);
    out.key(0);
    for (name, record) in tables {
        let more = more.iter().filter(|m| m.0 == name).map(|m| m.1.clone());
        let records: Vec<_> = std::iter::once(record).chain(more).collect();
        out.table(name, &records);
    }
    out.key(0);
    out.0
}

/// Returns the findings of `check` and the refusal of `solve`.
fn check_and_solve(bytes: &[u8]) -> (Vec<Finding>, String) {
    let files = InMemory::default().with_file("rod.op2", bytes.to_vec());
    let cx = Context::new(&files);
    let looked = check(&[PathBuf::from("rod.op2")], &cx).unwrap();
    assert!(looked.faults.is_empty(), "{:?}", looked.faults);
    let solved = solve_deck(Path::new("rod.op2"), SolveOptions::default(), &cx);
    let refused = solved.err().map_or(String::new(), |f| f.to_string());
    (looked.findings.0.clone(), refused)
}

fn find_unsolved_card(findings: &[Finding]) -> Option<(&str, f64)> {
    let found = findings.iter().find(|f| f.code == "card-not-solved")?;
    Some((found.message.as_str(), found.measured?))
}

#[test]
fn unread_elements_are_named_with_their_count_and_refused() {
    // Two CGAP of nine words, one RSSCON without a fixed length, and a code that is in no table.
    let gap = |id: i32| [id, 5, 1, 2, 0, 0, 0, 0, 0];
    let gaps = [[1908, 19, 104].as_slice(), &gap(31), &gap(32)].concat();
    for (table, record, named, count) in [
        ("GEOM2", gaps, "CGAP 31", 2.0),
        ("GEOM4", vec![7201, 72, 398, 9, 1, 2], "RSSCON", 1.0),
        ("GEOM2", vec![7, 7, 7, 1, 2], "record 7,7,7 of GEOM2", 1.0),
        (
            "MPT",
            [vec![503, 5, 90], vec![3; 11]].concat(),
            "MATS1 3",
            1.0,
        ),
        ("GEOM4", vec![6901, 69, 295, 0], "RBE2", 1.0),
    ] {
        let (findings, refused) = check_and_solve(&rod(&[(table, record)]));
        let (message, measured) =
            find_unsolved_card(&findings).unwrap_or_else(|| panic!("{named}"));
        assert!(
            message.contains(&format!("`rod.op2`: `{named}` affects the solution")),
            "{message}"
        );
        assert_eq!(measured, count, "{named}");
        assert!(refused.contains(named), "{named}: {refused}");
    }
}

#[test]
fn records_without_influence_give_no_finding() {
    let plotel = vec![5201, 52, 11, 9, 1, 2];
    let damper = vec![201, 2, 69, 8, 5, 1, 2, 1, 1];
    let heat = [vec![2103, 21, 234], vec![3; 11]].concat();
    for more in [
        vec![],
        vec![("GEOM2", plotel), ("GEOM2", damper), ("MPT", heat)],
    ] {
        let (findings, refused) = check_and_solve(&rod(&more));
        assert_eq!(find_unsolved_card(&findings), None);
        let notes = findings.iter().filter(|f| f.code == "geometry-note");
        assert_eq!(notes.count(), 0);
        assert!(!refused.contains("does not support"), "{refused}");
    }
}

#[test]
fn unread_loads_act_where_their_set_is_selected() {
    // FORCE2 in set 5, and MATT1, which acts if case control selects temperatures.
    let force2 = vec![4101, 41, 22, 5, 2, encode_real(1.0), 1, 2, 1, 2];
    let matt1 = [vec![703, 7, 91], vec![3; 12]].concat();
    let bytes = rod(&[("GEOM3", force2), ("MPT", matt1)]);
    let (findings, refused) = check_and_solve(&bytes);
    assert!(
        find_unsolved_card(&findings)
            .is_some_and(|w| w.0.contains("`FORCE2 5` affects the solution"))
    );
    assert!(!refused.contains("does not support"), "{refused}");
    let noted = |f: &&Finding| f.code == "geometry-note" && f.message.contains("MATT1");
    assert!(findings.iter().any(|f| noted(&f)));
    let (cards, _) = Op2::read(&bytes).unwrap().cards();
    let (model, _) = Model::from_cards(&cards);
    let case = |set: u32| LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(set)],
        spc: None,
        mpc: None,
        relief: Relief::Automatic,
    };
    assert!(refuse(&model, &[case(1)]).is_ok());
    match refuse(&model, &[case(5)]) {
        Err(FeError::Refused(list)) => assert_eq!(list[0].card, "FORCE2 5"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn springs_between_scalar_points_are_read_as_from_a_deck() {
    // Three springs in a row support grid 2 of the rod: CELAS2 to point 90, CELAS4 to point 91, CELAS3 to ground.
    let k = [2e7_f32, 5e7, 8e7];
    let first = vec![
        701,
        7,
        74,
        50,
        encode_real(k[0]),
        2,
        90,
        1,
        0,
        encode_real(0.0),
        encode_real(0.0),
    ];
    let held = vec![5481, 58, 12, 1, 23456, 0, 1, 2, -1];
    let op2 = rod(&[
        ("GEOM2", first),
        ("GEOM2", vec![901, 9, 76, 51, encode_real(k[1]), 90, 91]),
        ("GEOM2", vec![801, 8, 75, 52, 9, 91, 0]),
        ("GEOM2", vec![5551, 49, 105, 90, 91, 92]),
        (
            "EPT",
            vec![
                302,
                3,
                46,
                9,
                encode_real(k[2]),
                encode_real(0.0),
                encode_real(0.0),
            ],
        ),
        ("GEOM4", held),
    ]);
    let deck = "SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCROD,1,7,1,2\nPROD,7,3,.01\n\
         MAT1,3,1.+10,4.+9,.25,100.\nSUPORT,1,123456\nFORCE,1,2,,1000.,1.,0.,0.\nSPC1,1,23456,1,2\n\
         CELAS2,50,2.+7,2,1,90\nCELAS4,51,5.+7,90,91\nCELAS3,52,9,91\nPELAS,9,8.+7\nSPOINT,90,91,92\nENDDATA\n";
    let (cards, notes) = Op2::read(&op2).unwrap().cards();
    assert!(notes.is_empty(), "{notes:?}");
    let written = read_deck("rod.bdf", deck.into(), &mut MemoryLoader::default());
    assert!(written.faults.is_empty(), "{:?}", written.faults);
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: None,
        relief: Relief::None,
    };
    let moved = [&cards, &written.cards].map(|cards| {
        let (mut model, faults) = Model::from_cards(cards);
        assert!(faults.is_empty(), "{faults:?}");
        model.suports.clear();
        let cases = std::slice::from_ref(&case);
        let (solution, _) = solve_cases(&model, cases, &SolveOptions::default()).unwrap();
        let ids = model.grids.iter().map(|g| g.id);
        let u = solution.cases[0].displacement.iter().map(|u| u[0]);
        ids.zip(u).collect::<Vec<_>>()
    });
    // The force through the rod stretches each spring by F/k. Grid 1 is free and moves with grid 2.
    let stretch = k.map(|k| 1000.0 / f64::from(k));
    let at_91 = stretch[2];
    let at_90 = at_91 + stretch[1];
    let at_2 = at_90 + stretch[0];
    let expected = [(1, at_2), (2, at_2), (90, at_90), (91, at_91), (92, 0.0)];
    for moved in &moved {
        assert_eq!(moved.len(), expected.len());
        for ((id, u), (of, closed)) in moved.iter().zip(expected) {
            assert!(*id == of && (u - closed).abs() < 1e-12 * at_2, "{moved:?}");
        }
    }
}
