use super::*;
use nastran::bdf::{MemoryLoader, read_deck};
use nastran::cards::Dofs;
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Returns the model of a bulk data text in free format, and its faults.
fn model(bulk: &str) -> (Model, Vec<ModelFault>) {
    let text = format!("BEGIN BULK\n{bulk}\nENDDATA\n");
    let deck = read_deck("test.bdf", text.into_bytes(), &mut MemoryLoader::default());
    assert!(deck.faults.is_empty(), "{:?}", deck.faults);
    Model::from_deck(&deck)
}

/// Returns the messages of the faults that prevent a solution.
fn errors(bulk: &str) -> Vec<(u32, String)> {
    let (_, faults) = model(bulk);
    faults
        .iter()
        .filter(|f| f.weight() == FaultWeight::Error)
        .map(|f| (f.at.line, f.to_string()))
        .collect()
}

fn is_near(a: Vec3, b: [f64; 3]) -> bool {
    (a - Vec3::from(b)).amax() < 1e-12
}

const QUAD: &str = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nMAT1,1,2.+11,,.3,7850.\nPSHELL,1,1,.01,1,,1\n";

#[test]
fn chained_coordinate_systems_of_all_kinds_end_in_basic() {
    // Cylindrical system 2 refers to rectangular system 1 (origin 10,0,0, x along basic y). Grids in system 2 define spherical system 3.
    let (m, faults) = model(
        "CORD2C,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,1,,10.,0.,0.,10.,0.,1.\n,10.,1.,0.\n\
         GRID,1,2,2.,90.,5.\nGRID,2,2,2.,90.,6.\nGRID,3,2,3.,90.,5.\nCORD1S,3,1,2,3\nGRID,4,3,2.,90.,0.\nGRID,5,3,2.,0.,0.,2",
    );
    assert!(
        faults.iter().all(|f| f.weight() == FaultWeight::Note),
        "{faults:?}"
    );
    let at = |id: u32| m.grids[m.grid_ix(id).unwrap().us()];
    // Theta 90 degrees of system 2 is along the y axis of system 1, which is minus basic x.
    assert!(is_near(at(1).x, [8.0, 0.0, 5.0]), "{}", at(1).x);
    // System 3 has its origin at grid 1, z up, and x towards grid 3 (minus basic x). Theta 90, phi 0 is along its x axis.
    assert!(is_near(at(4).x, [6.0, 0.0, 5.0]), "{}", at(4).x);
    assert!(is_near(at(5).x, [8.0, 0.0, 7.0]), "{}", at(5).x);
    // Grid 5 moves in system 2: radial at (8, 0) is minus basic x.
    let axes = m.cd_axes(m.grid_ix(5).unwrap());
    assert!(is_near(axes.row(0).transpose(), [-1.0, 0.0, 0.0]), "{axes}");
}

#[test]
fn systems_in_a_circle_and_on_a_line_are_faults() {
    let found =
        errors("CORD2R,1,2,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.");
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found
            .iter()
            .all(|f| f.1.contains("defined through others by its own id")),
        "{found:?}"
    );
    let found = errors("CORD2R,1,,0.,0.,0.,0.,0.,1.\n,0.,0.,3.");
    assert!(found[0].1.contains("are on a line"), "{found:?}");
    let found = errors("GRID,1,7,0.,0.,0.");
    assert!(
        found[0].1.contains("coordinate system 7 is missing"),
        "{found:?}"
    );
}

#[test]
fn a_blank_field_takes_grdset_and_a_stated_zero_does_not() {
    let (m, _) = model(
        "CORD2R,1,,0.,0.,5.,0.,0.,6.\n,1.,0.,5.\nGRDSET,,1,,,,1,456\nGRID,1,,0.,0.,0.\nGRID,2,0,0.,0.,0.,0",
    );
    assert!(is_near(m.grids[0].x, [0.0, 0.0, 5.0]));
    assert_eq!(
        m.grids[0].ps,
        nastran::cards::Dofs::from_digits(456).unwrap()
    );
    assert!(is_near(m.grids[1].x, [0.0; 3]));
    assert_eq!(m.frames[m.grids[0].cd.us()].id, 1);
    assert_eq!(m.grids[1].cd, FrameIx(0));
}

