//! The whole workflow: find, name, judge.

use super::backdrop::{again, generous, of_fit, power};
use super::candidate::Candidate;
use super::change::Change;
use super::channel_check::{BrokenChannel, broken_channels};
use super::design::design;
use super::effect::library;
use super::fit::{Effort, MotionFit, Part, adjustments, fit};
use super::frame::MotionFrame;
use super::gap::{record_gap, share_floor, share_left};
use super::noise::Background;
use super::outcome::{MotionEffect, MotionOutcome};
use super::scorer::MotionScorer;
use crate::reconcile::outcome::{Gap, Rival, Verdict};
use crate::reconcile::search::{Breadth, Scored, search, settle};
use crate::vehicle::motion::VehicleError;
use crate::vehicle::term::UnitNames;

/// Log evidence that an effect must bring to be named.
const DECISIVE: f64 = 6.0;
/// Log evidence that is a hint.
const HINT: f64 = 1.0;
/// Rivals within this log evidence can't be told apart.
const CLOSE: f64 = 3.0;
/// How far the search looks.
const BREADTH: Breadth = Breadth {
    largest: 3,
    beam: 2,
    tries: 4,
    decisive: DECISIVE,
};
/// Reduced chi-square up to which a fit counts as at the floor of sensor noise: regressors carry noise of their own.
const AT_FLOOR: f64 = 1.6;
/// Share of the excess over the floor that may remain where everything is declared exact.
const REMAINDER: f64 = 0.04;
/// Share of the measured quantity that an imperfect background (declared tolerances) may leave without a word.
const SLACK: f64 = 0.04;
/// Share of the measured quantity that may be left by an imperfect background without a name: unmeasured couplings count, too.
const QUIET: f64 = 0.05;
/// Declared tolerances (1 sd) that a gain or delay must exceed to be a fault: what other channels may be off takes its share of one.
const BEYOND_TOLERANCE: f64 = 3.3;
/// Held-out gap over its floor up to which nothing is left to explain.
const AT_HELD_OUT_FLOOR: f64 = 1.25;
/// Share of the fitted record's gap to be closed all the same.
const CLOSED_TRANSIENT: f64 = 0.75;
/// Share of the closable gap that named effects must close where the background is imperfect.
const CLOSED_LOOSE: f64 = 0.6;
/// The same where no noise is declared.
const CLOSED_BLIND: f64 = 0.9;
/// Share of the closable gap on held-out data that named effects must close at least.
const PROVEN: f64 = 0.3;
/// Share of the closable gap that each named effect must close by itself.
const MATERIAL: f64 = 0.02;
/// The same where the background is imperfect.
const MATERIAL_LOOSE: f64 = 0.1;

/// Looks for the effects that part a record from its vehicle model; `only` limits the library to some ids.
///
/// # Errors
/// [`VehicleError`] when the record can't be fitted at all.
pub fn examine(frame: &MotionFrame, only: &[String]) -> Result<MotionOutcome, VehicleError> {
    let broken = broken_channels(frame);
    let first = design(
        frame,
        &frame.vehicle,
        &frame.data,
        &frame.corrections,
        vec![],
    )?;
    let candidates = library(frame, &first.motion, only);
    let none = Background::default();
    let null = fit(
        frame,
        &candidates,
        &frame.data,
        vec![],
        None,
        &none,
        Effort::Settled,
    )
    .ok_or_else(|| VehicleError::NoEquation(frame.vehicle.name.clone()))?;
    let mut scorer = MotionScorer {
        frame,
        candidates: &candidates,
        background: none,
        forms: vec![],
    };
    let mut all = Vec::new();
    let mut best: Option<Scored<MotionFit>> = None;
    let upheaval = upheaval(&scorer, &null);
    if let Some(found) = upheaval {
        scorer.background = of_fit(frame, &found.fit);
        let empty = Scored {
            set: vec![],
            log_evidence: -0.5 * null.chi2,
            fit: null.clone(),
        };
        best = Some(found.clone());
        all = vec![found, empty];
    } else if broken.is_empty() {
        scorer.background = generous(&mut scorer, &null);
        for _ in 0..3 {
            all = search(&mut scorer, BREADTH);
            best = settle(&all, DECISIVE);
            let Some(b) = &best else { break };
            let lower = of_fit(frame, &b.fit);
            if b.set.is_empty() || power(&lower) > 0.7 * power(&scorer.background) {
                break;
            }
            scorer.background = lower;
        }
    }
    let best = best.unwrap_or_else(|| Scored {
        set: vec![],
        log_evidence: 0.0,
        fit: null.clone(),
    });
    judged(&scorer, null, best, all, &broken)
}

