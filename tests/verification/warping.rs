//! Compares CBEAM with warping points with Vlasov's closed forms of restrained torsion and with an I-beam of shells.

use crate::mesh::{Bulk, assert_near};
use strainbridge::fe::*;

const E: f64 = 210_000.0;
const NU: f64 = 0.3;

/// Returns `n` beams along x with J and CW and with the warping points 1001 and up. End A is fixed, and its warping too
/// if `fixed` is set.
fn bar(n: u32, length: f64, (j, cw): (f64, f64)) -> Bulk {
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,{E:?},,{NU:?}"));
    b.card(&format!(
        "PBEAM,2,1,2400.,1.6+7,1.+6,0.,{j:?},0.,\n,0.,0.,0.,0.,0.,0.,0.,0.,\n,1.,1.,0.,0.,0.,0.,{cw:?},{cw:?}"
    ));
    for k in 0..=n {
        b.grid([length * f64::from(k) / f64::from(n), 0.0, 0.0]);
        b.card(&format!("SPOINT,{}", 1001 + k));
    }
    for k in 1..=n {
        b.card(&format!(
            "CBEAM,{k},2,{k},{},0.,1.,0.,,\n,,,,,,,,,\n,{},{}",
            k + 1,
            1000 + k,
            1001 + k
        ));
    }
    b.hold("123456", [1]);
    b.card(&format!("MOMENT,1,{},0,1.+6,1.,0.,0.", n + 1));
    assert!(b.faults().is_empty(), "{:?}", b.faults());
    b
}

#[test]
fn torsion_with_warping_held_at_one_end_or_both_is_that_of_vlasov() {
    let g = E / (2.0 + 2.0 * NU);
    let torque = 1e6;
    for (j, cw, length) in [
        (28_800.0, 1e10, 1500.0),
        (28_800.0, 1e10, 60.0),
        (2.88e6, 1e8, 9000.0),
    ] {
        let lambda = (g * j / (E * cw)).sqrt();
        let psi = lambda * length;
        let one_end = torque / (g * j) * (length - psi.tanh() / lambda);
        let both = torque * length / (g * j) * (1.0 - (psi / 2.0).tanh() / (psi / 2.0));
        for n in [1, 3] {
            let mut b = bar(n, length, (j, cw));
            b.card("SPC1,1,1,1001");
            let tip = b.solve();
            assert_near(
                "warping held at the root",
                tip.displacement_at(n + 1)[3],
                one_end,
                1e-7,
            );
            // The rate of twist at the free end is the value of its warping point.
            let rate = torque / (g * j) * (1.0 - 1.0 / psi.cosh());
            assert_near(
                "rate of twist",
                tip.displacement_at(1001 + n)[0],
                rate,
                1e-6,
            );
            b.card(&format!("SPC1,1,1,{}", 1001 + n));
            assert_near(
                "warping held at both ends",
                b.solve().displacement_at(n + 1)[3],
                both,
                1e-6,
            );
        }
        // With free warping, the twist is that of Saint-Venant.
        let b = bar(2, length, (j, cw));
        assert_near(
            "free",
            b.solve().displacement_at(3)[3],
            torque * length / (g * j),
            1e-6,
        );
    }
}

#[test]
fn without_warping_points_or_constant_a_beam_twists_as_saint_venant_has_it() {
    let g = E / (2.0 + 2.0 * NU);
    let mut b = bar(1, 1500.0, (28_800.0, 1e10));
    b.text = b.text.replace("\n,1001,1002", "");
    b.card("SPC1,1,1,1001,1002");
    assert_near(
        "no points",
        b.solve().displacement_at(2)[3],
        1e6 * 1500.0 / (g * 28_800.0),
        1e-9,
    );
    let mut b = bar(1, 1500.0, (28_800.0, 0.0));
    b.card("SPC1,1,1,1001,1002");
    assert_near(
        "no constant",
        b.solve().displacement_at(2)[3],
        1e6 * 1500.0 / (g * 28_800.0),
        1e-9,
    );
}

