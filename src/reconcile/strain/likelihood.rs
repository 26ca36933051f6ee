//! Readings with their covariance, and their prediction by a set of effects. `optimum` optimises the parameters, with amplitudes integrated out;
//! `evidence` contains the gain, and `screen` tries candidates.

use super::covariance::{Selection, covariance, patterns_read};
use super::frame::StrainFrame;
use super::prediction::predict;
use super::size::{RunBlocks, usual_sizes};
use crate::linalg::precision::Precision;
use crate::reconcile::effect::{Candidate, Member, Parameter, SizedAmplitudes};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Result of fitting a set.
#[derive(Clone, Debug, Default)]
pub struct Fit {
    /// Parameters by member of the set.
    pub parameters: Vec<Vec<f64>>,
    /// Standard deviations of the parameters by member.
    pub sigma: Vec<Vec<f64>>,
    /// Covariance of all parameters, members in order, by rows.
    pub covariance: Vec<f64>,
    /// Members with amplitudes: candidate number and sizes (see [`SizedAmplitudes::sizes`]).
    pub sizes: Vec<(usize, Vec<f64>)>,
    /// Residual of the selection with the fitted parameters.
    pub residual: Vec<f64>,
    /// r' C^-1 r.
    pub chi2: f64,
}

/// Candidates with amplitudes, and the rounded logs of their sizes.
type RoundedSizes = Vec<(usize, Vec<i64>)>;

/// Log evidence of sets of effects on the readings of a selection.
pub struct Likelihood<'a> {
    pub(super) frame: &'a StrainFrame,
    pub(super) candidates: &'a [Candidate],
    pub(super) selection: Selection,
    readings: Vec<f64>,
    /// Active effects of the prediction from which the covariance is computed.
    reference: &'a [(usize, Vec<f64>)],
    cache: BTreeMap<RoundedSizes, Option<Arc<Precision>>>,
    /// Index of (run, gauge) in the selection, at the position run times number of gauges plus gauge.
    pub(super) index: Vec<Option<usize>>,
    /// Runs of the selection.
    pub(super) runs: Vec<usize>,
    /// Covariance run by run.
    pub(super) blocks: RunBlocks,
    /// Whether general forms of discrepancy are left out of the search.
    pub(super) names_only: bool,
}

/// Sizes of amplitudes are rounded to this step of their natural log, so that sets share a factorisation.
const SIZE_STEP: f64 = 0.35;