/// An exchanged or turned channel, where nearly nothing is explained without and nearly everything with it.
fn upheaval(scorer: &MotionScorer, null: &MotionFit) -> Option<Scored<MotionFit>> {
    /// Share of the measured quantity left that makes one look.
    const LOST: f64 = 0.3;
    /// Fall of the squared residual that settles it.
    const FALL: f64 = 10.0;
    if record_gap(scorer.frame, null, &scorer.frame.data)?.gap < LOST {
        return None;
    }
    let tried = |(c, candidate): (usize, &Candidate)| {
        let part = Part {
            candidate: c,
            shape: candidate.shapes.first()?.clone(),
            fault: 0.0,
        };
        let f = fit(
            scorer.frame,
            scorer.candidates,
            &scorer.frame.data,
            vec![part],
            None,
            &Background::default(),
            Effort::Settled,
        )?;
        Some((c, f))
    };
    let (c, f) = scorer
        .candidates
        .iter()
        .enumerate()
        .filter(|(_, c)| c.is_upheaval())
        .filter_map(tried)
        .min_by(|a, b| a.1.chi2.total_cmp(&b.1.chi2))?;
    (FALL * f.chi2 < null.chi2).then(|| Scored {
        set: vec![c],
        log_evidence: -0.5 * f.chi2,
        fit: f,
    })
}

/// Fits under sensor noise alone, for chi-square.
fn by_noise(scorer: &MotionScorer, old: &MotionFit) -> MotionFit {
    again(scorer, old, &Background::default()).unwrap_or_else(|| old.clone())
}

fn judged(
    scorer: &MotionScorer,
    null: MotionFit,
    mut best: Scored<MotionFit>,
    all: Vec<Scored<MotionFit>>,
    broken: &[BrokenChannel],
) -> Result<MotionOutcome, VehicleError> {
    let frame = scorer.frame;
    let blind = frame.noise_acc.is_none() && frame.noise_force.is_none();
    let empty = all.iter().find(|s| s.set.is_empty()).cloned();
    let null_bg = empty.as_ref().map_or(&null, |s| &s.fit);
    let before_left = share_left(null_bg);
    let floor = share_floor(frame, null_bg);
    let closable = (before_left * before_left - floor * floor).max(0.0);
    let closed = |f: &MotionFit| {
        let after = share_left(f);
        if closable > 0.0 {
            (before_left * before_left - after * after) / closable
        } else {
            0.0
        }
    };
    // A set with a member that closes next to nothing isn't named.
    let material = if frame.is_loose() || blind {
        MATERIAL_LOOSE
    } else {
        MATERIAL
    };
    let all_material = |s: &Scored<MotionFit>| {
        let whole = closed(&s.fit);
        s.set.iter().all(|member| {
            let rest: Vec<usize> = s.set.iter().copied().filter(|m| m != member).collect();
            all.iter()
                .find(|s| s.set == rest)
                .is_none_or(|without| whole - closed(&without.fit) >= material)
        })
    };
    let nameable = |s: &Scored<MotionFit>| all_material(s) && beyond_tolerance(frame, &s.fit);
    if !nameable(&best) {
        let rest: Vec<Scored<MotionFit>> = all.iter().filter(|s| nameable(s)).cloned().collect();
        if let Some(b) = settle(&rest, DECISIVE) {
            best = b;
        }
    }
    let chi_null = by_noise(scorer, &null);
    let chi_best = by_noise(scorer, &best.fit);
    let reduced = |f: &MotionFit| f.chi2 / (f.n_rows.saturating_sub(f.columns.len())).max(1) as f64;
    let chi = [reduced(&chi_null), reduced(&chi_best)];
    let after_left = share_left(&best.fit);
    let share = closed(&best.fit);
    let null_evidence = empty.as_ref().map_or(best.log_evidence, |s| s.log_evidence);
    let evidence = best.log_evidence - null_evidence;
    let adequate = if blind {
        share > CLOSED_BLIND
    } else if frame.is_loose() {
        chi[1] < AT_FLOOR || share > CLOSED_LOOSE && after_left < 2.0 * SLACK
    } else {
        chi[1] < AT_FLOOR + REMAINDER * (chi[0] - 1.0).max(0.0)
    };
    let quiet = if blind {
        before_left < SLACK
    } else if frame.is_loose() {
        chi[0] < AT_FLOOR || before_left < QUIET
    } else {
        chi[0] < AT_FLOOR
    };
    let second = all.iter().find(|s| !s.set.is_empty());
    let hint = second.is_some_and(|s| s.log_evidence - null_evidence > HINT);
    let proof = frame.hold_out.as_ref().unwrap_or(&frame.data);
    let before = record_gap(frame, &chi_null, proof);
    let after = record_gap(frame, &best.fit, proof);
    let gap = Gap {
        before: before.as_ref().map_or(f64::NAN, |g| g.gap),
        after: after.as_ref().map_or(f64::NAN, |g| g.gap),
        floor: after
            .as_ref()
            .or(before.as_ref())
            .map_or(f64::NAN, |g| g.floor),
        mesh: 0.0,
    };
    // What was named must show on data that it was not fitted to.
    let proven =
        gap.after < gap.before && (gap.explained_share() > PROVEN || gap.before < 1.2 * gap.floor);
    // Held-out data at their own floor say more than a moment of the fitted record that a form misses (the jolt of a load).
    let at_floor = !frame.is_loose()
        && !blind
        && share > CLOSED_TRANSIENT
        && gap.after < AT_HELD_OUT_FLOOR * gap.floor;
    let adequate = adequate || at_floor;
    let decided = !best.set.is_empty() && evidence > DECISIVE && adequate && proven;
    let verdict = if !broken.is_empty() || decided {
        Verdict::Named
    } else if !quiet {
        Verdict::Unknown
    } else if hint && best.set.is_empty() {
        Verdict::BelowDetectability
    } else {
        Verdict::None
    };
    let attempt: Vec<MotionEffect> = if broken.is_empty() {
        named(scorer, &best.fit)
    } else {
        broken.iter().map(broken_effect).collect()
    };
    let rivals = rivals(scorer, &best, &all);
    let remains = remains(
        verdict,
        chi,
        after_left,
        floor,
        after.as_ref().or(before.as_ref()),
    );
    let next_measurement = next_measurement(scorer, verdict, &rivals);
    Ok(MotionOutcome {
        verdict,
        effects: if verdict == Verdict::Named {
            attempt.clone()
        } else {
            vec![]
        },
        best_attempt: attempt,
        corrections: adjustments(frame, &best.fit.parts),
        rivals,
        evidence,
        gap,
        before,
        after,
        reduced_chi2: chi,
        left: [before_left, after_left, floor],
        remains,
        next_measurement,
    })
}

