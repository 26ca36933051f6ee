//! Compares the consistent mass of shells and beams (PARAM,COUPMASS) with closed forms.

use crate::mesh::{Bulk, assert_near, free_modes, mass_of};

#[test]
fn the_coupled_mass_of_one_plate_turns_as_the_plate_itself() {
    // Rigid motions are exact: m (a^2 + b^2) / 12 about the centre. Four lumped corner masses give three times as much.
    let (a, b, t, rho) = (30.0, 20.0, 2.0, 7.85e-9);
    let mut bulk = Bulk::default();
    bulk.card("PARAM,COUPMASS,1");
    bulk.card("MAT1,1,210000.,,.3,7.85-9");
    bulk.card("PSHELL,1,1,2.0,1,,1");
    bulk.patch(1, 1, |u, v| [a * u, b * v, 5.0]);
    let p = mass_of(&bulk.model());
    let m = rho * a * b * t;
    assert_near("mass", p.mass, m, 1e-12);
    assert_near(
        "about the normal",
        p.matrix[(5, 5)],
        m * (a * a + b * b) / 12.0,
        1e-9,
    );
    assert_near("across", p.matrix[(3, 3)], m * b * b / 12.0, 1e-9);
    assert_near("centre of gravity", p.cg.z, 5.0, 1e-12);
}

#[test]
fn triangles_and_offsets_keep_mass_and_centre() {
    let mut bulk = Bulk::default();
    bulk.card("PARAM,COUPMASS,1");
    bulk.card("MAT1,1,210000.,,.3,7.85-9");
    bulk.card("PSHELL,1,1,2.0,1,,1");
    let g = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 60.0, 0.0]].map(|x| bulk.grid(x));
    bulk.card(&format!("CTRIA3,1,1,{},{},{},0.0,4.0", g[0], g[1], g[2]));
    let p = mass_of(&bulk.model());
    let m = 7.85e-9 * 2.0 * 0.5 * 30.0 * 60.0;
    assert_near("mass", p.mass, m, 1e-12);
    assert_near("x", p.cg.x, 10.0, 1e-9);
    assert_near("y", p.cg.y, 20.0, 1e-9);
    assert_near("z", p.cg.z, 4.0, 1e-9);
    // A triangle about an axis through its centroid and parallel to a side: m h^2 / 18.
    assert_near("inertia", p.matrix[(3, 3)], m * 60.0 * 60.0 / 18.0, 1e-9);
}

#[test]
fn eight_beams_with_coupled_mass_have_the_first_frequencies_of_the_free_beam() {
    let mut b = Bulk::default();
    b.card("PARAM,COUPMASS,1");
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let n = 8;
    let g: Vec<u32> = (0..=n)
        .map(|i| b.grid([250.0 * f64::from(i), 0.0, 0.0]))
        .collect();
    for i in 0..n as usize {
        b.card(&format!("CBAR,{},2,{},{},0.,1.,0.", i + 1, g[i], g[i + 1]));
    }
    let modes = free_modes(&b.model(), None, 3).modes;
    // Euler: f = (k L)^2 / L^2 sqrt(E I / (rho A)) / 2 pi with k L = 4.73004, 7.8532.
    let exact = |kl: f64, i: f64| {
        kl * kl / (2000.0_f64 * 2000.0) * (210_000.0 * i / (7.85e-9 * 200.0)).sqrt()
            / std::f64::consts::TAU
    };
    let expected = [
        exact(4.73004, 4000.0),
        exact(4.73004, 9000.0),
        exact(7.8532, 4000.0),
    ];
    for (mode, expected) in modes.iter().zip(expected) {
        // A consistent mass gives frequencies that are too high by the share (k L / n)^4 / 720.
        assert_near("frequency", mode.frequency, expected, 2e-3);
        assert!(mode.frequency > 0.9999 * expected);
    }
}
