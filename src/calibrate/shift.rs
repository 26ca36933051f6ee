//! Shift of each gauge's row, and its likely cause.

use super::cause::off_drawing;
use super::prior::rows as model_rows;
use super::state::State;
use super::types::{GaugeShift, ShiftWord, Task};
use crate::finding::{Finding, Severity};
use crate::linalg::precision::Precision;
use crate::linalg::spd;

/// Distance above which a shift is reported.
const NOTABLE: f64 = 3.0;
/// Share of the shift that one cause must explain to be named.
const EXPLAINED: f64 = 0.8;
/// Scale under which a gauge is dead.
const DEAD: f64 = 0.1;
/// Noise sd that the largest reading of a live gauge exceeds.
const LIVE: f64 = 3.0;

/// Largest difference from the row of a cause, over the change that the cause makes, at which the cause explains a row.
const SAME: f64 = 0.3;
/// Largest posterior sd, over the change that a cause makes, at which the runs separate the cause from no change.
const SEPARATED_SD_REL: f64 = 0.2;

/// Row of a gauge for loads of unit size: from the model, and as calibrated with its covariance.
struct Row {
    model: Vec<f64>,
    found: Vec<f64>,
    covariance: Vec<f64>,
}

impl Row {
    fn from_state(state: &State, g: usize) -> Self {
        let k = state.scales.len();
        let order = state.posterior.n * k;
        let at = |i: usize| (g * k + i / k) * order + g * k + i % k;
        Self {
            model: state.prior[g].mean.clone(),
            found: state.posterior.mean[g * k..(g + 1) * k].to_vec(),
            covariance: (0..k * k)
                .map(|i| state.posterior.covariance[at(i)])
                .collect(),
        }
    }

    /// Calibrated row along the model's.
    fn scale(&self) -> f64 {
        let own = spd::dot(&self.model, &self.model);
        if own > 0.0 {
            spd::dot(&self.found, &self.model) / own
        } else {
            1.0
        }
    }

    /// Returns the distance of the calibrated row from `wanted`, strain, if `wanted` explains the row and the runs separate it from the model's row.
    fn explained_by(&self, wanted: &[f64]) -> Option<f64> {
        let change: Vec<f64> = wanted.iter().zip(&self.model).map(|(w, m)| w - m).collect();
        let size = spd::dot(&change, &change).sqrt();
        let mut spread = vec![0.0; change.len()];
        spd::times(&self.covariance, &change, &mut spread);
        // Sd of the row along the change.
        let sd = spd::dot(&spread, &change).max(0.0).sqrt() / size;
        let off = self.found.iter().zip(wanted).map(|(f, w)| (f - w).powi(2));
        let off = off.sum::<f64>().sqrt();
        (size > 0.0 && sd < SEPARATED_SD_REL * size && off < SAME * size).then_some(off)
    }

    /// Returns the distance of the calibrated row from the model's row with reversed sign, if [`Row::explained_by`] accepts it.
    fn reversed_sign_distance(&self) -> Option<f64> {
        let turned: Vec<f64> = self.model.iter().map(|v| -v).collect();
        self.explained_by(&turned)
    }
}

