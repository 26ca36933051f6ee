//! The structures: a ladder frame of plates, bars, a bush, RBE3s and a mass, and a flat plate.
//!
//! They have no symmetry, so that no two layouts of gauges are equally good.

use crate::frame::{Bush, Frame, Gauge, Grid, Kind, Load, MM_T_S, Mass, Seat, Shell, System, V};
use nalgebra::Matrix3;

fn grid(tag: u32, x: [f64; 3]) -> Grid {
    Grid {
        tag,
        x: x.into(),
        cp: 0,
        cd: 0,
    }
}

fn quad(tag: u32, property: u32, corners: [u32; 4]) -> Shell {
    Shell {
        tag,
        property,
        corners: corners.to_vec(),
        flipped: false,
    }
}

fn load(name: &'static str, grid: u32, direction: [f64; 3]) -> Load {
    Load {
        name,
        grid,
        direction: direction.into(),
        moment: false,
        system: 0,
        applied: 1.0,
        expected: 1000.0,
    }
}

/// Returns a gauge on a shell.
fn gauge(frame: &Frame, name: &str, tag: u32, top: bool, direction: [f64; 3]) -> Gauge {
    Gauge {
        name: name.to_owned(),
        seat: Seat::Shell { tag, top },
        at: frame.centre(tag),
        shell: tag,
        direction: direction.into(),
        angle_deg: 0.0,
        system: 0,
        bridge: None,
        rosette: false,
        grid_length: 0.0,
    }
}

/// Returns a gauge at a point of the skin: `share` of the distance from the centre of the shell to its first corner.
fn at_point(frame: &Frame, name: &str, tag: u32, top: bool, share: f64) -> Gauge {
    let centre = frame.centre(tag);
    let foot = centre + share * (frame.x(frame.shell(tag).corners[0]) - centre);
    let property = frame.shell(tag).property;
    let (_, t) = frame.properties.iter().find(|p| p.0 == property).unwrap();
    let side = if top { 0.5 } else { -0.5 };
    let x = foot + frame.shell_normal(tag) * (t * side + frame.offset);
    Gauge {
        seat: Seat::Point(x),
        at: x,
        ..gauge(frame, name, tag, top, [1.0, 0.3, 0.2])
    }
}

fn empty_frame() -> Frame {
    Frame {
        units: MM_T_S,
        grids: Vec::new(),
        shells: Vec::new(),
        properties: Vec::new(),
        bars: Vec::new(),
        bushes: Vec::new(),
        spreads: Vec::new(),
        masses: Vec::new(),
        // System 1 is the basic frame, which rotates with the model. System 2 has reversed x and z. Systems 3 and 4 are
        // oblique.
        systems: vec![
            system(Kind::Rectangular, [0.0; 3], Matrix3::identity()),
            system(
                Kind::Rectangular,
                [10.0, -5.0, 0.0],
                Matrix3::from_diagonal(&V::new(-1.0, 1.0, -1.0)),
            ),
            system(Kind::Cylindrical, [-120.0, 40.0, -70.0], oblique_rotation()),
            system(Kind::Spherical, [-90.0, -700.0, 310.0], oblique_rotation()),
        ],
        held: Vec::new(),
        forces: Vec::new(),
        loads: Vec::new(),
        gauges: Vec::new(),
        turn: Matrix3::identity(),
        offset: 0.0,
        ids: (0, 1),
        reversed_tables: false,
    }
}

fn system(kind: Kind, origin: [f64; 3], axes: Matrix3<f64>) -> System {
    System {
        kind,
        origin: origin.into(),
        axes,
    }
}

/// Returns a rotation about an axis that is not an axis of the frame.
pub fn oblique_rotation() -> Matrix3<f64> {
    let axis = nalgebra::Unit::new_normalize(V::new(1.0, -2.0, 0.5));
    *nalgebra::Rotation3::from_axis_angle(&axis, 0.83).matrix()
}

/// Number of stations along a rail.
const STATIONS: u32 = 12;

