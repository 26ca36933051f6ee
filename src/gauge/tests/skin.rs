//! Sides in space: nearest skins, grids over shells whose normals oppose, grids longer than the part.

use super::*;

/// Reverses the corner order of every shell in `which`, which reverses its normal.
fn flip_normals(mut m: Model, which: &[usize]) -> Model {
    for &i in which {
        m.shells[i].grids.swap(1, 3);
        m.shells[i].grids.swap(5, 7);
    }
    m
}

/// Adds the shells of `other`. Its grids are moved by `by` and not joined to the grids of `m`.
fn with_plate(mut m: Model, other: Model, by: Vec3) -> Model {
    let first = m.grids.len() as u32;
    m.grids.extend(other.grids.into_iter().map(|g| Grid {
        id: g.id + first,
        x: g.x + by,
        ..g
    }));
    let id = m.shells.len() as u32;
    m.shells.extend(other.shells.into_iter().map(|s| Shell {
        id: s.id + id,
        grids: s.grids.map(|g| GridIx(g.0 + first)),
        ..s
    }));
    m
}

fn spec_at(x: [f64; 3]) -> GaugeSpec {
    GaugeSpec {
        place: GaugePlace::Nearest(Vec3::from(x)),
        direction: Some(Vec3::new(1.0, 1.0, 0.3)),
        ..GaugeSpec::place_on_shell("p", ShellIx(0))
    }
}

fn find_element_and_side(m: &Model, spec: &GaugeSpec) -> (u32, Surface) {
    let (g, _) = build(m, spec, CornerRows::Absent).unwrap();
    (g[0].element, g[0].surface)
}

#[test]
fn a_position_is_on_the_nearest_skin_whatever_the_offset_and_the_normal() {
    for zoffs in [-10.0, -1.0, 0.0, 1.0, 2.5, 10.0] {
        for turned in [false, true] {
            let mut m = plate(3, 1, 0);
            m.shells.iter_mut().for_each(|s| s.zoffs = zoffs);
            let (m, sign) = match turned {
                true => (flip_normals(m, &[0, 1, 2]), -1.0),
                false => (m, 1.0),
            };
            for (side, z) in [(Surface::Bottom, zoffs - 1.0), (Surface::Top, zoffs + 1.0)] {
                let spec = spec_at([13.0, 4.0, sign * z]);
                assert_eq!(
                    find_element_and_side(&m, &spec),
                    (2, side),
                    "{zoffs} {turned}"
                );
                let (_, findings) = build(&m, &spec, CornerRows::Absent).unwrap();
                assert!(findings[0].message.contains("0.0000 from the stated"));
            }
        }
    }
}

#[test]
fn the_nearest_of_close_plates_is_found_by_their_skins() {
    // Two plates of 2 mm. The skins of the first are at -1 and 1. The second has grids at 8 and skins at 2 and 4.
    let mut upper = plate(1, 1, 0);
    upper.shells[0].zoffs = -5.0;
    let m = with_plate(plate(1, 1, 0), upper, Vec3::z() * 8.0);
    for (z, expected) in [
        (-1.0, (1, Surface::Bottom)),
        (1.0, (1, Surface::Top)),
        (2.0, (2, Surface::Bottom)),
        (4.0, (2, Surface::Top)),
        (8.0, (2, Surface::Top)),
    ] {
        assert_eq!(
            find_element_and_side(&m, &spec_at([4.0, 5.0, z])),
            expected,
            "{z}"
        );
    }
    // Two plates on the same grids, one above and one below: their common face belongs to both, and the stated side decides.
    let [mut lower, mut upper] = [plate(1, 1, 0), plate(1, 1, 0)];
    (lower.shells[0].zoffs, upper.shells[0].zoffs) = (-1.0, 1.0);
    let m = with_plate(lower, upper, Vec3::zeros());
    for (side, element) in [(Surface::Top, 1), (Surface::Bottom, 2)] {
        let spec = GaugeSpec {
            surface: Some(side),
            ..spec_at([4.0, 5.0, 0.0])
        };
        assert_eq!(find_element_and_side(&m, &spec), (element, side));
    }
}

#[test]
fn next_to_a_web_the_skin_of_the_flange_is_found() {
    // A web in the plane y = 5. Its middle surface is nearer to the point than the middle surface of the flange below it.
    let mut web = plate(1, 1, 0);
    for g in &mut web.grids {
        g.x = Vec3::new(g.x.x, 5.0, g.x.y);
    }
    let m = with_plate(plate(1, 1, 0), web, Vec3::zeros());
    assert_eq!(
        find_element_and_side(&m, &spec_at([4.0, 4.5, 1.0])),
        (1, Surface::Top)
    );
    // The point inside the flange is nearer to a skin of the web than to a skin of the flange. A point on the middle surface belongs to that plate.
    assert_eq!(find_element_and_side(&m, &spec_at([4.0, 3.5, 0.0])).0, 1);
    // Normal of the web: x cross z = -y.
    assert_eq!(
        find_element_and_side(&m, &spec_at([4.0, 4.0, 3.0])),
        (2, Surface::Top)
    );
    assert_eq!(
        find_element_and_side(&m, &spec_at([4.0, 6.0, 3.0])),
        (2, Surface::Bottom)
    );
}

