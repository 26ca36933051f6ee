mod skin;

use super::*;
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::fe::{BeamField, CaseResult, ShellField};
use crate::finding::Severity;
use crate::model::*;
use nastran::cards::ShellShape;
use nastran::place::Place;
use std::sync::Arc;

/// Returns `nx` x `ny` squares of side 10 in the xy plane, numbered from 1 along x, with half thickness 1.
///
/// The corners of element 1 start at number `start`, which rotates its frame by quarter turns.
fn plate(nx: u32, ny: u32, start: usize) -> Model {
    let at = Place::default();
    let mut m = Model::default();
    for j in 0..=ny {
        for i in 0..=nx {
            let x = Vec3::new(10.0 * f64::from(i), 10.0 * f64::from(j), 0.0);
            m.grids.push(Grid {
                id: 1 + j * (nx + 1) + i,
                kind: crate::model::PointKind::Grid,
                x,
                cd: FrameIx(0),
                ps: Default::default(),
                at,
            });
        }
    }
    for j in 0..ny {
        for i in 0..nx {
            let g = j * (nx + 1) + i;
            let mut corners = [g, g + 1, g + nx + 2, g + nx + 1].map(GridIx);
            if m.shells.is_empty() {
                corners.rotate_left(start);
            }
            m.shells.push(Shell {
                id: 1 + j * nx + i,
                shape: ShellShape::Quad4,
                grids: [
                    corners[0], corners[1], corners[2], corners[3], corners[0], corners[1],
                    corners[2], corners[3],
                ],
                property: ShellPropertyIx(0),
                material_angle_rad: 0.0,
                zoffs: 0.0,
                thickness: [2.0; 4],
                at,
            });
        }
    }
    m.shell_properties.push(ShellProperty {
        id: 1,
        kind: ShellKind::Homogeneous {
            t: 2.0,
            membrane: None,
            bending: None,
            plane_strain: false,
            shear: None,
            coupling: None,
            bending_ratio: 1.0,
            shear_ratio: 0.833_333,
        },
        nsm: 0.0,
        z: [Some(-1.0), Some(1.0)],
        at,
    });
    m
}

/// Returns a case whose field is the basic tensor (exx, eyy, exy tensor shear) at a place and fibre z.
fn field(m: &Model, corners: CornerRows, e: impl Fn(Vec3, f64) -> [f64; 3]) -> CaseResult {
    let local = |shell: &Shell, place: ShellPlace, x: Vec3, z: f64| {
        let [exx, eyy, exy] = e(x, z);
        let r = shell_axes(m, shell, place).unwrap();
        let t = r * Mat3::new(exx, exy, 0.0, exy, eyy, 0.0, 0.0, 0.0, 0.0) * r.transpose();
        [t[(0, 0)], t[(1, 1)], 2.0 * t[(0, 1)]]
    };
    let mut f = ShellField {
        elements: Arc::new((0..m.shells.len() as u32).map(ShellIx).collect()),
        ..Default::default()
    };
    for s in &m.shells {
        let c = centre(m, s).unwrap();
        f.centre
            .push([-1.0, 1.0].map(|z| local(s, ShellPlace::Centre, c, z)));
        if corners == CornerRows::Present {
            f.corners.push(std::array::from_fn(|i| {
                [-1.0, 1.0].map(|z| local(s, ShellPlace::Corner(i), m.grids[s.grids[i].us()].x, z))
            }));
        }
    }
    CaseResult {
        subcase: 1,
        shells: f,
        ..Default::default()
    }
}

fn read(m: &Model, spec: &GaugeSpec, corners: CornerRows, case: &CaseResult) -> Vec<f64> {
    build(m, spec, corners)
        .unwrap()
        .0
        .iter()
        .map(|g| gauge_reading(g, case).unwrap())
        .collect()
}

/// Returns the strain of a basic tensor along the angle t.
fn strain_along(e: [f64; 3], t: f64) -> f64 {
    let (s, c) = t.sin_cos();
    e[0] * c * c + e[1] * s * s + 2.0 * e[2] * s * c
}

const E: [f64; 3] = [300e-6, -100e-6, 70e-6];

