//! Beams of a model: stiffness in the basic frame, strain at the recovery points.

use super::flexibility::{LocalBeam, compliance, release, section_at};
use super::interior::{Interior, LineLoad, sum_loads_beyond};
use super::warping::{self, torque_at_ends, warping_torsion};
use crate::fe::element::ElementMatrix;
use crate::fe::error::Refusal;
use crate::linalg::{SMatrix, SVector, Vector3};
use crate::model::{Beam, BeamProperty, GridIx, MaterialKind, Model, Section};

type Matrix12 = SMatrix<f64, 12, 12>;

fn refuse(beam: &Beam, reason: String, remedy: &str) -> Refusal {
    let card = if beam.is_beam { "CBEAM" } else { "CBAR" };
    Refusal {
        card: format!("{card} {}", beam.id),
        at: beam.at,
        reason,
        remedy: remedy.to_owned(),
    }
}

/// Returns the length between the offset ends.
pub(super) fn length(model: &Model, beam: &Beam) -> f64 {
    let end = |i: usize| model.grids[beam.grids[i].us()].x + beam.offsets[i];
    (end(1) - end(0)).norm()
}

pub(super) fn build_local_beam<'a>(
    model: &'a Model,
    beam: &Beam,
) -> Result<(LocalBeam<'a>, &'a BeamProperty), Refusal> {
    let length = length(model, beam);
    if !(length > 0.0) {
        return Err(refuse(
            beam,
            format!("length: {length}"),
            "its ends (offsets included) must not coincide",
        ));
    }
    let property = model
        .beam_properties
        .get(beam.property.us())
        .ok_or_else(|| {
            refuse(
                beam,
                "no property".to_owned(),
                "give it a PBAR, PBARL, PBEAM or PBEAML",
            )
        })?;
    let material = model.materials.get(property.material.us());
    let Some(MaterialKind::Isotropic { e, g, .. }) = material.map(|m| m.kind) else {
        return Err(refuse(
            beam,
            "its material is not a MAT1".to_owned(),
            "beams need a MAT1",
        ));
    };
    if !(e > 0.0 && g > 0.0) {
        return Err(refuse(
            beam,
            format!("E: {e}, G: {g}"),
            "give both a value above zero",
        ));
    }
    if property.sections.len() < 2
        || property
            .sections
            .iter()
            .any(|s| s.1.area < 0.0 || s.1.i1 < 0.0 || s.1.i2 < 0.0)
    {
        return Err(refuse(
            beam,
            "a section property is negative or missing".to_owned(),
            "correct the property card",
        ));
    }
    let local = LocalBeam {
        sections: &property.sections,
        e,
        g,
        length,
        k: property.k,
    };
    Ok((local, property))
}

/// Returns the transformation from the grids' displacements (basic frame) to the displacements of the offset ends (element frame).
pub(super) fn to_element(beam: &Beam) -> Matrix12 {
    let mut t = Matrix12::zeros();
    for end in 0..2 {
        let at = 6 * end;
        t.fixed_view_mut::<3, 3>(at, at).copy_from(&beam.axes);
        t.fixed_view_mut::<3, 3>(at + 3, at + 3)
            .copy_from(&beam.axes);
        // u_end = u + theta x offset
        let arm = -(beam.axes * beam.offsets[end].cross_matrix());
        t.fixed_view_mut::<3, 3>(at, at + 3).copy_from(&arm);
    }
    t
}

/// Computes the stiffness and the end forces equivalent to the loads between the ends, with pins released, element frame.
fn form_stiffness_and_forces(
    model: &Model,
    beam: &Beam,
    interior: &Interior,
) -> Result<(Matrix12, SVector<f64, 12>), Refusal> {
    let (local, _) = build_local_beam(model, beam)?;
    let flexible = || {
        refuse(
            beam,
            "its sections give no stiffness".to_owned(),
            "correct area, inertia and torsion constant",
        )
    };
    let mut k = local.stiffness().ok_or_else(flexible)?;
    let mut f = if interior.is_empty() {
        SVector::zeros()
    } else {
        interior.end_forces(&local).ok_or_else(flexible)?
    };
    if let Some(inertia) = &interior.inertia {
        f += SVector::<f64, 12>::from_column_slice(inertia);
    }
    release(
        &mut k,
        &mut f,
        u16::from(beam.pins[0].0) | u16::from(beam.pins[1].0) << 6,
    );
    Ok((k, f))
}

/// Computes the forces at the grids of beam `i` that are equivalent to the loads between its ends, basic frame. Bimoments at warping points are in
/// the first component.
///
/// # Errors
/// The errors of `beam_stiffness`.
pub(crate) fn beam_end_forces(
    model: &Model,
    i: usize,
    interior: &Interior,
) -> Result<Vec<(GridIx, [f64; 6])>, Refusal> {
    let beam = &model.beams[i];
    let (_, mut f) = form_stiffness_and_forces(model, beam, interior)?;
    let mut bimoments = Vec::new();
    if let Some([at_a, at_b]) = beam.warping {
        let torques = interior
            .loads
            .iter()
            .map(|l| (l.span, l.moment.map(|m| m.x)));
        let torsion = torque_at_ends(torsion_of(model, beam)?, torques);
        (f[3], f[9]) = (torsion[0], torsion[2]);
        bimoments = vec![(at_a, torsion[1]), (at_b, torsion[3])];
    }
    let ends: [f64; 12] = (to_element(beam).transpose() * f).into();
    let at_grids = beam.grids.iter().zip(ends.chunks_exact(6));
    let mut all: Vec<(GridIx, [f64; 6])> = at_grids
        .map(|(g, v)| (*g, std::array::from_fn(|i| v[i])))
        .collect();
    all.extend(
        bimoments
            .into_iter()
            .map(|(g, b)| (g, [b, 0.0, 0.0, 0.0, 0.0, 0.0])),
    );
    Ok(all)
}

