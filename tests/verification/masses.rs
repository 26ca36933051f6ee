//! Every kind of mass: the weight from `check` equals the mass in the solver. Scalar masses are compared with closed
//! forms.

use crate::small_decks::{assert_close, displacement_at, list_refused_cards, model, solve};
use strainbridge::fe::*;
use strainbridge::model::Vec3;

/// Plate of 2 x 1 x .01 and a bar of length 2 along its side. The density is 1000.
const PLATE: &str = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,1.,0.\nGRID,4,,0.,1.,0.\nMAT1,1,2.+11,,.3,1000.\n\
     CQUAD4,1,1,1,2,3,4\nPSHELL,1,1,.01,1,,1\nCBAR,2,2,1,2,0.,0.,1.\nPBAR,2,1,.01,1.-5,1.-5,1.-5\nSPC1,1,123456,1\n\
     FORCE,1,3,,1.,1.,0.,0.\n";

/// Kinds of mass: case control, cards, and the mass that the cards add to 20 kg of the plate and 20 kg of the bar.
const KINDS: [(&str, &str, f64); 22] = [
    ("", "", 0.0),
    ("", "CONM2,50,3,,5.,.1,.2,.3\n,1.,,2.,,,3.", 5.0),
    ("", "CONM1,50,3,,5.,,5.\n,5.", 5.0),
    (
        "",
        "CROD,5,5,2,4\nPROD,5,1,.01,,,3.",
        13.0 * 2.23606797749979,
    ),
    ("", "CONROD,5,2,3,1,.02,,,3.", 23.0),
    (
        "",
        "CTUBE,5,5,2,3\nPTUBE,5,1,.2,.0",
        1000.0 * 0.01 * std::f64::consts::PI,
    ),
    (
        "",
        "CBEAM,5,5,3,4,0.,0.,1.\nPBEAM,5,1,.01,1.-5,1.-5,,1.-5,2.\n,,,,,,,,\n,YESA,1.,.03,1.-5,1.-5,,1.-5,4.",
        46.0,
    ),
    ("", "CBAR,5,5,3,4,0.,0.,1.\nPBARL,5,1,,BAR\n,.1,.2,7.", 54.0),
    ("", "CSHEAR,5,5,1,2,3,4\nPSHEAR,5,1,.002,3.", 10.0),
    (
        "",
        "CQUAD4,5,5,1,2,3,4,0.,.2\nPSHELL,5,1,.001,1,,1,,4.",
        10.0,
    ),
    (
        "",
        "CQUAD4,5,5,1,2,3,4\nPCOMP,5,,3.\n,1,.001,0.,,1,.002,90.",
        12.0,
    ),
    (
        "",
        "GRID,11,,0.,0.,1.\nGRID,12,,2.,0.,1.\nGRID,13,,2.,1.,1.\nGRID,14,,0.,1.,1.\nCHEXA,5,5,1,2,3,4,11,12\n,13,14\nPSOLID,5,1",
        2000.0,
    ),
    (
        "",
        "CMASS2,50,3.,3,1\nCMASS2,51,3.,3,2\nCMASS2,52,3.,3,3",
        3.0,
    ),
    (
        "",
        "CMASS1,50,8,3,1\nCMASS1,51,8,3,2\nCMASS1,52,8,3,3\nPMASS,7,1.,8,3.",
        3.0,
    ),
    // A mass on a rotation, between two ends with the same motion, or at a scalar point adds no weight.
    (
        "",
        "CMASS2,50,3.,3,5\nCMASS2,51,7.,3,1,4,1\nSPOINT,90\nCMASS4,52,9.,90\nCMASS3,53,8,91\nPMASS,8,4.",
        0.0,
    ),
    (
        "",
        "PARAM,WTMASS,.1\nCONM2,50,3,,5.\nCMASS2,51,2.,4,1\nCMASS2,52,2.,4,2\nCMASS2,53,2.,4,3",
        4.7 - 40.0,
    ),
    (
        "",
        "GRID,8,,5.,5.,5.\nGRID,9,,6.,6.,6.\nRBE2,60,3,123456,8,9\nCONM2,50,8,,5.",
        5.0,
    ),
    (
        "",
        "GRID,8,,3.,1.,0.\nCBUSH,5,5,3,8,,,,0\nPBUSH,5,K,1.+6,1.+6,1.+6,1.+6,1.+6,1.+6\n,,M,4.\nCBUSH,6,5,3,,,,,0",
        6.0,
    ),
    ("NSM = 8", "NSM1,8,ELEMENT,3.,1", 6.0),
    (
        "NSM = 9",
        "NSM,8,ELEMENT,1,3.,2,2.\nNSML,7,ELEMENT,2,5.\nNSMADD,9,7,8",
        15.0,
    ),
    (
        "NSM = 8",
        "NSML1,8,ELEMENT,7.,1,5\nCQUAD4,5,1,1,2,3,4",
        27.0,
    ),
    (
        "NSM = 8",
        "NSM1,8,PROD,2.,5\nNSM1,8,CONROD,3.,6\nNSM1,8,PSHEAR,4.,7\nCROD,5,5,2,3\nPROD,5,3,.01\nMAT1,3,1.+9,,.3\n\
      CONROD,6,2,3,3,.01\nCSHEAR,7,7,1,2,3,4\nPSHEAR,7,3,.01",
        13.0,
    ),
];

