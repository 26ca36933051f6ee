//! A solution as blocks of a Nastran result file.

use crate::fe::strain_tensor::{principal_in_plane, principal_strains};
use crate::fe::{CaseResult, Solution, ply_strains};
use crate::model::{Model, ShellIx, ShellKind, Vec3};
use nastran::cards::{ShellShape, SolidShape};
use nastran::results::{Analysis, Block, ElementType, Quantity, RowId, Rows, ShellForm};

const NODAL: &[&str] = &["t1", "t2", "t3", "r1", "r2", "r3"];
const SHELL: &[&str] = &["fiber", "exx", "eyy", "gxy", "angle", "emax", "emin", "vm"];
const PLY: &[&str] = &[
    "s11", "s22", "s12", "s1z", "s2z", "angle", "smax", "smin", "vm",
];
const SOLID: &[&str] = &[
    "xx", "yy", "zz", "xy", "yz", "zx", "max", "mid", "min", "vm",
];
const BAR: &[&str] = &[
    "s1a", "s2a", "s3a", "s4a", "axial", "smaxa", "smina", "mst", "s1b", "s2b", "s3b", "s4b",
    "smaxb", "sminb", "msc",
];
const BEAM: &[&str] = &[
    "x_xb", "sxc", "sxd", "sxe", "sxf", "smax", "smin", "mst", "msc",
];

/// One block of a solution whose rows are formed later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannedBlock {
    case: usize,
    content: Content,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Displacement,
    /// Shape, strain at corners included.
    Shells(ShellShape, bool),
    /// CBEAM rather than CBAR.
    Beams(bool),
    Solids(SolidShape),
    /// Plies of laminates of this shape.
    Plies(ShellShape),
}

/// Element type of a shell's strain: with corners, and at the centre alone.
fn shell_type(shape: ShellShape, corners: bool) -> Option<u32> {
    match (shape, corners) {
        (ShellShape::Quad4, true) => Some(144),
        (ShellShape::Quad4, false) => Some(33),
        (ShellShape::Tria3, _) => Some(74),
        (ShellShape::QuadR, true) => Some(82),
        (ShellShape::QuadR, false) => Some(228),
        (ShellShape::TriaR, _) => Some(227),
        (ShellShape::Quad8, true) => Some(64),
        (ShellShape::Tria6, true) => Some(75),
        (ShellShape::Quad8 | ShellShape::Tria6, false) => None,
    }
}

/// Element type of plies.
fn ply_type(shape: ShellShape) -> u32 {
    match shape {
        ShellShape::Quad4 => 95,
        ShellShape::Quad8 => 96,
        ShellShape::Tria3 => 97,
        ShellShape::Tria6 => 98,
        ShellShape::QuadR => 232,
        ShellShape::TriaR => 233,
    }
}

fn solid_type(shape: SolidShape) -> u32 {
    match shape {
        SolidShape::Tetra => 39,
        SolidShape::Hexa => 67,
        SolidShape::Penta => 68,
        SolidShape::Pyram => 255,
    }
}

const SHAPES: [ShellShape; 6] = [
    ShellShape::Quad4,
    ShellShape::Tria3,
    ShellShape::QuadR,
    ShellShape::TriaR,
    ShellShape::Quad8,
    ShellShape::Tria6,
];

/// Returns every block of a solution in the order of the file.
///
/// Displacements of all cases come first, in the displacement frames of the grids. Then follow the strains of shells at both fibres, of the plies of
/// laminates, of solids, and of bars and beams. Shell strains include the corners where they are known, but not for CTRIA3 and CTRIAR.
pub fn planned_blocks(model: &Model, solution: &Solution) -> Vec<PlannedBlock> {
    let mut all = Vec::new();
    let mut plan = |content: &dyn Fn(&CaseResult) -> Option<Content>| {
        let cases = solution.cases.iter().enumerate();
        all.extend(
            cases.filter_map(|(case, c)| content(c).map(|content| PlannedBlock { case, content })),
        );
    };
    plan(&|c| (!c.displacement.is_empty()).then_some(Content::Displacement));
    for shape in SHAPES {
        plan(&|c| {
            let mut shells = c.shells.elements.iter();
            let constant = matches!(shape, ShellShape::Tria3 | ShellShape::TriaR);
            let corners = !constant && !c.shells.corners.is_empty();
            shell_type(shape, corners)?;
            shells
                .any(|ix| model.shells[ix.us()].shape == shape)
                .then_some(Content::Shells(shape, corners))
        });
    }
    for shape in SHAPES {
        plan(&|c| {
            let mut shells = c.shells.elements.iter();
            shells
                .any(|ix| model.shells[ix.us()].shape == shape && is_laminate(model, *ix))
                .then_some(Content::Plies(shape))
        });
    }
    for shape in [
        SolidShape::Tetra,
        SolidShape::Hexa,
        SolidShape::Penta,
        SolidShape::Pyram,
    ] {
        plan(&|c| {
            let mut solids = c.solids.elements.iter();
            solids
                .any(|i| model.solids[*i].shape == shape)
                .then_some(Content::Solids(shape))
        });
    }
    for is_beam in [false, true] {
        plan(&|c| {
            let mut beams = c.beams.elements.iter();
            beams
                .any(|ix| model.beams[ix.us()].is_beam == is_beam)
                .then_some(Content::Beams(is_beam))
        });
    }
    all
}

