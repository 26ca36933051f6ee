//! Gap on runs that were not fitted, before and after, over all readings and by gauge, with its floor. All three are computed in the same way.

use super::covariance::{Selection, covariance, read_patterns};
use super::frame::StrainFrame;
use super::prediction::predict;
use super::state::StrainState;
use crate::estimate::rms;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::spd::dot;
use crate::reconcile::checks::Fall;
use crate::reconcile::effect::{Member, SizedAmplitudes};
use crate::reconcile::outcome::{ChannelGap, Gap, GapBasis, GapNumbers};

/// Unknowns of a run that are estimated from one half of its gauges (odd or even number in file order). The other half tests them. The gap before,
/// the gap after and the expected residual use the same unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReestimatedUnknowns {
    /// Amplitudes of the active effects and of the nuisance loads. The gap before has no effect amplitudes, since an effect of size zero has none.
    Amplitudes,
    /// The amplitudes, and the errors of the recorded wheel loads.
    AmplitudesAndLoads,
}

/// Residuals of runs that were not fitted.
#[derive(Clone, Debug, Default)]
pub struct ValidationResiduals {
    /// Gauge number by reading.
    pub gauges: Vec<usize>,
    /// Reading, microstrain.
    pub reading: Vec<f64>,
    /// Residual of the analyst's model, microstrain.
    pub before: Vec<f64>,
    /// Residual with the effects, microstrain.
    pub after: Vec<f64>,
    /// Root mean square residual that a right model would leave, microstrain.
    pub floor: Vec<f64>,
    /// Residual on the analyst's mesh minus the residual on the finer mesh, microstrain.
    pub mesh: Vec<f64>,
}

impl ValidationResiduals {
    /// Returns the readings of gauges whose number in file order has this remainder after division by two.
    pub fn half(&self, remainder: usize) -> Self {
        let kept = |v: &[f64]| {
            v.iter()
                .zip(&self.gauges)
                .filter(|(_, g)| **g % 2 == remainder)
                .map(|(v, _)| *v)
                .collect()
        };
        Self {
            gauges: self
                .gauges
                .iter()
                .copied()
                .filter(|g| g % 2 == remainder)
                .collect(),
            reading: kept(&self.reading),
            before: kept(&self.before),
            after: kept(&self.after),
            floor: kept(&self.floor),
            mesh: kept(&self.mesh),
        }
    }

    /// Appends the residuals of other runs.
    pub fn extend(&mut self, other: Self) {
        self.gauges.extend(other.gauges);
        self.reading.extend(other.reading);
        self.before.extend(other.before);
        self.after.extend(other.after);
        self.floor.extend(other.floor);
        self.mesh.extend(other.mesh);
    }

    /// Returns the fall of the squared residual by the effects.
    fn fall(&self) -> Fall {
        Fall::from_residuals(&self.before, &self.after, &self.floor)
    }

    /// Returns the RMS residual over the RMS reading: before, after and floor.
    pub fn numbers(&self) -> GapNumbers {
        let scale = rms(self.reading.iter().copied());
        let relative = |v: &[f64]| {
            if scale > 0.0 {
                rms(v.iter().copied()) / scale
            } else {
                0.0
            }
        };
        GapNumbers {
            before: relative(&self.before),
            after: relative(&self.after),
            floor: relative(&self.floor),
        }
    }

    /// Returns the gap over all readings and by gauge. `loads_found` contains the residuals with the errors of the recorded wheel loads estimated as
    /// well.
    pub fn gap(
        &self,
        frame: &StrainFrame,
        basis: GapBasis,
        loads_found: &Self,
    ) -> (Gap, Vec<ChannelGap>) {
        let GapNumbers {
            before,
            after,
            floor,
        } = self.numbers();
        let scale = rms(self.reading.iter().copied());
        let mesh = frame
            .as_modelled
            .as_ref()
            .map(|_| rms(self.mesh.iter().copied()) / scale.max(f64::MIN_POSITIVE));
        let of = |g: usize, v: &[f64]| {
            rms(self
                .gauges
                .iter()
                .zip(v)
                .filter(|(e, _)| **e == g)
                .map(|(_, v)| *v))
        };
        let channel = |(g, f): (usize, &super::frame::GaugeFacts)| ChannelGap {
            channel: f.name.clone(),
            before: of(g, &self.before),
            after: of(g, &self.after),
            floor: of(g, &self.floor),
            reading: of(g, &self.reading),
        };
        let channels = frame.gauges.iter().enumerate().map(channel).collect();
        (
            Gap {
                before,
                after,
                floor,
                mesh,
                basis,
                loads_found: Some(loads_found.numbers()),
                falls: after < before && (self.fall().is_seen() || loads_found.fall().is_seen()),
            },
            channels,
        )
    }
}