#[test]
fn mcid_is_projected_on_the_element_and_theta_is_in_degrees() {
    let shell = |field: &str| {
        model(&format!("{QUAD}CQUAD4,1,1,1,2,3,4,{field}")).0.shells[0].material_angle_rad
    };
    assert!((shell("30.") - 30_f64.to_radians()).abs() < 1e-15);
    assert_eq!(
        shell("0"),
        0.0,
        "an integer 0 is the basic system, whose x is side 1-2 here"
    );
    let cord = "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,1.\n";
    let angle = model(&format!("{QUAD}{cord}CQUAD4,1,1,1,2,3,4,5")).0.shells[0].material_angle_rad;
    assert!((angle - FRAC_PI_2).abs() < 1e-12, "{angle}");
}

#[test]
fn fibre_distances_of_a_tapered_shell_are_local_unless_stated() {
    let of = |corners: &str, z: &str| {
        let deck = format!("{QUAD}CQUAD4,1,1,1,2,3,4\n,,,{corners}");
        let deck = deck.replace("PSHELL,1,1,.01,1,,1", &format!("PSHELL,1,1,.01,1,,1{z}"));
        let m = model(&deck).0;
        m.fibres(&m.shells[0])
    };
    // The thickness of a blank corner is T of the property, .01.
    let tapered = of(".02,.04,.06,", "");
    let halves = [0.01, 0.02, 0.03, 0.005];
    assert_eq!(tapered.corners, halves.map(|h| [-h, h]));
    let [low, high] = tapered.centre;
    assert!((low + 0.01625).abs() < 1e-15 && (high - 0.01625).abs() < 1e-15);
    let stated = of(".02,.04,.06,", ",,,\n,-.1,.2");
    assert_eq!(stated.corners, [[-0.1, 0.2]; 4]);
    assert_eq!(stated.centre, [-0.1, 0.2]);
}

#[test]
fn default_fibre_distances_are_half_the_thickness() {
    let (m, _) = model(&format!("{QUAD}CQUAD4,1,1,1,2,3,4"));
    assert_eq!(m.fibres(&m.shells[0]).centre, [-0.005, 0.005]);
    let (m, _) = model("MAT1,1,2.+11,,.3\nPCOMP,1,,,,,,,SYM\n,1,.1,45.,,1,.2,0.");
    let p = &m.shell_properties[0];
    assert!(
        p.fibres(9.0)
            .iter()
            .zip([-0.3, 0.3])
            .all(|(z, right)| (z - right).abs() < 1e-15),
        "{:?}",
        p.z
    );
    let ShellKind::Laminate { plies, .. } = &p.kind else {
        panic!()
    };
    assert_eq!(
        plies.iter().map(|p| p.t).collect::<Vec<_>>(),
        [0.1, 0.2, 0.2, 0.1]
    );
}

const BAR: &str =
    "MAT1,1,2.+11,,.3,1.\nPBAR,1,1,2.,1.,1.,1.\nCORD2C,9,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n";

#[test]
fn offsets_and_orientation_are_counted_in_the_displacement_frames() {
    // Both grids are at 45 degrees in a cylindrical system, one above the other. The offset is radial.
    let (m, faults) = model(&format!(
        "{BAR}GRID,1,9,1.,45.,0.,9\nGRID,2,9,1.,45.,2.,9\nCBAR,1,1,1,2,1.,0.,0.,GGG\n,,,-1.,0.,0.,-1.,0.,0."
    ));
    assert!(faults.is_empty(), "{faults:?}");
    let b = &m.beams[0];
    let s = 1.0 / SQRT_2;
    assert!(is_near(b.offsets[0], [-s, -s, 0.0]), "{}", b.offsets[0]);
    assert!(is_near(b.axes.row(0).transpose(), [0.0, 0.0, 1.0]));
    assert!(
        is_near(b.axes.row(1).transpose(), [s, s, 0.0]),
        "y along the radial orientation vector"
    );
    let w = m.weight();
    assert!(
        (w.mass - 4.0).abs() < 1e-12 && is_near(w.cg, [0.0, 0.0, 1.0]),
        "{w:?}"
    );
}