/// Returns a planned block and its rows.
pub fn rows_of_block(model: &Model, solution: &Solution, plan: PlannedBlock) -> (Block, Rows) {
    let case = &solution.cases[plan.case];
    match plan.content {
        Content::Displacement => (
            block(case, Quantity::Displacement, None),
            displacement(model, case),
        ),
        Content::Shells(shape, corners) => (
            block(case, Quantity::Strain, shell_type(shape, corners)),
            shells(model, case, shape, corners),
        ),
        Content::Plies(shape) => (
            block(case, Quantity::PlyStrain, Some(ply_type(shape))),
            plies(model, case, shape),
        ),
        Content::Solids(shape) => (
            block(case, Quantity::Strain, Some(solid_type(shape))),
            solids(model, case, shape),
        ),
        Content::Beams(is_beam) => {
            let element = if is_beam { 2 } else { 34 };
            (
                block(case, Quantity::Strain, Some(element)),
                beams(model, case, is_beam),
            )
        }
    }
}

fn block(case: &CaseResult, quantity: Quantity, element: Option<u32>) -> Block {
    Block {
        table: String::new(),
        quantity,
        analysis: Analysis::Statics,
        subcase: case.subcase,
        mode: 0,
        step: 0.0,
        element: element.map(ElementType),
        form: element.map(|_| ShellForm::Fiber),
        von_mises: true,
        complex: false,
        sort2: false,
        num_wide: 0,
        entries: 0,
        titles: [String::new(), String::new(), case.label.clone()],
    }
}

fn displacement(model: &Model, case: &CaseResult) -> Rows {
    let mut rows = Rows {
        columns: NODAL,
        ..Rows::default()
    };
    for (g, u) in (0..).map(crate::model::GridIx).zip(&case.displacement) {
        let Some(grid) = model.grids.get(g.us()) else {
            break;
        };
        let axes = model.cd_axes(g);
        let (t, r) = (
            axes * Vec3::new(u[0], u[1], u[2]),
            axes * Vec3::new(u[3], u[4], u[5]),
        );
        rows.ids.push(RowId {
            entity: grid.id,
            at: 1,
            layer: 0,
        });
        rows.values.extend([t.x, t.y, t.z, r.x, r.y, r.z]);
    }
    rows
}

fn shells(model: &Model, case: &CaseResult, shape: ShellShape, corners: bool) -> Rows {
    let mut rows = Rows {
        columns: SHELL,
        ..Rows::default()
    };
    let none = Vec::new();
    let corner_field = if corners { &case.shells.corners } else { &none };
    let expected = case.shells.elements.len() * if corners { 10 } else { 2 };
    rows.ids.reserve(expected);
    rows.values.reserve(expected * SHELL.len());
    for (i, (ix, centre)) in case
        .shells
        .elements
        .iter()
        .zip(&case.shells.centre)
        .enumerate()
    {
        let shell = &model.shells[ix.us()];
        if shell.shape != shape {
            continue;
        }
        let fibres = model.fibres(shell);
        let mut push = |at: u32, z: [f64; 2], strain: &[[f64; 3]; 2]| {
            for layer in 0..2 {
                rows.ids.push(RowId {
                    entity: shell.id,
                    at,
                    layer: layer as u32 + 1,
                });
                rows.values.push(z[layer]);
                rows.values.extend(with_invariants(strain[layer]));
            }
        };
        push(0, fibres.centre, centre);
        for ((g, z), strain) in shell.grids[..shape.n_corners()]
            .iter()
            .zip(fibres.corners)
            .zip(corner_field.get(i).into_iter().flatten())
        {
            push(model.grids[g.us()].id, z, strain);
        }
    }
    rows
}

fn is_laminate(model: &Model, ix: ShellIx) -> bool {
    let property = model.shells[ix.us()].property;
    matches!(
        model.shell_properties[property.us()].kind,
        ShellKind::Laminate { .. }
    )
}