impl<'a> Likelihood<'a> {
    /// Returns a likelihood over `runs`, with the covariance of the prediction under `reference` (candidates with parameters).
    pub fn new(
        frame: &'a StrainFrame,
        candidates: &'a [Candidate],
        runs: &[usize],
        reference: &'a [(usize, Vec<f64>)],
    ) -> Self {
        let selection = Selection::of_runs(frame, runs);
        let readings = selection.pick(&frame.observations.values, frame.n_gauges());
        let mut index = vec![None; frame.n_runs() * frame.n_gauges()];
        for (i, &(r, g)) in selection.0.iter().enumerate() {
            index[r * frame.n_gauges() + g] = Some(i);
        }
        let member = |r: &'a (usize, Vec<f64>)| {
            let effect = candidates.get(r.0)?.effect.as_ref();
            Some(Member {
                effect,
                parameters: &r.1,
            })
        };
        let members: Vec<Member<'_>> = reference.iter().filter_map(member).collect();
        let blocks = RunBlocks::from_selection(frame, &members, &selection);
        Self {
            frame,
            candidates,
            selection,
            readings,
            reference,
            cache: BTreeMap::new(),
            index,
            runs: runs.to_vec(),
            blocks,
            names_only: false,
        }
    }

    /// Returns the likelihood without the general forms of discrepancy in its search.
    pub fn names_only(self) -> Self {
        Self {
            names_only: true,
            ..self
        }
    }

    /// Returns the selection.
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// Returns the members of `set` with `parameters`.
    pub fn members<'b>(&'b self, set: &[usize], parameters: &'b [Vec<f64>]) -> Vec<Member<'b>> {
        let member = |(&c, p): (&usize, &'b Vec<f64>)| {
            self.candidates.get(c).map(|c| Member {
                effect: c.effect.as_ref(),
                parameters: p.as_slice(),
            })
        };
        set.iter().zip(parameters).filter_map(member).collect()
    }

    /// Returns the residual of the selection with the effects of `set` included.
    pub fn residual(&self, set: &[usize], parameters: &[Vec<f64>]) -> Vec<f64> {
        let predicted = predict(self.frame, &self.members(set, parameters));
        let picked = self.selection.pick(&predicted, self.frame.n_gauges());
        self.readings
            .iter()
            .zip(picked)
            .map(|(y, p)| y - p)
            .collect()
    }

    /// Returns the precision of the residual with unknown amplitudes of these sizes.
    pub fn precision(&mut self, sizes: &[(usize, Vec<f64>)]) -> Option<Arc<Precision>> {
        let rounded = |v: &f64| (v.max(f64::MIN_POSITIVE).ln() / SIZE_STEP).round() as i64;
        let key: RoundedSizes = sizes
            .iter()
            .map(|(c, s)| (*c, s.iter().map(rounded).collect()))
            .collect();
        if let Some(known) = self.cache.get(&key) {
            return known.clone();
        }
        let unrounded = |k: &i64| (*k as f64 * SIZE_STEP).exp();
        let mut unknown = Vec::new();
        for (c, ks) in &key {
            let amplitudes = self.candidates.get(*c)?.effect.amplitudes(self.frame)?;
            unknown.push(SizedAmplitudes {
                amplitudes,
                sizes: ks.iter().map(unrounded).collect(),
            });
        }
        let reference: Vec<usize> = self.reference.iter().map(|r| r.0).collect();
        let parameters: Vec<Vec<f64>> = self.reference.iter().map(|r| r.1.clone()).collect();
        let members = self.members(&reference, &parameters);
        let cov = covariance(self.frame, &members, &self.selection, &unknown);
        let made = Precision::from_covariance(&cov, self.selection.len()).map(Arc::new);
        self.cache.insert(key, made.clone());
        made
    }

    pub(super) fn parameters_of(&self, set: &[usize]) -> Vec<Vec<Parameter>> {
        set.iter()
            .map(|&c| {
                self.candidates
                    .get(c)
                    .map(|c| c.effect.parameters())
                    .unwrap_or_default()
            })
            .collect()
    }

    pub(super) fn with_amplitudes(&self, set: &[usize]) -> Vec<usize> {
        set.iter()
            .copied()
            .filter(|&c| {
                self.candidates
                    .get(c)
                    .is_some_and(|c| c.effect.amplitudes(self.frame).is_some())
            })
            .collect()
    }

    /// Returns the usual sizes of the amplitudes of members with amplitudes, updated with `residual`.
    pub(super) fn sizes_from(
        &self,
        families: &[usize],
        members: &[Member<'_>],
        residual: &[f64],
    ) -> Vec<(usize, Vec<f64>)> {
        let list: Vec<_> = families
            .iter()
            .filter_map(|&c| self.candidates.get(c)?.effect.amplitudes(self.frame))
            .collect();
        let read: Vec<_> = list
            .into_iter()
            .map(|mut a| {
                a.patterns = patterns_read(self.frame, members, &a.patterns);
                a
            })
            .collect();
        let sizes = usual_sizes(&self.blocks, residual, &read);
        families.iter().copied().zip(sizes).collect()
    }

    /// Returns the amplitudes of candidates with their sizes, as the gauges read them under `members`.
    pub(super) fn sized_amplitudes(
        &self,
        sizes: &[(usize, Vec<f64>)],
        members: &[Member<'_>],
    ) -> Vec<SizedAmplitudes> {
        let one = |(c, s): &(usize, Vec<f64>)| {
            let mut amplitudes = self.candidates.get(*c)?.effect.amplitudes(self.frame)?;
            amplitudes.patterns = patterns_read(self.frame, members, &amplitudes.patterns);
            Some(SizedAmplitudes {
                amplitudes,
                sizes: s.clone(),
            })
        };
        sizes.iter().filter_map(one).collect()
    }
}