#[test]
fn an_offset_with_o_is_counted_along_the_element() {
    let (m, _) = model(&format!(
        "{BAR}GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,2.\nCBAR,1,1,1,2,0.,1.,0.,GOO\n,,,.5,.1,0.,-.5,.1,0."
    ));
    assert!(
        is_near(m.beams[0].offsets[0], [0.0, 0.1, 0.5]),
        "{}",
        m.beams[0].offsets[0]
    );
    let found = errors(&format!(
        "{BAR}GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,0.\nCBAR,1,1,1,2,0.,1.,0."
    ));
    assert!(found[0].1.contains("length"), "{found:?}");
    let found = errors(&format!(
        "{BAR}GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,1.\nCBAR,1,1,1,2,0.,0.,1."
    ));
    assert!(found[0].1.contains("orientation"), "{found:?}");
}

#[test]
fn a_bush_takes_its_frame_from_cid_then_orientation_then_the_line() {
    let bush = |card: &str, k: &str| {
        model(&format!(
            "GRID,1,,0.,0.,0.\nGRID,2,,0.,3.,0.\nPBUSH,1,K,{k}\nCORD2R,4,,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\n{card}"
        ))
    };
    let (m, _) = bush("CBUSH,1,1,1,2,1.,0.,0.,4", "1.,1.,1.");
    assert!(
        is_near(m.bushes[0].axes.row(0).transpose(), [0.0, 1.0, 0.0]),
        "x of system 4"
    );
    let (m, _) = bush("CBUSH,1,1,1,2,0.,0.,1.", "1.,1.,1.");
    assert!(is_near(
        m.bushes[0].axes.row(1).transpose(),
        [0.0, 0.0, 1.0]
    ));
    assert!(is_near(m.bushes[0].location, [0.0, 1.5, 0.0]));
    let (m, faults) = bush("CBUSH,1,1,1,2", "5.,,,7.");
    assert!(
        faults.is_empty() && is_near(m.bushes[0].axes.row(0).transpose(), [0.0, 1.0, 0.0]),
        "{faults:?}"
    );
    let (_, faults) = bush("CBUSH,1,1,1,2", "5.,3.");
    assert!(
        faults.iter().any(|f| f.kind == FaultKind::Orientation),
        "{faults:?}"
    );
    // A grounded bush has no line. Without CID it has the basic frame, and the model records the assumption.
    let (m, faults) = bush("CBUSH,1,1,1", "5.,3.");
    assert!(
        m.bushes[0].frame_assumed && is_near(m.bushes[0].axes.row(0).transpose(), [1.0, 0.0, 0.0]),
        "{faults:?}"
    );
}

#[test]
fn a_conm2_with_cid_minus_1_states_a_location_and_its_products_of_inertia_change_sign() {
    let (m, _) = model("GRID,1,,1.,2.,3.\nCONM2,1,1,-1,2.,1.,2.,4.\n,10.,1.,20.,2.,3.,30.");
    let c = &m.masses[0];
    assert!(is_near(c.offset, [0.0, 0.0, 1.0]));
    assert_eq!(c.matrix[(3, 4)], -1.0);
    assert_eq!(c.matrix[(3, 5)], -2.0);
    // Parallel axis theorem: a mass of 2 at a distance of 1 above the grid.
    assert_eq!(
        (c.matrix[(3, 3)], c.matrix[(4, 4)], c.matrix[(5, 5)]),
        (12.0, 22.0, 30.0)
    );
    let w = m.weight();
    assert!(is_near(w.cg, [1.0, 2.0, 4.0]) && w.mass == 2.0);
}

