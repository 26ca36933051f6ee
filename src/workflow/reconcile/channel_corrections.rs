//! Named faults of channels as `[[correction]]` entries, which apply to these readings and to all later readings.

use super::extended_model::ReadingCorrection;
use crate::job::correct::channel_of;
use crate::job::{Job, StrainCorrection};
use crate::reconcile::NamedEffect;
use crate::reconcile::effect::{Correction, Extension};
use crate::reconcile::strain::StrainFrame;
use toml::{Table, Value};

/// Conversion of the readings of a channel, as the job has them, into strain of the model: `(reading - offset) / factor`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Undo {
    offset: f64,
    factor: f64,
    ignore: bool,
    angle_deg: f64,
}

impl Undo {
    const NOTHING: Self = Self {
        offset: 0.0,
        factor: 1.0,
        ignore: false,
        angle_deg: 0.0,
    };

    /// Subtracts `offset` from the converted strain.
    fn subtract_offset(&mut self, offset: f64) {
        self.offset += self.factor * offset;
    }
}

/// Name of a place, and a change in the strain from the weight of a mass there, microstrain per kg by gauge. The written deck causes this change.
pub(super) type Weight = (String, Vec<f64>);

/// Returns the corrections of the named effects; `deck` is present for a job with a deck. Returns `None` if entries of a job can't express them. This
/// applies to channels that are exchanged in a ring or already corrected by the job. It also applies to an offset in a job with a zero record, in
/// which the offset cancels.
///
/// Faults of channels are undone first, in the reverse of the order in which they act. Then the strain of masses added after the zero is subtracted.
/// With a deck, a factor on all strain follows.
pub(super) fn corrections(
    job: &Job,
    frame: &StrainFrame,
    effects: &[NamedEffect],
    deck: Option<&[Weight]>,
) -> Option<Vec<ReadingCorrection>> {
    let has_deck = deck.is_some();
    let at = |name: &str| frame.gauges.iter().position(|g| g.name == name);
    let mut undo = vec![Undo::NOTHING; frame.n_gauges()];
    let mut exchanged: Vec<[usize; 2]> = Vec::new();
    for e in effects.iter().rev() {
        let Extension::Channels(list) = &e.extension else {
            continue;
        };
        for (name, correction) in list {
            let g = at(name)?;
            let own = undo.get_mut(g)?;
            match correction {
                Correction::Sign => own.factor = -own.factor,
                Correction::Gain(gain) if *gain != 0.0 => own.factor *= gain,
                Correction::Gain(_) | Correction::Ignore => own.ignore = true,
                Correction::Offset(offset) => own.subtract_offset(*offset),
                // With a given S, the row of S is turned instead.
                Correction::AngleDeg(by) if has_deck => own.angle_deg += by,
                Correction::AngleDeg(_) | Correction::PositionMm(_) => {}
                Correction::ExchangedWith(other) => {
                    let other = at(other)?;
                    let free = |g: usize| {
                        !exchanged.iter().flatten().any(|e| *e == g) && !is_corrected(job, frame, g)
                    };
                    if !(free(g) && free(other)) {
                        return None;
                    }
                    undo.swap(g, other);
                    exchanged.push([g, other]);
                }
            }
        }
    }
    for e in effects {
        match &e.extension {
            Extension::Mass { place, kilogram } => {
                let mass = frame.masses.iter().find(|m| m.place == *place)?;
                let gains = deck.iter().flat_map(|d| d.iter());
                let gains = gains.filter(|g| g.0 == *place).map(|g| &g.1);
                for per_kg in gains.chain([&mass.per_kg]) {
                    for (own, per_kg) in undo.iter_mut().zip(per_kg) {
                        own.subtract_offset(kilogram * per_kg);
                    }
                }
            }
            Extension::Scale(factor) if has_deck => {
                undo.iter_mut().for_each(|own| own.factor *= factor);
            }
            _ => {}
        }
    }
    let zeroed = job
        .measured
        .as_ref()
        .is_some_and(|m| m.zero.is_some() || !m.zero_runs.is_empty());
    if zeroed && undo.iter().any(|u| u.offset != 0.0) {
        return None;
    }
    let entry = |(g, own): (usize, &Undo)| {
        let name = &frame.gauges.get(g)?.name;
        let pair = exchanged.iter().find(|e| e[0] == g);
        let with = pair.and_then(|e| Some(frame.gauges.get(e[1])?.name.clone()));
        // The readings already contain the corrections of the job.
        let before = channel_of(&job.corrections, name).factor;
        (*own != Undo::NOTHING || with.is_some()).then(|| ReadingCorrection {
            gauge: name.clone(),
            factor: own.factor,
            offset_microstrain: own.offset * before,
            exchanged_with: with,
            angle_deg: own.angle_deg,
            ignore: own.ignore,
        })
    };
    Some(undo.iter().enumerate().filter_map(entry).collect())
}

/// Returns the corrections of gauges of a deck with a wrong angle. Rewritten readings can't contain them.
pub(super) fn angle_corrections(effects: &[NamedEffect], has_deck: bool) -> Vec<ReadingCorrection> {
    let lists = effects.iter().filter_map(|e| match &e.extension {
        Extension::Channels(list) if has_deck => Some(list),
        _ => None,
    });
    let one = |(gauge, correction): &(String, Correction)| match correction {
        Correction::AngleDeg(by) => Some(ReadingCorrection {
            gauge: gauge.clone(),
            factor: 1.0,
            offset_microstrain: 0.0,
            exchanged_with: None,
            angle_deg: *by,
            ignore: false,
        }),
        _ => None,
    };
    lists.flatten().filter_map(one).collect()
}

/// Returns whether the job corrects a channel already.
fn is_corrected(job: &Job, frame: &StrainFrame, gauge: usize) -> bool {
    let is_of = |c: &StrainCorrection, name: &str| {
        c.gauge == name || c.exchanged_with.as_deref() == Some(name)
    };
    let name = frame.gauges.get(gauge).map(|g| g.name.as_str());
    name.is_some_and(|name| job.corrections.iter().any(|c| is_of(c, name)))
}

/// Returns a correction of a job.
pub(super) fn entry(c: &ReadingCorrection) -> Value {
    let mut t = Table::new();
    t.insert("gauge".into(), Value::String(c.gauge.clone()));
    if c.factor < 0.0 {
        t.insert("sign".into(), Value::Integer(-1));
    }
    let gain = c.factor.abs();
    if gain != 1.0 {
        t.insert("gain".into(), Value::Float(gain));
    }
    if c.offset_microstrain != 0.0 {
        t.insert(
            "offset_microstrain".into(),
            Value::Float(c.offset_microstrain),
        );
    }
    if let Some(other) = &c.exchanged_with {
        t.insert("exchanged_with".into(), Value::String(other.clone()));
    }
    if c.angle_deg != 0.0 {
        t.insert("angle_deg".into(), Value::Float(c.angle_deg));
    }
    if c.ignore {
        t.insert("ignore".into(), Value::Boolean(true));
    }
    Value::Table(t)
}
