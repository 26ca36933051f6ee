use super::*;
use crate::fe::Solution;
use crate::fe::strain_rows::{Location, Point, each_row, n_elements};
use crate::model::Model;
use nastran::bdf::{MemoryLoader, read_deck};
use nastran::op2::write_blocks;
use nastran::results::ResultsFile;

/// A plate of one quad 2 x 1 and one triangle, and a bar, in MPa and mm.
const DECK: &str = "SOL 101\nCEND\nBEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,2.,0.,0.
GRID,3,,2.,1.,0.
GRID,4,,0.,1.,0.
GRID,5,,3.,0.,0.,7
CORD2C,7,,3.,-1.,0.,3.,-1.,1.
,3.,0.,0.
CQUAD4,11,1,1,2,3,4
CTRIA3,12,1,2,5,3
CBAR,21,2,1,4,0.,0.,1.
PSHELL,1,1,0.4,1,,1
PBAR,2,1,1.,1.,1.,1.
MAT1,1,200000.,,0.25
ENDDATA
";

fn model() -> Model {
    let deck = read_deck(
        "plate.bdf",
        DECK.as_bytes().to_vec(),
        &mut MemoryLoader::default(),
    );
    Model::from_cards(&deck.cards).0
}

/// Returns a punch block: header, then entries of an id and reals.
pub(super) fn block(
    subcase: u32,
    quantity: &str,
    element: &str,
    entries: &[(&str, Vec<f64>)],
) -> String {
    let mut text = format!(
        "$TITLE   = T\n$SUBTITLE=\n$LABEL   = PULL\n${quantity}\n$REAL OUTPUT\n$SUBCASE ID = {subcase}\n"
    );
    if !element.is_empty() {
        text += &format!("$ELEMENT TYPE = {element}\n");
    }
    for (id, values) in entries {
        for (i, three) in values.chunks(3).enumerate() {
            text += &format!("{:<18}", if i == 0 { id } else { &"-CONT-" });
            three.iter().for_each(|v| text += &format!("{v:>18.6E}"));
            text.push('\n');
        }
    }
    text
}

/// Returns two fibres, each with fibre distance and three components. The other words are zero.
pub(super) fn shell(z: [f64; 2], a: [f64; 3], b: [f64; 3]) -> Vec<f64> {
    [
        [z[0], a[0], a[1], a[2], 0.0, 0.0, 0.0, 0.0],
        [z[1], b[0], b[1], b[2], 0.0, 0.0, 0.0, 0.0],
    ]
    .concat()
}

fn solve(text: &str) -> Solution {
    let file = ResultsFile::read(text.as_bytes(), "plate.pch").unwrap();
    solution_from_results(&model(), &[("plate.pch", &file)], &ReadOptions::default())
}

fn codes(solution: &Solution) -> Vec<&str> {
    solution.findings.iter().map(|f| f.code).collect()
}

fn assert_close(a: [f64; 3], b: [f64; 3]) {
    a.iter()
        .zip(b)
        .for_each(|(x, y)| assert!((x - y).abs() < 1e-12, "{a:?} {b:?}"));
}

#[test]
fn fibre_and_curvature_form_of_one_state_give_the_same_strain_at_the_surfaces() {
    let (mid, slope) = ([1e-4, -2e-4, 3e-4], [1e-3, 2e-3, -1e-3]);
    let at = |z: f64| std::array::from_fn(|i| mid[i] + z * slope[i]);
    let fibre = block(
        1,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[("        11", shell([-0.2, 0.2], at(-0.2), at(0.2)))],
    );
    let curvature = block(
        1,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[("        11", shell([0.0, -1.0], mid, slope.map(|s| -s)))],
    );
    let (a, b) = (solve(&fibre), solve(&curvature));
    for s in [&a, &b] {
        let [bottom, top] = s.cases[0].shells.centre[0];
        assert_close(bottom, at(-0.2));
        assert_close(top, at(0.2));
        assert!(!codes(s).contains(&"fibre-distance-differs"));
    }
    assert_eq!(a.cases[0].label, "PULL");
}

#[test]
fn elements_come_out_ascending_whatever_the_order_of_blocks() {
    let text = block(
        1,
        "ELEMENT STRAINS",
        "74 TRIA3",
        &[("        12", shell([-0.2, 0.2], [2e-4; 3], [2e-4; 3]))],
    ) + &block(
        1,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[("        11", shell([-0.2, 0.2], [1e-4; 3], [1e-4; 3]))],
    );
    let shells = &solve(&text).cases[0].shells;
    assert!(shells.elements.is_sorted());
    assert_close(shells.centre[0][0], [1e-4; 3]);
    assert_close(shells.centre[1][0], [2e-4; 3]);
}

