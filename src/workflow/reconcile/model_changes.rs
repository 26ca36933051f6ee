//! Differences between the extended model and the job: path, old value and new value.

use super::deck_frame::DeckFrame;
use super::described_effects::effect_of;
use super::extended_loads::sizes_by_component;
use super::extended_model::{
    DECK, ExtendedModel, PAYLOAD, RUNS, ReadingCorrection, SENSITIVITY, STRAIN,
};
use super::stiffness::factor;
use crate::job::correct::{channel_of, turned_by};
use crate::job::{EffectSource, Job};
use crate::reconcile::NamedEffect;
use crate::reconcile::effect::{Correction, Extension, Nuisance, RecordedQuantity};
use crate::reconcile::strain::{StiffnessOf, StrainFrame};
use crate::units::number;
use serde::Serialize;

/// Change of the model by an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelChange {
    /// Id of the effect with its place.
    pub effect: String,
    /// File and key, card, row or column.
    pub path: String,
    /// Value in the job.
    pub old: String,
    /// Value in the extended model.
    pub new: String,
}

/// Path, old and new value.
pub(super) type Place = [String; 3];

/// Converts places into the changes by one effect.
pub(super) fn list_changes(effect: &str, places: Vec<Place>) -> Vec<ModelChange> {
    let one = |[path, old, new]: Place| ModelChange {
        effect: effect.to_owned(),
        path,
        old,
        new,
    };
    places.into_iter().map(one).collect()
}

/// Returns the changes of the model by the effects of strain; empty without an extended model.
pub(super) fn added_to_strain(
    job: &Job,
    frame: &StrainFrame,
    effects: &[NamedEffect],
    extended: Option<&ExtendedModel>,
    deck: Option<&DeckFrame>,
) -> Vec<ModelChange> {
    let Some(extended) = extended else {
        return Vec::new();
    };
    let held = EffectPlaceInputs {
        job,
        frame,
        extended,
        deck,
    };
    let of = |e: &NamedEffect| list_changes(&e.id, held.places(e));
    effects.iter().flat_map(of).collect()
}

/// Inputs for the places of an effect.
struct EffectPlaceInputs<'a> {
    job: &'a Job,
    frame: &'a StrainFrame,
    extended: &'a ExtendedModel,
    deck: Option<&'a DeckFrame>,
}

