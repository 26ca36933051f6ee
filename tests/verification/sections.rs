//! Compares HAT1 and DBOX of PBARL with closed forms of their parts.

use crate::mesh::Bulk;
use strainbridge::model::Section;

fn section(kind: &str, dims: &[f64]) -> Section {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3");
    let fields: Vec<String> = dims.iter().map(|d| format!("{d:?}")).collect();
    let lines: Vec<String> = fields.chunks(8).map(|l| l.join(",")).collect();
    b.card(&format!("PBEAML,2,1,,{kind},,,,,\n,{}", lines.join(",\n,")));
    let (a, c) = (b.grid([0.0; 3]), b.grid([100.0, 0.0, 0.0]));
    b.card(&format!("CBEAM,1,2,{a},{c},0.,1.,0."));
    assert!(b.faults().is_empty(), "{:?}", b.faults());
    b.model().beam_properties[0].sections[0].1
}

fn assert_close(what: &str, got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance * expected.abs(),
        "{what}: {got} for {expected}"
    );
}

/// Returns the torsion constant of Bredt: 4 A^2 over the sum of l / t along the midline.
fn bredt(area: f64, walls: &[(f64, f64)]) -> f64 {
    4.0 * area * area / walls.iter().map(|(l, t)| l / t).sum::<f64>()
}

#[test]
fn a_hat_on_a_plate_has_the_area_inertia_and_torsion_of_its_parts() {
    let [w, h, crown, t, plate] = [120.0, 60.0, 70.0, 2.0, 3.0];
    let s = section("HAT1", &[w, h, crown, t, plate]);
    // The area formula of the manual.
    let area = w * plate + crown * t + (w - crown) * t + 2.0 * (h - plate - t) * t;
    assert_close("area", s.area, area, 1e-12);
    // Rectangles by the parallel axis theorem: (width, height, y of the middle).
    let parts = [
        (w, plate, plate / 2.0),
        (w - crown, t, plate + t / 2.0),
        (2.0 * t, h - plate - t, (plate + h - t) / 2.0),
        (crown, t, h - t / 2.0),
    ];
    let y0 = parts.iter().map(|(b, d, y)| b * d * y).sum::<f64>() / area;
    let i1: f64 = parts
        .iter()
        .map(|(b, d, y)| b * d.powi(3) / 12.0 + b * d * (y - y0).powi(2))
        .sum();
    assert_close("I1", s.i1, i1, 1e-12);
    let web = (crown - t) / 2.0;
    let i2 = plate * w.powi(3) / 12.0
        + t * (w.powi(3) - crown.powi(3)) / 12.0
        + 2.0 * (h - plate - t) * (t.powi(3) / 12.0 + t * web * web)
        + t * crown.powi(3) / 12.0;
    assert_close("I2", s.i2, i2, 1e-12);
    let (wide, high) = (crown - t, h - t / 2.0 - plate / 2.0);
    let cell = bredt(wide * high, &[(wide, t), (wide, plate), (2.0 * high, t)]);
    assert_close(
        "J",
        s.j,
        cell + (w - crown) * (t + plate).powi(3) / 3.0,
        1e-9,
    );
    // The section is symmetric about y. Neutral axis and shear centre are on the axis, and the shear centre is within
    // the height of the cell.
    assert!(s.neutral[1].abs() < 1e-12 * w);
    let bottom = s.recovery[1][0];
    assert!(-bottom > 0.0 && -bottom < h, "{:?}", s.recovery);
}

