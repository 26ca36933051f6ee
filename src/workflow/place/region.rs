//! Where the job lets gauges go.

use crate::gauge::centre;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::{Ids, Job, LoadActs, PropertyIds, Region};
use crate::model::{Model, Shell, ShellIx, Vec3};
use crate::placement::region::{
    Segment, attachments, borders, clear_of, free_edges, hole_rims, joints,
};
use crate::placement::sites::Site;
use crate::strain_chain::Fields;
use std::collections::BTreeSet;

/// Returns the surfaces on which the job allows gauges, among shells with strain in every case.
///
/// # Errors
/// No surface is left, or the deck lacks a SET, an element or a property.
pub fn allowed_sites(job: &Job, fields: &Fields, common: &[ShellIx]) -> Result<Vec<Site>, Faults> {
    allowed_sites_and_rule(job, fields, common).map(|(sites, _)| sites)
}

/// Rule of `[candidates]` that excludes the most shells, with the number of shells before and after it.
pub(super) struct StrictRule {
    /// The rule, as in "`boxes`" or "`clear_of` joints = 110".
    pub rule: String,
    pub left: usize,
    pub of: usize,
}

impl StrictRule {
    /// Returns whether the rule excludes more places than the spacing.
    pub(super) fn takes_most(&self) -> bool {
        2 * self.left < self.of
    }

    /// Returns a clause on the rule: "`clear_of` loads = 200 leaves 3 of 80 shells".
    pub(super) fn words(&self) -> String {
        let Self { rule, left, of } = self;
        format!("{rule} leaves {left} of {of} shells")
    }

    /// Returns the stricter of two rules: the one that leaves no shell, else the one that excludes more.
    fn choose_stricter(a: Option<Self>, b: Self) -> Self {
        match a {
            Some(a) if a.left == 0 || b.left > 0 && a.of - a.left >= b.of - b.left => a,
            _ => b,
        }
    }
}

/// Whether a shell, with its id, its property and its centre, follows a rule.
type Follows<'a> = &'a dyn Fn(&Shell, u32, Vec3) -> bool;

/// Returns [`allowed_sites`] and the rule that excludes most shells.
pub(super) fn allowed_sites_and_rule(
    job: &Job,
    fields: &Fields,
    common: &[ShellIx],
) -> Result<(Vec<Site>, Option<StrictRule>), Faults> {
    let rule = &job.candidates;
    let model = fields.model();
    check_ids(job, model)?;
    let sets = sets_of(job, fields)?;
    let mut shells: Vec<(ShellIx, Vec3)> = Vec::new();
    for &ix in common {
        let shell = model.shells.get(ix.us());
        shells.extend(shell.and_then(|s| Some((ix, centre(model, s)?))));
    }
    let of = |ids: &Option<PropertyIds>, id: u32| ids.as_ref().is_some_and(|l| l.contains(id));
    let among = |ids: &Option<Ids>, id: u32| ids.as_ref().is_some_and(|l| l.contains(id));
    let in_set = |s: &Shell| sets.iter().any(|l| l.has_element(s.id, s.shape.card()));
    let in_box = |boxes: &[Region], x: Vec3| boxes.iter().any(|b| holds(b, x));
    let rules: [(&str, bool, Follows); 7] = [
        ("properties", rule.properties.is_some(), &|_, p, _| {
            of(&rule.properties, p)
        }),
        ("elements", rule.elements.is_some(), &|s, _, _| {
            among(&rule.elements, s.id)
        }),
        (
            "exclude_properties",
            rule.exclude_properties.is_some(),
            &|_, p, _| !of(&rule.exclude_properties, p),
        ),
        (
            "exclude_elements",
            rule.exclude_elements.is_some(),
            &|s, _, _| !among(&rule.exclude_elements, s.id),
        ),
        ("sets", !sets.is_empty(), &|s, _, _| in_set(s)),
        ("boxes", !rule.boxes.is_empty(), &|_, _, x| {
            in_box(&rule.boxes, x)
        }),
        (
            "exclude_boxes",
            !rule.exclude_boxes.is_empty(),
            &|_, _, x| !in_box(&rule.exclude_boxes, x),
        ),
    ];
    let mut most: Option<StrictRule> = None;
    for (key, _, follows) in rules.into_iter().filter(|r| r.1) {
        let of = shells.len();
        shells.retain(|(ix, x)| {
            let shell = model.shells.get(ix.us());
            shell.is_some_and(|s| {
                let property = model.shell_properties.get(s.property.us());
                follows(s, property.map_or(0, |p| p.id), *x)
            })
        });
        let (rule, left) = (format!("`{key}`"), shells.len());
        most = Some(StrictRule::choose_stricter(
            most,
            StrictRule { rule, left, of },
        ));
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
    for (key, distance, segments) in limits.into_iter().filter(|l| l.1 > 0.0) {
        let of = shells.len();
        let points: Vec<Vec3> = shells.iter().map(|s| s.1).collect();
        let clear = clear_of(&points, &segments(), distance);
        let mut flags = clear.into_iter();
        shells.retain(|_| flags.next().unwrap_or(false));
        let rule = format!("`clear_of` {key} = {distance}");
        let left = shells.len();
        most = Some(StrictRule::choose_stricter(
            most,
            StrictRule { rule, left, of },
        ));
    }
    let sites: Vec<Site> = shells
        .iter()
        .flat_map(|(ix, _)| rule.surfaces.iter().map(|s| (*ix, *s)))
        .collect();
    if sites.is_empty() {
        let wrong = "no shell with strain in every load's subcase is among the candidates";
        let (wrong, remedy) = match &most {
            Some(strict) if strict.of > 0 && strict.left == 0 => (
                format!("{wrong}: {}", strict.words()),
                format!("widen or delete {}", strict.rule),
            ),
            _ => (
                wrong.to_owned(),
                "ask for STRAIN of shells in every subcase".to_owned(),
            ),
        };
        let fault = Fault::with_line(&*job.file, rule.line, "candidates", wrong, remedy);
        return Err(Faults::from(fault));
    }
    Ok((sites, most))
}

/// Refuses ids of properties, elements and reference grids that the model lacks: a misspelt exclusion would leave its place open for gauges.
///
/// # Errors
/// A fault for each id that the deck lacks.
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
            faults.push(Fault::with_line(
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
        faults.push(Fault::with_line(
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
            None => faults.push(Fault::with_line(
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
