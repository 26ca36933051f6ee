//! Tests CWELD and CFAST in every supported format.
//!
//! A connector alone joins two plates. The references are the closed forms of a round cantilever and of springs. The
//! tie is compared with fields of known slope.

use crate::mesh::{Bulk, Solved};
use strainbridge::fe::*;
use strainbridge::model::FaultWeight;

const E: f64 = 210_000.0;
const NU: f64 = 0.3;
const G: f64 = E / (2.0 + 2.0 * NU);
/// Diameter D of the weld and distance GAP of the plates.
const D: f64 = 6.0;
const GAP: f64 = 10.0;
/// Position of the connector, away from the middle of every element.
const AT: [f64; 2] = [21.0, 17.5];

/// Returns two plates 40 x 40, 2 thick, with elements of side 10. The lower one is fixed.
///
/// Property 1 is at z = 0 (elements 1 to 16), property 2 at z = GAP (elements 17 to 32). Grid GS 101 is between the
/// plates, GA 102 and GB 103 are on the plates. Load set 1 acts at GB.
pub fn plates(connector: &str, load: &str) -> Bulk {
    let mut b = Bulk::shell(E, NU, 2.0);
    b.card(&format!("PSHELL,2,1,2.,1,,1\nPWELD,7,1,{D:?}"));
    let n = 5;
    let mut lower = Vec::new();
    for z in [0.0, GAP] {
        let first = if z == 0.0 { 0 } else { n * n };
        for i in 0..n {
            for j in 0..n {
                let id = first + n * i + j + 1;
                let (x, y) = (10.0 * f64::from(i), 10.0 * f64::from(j));
                b.card(&format!("GRID,{id},,{x:?},{y:?},{z:?}"));
                if z == 0.0 {
                    lower.push(id);
                }
            }
        }
        let (eid, pid) = if z == 0.0 { (1, 1) } else { (17, 2) };
        for i in 0..n - 1 {
            for j in 0..n - 1 {
                let g = first + n * i + j + 1;
                b.card(&format!(
                    "CQUAD4,{},{pid},{g},{},{},{}",
                    eid + 4 * i + j,
                    g + n,
                    g + n + 1,
                    g + 1
                ));
            }
        }
    }
    for (id, z) in [(101, 4.0), (102, 0.0), (103, GAP)] {
        b.card(&format!("GRID,{id},,{:?},{:?},{z:?}", AT[0], AT[1]));
    }
    b.hold("123456", lower);
    b.card(connector);
    b.card(load);
    b
}

fn solve_without_faults(b: &Bulk) -> Solved {
    let faults = b.faults();
    assert!(faults.is_empty(), "{faults:?}");
    b.solve()
}

/// Returns the formats, all with GA and GB, which depend on the patches.
fn formats() -> Vec<(&'static str, String)> {
    // The connector is over element 10 (x 20 to 30, y 10 to 20) with the corners 12 17 18 13. The upper corner ids are
    // larger by 25.
    let card = |rest: &str| format!("CWELD,500,7,101,{rest}");
    vec![
        (
            "GRIDID",
            card("GRIDID,102,103,,,\n,12,17,18,13,,,,,\n,37,42,43,38"),
        ),
        ("ELEMID", card("ELEMID,102,103,,,\n,10,26")),
        ("ELPAT", card("ELPAT,102,103,,,\n,10,26")),
        ("PARTPAT", card("PARTPAT,102,103,,,\n,1,2")),
    ]
}

