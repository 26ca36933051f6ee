//! Stress per unit load.

use crate::fe::BeamField;
use crate::fe::strain_tensor::Surface;
use crate::finding::{Finding, Severity};
use crate::model::{Beam, BeamIx, MaterialIx, MaterialKind, Model, ShellIx, ShellKind};
use crate::sensitivity::LoadCaseOf;

/// A place with stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Centre of a shell's surface.
    Shell {
        /// Shell of the place.
        shell: ShellIx,
        /// Side.
        surface: Surface,
    },
    /// Recovery point 0 to 3 (C D E F) of a bar or beam, at a share of its length.
    Beam {
        /// The beam.
        beam: BeamIx,
        /// Point.
        point: usize,
        /// x/xb.
        station: f64,
    },
}

/// A row of the load-to-response matrix. It contains `sxx, syy, sxy` in the element's output frame per unit of each load, in model stress over job
/// unit of load. A bar has only `sxx`. The row also contains the strain `exx, eyy, gxy` from which the stress is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseRow {
    /// Place of the row.
    pub place: Place,
    /// Element id.
    pub element: u32,
    /// Stress per unit of each load.
    pub stress: Vec<[f64; 3]>,
    /// Strain per unit of each load.
    pub strain: Vec<[f64; 3]>,
}

impl ResponseRow {
    /// Returns the side of a shell, or the recovery point of a bar.
    pub fn surface_word(&self) -> String {
        match self.place {
            Place::Shell { surface, .. } => surface.word().to_owned(),
            Place::Beam { point, station, .. } => {
                format!("{} x={station}", ["C", "D", "E", "F"][point.min(3)])
            }
        }
    }
}

/// Returns the rows of every shell and bar with strain in all cases and an isotropic material. A finding states the number of other elements.
///
/// Plane stress: `sxx = E/(1-nu^2) (exx + nu eyy)`, `sxy = G gxy`. The stress of a bar is `E exx`, without shear and torsion.
pub fn response_rows(
    model: &Model,
    loads: &[LoadCaseOf],
    among: impl Fn(u32) -> bool,
) -> (Vec<ResponseRow>, Vec<Finding>) {
    let mut formed = ResponseRows::default();
    for (i, shell) in model.shells.iter().enumerate() {
        if among(shell.id) {
            formed.take(shell_rows(model, loads, ShellIx(i as u32), shell.id));
        }
    }
    for (i, beam) in model.beams.iter().enumerate() {
        if among(beam.id) {
            formed.take(beam_rows(model, loads, BeamIx(i as u32), beam));
        }
    }
    let mut rows = formed.rows;
    rows.retain(|r| r.stress.iter().flatten().all(|v| v.is_finite()));
    let findings = left_out(formed.anisotropic, formed.absent);
    (rows, findings)
}

/// Why an element has no rows.
enum ExclusionReason {
    /// It is not of one isotropic material.
    Isotropy,
    /// A load case has no strain of the element.
    Strain,
}

/// Rows that are complete, and the number of elements without rows.
#[derive(Default)]
struct ResponseRows {
    rows: Vec<ResponseRow>,
    anisotropic: usize,
    absent: usize,
}

impl ResponseRows {
    fn take(&mut self, element: Result<Vec<ResponseRow>, ExclusionReason>) {
        match element {
            Ok(rows) => self.rows.extend(rows),
            Err(ExclusionReason::Isotropy) => self.anisotropic += 1,
            Err(ExclusionReason::Strain) => self.absent += 1,
        }
    }
}

/// Returns the rows of both sides of a shell.
fn shell_rows(
    model: &Model,
    loads: &[LoadCaseOf],
    ix: ShellIx,
    element: u32,
) -> Result<Vec<ResponseRow>, ExclusionReason> {
    let places: Option<Vec<usize>> = loads
        .iter()
        .map(|l| l.case.shells.elements.binary_search(&ix).ok())
        .collect();
    let places = places.ok_or(ExclusionReason::Strain)?;
    let (e, g, nu) = shell_material(model, ix)
        .and_then(|m| isotropic_constants(model, m))
        .ok_or(ExclusionReason::Isotropy)?;
    let side = |surface: Surface| {
        let strain: Vec<[f64; 3]> = loads
            .iter()
            .zip(&places)
            .map(|(l, row)| {
                let v = l.case.shells.centre.get(*row);
                v.map_or([f64::NAN; 3], |v| v[surface.ix()].map(|v| v / l.applied))
            })
            .collect();
        let stress = strain
            .iter()
            .map(|[ex, ey, s]| {
                let plane = e / (1.0 - nu * nu);
                [plane * (ex + nu * ey), plane * (ey + nu * ex), g * s]
            })
            .collect();
        ResponseRow {
            place: Place::Shell { shell: ix, surface },
            element,
            stress,
            strain,
        }
    };
    Ok([Surface::Bottom, Surface::Top].map(side).into())
}

