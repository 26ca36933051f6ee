//! The answer of one connected part of a vehicle, and how it joins the whole.

use super::adequacy::{ChannelFloor, check_adequacy, check_lost, check_noise};
use super::checks::at_bound;
use super::fit::Fit;
use super::identifiability::{absent_sentence, scale_sentence, weak_sentences};
use super::identification::{ChannelFit, Estimate, Identification, IdentifyTask};
use super::layout::{Parameter, Vehicle};
use super::loads::Blend;
use super::misfit::channel_misfits;
use super::motion::Motion;
use super::term::Quantity;

/// The fit of one connected part of a vehicle.
pub(super) struct PartAnswer {
    pub part: Vehicle,
    pub names: Vec<Parameter>,
    pub values: Vec<f64>,
    pub covariance: Vec<Vec<f64>>,
    pub coverage_factor: f64,
    pub reference: Option<usize>,
    pub fit: Option<Fit>,
    pub unknown: Vec<usize>,
    pub blend: Blend,
    pub motion: Motion,
}

/// Adds the answer of a part to the answer of the vehicle.
pub(super) fn collect(
    task: &IdentifyTask,
    answer: &mut Identification,
    all: &[Parameter],
    part: PartAnswer,
    held: Option<&Motion>,
    floors: &[ChannelFloor],
) {
    answer.coverage_factor = answer.coverage_factor.max(part.coverage_factor);
    answer.findings.extend(part.motion.findings.iter().cloned());
    put_parameters(task, answer, all, &part);
    put_ratios(task, answer, &part);
    put_unidentifiable(answer, &part);
    if part.fit.is_none() {
        return;
    }
    put_fit(answer, &part, held, floors);
    for (wheel, shares) in part.part.wheels.iter().zip(part.blend) {
        let at = (answer.vehicle.wheels.iter()).position(|x| x.channel == wheel.channel);
        if let Some(w) = at {
            answer.blend[w] = shares;
        }
    }
}

impl PartAnswer {
    fn sigma(&self, i: usize) -> f64 {
        self.covariance[i][i].max(0.0).sqrt()
    }
}

fn put_parameters(
    task: &IdentifyTask,
    answer: &mut Identification,
    all: &[Parameter],
    part: &PartAnswer,
) {
    let at: Vec<usize> = part
        .names
        .iter()
        .map(|p| all.iter().position(|q| q.name == p.name).unwrap_or(0))
        .collect();
    let scaled = part.reference.is_none() && part.fit.is_some();
    for (i, p) in part.names.iter().enumerate() {
        let sigma = part.sigma(i);
        let known = task.known.contains_key(&p.name);
        let value = part.values[i];
        answer.values[at[i]] = value;
        answer.sigmas[at[i]] = if known { 0.0 } else { sigma };
        answer.scaled[at[i]] = scaled;
        for j in 0..part.names.len() {
            answer.covariance[at[i]][at[j]] = part.covariance[i][j];
        }
        let identifiable = value.is_finite() && (known || scaled && !part.unknown.contains(&i));
        let shown = scaled
            .then_some(value)
            .or(known.then_some(value))
            .filter(|v| v.is_finite());
        let half = part.coverage_factor * sigma;
        answer.parameters.push(Estimate {
            name: p.name.clone(),
            value: shown,
            sigma: shown.map(|_| if known { 0.0 } else { sigma }),
            unit: task.units.unit_name(p.quantity),
            identifiable,
            interval: shown.map(|v| if known { [v, v] } else { [v - half, v + half] }),
            known,
        });
    }
}