#[test]
fn a_weld_of_each_format_bends_stretches_and_twists_as_a_round_cantilever() {
    let area = std::f64::consts::PI * D * D / 4.0;
    let i = std::f64::consts::PI * D.powi(4) / 64.0;
    let l = GAP;
    let p = 100.0;
    let shear = p * l / (0.9 * G * area);
    // Load at the free end, dof of the displacement there, closed form.
    let cases = [
        ("FORCE,1,103,0,100.,0.,0.,1.", 2, p * l / (E * area)),
        (
            "FORCE,1,103,0,100.,1.,0.,0.",
            0,
            p * l.powi(3) / (3.0 * E * i) + shear,
        ),
        (
            "FORCE,1,103,0,100.,0.,1.,0.",
            1,
            p * l.powi(3) / (3.0 * E * i) + shear,
        ),
        ("FORCE,1,103,0,100.,1.,0.,0.", 4, p * l * l / (2.0 * E * i)),
        ("MOMENT,1,103,0,100.,1.,0.,0.", 3, p * l / (E * i)),
        ("MOMENT,1,103,0,100.,0.,0.,1.", 5, p * l / (G * 2.0 * i)),
    ];
    for (format, card) in formats() {
        for (load, dof, expected) in &cases {
            let s = solve_without_faults(&plates(&card, load));
            let got = s.displacement_at(103)[*dof];
            // Rounding error: the plates are 1000 times softer than the weld.
            assert!(
                (got - expected).abs() < 1e-7 * expected,
                "{format}, {load}: {got:e} for {expected:e}"
            );
            assert!(
                s.displacement_at(102).iter().all(|u| u.abs() < 1e-12),
                "{format}: GA is held"
            );
        }
    }
}

#[test]
fn a_weld_between_two_grids_or_from_a_patch_to_a_grid_is_the_same_cantilever() {
    let i = std::f64::consts::PI * D.powi(4) / 64.0;
    let expected = 100.0 * GAP / (E * i);
    let load = "MOMENT,1,103,0,100.,1.,0.,0.";
    for card in [
        "CWELD,500,7,,ALIGN,102,103\nSPC1,1,123456,102",
        "CWELD,500,7,,ELEMID,102,103,,,\n,10",
        "CWELD,500,7,,GRIDID,102,103,,,\n,12,17,18,13",
    ] {
        let mut b = plates(card, load);
        // Nothing else supports the upper plate.
        b.card("SPC1,1,123456,26,THRU,50");
        let got = solve_without_faults(&b).displacement_at(103)[3];
        assert!(
            (got - expected).abs() < 1e-9 * expected,
            "{card}: {got:e} for {expected:e}"
        );
    }
}

#[test]
fn a_spot_weld_and_a_short_one_count_with_their_effective_length() {
    let area = std::f64::consts::PI * D * D / 4.0;
    let load = "FORCE,1,103,0,100.,0.,0.,1.";
    let stretch = |property: &str| {
        let mut b = plates(&formats()[1].1.replace("500,7,", "500,8,"), load);
        b.card(property);
        solve_without_faults(&b).displacement_at(103)[2]
    };
    // SPOT gives half the sum of the thicknesses, 2. LDMIN 3 gives 18. LDMAX 1 gives 6.
    for (property, length) in [
        (format!("PWELD,8,1,{D:?},,,,,SPOT"), 2.0),
        (format!("PWELD,8,1,{D:?},,,,,,\n,3.,9."), 18.0),
        (format!("PWELD,8,1,{D:?},,,,,,\n,.1,1."), 6.0),
    ] {
        let (got, expected) = (stretch(&property), 100.0 * length / (E * area));
        assert!(
            (got - expected).abs() < 1e-7 * expected,
            "{property}: {got:e} for {expected:e}"
        );
    }
}

