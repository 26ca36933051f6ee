use super::*;
use std::f64::consts::PI;

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() < tolerance, "{a} against {b}");
}

/// Corners and exact mid-side places of a straight element: the edge terms vanish.
fn straight(edges: &[(usize, usize)], corners: &[[f64; 3]]) -> Vec<Option<Vec3>> {
    let x: Vec<Vec3> = corners.iter().map(|c| Vec3::from(*c)).collect();
    let mid = edges.iter().map(|(a, b)| (x[*a] + x[*b]) / 2.0);
    x.iter().copied().chain(mid).map(Some).collect()
}

#[test]
fn an_edge_that_bows_out_adds_its_volume_and_straight_solids_are_left_to_their_corners() {
    let cube = [
        [0., 0., 0.],
        [2., 0., 0.],
        [2., 3., 0.],
        [0., 3., 0.],
        [0., 0., 4.],
        [2., 0., 4.],
        [2., 3., 4.],
        [0., 3., 4.],
    ];
    let wedge = [
        [0., 0., 0.],
        [2., 0., 0.],
        [0., 3., 0.],
        [0., 0., 4.],
        [2., 0., 4.],
        [0., 3., 4.],
    ];
    let tetra = [[0., 0., 0.], [2., 0., 0.], [0., 3., 0.], [0., 0., 4.]];
    // The first edge bows by h against y: x = 2 r and z = 4 t stay, so dV = -8 h times the mean slope of its edge function along s.
    // Cube: 4 r (1 - r) (1 - t), integral 1/3. Wedge: 4 r (1 - t), 1/3. Tetrahedron: 4 r, 1/6.
    let h = 0.3;
    let cases: [(SolidShape, &[(usize, usize)], &[[f64; 3]], f64); 3] = [
        (SolidShape::Hexa, &CUBE, &cube, 24.0 + 8.0 / 3.0 * h),
        (SolidShape::Penta, &WEDGE, &wedge, 12.0 + 8.0 / 3.0 * h),
        (SolidShape::Tetra, &TETRAHEDRON, &tetra, 4.0 + 8.0 / 6.0 * h),
    ];
    for (shape, edges, corners, volume) in cases {
        let mut x = straight(edges, corners);
        assert!(solid_parts(shape, &x).is_none());
        x[corners.len()] = Some(Vec3::new(1.0, -h, 0.0));
        let parts = solid_parts(shape, &x).unwrap();
        close(parts.iter().map(|p| p.measure).sum(), volume, 1e-12);
    }
}

#[test]
fn a_bent_edge_adds_the_area_under_its_parabola() {
    // The parabola through (0,0), (1/2,-h), (1,0) has area 2/3 h; so have the mid-side grids of a square and a triangle.
    let h = 0.3;
    let mut x = straight(
        &SQUARE,
        &[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
    );
    x[4] = Some(Vec3::new(0.5, -h, 0.0));
    let area: f64 = shell_parts(ShellShape::Quad8, &x)
        .unwrap()
        .iter()
        .map(|p| p.measure)
        .sum();
    close(area, 1.0 + 2.0 / 3.0 * h, 1e-12);
    let mut x = straight(&TRIANGLE, &[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    x[3] = Some(Vec3::new(0.5, -h, 0.0));
    let area: f64 = shell_parts(ShellShape::Tria6, &x)
        .unwrap()
        .iter()
        .map(|p| p.measure)
        .sum();
    close(area, 0.5 + 2.0 / 3.0 * h, 1e-12);
}

#[test]
fn a_brick_bent_around_an_axis_fills_its_sector() {
    // A block of a tube, radii 1 and 2, height 1, angle a, its arcs parabolas through three points: under the chord of radius r a
    // triangle r^2 sin(a) / 2, above it two thirds of chord times height.
    let at = |r: f64, a: f64, z: f64| Some(Vec3::new(r * a.cos(), r * a.sin(), z));
    let (a, m) = (PI / 6.0, PI / 12.0);
    let ring = |z: f64| [at(1., 0., z), at(2., 0., z), at(2., a, z), at(1., a, z)];
    let middle = |z: f64| [at(1.5, 0., z), at(2., m, z), at(1.5, a, z), at(1., m, z)];
    let x: Vec<Option<Vec3>> = [ring(0.), ring(1.), middle(0.), ring(0.5), middle(1.)].concat();
    let volume: f64 = solid_parts(SolidShape::Hexa, &x)
        .unwrap()
        .iter()
        .map(|p| p.measure)
        .sum();
    let sector = a.sin() / 2.0 + 2.0 / 3.0 * 2.0 * m.sin() * (1.0 - m.cos());
    close(volume, (4.0 - 1.0) * sector, 1e-12);
}