#[test]
fn wtmass_scales_mass_once() {
    let (m, _) = model(&format!("{QUAD}CQUAD4,1,1,1,2,3,4\nPARAM,WTMASS,.5"));
    assert!((m.weight().mass - 0.5 * 78.5).abs() < 1e-12);
    assert!(is_near(m.weight().cg, [0.5, 0.5, 0.0]));
}

#[test]
fn volumes_of_solids_are_exact() {
    let corners = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,0.,0.,3.\nGRID,6,,2.,0.,3.\nGRID,7,,2.,1.,3.\nGRID,8,,0.,1.,3.\nMAT1,1,1.,,.3,1.\nPSOLID,1,1\n";
    for (card, volume) in [
        ("CHEXA,1,1,1,2,3,4,5,6\n,7,8", 6.0),
        ("CPENTA,1,1,1,2,3,5,6,7", 3.0),
        ("CTETRA,1,1,1,2,3,5", 1.0),
    ] {
        let (m, _) = model(&format!("{corners}{card}"));
        assert!(
            (m.weight().mass - volume).abs() < 1e-12,
            "{card}: {}",
            m.weight().mass
        );
    }
}

#[test]
fn pressure_on_a_solid_points_into_it() {
    let corners = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,0.,0.,3.\nGRID,6,,2.,0.,3.\nGRID,7,,2.,1.,3.\nGRID,8,,0.,1.,3.\nMAT1,1,1.,,.3,1.\nPSOLID,1,1\nCHEXA,1,1,1,2,3,4,5,6\n,7,8\nCTETRA,2,1,1,2,3,5\n";
    for (face, element, inward) in [
        ("5,7", 1, [0.0, 0.0, -1.0]),
        ("1,3", 1, [0.0, 0.0, 1.0]),
        ("2,7", 1, [-1.0, 0.0, 0.0]),
        ("1,5", 2, [0.0, 0.0, 1.0]),
    ] {
        let (m, faults) = model(&format!("{corners}PLOAD4,1,{element},2.,,,,{face}"));
        assert!(
            faults.iter().all(|f| f.weight() == FaultWeight::Note),
            "{faults:?}"
        );
        let Load::FacePressure {
            grids, pressure, ..
        } = &m.load_sets[0].loads[0].1
        else {
            panic!()
        };
        assert_eq!(*pressure, [2.0; 4]);
        let x: Vec<Vec3> = grids.iter().flatten().map(|g| m.grids[g.us()].x).collect();
        let n = (x[1] - x[0]).cross(&(x[2] - x[0]));
        assert!(is_near(n / n.norm(), inward), "{face}: {n}");
    }
}

#[test]
fn load_sums_scale_their_sets() {
    let (m, faults) = model(
        "GRID,1,,0.,0.,0.\nCONM2,1,1,,1.\nFORCE,1,1,,2.,1.,0.,0.\nMOMENT,2,1,,1.,0.,3.,0.\nLOAD,5,2.,1.5,1,-1.,2",
    );
    assert!(faults.is_empty(), "{faults:?}");
    let set = m.load_sets.iter().find(|s| s.sid == 5).unwrap();
    assert_eq!(
        set.loads.iter().map(|l| l.0).collect::<Vec<_>>(),
        [3.0, -2.0]
    );
    assert_eq!(
        set.loads[0].1,
        Load::Force(GridIx(0), Vec3::new(2.0, 0.0, 0.0))
    );
    let (m, faults) = model(
        "GRID,1,,0.,0.,0.\nCONM2,1,1,,1.\nFORCE,1,1,,2.,1.,0.,0.\nLOAD,8,10.,2.,7\nLOAD,7,5.,7.,1",
    );
    assert!(faults.is_empty(), "{faults:?}");
    assert_eq!(
        m.load_sets.iter().find(|s| s.sid == 8).unwrap().loads[0].0,
        700.0,
        "a sum of a sum"
    );
    assert!(
        !errors("LOAD,7,1.,1.,8\nLOAD,8,1.,1.,7").is_empty(),
        "a circle"
    );
    let found = errors("LOAD,5,1.,1.,77");
    assert!(found[0].1.contains("load set 77 is missing"), "{found:?}");
}

