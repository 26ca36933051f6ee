//! Thermal strain of the structure from the model: a temperature set of the deck, and expansion that differs by material.
//!
//! A self-compensated gauge reads the mechanical strain. The job states the apparent strain that the gauge reads in addition. A linear temperature
//! field causes no strain in a free structure of one material. A gradient must therefore come from the analyst's own set (sun on one flange, a hot
//! exhaust).

use crate::fe::UnitLoad;
use crate::fe::strain_tensor::Surface;
use crate::gauge::Gauge;
use crate::host::fault::{Fault, Faults};
use crate::job::{Job, Reconcile};
use crate::model::{ElementTemperature, GridIx, MaterialKind, Model, TemperatureSet};
use crate::reconcile::NamedEffect;
use crate::reconcile::effect::{Extension, Nuisance};
use std::collections::HashMap;
use toml::{Table, Value};

/// Apparent strain per degree below which temperature has no effect, microstrain.
pub(super) const NOTHING: f64 = 0.02;

/// The model with temperature sets of one degree, and the unit loads that use them.
pub(super) struct UnitTemperatureModel {
    /// Model of the deck, with added temperature sets.
    pub(super) model: Model,
    /// Strain for one degree everywhere, if materials expand differently.
    pub(super) even: Option<UnitLoad>,
    /// Strain for a temperature pattern with one degree between the coldest and the warmest place of the deck's set.
    pub(super) pattern: Option<UnitLoad>,
    /// Temperatures of this pattern at the grids.
    shape: Option<TemperatureSet>,
}

impl UnitTemperatureModel {
    /// # Errors
    /// A set that the deck lacks, or that contains only one temperature.
    pub(super) fn from_job(job: &Job, model: &Model) -> Result<Self, Faults> {
        let top = |sids: Vec<u32>| sids.into_iter().max().unwrap_or(0);
        let free = top(model.temperatures.iter().map(|t| t.sid).collect())
            .max(top(model.load_sets.iter().map(|s| s.sid).collect()))
            .saturating_add(1);
        let (cold, warm, shape) = (free, free.saturating_add(1), free.saturating_add(2));
        let mut out = Self {
            model: model.clone(),
            even: None,
            pattern: None,
            shape: None,
        };
        out.model.temperatures.extend([
            uniform_temperature(cold, 0.0),
            uniform_temperature(warm, 1.0),
        ]);
        let load = |set| UnitLoad::Temperature {
            set,
            initial: Some(cold),
        };
        out.even = expands_unevenly(model).then(|| load(warm));
        if let Some((sid, reconcile)) = job
            .reconcile
            .as_ref()
            .and_then(|r| Some((r.temperature_set?, r)))
        {
            let set = scale_temperature_set(job, reconcile, model, sid, shape)?;
            out.model.temperatures.push(set.clone());
            out.shape = Some(set);
            out.pattern = Some(load(shape));
        }
        Ok(out)
    }

    /// Returns the pattern at each gauge: on its side of a shell, or the mean of the ends of its bar.
    pub(super) fn rises(&self, gauges: &[Gauge]) -> Vec<f64> {
        let Some(set) = &self.shape else {
            return vec![0.0; gauges.len()];
        };
        let at = set.by_grid(self.model.grids.len());
        let mean = |grids: &[GridIx]| {
            grids.iter().map(|g| at[g.us()]).sum::<f64>() / grids.len().max(1) as f64
        };
        let of = |gauge: &Gauge| {
            let own = set.elements.get(&gauge.element);
            if let Some(s) = self.model.shells.iter().find(|s| s.id == gauge.element) {
                let out = match gauge.surface {
                    Surface::Top => 0.5,
                    Surface::Bottom => -0.5,
                };
                let n = s.shape.n_corners();
                let thickness = s.thickness[..n].iter().sum::<f64>() / n as f64;
                return match own {
                    Some(ElementTemperature::Plate { mean, gradient }) => {
                        mean + gradient * out * thickness
                    }
                    _ => mean(&s.grids[..n]),
                };
            }
            match own {
                Some(ElementTemperature::Line { ends, .. }) => 0.5 * (ends[0] + ends[1]),
                _ => {
                    let mut beams = self.model.beams.iter();
                    let beam = beams.find(|b| b.id == gauge.element);
                    beam.map_or(0.0, |b| mean(&b.grids))
                }
            }
        };
        gauges.iter().map(of).collect()
    }

    /// Returns the unit loads that exist: even temperature first, then the pattern.
    pub(super) fn loads(&self) -> Vec<UnitLoad> {
        self.even.iter().chain(&self.pattern).cloned().collect()
    }
}

fn uniform_temperature(sid: u32, degrees: f64) -> TemperatureSet {
    TemperatureSet {
        sid,
        default: Some(degrees),
        grids: Vec::new(),
        elements: HashMap::new(),
        unsupported: Vec::new(),
        at: Default::default(),
    }
}