/// Returns two rails along x with bars and a plate across, and a point above them on an RBE3 with a mass on a bush.
///
/// Each rail has a web and an upper flange with different thickness and taper. Distances have few digits, so that they
/// fit into small field.
pub fn ladder() -> Frame {
    let mut f = empty_frame();
    f.properties = vec![(1, 4.0), (2, 5.0), (3, 3.0)];
    for rail in 0..2_u32 {
        let (first, out) = (200 * rail, if rail == 0 { -1.0 } else { 1.0 });
        for i in 0..=STATIONS {
            let x = 100.0 * f64::from(i) + if i % 3 == 1 { 7.5 } else { 0.0 };
            let y = out * (200.0 + 2.5 * f64::from(i * rail));
            let height = 80.0 + 2.0 * f64::from(i);
            for (j, (dy, z)) in [(0.0, 0.0), (0.0, 0.5), (0.0, 1.0), (40.0, 1.0)]
                .into_iter()
                .enumerate()
            {
                let tag = first + 10 * i + j as u32 + 1;
                f.grids.push(grid(tag, [x, y + out * dy, z * height]));
            }
        }
        for i in 0..STATIONS {
            for j in 0..3 {
                let a = first + 10 * i + j + 1;
                let tag = first + 10 * i + j + 401;
                f.shells
                    .push(quad(tag, rail + 1, [a, a + 10, a + 11, a + 1]));
            }
        }
    }
    add_cross_plate(&mut f);
    upon(&mut f);
    f.held = vec![1, 121, 321];
    f.forces = vec![
        (61, [0.0, 300.0, -900.0].into()),
        (281, [500.0, 0.0, -400.0].into()),
    ];
    f.loads = vec![
        load("W1.FZ", 11, [0.0, 0.0, 1.0]),
        load("W2.FZ", 211, [0.0, 0.0, 1.0]),
        load("W3.FZ", 321, [0.0, 0.0, 1.0]),
        load("W3.FY", 321, [0.0, 1.0, 0.0]),
        load("P.FZ", 902, [0.0, 0.0, 1.0]),
        Load {
            moment: true,
            expected: 2e5,
            ..load("P.MX", 902, [1.0, 0.0, 0.0])
        },
        Load {
            moment: true,
            expected: 2e5,
            ..load("P.MY", 902, [0.0, 1.0, 0.0])
        },
    ];
    gauges(&mut f);
    f
}

/// Adds the plate between the rails at stations 6 and 7, partly of triangles, and two bars.
fn add_cross_plate(f: &mut Frame) {
    let rows: Vec<[u32; 5]> = (6..=7)
        .map(|i| {
            let [a, b] = [10 * i + 1, 200 + 10 * i + 1];
            let (from, to) = (f.x(a), f.x(b));
            let mut row = [a, 0, 0, 0, b];
            for k in 1..4_u32 {
                let y = (from.y + f64::from(k) / 4.0 * (to.y - from.y)).round();
                let tag = 920 + 10 * i + k;
                f.grids.push(grid(tag, [from.x, y, 0.0]));
                row[k as usize] = tag;
            }
            row
        })
        .collect();
    for k in 0..4 {
        let [a, b, c, d] = [rows[0][k], rows[1][k], rows[1][k + 1], rows[0][k + 1]];
        let tag = 750 + 2 * k as u32;
        if k == 2 {
            for (t, corners) in [(tag, vec![a, b, c]), (tag + 1, vec![a, c, d])] {
                f.shells.push(Shell {
                    corners,
                    ..quad(t, 3, [0; 4])
                });
            }
        } else {
            f.shells.push(quad(tag, 3, [a, b, c, d]));
        }
    }
    for (tag, i) in [(790, 2), (791, 11)] {
        f.bars
            .push((tag, [10 * i + 2, 200 + 10 * i + 2], [0.0, 0.2, 1.0].into()));
    }
}

/// Adds a point on an RBE3 between the rails, a point above it on a bush, a mass there, and a mass on a rail.
fn upon(f: &mut Frame) {
    f.grids.push(grid(901, [350.0, 20.0, 140.0]));
    f.grids.push(grid(902, [350.0, 20.0, 180.0]));
    f.spreads.push((903, 901, vec![23, 53, 223, 253, 243]));
    f.bushes.push(Bush {
        grids: [901, 902],
        k: [4e3, 3e3, 6e3, 5e6, 7e6, 4e6],
        v: [1.0, 0.5, 0.0].into(),
    });
    for (grid, mass, inertia) in [(902, 6.0, [4e4, 9e4, 6e4]), (124, 5.0, [0.0; 3])] {
        f.masses.push(Mass {
            grid,
            mass,
            offset: [12.5, -20.0, 30.0].into(),
            inertia,
            system: 1,
        });
    }
}