#[test]
fn each_kind_of_bad_input_has_its_own_message_with_the_line() {
    let quad = format!("{QUAD}CQUAD4,1,1,1,2,3,4\n");
    let cases: [(&str, u32, &str); 12] = [
        ("CQUAD4,1,1,1,2,3,4", 9, "element id occurs twice"),
        ("CQUAD4,2,7,1,2,3,4", 9, "shell property 7 is missing"),
        ("CQUAD4,2,1,1,2,3,99", 9, "grid 99 is missing"),
        (
            "PSHELL,2,5,.01\nCQUAD4,2,2,1,2,3,4",
            9,
            "material 5 is missing",
        ),
        (
            "PSHELL,2,1,-.01\nCQUAD4,2,2,1,2,3,4",
            9,
            "thickness is -0.01",
        ),
        ("PSHELL,2,1\nCQUAD4,2,2,1,2,3,4", 10, "thickness is 0"),
        ("GRID,1,,5.,0.,0.", 9, "grid id occurs twice"),
        ("CQUAD4,2,1,1,2,2,1", 9, "no area"),
        (
            "RBE2,5,1,123456,2\nRBE2,6,3,1,2",
            10,
            "dof 1 of grid 2 is dependent already on line 9",
        ),
        (
            "GRID,7,,.5,0.,0.\nRBE3,5,,7,123456,1.,123,1,2",
            10,
            "are on a line",
        ),
        ("MAT1,1,1.,,.3", 9, "material id occurs twice"),
        ("SPC1,1,123,99", 9, "grid 99 is missing"),
    ];
    for (more, line, message) in cases {
        let found = errors(&format!("{quad}{more}"));
        assert!(
            found.iter().any(|f| f.0 == line && f.1.contains(message)),
            "{more}: {found:?}"
        );
    }
    assert!(
        errors(&format!("{quad}GRID,1,,0.,0.,0.")).is_empty(),
        "the same grid twice is no fault"
    );
}

#[test]
fn an_rbe3_with_arms_off_a_line_or_without_the_rotation_is_accepted() {
    let grids = format!("{QUAD}CQUAD4,1,1,1,2,3,4\nGRID,7,,.5,.5,1.\nGRID,8,,.5,.5,0.\n");
    assert!(errors(&format!("{grids}RBE3,5,,7,123456,1.,123,1,2\n,3,4")).is_empty());
    assert!(errors(&format!("{grids}RBE3,5,,8,123,1.,123,1,3")).is_empty());
}

#[test]
fn a_grid_without_element_is_a_note() {
    let (_, faults) = model(&format!("{QUAD}CQUAD4,1,1,1,2,3,4\nGRID,9,,5.,5.,5."));
    assert_eq!(faults.len(), 1);
    assert_eq!(
        (faults[0].weight(), &faults[0].kind),
        (FaultWeight::Note, &FaultKind::Unattached)
    );
}

#[test]
fn scalar_points_are_carried_by_springs_constraints_and_equations() {
    // Grid 1 - spring 2 N/m - point 10 - spring 3 N/m - point 11. Only the spring defines point 11, and SPC1 fixes it.
    let (m, faults) = model(
        "GRID,1,,0.,0.,0.\nSPOINT,10\nCELAS2,1,2.,1,3,10\nCELAS2,2,3.,10,,11\nSPC1,5,0,11\nMPC,6,10,0,1.,1,3,-2.",
    );
    assert!(faults.is_empty(), "{faults:?}");
    let point = |id: u32| m.grid_ix(id).unwrap();
    assert!(m.grids[point(10).us()].is_scalar() && m.grids[point(11).us()].is_scalar());
    assert_eq!(
        m.springs[0].ends,
        [Some((point(1), 2)), Some((point(10), 0))]
    );
    assert_eq!(
        m.springs[1].ends,
        [Some((point(10), 0)), Some((point(11), 0))]
    );
    let dof_1 = Dofs::from_digits(1).unwrap();
    assert_eq!(m.spcs[0].terms, [(point(11), dof_1, 0.0)]);
    assert_eq!(
        m.mpcs[0].equations[0].0,
        [(point(10), 0, 1.0), (point(1), 2, -2.0)]
    );
    assert_eq!(m.weight().mass, 0.0);
}

