use super::outline::outline;
use super::paint::Values;
use super::part::{Owner, Part};
use super::skin::{Finest, skin};
use super::*;
use crate::fe::strain_tensor::largest_in_plane;
use crate::fe::{CaseResult, ShellField};
use crate::model::*;
use crate::report::page::Page;
use nastran::cards::{ShellShape, SolidShape};
use nastran::place::Place;
use std::sync::Arc;

fn grid(id: u32, x: [f64; 3]) -> Grid {
    Grid {
        id,
        kind: PointKind::Grid,
        x: x.into(),
        cd: FrameIx(0),
        ps: Default::default(),
        at: Place::default(),
    }
}

/// Returns a plate of `n` x `n` unit squares. The first `of_one` squares belong to property 0, all further ones to property 1.
fn plate(n: u32, of_one: usize) -> Model {
    let mut m = Model::default();
    for j in 0..=n {
        for i in 0..=n {
            m.grids
                .push(grid(1 + j * (n + 1) + i, [f64::from(i), f64::from(j), 0.0]));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let g = j * (n + 1) + i;
            let c = [g, g + 1, g + n + 2, g + n + 1].map(GridIx);
            m.shells.push(Shell {
                id: 1 + j * n + i,
                shape: ShellShape::Quad4,
                grids: [c[0], c[1], c[2], c[3], c[0], c[1], c[2], c[3]],
                property: ShellPropertyIx(u32::from(m.shells.len() >= of_one)),
                material_angle_rad: 0.0,
                zoffs: 0.0,
                thickness: [1.0; 4],
                at: Place::default(),
            });
        }
    }
    for id in [7, 8] {
        m.shell_properties.push(ShellProperty {
            id,
            kind: ShellKind::Homogeneous {
                t: 1.0,
                membrane: None,
                bending: None,
                plane_strain: false,
                shear: None,
                coupling: None,
                bending_ratio: 1.0,
                shear_ratio: 0.833_333,
            },
            nsm: 0.0,
            z: [None, None],
            at: Place::default(),
        });
    }
    m
}

/// Strain `exx` at the bottom and its negative at the top of every shell.
fn bending_case(model: &Model, exx: impl Fn(usize) -> f64) -> CaseResult {
    let n = model.shells.len();
    CaseResult {
        shells: ShellField {
            elements: Arc::new((0..n as u32).map(ShellIx).collect()),
            centre: (0..n)
                .map(|i| [[exx(i), 0.0, 0.0], [-exx(i), 0.0, 0.0]])
                .collect(),
            ..ShellField::default()
        },
        ..CaseResult::default()
    }
}

fn area(model: &Model, part: &Part) -> f64 {
    let at = |v: u32| model.grids[part.grids[part.drawn.vertices[v as usize] as usize].us()].x;
    let triangles = part.drawn.triangles.iter();
    triangles
        .map(|t| {
            let [a, b, c] = t.map(at);
            (b - a).cross(&(c - a)).norm() / 2.0
        })
        .sum()
}

#[test]
fn a_small_model_is_drawn_whole_with_a_part_a_property() {
    let model = plate(4, 6);
    let parts = skin(&model, 1, Finest::FewFields);
    let names: Vec<&str> = parts.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["shells 7", "shells 8"]);
    // The parts have six and ten squares.
    assert_eq!(area(&model, &parts[0]), 6.0);
    assert_eq!(area(&model, &parts[1]), 10.0);
}

