use super::*;

fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() < tolerance, "{a} against {b}");
}

/// Returns the corners and exact mid-side places of a straight element. Its edge terms vanish.
fn straight_node_locations(edges: &[(usize, usize)], corners: &[[f64; 3]]) -> Vec<Option<Vec3>> {
    let x: Vec<Vec3> = corners.iter().map(|c| Vec3::from(*c)).collect();
    let mid = edges.iter().map(|(a, b)| (x[*a] + x[*b]) / 2.0);
    x.iter().copied().chain(mid).map(Some).collect()
}

#[test]
fn a_bent_edge_adds_the_area_under_its_parabola() {
    // The parabola through (0,0), (1/2,-h), (1,0) has the area 2/3 h. The mid-side grid adds this area to a square and to a triangle.
    let h = 0.3;
    let mut x = straight_node_locations(
        &SQUARE,
        &[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
    );
    x[4] = Some(Vec3::new(0.5, -h, 0.0));
    let area = shell_area(ShellShape::Quad8, &x).unwrap();
    assert_close(area, 1.0 + 2.0 / 3.0 * h, 1e-12);
    let mut x = straight_node_locations(&TRIANGLE, &[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    x[3] = Some(Vec3::new(0.5, -h, 0.0));
    let area = shell_area(ShellShape::Tria6, &x).unwrap();
    assert_close(area, 0.5 + 2.0 / 3.0 * h, 1e-12);
}