#[test]
fn a_scalar_point_with_the_id_of_a_grid_and_an_endless_range_are_faults() {
    let found = errors("GRID,7,,0.,0.,0.\nSPOINT,7\nSPOINT,1000,THRU,99999999\nCELAS2,1,1.,7,1");
    assert_eq!(
        found.iter().map(|f| f.0).collect::<Vec<_>>(),
        [3, 4],
        "{found:?}"
    );
}

#[test]
fn cards_that_the_model_does_not_carry_are_reported_with_the_load_sets_that_lose_them() {
    let (m, _) = model(&format!(
        "{QUAD}CQUAD4,9,1,1,2,3,4\nCSEAM,3,5,1,1,1\nCVISC,4,5,1,2\nFORCE,6,2,,1.,0.,0.,1.\nFORCEAX,6,2,1.,1,3\nLOAD,7,1.,2.,6"
    ));
    let cards: Vec<(&str, Option<u32>)> = m
        .unsupported_cards
        .iter()
        .map(|c| (c.card.as_str(), c.id))
        .collect();
    assert_eq!(cards, [("CSEAM", Some(3))]);
    for set in &m.load_sets {
        let refused = set
            .loads
            .iter()
            .filter(|l| matches!(&l.1, Load::Unsupported(c, _) if c == "FORCEAX"));
        assert_eq!(refused.count(), 1, "set {}", set.sid);
    }
    assert_eq!(m.load_sets.len(), 2);
}

#[test]
fn a_refined_mesh_weighs_the_same_and_divides_every_shell_at_the_middles_of_its_sides() {
    let (m, _) = model(&format!(
        "{QUAD}GRID,5,,2.,0.,0.\nCQUAD4,1,1,1,2,3,4\nCTRIA3,2,1,2,5,3\nCONM2,9,2,,5."
    ));
    let fine = m.refine_shells().unwrap();
    // A square and a triangle on one side of it have five corners, seven sides of which two coincide, and one centre of the square.
    assert_eq!(fine.model.grids.len(), 5 + 7 + 1 - 1);
    assert_eq!(fine.model.shells.len(), 8);
    let (before, after) = (m.weight(), fine.model.weight());
    assert!((before.mass - after.mass).abs() < 1e-12 * before.mass);
    assert!((before.cg - after.cg).amax() < 1e-12);
    for (parent, children) in m.shells.iter().zip(&fine.children) {
        for (k, child) in children.iter().enumerate().take(parent.shape.n_corners()) {
            assert_eq!(fine.model.shells[child.us()].grids[k], parent.grids[k]);
        }
    }
    assert!(fine.model.grids.windows(2).all(|g| g[0].id < g[1].id));
}

#[test]
fn the_middle_of_a_side_with_a_bar_along_it_moves_as_the_mean_of_its_ends() {
    let bar = "CROD,7,3,1,2\nPROD,3,1,1.-4";
    let (m, _) = model(&format!("{QUAD}CQUAD4,1,1,1,2,3,4\n{bar}"));
    let fine = m.refine_shells().unwrap().model;
    let set = fine.mpcs.iter().find(|s| Some(s.sid) == fine.mpc).unwrap();
    assert_eq!(set.equations.len(), 6);
    for (dof, (terms, _)) in set.equations.iter().enumerate() {
        let ends = [(GridIx(0), dof as u8, -0.5), (GridIx(1), dof as u8, -0.5)];
        assert_eq!(terms[0].2, 1.0);
        assert_eq!(terms[1..], ends);
        let middle = fine.grids[terms[0].0.us()].x;
        assert_eq!(middle, 0.5 * (m.grids[0].x + m.grids[1].x));
    }
    // A diagonal bar connects two corners that share no side.
    let (m, _) = model(&format!(
        "{QUAD}CQUAD4,1,1,1,2,3,4\n{}",
        bar.replace("1,2", "1,3")
    ));
    assert!(m.refine_shells().unwrap().model.mpcs.is_empty());
}

