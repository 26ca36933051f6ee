//! Compares RSPLINE, CGAP, RIGID on PBUSH, bushes without CID, moments on RBE3 and chained equations with closed forms.

use crate::mesh::Bulk;
use strainbridge::fe::*;
use strainbridge::finding::Finding;

const E: f64 = 210_000.0;

pub fn findings(b: &Bulk) -> Vec<Finding> {
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: None,
        relief: Relief::None,
    };
    let (s, _) = solve_cases(&b.model(), &[case], &SolveOptions::default())
        .unwrap_or_else(|e| panic!("{e}"));
    s.findings
}

fn assert_close(what: &str, got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance * expected.abs().max(1e-12),
        "{what}: {got:e} for {expected:e}"
    );
}

/// Returns grids 1 to n along a line. A soft bar connects the ends, so that the model has something to solve.
fn line(points: &[[f64; 3]]) -> Bulk {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3\nPBAR,2,1,1.,1.,1.,1.");
    for p in points {
        b.grid(*p);
    }
    b
}

#[test]
fn a_straight_spline_is_a_cubic_between_its_ends_and_a_straight_line_in_twist_and_stretch() {
    let mut b = line(&[[0.0; 3], [25.0, 0.0, 0.0], [100.0, 0.0, 0.0]]);
    b.card("RSPLINE,9,,1,2,123456,3");
    let (v, w) = (
        [1e-3, 2e-3, -3e-3, 1e-4, 2e-4, -3e-4],
        [2e-3, -1e-3, 4e-3, -2e-4, 1e-4, 5e-4],
    );
    for (id, u) in [(1, v), (3, w)] {
        for (k, u) in u.iter().enumerate() {
            b.card(&format!("SPC,1,{id},{},{u:.7E}", k + 1));
        }
    }
    b.card("CBAR,1,2,1,3,0.,1.,0.\nFORCE,1,3,0,0.,0.,0.,1.");
    assert!(b.faults().is_empty(), "{:?}", b.faults());
    let u = b.solve().displacement_at(2);
    // Hermite functions at a quarter of L = 100.
    let (s, l) = (0.25_f64, 100.0);
    let h = [
        1.0 - 3.0 * s * s + 2.0 * s.powi(3),
        l * (s - 2.0 * s * s + s.powi(3)),
        3.0 * s * s - 2.0 * s.powi(3),
        l * (s.powi(3) - s * s),
    ];
    let slope = [
        (6.0 * s * s - 6.0 * s) / l,
        1.0 - 4.0 * s + 3.0 * s * s,
        (6.0 * s - 6.0 * s * s) / l,
        3.0 * s * s - 2.0 * s,
    ];
    let cubic = |f: &[f64; 4], ends: [f64; 4]| f.iter().zip(ends).map(|(a, b)| a * b).sum::<f64>();
    assert_close("along", u[0], v[0] + s * (w[0] - v[0]), 1e-6);
    assert_close("y", u[1], cubic(&h, [v[1], v[5], w[1], w[5]]), 1e-6);
    assert_close("z", u[2], cubic(&h, [v[2], -v[4], w[2], -w[4]]), 1e-6);
    assert_close("twist", u[3], v[3] + s * (w[3] - v[3]), 1e-6);
    assert_close(
        "about y",
        u[4],
        -cubic(&slope, [v[2], -v[4], w[2], -w[4]]),
        1e-6,
    );
    assert_close(
        "about z",
        u[5],
        cubic(&slope, [v[1], v[5], w[1], w[5]]),
        1e-6,
    );
}