impl EffectPlaceInputs<'_> {
    fn places(&self, e: &NamedEffect) -> Vec<Place> {
        match &e.extension {
            Extension::Channels(list) => list.iter().map(|(g, c)| self.channel(g, c)).collect(),
            Extension::ZoneStiffness { place, percent } => {
                self.stiffness(StiffnessOf::Zone, place, *percent)
            }
            Extension::JointStiffness { place, percent } => {
                self.stiffness(StiffnessOf::Joint, place, *percent)
            }
            Extension::LocalStiffness { place, percent } => {
                self.stiffness(StiffnessOf::Local, place, *percent)
            }
            Extension::Described { id, size } => self.stiffness(StiffnessOf::Described, id, *size),
            Extension::Mass { place, kilogram } => self.mass(place, *kilogram),
            Extension::PayloadOffset { dx, dy } => vec![self.payload_place(*dx, *dy)],
            Extension::PayloadWeight => {
                vec![self.in_job("[payload] weight_in_model", "false", "true".into())]
            }
            Extension::Scale(factor) => vec![match self.deck {
                Some(_) => self.in_job(
                    "[[correction]] of every gauge, gain",
                    "times 1",
                    format!("times {}", number(*factor)),
                ),
                None => change_at(
                    format!("{SENSITIVITY}: every entry"),
                    "times 1",
                    format!("times {}", number(*factor)),
                ),
            }],
            Extension::LoadScale { load, factor } => vec![change_at(
                format!("{RUNS}: column {load}"),
                "as recorded",
                format!("divided by {}", number(*factor)),
            )],
            Extension::RunExchange { runs } => vec![change_at(
                format!("{RUNS}: rows {}", runs.join(" and ")),
                "as recorded",
                "loads and payload exchanged".into(),
            )],
            Extension::RunRecord { run, noted, .. } => self.record(run, *noted),
            Extension::NuisanceLoads {
                source: Nuisance::Ground,
                ..
            } => {
                let size = e.size.first().copied().unwrap_or(0.0);
                let found = format!("{} kN rms, estimated in every run", number(size));
                vec![self.in_job("[runs] ground", "none", found)]
            }
            Extension::NuisanceLoads { source, loads, .. } => {
                let names: Vec<&str> = loads.iter().map(|l| l.0.as_str()).collect();
                let sizes = match source {
                    Nuisance::SideLoads => sizes_by_component(&e.size),
                    _ => {
                        let list: Vec<String> = e.size.iter().map(|s| number(*s)).collect();
                        format!("{} {}", list.join(", "), e.unit)
                    }
                };
                let found = format!("nuisance loads, found {sizes} rms");
                vec![self.in_job(&format!("[[load]] {}", names.join(", ")), "none", found)]
            }
            Extension::Nothing => Vec::new(),
        }
    }

    fn in_job(&self, key: &str, old: &str, new: String) -> Place {
        change_at(format!("{}: {key}", self.extended.name), old, new)
    }

    fn channel(&self, gauge: &str, correction: &Correction) -> Place {
        let in_s =
            |what: String| change_at(format!("{SENSITIVITY}: row {gauge}"), "as drawn", what);
        let turned = matches!(correction, Correction::AngleDeg(_));
        match correction {
            Correction::AngleDeg(by) if self.deck.is_none() => {
                in_s(format!("turned by {} degrees", number(*by)))
            }
            Correction::PositionMm(by) => in_s(format!("moved by {} mm", number(*by))),
            _ if self.extended.readings.is_some() && !turned => {
                let (key, new) = key_of(correction);
                change_at(
                    format!("{STRAIN}: column {gauge}"),
                    "as read",
                    format!("corrected by {key} {new}"),
                )
            }
            _ => self.entry(gauge, correction),
        }
    }

    /// Returns the `[[correction]]` entry of a channel that undoes `correction`, with the value in the entries of the job.
    fn entry(&self, gauge: &str, correction: &Correction) -> Place {
        // A fault that acts before an exchange is entered for the channel with which its channel is exchanged.
        let has = |c: &&ReadingCorrection, name: &str| {
            c.gauge == name || c.exchanged_with.as_deref() == Some(name)
        };
        let list = self.extended.corrections.iter();
        let of_either = list
            .clone()
            .find(|c| c.exchanged_with.is_some() && has(c, gauge));
        let partner = of_either.and_then(|c| match c.gauge == gauge {
            true => c.exchanged_with.as_deref(),
            false => Some(c.gauge.as_str()),
        });
        let names = [Some(gauge), partner].into_iter().flatten();
        let (_, found) = key_of(correction);
        for name in names {
            let Some(c) = list.clone().find(|c| c.gauge == name) else {
                continue;
            };
            let before = channel_of(&self.job.corrections, name);
            let is_first = !self.job.corrections.iter().any(|c| c.gauge == name);
            // If a channel has several entries, their factors are multiplied, and their offsets and angles are added.
            let with = |key: &str, [old, new, both]: [f64; 3]| {
                let text = |v: f64| match key {
                    "sign" => format!("{v:.0}"),
                    _ => number(v),
                };
                let new = match is_first {
                    true => text(new),
                    false => format!("{} in a further entry, {} together", text(new), text(both)),
                };
                self.in_job(&format!("[[correction]] of {name}, {key}"), &text(old), new)
            };
            let sign = |v: f64| 1f64.copysign(v);
            let (f, o, turn) = (
                before.factor,
                before.offset,
                turned_by(&self.job.corrections, name),
            );
            match correction {
                Correction::Sign if c.factor < 0.0 => {
                    return with("sign", [sign(f), -1.0, -sign(f)]);
                }
                Correction::Gain(_) if c.ignore => {
                    let key = format!("[[correction]] of {name}, ignore");
                    return self.in_job(&key, "false", "true".into());
                }
                Correction::Gain(_) if c.factor.abs() != 1.0 => {
                    let (old, new) = (f.abs(), c.factor.abs());
                    return with("gain", [old, new, old * new]);
                }
                Correction::Offset(_) if c.offset_microstrain != 0.0 => {
                    let new = c.offset_microstrain;
                    return with("offset_microstrain", [o, new, o + new]);
                }
                Correction::AngleDeg(_) if c.angle_deg != 0.0 => {
                    return with("angle_deg", [turn, c.angle_deg, turn + c.angle_deg]);
                }
                _ => {}
            }
        }
        let (key, old) = match correction {
            Correction::ExchangedWith(_) => ("exchanged_with", "none"),
            Correction::Ignore => ("ignore", "false"),
            // Two effects that cancel each other leave no entry.
            Correction::Sign
            | Correction::Gain(_)
            | Correction::Offset(_)
            | Correction::AngleDeg(_)
            | Correction::PositionMm(_) => {
                let why = format!("unchanged: another effect cancels {found}");
                return self.in_job(&format!("[[correction]] of {gauge}"), "as it is", why);
            }
        };
        self.in_job(&format!("[[correction]] of {gauge}, {key}"), old, found)
    }

    /// Properties of the deck with their old and new values; of a given S the size alone.
    fn stiffness(&self, of: StiffnessOf, place: &str, size: f64) -> Vec<Place> {
        let (Some(deck), Some(factor)) = (self.deck, factor(self.job, of, place, size)) else {
            let unit = match of {
                StiffnessOf::Zone => " %",
                StiffnessOf::Joint | StiffnessOf::Local => " (natural log times 100)",
                StiffnessOf::Described => "",
            };
            let new = format!("{}{unit}", number(size));
            return vec![change_at(
                format!("{SENSITIVITY}: change by {place}"),
                "0",
                new,
            )];
        };
        let edit = effect_of(self.job, place).map(|e| &e.source);
        match (of, edit) {
            (StiffnessOf::Zone, _) => {
                let ids = deck.zones.get(place);
                thicknesses(deck, |id| ids.is_some_and(|i| i.contains(id)), factor)
            }
            (StiffnessOf::Described, Some(EffectSource::Thickness { property, .. })) => {
                thicknesses(deck, |id| id == *property, factor)
            }
            (StiffnessOf::Described, Some(EffectSource::Bush { element, .. })) => {
                joint(deck, &element.to_string(), factor)
            }
            (StiffnessOf::Joint, _) => joint(deck, place, factor),
            _ => Vec::new(),
        }
    }

    fn mass(&self, place: &str, kilogram: f64) -> Vec<Place> {
        let new = format!("{} kg", number(kilogram));
        let of_mass = format!("strain of {new} at {place}");
        let strain = match self.extended.readings {
            Some(_) => change_at(
                format!("{STRAIN}: every column"),
                "as read",
                format!("less the {of_mass}"),
            ),
            None => {
                let key = "[[correction]] of every gauge, offset_microstrain";
                self.in_job(key, "as it is", format!("plus the {of_mass}"))
            }
        };
        let card = self
            .deck
            .map(|_| change_at(format!("{DECK}: CONM2 at {place}"), "none", new));
        card.into_iter().chain([strain]).collect()
    }

    fn payload_place(&self, dx: f64, dy: f64) -> Place {
        if let Some(x_m) = self.extended.nominal_x_m {
            let old = format!("{} m", number(self.frame.payload_origin[0]));
            let new = format!("{} m", number(x_m));
            return change_at(
                format!("{}: [payload] nominal_x", self.extended.name),
                &old,
                new,
            );
        }
        let file = match self.deck {
            None => PAYLOAD,
            Some(_) => RUNS,
        };
        change_at(
            format!("{file}: place of the payload"),
            "as recorded",
            format!("moved by {} m and {} m to the left", number(dx), number(dy)),
        )
    }

    /// Returns the recorded values of a run that an effect corrects, with the old and the new value.
    fn record(&self, run: &str, noted: RecordedQuantity) -> Vec<Place> {
        let frame = self.frame;
        let n_l = frame.n_loads();
        let row = frame.observations.runs.iter().position(|r| r == run);
        let now = self.extended.runs.as_ref();
        let (Some(r), Some(now)) = (row, now) else {
            return Vec::new();
        };
        let load = |l: usize| {
            let name = frame.load_names.get(l)?;
            let old = frame.loads.get(r * n_l + l)?;
            let new = now.loads.get(r * n_l + l)?;
            let unit = load_unit(frame.is_moment(l));
            Some(change_at(
                format!("{RUNS}: run {run}, {name}"),
                &format!("{} {unit}", number(*old)),
                format!("{} {unit}", number(*new)),
            ))
        };
        match noted {
            RecordedQuantity::Load(l) => load(l).into_iter().collect(),
            RecordedQuantity::Loads => (0..n_l).filter_map(load).collect(),
            RecordedQuantity::Mass => {
                let old = frame.payload.get(r).map_or(0.0, |p| p[0]);
                let new = now.payload.get(r).map_or(old, |p| p[0]);
                let path = format!("{RUNS}: run {run}, payload_mass");
                vec![change_at(
                    path,
                    &format!("{} kg", number(old)),
                    format!("{} kg", number(new)),
                )]
            }
        }
    }
}