/// Strain in the middle of every ply, ply axes; transverse shear is not computed (not a number).
fn plies(model: &Model, case: &CaseResult, shape: ShellShape) -> Rows {
    let mut rows = Rows {
        columns: PLY,
        ..Rows::default()
    };
    for (ix, centre) in case.shells.elements.iter().zip(&case.shells.centre) {
        let shell = &model.shells[ix.us()];
        if shell.shape != shape {
            continue;
        }
        for (layer, strain) in (1..).zip(ply_strains(model, *ix, centre)) {
            rows.ids.push(RowId {
                entity: shell.id,
                at: 0,
                layer,
            });
            let [ex, ey, g, angle, largest, smallest, von_mises] = with_invariants(strain);
            rows.values.extend([ex, ey, g, f64::NAN, f64::NAN]);
            rows.values.extend([angle, largest, smallest, von_mises]);
        }
    }
    rows
}

fn solids(model: &Model, case: &CaseResult, shape: SolidShape) -> Rows {
    let mut rows = Rows {
        columns: SOLID,
        ..Rows::default()
    };
    let field = &case.solids;
    for ((i, centre), corners) in field.elements.iter().zip(&field.centre).zip(&field.corners) {
        let solid = &model.solids[*i];
        if solid.shape != shape {
            continue;
        }
        let cordm = model.solid_properties[solid.property as usize].cordm;
        let layer = cordm.and_then(|c| u32::try_from(c).ok()).unwrap_or(0);
        let mut push = |at: u32, strain: &[f64; 6]| {
            rows.ids.push(RowId {
                entity: solid.id,
                at,
                layer,
            });
            rows.values.extend(strain);
            rows.values.extend(principal_and_von_mises(strain));
        };
        push(0, centre);
        for (g, strain) in solid.grids[..shape.n_corners()].iter().zip(corners) {
            push(g.map_or(0, |g| model.grids[g.us()].id), strain);
        }
    }
    rows
}

/// Principal strains, largest first, and the von Mises strain.
fn principal_and_von_mises(e: &[f64; 6]) -> [f64; 4] {
    let [a, b, c] = principal_strains(e);
    let apart = (a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2);
    [a, b, c, (2.0 * apart).sqrt() / 3.0]
}

/// exx, eyy, gxy, angle of the larger principal strain (degrees), both principal strains, von Mises strain.
fn with_invariants([ex, ey, g]: [f64; 3]) -> [f64; 7] {
    let [largest, smallest] = principal_in_plane([ex, ey, g]);
    let angle = 0.5 * g.atan2(ex - ey).to_degrees();
    let von_mises = (4.0 / 9.0 * (ex * ex + ey * ey - ex * ey) + g * g / 3.0).sqrt();
    [ex, ey, g, angle, largest, smallest, von_mises]
}

fn beams(model: &Model, case: &CaseResult, is_beam: bool) -> Rows {
    let mut rows = Rows {
        columns: if is_beam { BEAM } else { BAR },
        ..Rows::default()
    };
    let extremes = |s: &[f64; 4]| {
        s.iter()
            .fold((f64::NEG_INFINITY, f64::INFINITY), |(a, b), v| {
                (a.max(*v), b.min(*v))
            })
    };
    let field = &case.beams;
    let all = field.elements.iter().zip(&field.stations).zip(&field.axial);
    for ((ix, stations), axial) in all {
        let beam = &model.beams[ix.us()];
        if beam.is_beam != is_beam {
            continue;
        }
        if is_beam {
            for (k, (xi, s)) in stations.iter().enumerate() {
                let at = match k {
                    0 => model.grids[beam.grids[0].us()].id,
                    k if k + 1 == stations.len() => model.grids[beam.grids[1].us()].id,
                    _ => 0,
                };
                let (largest, smallest) = extremes(s);
                rows.ids.push(RowId {
                    entity: beam.id,
                    at,
                    layer: 0,
                });
                rows.values
                    .extend([*xi, s[0], s[1], s[2], s[3], largest, smallest, 0.0, 0.0]);
            }
        } else if let (Some((_, a)), Some((_, b))) = (stations.first(), stations.last()) {
            // A row contains the axial strain once, for end A; readers add this strain to the bending strain of both ends.
            let axial = axial.first().copied().unwrap_or(f64::NAN);
            let (bend_a, bend_b) = (a.map(|s| s - axial), b.map(|s| s - axial));
            let ((amax, amin), (bmax, bmin)) = (extremes(a), extremes(b));
            rows.ids.push(RowId {
                entity: beam.id,
                at: 0,
                layer: 0,
            });
            rows.values.extend(bend_a);
            rows.values.extend([axial, amax, amin, 0.0]);
            rows.values.extend(bend_b);
            rows.values.extend([bmax, bmin, 0.0]);
        }
    }
    rows
}
