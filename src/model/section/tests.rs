use super::thin::{Wall, shear_centre};
use super::*;

fn is_close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs().max(1e-12)
}

#[test]
fn areas_agree_with_the_manuals_formulas() {
    // Area formulas of the figures in the manual (as listed in pyNastran), evaluated at these dimensions.
    let d = [6.0, 5.0, 0.7, 0.4, 0.6, 0.5];
    let cases: [(&str, &[f64], f64); 15] = [
        (
            "I",
            &[10.0, 6.0, 4.0, 0.4, 0.6, 0.5],
            4.0 * 0.5 + 6.0 * 0.6 + (10.0 - 1.1) * 0.4,
        ),
        ("I1", &[5.0, 0.5, 8.0, 9.0], 0.5 * 8.0 + 1.0 * 5.5),
        (
            "CHAN",
            &[4.0, 9.0, 0.5, 0.6],
            2.0 * 4.0 * 0.6 + (9.0 - 1.2) * 0.5,
        ),
        ("CHAN1", &[3.0, 0.5, 8.0, 9.0], 0.5 * 8.0 + 1.0 * 3.5),
        (
            "CHAN2",
            &[0.5, 0.6, 4.0, 9.0],
            2.0 * 0.5 * 4.0 + (9.0 - 1.0) * 0.6,
        ),
        ("T", &d[..4], 6.0 * 0.7 + (5.0 - 0.7) * 0.4),
        ("T1", &d[..4], 6.0 * 0.7 + 5.0 * 0.4),
        ("T2", &d[..4], 6.0 * 0.7 + (5.0 - 0.7) * 0.4),
        ("L", &d[..4], 5.0 * 0.4 + (6.0 - 0.4) * 0.7),
        ("BOX", &d[..4], 2.0 * 6.0 * 0.7 + 2.0 * (5.0 - 1.4) * 0.4),
        ("H", &[4.0, 1.0, 6.0, 0.5], 1.0 * 6.0 + 4.0 * 0.5),
        ("Z", &[3.0, 0.5, 8.0, 9.0], 0.5 * 8.0 + 1.0 * 3.5),
        (
            "HAT",
            &[5.0, 0.3, 4.0, 1.5],
            0.3 * (2.0 * 1.5 + 2.0 * 5.0 + 4.0 - 0.6),
        ),
        ("CROSS", &[4.0, 0.5, 6.0, 0.7], 0.5 * 6.0 + 0.7 * 4.0),
        ("HEXA", &[1.0, 6.0, 4.0], 4.0 * (6.0 - 1.0)),
    ];
    for (kind, dims, area) in cases {
        let s = bar_section(kind, dims).unwrap_or_else(|e| panic!("{kind}: {e:?}"));
        assert!(
            is_close(s.section.area, area, 1e-12),
            "{kind}: {} against {area}",
            s.section.area
        );
    }
}

#[test]
fn a_channels_shear_centre_is_outside_its_web_by_the_textbook_distance() {
    // e = 3 b^2 tf / (h tw + 6 b tf) from the midline of the web, with the midline dimensions b and h. Source: Timoshenko, Strength of Materials.
    let (w, h, tw, tf) = (4.0, 9.0, 0.5, 0.6);
    let (b, hm) = (w - tw / 2.0, h - tf);
    let e = 3.0 * b * b * tf / (hm * tw + 6.0 * b * tf);
    let s = bar_section("CHAN", &[w, h, tw, tf]).unwrap().section;
    // E is the lower left corner: tw/2 + ... left of the web's midline, so its z is e - tw/2 from the shear centre.
    assert!(
        is_close(s.recovery[2][1], e - tw / 2.0, 1e-12),
        "{:?} {e}",
        s.recovery
    );
    assert!(is_close(s.recovery[2][0], -h / 2.0, 1e-12));
    assert!(s.neutral[1] > 0.0 && s.neutral[0].abs() < 1e-12);
}