#[test]
fn twenty_thousand_loads_that_name_each_other_are_written_out_at_once() {
    let mut text = format!("{QUAD}CQUAD4,9,1,1,2,3,4\nFORCE,1,2,,1.,0.,0.,1.\n");
    for sid in 2..=20_001 {
        text.push_str(&format!("LOAD,{sid},1.,1.,{}\n", sid - 1));
    }
    // Each sum doubles the previous one. Copies would contain 2^40 loads.
    for sid in 30_001..=30_040 {
        let before = if sid == 30_001 { 20_001 } else { sid - 1 };
        text.push_str(&format!("LOAD,{sid},1.,1.,{before},1.,{before}\n"));
    }
    let (m, faults) = model(&text);
    assert!(
        faults.iter().all(|f| f.weight() == FaultWeight::Note),
        "{faults:?}"
    );
    let last = m.load_sets.iter().find(|s| s.sid == 30_040).unwrap();
    assert_eq!(last.loads.len(), 1);
    assert_eq!(last.loads[0].0, 2_f64.powi(40));
}

#[test]
fn sets_that_sum_each_other_in_a_circle_are_called_that() {
    let (_, faults) = model(&format!(
        "{QUAD}CQUAD4,9,1,1,2,3,4\nLOAD,3,1.,1.,4\nLOAD,4,1.,1.,5\nLOAD,5,1.,1.,3\nSPCADD,7,8\nSPCADD,8,7\n"
    ));
    let messages: Vec<String> = faults
        .iter()
        .filter(|f| matches!(f.kind, FaultKind::SumCycle { .. }))
        .map(ToString::to_string)
        .collect();
    assert_eq!(
        messages,
        [
            "LOAD 3: the sets name each other in a circle: 3 -> 4 -> 5 -> 3",
            "SPCADD 7: the sets name each other in a circle: 7 -> 8 -> 7",
        ]
    );
    assert!(
        !faults
            .iter()
            .any(|f| matches!(f.kind, FaultKind::Missing { .. }))
    );
}

#[test]
fn a_sum_of_sums_of_constraints_holds_every_set_once() {
    let (m, _) = model(&format!(
        "{QUAD}CQUAD4,9,1,1,2,3,4\nSPC1,1,123,1\nSPC1,2,3,2\nSPCADD,5,1,2\nSPCADD,6,5,1\n"
    ));
    let six = m.spcs.iter().find(|s| s.sid == 6).unwrap();
    assert_eq!(six.terms.len(), 2);
}