/// An I-beam of shells compared with one CBEAM with warping. Height and width are 200 and 100 between midlines, the
/// thickness is 6, and the root is fixed. The section constants are those of thin walls, J = sum b t^3 / 3 and CW = h^2
/// b^3 t / 24.
#[test]
fn an_i_beam_of_shells_twists_as_the_warping_beam() {
    let (h, w, t, length) = (200.0, 100.0, 6.0, 1500.0);
    let mut b = Bulk::shell(E, NU, t);
    let (along, across, up) = (75, 8, 12);
    let flange =
        |b: &mut Bulk, z: f64| b.patch(along, across, |x, y| [length * x, w * (y - 0.5), z]);
    let bottom = flange(&mut b, -h / 2.0);
    let top = flange(&mut b, h / 2.0);
    let middle = across / 2;
    let mut rows: Vec<Vec<u32>> = Vec::new();
    for i in 0..=along {
        let mut column = vec![bottom[i][middle]];
        for k in 1..up {
            column.push(b.grid([
                length * i as f64 / along as f64,
                0.0,
                h * (k as f64 / up as f64 - 0.5),
            ]));
        }
        column.push(top[i][middle]);
        rows.push(column);
    }
    for i in 0..along {
        for k in 0..up {
            b.quad([
                rows[i][k],
                rows[i + 1][k],
                rows[i + 1][k + 1],
                rows[i][k + 1],
            ]);
        }
    }
    let root: Vec<u32> = bottom[0]
        .iter()
        .chain(&top[0])
        .chain(&rows[0])
        .copied()
        .collect();
    b.hold("123456", root);
    // A torque of 1e6 as a couple on the flanges.
    let p = 1e6 / h;
    let (low, high) = (bottom[along][middle], top[along][middle]);
    b.force(high, [0.0, -p, 0.0]);
    b.force(low, [0.0, p, 0.0]);
    let s = b.solve();
    let shells = (s.displacement_at(low)[1] - s.displacement_at(high)[1]) / h;
    let j = (2.0 * w + h) * t.powi(3) / 3.0;
    let cw = h * h * w.powi(3) * t / 24.0;
    let mut beam = bar(1, length, (j, cw));
    beam.card("SPC1,1,1,1001");
    let twist = beam.solve().displacement_at(2)[3];
    // Thin-wall theory neglects shear strain of the flanges and warping across the thickness of the walls.
    assert_near("I-beam of shells over warping beam", shells, twist, 0.03);
    // Without restrained warping the twist would be more than twice as large.
    let g = E / (2.0 + 2.0 * NU);
    assert!(1e6 * length / (g * j) > 2.0 * twist);
}