#[test]
fn an_i_sections_shear_centre_divides_the_flanges_by_their_inertia() {
    let s = bar_section("I", &[10.0, 6.0, 4.0, 0.4, 0.6, 0.5])
        .unwrap()
        .section;
    let (top, bottom) = (0.5 * 64.0, 0.6 * 216.0);
    let from_bottom_midline = (10.0 - 0.55) * top / (top + bottom);
    assert!(
        is_close(s.recovery[1][0], -(from_bottom_midline + 0.3), 1e-12),
        "{:?}",
        s.recovery
    );
}

#[test]
fn a_hat_with_equal_walls_has_the_published_shear_centre() {
    // Pilkey (2002), hat: for brims of width 0 the hat is a channel turned down with its centre above the crown.
    let (h, t, w) = (5.0, 0.1, 4.0);
    let midline = shear_centre(
        &[[0.0, -2.0], [5.0, -2.0], [5.0, 2.0], [0.0, 2.0]],
        &[
            Wall { from: 0, to: 1, t },
            Wall { from: 1, to: 2, t },
            Wall { from: 2, to: 3, t },
        ],
    )
    .unwrap();
    let e = 3.0 * h * h * t / (w * t + 6.0 * h * t);
    assert!(
        is_close(midline[0], h + e, 1e-12) && midline[1].abs() < 1e-12,
        "{midline:?} {e}"
    );
}

#[test]
fn an_angle_and_a_tee_have_theirs_where_the_walls_meet() {
    let s = bar_section("L", &[6.0, 5.0, 0.7, 0.4]).unwrap().section;
    assert_eq!(s.recovery[2], [-0.35, -0.2]);
    let s = bar_section("T", &[6.0, 5.0, 0.7, 0.4]).unwrap().section;
    assert!(
        is_close(s.recovery[0][0], 0.35, 1e-12),
        "C is on top of the flange"
    );
}

#[test]
fn torsion_of_a_bar_and_a_box_agree_with_tables() {
    // Timoshenko and Goodier: J = beta a b^3 with beta = 0.1406 (square) and 0.229 (2 : 1).
    assert!(is_close(
        bar_section("BAR", &[1.0, 1.0]).unwrap().section.j,
        0.1406,
        2e-3
    ));
    assert!(is_close(
        bar_section("BAR", &[2.0, 1.0]).unwrap().section.j,
        0.229 * 2.0,
        3e-3
    ));
    // Bredt: square tube with wall t = 0.1, midline 2: J = a^3 t = 0.8.
    assert!(is_close(
        bar_section("BOX", &[2.1, 2.1, 0.1, 0.1]).unwrap().section.j,
        0.8,
        1e-12
    ));
}

#[test]
fn a_z_section_has_a_negative_product_of_inertia() {
    // Top flange to the left: integral y z dA = -2 (free width + web) t (free / 2) (inner / 2 + t / 2).
    let (f, w, inner, h) = (3.0, 0.5, 8.0, 9.0);
    let s = bar_section("Z", &[f, w, inner, h]).unwrap().section;
    let t = (h - inner) / 2.0;
    let expected = -2.0 * (f + w) * t * (f / 2.0) * (inner / 2.0 + t / 2.0);
    assert!(is_close(s.i12, expected, 1e-12), "{} {expected}", s.i12);
}

#[test]
fn impossible_dimensions_are_refused() {
    assert_eq!(
        bar_section("TUBE", &[1.0, 2.0]).unwrap_err(),
        SectionFault::Shape
    );
    assert_eq!(
        bar_section("BOX", &[1.0, 1.0, 0.6, 0.1]).unwrap_err(),
        SectionFault::Shape
    );
    assert_eq!(
        bar_section("BAR", &[1.0]).unwrap_err(),
        SectionFault::Count { expected: 2 }
    );
    assert_eq!(
        bar_section("STAR", &[1.0]).unwrap_err(),
        SectionFault::Unknown
    );
}
