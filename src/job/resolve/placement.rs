//! `[candidates]`, `[placement]`, `[study]`.

use super::super::faults::Collector;
use super::super::raw_job::{RawCandidates, RawPlacement, RawStudy};
use super::super::shapes::{NumberOrWord, Texts};
use super::super::spanned_value::SpannedValue;
use super::super::types::*;
use super::gauge::{ROSETTES, SURFACES, bridges};
use crate::fe::strain_tensor::Surface;
use crate::gauge::Bridge;
use crate::placement::Loss;
use crate::study::ErrorKind;
use std::ops::Range;

/// Noise of a strain channel if the job states none, microstrain.
pub(super) const DEFAULT_NOISE_MICROSTRAIN: f64 = 1.0;
/// Step between the angles of candidates if the job states none, degrees.
const DEFAULT_ANGLE_STEP_DEG: f64 = 15.0;
/// Smallest step of angles, a tenth of the accuracy of installed gauges. Every place is tried at each angle, and "continuous" takes the best of all
/// angles.
const LEAST_ANGLE_STEP_DEG: f64 = 0.1;

pub(super) fn default_criterion(loads: &[JobLoad]) -> Optimality {
    if loads.iter().any(|l| l.role == LoadRole::Nuisance) {
        Optimality::Ds
    } else {
        Optimality::D
    }
}

pub(super) fn candidates(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawCandidates>>,
) -> Candidates {
    let mut out = Candidates {
        properties: None,
        elements: None,
        surfaces: vec![Surface::Top, Surface::Bottom],
        angles: AngleStep::Degrees(DEFAULT_ANGLE_STEP_DEG),
        grid_length: 0.0,
        bridges: vec![Bridge::Quarter],
        rosette: None,
        sets: None,
        exclude_properties: None,
        exclude_elements: None,
        wanted_elements: None,
        file: None,
        spots: None,
        boxes: Vec::new(),
        exclude_boxes: Vec::new(),
        clear: Clearances::default(),
        line: 0,
    };
    let Some(section) = raw else { return out };
    let raw = section.value();
    out.line = c.line(section);
    out.properties = raw.properties.as_ref().map(|p| p.value().clone());
    out.elements = raw.elements.as_ref().map(|p| p.value().clone());
    if let Some(list) = &raw.surfaces {
        out.surfaces = list
            .value()
            .iter()
            .filter_map(|s| c.choose_at(s, "candidates.surfaces", &SURFACES))
            .collect();
        out.surfaces.dedup();
        if list.value().is_empty() {
            c.fault(
                list,
                "candidates.surfaces",
                "the list is empty",
                "name `top`, `bottom` or both",
            );
        }
    }
    match raw.angle_step_deg.as_ref().map(|a| (a, a.value())) {
        None => {}
        Some((_, NumberOrWord::Number(x))) if (LEAST_ANGLE_STEP_DEG..=180.0).contains(x) => {
            out.angles = AngleStep::Degrees(*x)
        }
        Some((_, NumberOrWord::Word(w))) if w == "continuous" => out.angles = AngleStep::Continuous,
        Some((at, found)) => {
            let found = match found {
                NumberOrWord::Number(x) => x.to_string(),
                NumberOrWord::Word(w) => w.clone(),
            };
            let wrong = format!(
                "`{found}`, expected degrees from {LEAST_ANGLE_STEP_DEG} to 180, or \"continuous\""
            );
            c.fault(
                at,
                "candidates.angle_step_deg",
                wrong,
                "write 15, or \"continuous\"",
            );
        }
    }
    out.grid_length = c
        .at_least_zero(&raw.grid_length, "candidates.grid_length")
        .unwrap_or(0.0);
    if let Some(b) = &raw.bridge {
        let words = match b.value() {
            Texts::One(w) => vec![w.clone()],
            Texts::Many(list) => list.clone(),
        };
        let choices = bridges();
        out.bridges = words
            .into_iter()
            .filter_map(|w| {
                c.choose_at(
                    &SpannedValue::new(b.span(), w),
                    "candidates.bridge",
                    &choices,
                )
            })
            .collect();
        out.bridges.dedup();
        if out.bridges.is_empty() && raw.rosette.is_none() {
            let wrong = "the list contains no wiring";
            c.fault(b, "candidates.bridge", wrong, "name `quarter`, for one");
        }
    }
    out.rosette = raw
        .rosette
        .as_ref()
        .and_then(|r| c.choose_at(r, "candidates.rosette", &ROSETTES));
    let ids = |s: &Option<SpannedValue<Ids>>| s.as_ref().map(|v| v.value().clone());
    out.sets = ids(&raw.sets);
    out.exclude_properties = raw.exclude_properties.as_ref().map(|p| p.value().clone());
    out.exclude_elements = ids(&raw.exclude_elements);
    out.wanted_elements = ids(&raw.wanted_elements);
    out.file = c.named_file(&raw.file, "candidates.file");
    if out.file.as_ref().is_some_and(|f| !f.is_toml()) {
        refuse_search_keys(c, section);
    }
    out.boxes = boxes(c, &raw.boxes, "candidates.boxes");
    out.exclude_boxes = boxes(c, &raw.exclude_boxes, "candidates.exclude_boxes");
    if let Some(clear) = &raw.clear_of {
        let mut least =
            |v: &Option<SpannedValue<f64>>, key: &str| c.at_least_zero(v, key).unwrap_or(0.0);
        out.clear = Clearances {
            edges: least(&clear.edges, "candidates.clear_of.edges"),
            holes: (clear.holes.is_some())
                .then(|| least(&clear.holes, "candidates.clear_of.holes")),
            joints: least(&clear.joints, "candidates.clear_of.joints"),
            loads: least(&clear.loads, "candidates.clear_of.loads"),
            attachments: least(&clear.attachments, "candidates.clear_of.attachments"),
        };
    }
    out
}