#[test]
fn the_warping_constants_of_open_sections_are_those_of_the_books() {
    let of = |kind: &str, dims: &[f64]| {
        let mut b = Bulk::default();
        b.card("MAT1,1,210000.,,.3");
        let fields: Vec<String> = dims.iter().map(|d| format!("{d:?}")).collect();
        b.card(&format!("PBEAML,2,1,,{kind},,,,,\n,{}", fields.join(",")));
        let (a, c) = (b.grid([0.0; 3]), b.grid([100.0, 0.0, 0.0]));
        b.card(&format!("CBEAM,1,2,{a},{c},0.,1.,0."));
        assert!(b.faults().is_empty(), "{:?}", b.faults());
        b.model().beam_properties[0].warping[0]
    };
    // I with equal flanges: h^2 b^3 t / 24 with midline sizes.
    let (h, b, t, tw) = (194.0_f64, 100.0_f64, 6.0, 4.0);
    let i = h * h * b.powi(3) * t / 24.0;
    assert_near("I", of("I", &[200.0, b, b, tw, t, t]), i, 1e-9);
    assert_near("I1", of("I1", &[b - tw, tw, 188.0, 200.0]), i, 1e-9);
    assert_near("H", of("H", &[194.0 - 6.0, 12.0, b, tw]), i, 1e-9);
    // I with unequal flanges: h^2 I1 I2 / (I1 + I2).
    let (i1, i2) = (6.0 * b.powi(3) / 12.0, 6.0 * 60.0_f64.powi(3) / 12.0);
    assert_near(
        "I, one narrow",
        of("I", &[200.0, b, 60.0, tw, t, t]),
        h * h * i1 * i2 / (i1 + i2),
        1e-9,
    );
    // Channel with midline sizes: b^3 h^2 t / 12 (3 b t + 2 h tw) / (6 b t + h tw).
    let (h, b) = (194.0_f64, 58.0_f64);
    let channel =
        b.powi(3) * h * h * t / 12.0 * (3.0 * b * t + 2.0 * h * tw) / (6.0 * b * t + h * tw);
    assert_near("CHAN", of("CHAN", &[60.0, 200.0, tw, t]), channel, 1e-9);
    assert_near(
        "CHAN1",
        of("CHAN1", &[56.0, tw, 188.0, 200.0]),
        channel,
        1e-9,
    );
    assert_near("CHAN2", of("CHAN2", &[t, tw, 60.0, 200.0]), channel, 1e-9);
    // Z: b^3 h^2 t / 12 (b t + 2 h tw) / (2 b t + h tw).
    let z = b.powi(3) * h * h * t / 12.0 * (b * t + 2.0 * h * tw) / (2.0 * b * t + h * tw);
    assert_near("Z", of("Z", &[56.0, tw, 188.0, 200.0]), z, 1e-9);
    for (kind, dims) in [
        ("T", [100.0, 80.0, 5.0, 5.0]),
        ("L", [100.0, 80.0, 5.0, 5.0]),
        ("BOX", [100.0, 80.0, 5.0, 5.0]),
    ] {
        assert_eq!(of(kind, &dims), 0.0, "{kind}");
    }
}

/// The solution of E CW theta'''' - GJ theta'' = m with theta = theta' = 0 at the root and free ends at the tip.
#[test]
fn torques_along_a_warping_beam_twist_it_as_vlasov_has_it_however_few_the_elements() {
    let g = E / (2.0 + 2.0 * NU);
    let (m, length) = (100.0, 1500.0);
    for (j, cw) in [(28_800.0, 1e10), (2.88e6, 1e8), (1.0, 1e14)] {
        let lambda = (g * j / (E * cw)).sqrt();
        let psi = lambda * length;
        let uniform = if psi < 0.01 {
            // Without Saint-Venant's term it is a cantilever with the stiffness E CW under m.
            m * length.powi(4) / (8.0 * E * cw)
        } else {
            let curl = (1.0 + psi * psi.sinh()) / psi.cosh() - 1.0;
            m / (g * j) * (length * length / 2.0 - curl / (lambda * lambda))
        };
        for n in [1_u32, 3] {
            let mut b = bar(n, length, (j, cw));
            b.text = b.text.replace("MOMENT,1,", "MOMENT,2,");
            b.card("SPC1,1,1,1001");
            for k in 1..=n {
                b.card(&format!("PLOAD1,1,{k},MXE,FR,0.,{m:?},1.,{m:?}"));
            }
            let s = b.solve();
            assert_near("uniform torque", s.displacement_at(n + 1)[3], uniform, 1e-6);
        }
    }
}