#[test]
fn a_quarter_gauge_reads_the_strain_along_its_direction_however_the_element_is_numbered() {
    for start in 0..4 {
        let m = plate(2, 1, start);
        let case = field(&m, CornerRows::Absent, |_, _| E);
        for deg in [0.0_f64, 15.0, 45.0, 90.0, 130.0] {
            let spec = GaugeSpec {
                direction: Some(Vec3::new(2.0, 0.0, 5.0)),
                angle_rad: deg.to_radians(),
                ..GaugeSpec::place_on_shell("a", ShellIx(0))
            };
            let got = read(&m, &spec, CornerRows::Absent, &case)[0];
            assert!(
                (got - strain_along(E, deg.to_radians())).abs() < 1e-15,
                "{start} {deg}: {got}"
            );
        }
    }
}

#[test]
fn the_angle_turns_about_the_element_normal_on_the_bottom_as_well() {
    let m = plate(1, 1, 0);
    let case = field(&m, CornerRows::Absent, |_, _| E);
    let spec = GaugeSpec {
        direction: Some(Vec3::x()),
        angle_rad: 0.5,
        surface: Some(Surface::Bottom),
        ..GaugeSpec::place_on_shell("a", ShellIx(0))
    };
    assert!((read(&m, &spec, CornerRows::Absent, &case)[0] - strain_along(E, 0.5)).abs() < 1e-15);
    let g = &build(&m, &spec, CornerRows::Absent).unwrap().0[0];
    assert!(
        (g.angle_rad - 0.5).abs() < 1e-12
            && (g.position - Vec3::new(5.0, 5.0, -1.0)).norm() < 1e-12
    );
}

#[test]
fn bridges_are_signed_sums_over_their_factor() {
    let m = plate(2, 1, 1);
    // Axial strain 100, bending +-40 at the surfaces, shear gxy = 2 x 30.
    let case = field(&m, CornerRows::Absent, |_, z| {
        [100e-6 + 40e-6 * z, 0.0, 30e-6]
    });
    let spec = GaugeSpec {
        direction: Some(Vec3::x()),
        ..GaugeSpec::place_on_shell("a", ShellIx(0))
    };
    let with = |bridge| {
        read(
            &m,
            &GaugeSpec {
                bridge,
                ..spec.clone()
            },
            CornerRows::Absent,
            &case,
        )[0] * 1e6
    };
    assert!((with(Bridge::Quarter) - 140.0).abs() < 1e-9);
    assert!(
        (with(Bridge::HalfBending) - 80.0).abs() < 1e-9,
        "top less bottom"
    );
    assert!(
        (with(Bridge::FullBending) - 160.0).abs() < 1e-9,
        "twice that: four times the bending strain"
    );
    assert!(
        (with(Bridge::Shear) - 60.0).abs() < 1e-9,
        "engineering shear"
    );
    let both = GaugeSpec {
        bridge: Bridge::Shear,
        pair: Some(Pair::with_parallel_axis(ShellIx(1), Surface::Bottom)),
        ..spec.clone()
    };
    assert!((read(&m, &both, CornerRows::Absent, &case)[0] * 1e6 - 120.0).abs() < 1e-9);
    let two = GaugeSpec {
        bridge: Bridge::FullBending,
        bridge_factor: 4.0,
        ..spec
    };
    assert!((read(&m, &two, CornerRows::Absent, &case)[0] * 1e6 - 40.0).abs() < 1e-9);
}

/// Returns a rectangular rosette on the first element with leg a along x.
fn rectangular() -> GaugeSpec {
    GaugeSpec {
        direction: Some(Vec3::x()),
        rosette: Some(Rosette::Rectangular),
        ..GaugeSpec::place_on_shell("R", ShellIx(0))
    }
}

#[test]
fn rosettes_give_three_legs_that_hold_the_whole_tensor() {
    let m = plate(1, 1, 2);
    let case = field(&m, CornerRows::Absent, |_, _| E);
    let spec = rectangular();
    let names: Vec<String> = build(&m, &spec, CornerRows::Absent)
        .unwrap()
        .0
        .into_iter()
        .map(|g| g.name)
        .collect();
    assert_eq!(names, ["R.a", "R.b", "R.c"]);
    let r = read(&m, &spec, CornerRows::Absent, &case);
    assert!((r[0] - E[0]).abs() < 1e-15 && (r[2] - E[1]).abs() < 1e-15);
    assert!(
        (2.0 * r[1] - r[0] - r[2] - 2.0 * E[2]).abs() < 1e-15,
        "gxy = 2 b - a - c"
    );
    let d = read(
        &m,
        &GaugeSpec {
            rosette: Some(Rosette::Delta),
            ..spec
        },
        CornerRows::Absent,
        &case,
    );
    assert!(
        ((2.0 * d[1] + 2.0 * d[2] - d[0]) / 3.0 - E[1]).abs() < 1e-15,
        "eyy = (2 b + 2 c - a) / 3"
    );
}

