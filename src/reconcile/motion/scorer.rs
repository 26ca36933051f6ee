//! Scorer of the search for acceleration records: evidence of sets of effects, and the next candidates.

use super::candidate::Candidate;
use super::change::{Change, assemble};
use super::columns::{fault_columns, late_between, parameter_column, slices};
use super::corrections::adjustments;
use super::design::{Design, design};
use super::evidence::{cost, evidence};
use super::fit::{Effort, fit};
use super::floor::share;
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use super::noise::Background;
use super::part::Part;
use crate::estimate::columns::Basis;
use crate::reconcile::search::{Addition, ScoredSet, Scorer};
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::stretch::slow_stretches;
use std::sync::Arc;

/// Scores sets of effects on the fitted record.
pub struct MotionScorer<'a> {
    /// The frame.
    pub frame: &'a MotionFrame,
    /// The library.
    pub candidates: &'a [Candidate],
    /// Background: the residual power that no effect explains.
    pub background: Background,
    /// Designs with every form of every candidate, by corrections and swaps.
    pub forms: Vec<(Vec<Adjustment>, Vec<String>, Arc<Forms>)>,
}

/// A design with every form of every candidate in it.
pub struct Forms {
    design: Design,
    /// Parameters of each form: candidate, form, indices.
    own: Vec<(usize, usize, Vec<usize>)>,
}

/// Fall of the squared residual below which a form's constant isn't refined.
const WORTH_REFINING: f64 = 30.0;
/// Steps of refinement, each finer.
const REFINE: [f64; 8] = [0.2, 0.07, 0.025, 0.009, 0.003, 0.001, 0.0003, 0.0001];