/// Refuses the keys that describe where a search may put gauges: a table of spots states every place, side and direction.
fn refuse_search_keys(c: &mut Collector, section: &SpannedValue<RawCandidates>) {
    let raw = section.value();
    fn key_and_span<T>(
        key: &'static str,
        value: &Option<SpannedValue<T>>,
    ) -> Option<(&'static str, Range<usize>)> {
        value.as_ref().map(|v| (key, v.span()))
    }
    let stated = [
        key_and_span("properties", &raw.properties),
        key_and_span("elements", &raw.elements),
        key_and_span("surfaces", &raw.surfaces),
        key_and_span("angle_step_deg", &raw.angle_step_deg),
        key_and_span("grid_length", &raw.grid_length),
        key_and_span("bridge", &raw.bridge),
        key_and_span("rosette", &raw.rosette),
        key_and_span("sets", &raw.sets),
        key_and_span("exclude_properties", &raw.exclude_properties),
        key_and_span("exclude_elements", &raw.exclude_elements),
        key_and_span("wanted_elements", &raw.wanted_elements),
        key_and_span("boxes", &raw.boxes),
        key_and_span("exclude_boxes", &raw.exclude_boxes),
        (raw.clear_of.is_some()).then(|| ("clear_of", section.span())),
    ];
    for (key, span) in stated.into_iter().flatten() {
        let remedy = match key {
            "grid_length" | "bridge" | "rosette" => {
                format!("delete the key, and state the column `{key}` of the table instead")
            }
            _ => "delete the key, and the rows of spots that are not wanted".to_owned(),
        };
        c.fault(
            &SpannedValue::new(span, ()),
            &format!("candidates.{key}"),
            "`file` is a table of spots, which states every place: this key has no use",
            remedy,
        );
    }
}

/// Boxes of two or three ranges, each low before high.
fn boxes(
    c: &mut Collector,
    raw: &Option<SpannedValue<Vec<Vec<[f64; 2]>>>>,
    key: &str,
) -> Vec<Region> {
    let Some(list) = raw else { return Vec::new() };
    for b in list.value() {
        let ranges = (2..=3).contains(&b.len());
        if !ranges || b.iter().any(|[low, high]| !(low <= high)) {
            c.fault(
                list,
                key,
                "a box is two or three ranges [low, high]",
                "write [[[0, 1000], [-50, 50], [0, 300]]]",
            );
        }
    }
    list.value().clone()
}