#[test]
fn a_card_that_is_not_carried_is_named_by_its_own_line_and_not_called_missing() {
    // Columns: unsupported card, card that refers to it, whether this reference prevents every use of the model.
    let table = [
        (
            "PBCOMP,9,1,.01,1.-5,1.-5",
            "CBEAM,9,9,1,2,0.,0.,1.",
            "PBCOMP 9",
            false,
        ),
        (
            "PBMSECT,9,1,CP",
            "CBAR,9,9,1,2,0.,0.,1.",
            "PBMSECT 9",
            false,
        ),
        ("PCOMPS,9,,0.", "CTETRA,9,9,1,2,3,5", "PCOMPS 9", false),
        ("PLSOLID,9,1", "CTETRA,9,9,1,2,3,5", "PLSOLID 9", false),
        ("PLPLANE,9,1", "CQUAD4,9,9,1,2,3,4", "PLPLANE 9", true),
        (
            "MAT11,8,1.,1.,1.",
            "PSOLID,9,8\nCTETRA,9,9,1,2,3,5",
            "MAT11 8",
            false,
        ),
        (
            "MATHP,8,1.",
            "PSOLID,9,8\nCTETRA,9,9,1,2,3,5",
            "MATHP 8",
            false,
        ),
        ("MAT4,8,1.", "PROD,9,8,1.\nCROD,9,9,1,2", "MAT4 8", false),
        (
            "CBEND,9,1,1,2,0.,0.,1.",
            "PLOAD1,4,9,FY,FR,0.,1.,1.,1.",
            "CBEND 9",
            false,
        ),
        ("GRIDB,77,,,10.", "SPC1,1,1,77", "GRIDB 77", true),
        ("EPOINT,70,THRU,80", "SPC1,1,1,77", "EPOINT 70", true),
        ("GRIDG,3,,1,-4,5", "SPC1,1,1,77", "GRIDG 3", true),
        ("CORD3G,9,E,1,2", "GRID,77,9,1.,1.,1.", "CORD3G 9", true),
    ];
    for (card, user, named, stops) in table {
        let text = format!("{QUAD}GRID,5,,0.,0.,1.\nCQUAD4,1,1,1,2,3,4\n{user}\n{card}\n");
        let (m, faults) = model(&text);
        let own: Vec<&ModelFault> = faults.iter().filter(|f| f.card == named).collect();
        assert_eq!(own.len(), 1, "{card}: {faults:?}");
        assert_eq!(own[0].at.line as usize, text.lines().count() + 1, "{card}");
        assert_eq!(own[0].weight() != FaultWeight::Note, stops, "{card}");
        assert!(
            faults
                .iter()
                .all(|f| !f.kind.to_string().contains("missing")),
            "{card}: {faults:?}"
        );
        assert!(
            m.unsupported_cards.iter().any(|c| c.at == own[0].at),
            "the solver refuses {card}"
        );
    }
    // A property that no card defines is still missing.
    let found = errors(&format!("{QUAD}CQUAD4,1,7,1,2,3,4\nPBCOMP,9,1,.01"));
    assert!(
        found[0].1.contains("shell property 7 is missing"),
        "{found:?}"
    );
}

#[test]
fn scalar_masses_and_dampers_make_their_scalar_points() {
    for (card, points) in [
        ("PMASS,9,1.\nCMASS3,9,9,,2702", vec![2702]),
        ("CMASS4,9,1.,2701,2702", vec![2701, 2702]),
        ("CDAMP3,9,9,2701,0", vec![2701]),
        ("CDAMP4,9,1.,,2702", vec![2702]),
        ("CMASS2,9,1.,1,3,2701", vec![2701]),
    ] {
        let last = points[points.len() - 1];
        let (m, faults) = model(&format!(
            "{QUAD}CQUAD4,1,1,1,2,3,4\n{card}\nSPC,1,{last},0,0."
        ));
        assert!(
            faults.iter().all(|f| f.weight() == FaultWeight::Note),
            "{card}: {faults:?}"
        );
        let scalar: Vec<u32> = m
            .grids
            .iter()
            .filter(|g| g.is_scalar())
            .map(|g| g.id)
            .collect();
        assert_eq!(scalar, points, "{card}");
    }
}

#[test]
fn a_property_has_its_own_name_or_that_of_its_component() {
    let (m, _) = model(&format!(
        "$HMNAME COMP 3\"left rail\" 1 \"\" 4\n$HMNAME COMP 8 \"bracket\"\n$HMNAME COMP 5 \"other\"\n$HMNAME PROP 5 \"bolt\"\n{QUAD}"
    ));
    let names: Vec<(u32, &str)> = m
        .property_names
        .iter()
        .map(|n| (n.0, n.1.as_str()))
        .collect();
    assert_eq!(names, [(1, "left rail"), (5, "bolt"), (8, "bracket")]);
}