#[test]
fn a_bent_spline_moves_as_bars_of_the_tube_that_it_stands_for() {
    // A quarter circle of radius 50 in six chords, with turned frames. The tube has D/L = .2 and I = 1, and its J gives
    // GJ = EI.
    let points: Vec<[f64; 3]> = (0..=6)
        .map(|k| {
            let a = std::f64::consts::FRAC_PI_2 * f64::from(k) / 6.0;
            [50.0 * a.cos(), 50.0 * a.sin(), 3.0 * f64::from(k)]
        })
        .collect();
    let length: f64 = points
        .windows(2)
        .map(|p| {
            (0..3)
                .map(|i| (p[1][i] - p[0][i]).powi(2))
                .sum::<f64>()
                .sqrt()
        })
        .sum();
    let d = 0.2 * length;
    let ends = [
        [1e-3, 2e-3, -3e-3, 1e-4, 2e-4, -3e-4],
        [2e-3, -1e-3, 4e-3, -2e-4, 1e-4, 5e-4],
    ];
    let enforced = |b: &mut Bulk| {
        for (id, u) in [1, 7].into_iter().zip(ends) {
            for (k, u) in u.iter().enumerate() {
                b.card(&format!("SPC,1,{id},{},{u:.7E}", k + 1));
            }
        }
        b.card("FORCE,1,7,0,0.,0.,0.,1.");
    };
    let mut bars = line(&points);
    // For nu = .3, G is E / 2.6, so J = 2.6 I. A = 8 I / d^2. There is no shear flexibility (K1 = K2 = 0).
    bars.card(&format!("PBAR,3,1,{:?},1.,1.,2.6", 8.0 / (d * d)));
    for k in 1..=6 {
        bars.card(&format!("CBAR,{k},3,{k},{},0.,0.,1.", k + 1));
    }
    enforced(&mut bars);
    let mut spline = line(&points);
    spline.card("RSPLINE,9,.2,1,2,123456,3,123456,4,\n,123456,5,123456,6,123456,7");
    spline.card("CBAR,1,2,1,7,0.,0.,1.");
    enforced(&mut spline);
    assert!(spline.faults().is_empty(), "{:?}", spline.faults());
    let (a, b) = (bars.solve(), spline.solve());
    for id in 2..=6 {
        for (x, y) in a.displacement_at(id).iter().zip(b.displacement_at(id)) {
            assert!(
                (x - y).abs() < 1e-7 * 5e-3,
                "grid {id}: {:?} {:?}",
                a.displacement_at(id),
                b.displacement_at(id)
            );
        }
    }
    // A card without a valid meaning is refused.
    for (card, printed) in [
        ("RSPLINE,9,.2,1,2,123456", "independent"),
        ("RSPLINE,9,.2,1,2,123,3,123", "independent"),
        ("RSPLINE,9,.2,1,2,123,2,123,3", "length"),
    ] {
        let mut b = line(&points);
        b.card(card);
        assert!(
            b.faults().iter().any(|f| f.contains(printed)),
            "{card}: {:?}",
            b.faults()
        );
    }
}

#[test]
fn a_gap_carries_ka_and_kt_while_closed_and_kb_alone_while_open_and_reports_it() {
    let with = |property: &str, load: &str| {
        let mut b = line(&[[0.0; 3], [10.0, 0.0, 0.0]]);
        b.card("CGAP,5,6,1,2,0.,1.,0.");
        b.card(property);
        b.card("CELAS2,8,1.,2,1\nCELAS2,9,1.,2,2\nCELAS2,10,1.,2,3");
        b.hold("123456", [1]);
        b.card(load);
        b
    };
    let along = "FORCE,1,2,0,-100.,1.,0.,0.";
    let across = "FORCE,1,2,0,100.,0.,1.,0.";
    for (property, load, dof, k) in [
        ("PGAP,6,0.,0.,1000.,,300.", along, 0, 1000.0),
        ("PGAP,6,0.,0.,1000.,,,.3", across, 1, 300.0),
        ("PGAP,6,.5,0.,1000.,7.", along, 0, 7.0),
        ("PGAP,6,.5,0.,1000.,7.,300.", across, 1, 0.0),
    ] {
        let b = with(property, load);
        let got = b.solve().displacement_at(2)[dof].abs();
        // The rotations of the grid are free, as on a solid. The lateral stiffness acts on translations.
        assert_close(property, got, 100.0 / (k + 1.0), 1e-9);
        let told = findings(&b);
        let gap = told
            .iter()
            .find(|f| f.code == "gap-linear")
            .expect("gap-linear");
        let word = if property.contains(".5,") {
            "1 open (5)"
        } else {
            "1 closed (5)"
        };
        assert!(gap.message.contains(word), "{}", gap.message);
        let leaves_a_moment = property.ends_with("300.") && !property.contains(".5,");
        let leaves_a_moment = leaves_a_moment || property.ends_with(".3");
        assert_eq!(
            gap.message.contains("is not balanced"),
            leaves_a_moment,
            "{property}: {}",
            gap.message
        );
    }
    let preloaded = findings(&with("PGAP,6,0.,50.,1000.", along));
    let gap = preloaded
        .iter()
        .find(|f| f.code == "gap-linear")
        .expect("gap-linear");
    assert!(gap.message.contains("preload"), "{}", gap.message);
}