pub(super) fn placement(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawPlacement>>,
    measured: Option<&Measured>,
    criterion: Optimality,
) -> Placement {
    // Values of `[measured]` apply to the plan, unless the plan states its own.
    let noise = measured.map_or(DEFAULT_NOISE_MICROSTRAIN, |m| m.noise_microstrain);
    let model = measured.map_or(0.0, |m| m.model_uncertainty_rel);
    let mut out = Placement {
        proof: true,
        gauges: None,
        criterion,
        spacing: 0.0,
        noise_microstrain: noise,
        angle_tolerance_deg: 0.0,
        model_uncertainty_rel: model,
        seed: 1,
        position_tolerance: 0.0,
        gauge_factor_rel: 0.0,
        noise_by_bridge: Vec::new(),
        loss: Loss::Judged,
        keep: Keep::None,
        symmetric: None,
        costs: Vec::new(),
        budget: None,
        curve: Vec::new(),
        reserve: 0,
        references: Vec::new(),
        line: 0,
    };
    let Some(section) = raw else { return out };
    let raw = section.value();
    out.line = c.line(section);
    out.gauges = c.count(&raw.gauges, "placement.gauges");
    out.criterion = c.choose(
        &raw.criterion,
        "placement.criterion",
        &[
            Optimality::D,
            Optimality::Ds,
            Optimality::A,
            Optimality::I,
            Optimality::BayesianD,
            Optimality::Condition,
        ]
        .map(|k| (k.name(), k)),
        criterion,
    );
    out.spacing = c
        .at_least_zero(&raw.spacing, "placement.spacing")
        .unwrap_or(0.0);
    out.noise_microstrain = c
        .positive_number(&raw.noise_microstrain, "placement.noise_microstrain")
        .unwrap_or(noise);
    out.angle_tolerance_deg = c
        .at_least_zero(&raw.angle_tolerance_deg, "placement.angle_tolerance_deg")
        .unwrap_or(0.0);
    out.model_uncertainty_rel = c
        .fraction(
            &raw.model_uncertainty_rel,
            "placement.model_uncertainty_rel",
        )
        .unwrap_or(model);
    out.seed = raw.seed.as_ref().map_or(1, |s| *s.value());
    out.position_tolerance = c
        .at_least_zero(&raw.position_tolerance, "placement.position_tolerance")
        .unwrap_or(0.0);
    out.gauge_factor_rel = c
        .fraction(&raw.gauge_factor_rel, "placement.gauge_factor_rel")
        .unwrap_or(0.0);
    let bridges = bridges();
    for (name, noise) in &raw.noise_by_bridge {
        let key = "placement.noise_by_bridge";
        let bridge = c.choose_at(name, key, &bridges);
        let noise = c.positive_number(&Some(noise.clone()), key);
        out.noise_by_bridge.extend(bridge.zip(noise));
    }
    let kinds: Vec<(&str, &str)> = Bridge::ALL
        .iter()
        .map(|b| (b.name(), b.name()))
        .chain([("rosette", "rosette")])
        .collect();
    for (name, cost) in &raw.costs {
        let kind = c.choose_at(name, "placement.costs", &kinds);
        let cost = c.positive_number(&Some(cost.clone()), "placement.costs");
        out.costs.extend(kind.map(str::to_owned).zip(cost));
    }
    out.budget = c.positive_number(&raw.budget, "placement.budget");
    out.loss = c.choose(
        &raw.loss,
        "placement.loss",
        &[("judge", Loss::Judged), ("optimise", Loss::Optimised)],
        Loss::Judged,
    );
    out.keep = match raw.keep.as_ref().map(SpannedValue::value) {
        None => Keep::None,
        Some(Texts::One(w)) if w == "all" => Keep::All,
        Some(Texts::One(w)) => Keep::Named(vec![w.clone()]),
        Some(Texts::Many(list)) => Keep::Named(list.clone()),
    };
    out.symmetric = raw
        .symmetric
        .as_ref()
        .and_then(|s| c.choose_at(s, "placement.symmetric", &[("x", 0), ("y", 1), ("z", 2)]));
    out.curve = raw.curve.as_ref().map_or_else(Vec::new, |n| {
        n.value().0.iter().map(|n| *n as usize).collect()
    });
    out.reserve = raw.reserve.as_ref().map_or(0, |n| *n.value() as usize);
    out.references = raw
        .references
        .iter()
        .map(|(name, grid)| (name.clone(), *grid))
        .collect();
    out
}

pub(super) fn study(c: &mut Collector, raw: Option<&SpannedValue<RawStudy>>) -> Option<Study> {
    let section = raw?;
    let raw = section.value();
    let layouts = match &raw.layouts {
        Some(l) => {
            let choices = [
                ("given", "given"),
                ("random", "random"),
                ("D", "D"),
                ("Ds", "Ds"),
            ];
            l.value()
                .iter()
                .filter_map(|w| c.choose_at(w, "study.layouts", &choices))
                .map(str::to_owned)
                .collect()
        }
        None => vec!["given".to_owned(), "random".to_owned(), "D".to_owned()],
    };
    let mut errors = Vec::new();
    for e in &raw.errors {
        let kind = c.require(
            &e.value().kind,
            e,
            "study.errors.kind",
            "kind = \"relative-uniform\"",
        );
        let is_relative = kind
            .as_deref()
            .and_then(ErrorKind::from_word)
            .is_some_and(ErrorKind::is_relative);
        let size = match is_relative {
            true => c.fraction(&e.value().size, "study.errors.size"),
            false => c.at_least_zero(&e.value().size, "study.errors.size"),
        };
        if e.value().size.is_none() {
            c.fault(
                e,
                "study.errors.size",
                "this key is missing",
                "add `size = 0.1`",
            );
        }
        if let (Some(kind), Some(size)) = (kind, size) {
            errors.push((kind, size));
        }
    }
    Some(Study {
        layouts,
        gauges: raw.gauges.as_ref().map_or_else(Vec::new, |g| {
            g.value().0.iter().map(|n| *n as usize).collect()
        }),
        errors,
        trials: c.count(&raw.trials, "study.trials").unwrap_or(1000),
        seed: raw.seed.as_ref().map_or(1, |s| *s.value()),
        line: c.line(section),
    })
}