fn residual(frame: &StrainFrame, members: &[Member<'_>], selection: &Selection) -> Vec<f64> {
    let n_g = frame.n_gauges();
    let predicted = selection.pick(&predict(frame, members), n_g);
    let readings = selection.pick(&frame.observations.values, n_g);
    readings.iter().zip(predicted).map(|(y, p)| y - p).collect()
}

/// Patterns whose amplitudes are estimated, with the mean and covariance of the amplitudes given the fit runs.
struct Patterns {
    /// Pattern values by run, pattern and gauge, as the gauges read them in that run.
    values: Vec<Vec<Vec<f64>>>,
    mean: Vec<f64>,
    /// Covariance of the amplitudes, `n x n` by rows.
    covariance: Vec<f64>,
}

impl Patterns {
    /// Returns the reading of a gauge in a run that the mean amplitudes cause.
    fn expected_reading(&self, run: usize, gauge: usize) -> f64 {
        let read = self.values[run].iter().zip(&self.mean);
        read.map(|(p, m)| p[gauge] * m).sum()
    }

    /// Returns the covariance of the readings of two gauges in a run that the amplitudes cause.
    fn reading_covariance(&self, run: usize, g: usize, h: usize) -> f64 {
        let (n, values) = (self.mean.len(), &self.values[run]);
        let rows = self.covariance.chunks_exact(n.max(1)).zip(values);
        rows.map(|(row, p)| p[g] * row.iter().zip(values).map(|(c, q)| c * q[h]).sum::<f64>())
            .sum()
    }
}

/// Fit runs with a set of active effects, and the covariance that predicts the held-out runs from them.
struct ValidationPredictor<'a> {
    frame: &'a StrainFrame,
    members: &'a [Member<'a>],
    unknown: &'a [SizedAmplitudes],
    /// Readings of the fit runs, then readings of the held-out runs.
    both: Selection,
    /// Covariance of the residual of `both`, microstrain^2.
    joint: Vec<f64>,
    fit: Selection,
    factor: Cholesky,
    /// Precision of the fit runs times their residual.
    weighted: Vec<f64>,
}

impl<'a> ValidationPredictor<'a> {
    fn new(
        frame: &'a StrainFrame,
        members: &'a [Member<'a>],
        unknown: &'a [SizedAmplitudes],
    ) -> Option<Self> {
        let fit = Selection::of_runs(frame, &frame.observations.fit_runs());
        let proof = Selection::of_runs(frame, &frame.observations.proof_runs());
        let both = Selection([fit.0.as_slice(), &proof.0].concat());
        let joint = covariance(frame, members, &both, unknown);
        let rows = joint.chunks_exact(both.len().max(1)).take(fit.len());
        let of_fit: Vec<f64> = rows.flat_map(|row| &row[..fit.len()]).copied().collect();
        let factor = Cholesky::from_covariance(&of_fit, fit.len())?;
        let weighted = factor.solve(&residual(frame, members, &fit));
        Some(Self {
            frame,
            members,
            unknown,
            both,
            joint,
            fit,
            factor,
            weighted,
        })
    }

    /// Returns the patterns whose amplitudes are estimated. The fit runs determine amplitudes that repeat: m = T B P r, M = T - T B P B' T. B
    /// contains the patterns over the readings of the fit runs, and T the variances of the repeating amplitudes. P is the precision of the fit runs
    /// and r their residual.
    fn patterns(&self, reestimated: ReestimatedUnknowns) -> Patterns {
        let mut values = Vec::new();
        let (mut steady, mut scatter) = (Vec::new(), Vec::new());
        let known = self.frame.nuisance_amplitudes();
        for u in self.unknown.iter().chain(&known) {
            values.extend(u.amplitudes.patterns.iter().cloned());
            steady.extend(u.amplitudes.kinds.iter().map(|&k| u.steady_variance(k)));
            scatter.extend(u.amplitudes.kinds.iter().map(|&k| u.scatter_variance(k)));
        }
        if reestimated == ReestimatedUnknowns::AmplitudesAndLoads {
            let state = StrainState::from_members(self.frame, self.members);
            let [n_g, _, n_c] = state.shape;
            let column = |l: usize| {
                (0..n_g)
                    .map(|g| state.influence[g * n_c + l])
                    .collect::<Vec<f64>>()
            };
            let columns: Vec<Vec<f64>> = (0..self.frame.n_loads()).map(column).collect();
            values.extend(columns);
            steady.resize(values.len(), 0.0);
            scatter.resize(values.len(), self.frame.load_noise * self.frame.load_noise);
        }
        let n = values.len();
        let read = |run: usize| read_patterns(self.frame, self.members, &values, run);
        let values: Vec<Vec<Vec<f64>>> = (0..self.frame.n_runs()).map(read).collect();
        let over_fit = |p: usize| -> Vec<f64> {
            let read = |&(run, g): &(usize, usize)| values[run][p][g];
            self.fit.0.iter().map(read).collect()
        };
        let mut mean = vec![0.0; n];
        let mut covariance = vec![0.0; n * n];
        for p in 0..n {
            covariance[p * n + p] = scatter[p] + steady[p];
        }
        let repeats: Vec<usize> = (0..n).filter(|p| steady[*p] > 0.0).collect();
        let columns: Vec<Vec<f64>> = repeats.iter().map(|&p| over_fit(p)).collect();
        for (p, column) in repeats.iter().zip(&columns) {
            mean[*p] = steady[*p] * dot(column, &self.weighted);
            let solved = self.factor.solve(column);
            for (q, other) in repeats.iter().zip(&columns) {
                covariance[p * n + q] -= steady[*p] * dot(&solved, other) * steady[*q];
            }
        }
        Patterns {
            values,
            mean,
            covariance,
        }
    }
}