fn gauges(f: &mut Frame) {
    let along = [1.0, 0.0, 0.0];
    let mut g = vec![
        at_point(f, "P1", 433, true, 0.4),
        at_point(f, "P2", 621, false, -0.3),
        at_point(f, "P3", 752, true, 0.2),
        gauge(f, "R1", 652, true, along),
        gauge(f, "H1", 641, true, along),
        gauge(f, "L1", 461, false, along),
    ];
    g[3].rosette = true;
    g[3].angle_deg = 10.0;
    g[4].bridge = Some("half-bending");
    // The grid of this gauge extends over the edge between two webs.
    g[5].grid_length = 110.0;
    for rail in 0..2 {
        for (n, i) in [1, 3, 4, 6, 8, 10].into_iter().enumerate() {
            let tag = 401 + 200 * rail + 10 * i;
            let web = gauge(f, &format!("S{rail}{i}"), tag, n % 2 == 0, along);
            let angle_deg = [45.0, -50.0, 20.0][n % 3];
            g.push(Gauge { angle_deg, ..web });
            g.push(gauge(
                f,
                &format!("F{rail}{i}"),
                tag + 2,
                n % 3 == 0,
                [1.0, 0.2, 0.0],
            ));
        }
    }
    for (name, tag, station) in [("B1", 790, 0.25), ("B2", 791, 0.75)] {
        let [a, b] = f.bars.iter().find(|b| b.0 == tag).unwrap().1;
        g.push(Gauge {
            seat: Seat::Bar { tag, station },
            at: f.x(a) + station * (f.x(b) - f.x(a)),
            ..gauge(f, name, 423, true, along)
        });
    }
    f.gauges = g;
}

/// Returns a flat plate whose middle surface is in the plane z = 0, with lateral loads only. Its grids are at
/// `-offset`, and ZOFFS is `offset`.
pub fn plate(offset: f64) -> Frame {
    let mut f = empty_frame();
    f.offset = offset;
    f.properties = vec![(1, 6.0), (2, 4.0)];
    for i in 0..=8_u32 {
        for j in 0..=5_u32 {
            let x = 50.0 * f64::from(i) + if i % 3 == 1 { 4.0 } else { 0.0 };
            let y = 40.0 * f64::from(j) + 2.0 * f64::from(i);
            f.grids.push(grid(10 * i + j + 1, [x, y, -offset]));
        }
    }
    for i in 0..8_u32 {
        for j in 0..5_u32 {
            let a = 10 * i + j + 1;
            let property = if i < 5 { 1 } else { 2 };
            f.shells
                .push(quad(200 + a, property, [a, a + 10, a + 11, a + 1]));
        }
    }
    f.held = vec![1, 5, 81];
    f.forces = vec![
        (46, [0.0, 0.0, -90.0].into()),
        (83, [0.0, 0.0, 40.0].into()),
    ];
    f.loads = [("A", 3), ("B", 35), ("C", 84), ("D", 61)]
        .map(|(name, grid)| load(name, grid, [0.0, 0.0, 1.0]))
        .to_vec();
    f.loads.iter_mut().for_each(|l| l.expected = 200.0);
    let along = [1.0, 0.0, 0.0];
    let mut g = vec![
        gauge(&f, "G1", 213, true, along),
        gauge(&f, "G2", 222, false, [0.0, 1.0, 0.0]),
        gauge(&f, "G3", 234, true, [1.0, 1.0, 0.0]),
        at_point(&f, "G4", 242, true, 0.3),
        at_point(&f, "G5", 252, false, 0.3),
        at_point(&f, "G6", 264, false, -0.2),
        gauge(&f, "R1", 251, false, along),
        gauge(&f, "H1", 263, true, along),
    ];
    g[6].rosette = true;
    g[7].bridge = Some("half-bending");
    f.gauges = g;
    f
}