/// Whether every gain and delay of a fit is more than a healthy channel of the declared tolerance may have.
fn beyond_tolerance(frame: &MotionFrame, fit: &MotionFit) -> bool {
    fit.parts.iter().zip(&fit.sizes).all(|(p, sizes)| {
        let size = sizes.first().map_or(0.0, |s| s[0]);
        match p.shape {
            Change::Gain { .. } => (size - 1.0).abs() > BEYOND_TOLERANCE * frame.gain_tolerance,
            Change::Delay { .. } => size.abs() > BEYOND_TOLERANCE * frame.sync_tolerance_s,
            _ => true,
        }
    })
}

fn broken_effect(b: &BrokenChannel) -> MotionEffect {
    MotionEffect {
        id: format!("{}:{}", b.id, b.channel),
        place: Some(b.channel.clone()),
        change: Change::Gain {
            channel: b.channel.clone(),
        },
        size: vec![b.measured],
        sigma: vec![f64::NAN],
        unit: String::new(),
        plausible: true,
    }
}

/// The effects of a fit in words and numbers.
fn named(scorer: &MotionScorer, fit: &MotionFit) -> Vec<MotionEffect> {
    let parameters = fit.assembled.vehicle.parameters();
    fit.parts
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let c = &scorer.candidates[p.candidate];
            let size: Vec<f64> = fit.sizes[i].iter().map(|s| s[0]).collect();
            let place = c.place.clone();
            let unit = match &p.shape {
                Change::Gain { .. } | Change::Flip { .. } | Change::Swap { .. } => "-".to_owned(),
                Change::Delay { .. } => "s".to_owned(),
                _ => fit.assembled.own[i]
                    .first()
                    .and_then(|&k| parameters.get(k))
                    .map_or_else(String::new, |q| {
                        unit_of(scorer.frame, &scorer.frame.units, fit, q.quantity)
                    }),
            };
            MotionEffect {
                id: c.id.clone(),
                place,
                change: p.shape.clone(),
                sigma: fit.sizes[i].iter().map(|s| s[1]).collect(),
                unit,
                plausible: size.iter().all(|v| v.is_finite()),
                size,
            }
        })
        .collect()
}