#[test]
fn a_position_is_interpolated_from_corner_rows_and_falls_back_to_the_centre() {
    let m = plate(3, 1, 0);
    let linear = |x: Vec3, _: f64| [1e-6 * x.x, 0.0, 0.0];
    let spec = GaugeSpec {
        place: GaugePlace::Nearest(Vec3::new(13.0, 4.0, 6.0)),
        direction: Some(Vec3::x()),
        ..GaugeSpec::place_on_shell("p", ShellIx(0))
    };
    let (g, findings) = build(&m, &spec, CornerRows::Present).unwrap();
    assert_eq!((g[0].element, g[0].surface), (2, Surface::Top));
    assert_eq!(findings[0].code, "gauge-at-nearest-surface");
    for (off, severity) in [(40.0, Severity::Warning), (4000.0, Severity::Error)] {
        let far = GaugeSpec {
            place: GaugePlace::Nearest(Vec3::new(13.0, 4.0, off)),
            ..spec.clone()
        };
        let (_, findings) = build(&m, &far, CornerRows::Present).unwrap();
        assert_eq!(
            (findings[0].code, findings[0].severity),
            ("gauge-off-structure", severity)
        );
    }
    let corner = read(
        &m,
        &spec,
        CornerRows::Present,
        &field(&m, CornerRows::Present, linear),
    )[0];
    assert!((corner - 13e-6).abs() < 1e-15, "{corner}");
    let at_centre = read(
        &m,
        &spec,
        CornerRows::Absent,
        &field(&m, CornerRows::Absent, linear),
    )[0];
    assert!((at_centre - 15e-6).abs() < 1e-15);
    let below = GaugeSpec {
        place: GaugePlace::Nearest(Vec3::new(13.0, 4.0, -2.0)),
        ..spec
    };
    assert_eq!(
        build(&m, &below, CornerRows::Absent).unwrap().0[0].surface,
        Surface::Bottom
    );
}

#[test]
fn a_grid_averages_over_its_length() {
    let m = plate(9, 3, 0);
    let middle = ShellIx(13);
    let spec = GaugeSpec {
        direction: Some(Vec3::x()),
        grid_length: 6.0,
        ..GaugeSpec::place_on_shell("g", middle)
    };
    let linear = |x: Vec3, _: f64| [1e-6 * x.x, 0.0, 0.0];
    for corners in [CornerRows::Present, CornerRows::Absent] {
        let got = read(&m, &spec, corners, &field(&m, corners, linear))[0];
        assert!(
            (got - 45e-6).abs() < 1e-15,
            "a linear field averages to its middle: {got}"
        );
    }
    // The position is off the centre and the grid is across two elements. The field is still linear, so that the mean is the value at the middle.
    let off = GaugeSpec {
        place: GaugePlace::Nearest(Vec3::new(48.0, 15.0, 1.0)),
        ..spec.clone()
    };
    let got = read(
        &m,
        &off,
        CornerRows::Present,
        &field(&m, CornerRows::Present, linear),
    )[0];
    assert!((got - 48e-6).abs() < 1e-15, "{got}");
    // The field `(x - 45)^2` at the corners is 25 at both ends of the middle element, so it is constant in this element.
    let long = GaugeSpec {
        grid_length: 30.0,
        ..spec
    };
    let square = field(&m, CornerRows::Present, |x, _| {
        [1e-8 * (x.x - 45.0).powi(2), 0.0, 0.0]
    });
    let mean = read(&m, &long, CornerRows::Present, &square)[0];
    // At 5 and 15 from the middle, the corner values are 25 and 225. The bilinear field is 25 up to 5, then 25 + 20 (d - 5). The rule is
    // Gauss-Legendre with five points (Abramowitz and Stegun, table 25.4) over +-15. Its middle point takes the centre row of the shell, which is 0
    // here.
    let ridge = |d: f64| 25.0 + 20.0 * (d.abs() - 5.0).max(0.0);
    let rule = [
        (0.0, 0.568_888_888_9),
        (0.538_469_310_1, 0.478_628_670_5),
        (0.906_179_845_9, 0.236_926_885_1),
    ];
    let expected: f64 = rule
        .iter()
        .map(|(x, w)| if *x == 0.0 { 0.0 } else { w * ridge(15.0 * x) })
        .sum();
    assert!(
        (mean - 1e-8 * expected).abs() < 1e-9 * mean,
        "{mean} against {expected}e-8"
    );
}