impl MotionScorer<'_> {
    /// Returns the cost of a candidate in a form: [`cost`].
    pub fn cost(&self, candidate: usize, shape: &Change, n_rows: usize) -> f64 {
        let c = &self.candidates[candidate];
        cost(c, shape, self.candidates.len(), n_rows)
    }

    fn part(&self, candidate: usize, addition: Option<&Addition>) -> Part {
        let shapes = &self.candidates[candidate].shapes;
        let chosen = addition.and_then(|a| a.parameters.first()).copied();
        let index = (chosen.unwrap_or(0.0) as usize).min(shapes.len().saturating_sub(1));
        let start = addition.and_then(|a| a.parameters.get(1)).copied();
        let shape = shapes[index].clone();
        let fault = match &shape {
            Change::Gain { .. } => 1.0 + start.unwrap_or(0.0).clamp(-0.4, 0.6),
            Change::Delay { .. } | Change::Slip { .. } => start.unwrap_or(0.0).clamp(-0.02, 0.02),
            Change::Clock { .. } => {
                let most = 0.02 / self.frame.data.duration_s().max(1.0);
                start.unwrap_or(0.0).clamp(-most, most)
            }
            // A low-pass with the start value zero would have the column of a delay.
            Change::Lag { .. } => start.unwrap_or(0.0).clamp(0.001, 0.03),
            _ => 0.0,
        };
        Part {
            candidate,
            shape,
            fault,
        }
    }

    /// Finds the constants of the forms in a fit, but for candidates that are settled.
    fn refine_constants(&self, mut best: MotionFit, settled: &[usize]) -> MotionFit {
        for step in &REFINE {
            for i in 0..best.parts.len() {
                if settled.contains(&best.parts[i].candidate) {
                    continue;
                }
                let varied = best.parts[i].shape.neighbours(*step, self.frame.gravity);
                for shape in self.best_of(&best, i, &varied) {
                    let mut parts = best.parts.clone();
                    parts[i].shape = shape;
                    let again = fit(
                        self.frame,
                        self.candidates,
                        &self.frame.data,
                        parts,
                        Some(&best),
                        &self.background,
                        Effort::Touch,
                    );
                    if let Some(f) = again.filter(|f| f.misfit() < best.misfit()) {
                        best = f;
                    }
                }
            }
        }
        best
    }

    /// Returns a set whose constants of terms are estimated with all members in the set.
    pub fn with_own_constants(&self, of: ScoredSet<MotionFit>) -> ScoredSet<MotionFit> {
        let varies = |p: &Part| {
            let is_term = matches!(p.shape, Change::Terms { .. });
            is_term && !p.shape.neighbours(REFINE[0], self.frame.gravity).is_empty()
        };
        if of.set.len() < 2 || !of.fit.parts.iter().any(varies) {
            return of;
        }
        let others = of.fit.parts.iter().filter(|p| !varies(p));
        let settled: Vec<usize> = others.map(|p| p.candidate).collect();
        let fit = self.refine_constants(of.fit, &settled);
        ScoredSet {
            log_evidence: evidence(self.frame, self.candidates, &fit),
            set: of.set,
            fit,
        }
    }

    /// Returns the form of `varied` with the smallest residual, all other parts unchanged; empty if the present form has a smaller one.
    ///
    /// For a change of mass, returns the best form with its weight and the best one without. The balance of weight is another row for the two forms,
    /// so only a fit compares them.
    fn best_of(&self, now: &MotionFit, part: usize, varied: &[Change]) -> Vec<Change> {
        self.gains_of(now, part, varied)
            .map_or(vec![], |(present, gains)| {
                let weighs = |c: &Change| matches!(c, Change::Step(s) if s.gravity > 0.0);
                let own = weighs(&now.parts[part].shape);
                let best = |with: bool| {
                    varied
                        .iter()
                        .zip(&gains)
                        .filter(|(c, g)| weighs(c) == with && (with != own || **g > present))
                        .max_by(|a, b| a.1.total_cmp(b.1))
                        .map(|(c, _)| c.clone())
                };
                [best(true), best(false)].into_iter().flatten().collect()
            })
    }

    /// Returns the fit of a set with a new timing fault, from the start with the smallest residual. Beyond a quarter of a wave of the measured
    /// quantity, a linear step can go in the wrong direction.
    fn settled_from_afar(&self, first: MotionFit, known: &[usize]) -> MotionFit {
        /// Lateness at the end of the record that is tried, s.
        const LATE_S: [f64; 8] = [-0.25, -0.12, -0.06, -0.03, 0.03, 0.06, 0.12, 0.25];
        let length_s = self.frame.data.duration_s().max(1.0);
        let mut best = first;
        for i in 0..best.parts.len() {
            if known.contains(&best.parts[i].candidate) {
                continue;
            }
            let unit = match best.parts[i].shape {
                Change::Clock { .. } => 1.0 / length_s,
                Change::Slip { .. } => 1.0,
                _ => continue,
            };
            let started = best.clone();
            for late in LATE_S {
                let mut parts = started.parts.clone();
                parts[i].fault = unit * late;
                let again = fit(
                    self.frame,
                    self.candidates,
                    &self.frame.data,
                    parts,
                    Some(&started),
                    &self.background,
                    Effort::Settled,
                );
                if let Some(f) = again.filter(|f| f.misfit() < best.misfit()) {
                    best = f;
                }
            }
        }
        best
    }

    /// Returns the falls of the squared residual at other moments of a slip, with all other parts unchanged.
    fn gains_of_slip(&self, now: &MotionFit, part: usize, varied: &[Change]) -> Option<Vec<f64>> {
        /// Share of the slip that the better moment must take up, and its inverse.
        const SAME: f64 = 0.3;
        let Change::Slip { channel, at_s } = &now.parts[part].shape else {
            return None;
        };
        let by_s = now.parts[part].fault;
        let basis = Basis::from_columns(&now.columns);
        let gain = |shape: &Change| {
            let Change::Slip { at_s: other, .. } = shape else {
                return 0.0;
            };
            let times = [at_s.min(*other), at_s.max(*other)];
            let column = late_between(&now.design, &now.responses, channel, times);
            let Some(column) = column else { return 0.0 };
            let rows = now.rows(&slices(&column), 0.0);
            let (fall, found) = basis.gain(&now.residual, &[rows]);
            let wanted = if *other > *at_s { -by_s } else { by_s };
            let share = found / wanted;
            if share > SAME && share < 1.0 / SAME {
                fall
            } else {
                0.0
            }
        };
        Some(varied.iter().map(gain).collect())
    }

    /// Returns the falls of the squared residual with the present form and with other forms of a part, with all other parts unchanged.
    fn gains_of(&self, now: &MotionFit, part: usize, varied: &[Change]) -> Option<(f64, Vec<f64>)> {
        if varied.is_empty() {
            return None;
        }
        if matches!(now.parts[part].shape, Change::Lag { .. }) {
            return Some((0.0, vec![1.0; varied.len()]));
        }
        if let Some(gains) = self.gains_of_slip(now, part, varied) {
            return Some((0.0, gains));
        }
        let mut changes: Vec<&Change> = now.parts.iter().map(|p| &p.shape).collect();
        changes.extend(varied);
        let all = assemble(&self.frame.vehicle, &changes);
        let mut values = vec![0.0; all.vehicle.parameters().len()];
        for (&to, &old) in all.base.iter().zip(&now.assembled.base) {
            values[to] = now.values[old];
        }
        for (to, old) in all.own.iter().zip(&now.assembled.own) {
            to.iter()
                .zip(old)
                .for_each(|(&t, &o)| values[t] = now.values[o]);
        }
        let adjust = adjustments(self.frame, &now.parts);
        let slow = slow_stretches(&all.vehicle, &values, &self.frame.data, &adjust);
        let d = design(self.frame, &all.vehicle, &self.frame.data, &adjust, slow).ok()?;
        let n_parts = now.parts.len();
        // The columns without the tested part, to which each form is added in turn.
        let own: Vec<usize> = all.own[part].clone();
        let old = &now.assembled.own[part];
        let skip: Vec<usize> = (0..now.free.len())
            .filter(|&k| old.contains(&now.free[k]))
            .collect();
        let kept: Vec<_> = now
            .columns
            .iter()
            .enumerate()
            .filter(|(k, _)| !skip.contains(k))
            .map(|(_, c)| c.clone())
            .collect();
        let basis = Basis::from_columns(&kept);
        // Residual without the part: the contribution of its columns is added again.
        let mut residual = now.residual.to_vec();
        for &k in &skip {
            let x = now.values[now.free[k]];
            residual
                .iter_mut()
                .zip(&now.columns[k].rows)
                .for_each(|(r, c)| *r += c * x);
        }
        let at_rest = |shape: &Change| {
            let rest = now.rest.as_ref();
            rest.map_or(0.0, |r| r.entry_of_change(self.frame, shape))
        };
        let gain = |parameters: &[usize], shape: &Change| {
            let columns: Vec<Vec<f64>> = parameters
                .iter()
                .map(|&p| now.rows(&parameter_column(&d, p), at_rest(shape)))
                .collect();
            basis.gain(&residual, &columns).0
        };
        let present = gain(&own, &now.parts[part].shape);
        let others = varied.iter().enumerate();
        let gains = others.map(|(k, shape)| gain(&all.own[n_parts + k], shape));
        Some((present, gains.collect()))
    }

    /// Returns the design with all forms for the corrections of a fit.
    fn all_forms(&mut self, base: &MotionFit) -> Option<Arc<Forms>> {
        let adjust = adjustments(self.frame, &base.parts);
        let key: Vec<String> = base
            .parts
            .iter()
            .map(|p| format!("{:?}", p.shape))
            .collect();
        if let Some(f) = self.forms.iter().find(|f| f.0 == adjust && f.1 == key) {
            return Some(Arc::clone(&f.2));
        }
        let mut changes: Vec<&Change> = base.parts.iter().map(|p| &p.shape).collect();
        let mut names = Vec::new();
        for (c, candidate) in self.candidates.iter().enumerate() {
            for (k, shape) in candidate.shapes.iter().enumerate() {
                if matches!(
                    shape,
                    Change::Terms { .. } | Change::Links(_) | Change::Step(_)
                ) {
                    names.push((c, k));
                    changes.push(shape);
                }
            }
        }
        let all = assemble(&self.frame.vehicle, &changes);
        let mut values = vec![0.0; all.vehicle.parameters().len()];
        for (&to, &old) in all.base.iter().zip(&base.assembled.base) {
            values[to] = base.values[old];
        }
        for (to, old) in all.own.iter().zip(&base.assembled.own) {
            to.iter()
                .zip(old)
                .for_each(|(&t, &o)| values[t] = base.values[o]);
        }
        let slow = slow_stretches(&all.vehicle, &values, &self.frame.data, &adjust);
        let design = design(self.frame, &all.vehicle, &self.frame.data, &adjust, slow).ok()?;
        let own = names
            .into_iter()
            .zip(all.own.iter().skip(base.parts.len()))
            .map(|((c, k), o)| (c, k, o.clone()))
            .collect();
        let forms = Arc::new(Forms { design, own });
        self.forms.push((adjust, key, Arc::clone(&forms)));
        Some(forms)
    }

    /// Returns the whitened columns of every form that could be added to a fit: candidate, form, columns.
    pub fn form_columns(&mut self, base: &MotionFit) -> Vec<(usize, usize, Vec<Vec<f64>>)> {
        let mut out = Vec::new();
        let set: Vec<usize> = base.parts.iter().map(|p| p.candidate).collect();
        if let Some(forms) = self.all_forms(base) {
            for (c, k, own) in &forms.own {
                if set.contains(c) {
                    continue;
                }
                let rest = base.rest.as_ref();
                let shape = &self.candidates[*c].shapes[*k];
                let at_rest = rest.map_or(0.0, |r| r.entry_of_change(self.frame, shape));
                let columns = own
                    .iter()
                    .map(|&p| base.rows(&parameter_column(&forms.design, p), at_rest))
                    .collect();
                out.push((*c, *k, columns));
            }
        }
        for (c, candidate) in self.candidates.iter().enumerate() {
            if set.contains(&c) {
                continue;
            }
            for (k, shape) in candidate.shapes.iter().enumerate() {
                let start = if matches!(shape, Change::Gain { .. }) {
                    1.0
                } else {
                    0.0
                };
                let columns = fault_columns(&base.design, &base.responses, shape, start);
                if !columns.is_empty() {
                    let rows = columns.iter().map(|c| base.rows(&slices(c), 0.0));
                    out.push((c, k, rows.collect()));
                }
            }
        }
        out
    }
}