/// Returns mean and covariance (`n x n`) of the residual of one run, given the fit runs.
fn given_fit(predictor: &ValidationPredictor<'_>, run: &Selection) -> (Vec<f64>, Vec<f64>) {
    let n = run.len();
    let proof = predictor.both.0.iter().skip(predictor.fit.len());
    let before = proof.take_while(|e| Some(*e) != run.0.first()).count();
    let (first, width) = (predictor.fit.len() + before, predictor.both.len());
    let shared = |i: usize| {
        let row = (first + i) * width;
        &predictor.joint[row..row + predictor.fit.len()]
    };
    let mean = (0..n)
        .map(|i| dot(shared(i), &predictor.weighted))
        .collect();
    let mut out = vec![0.0; n * n];
    for i in 0..n {
        let known = predictor.factor.solve(shared(i));
        for j in 0..n {
            let prior = predictor.joint[(first + i) * width + first + j];
            out[i * n + j] = prior - dot(&known, shared(j));
        }
    }
    (mean, out)
}

/// Held-out runs given the fit runs, with one model.
struct Proof<'a> {
    predictor: &'a ValidationPredictor<'a>,
    patterns: Patterns,
}

/// One held-out run.
struct ProofRun<'a> {
    proof: &'a Proof<'a>,
    all: Selection,
    /// Residual of the model on the analyst's mesh.
    residual: Vec<f64>,
    /// Innovation: residual on the finer mesh minus its mean given the fit runs.
    innovation: Vec<f64>,
    /// Mean given the fit runs minus the mean of the patterns, plus `mesh`: model errors that the fit runs show, and the mesh difference.
    offset: Vec<f64>,
    /// Residual on the analyst's mesh minus the residual on the finer mesh.
    mesh: Vec<f64>,
    /// Covariance of the innovation, `n x n`.
    spread: Vec<f64>,
}

impl<'a> Proof<'a> {
    fn new(predictor: &'a ValidationPredictor<'a>, reestimated: ReestimatedUnknowns) -> Self {
        Self {
            patterns: predictor.patterns(reestimated),
            predictor,
        }
    }

    fn run(&self, own: &StrainFrame, run: usize) -> ProofRun<'_> {
        let t = self.predictor;
        let all = Selection::of_runs(t.frame, &[run]);
        let on_own = residual(own, t.members, &all);
        let on_finer = residual(t.frame, t.members, &all);
        let (mean, spread) = given_fit(t, &all);
        let mesh: Vec<f64> = on_own.iter().zip(&on_finer).map(|(a, b)| a - b).collect();
        let offset = all.0.iter().zip(mean.iter().zip(&mesh));
        ProofRun {
            offset: offset
                .map(|(e, (m, d))| m - self.patterns.expected_reading(run, e.1) + d)
                .collect(),
            innovation: on_finer.iter().zip(&mean).map(|(r, m)| r - m).collect(),
            residual: on_own,
            proof: self,
            all,
            mesh,
            spread,
        }
    }
}

