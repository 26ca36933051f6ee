//! Shells of a model: stiffness, strain rows, mass by corner.

use super::expansion::expansion;
use super::many::{ManyShell, many_shell, over_surface};
use super::output_frame::output_frame;
use super::quad4::quad4;
use super::tria3::tria3;
use super::types::{BadShape, Heat, Parts, ShellInput, ShellLaw, ShellMatrices, Sides, StrainRows};
use crate::fe::element::ElementMatrix;
use crate::fe::error::Refusal;
use crate::fe::prepared_model::PreparedModel;
use crate::fe::temperature::Temperatures;
use crate::model::{Model, Shell, ShellKind, Vec3};
use nastran::cards::ShellShape;

/// K6ROT of CQUADR and CTRIAR: it resists equal rotations at all corners, which bend no side.
const STABLE_DRILLING: f64 = 1e3;

/// Matrices of a shell, with any number of corners.
#[derive(Clone, Debug)]
pub(crate) enum AnyShell {
    Quad(Box<ShellMatrices<4, 24>>),
    Tria(Box<ShellMatrices<3, 18>>),
    /// With mid-side grids.
    Many(Box<ManyShell>),
}

fn corners<const N: usize>(model: &Model, shell: &Shell) -> [Vec3; N] {
    std::array::from_fn(|k| model.grids[shell.grids[k].us()].x)
}

fn refuse(shell: &Shell, reason: &str, remedy: &str) -> Refusal {
    Refusal::new(
        format!("{} {}", shell.shape.card(), shell.id),
        shell.at,
        reason,
        remedy,
    )
}

/// Returns the angle of the material x axis from the output x axis, radians.
pub(crate) fn material_angle(model: &Model, shell: &Shell) -> Option<f64> {
    let n = shell.shape.n_corners();
    let x: Vec<Vec3> = shell.grids[..n]
        .iter()
        .map(|g| model.grids[g.us()].x)
        .collect();
    let frame = output_frame(&x)?;
    let side = frame * (x[1] - x[0]);
    Some(side.y.atan2(side.x) + shell.material_angle_rad)
}

/// Returns the matrices of shell `i`.
///
/// # Errors
/// Shapes, thicknesses and properties that make no element.
pub(crate) fn shell_matrices(
    prepared: &PreparedModel<'_>,
    i: usize,
    parts: Parts,
    heat: Option<&Heat>,
) -> Result<AnyShell, Refusal> {
    let model = prepared.model;
    let shell = &model.shells[i];
    let n = shell.shape.n_corners();
    let bad = |_: BadShape| {
        refuse(
            shell,
            "its corners span no area or form a re-entrant shape",
            "move its grids or delete it",
        )
    };
    if !shell.thickness[..n]
        .iter()
        .all(|t| *t > 0.0 && t.is_finite())
    {
        let stated = shell.thickness[..n].iter().map(f64::to_string);
        let stated: Vec<String> = stated.collect();
        return Err(refuse(
            shell,
            &format!("its thickness at the corners is {}", stated.join(", ")),
            "give a thickness above zero",
        ));
    }
    let property = model
        .shell_properties
        .get(shell.property.us())
        .ok_or_else(|| refuse(shell, "no property", "give it a PSHELL"))?;
    let angle = material_angle(model, shell).ok_or(BadShape).map_err(bad)?;
    let law = ShellLaw::new(model, property, angle).ok_or_else(|| {
        refuse(
            shell,
            "its property has no plane-stress law",
            "use a PSHELL or PCOMP with MAT1, MAT2 or MAT8",
        )
    })?;
    if matches!(shell.shape, ShellShape::Quad8 | ShellShape::Tria6) {
        let many = many_shell(model, shell, property, angle, model.params.k6rot, heat);
        return Ok(AnyShell::Many(Box::new(many.map_err(bad)?)));
    }
    let d = &prepared.directors[i];
    let (k6rot, sides) = match shell.shape {
        ShellShape::QuadR | ShellShape::TriaR => (STABLE_DRILLING, Sides::Bending),
        _ => (model.params.k6rot, Sides::Straight),
    };
    let (zoffs, t) = (shell.zoffs, shell.thickness);
    if n == 4 {
        let input = ShellInput {
            x: corners(model, shell),
            directors: *d,
            thickness: t,
            law: &law,
            zoffs,
            k6rot,
            parts,
            sides,
            heat,
        };
        Ok(AnyShell::Quad(Box::new(quad4(&input).map_err(bad)?)))
    } else {
        let (directors, thickness) = ([d[0], d[1], d[2]], [t[0], t[1], t[2]]);
        let input = ShellInput {
            x: corners(model, shell),
            directors,
            thickness,
            law: &law,
            zoffs,
            k6rot,
            parts,
            sides,
            heat,
        };
        Ok(AnyShell::Tria(Box::new(tria3(&input).map_err(bad)?)))
    }
}

