use super::*;

#[test]
fn curvature_form_carries_minus_the_derivative() {
    let (mid, slope) = ([1e-4, 2e-4, -1e-4], [3e-3, -1e-3, 2e-3]);
    let row2 = slope.map(|s: f64| -s);
    let got = strain_from_curvature(mid, row2, 0.5);
    (0..3).for_each(|i| assert!((got[i] - (mid[i] + 0.5 * slope[i])).abs() < 1e-18));
}

#[test]
fn uniaxial_stress_gives_poisson_contraction_and_its_normal_strain() {
    let (e, nu) = (210_000.0, 0.3);
    let strain = strain_from_stress([210.0, 0.0, 0.0], e, e / 2.6, nu);
    assert!((strain[0] - 1e-3).abs() < 1e-18 && (strain[1] + 3e-4).abs() < 1e-18);
    // Across the thickness the contraction is the same as across the width.
    let ezz = -nu / (1.0 - nu) * (strain[0] + strain[1]);
    assert!((ezz - strain[1]).abs() < 1e-18);
}