/// Returns the job key of a correction of a channel, and the value found.
fn key_of(correction: &Correction) -> (&'static str, String) {
    match correction {
        Correction::Sign => ("sign", "-1".into()),
        Correction::Gain(gain) => ("gain", number(*gain)),
        Correction::Offset(offset) => ("offset_microstrain", number(*offset)),
        Correction::ExchangedWith(other) => ("exchanged_with", other.clone()),
        Correction::AngleDeg(by) => ("angle_deg", number(*by)),
        Correction::PositionMm(by) => ("position", format!("{} mm", number(*by))),
        Correction::Ignore => ("ignore", "true".into()),
    }
}

fn load_unit(is_moment: bool) -> &'static str {
    match is_moment {
        true => "kN m",
        false => "kN",
    }
}

fn change_at(path: String, old: &str, new: String) -> Place {
    [path, old.to_owned(), new]
}

/// Thickness of the shell properties `wanted`, in the unit of the deck.
fn thicknesses(deck: &DeckFrame, wanted: impl Fn(u32) -> bool, factor: f64) -> Vec<Place> {
    let cards = deck.fields.deck.deck.cards.pshells.iter().map(|p| &p.card);
    let one = |(id, t): (u32, f64)| {
        change_at(
            format!("{DECK}: PSHELL {id}, T"),
            &number(t),
            number(t * factor),
        )
    };
    let known = cards.filter_map(|c| Some((c.id, c.t?)));
    known.filter(|(id, _)| wanted(*id)).map(one).collect()
}

/// Stiffness of a bush, in the units of the deck.
fn joint(deck: &DeckFrame, place: &str, factor: f64) -> Vec<Place> {
    let mut bushes = deck.fields.model().bushes.iter();
    let bush = bushes.find(|b| b.id.to_string() == place);
    let list = |factor: f64| {
        let k = bush.iter().flat_map(|b| b.k.iter().copied());
        let k: Vec<String> = k.map(|k: f64| number(k * factor)).collect();
        k.join(", ")
    };
    vec![change_at(
        format!("{DECK}: PBUSH of CBUSH {place}, K"),
        &list(1.0),
        list(factor),
    )]
}
