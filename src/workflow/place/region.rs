//! Where the job lets gauges go.

use crate::gauge::centre;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::{Job, LoadActs, PropertyIds, Region};
use crate::model::{Model, ShellIx, Vec3};
use crate::placement::region::{
    Segment, attachments, borders, clear_of, free_edges, hole_rims, joints,
};
use crate::placement::sites::Site;
use crate::strain_chain::Fields;
use std::collections::BTreeSet;

/// Surfaces where the job lets gauges go, among shells with strain in every case.
///
/// # Errors
/// No surface is left, or the deck lacks a SET, an element or a property.
pub fn allowed_sites(job: &Job, fields: &Fields, common: &[ShellIx]) -> Result<Vec<Site>, Faults> {
    allowed_sites_and_rule(job, fields, common).map(|(sites, _)| sites)
}

/// Rule of `clear_of` that excludes the most shells, with the number of shells before and after it.
pub(super) struct ClearRule {
    /// The rule, as in `joints = 110`.
    pub rule: String,
    pub left: usize,
    pub of: usize,
}

impl ClearRule {
    /// Whether the rule, not the spacing, is what most places are lost to.
    pub(super) fn takes_most(&self) -> bool {
        2 * self.left < self.of
    }

    /// Returns a clause on the rule: "`clear_of` loads = 200 leaves 3 of 80 shells".
    pub(super) fn words(&self) -> String {
        let Self { rule, left, of } = self;
        format!("`clear_of` {rule} leaves {left} of {of} shells")
    }
}

/// [`allowed_sites`] with the rule of `clear_of` that excludes the most.
pub(super) fn allowed_sites_and_rule(
    job: &Job,
    fields: &Fields,
    common: &[ShellIx],
) -> Result<(Vec<Site>, Option<ClearRule>), Faults> {
    let rule = &job.candidates;
    let model = fields.model();
    check_ids(job, model)?;
    let sets = sets_of(job, fields)?;
    let mut shells: Vec<(ShellIx, Vec3)> = Vec::new();
    for &ix in common {
        let Some(shell) = model.shells.get(ix.us()) else {
            continue;
        };
        let property = model
            .shell_properties
            .get(shell.property.us())
            .map_or(0, |p| p.id);
        let among =
            |ids: &Option<crate::job::Ids>, id: u32| ids.as_ref().map(|list| list.contains(id));
        let of = |ids: &Option<PropertyIds>| ids.as_ref().map(|list| list.contains(property));
        let allowed = of(&rule.properties) != Some(false)
            && among(&rule.elements, shell.id) != Some(false)
            && of(&rule.exclude_properties) != Some(true)
            && among(&rule.exclude_elements, shell.id) != Some(true)
            && (sets.is_empty()
                || sets
                    .iter()
                    .any(|s| s.has_element(shell.id, shell.shape.card())));
        let Some(x) = centre(model, shell).filter(|_| allowed) else {
            continue;
        };
        let inside = rule.boxes.is_empty() || rule.boxes.iter().any(|b| holds(b, x));
        if inside && !rule.exclude_boxes.iter().any(|b| holds(b, x)) {
            shells.push((ix, x));
        }
    }
    let clear = rule.clear;
    let rims = clear.holes.unwrap_or(clear.edges);
    let apart = rims != clear.edges;
    let limits: [(&str, f64, &dyn Fn() -> Vec<Segment>); 5] = [
        ("edges", clear.edges, &|| {
            if apart {
                borders(model)
            } else {
                free_edges(model)
            }
        }),
        ("holes", if apart { rims } else { 0.0 }, &|| {
            hole_rims(model)
        }),
        ("joints", clear.joints, &|| joints(model)),
        ("loads", clear.loads, &|| load_points(job, fields)),
        ("attachments", clear.attachments, &|| attachments(model)),
    ];
    let mut most: Option<ClearRule> = None;
    for (key, distance, segments) in limits.into_iter().filter(|l| l.1 > 0.0) {
        let of = shells.len();
        let points: Vec<Vec3> = shells.iter().map(|s| s.1).collect();
        let clear = clear_of(&points, &segments(), distance);
        let mut flags = clear.into_iter();
        shells.retain(|_| flags.next().unwrap_or(false));
        let left = shells.len();
        if most.as_ref().is_none_or(|m| of - left > m.of - m.left) {
            let rule = format!("{key} = {distance}");
            most = Some(ClearRule { rule, left, of });
        }
    }
    let sites: Vec<Site> = shells
        .iter()
        .flat_map(|(ix, _)| rule.surfaces.iter().map(|s| (*ix, *s)))
        .collect();
    if sites.is_empty() {
        let wrong = "no shell with strain in every load's subcase is among the candidates";
        let wrong = match most.filter(ClearRule::takes_most) {
            Some(cleared) => format!("{wrong}: {}", cleared.words()),
            None => wrong.to_owned(),
        };
        return Err(Faults::from(Fault::at(
            &*job.file,
            rule.line,
            "candidates",
            wrong,
            "widen `properties`, `elements` or `boxes`, reduce `clear_of`, or ask for STRAIN of more elements",
        )));
    }
    Ok((sites, most))
}