#[test]
fn a_fastener_gives_way_by_its_springs_at_the_middle_between_its_ends() {
    let property = "PFAST,9,6.,,,5000.,2000.,2000.,40000.,\n,80000.,80000.,.25";
    let p = 100.0;
    // Lateral displacement: the spring, and the rotation of the arm of half the length under the moment of the force.
    let across = p / 2000.0 + p * GAP * GAP / 4.0 / 80_000.0;
    let cases = [
        ("FORCE,1,103,0,100.,0.,0.,1.", 2, p / 5000.0),
        ("FORCE,1,103,0,100.,1.,0.,0.", 0, across),
        ("MOMENT,1,103,0,100.,0.,1.,0.", 4, p / 80_000.0),
        ("MOMENT,1,103,0,100.,0.,0.,1.", 5, p / 40_000.0),
    ];
    for card in [
        "CFAST,500,9,PROP,1,2,101,102,103",
        "CFAST,500,9,ELEM,10,26,101,102,103",
        "CFAST,500,9,PROP,1,2,,102,103,\n,21.,17.5,4.",
    ] {
        for (load, dof, expected) in &cases {
            let mut b = plates(card, load);
            b.card(property);
            let s = solve_without_faults(&b);
            let got = s.displacement_at(103)[*dof];
            assert!(
                (got - expected).abs() < 1e-7 * expected,
                "{card}, {load}: {got:e} for {expected:e}"
            );
        }
    }
    // The mass is half on each plate: .25 in total, with its centre in the middle of the length.
    let mut b = plates("CFAST,500,9,PROP,1,2,101", "");
    b.card(property);
    let (with, without) = (b.model().weight(), plates("", "").model().weight());
    assert!((with.mass - without.mass - 0.25).abs() < 1e-12);
    assert!((with.cg.z - GAP / 2.0).abs() < 1e-9, "{:?}", with.cg);
    assert!(
        (with.cg.x - AT[0]).abs() < 1e-9 && (with.cg.y - AT[1]).abs() < 1e-9,
        "{:?}",
        with.cg
    );
}

#[test]
fn mflag_selects_the_axes_of_mcid_for_a_fastener() {
    // KT1 = 5000 acts along basic x of system 5. The third axis of the system is the normal of the plates.
    let cards = "CORD2R,5,0,0.,0.,0.,0.,0.,1.,\n,0.,1.,0.\nPFAST,9,6.,5,1,5000.,2000.,1000.,90000.,\n,90000.,90000.";
    let bend = 100.0 * GAP * GAP / 4.0 / 90_000.0;
    // The x axis of system 5 is basic y.
    for (load, dof, expected) in [
        ("FORCE,1,103,0,100.,0.,1.,0.", 1, 100.0 / 5000.0 + bend),
        ("FORCE,1,103,0,100.,1.,0.,0.", 0, 100.0 / 2000.0 + bend),
        ("FORCE,1,103,0,100.,0.,0.,1.", 2, 100.0 / 1000.0),
    ] {
        let mut b = plates("CFAST,500,9,PROP,1,2,101,102,103", load);
        b.card(cards);
        let got = solve_without_faults(&b).displacement_at(103)[dof];
        assert!(
            (got - expected).abs() < 1e-7 * expected,
            "{load}: {got:e} for {expected:e}"
        );
    }
    // MFLAG 0 with an MCID rotated about the axis of the connector is refused if it changes the result.
    let mut b = plates("CFAST,500,9,PROP,1,2,101,102,103", "");
    b.card(&cards.replace("9,6.,5,1,", "9,6.,5,0,"));
    assert!(
        b.faults().iter().any(|f| f.contains("MFLAG 0")),
        "{:?}",
        b.faults()
    );
}