#[test]
fn transverse_sensitivity_reads_the_correct_strain_on_the_makers_bar() {
    let m = plate(1, 1, 0);
    let spec = GaugeSpec {
        direction: Some(Vec3::x()),
        transverse_sensitivity: 0.03,
        ..GaugeSpec::place_on_shell("k", ShellIx(0))
    };
    let bar = field(&m, CornerRows::Absent, |_, _| {
        [200e-6, -0.285 * 200e-6, 0.0]
    });
    assert!((read(&m, &spec, CornerRows::Absent, &bar)[0] - 200e-6).abs() < 1e-15);
    let biaxial = field(&m, CornerRows::Absent, |_, _| [200e-6, 200e-6, 0.0]);
    let expected = 200e-6 * 1.03 / (1.0 - 0.285 * 0.03);
    assert!((read(&m, &spec, CornerRows::Absent, &biaxial)[0] - expected).abs() < 1e-15);
}

#[test]
fn a_direction_normal_to_the_surface_is_refused() {
    let m = plate(1, 1, 0);
    let spec = GaugeSpec {
        direction: Some(Vec3::z()),
        ..GaugeSpec::place_on_shell("n", ShellIx(0))
    };
    assert!(matches!(
        build(&m, &spec, CornerRows::Absent),
        Err(GaugeError::NormalDirection { element: 1, .. })
    ));
}

fn bar(id: u32, grids: [u32; 2]) -> Beam {
    Beam {
        id,
        is_beam: false,
        grids: grids.map(GridIx),
        property: BeamPropertyIx(0),
        offsets: [Vec3::zeros(); 2],
        axes: Mat3::identity(),
        pins: Default::default(),
        warping: None,
        idle_points: false,
        at: Place::default(),
    }
}

#[test]
fn a_gauge_on_a_bar_reads_at_its_recovery_point_and_station() {
    let mut m = plate(1, 1, 0);
    m.beams.push(bar(7, [0, 1]));
    let case = CaseResult {
        beams: BeamField {
            elements: Arc::new(vec![BeamIx(0)]),
            stations: vec![vec![
                (0.0, [1e-6, 2e-6, -1e-6, 0.0]),
                (1.0, [3e-6, 2e-6, -3e-6, 0.0]),
            ]],
            // The axial strain differs from the mean of the four recovery points.
            axial: vec![vec![1e-7, 3e-7]],
            ..Default::default()
        },
        ..Default::default()
    };
    let at = |point, station, bridge| {
        let place = GaugePlace::Beam {
            beam: BeamIx(0),
            point,
            station,
        };
        read(
            &m,
            &GaugeSpec {
                place,
                bridge,
                ..GaugeSpec::place_on_shell("b", ShellIx(0))
            },
            CornerRows::Absent,
            &case,
        )[0]
    };
    assert!((at(0, 0.0, Bridge::Quarter) - 1e-6).abs() < 1e-18);
    assert!((at(0, 0.25, Bridge::Quarter) - 1.5e-6).abs() < 1e-18);
    assert!((at(2, 1.0, Bridge::Quarter) + 3e-6).abs() < 1e-18);
    // The bending strain changes its sign across the neutral axis. A half bridge reads it twice, a full bridge four times.
    assert!((at(0, 0.0, Bridge::HalfBending) - 2.0 * 0.9e-6).abs() < 1e-18);
    assert!((at(0, 0.5, Bridge::FullBending) - 4.0 * (2e-6 - 2e-7)).abs() < 1e-18);
    // Recovery points have only the strain along the axis. A gauge across the axis was formerly read along it.
    let along = GaugeSpec {
        place: GaugePlace::Beam {
            beam: BeamIx(0),
            point: 0,
            station: 0.0,
        },
        direction: Some(Vec3::new(-2.0, 0.0, 0.0)),
        angle_rad: std::f64::consts::PI,
        ..GaugeSpec::place_on_shell("b", ShellIx(0))
    };
    assert!(build(&m, &along, CornerRows::Absent).is_ok());
    let across = [
        GaugeSpec {
            bridge: Bridge::Shear,
            ..along.clone()
        },
        GaugeSpec {
            rosette: Some(Rosette::Rectangular),
            ..along.clone()
        },
        GaugeSpec {
            angle_rad: std::f64::consts::FRAC_PI_4,
            ..along.clone()
        },
        GaugeSpec {
            direction: Some(Vec3::y()),
            ..along.clone()
        },
        GaugeSpec {
            pair: Some(Pair::with_parallel_axis(ShellIx(0), Surface::Top)),
            ..along
        },
    ];
    for spec in across {
        let got = build(&m, &spec, CornerRows::Absent);
        assert!(
            matches!(got, Err(GaugeError::AcrossBeam { element: 7, .. })),
            "{spec:?}"
        );
    }
}

