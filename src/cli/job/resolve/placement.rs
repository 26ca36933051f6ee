//! `[candidates]`, `[placement]`, `[study]`.

use super::super::faults::Collector;
use super::super::raw::{RawCandidates, RawPlacement, RawStudy};
use super::super::shapes::NumberOrWord;
use super::super::types::*;
use toml::Spanned;

/// Noise of a strain channel where the job says nothing, microstrain.
pub(super) const DEFAULT_NOISE_MICROSTRAIN: f64 = 1.0;
/// Angles of candidates where the job says nothing, degrees.
const DEFAULT_ANGLE_STEP_DEG: f64 = 15.0;

pub(super) fn default_criterion(loads: &[JobLoad]) -> Criterion {
    if loads.iter().any(|l| l.role == Role::Nuisance) {
        Criterion::Ds
    } else {
        Criterion::D
    }
}

pub(super) fn candidates(c: &mut Collector, raw: Option<&Spanned<RawCandidates>>) -> Candidates {
    let mut out = Candidates {
        properties: None,
        elements: None,
        surfaces: vec![Surface::Top, Surface::Bottom],
        angles: AngleStep::Degrees(DEFAULT_ANGLE_STEP_DEG),
        grid_length: 0.0,
        line: 0,
    };
    let Some(section) = raw else { return out };
    let raw = section.get_ref();
    out.line = c.line(section);
    out.properties = raw.properties.as_ref().map(|p| p.get_ref().clone());
    out.elements = raw.elements.as_ref().map(|p| p.get_ref().clone());
    if let Some(list) = &raw.surfaces {
        let choices = [("top", Surface::Top), ("bottom", Surface::Bottom)];
        out.surfaces = list
            .get_ref()
            .iter()
            .filter_map(|s| c.choose_at(s, "candidates.surfaces", &choices))
            .collect();
        out.surfaces.dedup();
        if list.get_ref().is_empty() {
            c.fault(
                list,
                "candidates.surfaces",
                "the list is empty",
                "name `top`, `bottom` or both",
            );
        }
    }
    match raw.angle_step_deg.as_ref().map(|a| (a, a.get_ref())) {
        None => {}
        Some((_, NumberOrWord::Number(x))) if *x > 0.0 && *x <= 180.0 => {
            out.angles = AngleStep::Degrees(*x)
        }
        Some((_, NumberOrWord::Word(w))) if w == "continuous" => out.angles = AngleStep::Continuous,
        Some((at, found)) => {
            let found = match found {
                NumberOrWord::Number(x) => x.to_string(),
                NumberOrWord::Word(w) => w.clone(),
            };
            let wrong =
                format!("`{found}`, expected degrees above 0 and up to 180, or \"continuous\"");
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
        c.choose_at(b, "candidates.bridge", &[("quarter", ())]);
    }
    out
}

pub(super) fn placement(
    c: &mut Collector,
    raw: Option<&Spanned<RawPlacement>>,
    criterion: Criterion,
) -> Placement {
    let mut out = Placement {
        gauges: None,
        criterion,
        spacing: 0.0,
        noise_microstrain: DEFAULT_NOISE_MICROSTRAIN,
        angle_tolerance_deg: 0.0,
        model_uncertainty_rel: 0.0,
        seed: 1,
        line: 0,
    };
    let Some(section) = raw else { return out };
    let raw = section.get_ref();
    out.line = c.line(section);
    out.gauges = c.count(&raw.gauges, "placement.gauges");
    out.criterion = c.choose(
        &raw.criterion,
        "placement.criterion",
        &[("D", Criterion::D), ("Ds", Criterion::Ds)],
        criterion,
    );
    out.spacing = c
        .at_least_zero(&raw.spacing, "placement.spacing")
        .unwrap_or(0.0);
    out.noise_microstrain = c
        .positive(&raw.noise_microstrain, "placement.noise_microstrain")
        .unwrap_or(DEFAULT_NOISE_MICROSTRAIN);
    out.angle_tolerance_deg = c
        .at_least_zero(&raw.angle_tolerance_deg, "placement.angle_tolerance_deg")
        .unwrap_or(0.0);
    out.model_uncertainty_rel = c
        .at_least_zero(
            &raw.model_uncertainty_rel,
            "placement.model_uncertainty_rel",
        )
        .unwrap_or(0.0);
    out.seed = raw.seed.as_ref().map_or(1, |s| *s.get_ref());
    out
}

pub(super) fn study(c: &mut Collector, raw: Option<&Spanned<RawStudy>>) -> Option<Study> {
    let section = raw?;
    let raw = section.get_ref();
    let layouts = match &raw.layouts {
        Some(l) => {
            let choices = [
                ("given", "given"),
                ("random", "random"),
                ("D", "D"),
                ("Ds", "Ds"),
            ];
            l.get_ref()
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
            &e.get_ref().kind,
            e,
            "study.errors.kind",
            "kind = \"relative-uniform\"",
        );
        let size = c.at_least_zero(&e.get_ref().size, "study.errors.size");
        if e.get_ref().size.is_none() {
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
            g.get_ref().0.iter().map(|n| *n as usize).collect()
        }),
        errors,
        trials: c.count(&raw.trials, "study.trials").unwrap_or(1000),
        seed: raw.seed.as_ref().map_or(1, |s| *s.get_ref()),
        line: c.line(section),
    })
}
