//! PLOAD4 with directions: tractions in rectangular, cylindrical and spherical systems, compared with the integrals of
//! their fields.

use crate::mesh::Bulk;
use strainbridge::fe::*;

/// Returns the total reaction about the origin of a ring in the plane z = 0 between the radii 20 and 50. The ring is
/// fixed at its inner edge.
fn reactions(traction: &str) -> [f64; 6] {
    let mut b = Bulk::shell(210_000.0, 0.3, 2.0);
    let n = 72;
    let ids: Vec<Vec<u32>> = (0..n)
        .map(|k| {
            let a = std::f64::consts::TAU * f64::from(k) / f64::from(n);
            (0..=6)
                .map(|r| {
                    let r = 20.0 + 5.0 * f64::from(r);
                    b.grid([r * a.cos(), r * a.sin(), 0.0])
                })
                .collect()
        })
        .collect();
    for k in 0..n as usize {
        let next = &ids[(k + 1) % n as usize];
        for r in 0..6 {
            b.quad([ids[k][r], ids[k][r + 1], next[r + 1], next[r]]);
        }
    }
    b.hold("123456", ids.iter().map(|r| r[0]));
    b.card("CORD2C,5,0,0.,0.,0.,0.,0.,1.,\n,1.,0.,0.\nCORD2S,6,0,0.,0.,0.,0.,0.,1.,\n,1.,0.,0.");
    b.card(&format!("PLOAD4,1,1,.5,,,,THRU,{},\n,{traction}", 6 * n));
    assert!(b.faults().is_empty(), "{:?}", b.faults());
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
    for i in 0..6 {
        let size = r.applied.iter().fold(1.0_f64, |a, v| a.max(v.abs()));
        assert!((r.total[i] + r.applied[i]).abs() < 1e-6 * size);
    }
    r.applied
}

#[test]
fn tractions_of_turned_systems_have_the_totals_of_their_integrals() {
    let pi = std::f64::consts::PI;
    let area = pi * (50.0_f64.powi(2) - 20.0_f64.powi(2));
    let moment = 2.0 * pi / 3.0 * (50.0_f64.powi(3) - 20.0_f64.powi(3));
    let p = 0.5;
    // The chords of 72 sides omit .13 % of the area and .25 % of the moment.
    let near = |what: &str, got: f64, expected: f64| {
        assert!(
            (got - expected).abs() < 3e-3 * p * moment.min(50.0 * area) / 50.0,
            "{what}: {got} for {expected}"
        );
    };
    // Traction along x in the basic system. The length of N does not matter.
    let f = reactions("0,3.,0.,0.");
    near("x", f[0], p * area);
    near("no z", f[2], 0.0);
    // A circumferential traction gives a torque and no force. A radial traction has no resultant.
    let f = reactions("5,0.,2.,0.");
    assert!(
        (f[5] / (p * moment) - 1.0).abs() < 4e-3,
        "{} for {}",
        f[5],
        p * moment
    );
    near("no force", f[0].hypot(f[1]), 0.0);
    let f = reactions("5,1.,0.,0.");
    assert!(f.iter().all(|v| v.abs() < 1e-6 * p * area), "{f:?}");
    // Spherical system: theta points down in the plane of the equator.
    let f = reactions("6,0.,1.,0.");
    near("-z", f[2], -p * area);
    // Half circumferential and half axial. The unit vectors depend on the position.
    let f = reactions("5,0.,1.,1.");
    near("z", f[2], p * area / 2.0_f64.sqrt());
    assert!(
        (f[5] / (p * moment / 2.0_f64.sqrt()) - 1.0).abs() < 4e-3,
        "{f:?}"
    );
}
