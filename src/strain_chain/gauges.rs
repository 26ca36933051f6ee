//! The job's gauges laid onto the model.

use super::Fields;
use super::specs::corrected_spec_of;
use super::stated_points::point_findings;
use crate::gauge::{Gauge, GaugeError, build, off_skin, on_unverified_elements};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::{Job, JobGauge};
use crate::sensitivity::{NoStrain, NoStrainCause, bar_points};

/// Returns the channels of the job's gauges, in job order. Findings are added to `work`.
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
    let stated = point_findings(fields.model(), job);
    for finding in stated.into_iter().chain(off_skin(fields.model(), &gauges)) {
        // A command that places the gauges twice reports each finding once.
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

/// Returns the fault of a gauge that cannot be placed, at the line that states the gauge.
pub fn not_laid(g: &JobGauge, e: &GaugeError) -> Fault {
    let (wrong, remedy) = e.parts();
    Fault::with_line(&*g.file, g.line, "gauge", wrong, remedy)
}

/// Returns the faults of gauges without strain, at the lines that state them.
pub fn without_strain(job: &Job, missing: &[NoStrain]) -> Faults {
    let mut out: FaultList = Vec::new();
    for m in missing {
        let stated = job
            .gauges
            .iter()
            .find(|g| g.name == m.gauge || m.gauge.starts_with(&format!("{}.", g.name)));
        let (file, line) = stated.map_or((job.file.as_str(), 0), |g| (g.file.as_str(), g.line));
        let wrong = format!("gauge `{}`: {}", m.gauge, m.describe_cause());
        let field = match m.why {
            NoStrainCause::Absent => "element",
            NoStrainCause::BetweenStations => "station",
        };
        let fault = Fault::with_line(file, line, field, wrong, m.remedy());
        if !out
            .iter()
            .any(|f| f.line == fault.line && f.file == fault.file)
        {
            out.push(fault);
        }
    }
    let unknown = Fault::new(
        &*job.file,
        "gauge",
        "a gauge has no strain in some subcase",
        "ask for STRAIN of every element in every subcase",
    );
    Faults::or(out, unknown)
}
