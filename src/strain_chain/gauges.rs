//! The job's gauges laid onto the model.

use super::Fields;
use super::specs::corrected_spec_of;
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::gauge::{Gauge, GaugeError, beside_beam, beside_shell, build, on_unverified_elements};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::words::short;
use crate::host::work::Work;
use crate::job::{Job, JobGauge, StatedPlace};
use crate::model::{Model, Vec3};
use crate::sensitivity::{NoStrain, NoStrainCause, bar_points};
use crate::units::Quantity;

/// Channels of the job's gauges, in job order; findings go to the work.
///
/// # Errors
/// Elements and coordinate systems that the deck lacks, directions normal to their surface.
pub fn lay_gauges(work: &mut Work, job: &Job, fields: &Fields) -> Result<Vec<Gauge>, Faults> {
    let mut faults = FaultList::new();
    let mut gauges = Vec::new();
    let corners = fields.corner_rows(job);
    for g in &job.gauges {
        match corrected_spec_of(fields.model(), job, g) {
            Ok(spec) => match build(fields.model(), &spec, corners) {
                Ok((channels, findings)) => {
                    gauges.extend(channels);
                    work.findings.extend(findings);
                }
                Err(e) => faults.push(not_laid(g, &e)),
            },
            Err(f) => faults.push(f),
        }
    }
    Faults::check(faults)?;
    for finding in off_their_elements(fields.model(), job) {
        // Who lays the gauges twice says it once.
        if !work.findings.contains(&finding) {
            work.findings.push(finding);
        }
    }
    if job.model.as_ref().is_some_and(|m| m.results.is_empty()) {
        work.findings
            .extend(on_unverified_elements(fields.model(), &gauges));
    } else {
        let loads = fields.load_cases(job);
        for finding in bar_points(fields.model(), &gauges, &loads) {
            if !work.findings.contains(&finding) {
                work.findings.push(finding);
            }
        }
    }
    Ok(gauges)
}

/// How well a point of a drawing is read and rounded, m: a gauge and its tabs are some 5 mm wide.
const READ_OFF_M: f64 = 5e-3;

/// How far from its element a gauge's point may be stated, job units, beside the element's faces: as far as the job says that gauges may sit
/// from their drawing, with 95 %, and what reading a drawing leaves.
fn point_tolerance(job: &Job) -> f64 {
    let in_mm = job.reconcile.as_ref().and_then(|r| r.position_tolerance_mm);
    let stated = [
        job.placement.position_tolerance,
        job.calibration.position_tolerance,
        in_mm.unwrap_or(0.0) * 1e-3 / job.units.length_m(),
    ];
    NORMAL_95 * stated.into_iter().fold(0.0, f64::max) + READ_OFF_M / job.units.length_m()
}

/// Gauges whose stated point lies beside their stated element: one of the two is wrong, beyond doubt where they are farther from each other
/// than the element is large. Their strain is that of the element.
pub fn off_their_elements(model: &Model, job: &Job) -> Vec<Finding> {
    let beside = |g: &JobGauge, x: Vec3| match g.place {
        StatedPlace::Element(id) => beside_shell(model, model.shell_ix(id)?, x),
        StatedPlace::BeamPoint { element, .. } => beside_beam(model, model.beam_ix(element)?, x),
        StatedPlace::Position(..) | StatedPlace::Unstated => None,
    };
    let unit = job.units.unit(Quantity::Length).name;
    let tolerance = point_tolerance(job);
    let of = |g: &JobGauge| {
        let x = g.position?;
        // The point may be meant in the axes of `cid`, as the direction is.
        let frame = model.frames.get(model.frame_ix(g.cid)?.us())?;
        let found = [Vec3::from(x), frame.to_basic(x)]
            .into_iter()
            .filter_map(|x| beside(g, x))
            .min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        let element = match g.place {
            StatedPlace::Element(id) | StatedPlace::BeamPoint { element: id, .. } => id,
            StatedPlace::Position(..) | StatedPlace::Unstated => return None,
        };
        // A bar that states no recovery points doesn't say how deep it is.
        let near = found.faces.map_or(found.size, |faces| faces + tolerance);
        let (severity, limit) = match found.distance > found.size.max(near) {
            true => (Severity::Error, found.size.max(near)),
            false => (Severity::Warning, near),
        };
        (found.distance > limit).then(|| {
            Finding::new(
                severity,
                "point-off-element",
                &g.name,
                format!(
                    "{}:{}: the point stated for gauge `{}` lies {} {unit} from its element {element}, which is {} {unit} large: the strain is \
                     that of the element",
                    g.file, g.line, g.name, short(found.distance), short(found.size)
                ),
                "correct the point or the element, or state one of the two alone",
            )
            .with_numbers(found.distance, limit)
        })
    };
    job.gauges.iter().filter_map(of).collect()
}

/// A gauge that can't be laid, as a fault at the line that states it.
pub fn not_laid(g: &JobGauge, e: &GaugeError) -> Fault {
    let (wrong, remedy) = e.parts();
    Fault::at(&*g.file, g.line, "gauge", wrong, remedy)
}

/// Faults of gauges without strain, at the line that states them.
pub fn without_strain(job: &Job, missing: &[NoStrain]) -> Faults {
    let mut out: FaultList = Vec::new();
    for m in missing {
        let stated = job
            .gauges
            .iter()
            .find(|g| g.name == m.gauge || m.gauge.starts_with(&format!("{}.", g.name)));
        let (file, line) = stated.map_or((job.file.as_str(), 0), |g| (g.file.as_str(), g.line));
        let wrong = format!("gauge `{}`: {}", m.gauge, m.wrong());
        let field = match m.why {
            NoStrainCause::Absent => "element",
            NoStrainCause::BetweenStations => "station",
        };
        let fault = Fault::at(file, line, field, wrong, m.remedy());
        if !out
            .iter()
            .any(|f| f.line == fault.line && f.file == fault.file)
        {
            out.push(fault);
        }
    }
    let unknown = Fault::of(
        &*job.file,
        "gauge",
        "a gauge has no strain in some subcase",
        "ask for STRAIN of every element in every subcase",
    );
    Faults::or(out, unknown)
}