#[test]
fn the_weight_of_every_kind_of_mass_is_that_of_the_mass_matrix() {
    for (selected, cards, more) in KINDS {
        let case_control = format!("SPC = 1\nLOAD = 1\n{selected}");
        let mut bulk = format!("{PLATE}{cards}\n");
        bulk += "PARAM,AUTOSPC,YES\n";
        let (model, solved) = solve(&case_control, &bulk);
        let (ours, theirs) = (model.weight(), solved.report.mass.unwrap());
        assert_close(cards, ours.mass, 40.0 + more, 1e-12);
        assert_close(cards, theirs.mass, ours.mass, 1e-12);
        let apart = (ours.cg - theirs.cg).norm();
        assert!(apart < 1e-12, "{cards}: {} {}", ours.cg, theirs.cg);
    }
}

/// Materials and properties of [`SHAPES`]. The density is 7.
const DENSE: &str = "MAT1,1,2.+11,,.3,7.\nPSHELL,1,1,.1,1\nPSOLID,2,1\n";

/// Elements that are neither parallelograms nor parallelepipeds: cards, mass, centre of gravity along x, y, z.
const SHAPES: [(&str, f64, [f64; 3]); 5] = [
    // A right trapezoid with the parallel sides 4 and 1 and the height 3.
    (
        "GRID,1,,0.,0.,0.\nGRID,2,,4.,0.,0.\nGRID,3,,1.,3.,0.\nGRID,4,,0.,3.,0.\nCQUAD4,1,1,1,2,3,4",
        0.7 * 7.5,
        [1.4, 1.2, 0.0],
    ),
    // A square of side 2. The thickness is .1 at x = 0 and .3 at x = 2.
    (
        "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,2.,0.\nGRID,4,,0.,2.,0.\nCQUAD4,1,1,1,2,3,4\n,,,.1,.3,.3,.1",
        7.0 * 0.8,
        [7.0 / 6.0, 1.0, 0.0],
    ),
    // A triangle with legs of 3. The thickness is .1 at two corners and .4 at the corner on x.
    (
        "GRID,1,,0.,0.,0.\nGRID,2,,3.,0.,0.\nGRID,3,,0.,3.,0.\nCTRIA3,1,1,1,2,3\n,,,.1,.4,.1",
        7.0 * 0.9,
        [1.25, 0.875, 0.0],
    ),
    // A frustum of height 3 with square ends of sides 2 and 1.
    (
        "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,2.,0.\nGRID,4,,0.,2.,0.\nGRID,5,,.5,.5,3.\nGRID,6,,1.5,.5,3.\n\
         GRID,7,,1.5,1.5,3.\nGRID,8,,.5,1.5,3.\nCHEXA,1,2,1,2,3,4,5,6\n,7,8",
        49.0,
        [1.0, 1.0, 33.0 / 28.0],
    ),
    // A frustum of height 3 with triangular ends of legs 2 and 1.
    (
        "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,0.,2.,0.\nGRID,4,,0.,0.,3.\nGRID,5,,1.,0.,3.\nGRID,6,,0.,1.,3.\n\
         CPENTA,1,2,1,2,3,4,5,6",
        24.5,
        [15.0 / 28.0, 15.0 / 28.0, 33.0 / 28.0],
    ),
];

#[test]
fn tapered_elements_have_the_mass_and_the_centre_of_the_body() {
    for (cards, mass, centre) in SHAPES {
        for coupled in ["", "PARAM,COUPMASS,1\n"] {
            let (model, faults) = model("", &format!("{DENSE}{coupled}{cards}"));
            assert!(faults.is_empty(), "{faults:?}");
            let ours = model.weight();
            assert_close(cards, ours.mass, mass, 1e-12);
            let apart = (ours.cg - Vec3::from(centre)).amax();
            assert!(apart < 1e-12, "{cards}: {} {centre:?}", ours.cg);
        }
    }
}