#[test]
fn a_gauge_on_the_refined_mesh_reads_the_same_even_strain_and_the_same_mean_of_a_linear_one() {
    for start in 0..4 {
        let m = plate(2, 2, start);
        let fine = m.refine_shells().unwrap();
        let even = field(&fine.model, CornerRows::Absent, |_, _| E);
        let linear = |x: Vec3, z: f64| E.map(|e| e * (1.0 + 0.03 * x.x - 0.02 * x.y) * z);
        let bent = field(&fine.model, CornerRows::Absent, linear);
        for bridge in [Bridge::Quarter, Bridge::Shear] {
            let spec = GaugeSpec {
                direction: Some(Vec3::new(1.0, 0.4, 0.0)),
                surface: Some(Surface::Bottom),
                bridge,
                ..GaugeSpec::place_on_shell("a", ShellIx(0))
            };
            let (coarse, _) = build(&m, &spec, CornerRows::Absent).unwrap();
            let on = on_refined(&coarse[0], &m, &fine).unwrap();
            let same = read(
                &m,
                &spec,
                CornerRows::Absent,
                &field(&m, CornerRows::Absent, |_, _| E),
            );
            assert!((gauge_reading(&on, &even).unwrap() - same[0]).abs() < 1e-15);
            let same = read(
                &m,
                &spec,
                CornerRows::Absent,
                &field(&m, CornerRows::Absent, linear),
            );
            assert!((gauge_reading(&on, &bent).unwrap() - same[0]).abs() < 1e-15);
        }
    }
}

#[test]
fn a_moved_gauge_reads_the_slope_of_a_linear_field_along_the_way_it_moves() {
    let m = plate(3, 3, 0);
    let slope = |x: Vec3, _: f64| E.map(|e| e * (0.03 * x.x - 0.02 * x.y));
    let case = field(&m, CornerRows::Absent, slope);
    // The middle shell of nine has neighbours on all sides.
    let spec = GaugeSpec {
        direction: Some(Vec3::x()),
        ..GaugeSpec::place_on_shell("a", ShellIx(4))
    };
    let (gauges, _) = build(&m, &spec, CornerRows::Absent).unwrap();
    for (way, expected) in [(Vec3::x(), 0.03), (Vec3::y(), -0.02), (-Vec3::x(), -0.03)] {
        let change =
            gauge_reading(&strain_gradient_gauge(&gauges[0], &m, way).unwrap(), &case).unwrap();
        assert!((change - E[0] * expected).abs() < 1e-12, "{way}: {change}");
    }
}

#[test]
fn a_gauge_at_a_free_edge_has_the_slope_of_a_linear_field_as_one_inside_has() {
    let m = plate(3, 3, 0);
    // Strain along x, in microstrain, with slopes of 2 along x and -5 along y. The gauges read along x.
    let case = field(&m, CornerRows::Present, |x, _| {
        [2.0 * x.x - 5.0 * x.y, 0.0, 0.0]
    });
    let corner = CornerRows::Present;
    for at in [
        [15.0, 15.0],
        [0.0, 15.0],
        [30.0, 15.0],
        [12.0, 0.0],
        [0.0, 30.0],
        // This gauge is nearer to the edge than the step.
        [1.0, 29.0],
    ] {
        let spec = GaugeSpec {
            place: GaugePlace::Nearest(Vec3::new(at[0], at[1], 1.0)),
            surface: Some(Surface::Top),
            direction: Some(Vec3::x()),
            ..GaugeSpec::place_on_shell("g", ShellIx(0))
        };
        let (gauges, _) = build(&m, &spec, corner).unwrap();
        let drawn = NominalGauge::new(&m, &spec, &gauges[0], corner, 20.0).unwrap();
        let read = |g: &Gauge| Some(vec![gauge_reading(g, &case)?]);
        let along = drawn.slope(Offset::shift_along, 3.0, read).unwrap();
        let across = drawn.slope(Offset::shift_across, 3.0, read).unwrap();
        // Round-off of strain of about 100 over a step of 1.
        assert!((along[0] - 2.0).abs() < 1e-9, "{at:?}: {along:?}");
        assert!((across[0] + 5.0).abs() < 1e-9, "{at:?}: {across:?}");
    }
}