/// Elements are selected only on parts of shells, so a part consists of shells or has no shells. The largest property is a separate part.
#[test]
fn small_properties_go_together_shells_apart_from_the_rest() {
    let mut model = plate(24, 0);
    let property = model.shell_properties[0].clone();
    model.shell_properties = (0..50)
        .map(|p| ShellProperty {
            id: 100 + p,
            ..property.clone()
        })
        .collect();
    for (i, shell) in model.shells.iter_mut().enumerate() {
        shell.property = ShellPropertyIx((i as u32 / 7).min(49));
    }
    let first = model.grids.len() as u32;
    for (k, z) in [5.0, 6.0].into_iter().enumerate() {
        for (i, [x, y]) in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .into_iter()
            .enumerate()
        {
            let id = first + 4 * k as u32 + i as u32 + 1;
            model.grids.push(grid(id, [x, y, z]));
        }
    }
    let mut grids = [None; 20];
    for (i, g) in grids.iter_mut().enumerate().take(8) {
        *g = Some(GridIx(first + i as u32));
    }
    model.solids.push(Solid {
        id: 1000,
        shape: SolidShape::Hexa,
        grids,
        property: 0,
        at: Place::default(),
    });
    let parts = skin(&model, 0, Finest::Always);
    assert!(parts.len() <= 40, "{}", parts.len());
    assert_eq!(parts.iter().map(|p| p.faces.len()).sum::<usize>(), 576 + 6);
    assert!(parts.iter().any(|p| p.name == "shells 149"));
    for part in &parts {
        let shells = part.faces.iter().filter(|f| matches!(f.0, Owner::Shell(_)));
        let n = shells.count();
        assert!(n == 0 || n == part.faces.len(), "{}: {n}", part.name);
    }
}

#[test]
fn a_large_model_is_drawn_coarser_and_its_small_parts_stay_whole() {
    // 313,600 elements. The first 100 are a strip with a width of one element.
    let model = plate(560, 100);
    let parts = skin(&model, 1, Finest::FewFields);
    let triangles: usize = parts.iter().map(|p| p.drawn.triangles.len()).sum();
    assert!(triangles <= 120_000 && triangles > 40_000, "{triangles}");
    assert_eq!(area(&model, &parts[0]), 100.0);
    // Borders keep their places, and no square is lost. The one exception is at the end of the strip, where one cube contains two corners.
    let large = area(&model, &parts[1]);
    let whole = 560.0 * 560.0 - 100.0;
    assert!((large - whole).abs() < 9.0, "{large}");
}

#[test]
fn a_vertex_takes_the_mean_around_its_grid_and_of_its_grids_the_largest() {
    let model = plate(2, 9);
    let parts = skin(&model, 1, Finest::FewFields);
    let values = Values::from_case(&model, &bending_case(&model, |i| i as f64));
    let [bottom, top] = values.strain_at_vertices(&parts[0]);
    // The middle grid is a corner of elements 0 to 3. The first corner belongs to element 0 only.
    let at = |id: u32| {
        let local = parts[0].grids.iter().position(|g| g.0 + 1 == id).unwrap();
        parts[0].drawn.vertex_of[local] as usize
    };
    assert_eq!((bottom[at(5)], top[at(5)]), (1.5, -1.5));
    assert_eq!(bottom[at(1)], 0.0);
    assert_eq!(bottom[at(9)], 3.0);
    // A single element of high strain stays visible when 313,600 elements become a few ten thousand. The vertex keeps the mean of the four elements
    // around its grid.
    let model = plate(560, 0);
    let hot = Values::from_case(
        &model,
        &bending_case(&model, |i| if i == 100_000 { 4.0 } else { 0.0 }),
    );
    let parts = skin(&model, 1, Finest::FewFields);
    let most = parts
        .iter()
        .flat_map(|p| hot.strain_at_vertices(p)[0].clone())
        .fold(0.0, f64::max);
    assert_eq!(most, 1.0);
}

#[test]
fn numbers_of_shells_reach_the_vertices_without_a_strain() {
    let model = plate(2, 9);
    let parts = skin(&model, 1, Finest::FewFields);
    let given = [2.0, 4.0, 6.0, 8.0].map(|v| [v, f64::NAN]);
    let values = Values::of_field(&model, &FieldValues::Magnitudes(given.to_vec()));
    let [bottom, top] = values.strain_at_vertices(&parts[0]);
    // Nine grids in rows of three. A corner has the value of its element, a side the mean of two elements, the middle the mean of four.
    let at = |id: u32| {
        let local = parts[0].grids.iter().position(|g| g.0 + 1 == id).unwrap();
        bottom[parts[0].drawn.vertex_of[local] as usize]
    };
    assert_eq!([at(1), at(2), at(5), at(9)], [2.0, 3.0, 5.0, 8.0]);
    assert!(top.iter().all(|v| v.is_nan()));
}