/// Returns the rows of the recovery points of a bar or beam at each of its stations.
fn beam_rows(
    model: &Model,
    loads: &[LoadCaseOf],
    ix: BeamIx,
    beam: &Beam,
) -> Result<Vec<ResponseRow>, ExclusionReason> {
    let fields: Vec<&BeamField> = loads.iter().map(|l| &l.case.beams).collect();
    let absent = |f: &&BeamField| f.elements.binary_search(&ix).is_err();
    if fields.iter().any(absent) {
        return Err(ExclusionReason::Strain);
    }
    let property = model.beam_properties.get(beam.property.us());
    let (e, _, _) = property
        .and_then(|p| isotropic_constants(model, p.material))
        .ok_or(ExclusionReason::Isotropy)?;
    let mut rows = Vec::new();
    for station in stations(&fields, ix) {
        let by_load: Vec<[f64; 4]> = loads
            .iter()
            .map(|l| match l.case.beams.strain_at(ix, station) {
                Some((points, _)) => points.map(|e| e / l.applied),
                None => [f64::NAN; 4],
            })
            .collect();
        for point in 0..4 {
            let strain: Vec<[f64; 3]> = by_load.iter().map(|v| [v[point], 0.0, 0.0]).collect();
            rows.push(ResponseRow {
                place: Place::Beam {
                    beam: ix,
                    point,
                    station,
                },
                element: beam.id,
                stress: strain.iter().map(|v| [e * v[0], 0.0, 0.0]).collect(),
                strain,
            });
        }
    }
    Ok(rows)
}

/// Returns the stations of a bar or beam. These are the stations in the case of the first load, and inner stations if loads act between its ends in
/// any case.
fn stations(fields: &[&BeamField], beam: BeamIx) -> Vec<f64> {
    let own = fields.first().and_then(|f| {
        let row = f.elements.binary_search(&beam).ok()?;
        f.stations.get(row)
    });
    let mut all: Vec<f64> = own.iter().flat_map(|s| s.iter().map(|s| s.0)).collect();
    let inner = fields.iter().flat_map(|f| f.inner_stations(beam));
    all.extend(inner);
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Returns the findings on elements without rows.
fn left_out(anisotropic: usize, absent: usize) -> Vec<Finding> {
    let mut findings = Vec::new();
    if anisotropic > 0 {
        findings.push(
            Finding::new(
                Severity::Warning,
                "stress-not-formed",
                "elements",
                format!("{anisotropic} elements have a material that is not isotropic: they have strain, and no von Mises stress here"),
                "assess them by strain",
            )
            .with_numbers(anisotropic as f64, 0.0),
        );
    }
    if absent > 0 {
        findings.push(
            Finding::new(
                Severity::Info,
                "elements-without-strain",
                "elements",
                format!(
                    "{absent} elements have no strain in the subcase of a load and are left out"
                ),
                "ask for STRAIN(FIBER,CENTER) = ALL in every subcase",
            )
            .with_numbers(absent as f64, 0.0),
        );
    }
    findings
}

fn shell_material(model: &Model, ix: ShellIx) -> Option<MaterialIx> {
    let shell = model.shells.get(ix.us())?;
    match &model.shell_properties.get(shell.property.us())?.kind {
        ShellKind::Homogeneous {
            membrane, bending, ..
        } => match (membrane, bending) {
            (Some(m), Some(b)) if m != b => None,
            (m, b) => m.or(*b),
        },
        _ => None,
    }
}

/// Returns E, G and nu of an isotropic material.
fn isotropic_constants(model: &Model, material: MaterialIx) -> Option<(f64, f64, f64)> {
    match model.materials.get(material.us())?.kind {
        MaterialKind::Isotropic { e, g, nu, .. } => Some((e, g, nu)),
        _ => None,
    }
}