/// Fields such as u = 1 + 2x + 3y + .1xy are enforced on the lower plate, one for each component.
///
/// At GA the translation equals the field and the rotation equals half its curl. This holds for ties by slopes and for
/// ties by auxiliary points, because the square about GA is within one element.
#[test]
fn a_piercing_grid_moves_and_turns_with_the_field_of_its_patch() {
    let field = |x: f64, y: f64| {
        let c = [
            [1.0, 2.0, 3.0, 0.1],
            [-2.0, 1.0, 4.0, -0.2],
            [3.0, -5.0, 2.0, 0.3],
        ];
        c.map(|[a, b, c, d]| (a + b * x + c * y + d * x * y) * 1e-4)
    };
    let mut all = formats();
    all.push((
        "CFAST",
        "PFAST,9,2.,,,5000.,2000.,2000.,4000.,\n,8000.,8000.\nCFAST,500,9,ELEM,10,26,101,102,103"
            .into(),
    ));
    for (format, card) in all {
        let mut b = plates(&card.replace("500,7,", "500,6,"), "PWELD,6,1,2.");
        for id in 1..=25_u32 {
            let (i, j) = ((id - 1) / 5, (id - 1) % 5);
            let u = field(10.0 * f64::from(i), 10.0 * f64::from(j));
            for (k, v) in u.iter().enumerate() {
                b.card(&format!("SPC,1,{id},{},{v:.7E}", k + 1));
            }
        }
        b.card("FORCE,1,103,0,0.,0.,0.,1.");
        // SPC cards add their values, and the lower plate is fixed already.
        let s = solve_without_faults(&b);
        let (x, y) = (AT[0], AT[1]);
        let u = field(x, y);
        let slopes = |c: usize| {
            let h = 1e-3;
            let dx = (field(x + h, y)[c] - field(x - h, y)[c]) / (2.0 * h);
            let dy = (field(x, y + h)[c] - field(x, y - h)[c]) / (2.0 * h);
            (dx, dy)
        };
        let expected = [
            u[0],
            u[1],
            u[2],
            slopes(2).1,
            -slopes(2).0,
            (slopes(1).0 - slopes(0).1) / 2.0,
        ];
        let got = s.displacement_at(102);
        for (k, (a, e)) in got.iter().zip(expected).enumerate() {
            // Values are written with eight digits.
            assert!(
                (a - e).abs() < 2e-7 * e.abs().max(1e-4),
                "{format}, dof {}: {a:e} for {e:e}",
                k + 1
            );
        }
    }
}

#[test]
fn a_missing_part_of_a_connector_is_a_fault_with_its_remedy() {
    let cases = [
        ("CWELD,500,7,101,GIBBON,102,103", "format `GIBBON`"),
        ("CWELD,500,7,,PARTPAT,,,,,\n,1,2", "without GS"),
        (
            "CWELD,500,7,101,PARTPAT,,,,,\n,1,5",
            "shell property 5 is missing",
        ),
        (
            "CWELD,500,7,101,PARTPAT,,,,,\n,1,1",
            "both ends on one shell",
        ),
        (
            "CWELD,500,7,101,ELEMID,,,,,\n,1,26",
            "meets no shell of side A",
        ),
        (
            "CWELD,500,70,101,ELEMID,,,,,\n,10,26",
            "PWELD 70 is missing",
        ),
        (
            "CWELD,500,7,101,GRIDID,,,,,\n,12,17,18,13,1,2,3,4,\n,37,42,43,38",
            "mid-side grids",
        ),
        ("CFAST,500,7,BOLT,1,2,101", "PFAST 7 is missing"),
        (
            "PFAST,7,6.,,,1.,1.,1.\nCFAST,500,7,BOLT,1,2,101",
            "`BOLT` is not known",
        ),
    ];
    for (card, printed) in cases {
        let faults = plates(card, "").faults();
        assert!(
            faults.iter().any(|f| f.contains(printed)),
            "{card}: {faults:?}"
        );
    }
}