/// Refuses ids of properties, elements and reference grids that the model lacks: a misspelt exclusion would leave its place open for gauges.
///
/// # Errors
/// A fault for each such id.
fn check_ids(job: &Job, model: &Model) -> Result<(), Faults> {
    let rule = &job.candidates;
    let shells = model.shell_properties.iter().map(|p| p.id);
    let beams = model.beam_properties.iter().map(|p| p.id);
    let solids = model.solid_properties.iter().map(|p| p.id);
    let properties: BTreeSet<u32> = shells.chain(beams).chain(solids).collect();
    let elements: BTreeSet<u32> = model.elements().map(|e| model.element_id(e)).collect();
    let of = |list: &Option<PropertyIds>| list.as_ref().map(|p| p.ids.clone());
    let lists = [
        ("properties", &of(&rule.properties), &properties),
        (
            "exclude_properties",
            &of(&rule.exclude_properties),
            &properties,
        ),
        ("elements", &rule.elements, &elements),
        ("exclude_elements", &rule.exclude_elements, &elements),
    ];
    let mut faults = FaultList::new();
    for (key, ids, there) in lists {
        let what = match key.ends_with("properties") {
            true => "property of a shell, bar or solid",
            false => "element",
        };
        let ranges = ids.iter().flat_map(|ids| &ids.0);
        for [a, b] in ranges.filter(|[a, b]| there.range(*a..).next().is_none_or(|id| id > b)) {
            let range = match a == b {
                true => a.to_string(),
                false => format!("{a} to {b}"),
            };
            faults.push(Fault::at(
                &*job.file,
                rule.line,
                format!("candidates.{key}"),
                format!("the model has no {what} with the id {range}"),
                "correct the id, or delete it from the list",
            ));
        }
    }
    let placement = &job.placement;
    let missing = placement.references.iter();
    for (name, grid) in missing.filter(|r| model.grid_ix(r.1).is_none()) {
        faults.push(Fault::at(
            &*job.file,
            placement.line,
            "placement.references",
            format!("`{name}`: the model has no grid {grid}"),
            "correct the id, or delete the reference point",
        ));
    }
    Faults::check(faults)
}

/// The deck's SETs that the job names.
fn sets_of<'a>(job: &Job, fields: &'a Fields) -> Result<Vec<&'a nastran::bdf::Set>, Faults> {
    let Some(wanted) = &job.candidates.sets else {
        return Ok(Vec::new());
    };
    let control = &fields.deck.deck.case_control;
    let mut found = Vec::new();
    let mut faults = FaultList::new();
    for id in wanted.0.iter().flat_map(|[a, b]| *a..=*b) {
        let set = std::iter::once(&control.global)
            .chain(&control.subcases)
            .find_map(|s| s.sets.get(&id));
        match set {
            Some(s) => found.push(s),
            None => faults.push(Fault::at(
                &*job.file,
                job.candidates.line,
                "candidates.sets",
                format!("the deck's case control has no SET {id}"),
                "name a SET of element ids, or list `elements`",
            )),
        }
    }
    Faults::check(faults)?;
    Ok(found)
}

fn holds(region: &Region, x: Vec3) -> bool {
    region
        .iter()
        .zip([x.x, x.y, x.z])
        .all(|([low, high], v)| (*low..=*high).contains(&v))
}

fn load_points(job: &Job, fields: &Fields) -> Vec<Segment> {
    let model = fields.model();
    job.loads
        .iter()
        .filter_map(|l| match l.acts {
            LoadActs::AtGrid { grid, .. } => {
                let x = model.grids.get(model.grid_ix(grid)?.us())?.x;
                Some([x, x])
            }
            LoadActs::Set(_) | LoadActs::Named => None,
        })
        .collect()
}