/// The motion of the tip depends only on the torque along the bar, and not on the division into elements.
///
/// The test compares torques over spans and at points within one element with elements that end there. It also compares
/// a linear torque over the whole element with its parts.
#[test]
fn a_torque_within_a_warping_beam_is_the_same_wherever_elements_end() {
    for (j, cw) in [(28_800.0, 1e10), (2.88e6, 1e8), (1.0, 1e14)] {
        let solved = |n: u32, loads: &[String]| {
            let mut b = bar(n, 1500.0, (j, cw));
            b.text = b.text.replace("MOMENT,1,", "MOMENT,2,");
            b.card("SPC1,1,1,1001");
            loads.iter().for_each(|l| b.card(l));
            let s = b.solve();
            [s.displacement_at(n + 1)[3], s.displacement_at(1001 + n)[0]]
        };
        let card = |element: u32, rest: &str| format!("PLOAD1,1,{element},MXE,FR,{rest}");
        let pairs = [
            // Concentrated torque at two thirds.
            (
                vec![card(1, ".666666666667,500.")],
                vec![card(2, "1.,500.")],
            ),
            // Torque over the middle third, from 30 to 90.
            (
                vec![card(1, ".333333333333,30.,.666666666667,90.")],
                vec![card(2, "0.,30.,1.,90.")],
            ),
            // Torque over the whole element, from zero to 90.
            (
                vec![card(1, "0.,0.,1.,90.")],
                vec![
                    card(1, "0.,0.,1.,30."),
                    card(2, "0.,30.,1.,60."),
                    card(3, "0.,60.,1.,90."),
                ],
            ),
        ];
        for (one, three) in pairs {
            let (a, b) = (solved(1, &one), solved(3, &three));
            assert_near(&one[0], a[0], b[0], 1e-6);
            // Far from a torque, the rate of twist decays to zero.
            let rate = (a[1] - b[1]).abs();
            assert!(rate < 1e-6 * (b[0] / 1500.0), "{}: {a:?} {b:?}", one[0]);
        }
    }
}

#[test]
fn bimoments_count_neither_as_forces_of_supports_nor_as_forces_on_a_free_body() {
    let mut b = bar(1, 1500.0, (28_800.0, 1e10));
    b.card("SPC1,1,1,1001\nPLOAD1,1,1,MXE,FR,0.,100.,1.,100.");
    let model = b.model();
    let case = |relief, spc| LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc,
        mpc: None,
        relief,
    };
    let options = SolveOptions::default();
    let (_, report) = solve_cases(&model, &[case(Relief::None, Some(1))], &options)
        .unwrap_or_else(|e| panic!("{e}"));
    let r = &report.reactions[0];
    assert!(r.residual < 1e-9, "{}", r.residual);
    assert_near("reaction", r.total[3], -(1e6 + 100.0 * 1500.0), 1e-9);
    assert!(r.total[0].abs() < 1e-6 * r.total[3].abs(), "{:?}", r.total);
    // A free bar under a torque that grows along it. The bimoments of its ends do not cancel, and they exert no force.
    let mut b = bar(1, 1500.0, (28_800.0, 1e10));
    b.card("PLOAD1,1,1,MXE,FR,0.,0.,1.,100.");
    b.card("CONM2,51,1,,2.,,,,,\n,900.,,900.,,,900.\nCONM2,52,2,,2.,,,,,\n,900.,,900.,,,900.");
    let (_, report) = solve_cases(&b.model(), &[case(Relief::Automatic, None)], &options)
        .unwrap_or_else(|e| panic!("{e}"));
    let balance = &report.balance[0];
    assert_near("torque", balance.applied[3], 1e6 + 50.0 * 1500.0, 1e-9);
    assert_near(
        "spin",
        balance.acceleration[3],
        balance.applied[3] / 1800.0,
        1e-9,
    );
    assert!(balance.applied[0].abs() < 1e-6, "{:?}", balance.applied);
    assert!(balance.acceleration[0].abs() < 1e-6, "{balance:?}");
}

#[test]
fn warping_points_of_a_beam_without_warping_constant_are_reported() {
    let told = |cw: f64| {
        let mut b = bar(1, 1500.0, (28_800.0, cw));
        b.card("SPC1,1,1,1001,1002");
        let case = LoadCase {
            subcase: 1,
            label: String::new(),
            loads: vec![UnitLoad::Set(1)],
            spc: Some(1),
            mpc: None,
            relief: Relief::None,
        };
        let solved = solve_cases(&b.model(), &[case], &SolveOptions::default());
        let (solution, _) = solved.unwrap_or_else(|e| panic!("{e}"));
        let messages = solution.findings.into_iter().map(|f| f.message);
        messages.collect::<Vec<_>>()
    };
    assert!(told(0.0).iter().any(|m| m.contains("without warping")));
    assert!(told(1e10).iter().all(|m| !m.contains("without warping")));
}