/// Unit of a quantity; a share of the reference mass where no force sets the scale.
fn unit_of(
    frame: &MotionFrame,
    units: &UnitNames,
    fit: &MotionFit,
    quantity: crate::vehicle::term::Quantity,
) -> String {
    let unit = units.of(quantity);
    let driven = fit
        .design
        .equations
        .iter()
        .any(|e| e.target.iter().any(|t| t.norm_sqr() > 0.0));
    if driven || frame.known.values().any(|v| *v != 0.0) {
        unit
    } else {
        format!("({unit})/({})", units.mass)
    }
}

/// Other sets, nearest first; sets that merely add to the best are no rivals. Where nothing is named, what came nearest.
fn rivals(
    scorer: &MotionScorer,
    best: &Scored<MotionFit>,
    all: &[Scored<MotionFit>],
) -> Vec<Rival> {
    /// As many as anyone reads.
    const MOST: usize = 4;
    let frame = scorer.frame;
    let proof = frame.hold_out.as_ref().unwrap_or(&frame.data);
    all.iter()
        .filter(|s| {
            let adds = !best.set.is_empty() && best.set.iter().all(|m| s.set.contains(m));
            !s.set.is_empty() && !adds
        })
        .take(MOST)
        .map(|s| {
            let difference = best.log_evidence - s.log_evidence;
            Rival {
                ids: s
                    .set
                    .iter()
                    .map(|&c| scorer.candidates[c].id.clone())
                    .collect(),
                evidence_difference: difference,
                gap_after: record_gap(frame, &s.fit, proof).map_or(f64::NAN, |g| g.gap),
                indistinguishable: difference < CLOSE,
            }
        })
        .collect()
}

fn remains(
    verdict: Verdict,
    chi: [f64; 2],
    left: f64,
    floor: f64,
    gap: Option<&super::gap::RecordGap>,
) -> String {
    let worst = gap.and_then(|g| {
        g.equations
            .iter()
            .max_by(|a, b| (a.gap / a.floor.max(1e-12)).total_cmp(&(b.gap / b.floor.max(1e-12))))
    });
    let place = worst.map_or_else(String::new, |e| {
        let band = e.by_band.iter().max_by(|a, b| a[1].total_cmp(&b[1]));
        let up_to = band.map_or_else(String::new, |b| {
            format!(", most of it in the band up to {:.1} Hz", b[0])
        });
        format!(" Largest in `{}`{up_to}.", e.name)
    });
    let state = match verdict {
        Verdict::Named if chi[1] < AT_FLOOR => "What is left is at the floor of sensor noise.",
        Verdict::None | Verdict::BelowDetectability if chi[0] < AT_FLOOR => {
            "Model and record agree within sensor noise."
        }
        Verdict::Unknown => "A gap remains that nothing in the library explains.",
        _ => "What is left is above sensor noise, within what the declared tolerances allow.",
    };
    format!(
        "{state} Left on the fitted record: {:.2} % of the measured quantity, sensor noise {:.2} %.{place}",
        100.0 * left,
        100.0 * floor
    )
}

fn next_measurement(scorer: &MotionScorer, verdict: Verdict, rivals: &[Rival]) -> String {
    let close: Vec<&Rival> = rivals.iter().filter(|r| r.indistinguishable).collect();
    let channel = |r: &&Rival| {
        r.ids.iter().all(|id| {
            scorer
                .candidates
                .iter()
                .any(|c| c.id == *id && c.is_channel())
        })
    };
    match (verdict, close.first()) {
        (Verdict::Named, Some(r)) if channel(r) => format!(
            "Turn the accelerometers over (2 g) or tap all of them at once: that tells it from {}.",
            r.ids.join(" + ")
        ),
        (Verdict::Named, Some(r)) => format!(
            "Drive a rougher and a smoother road: {} scales with amplitude in another way.",
            r.ids.join(" + ")
        ),
        (Verdict::Named, None) => "None needed; another road would confirm it.".into(),
        (Verdict::Unknown, _) => {
            "Measure what the model leaves out: the other side and axle, spring travel, a second accelerometer on each body.".into()
        }
        _ => "A rougher road or longer record would show smaller effects.".into(),
    }
}
