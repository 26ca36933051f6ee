use super::*;

fn quad(third: [f64; 3], fourth: [f64; 3]) -> [Vec3; 4] {
    [[0.0; 3], [2.0, 0.0, 0.0], third, fourth].map(Vec3::from)
}

#[test]
fn a_corner_pushed_past_the_diagonal_makes_a_quadrilateral_re_entrant_and_a_kite_is_not() {
    assert!(!is_re_entrant(&quad([2.0, 2.0, 0.0], [0.0, 2.0, 0.0])));
    // The third corner is inside the triangle of the other three, so its angle is above 180 degrees.
    assert!(is_re_entrant(&quad([0.9, 0.9, 0.0], [0.0, 2.0, 0.0])));
    assert!(!is_re_entrant(&quad([1.1, 1.1, 0.0], [0.0, 2.0, 0.0])));
    // On the diagonal itself the angle is 180 degrees.
    assert!(is_re_entrant(&quad([1.0, 1.0, 0.0], [0.0, 2.0, 0.0])));
}

#[test]
fn a_square_with_one_corner_lifted_is_warped_by_a_quarter_of_the_lift_over_its_diagonal() {
    // Every corner is a quarter of the lift away from the mean plane (to first order in the lift).
    let lift = 1e-3;
    let w = warp(&quad([2.0, 2.0, lift], [0.0, 2.0, 0.0]));
    assert!((w - 0.25 * lift / 8_f64.sqrt()).abs() < 1e-9, "{w}");
    assert_eq!(warp(&quad([2.0, 2.0, 0.0], [0.0, 2.0, 0.0])), 0.0);
}