/// Shifts and scales the temperature set of the deck. Its coldest place then has 0 degrees, its warmest 1 degree.
fn scale_temperature_set(
    job: &Job,
    reconcile: &Reconcile,
    model: &Model,
    sid: u32,
    as_sid: u32,
) -> Result<TemperatureSet, Faults> {
    let fault = |wrong: String, remedy: &str| {
        Faults::from(Fault::with_line(
            &*job.file,
            reconcile.line,
            "reconcile.temperature_set",
            wrong,
            remedy,
        ))
    };
    let Some(set) = model.temperatures.iter().find(|t| t.sid == sid) else {
        return Err(fault(
            format!("the deck has no temperature set {sid}"),
            "name the set of its TEMP, TEMPD or TEMPP1 cards",
        ));
    };
    if let Some((card, _)) = set.unsupported.first() {
        return Err(fault(
            format!("temperature set {sid} selects {card}, which is not supported"),
            "give temperatures by TEMP, TEMPD and TEMPP1",
        ));
    }
    let [low, high] = extremes(model, set);
    let range = high - low;
    if !(range > 0.0 && range.is_finite()) {
        return Err(fault(
            format!("temperature set {sid} is uniform"),
            "delete it: `thermal_uniform` contains a uniform temperature already",
        ));
    }
    let default = set.default.unwrap_or(0.0);
    let of = |t: f64| (t - low) / range;
    Ok(TemperatureSet {
        sid: as_sid,
        default: Some(of(default)),
        grids: set.grids.iter().map(|(g, t)| (*g, of(*t))).collect(),
        elements: set
            .elements
            .iter()
            .map(|(id, t)| {
                let t = match *t {
                    ElementTemperature::Plate { mean, gradient } => ElementTemperature::Plate {
                        mean: of(mean),
                        gradient: gradient / range,
                    },
                    ElementTemperature::Line { ends, gradient } => ElementTemperature::Line {
                        ends: ends.map(of),
                        gradient: gradient.map(|g| g.map(|v| v / range)),
                    },
                };
                (*id, t)
            })
            .collect(),
        ..uniform_temperature(as_sid, 0.0)
    })
}

/// Returns the lowest and highest temperature that an element has in a set.
fn extremes(model: &Model, set: &TemperatureSet) -> [f64; 2] {
    let at = set.by_grid(model.grids.len());
    let of = |id: u32, grids: &[GridIx]| -> Vec<f64> {
        match set.elements.get(&id) {
            Some(ElementTemperature::Plate { mean, .. }) => vec![*mean],
            Some(ElementTemperature::Line { ends, .. }) => ends.to_vec(),
            None => grids.iter().map(|g| at[g.us()]).collect(),
        }
    };
    let shells = model.shells.iter();
    let shells = shells.flat_map(|s| of(s.id, &s.grids[..s.shape.n_corners()]));
    let lines = model.beams.iter().map(|b| (b.id, b.grids));
    let lines = lines.chain(model.rods.iter().map(|r| (r.id, r.grids)));
    let solids = model.solids.iter().flat_map(|s| s.grids.iter().flatten());
    shells
        .chain(lines.flat_map(|(id, grids)| of(id, &grids)))
        .chain(solids.map(|g| at[g.us()]))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| {
            [a.min(t), b.max(t)]
        })
}

/// Returns a `[[load]]` entry of the deck's temperature set, `role = "nuisance"`, if `thermal_gradient` was named. `usual` is the difference in
/// degrees between its coldest and warmest place, one standard deviation.
pub(super) fn entry(job: &Job, model: &Model, effects: &[NamedEffect]) -> Option<Value> {
    let sid = job.reconcile.as_ref()?.temperature_set?;
    let usual = effects.iter().find_map(|e| match &e.extension {
        Extension::NuisanceLoads {
            source: Nuisance::TemperatureGradient,
            loads,
            ..
        } => loads.first().cloned(),
        _ => None,
    })?;
    let [low, high] = extremes(model, model.temperatures.iter().find(|t| t.sid == sid)?);
    let mut t = Table::new();
    t.insert("name".into(), Value::String(usual.0));
    t.insert("load_set".into(), Value::Integer(i64::from(sid)));
    t.insert("role".into(), Value::String("nuisance".into()));
    t.insert("expected".into(), Value::Float(usual.1 / (high - low)));
    Some(Value::Table(t))
}

/// Returns whether an even temperature strains the structure. Its materials then expand differently, or one of them expands differently by direction.
fn expands_unevenly(model: &Model) -> bool {
    let mut seen: Option<f64> = None;
    let mut same = |alpha: f64| {
        let first = *seen.get_or_insert(alpha);
        (alpha - first).abs() <= 1e-6 * first.abs().max(alpha.abs())
    };
    !model.materials.iter().all(|m| match m.kind {
        MaterialKind::Isotropic { alpha, .. } => same(alpha),
        MaterialKind::Anisotropic2d { alpha, .. } => {
            same(alpha[0]) && same(alpha[1]) && alpha[2] == 0.0
        }
        MaterialKind::Orthotropic { alpha, .. } => alpha.into_iter().all(&mut same),
        MaterialKind::Anisotropic3d { alpha, .. } => {
            alpha[..3].iter().all(|a| same(*a)) && alpha[3..].iter().all(|a| *a == 0.0)
        }
    })
}