#[test]
fn rigid_components_of_a_bush_hand_on_motion_and_the_others_give_way() {
    // A cantilever of 500. A bush connects its tip to a grid 40 away along y. It is an arm if all terms are rigid, and
    // K6 is a spring.
    let (l, i, a) = (500.0, 9000.0, 40.0);
    for (property, hinge) in [
        ("PBUSH,7,K,RIGID,RIGID,RIGID,RIGID,RIGID,RIGID", 0.0),
        ("PBUSH,7,K,RIGID,RIGID,RIGID,RIGID,RIGID,2.+6", 1.0 / 2e6),
    ] {
        for cid in ["", "3"] {
            let mut b = Bulk::default();
            b.card("MAT1,1,210000.,,.3\nPBAR,2,1,200.,9000.,9000.,18000.");
            let (root, tip) = (b.grid([0.0; 3]), b.grid([l, 0.0, 0.0]));
            let arm = b.grid([l, a, 0.0]);
            b.card(&format!("CBAR,1,2,{root},{tip},0.,1.,0."));
            // Axes from the line and the vector: x along y, z down. In system 3, z is basic z, and the system is turned
            // by 30 degrees about it.
            b.card("CORD2R,3,0,0.,0.,0.,0.,0.,1.,\n,.866025403784,.5,0.");
            b.card(&format!("CBUSH,5,7,{tip},{arm},1.,0.,0.,{cid}"));
            b.card(property);
            b.hold("123456", [root]);
            b.card(&format!("FORCE,1,{arm},0,100.,1.,0.,0."));
            assert!(b.faults().is_empty(), "{:?}", b.faults());
            let s = b.solve();
            // The force at the arm bends the bar by the moment -P a about z and stretches it.
            let m = -100.0 * a;
            let turn = m * l / (E * i);
            // The hinge is in the middle of the bush, so the force has half the arm about it.
            let hinge_turn = hinge * m / 2.0;
            let expected = 100.0 * l / (E * 200.0) - turn * a - hinge_turn * a / 2.0;
            assert_close("arm, x", s.displacement_at(arm)[0], expected, 1e-9);
            assert_close(
                "arm, y",
                s.displacement_at(arm)[1],
                m * l * l / (2.0 * E * i),
                1e-9,
            );
            assert_close(
                "arm, turn",
                s.displacement_at(arm)[5],
                turn + hinge_turn,
                1e-9,
            );
        }
    }
}

#[test]
fn a_rigid_bush_follows_whichever_end_is_free_to() {
    // The arm of the test above, but an RBE2 moves its end. The bush makes its other end dependent.
    let (l, i, a) = (500.0, 9000.0, 40.0);
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3\nPBAR,2,1,200.,9000.,9000.,18000.");
    let (root, tip) = (b.grid([0.0; 3]), b.grid([l, 0.0, 0.0]));
    let (arm, load) = (b.grid([l, a, 0.0]), b.grid([l, a, 0.0]));
    b.card(&format!("CBAR,1,2,{root},{tip},0.,1.,0."));
    b.card(&format!("CBUSH,5,7,{tip},{arm},1.,0.,0."));
    b.card("PBUSH,7,K,RIGID,RIGID,RIGID,RIGID,RIGID,RIGID");
    b.card(&format!("RBE2,90,{load},123456,{arm}"));
    b.hold("123456", [root]);
    b.card(&format!("FORCE,1,{load},0,100.,1.,0.,0."));
    assert!(b.faults().is_empty(), "{:?}", b.faults());
    let s = b.solve();
    let turn = -100.0 * a * l / (E * i);
    let expected = 100.0 * l / (E * 200.0) - turn * a;
    assert_close("arm, x", s.displacement_at(load)[0], expected, 1e-9);
    assert_close("arm, turn", s.displacement_at(load)[5], turn, 1e-9);
}