/// Returns the stiffness of beam `i`, basic frame.
///
/// # Errors
/// Lengths, materials and sections that make no beam.
pub(crate) fn beam_stiffness(model: &Model, i: usize) -> Result<ElementMatrix, Refusal> {
    let beam = &model.beams[i];
    let t = to_element(beam);
    let k = form_stiffness_and_forces(model, beam, &Interior::default())?.0;
    if beam.warping.is_some() {
        return replace_torsion_by_warping(model, beam, k, &t);
    }
    let k = t.transpose() * k * t;
    Ok(ElementMatrix {
        grids: beam.grids.to_vec(),
        values: k.transpose().as_slice().to_vec(),
    })
}

/// Returns the stiffness `k` of a beam (element frame) with its torsion replaced by warping torsion.
fn replace_torsion_by_warping(
    model: &Model,
    beam: &Beam,
    k: Matrix12,
    t: &Matrix12,
) -> Result<ElementMatrix, Refusal> {
    let (gj, ecw, length) = torsion_of(model, beam)?;
    let torsion = warping_torsion(gj, ecw, length);
    Ok(warping::assemble_with_warping(
        &beam.all_grids(),
        k,
        t,
        &torsion,
    ))
}

/// GJ, E CW and length of a beam that warps.
fn torsion_of(model: &Model, beam: &Beam) -> Result<(f64, f64, f64), Refusal> {
    let (local, property) = build_local_beam(model, beam)?;
    let uniform = |of: &dyn Fn(&crate::model::Section) -> f64| {
        let first = property.sections.first().map_or(0.0, |s| of(&s.1));
        property
            .sections
            .iter()
            .all(|s| (of(&s.1) - first).abs() <= 1e-6 * first.abs())
    };
    let [cw, cw_b] = property.warping;
    if !uniform(&|s| s.j) || (cw - cw_b).abs() > 1e-6 * cw.abs() {
        return Err(refuse(
            beam,
            "J or CW differs along a beam that warps".to_owned(),
            "give each element the mean of its ends, or leave SA and SB out",
        ));
    }
    let torsion_released = beam.pins.iter().any(|p| p.has(4));
    if torsion_released {
        return Err(refuse(
            beam,
            "pin 4 on a beam that warps".to_owned(),
            "join the ends by separate grids, or leave SA and SB out",
        ));
    }
    let j = property.sections.first().map_or(0.0, |s| s.1.j);
    Ok((local.g * j, local.e * cw, local.length))
}

/// Mechanical strain of a beam at one of its stations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StationStrain {
    /// x/xb.
    pub(crate) station: f64,
    /// Strain along the axis at C, D, E, F.
    pub(crate) points: [f64; 4],
    /// Strain of the neutral axis.
    pub(crate) axial: f64,
}

/// Forces on end B of a beam, element axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BeamForces {
    /// N, Vy, Vz.
    force: [f64; 3],
    /// My, Mz.
    moment: [f64; 2],
}

/// Returns the forces on end B of beam `i` from displacements (basic). They include the forces that balance the loads between the ends.
///
/// # Errors
/// The errors of `beam_stiffness`.
pub(crate) fn beam_forces(
    model: &Model,
    i: usize,
    u: &[[f64; 6]],
    interior: &Interior,
) -> Result<BeamForces, Refusal> {
    let beam = &model.beams[i];
    let grid: Vec<f64> = beam.grids.iter().flat_map(|g| u[g.us()]).collect();
    let (k, held) = form_stiffness_and_forces(model, beam, interior)?;
    let f = k * (to_element(beam) * SVector::<f64, 12>::from_column_slice(&grid)) - held;
    Ok(BeamForces {
        force: [f[6], f[7], f[8]],
        moment: [f[10], f[11]],
    })
}

/// Returns the mechanical axial strain at C, D, E, F and at the neutral axis at station `xi` of a beam. The arguments are sections, modulus and
/// length, forces on end B, and loads between the ends.
pub(crate) fn strain_at(
    (sections, e, length): (&[(f64, Section)], f64, f64),
    forces: &BeamForces,
    loads: &[LineLoad],
    xi: f64,
) -> StationStrain {
    let s = section_at(sections, xi);
    let arm = length * (1.0 - xi);
    let inside = sum_loads_beyond(loads, xi, length);
    let ([n, vy, vz], [my, mz]) = (forces.force, forces.moment);
    let at_section = Vector3::new(
        n + inside[0],
        my - arm * vz + inside[4],
        mz + arm * vy + inside[5],
    );
    let c = compliance(&s, e, length) * at_section;
    let at = |[y, z]: [f64; 2]| c[0] + z * c[1] - y * c[2];
    StationStrain {
        station: xi,
        points: s.recovery.map(at),
        axial: at(s.neutral),
    }
}

/// Returns modulus and length of beam `i`.
///
/// # Errors
/// The errors of `beam_stiffness`.
pub(crate) fn modulus_and_length(model: &Model, i: usize) -> Result<(f64, f64), Refusal> {
    let (local, _) = build_local_beam(model, &model.beams[i])?;
    Ok((local.e, local.length))
}
