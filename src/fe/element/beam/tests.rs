use super::flexibility::{LocalBeam, release};
use crate::model::Section;

fn section() -> Section {
    Section {
        area: 120.0,
        i1: 3600.0,
        i2: 900.0,
        j: 1500.0,
        ..Section::default()
    }
}

fn beam<'a>(sections: &'a [(f64, Section)], k: [f64; 2]) -> LocalBeam<'a> {
    LocalBeam {
        sections,
        e: 210_000.0,
        g: 81_000.0,
        length: 250.0,
        k,
    }
}

/// Returns the displacements of B under a load there, with A fixed.
fn tip(k: &crate::linalg::SMatrix<f64, 12, 12>, load: [f64; 6]) -> Vec<f64> {
    let kb = k.fixed_view::<6, 6>(6, 6).into_owned();
    (kb.try_inverse().unwrap() * crate::linalg::Vector6::from(load))
        .iter()
        .copied()
        .collect()
}

#[test]
fn a_cantilever_with_tip_loads_is_exact_shear_included() {
    let sections = [(0.0, section()), (1.0, section())];
    let (l, e, g) = (250.0_f64, 210_000.0, 81_000.0);
    let k = beam(&sections, [0.8, 0.5]).stiffness().unwrap();
    let u = tip(&k, [1000.0, 100.0, -70.0, 5e4, 0.0, 0.0]);
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} for {b}");
    close(u[0], 1000.0 * l / (e * 120.0));
    close(
        u[1],
        100.0 * l.powi(3) / (3.0 * e * 3600.0) + 100.0 * l / (0.8 * g * 120.0),
    );
    close(
        u[2],
        -70.0 * l.powi(3) / (3.0 * e * 900.0) - 70.0 * l / (0.5 * g * 120.0),
    );
    close(u[3], 5e4 * l / (g * 1500.0));
    close(u[4], 70.0 * l * l / (2.0 * e * 900.0));
    close(u[5], 100.0 * l * l / (2.0 * e * 3600.0));
}

#[test]
fn a_load_along_a_beam_whose_neutral_axis_is_off_the_line_bends_it() {
    let off = Section {
        neutral: [4.0, -3.0],
        ..section()
    };
    let sections = [(0.0, off), (1.0, off)];
    let (l, e) = (250.0_f64, 210_000.0);
    let u = tip(
        &beam(&sections, [0.0; 2]).stiffness().unwrap(),
        [1000.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    );
    // The force acts 4 mm below (y) and 3 mm above (z) the neutral axis. The moments about this axis are force times distance.
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} for {b}");
    close(u[5], 1000.0 * 4.0 * l / (e * 3600.0));
    close(u[4], 1000.0 * 3.0 * l / (e * 900.0));
}

#[test]
fn a_tapered_cantilever_in_tension_follows_the_logarithm() {
    let narrow = Section {
        area: 60.0,
        ..section()
    };
    let sections = [
        (0.0, section()),
        (
            0.25,
            Section {
                area: 105.0,
                ..section()
            },
        ),
        (
            0.5,
            Section {
                area: 90.0,
                ..section()
            },
        ),
        (1.0, narrow),
    ];
    let u = tip(
        &beam(&sections, [0.0; 2]).stiffness().unwrap(),
        [1000.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    );
    let exact = 1000.0 * 250.0 / (210_000.0 * 60.0) * 2.0_f64.ln();
    assert!((u[0] / exact - 1.0).abs() < 1e-4);
}

#[test]
fn a_pin_carries_no_moment_and_leaves_the_beam_half_as_stiff_to_rotation_elsewhere() {
    let sections = [(0.0, section()), (1.0, section())];
    let mut k = beam(&sections, [0.0; 2]).stiffness().unwrap();
    let before = k[(5, 5)];
    release(&mut k, &mut nalgebra::SVector::zeros(), 1 << 11);
    assert!(k.row(11).iter().all(|v| *v == 0.0));
    assert!((k[(5, 5)] / before - 0.75).abs() < 1e-9, "3EI/L for 4EI/L");
}

#[test]
fn a_section_without_bending_stiffness_makes_a_rod() {
    let thin = Section {
        area: 120.0,
        ..Section::default()
    };
    let sections = [(0.0, thin), (1.0, thin)];
    let k = beam(&sections, [0.0; 2]).stiffness().unwrap();
    assert!((k[(0, 0)] / (210_000.0 * 120.0 / 250.0) - 1.0).abs() < 1e-9);
    assert_eq!(k.iter().filter(|v| **v != 0.0).count(), 4);
}