/// Returns the shift of every gauge. The distance is measured with the model error that the other gauges determine. The gauge itself and gauges with
/// a known fault do not contribute, since one reversed gauge makes any error of the model probable.
pub(super) fn check(task: &Task, state: &State) -> Vec<GaugeShift> {
    let n = task.gauges.len();
    let Some((model, evidence)) = task.model.as_ref().zip(state.error_evidence.as_ref()) else {
        return without_model(task);
    };
    let rows: Vec<Row> = (0..n).map(|g| Row::from_state(state, g)).collect();
    let distance = |g: usize, to: &[f64], without: &[usize]| -> f64 {
        let error = evidence.most_probable(without);
        let prior = model_rows(model, &state.scales, [(g, error.into())]).pop();
        let moved: Vec<f64> = to.iter().zip(&rows[g].model).map(|(a, b)| a - b).collect();
        let k = moved.len();
        let precision = prior.and_then(|p| Precision::from_covariance(&p.covariance, k));
        precision.map_or(0.0, |p| {
            (spd::dot(&p.apply(&moved), &moved) / k.max(1) as f64).sqrt()
        })
    };
    // Faults that need no estimate of the model error.
    let mut words: Vec<Option<ShiftWord>> = vec![None; n];
    for (g, row) in rows.iter().enumerate() {
        let expected = row.model.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        if is_silent(task, g) && expected > LIVE * LIVE * task.noise {
            words[g] = Some(ShiftWord::Dead);
        }
    }
    for (a, b) in find_exchanged_pairs(&rows) {
        let free = words[a].is_none() && words[b].is_none();
        let apart = |g: usize, to: usize| distance(g, &rows[to].model, &[a, b]) > NOTABLE;
        if free && apart(a, b) && apart(b, a) {
            words[a] = Some(ShiftWord::Exchanged { with: b });
            words[b] = Some(ShiftWord::Exchanged { with: a });
        }
    }
    for (g, (word, row)) in words.iter_mut().zip(&rows).enumerate() {
        if word.is_none() && row.scale().abs() < DEAD {
            // A gauge installed across its axis may read almost nothing without being dead.
            let error = evidence.most_probable(&[g]);
            let turned = off_drawing(model, &state.scales, evidence, error, g);
            let turned = turned.filter(|w| *w == ShiftWord::Angle);
            *word = Some(turned.unwrap_or(ShiftWord::Dead));
        } else if word.is_none() && row.reversed_sign_distance().is_some() {
            *word = Some(ShiftWord::Sign);
        }
    }
    let mut shifts = vec![0.0; n];
    loop {
        let wrong: Vec<usize> = (0..n).filter(|g| words[*g].is_some()).collect();
        for (g, shift) in shifts.iter_mut().enumerate() {
            let mut without = wrong.clone();
            without.push(g);
            *shift = distance(g, &rows[g].found, &without);
        }
        let news = (0..n).filter(|g| words[*g].is_none() && shifts[*g] >= NOTABLE);
        let news: Vec<usize> = news.collect();
        // If most gauges are far off, the error of the model is large and the gauges are not wrong. They are reported and stay in the estimate of the
        // model error.
        let stop = news.is_empty() || 2 * (wrong.len() + news.len()) > n;
        for g in news {
            let mut without = wrong.clone();
            without.push(g);
            let found = off_drawing(
                model,
                &state.scales,
                evidence,
                evidence.most_probable(&without),
                g,
            );
            words[g] = Some(cause(&rows[g], found));
        }
        if stop {
            break;
        }
    }
    let all = rows.iter().zip(&words).zip(&shifts).zip(&task.gauges);
    all.map(|(((row, word), shift), name)| GaugeShift {
        name: name.clone(),
        shift: *shift,
        scale: row.scale(),
        word: word.unwrap_or(ShiftWord::None),
    })
    .collect()
}

/// Returns the gauges with reversed sign, exchanged gauges and dead gauges. If they are half of all gauges or more, the loads are more likely wrong,
/// and the list is empty.
pub(super) fn wrongly_wired(shifts: &[GaugeShift]) -> Vec<usize> {
    let is = |w: &ShiftWord| {
        matches!(
            w,
            ShiftWord::Sign | ShiftWord::Exchanged { .. } | ShiftWord::Dead
        )
    };
    let out: Vec<usize> = (0..shifts.len()).filter(|g| is(&shifts[*g].word)).collect();
    if 2 * out.len() < shifts.len() {
        out
    } else {
        Vec::new()
    }
}

/// Returns the shifts without a model, which detect dead gauges only.
fn without_model(task: &Task) -> Vec<GaugeShift> {
    let one = |(g, name): (usize, &String)| GaugeShift {
        name: name.clone(),
        shift: 0.0,
        scale: 1.0,
        word: match is_silent(task, g) {
            true => ShiftWord::Dead,
            false => ShiftWord::None,
        },
    };
    task.gauges.iter().enumerate().map(one).collect()
}

/// Returns whether a gauge has readings, all of them below [`LIVE`] times the noise.
fn is_silent(task: &Task, g: usize) -> bool {
    let readings = task.runs.iter().filter_map(|r| r.strain.get(g));
    let mut readings = readings.filter(|v| v.is_finite()).peekable();
    readings.peek().is_some() && readings.all(|v| v.abs() < LIVE * task.noise)
}