/// Returns a bending field: basic strain that changes its sign through the thickness and varies along x, and a membrane part.
fn bending_field(m: &Model, corners: CornerRows) -> CaseResult {
    let mut case = field(m, corners, |x, z| {
        E.map(|e| e * (0.2 + (1.0 + 0.01 * x.x) * z))
    });
    // `field` sorts fibres by their distance along the normal of each shell. This field needs the basic z.
    for (i, s) in m.shells.iter().enumerate() {
        if shell_axes(m, s, ShellPlace::Centre).unwrap()[(2, 2)] < 0.0 {
            case.shells.centre[i].swap(0, 1);
            if let Some(c) = case.shells.corners.get_mut(i) {
                c.iter_mut().for_each(|sides| sides.swap(0, 1));
            }
        }
    }
    case
}

#[test]
fn a_grid_over_turned_shells_keeps_its_side_in_space() {
    let wirings = [
        (Bridge::Quarter, None),
        (Bridge::HalfBending, None),
        (Bridge::Shear, None),
        (Bridge::Quarter, Some(Rosette::Delta)),
    ];
    for corners in [CornerRows::Present, CornerRows::Absent] {
        for (bridge, rosette) in wirings {
            for length in [8.0, 26.0, 44.0] {
                let spec = GaugeSpec {
                    grid_length: length,
                    direction: Some(Vec3::new(1.0, 0.2, 0.0)),
                    bridge,
                    rosette,
                    ..GaugeSpec::place_on_shell("g", ShellIx(22))
                };
                let of = |which: &[usize]| {
                    let m = flip_normals(plate(9, 5, 0), which);
                    read(&m, &spec, corners, &bending_field(&m, corners))
                };
                let plain = of(&[]);
                for which in [&[21, 23][..], &[20, 23, 25], &[13, 14, 30, 31, 32, 21]] {
                    for (a, b) in of(which).iter().zip(&plain) {
                        // Rounding of strains of 1e-3.
                        assert!((a - b).abs() < 1e-15, "{bridge:?} {length} {which:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_grid_over_a_step_of_thickness_stays_on_the_same_skin() {
    // Fibres are at 1 and 2.5, and pure bending strains each by its distance. Half of the grid is on each plate.
    let mut m = plate(2, 1, 0);
    let mut thick = m.shell_properties[0].clone();
    (thick.id, thick.z) = (2, [Some(-2.5), Some(2.5)]);
    m.shell_properties.push(thick);
    m.shells[1].property = ShellPropertyIx(1);
    m.shells[1].thickness = [5.0; 4];
    let mut case = field(&m, CornerRows::Absent, |_, z| [1e-6 * z, 0.0, 0.0]);
    case.shells.centre[1]
        .iter_mut()
        .flatten()
        .for_each(|v| *v *= 2.5);
    let spec = GaugeSpec {
        grid_length: 6.0,
        surface: Some(Surface::Bottom),
        direction: Some(Vec3::x()),
        ..spec_at([10.0, 5.0, -1.0])
    };
    // Centre rows alone vary linearly between centres, so that the strain at the edge is the mean of both.
    let m_turned = flip_normals(m.clone(), &[1]);
    let mut turned = case.clone();
    turned.shells.centre[1].swap(0, 1);
    for (m, case) in [(m, case), (m_turned, turned)] {
        let (gauges, _) = build(&m, &spec, CornerRows::Absent).unwrap();
        let got = gauge_reading(&gauges[0], &case).unwrap();
        assert!(got < -0.9e-6 && got > -2.6e-6, "{got}");
        let opposite = GaugeSpec {
            surface: Some(Surface::Top),
            ..spec.clone()
        };
        let (gauges, _) = build(&m, &opposite, CornerRows::Absent).unwrap();
        assert!((gauge_reading(&gauges[0], &case).unwrap() + got).abs() < 1e-18);
    }
}

#[test]
fn a_grid_that_is_longer_than_the_part_is_refused_and_one_over_the_edge_is_named() {
    let m = plate(3, 1, 0);
    let with = |length: f64, shell: u32, along: Vec3| {
        let spec = GaugeSpec {
            grid_length: length,
            direction: Some(along),
            ..GaugeSpec::place_on_shell("g", ShellIx(shell))
        };
        build(&m, &spec, CornerRows::Absent).map(|b| b.1)
    };
    // The plate is 30 by 10.
    for (length, shell, along, size) in [
        (1e6, 1, Vec3::x(), 30.0),
        (31.0, 1, Vec3::x(), 30.0),
        (31.0, 0, Vec3::x(), 30.0),
        (10.5, 1, Vec3::y(), 10.0),
    ] {
        let Err(GaugeError::GridBeyondPart {
            grid_length, part, ..
        }) = with(length, shell, along)
        else {
            panic!("{length} {shell}");
        };
        assert!(grid_length == length && (part - size).abs() < 1e-9);
    }
    for (length, shell, along) in [
        (30.0, 1, Vec3::x()),
        (10.0, 1, Vec3::y()),
        (10.0, 0, Vec3::x()),
        // The outermost point at which strain is taken is on the part.
        (10.4, 0, Vec3::x()),
        // The grid is far shorter than an element of this coarse mesh.
        (3.0, 2, Vec3::x()),
    ] {
        assert_eq!(with(length, shell, along).unwrap(), [], "{length} {shell}");
    }
    // The middle of the grid is 5 from the edge.
    let named = with(16.0, 0, Vec3::x()).unwrap();
    assert_eq!(named[0].code, "gauge-off-structure");
    assert_eq!(named[0].severity, Severity::Warning);
    assert!(named[0].message.contains("3.0000 past the edge"));
}

#[test]
fn a_grid_round_a_tube_is_no_longer_than_the_tube_is_wide() {
    // 36 flat shells round a tube of radius 50.
    let mut m = plate(36, 1, 0);
    for g in &mut m.grids {
        let turn = (10.0 * g.x.x / 10.0).to_radians();
        g.x = Vec3::new(50.0 * turn.cos(), 50.0 * turn.sin(), g.x.y);
    }
    let with = |length: f64| {
        let spec = GaugeSpec {
            grid_length: length,
            direction: Some(Vec3::y()),
            ..GaugeSpec::place_on_shell("g", ShellIx(18))
        };
        build(&m, &spec, CornerRows::Absent)
    };
    assert_eq!(with(30.0).unwrap().1, []);
    assert_eq!(with(100.0).unwrap().1, []);
    let far = with(1e6);
    assert!(matches!(far, Err(GaugeError::GridBeyondPart { part, .. }) if part < 100.0));
}

#[test]
fn the_second_pair_of_a_bridge_turns_with_its_axes() {
    let m = plate(2, 1, 0);
    let case = field(&m, CornerRows::Absent, |_, _| E);
    // The axes at the second place are turned by 90 degrees about z.
    let turn = Mat3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    for deg in [0.0_f64, 30.0] {
        let spec = GaugeSpec {
            bridge: Bridge::HalfBending,
            direction: Some(Vec3::x()),
            angle_rad: deg.to_radians(),
            pair: Some(Pair {
                turn,
                ..Pair::with_parallel_axis(ShellIx(1), Surface::Top)
            }),
            ..GaugeSpec::place_on_shell("h", ShellIx(0))
        };
        let expected =
            strain_along(E, deg.to_radians()) - strain_along(E, (deg + 90.0).to_radians());
        let got = read(&m, &spec, CornerRows::Absent, &case)[0];
        assert!((got - expected).abs() < 1e-15, "{deg}: {got}");
    }
}

#[test]
fn a_leg_of_a_rosette_can_be_turned_alone() {
    let m = plate(1, 1, 0);
    let case = field(&m, CornerRows::Absent, |_, _| E);
    let spec = GaugeSpec {
        leg_turns_rad: [0.0, 0.1, 0.0],
        ..rectangular()
    };
    let legs = read(&m, &spec, CornerRows::Absent, &case);
    let turned = std::f64::consts::FRAC_PI_4 + 0.1;
    assert!((legs[1] - strain_along(E, turned)).abs() < 1e-15);
    assert!((legs[0] - E[0]).abs() < 1e-15 && (legs[2] - E[1]).abs() < 1e-15);
}

#[test]
fn a_grid_on_a_bar_is_no_longer_than_the_straight_bars_along_it() {
    // Three bars of 10 along x and one that turns off.
    let mut m = plate(3, 1, 0);
    for (id, [a, b]) in [[0, 1], [2, 1], [2, 3], [3, 7]].into_iter().enumerate() {
        m.beams.push(bar(id as u32 + 1, [a, b]));
    }
    for (length, fits) in [(6.0, true), (30.0, true), (31.0, false), (1e6, false)] {
        let spec = GaugeSpec {
            place: GaugePlace::Beam {
                beam: BeamIx(1),
                point: 0,
                station: 0.5,
            },
            grid_length: length,
            ..GaugeSpec::place_on_shell("b", ShellIx(0))
        };
        let got = build(&m, &spec, CornerRows::Absent);
        assert_eq!(got.is_ok(), fits, "{length}: {got:?}");
    }
}

#[test]
fn only_shells_that_are_about_parallel_have_an_opposite_side() {
    let mut web = plate(1, 1, 0);
    for g in &mut web.grids {
        g.x = Vec3::new(g.x.x, 5.0, g.x.y);
    }
    let m = with_plate(plate(1, 1, 0), web, Vec3::zeros());
    let from = (ShellIx(0), Surface::Top);
    assert_eq!(away_from(&m, from, ShellIx(1)), None);
    assert_eq!(away_from(&m, from, ShellIx(0)), Some(Surface::Bottom));
    let m = with_plate(
        plate(1, 1, 0),
        flip_normals(plate(1, 1, 0), &[0]),
        Vec3::z(),
    );
    assert_eq!(away_from(&m, from, ShellIx(1)), Some(Surface::Top));
}