#[test]
fn what_a_connector_does_in_silence_is_a_finding() {
    let codes = |b: &Bulk| -> Vec<(String, String)> {
        let found = crate::ties::findings(b).into_iter();
        found
            .filter(|f| f.code.starts_with("connector-"))
            .map(|f| (f.code.to_string(), f.message))
            .collect()
    };
    let push = "FORCE,1,40,0,1.,0.,0.,-1.";
    // Element 10 and its neighbours cover x from 10 to 40 and y from 0 to 30. A square of 53 about (21, 17.5) fits
    // after two halvings.
    let wide = plates(
        "CWELD,500,8,101,ELPAT,,,,,\n,10,26",
        &format!("PWELD,8,1,60.\n{push}"),
    );
    let told = codes(&wide);
    assert!(
        told.len() == 1 && told[0].0 == "connector-halved" && told[0].1.contains("2 times"),
        "{told:?}"
    );
    let narrow = plates("CWELD,500,7,101,ELPAT,,,,,\n,10,26", push);
    assert!(codes(&narrow).is_empty());
    // The slope of the upper plate is 1 in 2, which is 27 degrees.
    let mut tilted = plates("CWELD,500,7,101,PARTPAT,,,,,\n,1,2", push);
    let lines = tilted
        .text
        .lines()
        .map(|line| match line.strip_suffix(",10.0") {
            Some(rest) if line.starts_with("GRID,") => {
                let x: f64 = rest.split(',').nth(3).unwrap().parse().unwrap();
                format!("{rest},{:?}", 10.0 + x / 2.0)
            }
            _ => line.to_owned(),
        });
    tilted.text = lines.collect::<Vec<_>>().join("\n") + "\n";
    let told = codes(&tilted);
    assert!(
        told.len() == 1 && told[0].0 == "connector-angle" && told[0].1.contains("27 degrees"),
        "{told:?}"
    );
}

#[test]
fn faults_name_the_card_of_a_connector_and_its_point_counts_as_used() {
    let b = plates(
        "CFAST,500,9,ELEM,10,26,101,102,103\nPFAST,9,6.,,,1.,1.,1.\nRBE2,90,1,123456,102",
        "",
    );
    let faults = b.faults();
    assert!(
        faults
            .iter()
            .any(|f| f.contains("CFAST 500: dof 1 of grid 102")),
        "{faults:?}"
    );
    let (_, all) = plates("CWELD,500,7,101,ELPAT,102,103,,,\n,10,26", "").read_model();
    assert!(all.is_empty(), "{all:?}");
    // The message must give the field of the side that is wrong.
    for (card, field) in [
        ("CWELD,500,7,101,ELPAT,,,,,\n,10,99", "SHIDB"),
        ("CWELD,500,7,101,ELPAT,,,,,\n,99,10", "SHIDA"),
        ("CWELD,500,7,101,PARTPAT,,,,,\n,1,9", "PIDB"),
        ("PFAST,7,6.,,,1.,1.,1.\nCFAST,500,7,PROP,1,9,101", "IDB"),
        ("PFAST,7,6.,,,1.,1.,1.\nCFAST,500,7,ELEM,99,10,101", "IDA"),
    ] {
        let (_, all) = plates(card, "").read_model();
        assert!(all.iter().any(|f| f.field == field), "{card}: {all:?}");
    }
}

#[test]
fn the_formats_agree_where_a_lap_joint_of_two_plates_is_pulled() {
    // A patch of one element and a circle of the weld's size are different idealisations. The stretch of the joint
    // agrees only roughly.
    let stretch: Vec<f64> = formats()
        .into_iter()
        .map(|(_, card)| {
            let b = plates(
                &card.replace(",102,103", ",,"),
                "FORCE,1,48,0,100.,1.,0.,0.\nFORCE,1,46,0,100.,1.,0.,0.",
            );
            let s = solve_without_faults(&b);
            s.displacement_at(48)[0]
        })
        .collect();
    for s in &stretch {
        assert!(
            (s / stretch[0] - 1.0).abs() < 0.15 && *s > 0.0,
            "{stretch:?}"
        );
    }
}