#[test]
fn which_dofs_a_rigid_bush_makes_dependent_does_not_hang_on_the_unit_of_length() {
    // Only translations are rigid, and the rotations of the arm's end are fixed. The force acts in the middle of the
    // arm.
    for unit in [1.0_f64, 1e-3] {
        let (l, i, a) = (500.0 * unit, 9000.0 * unit.powi(4), 40.0 * unit);
        let (area, e) = (200.0 * unit * unit, E / (unit * unit));
        let mut b = Bulk::default();
        b.card(&format!("MAT1,1,{e:?},,.3"));
        b.card(&format!("PBAR,2,1,{area:.6E},{i:.6E},{i:.6E},{i:.6E}"));
        let (root, tip) = (b.grid([0.0; 3]), b.grid([l, 0.0, 0.0]));
        let arm = b.grid([l, a, 0.0]);
        b.card(&format!("CBAR,1,2,{root},{tip},0.,1.,0."));
        b.card(&format!("CBUSH,5,7,{tip},{arm},1.,0.,0."));
        b.card("PBUSH,7,K,RIGID,RIGID,RIGID");
        b.hold("123456", [root]);
        b.hold("456", [arm]);
        b.card(&format!("FORCE,1,{arm},0,100.,1.,0.,0."));
        assert!(b.faults().is_empty(), "{:?}", b.faults());
        let turn = 100.0 * a / 2.0 * l / (e * i);
        let expected = 100.0 * l / (e * area) + turn * a / 2.0;
        assert_close("arm, x", b.solve().displacement_at(arm)[0], expected, 1e-9);
    }
}

#[test]
fn a_rigid_bush_to_ground_is_a_support_with_a_reaction() {
    let with = |cid: &str, property: &str| {
        let mut b = Bulk::default();
        b.card("MAT1,1,210000.,,.3\nPBAR,2,1,200.,9000.,9000.,18000.");
        let (root, tip) = (b.grid([0.0; 3]), b.grid([500.0, 0.0, 0.0]));
        // An RBE2 joins the bar to the grid of the bush. The force of the bar reaches the ground through it.
        let ground = b.grid([0.0, 30.0, 0.0]);
        b.card(&format!("CBAR,1,2,{root},{tip},0.,1.,0."));
        b.card(&format!("RBE2,90,{ground},123456,{root}"));
        b.card("CORD2R,3,0,0.,0.,0.,0.,0.,1.,\n,.866025403784,.5,0.");
        b.card(&format!("CBUSH,5,7,{ground},,,,,{cid}"));
        b.card(&format!("PBUSH,7,K,{property}"));
        b.card(&format!("FORCE,1,{tip},0,100.,1.,2.,3."));
        b.card(&format!("SPC1,1,6,{tip}"));
        assert!(b.faults().is_empty(), "{:?}", b.faults());
        b
    };
    let told = |b: &Bulk| {
        let found = findings(b);
        found.iter().any(|f| f.code == "bush-reaction-missing")
    };
    for cid in ["0", "3"] {
        let b = with(cid, "RIGID,RIGID,RIGID,RIGID,RIGID,RIGID");
        let case = LoadCase {
            subcase: 1,
            label: String::new(),
            loads: vec![UnitLoad::Set(1)],
            spc: Some(1),
            mpc: None,
            relief: Relief::None,
        };
        let (_, report) = solve_cases(&b.model(), &[case], &SolveOptions::default())
            .unwrap_or_else(|e| panic!("{e}"));
        let r = &report.reactions[0];
        assert!(r.residual < 1e-9, "{}", r.residual);
        assert_close("x", r.total[0], -100.0, 1e-9);
        assert_close("y", r.total[1], -200.0, 1e-9);
        assert_close("z", r.total[2], -300.0, 1e-9);
        assert!(!told(&b));
    }
    // One oblique direction is rigid. No single dof fixes it, and a finding reports that.
    assert!(told(&with("3", "RIGID,1.+6,1.+6,1.+8,1.+8,1.+8")));
    assert!(!told(&with("0", "RIGID,1.+6,1.+6,1.+8,1.+8,1.+8")));
}