impl Scorer for MotionScorer<'_> {
    type Fit = MotionFit;

    fn score(
        &mut self,
        set: &[usize],
        from: Option<(&ScoredSet<MotionFit>, Option<&Addition>)>,
    ) -> Option<ScoredSet<MotionFit>> {
        let parts: Vec<Part> = set
            .iter()
            .map(|&c| {
                let known = from.and_then(|(f, _)| f.fit.parts.iter().find(|p| p.candidate == c));
                let addition = from.and_then(|(_, a)| a).filter(|a| a.candidate == c);
                known.cloned().unwrap_or_else(|| self.part(c, addition))
            })
            .collect();
        let start = from.map(|(f, _)| &f.fit);
        let from_there = |start: Option<&MotionFit>| {
            fit(
                self.frame,
                self.candidates,
                &self.frame.data,
                parts.clone(),
                start,
                &self.background,
                Effort::Settled,
            )
        };
        let lost =
            start.is_some_and(|f| share(&f.design, &f.left, &f.values) > self.frame.rules.lost);
        let from_start = if lost { from_there(None) } else { None };
        let first = (from_there(start).into_iter().chain(from_start))
            .min_by(|a, b| a.misfit().total_cmp(&b.misfit()))?;
        // If the same set is scored again, its background has changed. Constants that were estimated with a larger background are then estimated
        // again.
        let neighbour = from.map(|(f, _)| f).filter(|f| f.set != set);
        let before = neighbour.map_or(f64::INFINITY, |f| f.fit.chi2);
        let fit = if before - first.chi2 > WORTH_REFINING {
            let known = from.map_or(&[][..], |(f, _)| &f.set);
            let settled: Vec<usize> = neighbour.map_or(vec![], |f| f.set.clone());
            self.refine_constants(self.settled_from_afar(first, known), &settled)
        } else {
            first
        };
        Some(ScoredSet {
            set: set.to_vec(),
            log_evidence: evidence(self.frame, self.candidates, &fit),
            fit,
        })
    }

    fn screen(&mut self, base: &ScoredSet<MotionFit>) -> Vec<Addition> {
        let basis = Basis::from_columns(&base.fit.columns);
        let mut best: Vec<Option<Addition>> = vec![None; self.candidates.len()];
        for (c, k, columns) in self.form_columns(&base.fit) {
            let (fall, first) = basis.gain(&base.fit.residual, &columns);
            let shape = &self.candidates[c].shapes[k];
            let against =
                self.candidates[c].sign == super::candidate::Sign::Positive && first < 0.0;
            let gain =
                0.5 * fall * if against { 0.0 } else { 1.0 } - self.cost(c, shape, base.fit.n_rows);
            if best[c].as_ref().is_none_or(|b| gain > b.gain) {
                best[c] = Some(Addition {
                    candidate: c,
                    gain,
                    parameters: vec![k as f64, first],
                    sizes: vec![first],
                });
            }
        }
        let mut out: Vec<Addition> = best.into_iter().flatten().collect();
        out.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        out
    }

    fn is_stopped(&self) -> bool {
        self.frame.stop.is_asked()
    }

    fn is_compatible_pair(&self, a: usize, b: usize) -> bool {
        let whole = |c: usize| self.candidates[c].is_dominant_fault();
        // A low-pass filter already delays the channel. With an additional delay of either sign, it would represent filters that are not in the
        // library.
        let filtered_and_late = |a: usize, b: usize| {
            let (a, b) = (&self.candidates[a], &self.candidates[b]);
            a.family() == "low_pass" && b.family() == "time_offset" && a.place == b.place
        };
        a != b && !(whole(a) || whole(b) || filtered_and_late(a, b) || filtered_and_late(b, a))
    }

    fn kin(&self, candidate: usize) -> usize {
        let family = self.candidates[candidate].family();
        self.candidates
            .iter()
            .position(|c| c.family() == family)
            .unwrap_or(candidate)
    }
}