#[test]
fn colours_of_magnitudes_begin_at_zero_and_those_of_strain_lie_about_it() {
    let model = plate(2, 9);
    let case = bending_case(&model, |i| i as f64 - 1.5);
    let stress = FieldValues::Magnitudes(vec![[3.0, 5.0]; 4]);
    for (values, signed) in [(FieldValues::Strain(&case), true), (stress, false)] {
        let scene = Scene {
            model: &model,
            marks: Vec::new(),
            fields: vec![Field {
                name: "A".into(),
                unit: String::new(),
                values,
                scale: 1.0,
            }],
            arrows: Vec::new(),
            length: "mm",
            pointing: PickTargets::Nothing,
            caption: String::new(),
        };
        let section = scene_section("Model", &scene);
        let page = Page::new("Plate", "", &[], vec![section]).to_html();
        assert!(page.contains(&format!("\"signed\":{signed}")));
        assert_eq!(page.contains("top (Z2), signed"), signed);
    }
}

#[test]
fn the_principal_strain_is_that_of_mohrs_circle() {
    // Pure shear of 2e-3: 1e-3 at 45 degrees. Uniaxial with nu 0.3. Both with the sign of the larger.
    assert!((largest_in_plane([0.0, 0.0, 2e-3]) - 1e-3).abs() < 1e-18);
    assert_eq!(largest_in_plane([1e-3, -3e-4, 0.0]), 1e-3);
    assert_eq!(largest_in_plane([-1e-3, 3e-4, 0.0]), -1e-3);
}

#[test]
fn of_solids_the_outside_alone_is_drawn() {
    let mut model = Model::default();
    for k in 0..=2_u32 {
        for (i, xy) in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .iter()
            .enumerate()
        {
            model
                .grids
                .push(grid(4 * k + i as u32 + 1, [xy[0], xy[1], f64::from(k)]));
        }
    }
    for k in 0..2 {
        let mut grids = [None; 20];
        for (i, g) in grids.iter_mut().enumerate().take(8) {
            *g = Some(GridIx(4 * k + i as u32));
        }
        model.solids.push(Solid {
            id: k + 1,
            shape: SolidShape::Hexa,
            grids,
            property: 0,
            at: Place::default(),
        });
    }
    let parts = skin(&model, 0, Finest::FewFields);
    // Two cubes on top of each other: ten faces of area 1.
    assert_eq!(parts[0].faces.len(), 10);
    assert_eq!(area(&model, &parts[0]), 10.0);
}

#[test]
fn the_outline_of_a_large_plate_is_its_border() {
    let model = plate(60, 0);
    let faces = model
        .shells
        .iter()
        .map(|s| [s.grids[0], s.grids[1], s.grids[2], s.grids[3]]);
    assert_eq!(outline(&model, faces).len(), 4 * 60);
}

#[test]
fn a_page_of_a_large_model_stays_small() {
    let model = plate(560, 100);
    let case = bending_case(&model, |i| (i as f64).sin());
    let field = |name: &str| Field {
        name: name.into(),
        unit: "µε".into(),
        values: FieldValues::Strain(&case),
        scale: 1e6,
    };
    let scene = Scene {
        model: &model,
        marks: Vec::new(),
        fields: ["A.FZ", "B.FZ", "C.FZ"].map(field).to_vec(),
        arrows: Vec::new(),
        length: "mm",
        pointing: PickTargets::Nothing,
        caption: String::new(),
    };
    let section = scene_section("Model", &scene);
    let page = Page::new("Plate", "", &[], vec![section]).to_html();
    let mut sections = page.split("<section");
    let section = sections.find(|s| s.contains("coarser than the model"));
    let (section, _) = section.unwrap().split_once("</section>").unwrap();
    // 120,000 triangles and 60,000 vertices: numbers of one to three bytes, fewer than 12 a triangle, 15 a vertex with its fields, with base64.
    assert!(section.len() < 3_200_000, "{}", section.len());
}