/// Elements of every shape, warped and offset: R' M R about the centre of gravity agrees between the solver and the
/// model.
#[test]
fn the_rigid_mass_of_warped_and_curved_elements_is_that_of_the_mass_matrix() {
    const WARPED: &str = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,.4\nGRID,3,,2.2,1.,0.\nGRID,4,,0.,1.3,.3\nGRID,5,,.1,0.,1.\nGRID,6,,2.,.2,1.4\n\
         GRID,7,,2.,1.,1.2\nGRID,8,,0.,1.,1.\nGRID,9,,1.,-.1,.3\nCQUAD4,1,1,1,2,3,4,,.2\nCQUAD8,2,1,5,6,7,8\nCTRIA3,3,1,2,3,6\n\
         CHEXA,4,2,1,2,3,4,5,6\n,7,8,9\nCTETRA,5,2,1,2,4,5\nCBEAM,6,6,3,7,1.,0.,0.\nPBEAM,6,1,.01,1.-5,1.-5,,1.-5,2.\n\
         CSHEAR,7,7,1,2,3,4\nPSHEAR,7,1,.1\nSPC1,1,123456,1,THRU,4\nFORCE,1,7,,1.,1.,0.,0.\nPARAM,AUTOSPC,YES\n";
    for coupled in ["", "PARAM,COUPMASS,1\n"] {
        let (model, solved) = solve("SPC = 1\nLOAD = 1", &format!("{DENSE}{coupled}{WARPED}"));
        let (ours, theirs) = (model.weight(), solved.report.mass.unwrap());
        assert_close("mass", ours.mass, theirs.mass, 1e-12);
        let apart = (ours.cg - theirs.cg).norm();
        assert!(apart < 1e-12, "{} {}", ours.cg, theirs.cg);
        let apart = (model.rigid_body_mass(theirs.cg) - theirs.matrix).amax();
        assert!(apart < 1e-12 * theirs.matrix.amax(), "{coupled}: {apart}");
    }
}

/// A mass in one direction adds to the weight in that direction only, as in the mass axis system of the grid point
/// weight generator.
#[test]
fn a_mass_in_one_direction_weighs_in_that_direction() {
    // The displacement frame of grid 30 is turned by 30 degrees about z.
    let turned = "CORD2R,9,,0.,0.,0.,0.,0.,1.\n,1.,.57735026918962584,0.\nGRID,30,,2.,1.,0.,9\nRBE2,60,3,123456,30\n";
    let (model, solved) = solve(
        "SPC = 1\nLOAD = 1",
        &format!("{PLATE}{turned}CMASS2,50,3.,30,2"),
    );
    assert_close("weight", model.weight().mass, 43.0, 1e-12);
    assert_close("solver", solved.report.mass.unwrap().mass, 43.0, 1e-12);
}

/// A rod as a spring of stiffness 1e6.
const OSCILLATOR: &str = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCROD,1,7,1,2\nPROD,7,3,.001\nMAT1,3,2.+9,,.3\nSPC1,1,123456,1\nSPC1,1,23456,2\n";

#[track_caller]
fn frequencies(cards: &str, count: usize) -> Vec<f64> {
    let (model, faults) = model("SPC = 1", &format!("{OSCILLATOR}{cards}"));
    assert!(faults.is_empty(), "{faults:?}");
    let solved = solve_modes(&model, Some(1), None, count, &SolveOptions::default());
    let solved = solved.unwrap_or_else(|e| panic!("{e}"));
    solved.modes.iter().map(|m| m.frequency).collect()
}

fn hertz(square: f64) -> f64 {
    square.sqrt() / std::f64::consts::TAU
}

#[test]
fn scalar_masses_vibrate_on_springs_in_small_large_and_free_field() {
    let small = "CMASS2  50      8.      2       1       \n";
    let large = "CMASS1* 50              7               2               1               *\n*                                               \n\
                 PMASS   7       8.\n";
    for cards in [
        "CMASS2,50,8.,2,1",
        small,
        large,
        "CMASS1,50,7,2,1\nPMASS,7,8.",
        "CMASS2,50,8.,,,2,1",
    ] {
        let found = frequencies(cards, 1);
        assert_eq!(found.len(), 1, "{cards}");
        assert_close(cards, found[0], hertz(1.0e6 / 8.0), 1e-9);
    }
    // WTMASS reduces the mass by two orders of magnitude.
    let light = frequencies("PARAM,WTMASS,.01\nCMASS2,50,8.,2,1", 1);
    assert_close("WTMASS", light[0], hertz(1.0e6 / 0.08), 1e-9);
}