#[test]
fn strain_comes_from_stress_only_where_there_is_no_strain_and_reports_it() {
    let stress = block(
        1,
        "ELEMENT STRESSES",
        "33 QUAD4",
        &[(
            "        11",
            shell([-0.2, 0.2], [200.0, 0.0, 80.0], [0.0, 200.0, 0.0]),
        )],
    );
    let alone = solve(&stress);
    assert!(alone.cases[0].shells.from_stress && codes(&alone).contains(&"strain-from-stress"));
    // E 200000, nu 0.25, G 80000.
    assert_close(alone.cases[0].shells.centre[0][0], [1e-3, -2.5e-4, 1e-3]);
    let strain = block(
        1,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[("        11", shell([-0.2, 0.2], [5e-4; 3], [5e-4; 3]))],
    );
    let both = solve(&(stress + &strain));
    assert!(!both.cases[0].shells.from_stress);
    assert_close(both.cases[0].shells.centre[0][0], [5e-4; 3]);
}

#[test]
fn bending_of_a_bar_takes_its_axial_strain() {
    let row = (1..=15).map(|i| f64::from(i) * 1e-5).collect();
    let solution = solve(&block(
        1,
        "ELEMENT STRAINS",
        "34 BAR",
        &[("        21", row)],
    ));
    let stations = &solution.cases[0].beams.stations[0];
    assert_eq!((stations[0].0, stations[1].0), (0.0, 1.0));
    for (got, want) in stations[0]
        .1
        .iter()
        .chain(&stations[1].1)
        .zip([6e-5, 7e-5, 8e-5, 9e-5, 14e-5, 15e-5, 16e-5, 17e-5])
    {
        assert!((got - want).abs() < 1e-15);
    }
}

#[test]
fn displacements_turn_from_a_cylindrical_frame_to_basic() {
    let text = block(
        1,
        "DISPLACEMENTS",
        "",
        &[
            ("         5       G", vec![1.0, 2.0, 3.0, 0.0, 0.0, 4.0]),
            ("         1       G", vec![1.0, 2.0, 3.0, 0.0, 0.0, 0.0]),
        ],
    );
    let solution = solve(&text);
    let u = &solution.cases[0].displacement;
    let ix = |id: u32| model().grid_ix(id).unwrap().us();
    // Grid 5 is on its frame's x axis, which is along basic y. There, radial is basic y and tangential is -x.
    let basic = [-2.0, 1.0, 3.0, 0.0, 0.0, 4.0];
    let off = u[ix(5)].iter().zip(basic).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-14, "{:?}", u[ix(5)]);
    assert_eq!(u[ix(1)][..3], [1.0, 2.0, 3.0]);
    assert!(u[ix(2)][0].is_nan());
}

#[test]
fn displacements_of_a_table_in_the_basic_frame_stay_as_they_are() {
    let stated = [1.0, 2.0, 3.0, 0.0, 0.0, 4.0];
    let entry = ("         5       G", stated.to_vec());
    let text = block(1, "DISPLACEMENTS", "", &[entry]);
    let punch = ResultsFile::read(text.as_bytes(), "plate.pch").unwrap();
    let rows = punch.rows(0).unwrap();
    let mut bytes = write_blocks([(&punch.blocks()[0], &rows)], [11, 22, 2026]).unwrap();
    let at_5 = |bytes: &[u8]| {
        let file = ResultsFile::read(bytes, "plate.op2").unwrap();
        let files = [("plate.op2", &file)];
        let solution = solution_from_results(&model(), &files, &ReadOptions::default());
        solution.cases[0].displacement[model().grid_ix(5).unwrap().us()]
    };
    // Grid 5 has a separate displacement frame.
    assert_ne!(at_5(&bytes), stated);
    let names: Vec<usize> = (0..bytes.len() - 8)
        .filter(|&i| bytes[i..].starts_with(b"OUGV1   "))
        .collect();
    for i in names {
        bytes[i..i + 8].copy_from_slice(b"BOUGV1  ");
    }
    assert_eq!(at_5(&bytes), stated);
}

#[test]
fn each_contradiction_is_reported_once() {
    let entry = |z: f64| shell([-z, z], [1e-4; 3], [1e-4; 3]);
    let text = block(
        1,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[("        11", entry(0.5)), ("        99", entry(0.2))],
    ) + &block(
        2,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[("        11", entry(0.5))],
    ) + &block(
        3,
        "DISPLACEMENTS",
        "",
        &[("        77       G", vec![0.0; 6])],
    ) + &block(
        4,
        "EIGENVECTOR",
        "",
        &[("         1       G", vec![0.0; 6])],
    );
    let solution = solve(&text);
    for code in [
        "fibre-distance-differs",
        "element-not-in-deck",
        "grid-not-in-deck",
        "no-strain-output",
        "not-static",
    ] {
        assert_eq!(
            codes(&solution).iter().filter(|c| **c == code).count(),
            1,
            "{code}: {:?}",
            codes(&solution)
        );
    }
    let fibres = solution
        .findings
        .iter()
        .find(|f| f.code == "fibre-distance-differs")
        .unwrap();
    assert_eq!((fibres.measured, fibres.limit), (Some(-0.5), Some(-0.2)));
}

