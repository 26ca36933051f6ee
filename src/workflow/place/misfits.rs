//! Chosen places at which a grid does not fit on the part.

use super::task::Task;
use crate::finding::Finding;
use crate::gauge::{Gauge, GaugeError, GaugeSpec};
use crate::host::fault::Fault;
use crate::job::Job;
use crate::placement::sites::Site;

/// Gauges on the model with their findings, or the reason why they can't be built.
type BuiltGauges = Result<(Vec<Gauge>, Vec<Finding>), GaugeError>;

/// Returns a gauge, reduced to a point if its grid is longer than the part, and the fault of a grid that does not fit.
pub(super) fn fit_gauge_to_part(
    job: &Job,
    spec: GaugeSpec,
    build: impl Fn(&GaugeSpec) -> BuiltGauges,
) -> (GaugeSpec, Option<Fault>) {
    let built = build(&spec);
    let misfit = misfit(job, &built);
    match built {
        Err(GaugeError::GridBeyondPart { .. }) => {
            let grid_length = 0.0;
            let at_point = GaugeSpec {
                grid_length,
                ..spec
            };
            (at_point, misfit)
        }
        _ => (spec, misfit),
    }
}

/// Returns the fault of a grid that is longer than the part or that reaches past its edge.
fn misfit(job: &Job, built: &BuiltGauges) -> Option<Fault> {
    let (wrong, remedy) = match built {
        Err(e @ GaugeError::GridBeyondPart { element, part, .. }) => (
            e.parts().0,
            format!(
                "lower [candidates] `grid_length` to {part:.4} or less, or add element {element} to [candidates] `exclude_elements`"
            ),
        ),
        Ok((_, findings)) => {
            let off = findings.iter().find(|f| f.code == "gauge-off-structure")?;
            let remedy = format!(
                "lower [candidates] `grid_length`, or exclude places near edges: [candidates] clear_of = {{ edges = {} }}",
                0.5 * job.candidates.grid_length
            );
            (off.clause().to_owned(), remedy)
        }
        Err(_) => return None,
    };
    let line = job.candidates.line;
    Some(Fault::with_line(
        &*job.file,
        line,
        "candidates.grid_length",
        wrong,
        remedy,
    ))
}

/// Leaves out the sites of chosen gauges whose grid does not fit. Returns one of their refusals, or `None` if every grid fits. `chosen` contains the
/// site, the element and the refusal of each gauge.
///
/// # Errors
/// The fault of a gauge that does not fit, if no further round is allowed or if the job names its element.
pub(super) fn leave_out<'a>(
    task: &mut Task,
    chosen: impl Iterator<Item = (Option<Site>, u32, Option<&'a Fault>)>,
    is_allowed: bool,
) -> Result<Option<Fault>, Fault> {
    let wanted = task.job.candidates.wanted_elements.as_ref();
    let mut out: Vec<Site> = Vec::new();
    let mut last = None;
    for (site, element, misfit) in chosen {
        let Some(misfit) = misfit else {
            continue;
        };
        if !is_allowed || wanted.is_some_and(|w| w.contains(element)) {
            return Err(misfit.clone());
        }
        out.extend(site);
        last = Some(misfit.clone());
    }
    task.sites.retain(|site| !out.contains(site));
    Ok(last)
}