/// Two masses in a row, one of them on a scalar point: k1 = 1e6, k2 = 2e6, m1 = 8, m2 = 4.
#[test]
fn a_scalar_point_with_mass_vibrates_with_the_grid() {
    let found = frequencies(
        "CMASS2,50,8.,2,1\nCELAS2,60,2.+6,2,1,90\nCMASS4,51,4.,90\nSPOINT,90",
        2,
    );
    // With w the square of the frequency: (3e6 - 8 w) (2e6 - 4 w) = 4e12, or 32 w^2 - 2.8e7 w + 2e12 = 0.
    let root = (2.8e7_f64.powi(2) - 4.0 * 32.0 * 2.0e12).sqrt();
    assert_close("first", found[0], hertz((2.8e7 - root) / 64.0), 1e-9);
    assert_close("second", found[1], hertz((2.8e7 + root) / 64.0), 1e-9);
    // A mass between both points with the kinetic energy 5 (u1 - u2)^2 / 2. Both points have a mass of 8 and a spring
    // of 1e6 to ground.
    let both =
        "CMASS2,50,8.,2,1\nCMASS4,51,8.,90\nCELAS2,60,1.+6,90,,,\nCMASS2,52,5.,2,1,90\nSPOINT,90";
    let found = frequencies(both, 2);
    assert_close("against each other", found[0], hertz(1.0e6 / 18.0), 1e-9);
    assert_close("together", found[1], hertz(1.0e6 / 8.0), 1e-9);
}

#[test]
fn scalar_points_alone_vibrate() {
    let cards =
        "SPOINT,90,91\nCELAS4,60,1.+6,90\nCELAS4,61,1.+6,90,91\nCMASS4,70,2.,90\nCMASS4,71,2.,91\n";
    let (model, faults) = model("", cards);
    assert!(faults.is_empty(), "{faults:?}");
    let solved = solve_modes(&model, None, None, 2, &SolveOptions::default());
    let solved = solved.unwrap_or_else(|e| panic!("{e}"));
    let found: Vec<f64> = solved.modes.iter().map(|m| m.frequency).collect();
    // k / m (3 -+ sqrt 5) / 2.
    assert_close(
        "first",
        found[0],
        hertz(0.5e6 * (3.0 - 5.0_f64.sqrt()) / 2.0),
        1e-9,
    );
    assert_close(
        "second",
        found[1],
        hertz(0.5e6 * (3.0 + 5.0_f64.sqrt()) / 2.0),
        1e-9,
    );
    assert_eq!(solved.mass, None);
}

#[test]
fn gravity_pulls_scalar_masses_of_grids_and_leaves_those_of_scalar_points() {
    let cards =
        "CMASS2,50,8.,2,1\nSPOINT,90\nCMASS4,51,4.,90\nCELAS2,60,2.+6,2,1,90\nGRAV,1,,5.,1.,0.,0.";
    let solved = solve("SPC = 1\nLOAD = 1", &format!("{OSCILLATOR}{cards}"));
    assert_close("grid", displacement_at(&solved, 2)[0], 40.0 / 1.0e6, 1e-12);
    assert_close(
        "point",
        displacement_at(&solved, 90)[0],
        40.0 / 1.0e6,
        1e-12,
    );
    assert_close(
        "reaction",
        solved.1.report.reactions[0].total[0],
        -40.0,
        1e-12,
    );
}

/// A free rod with different masses at its ends. A force of 60 at the second end gives the tension 60 m1 / (m1 + m2).
#[test]
fn inertia_of_scalar_masses_balances_a_free_structure() {
    let free = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCROD,1,7,1,2\nPROD,7,3,.001\nMAT1,3,2.+9,,.3\nSPC1,1,23456,1,2\n\
        CMASS2,50,2.,1,1\nCMASS2,51,4.,2,1\nFORCE,1,2,,60.,1.,0.,0.\nPARAM,INREL,-2\n";
    let solved = solve("SPC = 1\nLOAD = 1", free);
    let stretch = displacement_at(&solved, 2)[0] - displacement_at(&solved, 1)[0];
    assert_close("stretch", stretch, 60.0 * 2.0 / 6.0 / 1.0e6, 1e-9);
    assert_close(
        "acceleration",
        solved.1.report.balance[0].acceleration[0],
        10.0,
        1e-9,
    );
    let of_point = format!("{free}SPOINT,90\nCMASS4,52,1.,90\nCELAS2,60,1.+6,2,1,90\n");
    assert_eq!(
        list_refused_cards("SPC = 1\nLOAD = 1", &of_point),
        ["CMASS 52"]
    );
}

