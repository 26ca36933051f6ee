//! Elements that must receive a gauge.

use super::pool::Kind;
use super::task::Task;
use crate::host::fault::Fault;
use crate::placement::candidates::Choice;
use crate::placement::required_places::with_one_in_each;
use crate::placement::{Layout, Spec};

/// Returns the gauges of a layout with one gauge on every wanted element; `None` if the job has no such elements.
///
/// # Errors Elements that are not candidates, more wanted elements than gauges, no place at the stated spacing.
pub(super) fn on_wanted(
    task: &Task,
    kind: &Kind,
    spec: &Spec,
    layout: &Layout,
) -> Result<Option<Vec<Choice>>, Fault> {
    let Some(wanted) = &task.job.candidates.wanted_elements else {
        return Ok(None);
    };
    let refuse = |wrong: String, remedy: &str| {
        let (file, line) = (&*task.job.file, task.job.candidates.line);
        Fault::with_line(file, line, "candidates.wanted_elements", wrong, remedy)
    };
    let mut places: Vec<(u32, usize)> = Vec::new();
    for (place, (shell, _)) in task.sites.iter().enumerate() {
        let element = task.fields.model().shells.get(shell.us());
        let id = element.map(|s| s.id).filter(|id| wanted.contains(*id));
        places.extend(id.map(|id| (id, place)));
    }
    places.sort_unstable();
    for [a, b] in &wanted.0 {
        if !places.iter().any(|(id, _)| (*a..=*b).contains(id)) {
            let wrong = match a == b {
                true => format!("element {a} is not a candidate"),
                false => format!("none of elements {a} to {b} is a candidate"),
            };
            let remedy = "name shells that the other keys of [candidates] allow";
            return Err(refuse(wrong, remedy));
        }
    }
    let groups: Vec<Vec<usize>> = places
        .chunk_by(|a, b| a.0 == b.0)
        .map(|g| g.iter().map(|p| p.1).collect())
        .collect();
    if groups.len() > layout.gauges.len() {
        let (elements, gauges) = (groups.len(), layout.gauges.len());
        let wrong = format!("{elements} elements for {gauges} gauges");
        return Err(refuse(wrong, "want fewer elements, or place more gauges"));
    }
    with_one_in_each(&kind.candidates, spec, layout.gauges.clone(), &groups)
        .map(Some)
        .map_err(|group| {
            let ids: Vec<u32> = places.chunk_by(|a, b| a.0 == b.0).map(|g| g[0].0).collect();
            let wrong = format!(
                "no gauge on element {} separates the loads with the stated spacing from the others",
                ids[group]
            );
            refuse(
                wrong,
                "reduce [placement] spacing, or want elements further apart",
            )
        })
}