impl ProofRun<'_> {
    /// Returns, by reading, the residual with the patterns estimated from the other half of the gauges, and the floor of this residual.
    fn residual_and_floor(&self) -> (Vec<f64>, Vec<f64>) {
        /// Limit, in standard deviations, of the load errors that the other half of the gauges shows. A larger value is not a load error.
        const BELIEVED: f64 = 3.0;
        let n = self.all.len();
        let gauge = |i: usize| self.all.0[i].1;
        let run = self.all.0.first().map_or(0, |e| e.0);
        let patterns = &self.proof.patterns;
        let expected: Vec<f64> = (0..n)
            .map(|i| patterns.expected_reading(run, gauge(i)))
            .collect();
        let mut left: Vec<f64> = self
            .residual
            .iter()
            .zip(&expected)
            .map(|(r, e)| r - e)
            .collect();
        let mut floor = vec![0.0; n];
        for half in [0, 1] {
            let of = |even: usize| {
                (0..n)
                    .filter(|i| gauge(*i) % 2 == even)
                    .collect::<Vec<usize>>()
            };
            let (used, seen) = (of(half), of(1 - half));
            let block: Vec<f64> = used
                .iter()
                .flat_map(|&i| used.iter().map(move |&j| (i, j)))
                .map(|(i, j)| self.spread[i * n + j])
                .collect();
            let factor = Cholesky::from_covariance(&block, used.len());
            let innovation: Vec<f64> = used.iter().map(|&i| self.innovation[i]).collect();
            for &i in &seen {
                let shared: Vec<f64> = used
                    .iter()
                    .map(|&j| patterns.reading_covariance(run, gauge(i), gauge(j)))
                    .collect();
                let whole: Vec<f64> = used.iter().map(|&j| self.spread[i * n + j]).collect();
                let Some(c) = &factor else {
                    floor[i] = self.spread[i * n + i].max(0.0).sqrt();
                    continue;
                };
                let (k, k_whole) = (c.solve(&shared), c.solve(&whole));
                left[i] -= dot(&k, &innovation);
                let rest: Vec<f64> = k_whole.iter().zip(&k).map(|(a, b)| a - b).collect();
                let spread_of = |v: &[f64]| -> f64 {
                    let row = |a: usize| dot(&block[a * used.len()..(a + 1) * used.len()], v);
                    (0..used.len()).map(|a| v[a] * row(a)).sum()
                };
                let most = BELIEVED * spread_of(&rest).max(0.0).sqrt();
                let realised = dot(&rest, &innovation).clamp(-most, most);
                let conditional = self.spread[i * n + i] - dot(&k_whole, &whole);
                floor[i] = (conditional.max(0.0) + (self.offset[i] + realised).powi(2)).sqrt();
            }
        }
        (left, floor)
    }
}

/// Returns the residuals of the held-out runs by the analyst's model and with `members`, and their expected residual.
///
/// Each tested reading j is predicted from the readings u of the other half of its run. K i_u is subtracted, with K = J_j V J_u' G_uu^-1. The
/// innovation i is the residual minus its mean given the fit runs. G is the covariance of i, and J V J' the part of G from the patterns. Given i_u, a
/// right model leaves the mean square (m_j + (G_ju G_uu^-1 - K) i_u)^2 + G_jj - G_ju G_uu^-1 G_uj. The vector m contains the model errors that the
/// fit runs show. The residual before has no effects. Its only patterns are the nuisance loads and, if `reestimated` includes them, the wheel loads.
pub fn proof_residuals(
    finer: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
    reestimated: ReestimatedUnknowns,
) -> Option<ValidationResiduals> {
    let before = proof_residuals_before(finer, &[reestimated])?.pop()?;
    verdict_after_removal(finer, members, unknown, &[(reestimated, before)])?.pop()
}

/// Returns the residuals of the held-out runs by the analyst's model, for each of `reestimated`. They do not depend on the active effects.
pub(super) fn proof_residuals_before(
    finer: &StrainFrame,
    reestimated: &[ReestimatedUnknowns],
) -> Option<Vec<Vec<f64>>> {
    let own = finer.as_modelled();
    let predictor = ValidationPredictor::new(finer, &[], &[])?;
    let of = |reestimated: &ReestimatedUnknowns| {
        let without = Proof::new(&predictor, *reestimated);
        let runs = finer.observations.proof_runs().into_iter();
        runs.flat_map(|run| without.run(&own, run).residual_and_floor().0)
            .collect()
    };
    Some(reestimated.iter().map(of).collect())
}

/// Returns the residuals of [`proof_residuals`] for each of `ways`: the unknowns to estimate, with the residuals of [`proof_residuals_before`].
pub(super) fn verdict_after_removal(
    finer: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
    ways: &[(ReestimatedUnknowns, Vec<f64>)],
) -> Option<Vec<ValidationResiduals>> {
    let own = finer.as_modelled();
    let predictor = ValidationPredictor::new(finer, members, unknown)?;
    let of = |(reestimated, before): &(ReestimatedUnknowns, Vec<f64>)| {
        let with = Proof::new(&predictor, *reestimated);
        let mut out = ValidationResiduals::default();
        for run in finer.observations.proof_runs() {
            let now = with.run(&own, run);
            let (after, floor) = now.residual_and_floor();
            let from = out.after.len();
            out.extend(ValidationResiduals {
                gauges: now.all.0.iter().map(|e| e.1).collect(),
                reading: now.all.pick(&finer.observations.values, finer.n_gauges()),
                before: before
                    .iter()
                    .skip(from)
                    .take(after.len())
                    .copied()
                    .collect(),
                after,
                floor,
                mesh: now.mesh,
            });
        }
        out
    };
    Some(ways.iter().map(of).collect())
}