#[test]
fn a_double_box_has_the_area_inertia_and_torsion_of_its_cells() {
    // Symmetric section: the middle wall carries no shear flow in torsion, and all centres coincide.
    let (w, h) = (200.0, 80.0);
    let s = section("DBOX", &[w, h, 100.0, 4.0, 3.0, 4.0, 5.0, 5.0, 5.0, 5.0]);
    let (wm, hm) = (w - 4.0, h - 5.0);
    assert_close(
        "J",
        s.j,
        bredt(wm * hm, &[(2.0 * wm, 5.0), (2.0 * hm, 4.0)]),
        1e-9,
    );
    assert!(
        s.neutral[0].abs() < 1e-9 && s.neutral[1].abs() < 1e-9,
        "{:?}",
        s.neutral
    );
    let lying = 2.0 * ((w - 11.0) * 5.0_f64.powi(3) / 12.0 + (w - 11.0) * 5.0 * (hm / 2.0).powi(2));
    assert_close("I1", s.i1, 11.0 * h.powi(3) / 12.0 + lying, 1e-12);
    assert_close("area", s.area, 11.0 * h + 2.0 * (w - 11.0) * 5.0, 1e-12);
    // Unsymmetric section: the flows q1 and q2 of two cells with equal twist, by Cramer's rule.
    let [left, web, right, tl, bl, tr, br] = [4.0, 2.0, 6.0, 5.0, 5.0, 3.0, 3.0];
    let s = section("DBOX", &[w, h, 80.0, left, web, right, tl, bl, tr, br]);
    // Midlines: the flanges of each cell differ in level by a millimetre, and half of it counts at the middle wall.
    let (b1, b2) = (80.0 - left / 2.0, w - right / 2.0 - 80.0);
    let (h1, h2) = (h - (tl + bl) / 2.0, h - (tr + br) / 2.0);
    let hw = (h1 + h2) / 2.0;
    let slope = |b: f64, dy: f64| b.hypot(dy);
    let (f1, f2) = (slope(b1, (h2 - h1) / 4.0), slope(b2, (h2 - h1) / 4.0));
    let (a1, a2) = (b1 * (h1 + hw) / 2.0, b2 * (hw + h2) / 2.0);
    let d11 = h1 / left + hw / web + f1 / tl + f1 / bl;
    let d22 = h2 / right + hw / web + f2 / tr + f2 / br;
    let d12 = -hw / web;
    let det = d11 * d22 - d12 * d12;
    let (q1, q2) = (
        (2.0 * a1 * d22 - 2.0 * a2 * d12) / det,
        (2.0 * a2 * d11 - 2.0 * a1 * d12) / det,
    );
    assert_close("J of two cells", s.j, 2.0 * (a1 * q1 + a2 * q2), 1e-9);
    // Blank DIM5 to DIM8 take DIM4. Blank DIM9 and DIM10 take DIM6.
    for (right, dims) in [(6.0, "4.,,6."), (4.0, "4.")] {
        let short = section(
            "DBOX",
            &[w, h, 80.0, 4.0, 4.0, right, 4.0, 4.0, right, right],
        );
        let mut b = Bulk::default();
        b.card(&format!(
            "MAT1,1,210000.,,.3\nPBARL,2,1,,DBOX,,,,,\n,200.,80.,80.,{dims}"
        ));
        assert!(b.faults().is_empty(), "{:?}", b.faults());
        assert_close(
            "defaults",
            b.model().beam_properties[0].sections[0].1.area,
            short.area,
            1e-12,
        );
    }
}

/// Shear flow of one cell with different side walls.
///
/// It is the sum of two flows. The first one is the flow of the box cut open in the middle of its left wall. The second
/// one circulates and closes the cut without a twist. The moment of both is zero about the shear centre.
#[test]
fn a_box_of_unlike_sides_has_the_shear_centre_of_its_shear_flow() {
    let [w, h, t1, t2, tf] = [201.0, 75.0, 4.0, 8.0, 5.0];
    // The middle wall has practically no thickness, so there is one cell.
    let s = section("DBOX", &[w, h + tf, 100.0, t1, 1e-9, t2, tf, tf, tf, tf]);
    // Midlines: flanges of length b, walls of height h. First moments of area start at the cut and run down, along the
    // bottom, up and back.
    let b = w - (t1 + t2) / 2.0;
    let i = h.powi(3) * (t1 + t2) / 12.0 + b * tf * h * h / 2.0;
    let corner = t1 * h * h / 8.0;
    // The integral around the cell over the thickness, and the constant flow that cancels it.
    let around = h.powi(3) / 24.0
        + 2.0 * (corner * b + tf * h * b * b / 4.0) / tf
        + ((corner + tf * h * b / 2.0) * h + t2 * h.powi(3) / 12.0) / t2;
    let q = around / (h / t1 + h / t2 + 2.0 * b / tf);
    // Moment about the middle of the left wall.
    let right = (corner + tf * h * b / 2.0) * h + t2 * h.powi(3) / 12.0 - q * h;
    let flange = q * b - (corner * b + tf * h * b * b / 4.0);
    let centre = (b * right - h * flange) / i;
    assert_close("shear centre", -s.recovery[2][1] - t1 / 2.0, centre, 1e-6);
}