/// Pairs of gauges whose calibrated rows are each other's model rows, the clearest first.
fn find_exchanged_pairs(rows: &[Row]) -> Vec<(usize, usize)> {
    let mut out: Vec<(f64, usize, usize)> = Vec::new();
    for (a, first) in rows.iter().enumerate() {
        for (b, second) in rows.iter().enumerate().skip(a + 1) {
            let off = first.explained_by(&second.model);
            let Some((x, y)) = off.zip(second.explained_by(&first.model)) else {
                continue;
            };
            // Two reversed gauges on top and bottom look much like two exchanged gauges.
            let turned = first
                .reversed_sign_distance()
                .zip(second.reversed_sign_distance());
            if turned.is_none_or(|(u, v)| x.hypot(y) <= u.hypot(v)) {
                out.push((x.hypot(y), a, b));
            }
        }
    }
    out.sort_by(|x, y| x.0.total_cmp(&y.0));
    out.into_iter().map(|(_, a, b)| (a, b)).collect()
}

/// Returns the cause of the change of a row that is far off. `off_drawing`: the cause from the readings if the model contains the changes by an angle
/// or a place. `Angle` and `Place` come from `off_drawing` only.
fn cause(row: &Row, off_drawing: Option<ShiftWord>) -> ShiftWord {
    if let Some(word @ (ShiftWord::Angle | ShiftWord::Place)) = off_drawing {
        return word;
    }
    let rather_gain = off_drawing.is_none_or(|w| w == ShiftWord::Gain);
    let moved: Vec<f64> = row
        .found
        .iter()
        .zip(&row.model)
        .map(|(a, b)| a - b)
        .collect();
    // Share of the squared change that a gain explains.
    let own = spd::dot(&row.model, &row.model);
    let all = spd::dot(&moved, &moved);
    let gain = spd::dot(&row.model, &moved).powi(2);
    let explained = if own > 0.0 && all > 0.0 {
        gain / (own * all)
    } else {
        0.0
    };
    if row.scale() < 0.0 && off_drawing.is_none() {
        ShiftWord::Sign
    } else if rather_gain && explained > EXPLAINED {
        ShiftWord::Gain
    } else {
        ShiftWord::Undetermined
    }
}

/// Returns a finding for each notable gauge.
pub(super) fn findings(task: &Task, shifts: &[GaugeShift]) -> Vec<Finding> {
    let stated = task
        .model
        .as_ref()
        .map_or(0.0, |m| 100.0 * m.uncertainty_rel);
    // The finding on the first of two exchanged gauges is for both.
    let notable = shifts.iter().enumerate().filter(|(g, s)| match s.word {
        ShiftWord::None => false,
        ShiftWord::Exchanged { with } => *g < with,
        _ => true,
    });
    notable
        .map(|(_, s)| {
            let name = match s.word {
                ShiftWord::Exchanged { with } => format!("{}, {}", s.name, shifts[with].name),
                _ => s.name.clone(),
            };
            let (code, severity, looks) = match s.word {
                ShiftWord::Dead => ("gauge-dead", Severity::Warning, "it has no signal in any run: it is dead or not connected".to_owned()),
                ShiftWord::Sign => ("input-sign-reversed", Severity::Warning, "its sign is reversed, as with exchanged wires".to_owned()),
                ShiftWord::Gain => ("gauge-shifted", Severity::Warning, format!("the deviation fits a gain of {:.3}", s.scale)),
                ShiftWord::Angle => ("gauge-shifted", Severity::Warning, "the deviation fits a wrong angle".to_owned()),
                ShiftWord::Exchanged { .. } => ("inputs-exchanged", Severity::Warning, "the readings of each gauge fit the strain that the model predicts for the other: channels or names are exchanged".to_owned()),
                ShiftWord::Undetermined => ("gauge-shifted", Severity::Warning, "the deviation does not clearly fit a gain, an angle or another position".to_owned()),
                ShiftWord::Place | ShiftWord::None => ("gauge-shifted", Severity::Warning, "the deviation fits a position other than the position in the model".to_owned()),
            };
            let message = if task.model.is_some() {
                format!("gauge `{name}` deviates by {:.1} sigma from the model (stated: {stated:.0} %): {looks}", s.shift)
            } else {
                format!("gauge `{name}`: {looks}")
            };
            Finding::new(severity, code, name, message, "check its wiring, position and bridge factor; the calibrated S already includes the deviation").with_numbers(s.shift, NOTABLE)
        })
        .collect()
}