/// The equivalent deck written out by hand.
///
/// RBE3 elements with the shape functions as weights tie auxiliary grids, and further RBE3 elements tie the ends to
/// those grids. A round bar is between the ends.
#[test]
fn a_weld_on_a_property_is_the_deck_that_spells_its_ties_out() {
    let load = "FORCE,1,50,0,100.,.3,-.5,1.\nMOMENT,1,46,0,70.,1.,.2,.4";
    let weld = solve_without_faults(&plates("CWELD,500,7,101,PARTPAT,,,,,\n,1,2", load));
    let mut b = plates("", load);
    let half = std::f64::consts::PI.sqrt() / 4.0 * D;
    for (side, z) in [(0_u32, 0.0), (1, GAP)] {
        let mut auxiliary = Vec::new();
        for (k, (a, c)) in (1_u32..).zip([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) {
            let (x, y) = (AT[0] + a * half, AT[1] + c * half);
            let id = 110 + 10 * side + k;
            b.card(&format!(
                "GRID*   {id:16}{:16}{x:16.9}{y:16.9}\n*       {z:16.9}",
                ""
            ));
            // The element below the auxiliary grid and its bilinear shape functions.
            let (i, j) = ((x / 10.0).floor(), (y / 10.0).floor());
            let (r, s) = (x / 10.0 - i, y / 10.0 - j);
            let g = 25 * side + (5.0 * i + j) as u32 + 1;
            let weights = [
                (g, (1.0 - r) * (1.0 - s)),
                (g + 5, r * (1.0 - s)),
                (g + 6, r * s),
                (g + 1, (1.0 - r) * s),
            ];
            let fields: Vec<String> = weights
                .iter()
                .map(|(g, w)| format!("{w:.12},123,{g}"))
                .collect();
            let all: Vec<&str> = fields.iter().flat_map(|f| f.split(',')).collect();
            // Four fields precede the first weight. A line has eight fields.
            let (first, rest) = all.split_at(4);
            let lines: Vec<String> = rest
                .chunks(8)
                .map(|l| format!(",{}", l.join(",")))
                .collect();
            b.card(&format!(
                "RBE3,{},,{id},123,{}\n{}",
                900 + id,
                first.join(","),
                lines.join("\n")
            ));
            auxiliary.push(id);
        }
        b.card(&format!(
            "RBE3,{},,{},123456,1.,123,{},{},\n,{},{}",
            950 + side,
            102 + side,
            auxiliary[0],
            auxiliary[1],
            auxiliary[2],
            auxiliary[3]
        ));
    }
    b.card(&format!("PBARL,8,1,,ROD,,,,,\n,{:?}", D / 2.0));
    b.card("CBAR,501,8,102,103,1.,0.,0.");
    let spelt = solve_without_faults(&b);
    for id in 26..=50 {
        let (a, e) = (weld.displacement_at(id), spelt.displacement_at(id));
        let size = spelt.displacement_at(50)[2].abs();
        for k in 0..3 {
            // Weights are written with twelve digits, positions with nine.
            assert!((a[k] - e[k]).abs() < 1e-6 * size, "grid {id}: {a:?} {e:?}");
        }
    }
}

impl Bulk {
    /// Returns the messages of the faults that prevent a solution.
    pub fn faults(&self) -> Vec<String> {
        self.read_model()
            .1
            .iter()
            .filter(|f| f.weight() == FaultWeight::Error)
            .map(|f| format!("{f}: {}", f.remedy()))
            .collect()
    }
}

#[test]
fn decks_with_connectors_solve_from_cards_and_are_reported_as_formulation() {
    let b = plates(
        "CFAST,500,9,PROP,1,2,101\nPFAST,9,6.,,,5000.,2000.,2000.,40000.,\n,80000.,80000.",
        "FORCE,1,50,0,10.,0.,0.,1.",
    );
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: None,
        relief: Relief::None,
    };
    let (solution, report) = solve_cases(&b.model(), &[case], &SolveOptions::default()).unwrap();
    let told = solution.findings.iter().filter(|f| f.code == "formulation");
    assert!(
        told.clone().any(|f| f.message.contains("1 connectors")),
        "{:?}",
        solution.findings
    );
    // The support takes exactly the applied load, so the tie adds neither force nor moment.
    let r = &report.reactions[0];
    for i in 0..6 {
        assert!(
            (r.total[i] + r.applied[i]).abs() < 1e-6,
            "{:?} {:?}",
            r.total,
            r.applied
        );
    }
}