#[test]
fn strain_of_one_file_and_displacements_of_another_make_one_case() {
    let strain = block(
        1,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[("        11", shell([-0.2, 0.2], [1e-4; 3], [1e-4; 3]))],
    );
    let moved = block(
        1,
        "DISPLACEMENTS",
        "",
        &[("         1       G", vec![1.0; 6])],
    );
    let (a, b) = (
        ResultsFile::read(strain.as_bytes(), "a").unwrap(),
        ResultsFile::read(moved.as_bytes(), "b").unwrap(),
    );
    let both = solution_from_results(&model(), &[("a", &a), ("b", &b)], &ReadOptions::default());
    assert_eq!(both.cases.len(), 1);
    assert!(!both.cases[0].shells.elements.is_empty() && !both.cases[0].displacement.is_empty());
    // Equal values count as one case.
    let twice = solution_from_results(&model(), &[("a", &a), ("a2", &a)], &ReadOptions::default());
    assert_eq!(twice.cases.len(), 1);
    assert!(!codes(&twice).contains(&"subcase-ambiguous"));
}

#[test]
fn elements_that_are_spread_over_two_files_are_one_case_and_other_values_are_two() {
    let strain = |element: &str, id: &str, exx: f64| {
        let rows = shell([-0.2, 0.2], [exx; 3], [exx; 3]);
        block(1, "ELEMENT STRAINS", element, &[(id, rows)])
    };
    let quad = |exx| strain("33 QUAD4", "        11", exx);
    let texts = [
        quad(1e-4),
        strain("74 TRIA3", "        12", 2e-4),
        quad(9e-4),
    ];
    let files = texts.each_ref();
    let files = files.map(|t| ResultsFile::read(t.as_bytes(), "").unwrap());
    let of = |list: &[usize]| {
        let named: Vec<_> = list
            .iter()
            .map(|i| (["a", "b", "c"][*i], &files[*i]))
            .collect();
        solution_from_results(&model(), &named, &ReadOptions::default())
    };
    let spread = of(&[1, 0]);
    assert_eq!(spread.cases.len(), 1);
    let shells = &spread.cases[0].shells;
    assert!(shells.elements.is_sorted() && shells.elements.len() == 2);
    assert_close(shells.centre[0][0], [1e-4; 3]);
    assert_close(shells.centre[1][0], [2e-4; 3]);
    assert!(!codes(&spread).contains(&"subcase-ambiguous"));
    let two = of(&[0, 2]);
    assert_eq!(two.cases.len(), 2);
    let finding = two.findings.iter().find(|f| f.code == "subcase-ambiguous");
    let finding = finding.unwrap();
    assert_eq!(finding.subject, "a, c");
    assert!(
        finding
            .message
            .starts_with("Subcase 1 is in `a` and in `c` with different strain")
    );
}

#[test]
fn rows_carry_the_normal_strain_of_plane_stress_and_bars_lie_along_their_axis() {
    let text = block(
        1,
        "ELEMENT STRAINS",
        "33 QUAD4",
        &[(
            "        11",
            shell([-0.2, 0.2], [3e-4, 0.0, 2e-4], [0.0; 3]),
        )],
    ) + &block(
        1,
        "ELEMENT STRAINS",
        "34 BAR",
        &[(
            "        21",
            vec![
                0.0, 0.0, 0.0, 0.0, 5e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            ],
        )],
    );
    let (solution, m) = (solve(&text), model());
    let mut rows = Vec::new();
    each_row(
        &m,
        &solution.cases[0],
        0..n_elements(&solution.cases[0]),
        |r| rows.push(*r),
    );
    assert_eq!(rows.len(), 2 + 8);
    // The quad is in basic x-y with x along side 1-2. So ezz = -nu / (1 - nu) exx, and tensor shear is half the engineering shear.
    let want = [3e-4, 0.0, -1e-4, 1e-4, 0.0, 0.0];
    rows[0]
        .basic
        .iter()
        .zip(want)
        .for_each(|(g, w)| assert!((g - w).abs() < 1e-15));
    // The bar runs along basic y from grid 1 to grid 4.
    let bar = rows[2];
    assert_eq!(
        (bar.card, bar.location, bar.point),
        ("CBAR", Location::Grid(1), Point::Recovery(0))
    );
    bar.basic
        .iter()
        .zip([0.0, 5e-4, 0.0, 0.0, 0.0, 0.0])
        .for_each(|(g, w)| assert!((g - w).abs() < 1e-15));
}