/// Ratios to the reference mass, where no force sets the scale.
fn put_ratios(task: &IdentifyTask, answer: &mut Identification, part: &PartAnswer) {
    let Some(r) = part.reference else { return };
    let units = &task.units;
    let reference = &part.names[r].name;
    let finite = |i: &usize| part.values[*i].is_finite();
    for i in (0..part.names.len()).filter(|i| *i != r && finite(i)) {
        let (p, value) = (&part.names[i], part.values[i]);
        let sigma = part.sigma(i);
        let half = part.coverage_factor * sigma;
        answer.parameters.push(Estimate {
            name: format!("{}/{reference}", p.name),
            value: Some(value),
            sigma: Some(sigma),
            unit: format!(
                "({})/({})",
                units.unit_name(p.quantity),
                units.unit_name(Quantity::Mass)
            ),
            identifiable: !part.unknown.contains(&i),
            interval: Some([value - half, value + half]),
            known: false,
        });
    }
    let group: Vec<String> = (0..part.names.len())
        .filter(finite)
        .map(|i| part.names[i].name.clone())
        .collect();
    let springs: Vec<String> = part
        .names
        .iter()
        .filter(|p| p.quantity == Quantity::Stiffness)
        .map(|p| p.name.clone())
        .collect();
    answer
        .unidentifiable
        .push(scale_sentence(&group, reference, &springs));
}

/// Adds messages on parameters that are not determined, and on parameters at their bounds.
fn put_unidentifiable(answer: &mut Identification, part: &PartAnswer) {
    let absent: Vec<String> = (0..part.names.len())
        .filter(|&i| !part.values[i].is_finite())
        .map(|i| part.names[i].name.clone())
        .collect();
    if !absent.is_empty() {
        let channels: Vec<String> = part
            .part
            .wheels
            .iter()
            .zip(&part.motion.forces)
            .filter(|(_, f)| f.is_none())
            .map(|(w, _)| w.channel.clone())
            .collect();
        answer
            .unidentifiable
            .push(absent_sentence(&absent, &channels));
    }
    let Some(f) = &part.fit else { return };
    answer
        .unidentifiable
        .extend(weak_sentences(f, &part.names, &part.unknown));
    for &i in &f.active {
        let p = &part.names[i];
        let is_damping = p.quantity == Quantity::Damping;
        answer
            .findings
            .push(at_bound(&p.name, f.values[i], is_damping));
    }
    let values = &f.solution.singular_values;
    if let (Some(a), Some(b)) = (values.first(), values.last()) {
        answer.conditioning = answer.conditioning.min(b / a);
    }
}

/// Adds the residual of each channel, and whether a complete model would leave such a residual.
fn put_fit(
    answer: &mut Identification,
    part: &PartAnswer,
    held: Option<&Motion>,
    floors: &[ChannelFloor],
) {
    let fitted = channel_misfits(&part.part, &part.values, &part.motion, &part.blend);
    let hold_out_misfits = held.map(|h| channel_misfits(&part.part, &part.values, h, &part.blend));
    // A model without parameter values explains none of the signal.
    let share = |error: &f64, size: &f64| match (error / size).is_finite() {
        true => error / size,
        false => 1.0,
    };
    for (i, (channel, error, size)) in fitted.iter().enumerate() {
        let held_out = hold_out_misfits.as_ref().and_then(|j| j.get(i));
        let own = share(error, size);
        let (relative_rms, size, on) = match held_out {
            Some((_, e, s)) => (share(e, s), *s, "hold-out"),
            None => (own, *size, "fitted"),
        };
        let (tested_share, size, tested_on) = if part.part.changes() {
            (own, fitted[i].2, "fitted")
        } else {
            (relative_rms, size, on)
        };
        let floor = floors.iter().find(|f| f.channel == *channel);
        if let Some(f) = floor {
            let shares = [f.expected / size, f.limit / size];
            answer
                .findings
                .extend(check_adequacy(channel, tested_share, shares, tested_on));
            answer
                .findings
                .extend(check_noise(channel, f.noise / size, tested_on));
        } else {
            answer
                .findings
                .extend(check_lost(channel, tested_share, tested_on));
        }
        answer.fit.push(ChannelFit {
            channel: channel.clone(),
            relative_rms,
            relative_rms_fitted: own,
            floor: floor.map(|f| f.expected / size),
            on,
        });
        let wheel = (answer.vehicle.wheels.iter()).position(|w| w.channel == *channel);
        if let Some(w) = wheel {
            let larger = error.max(held_out.map_or(0.0, |h| h.1));
            answer.wheel_force_sigma[w] = Some(larger).filter(|s| s.is_finite());
        }
    }
}