/// Returns the stiffness of shell `i`.
///
/// # Errors
/// The errors of `shell_matrices`.
pub(crate) fn shell_stiffness(
    prepared: &PreparedModel<'_>,
    i: usize,
) -> Result<ElementMatrix, Refusal> {
    let grids = &prepared.model.shells[i].grids;
    Ok(match shell_matrices(prepared, i, Parts::All, None)? {
        AnyShell::Quad(m) => ElementMatrix::from_rows(&grids[..4], &m.stiffness),
        AnyShell::Tria(m) => ElementMatrix::from_rows(&grids[..3], &m.stiffness),
        AnyShell::Many(m) => ElementMatrix {
            grids: prepared.model.shells[i].all_grids(),
            values: m.stiffness,
        },
    })
}

/// Returns the thermal load of shell `i` in a load case; `None` if its property has no law.
pub(crate) fn shell_heat(model: &Model, i: usize, t: &Temperatures) -> Option<Heat> {
    let shell = &model.shells[i];
    let n = shell.shape.n_corners();
    let thickness = shell.thickness[..n].iter().sum::<f64>() / n as f64;
    let property = model.shell_properties.get(shell.property.us())?;
    let angle = material_angle(model, shell)?;
    let expansion = expansion(model, property, thickness, angle)?;
    let (rise, gradient) = t.shell_rise(shell, expansion.tref);
    Some(Heat {
        expansion,
        rise,
        gradient,
    })
}

/// Returns the forces of the thermal strain of shell `i`, six a grid, basic frame.
///
/// # Errors
/// The errors of `shell_matrices`.
pub(crate) fn shell_thermal_force(
    prepared: &PreparedModel<'_>,
    i: usize,
    t: &Temperatures,
) -> Result<Vec<f64>, Refusal> {
    let Some(heat) = shell_heat(prepared.model, i, t) else {
        return Ok(Vec::new());
    };
    Ok(
        match shell_matrices(prepared, i, Parts::WithoutStiffness, Some(&heat))? {
            AnyShell::Quad(m) => m.thermal.to_vec(),
            AnyShell::Tria(m) => m.thermal.to_vec(),
            AnyShell::Many(m) => m.thermal,
        },
    )
}

/// Density times thickness per thickness, and further mass per area, of a property.
fn densities(model: &Model, property: &crate::model::ShellProperty) -> (f64, f64) {
    let rho = |m: &crate::model::MaterialIx| model.materials.get(m.us()).map_or(0.0, |m| m.rho);
    match &property.kind {
        ShellKind::Homogeneous {
            membrane,
            bending,
            shear,
            ..
        } => {
            let first = membrane.as_ref().or(bending.as_ref()).or(shear.as_ref());
            (first.map_or(0.0, rho), property.nsm)
        }
        ShellKind::Laminate { plies, .. } => {
            let layers: f64 = plies.iter().map(|p| rho(&p.material) * p.t).sum();
            (0.0, layers + property.nsm)
        }
    }
}

/// Returns the consistent mass of a shell with mid-side grids: the grids, and the mass matrix by rows, before WTMASS.
pub(crate) fn many_mass(model: &Model, i: usize) -> (Vec<crate::model::GridIx>, Vec<f64>) {
    let shell = &model.shells[i];
    let grids = shell.all_grids();
    let n = grids.len();
    let mut products = vec![0.0; n * n];
    if let Some(property) = model.shell_properties.get(shell.property.us()) {
        let (rho, per_area) = densities(model, property);
        over_surface(model, shell, |functions, area, t| {
            let m = (rho * t + per_area) * area.norm();
            for (a, f) in functions.iter().enumerate() {
                for (b, g) in functions.iter().enumerate() {
                    products[a * n + b] += m * f[0] * g[0];
                }
            }
        });
    }
    (grids, products)
}

/// Returns the consistent mass of shell `i` by pairs of corners, before WTMASS. It is the integral of the product of two shape functions times
/// (density * thickness + NSM). The sum of a row is the lumped mass at that corner.
pub(crate) fn shell_mass(model: &Model, i: usize) -> [[f64; 4]; 4] {
    let shell = &model.shells[i];
    let Some(property) = model.shell_properties.get(shell.property.us()) else {
        return [[0.0; 4]; 4];
    };
    let (rho, per_area) = densities(model, property);
    let all: [Vec3; 4] = std::array::from_fn(|k| model.grids[shell.grids[k].us()].x);
    let n = shell.shape.n_corners().min(4);
    let products = super::area::corner_products(&all[..n], &shell.thickness);
    std::array::from_fn(|k| {
        std::array::from_fn(|l| rho * products.volume[k][l] + per_area * products.area[k][l])
    })
}

/// Returns the mechanical strain at both surfaces from rows and displacements, minus the thermal strain: bottom (Z1), top (Z2).
pub(crate) fn surfaces<const M: usize>(
    rows: &StrainRows<M>,
    z: [f64; 2],
    u: &[f64; M],
    free: &[[f64; 3]; 2],
) -> [[f64; 3]; 2] {
    let dot = |row: &[f64; M]| row.iter().zip(u).map(|(a, b)| a * b).sum::<f64>();
    let (membrane, curvature) = (
        rows.membrane.each_ref().map(dot),
        rows.curvature.each_ref().map(dot),
    );
    std::array::from_fn(|s| std::array::from_fn(|c| membrane[c] + z[s] * curvature[c] - free[s][c]))
}