#[test]
fn a_scalar_mass_without_its_property_or_component_is_a_fault() {
    let faults = |cards: &str| model("", &format!("{OSCILLATOR}{cards}")).1.len();
    assert_eq!(faults("CMASS1,50,7,2,1"), 1);
    assert_eq!(faults("CMASS2,50,8.,2,0"), 1);
    assert_eq!(faults("CMASS2,50,8.,77,1"), 1);
}

#[test]
fn non_structural_mass_of_areas_and_lengths_together_is_refused_as_a_total() {
    let of =
        |cards: &str| list_refused_cards("SPC = 1\nLOAD = 1\nNSM = 8", &format!("{PLATE}{cards}"));
    let what = "NSM of ELEMENT with areas and lengths together 8";
    assert_eq!(of("NSML1,8,ELEMENT,7.,1,2"), [what]);
    assert_eq!(of("NSM1,8,ELEMENT,7.,ALL"), [what]);
    assert!(of("NSM1,8,ELEMENT,7.,1,2").is_empty());
    assert_eq!(of("NSM1,8,PCONEAX,7.,1"), ["NSM of PCONEAX 8"]);
    let (_, faults) = model("NSM = 8", &format!("{PLATE}NSM1,8,ELEMENT,7.,1,77"));
    assert_eq!(faults.len(), 1);
}

/// Two bars with one property. NSM adds mass to the second one only, and GRAV acts on it.
#[test]
fn non_structural_mass_of_one_element_acts_in_its_loads() {
    let rods = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,3.,0.,0.\nCBAR,1,7,1,2,0.,0.,1.\nCBAR,2,7,2,3,0.,0.,1.\nPBAR,7,5,.01\n\
        MAT1,5,1.+10,,.3,100.\nSPC1,1,123456,1\nSPC1,1,23456,2,3\nGRAV,1,,10.,1.,0.,0.\nNSM1,8,ELEMENT,4.,2\n";
    let solved = solve("SPC = 1\nLOAD = 1\nNSM = 8", rods);
    // 1 per length on both bars and 4 more on the second one: 2.5 kg at the tip, 3.5 kg at the middle.
    let middle = 60.0 * 2.0 / 1.0e8;
    assert_close("middle", displacement_at(&solved, 2)[0], middle, 1e-12);
    assert_close(
        "tip",
        displacement_at(&solved, 3)[0],
        middle + 25.0 / 1.0e8,
        1e-12,
    );
}

/// Two plates that meet at ten degrees have a common mean normal. SNORM may state this normal with either sign.
#[test]
fn the_mean_normal_stated_by_snorm_changes_nothing() {
    let (s, c) = 10.0_f64.to_radians().sin_cos();
    let (half_s, half_c) = 5.0_f64.to_radians().sin_cos();
    let fold = format!(
        "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,{:?},0.,{s:?}\nGRID,6,,{:?},1.,{s:?}\n\
         CQUAD4,1,1,1,2,3,4\nCQUAD4,2,1,2,5,6,3\nPSHELL,1,1,.02,1,,1\nMAT1,1,2.+11,,.3\nSPC1,1,123456,1,4\n\
         FORCE,1,5,,9.,0.,0.,1.\nFORCE,1,6,,5.,0.,1.,1.\n",
        1.0 + c,
        1.0 + c
    );
    let tip =
        |cards: &str| displacement_at(&solve("SPC = 1\nLOAD = 1", &format!("{fold}{cards}")), 6);
    let plain = tip("");
    for sign in [1.0, -1.0] {
        let n = format!("{:?},0.,{:?}", -half_s * sign, half_c * sign);
        let stated = tip(&format!("SNORM,2,0,{n}\nSNORM,3,,{n}\n"));
        for (a, b) in plain.iter().zip(stated) {
            assert!(
                (a - b).abs() < 1e-9 * plain[2].abs(),
                "{plain:?} {stated:?}"
            );
        }
    }
    // The normal of one plate differs from the mean normal.
    let other = tip("SNORM,2,0,0.,0.,1.\nSNORM,3,0,0.,0.,1.\n");
    assert!((other[2] / plain[2] - 1.0).abs() > 1e-6);
    let of = |cards: &str| list_refused_cards("SPC = 1\nLOAD = 1", &format!("{fold}{cards}"));
    assert_eq!(of("SNORM,2,0,1.,0.,1.\n"), ["SNORM 2"]);
    assert_eq!(of("PARAM,SNORM,0.\nSNORM,2,0,0.,0.,1.\n"), ["SNORM 2"]);
}
