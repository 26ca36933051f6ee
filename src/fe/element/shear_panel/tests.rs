use super::*;
use crate::model::{Grid, Material, MaterialIx, PointKind};

fn model(x: [[f64; 3]; 4], f1: f64) -> Model {
    let mut m = Model::default();
    for (i, x) in x.iter().enumerate() {
        m.grids.push(Grid {
            id: i as u32 + 1,
            kind: PointKind::Grid,
            x: Vec3::from(*x),
            cd: crate::model::FrameIx(0),
            ps: Default::default(),
            at: Default::default(),
        });
    }
    m.materials.push(Material {
        id: 1,
        kind: MaterialKind::Isotropic {
            e: 70_000.0,
            g: 27_000.0,
            nu: 0.3,
            alpha: 0.0,
        },
        rho: 2.0,
        tref: 0.0,
        at: Default::default(),
    });
    m.shear_panels.push(ShearPanel {
        id: 1,
        grids: [0, 1, 2, 3].map(crate::model::GridIx),
        material: MaterialIx(0),
        t: 1.5,
        nsm: 0.5,
        f1,
        f2: 0.0,
        at: Default::default(),
    });
    m
}

const SKEW: [[f64; 3]; 4] = [
    [0., 0., 1.],
    [90., 10., 0.],
    [80., 70., 3.],
    [-5., 55., -1.],
];

#[test]
fn a_rectangle_sheared_stores_half_g_gamma_squared_in_its_volume() {
    let m = model(
        [[0., 0., 0.], [90., 0., 0.], [90., 40., 0.], [0., 40., 0.]],
        0.0,
    );
    let k = shear_panel_stiffness(&m, 0).unwrap();
    let gamma = 1e-3;
    let mut u = [0.0; 24];
    (u[12], u[18]) = (gamma * 40.0, gamma * 40.0);
    let f = k.times(&u);
    let energy: f64 = f.iter().zip(&u).map(|(f, u)| f * u).sum();
    let exact = 27_000.0 * gamma * gamma * 90.0 * 40.0 * 1.5;
    assert!((energy / exact - 1.0).abs() < 1e-12, "{energy} for {exact}");
}

#[test]
fn no_rigid_motion_of_a_flat_panel_is_resisted_and_it_has_one_stiffness() {
    let mut flat = SKEW;
    flat.iter_mut()
        .for_each(|x| x[2] = 0.02 * x[0] - 0.3 * x[1]);
    for f1 in [0.0, 1.0] {
        let m = model(flat, f1);
        let k = shear_panel_stiffness(&m, 0).unwrap();
        let largest = k.values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        for mode in 0..6 {
            let mut u = [0.0; 24];
            for (g, at) in m.grids.iter().zip((0..24).step_by(6)) {
                let mut t = Vec3::zeros();
                t[mode % 3] = 1.0;
                let v = if mode < 3 { t } else { t.cross(&g.x) / 100.0 };
                (0..3).for_each(|i| u[at + i] = v[i]);
            }
            for f in k.times(&u) {
                assert!(f.abs() < 1e-10 * largest, "mode {mode}: {f:e}");
            }
        }
    }
}

#[test]
fn nearly_parallel_sides_give_the_flexibility_of_parallel_ones() {
    // The formulas must agree on both sides of the limit of parallelism.
    let near = |tilt: f64| {
        let x = [
            [0., 0., 0.],
            [90., 0., 0.],
            [80., 60., 0.],
            [15., 60. + tilt, 0.],
        ]
        .map(Vec3::from);
        Plane::new(&x).unwrap().flexibility(0.3)
    };
    let (parallel, almost) = (near(0.0), near(0.02));
    // The tilt changes the height by 3e-4.
    assert!(
        (almost / parallel - 1.0).abs() < 2e-3,
        "{almost} for {parallel}"
    );
}

#[test]
fn the_mass_is_that_of_the_sheet_and_its_cover() {
    let m = model(
        [[0., 0., 0.], [90., 0., 0.], [90., 40., 0.], [0., 40., 0.]],
        0.0,
    );
    let sum: f64 = shear_panel_mass(&m, 0).iter().sum();
    assert!((sum - 3600.0 * (2.0 * 1.5 + 0.5)).abs() < 1e-9);
}