/// Pure bending of a CBAR strains the points of every section by `M y / I` about the centroid of the section.
///
/// The strain must therefore change its sign across the section. The CBEAM with the same section gives the centroid.
#[test]
fn points_of_a_pbarl_count_from_the_centroid() {
    let types: [(&str, &[f64]); 10] = [
        ("T", &[60.0, 90.0, 7.0, 5.0]),
        ("T1", &[60.0, 90.0, 7.0, 5.0]),
        ("T2", &[60.0, 90.0, 7.0, 5.0]),
        ("L", &[50.0, 70.0, 6.0, 5.0]),
        ("CHAN", &[40.0, 100.0, 5.0, 6.0]),
        ("CHAN1", &[30.0, 6.0, 80.0, 100.0]),
        ("CHAN2", &[5.0, 6.0, 60.0, 90.0]),
        ("HAT", &[50.0, 4.0, 60.0, 20.0]),
        ("I", &[100.0, 80.0, 40.0, 5.0, 7.0, 6.0]),
        ("BOX1", &[60.0, 90.0, 5.0, 9.0, 4.0, 7.0]),
    ];
    for (kind, dims) in types {
        let beam = section(kind, dims);
        let mut b = Bulk::default();
        b.card("MAT1,1,210000.,,.3");
        let fields: Vec<String> = dims.iter().map(|d| format!("{d:?}")).collect();
        b.card(&format!("PBARL,2,1,,{kind},,,,,\n,{}", fields.join(",")));
        let (a, c) = (b.grid([0.0; 3]), b.grid([100.0, 0.0, 0.0]));
        b.card(&format!("CBAR,1,2,{a},{c},0.,1.,0."));
        b.hold("123456", [a]);
        b.card("MOMENT,1,2,0,1000.,0.,0.,1.");
        let s = b.solve();
        let (points, axial) = s
            .case
            .beams
            .strain_at(s.model.beam_ix(1).unwrap(), 0.5)
            .unwrap();
        assert!(axial.abs() < 1e-15, "{kind}: {axial}");
        // Curvatures of a section with a product of inertia under a moment about z.
        let d = beam.i1 * beam.i2 - beam.i12 * beam.i12;
        let largest = points.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
        for (p, got) in beam.recovery.iter().zip(points) {
            let (y, z) = (p[0] - beam.neutral[0], p[1] - beam.neutral[1]);
            let expected = -1000.0 * (beam.i2 * y - beam.i12 * z) / (210_000.0 * d);
            assert!(
                (got - expected).abs() <= 1e-9 * largest,
                "{kind}: {got} for {expected}"
            );
        }
    }
    // A T with flange 80 x 8 and web 92 x 6 under 1e5. The centroid is 27.15 below the top of the flange.
    let (flange, web) = (80.0 * 8.0, 92.0 * 6.0);
    let from_top = (flange * 4.0 + web * 54.0) / (flange + web);
    let i = 80.0 * 512.0 / 12.0
        + flange * (from_top - 4.0_f64).powi(2)
        + 6.0 * 92.0_f64.powi(3) / 12.0
        + web * (54.0 - from_top).powi(2);
    let t = section("T", &[80.0, 100.0, 8.0, 6.0]);
    assert_close("I1", t.i1, i, 1e-12);
    assert_close("top", t.recovery[0][0] - t.neutral[0], from_top, 1e-12);
    assert_close(
        "bottom",
        t.recovery[2][0] - t.neutral[0],
        from_top - 100.0,
        1e-12,
    );
}