#[test]
fn a_bush_without_axes_takes_the_basic_frame_and_reports_it_where_it_matters() {
    let at = |property: &str, second: &str| {
        let mut b = Bulk::default();
        b.grid([3.0, 4.0, 5.0]);
        b.grid([3.0, 4.0, 5.0]);
        b.card(property);
        b.card(&format!("CBUSH,5,7,1,{second}"));
        b.hold("123456", [2]);
        if second.is_empty() {
            b.card("CELAS2,8,1.,2,1");
        }
        b.force(1, [100.0, 60.0, 30.0]);
        assert!(b.faults().is_empty(), "{:?}", b.faults());
        (b.solve().displacement_at(1), findings(&b))
    };
    // A vector without a line between the ends must not be ignored silently.
    for (property, faulty) in [("50.,30.,10.", true), ("10.,10.,10.", false)] {
        let mut b = Bulk::default();
        b.grid([3.0, 4.0, 5.0]);
        b.grid([3.0, 4.0, 5.0]);
        b.card(&format!("PBUSH,7,K,{property}\nCBUSH,5,7,1,2,0.,1.,0."));
        let told = b.faults().iter().any(|f| f.contains("without CID"));
        assert_eq!(told, faulty, "{:?}", b.faults());
    }
    for second in ["2", ""] {
        let (u, told) = at("PBUSH,7,K,50.,30.,10.,1.,1.,1.", second);
        assert!(
            (u[0] - 2.0).abs() < 1e-9 && (u[1] - 2.0).abs() < 1e-9 && (u[2] - 3.0).abs() < 1e-9
        );
        assert!(
            told.iter().any(|f| f.code == "bush-frame-assumed"),
            "{told:?}"
        );
        let (u, told) = at("PBUSH,7,K,10.,10.,10.,1.,1.,1.", second);
        assert!((u[0] - 10.0).abs() < 1e-9);
        assert!(
            !told.iter().any(|f| f.code == "bush-frame-assumed"),
            "{told:?}"
        );
    }
}

#[test]
fn a_moment_on_an_rbe3_is_shared_out_by_lever_arms() {
    // The reference grid is in the middle of four grids of a rectangle 2a x 2b. A moment M about z gives the force M
    // r_i / sum r^2 at grid i, perpendicular to r_i.
    let (a, b_) = (30.0, 20.0);
    let corners = [[a, b_], [-a, b_], [-a, -b_], [a, -b_]];
    let mut b = Bulk::default();
    for c in corners {
        b.grid([c[0], c[1], 0.0]);
    }
    let centre = b.grid([0.0; 3]);
    for g in 1..=4 {
        for dof in 1..=3 {
            b.card(&format!("CELAS2,{},100.,{g},{dof}", 10 * g + dof));
        }
    }
    b.hold("456", 1..=4);
    b.card(&format!("RBE3,90,,{centre},123456,1.,123,1,2,\n,3,4"));
    b.card(&format!("MOMENT,1,{centre},0,1000.,0.,0.,1."));
    assert!(b.faults().is_empty(), "{:?}", b.faults());
    let s = b.solve();
    let sum: f64 = 4.0 * (a * a + b_ * b_);
    for (g, c) in (1..=4).zip(corners) {
        assert_close(
            "x",
            s.displacement_at(g)[0] * 100.0,
            -1000.0 * c[1] / sum,
            1e-9,
        );
        assert_close(
            "y",
            s.displacement_at(g)[1] * 100.0,
            1000.0 * c[0] / sum,
            1e-9,
        );
    }
    // A moment about x gives forces along z, proportional to y / sum y^2.
    let text = b.text.replace("0.,0.,1.\n", "1.,0.,0.\n");
    assert_ne!(text, b.text);
    b.text = text;
    let s = b.solve();
    for (g, c) in (1..=4).zip(corners) {
        assert_close(
            "z",
            s.displacement_at(g)[2] * 100.0,
            1000.0 * c[1] / (4.0 * b_ * b_),
            1e-9,
        );
    }
}

#[test]
fn equations_that_chain_carry_forces_and_motion_through_all_of_them() {
    // u4 = 2 u3, u3 = 3 u2, u2 = u1 / 2 (out of order). A force F at grid 4 is 3 F at grid 1.
    let mut b = Bulk::default();
    for _ in 0..4 {
        b.grid([0.0; 3]);
    }
    b.card("CELAS2,1,10.,1,1");
    b.hold("23456", 1..=4);
    for (sid, dependent, other, c) in [(5, 4, 3, 2.0), (5, 2, 1, 0.5), (5, 3, 2, 3.0)] {
        b.card(&format!("MPC,{sid},{dependent},1,1.,{other},1,{:?}", -c));
    }
    b.force(4, [20.0, 0.0, 0.0]);
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: Some(5),
        relief: Relief::None,
    };
    let (s, _) = solve_cases(&b.model(), &[case], &SolveOptions::default())
        .unwrap_or_else(|e| panic!("{e}"));
    let u = |g: usize| s.cases[0].displacement[g - 1][0];
    assert_close("1", u(1), 3.0 * 20.0 / 10.0, 1e-12);
    assert_close("2", u(2), 3.0, 1e-12);
    assert_close("3", u(3), 9.0, 1e-12);
    assert_close("4", u(4), 18.0, 1e-12);
}
