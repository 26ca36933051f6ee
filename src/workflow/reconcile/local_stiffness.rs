//! Small regions of shells whose stiffness may be wrong, near gauges that disagree: a crack, a loose joint, a missing patch.
//!
//! A region contains the shells within a radius of a shell, and one factor scales all its moduli. Regions near the gauges that disagree are ranked by
//! the reduction of the residual with one amplitude each. Their signatures come to first order from adjoint solutions (one factor for all). The best
//! regions are moved, widened and narrowed. The leading regions are solved at half their stiffness, and the best of these join the library's effects.

use super::deck_frame::DeckFrame;
use super::influence::{adjoint, blank_payload, of_solver};
use super::local_ground::Ground;
use super::region::Region;
use super::stiffness_changes::DeckStiffnessChange;
use crate::fe::Adjoint;
use crate::gauge::strain_terms;
use crate::host::fault::Faults;
use crate::job::Job;
use crate::reconcile::effect::{Correction, Extension};
use crate::reconcile::strain::{StiffnessOf, StiffnessSignature, StrainFrame, StrainState};
use crate::reconcile::{NamedEffect, Outcome, Verdict};
use crate::units::MICROSTRAIN;

/// Stiffness at which a region is solved first, natural log times 100: half.
const HALF: f64 = -69.314_718_055_994_53;
/// Prior sd of a region's stiffness, natural log times 100: known to a factor of two, as a joint's.
const PRIOR: f64 = 70.0;
/// Grids that the solutions of the regions that lead may have together: a minute on two cores.
const BUDGET: usize = 1_000_000;
/// Regions of a look.
const LOOKS: usize = 32;
/// Number of gauges that a search includes, the gauges that disagree first. Each gauge is a further right-hand side.
const COUNTED: usize = 64;
/// Regions that are moved, widened and narrowed, by shares of their radius.
const REFINED: usize = 2;
/// Each finer.
const STEPS: [f64; 3] = [0.9, 0.5, 0.3];
/// Number of regions added to the library, and largest number of regions that are solved to find them.
const KEPT: usize = 4;
const LEADING: usize = 2 * KEPT;
/// Gauges that are looked round, worst first.
const GAUGES: usize = 8;

/// A region with what halving its stiffness does to the influence matrix, to first order or solved.
struct TrialRegion {
    region: Region,
    change: Vec<f64>,
    /// Share of the squared residual that one amplitude explains.
    takes: f64,
}

/// Returns the gauges near which a region is searched, if nothing explains the gap or if several gauges would each be at fault; otherwise none.
pub(super) fn gauges_that_disagree(outcome: &Outcome) -> Vec<String> {
    // If a smooth model error replaces named effects, the gauges of these effects count too.
    let attempt = outcome.best_attempt.iter().chain(&outcome.replaced);
    let at_fault: Vec<&String> = attempt.flat_map(read_otherwise).collect();
    if outcome.verdict != Verdict::Unknown && at_fault.len() < 2 {
        return vec![];
    }
    let mut out: Vec<String> = Vec::new();
    let off = outcome.gauges_off_before.iter().map(|m| &m.name);
    for name in at_fault.into_iter().chain(off) {
        if !out.contains(name) && out.len() < GAUGES {
            out.push(name.clone());
        }
    }
    out
}

/// Returns the gauges with another strain according to an effect, gauges of a card included.
fn read_otherwise(e: &NamedEffect) -> Vec<&String> {
    let Extension::Channels(list) = &e.extension else {
        return vec![];
    };
    let of_strain = |c: &&(String, Correction)| {
        matches!(
            c.1,
            Correction::Gain(_) | Correction::AngleDeg(_) | Correction::PositionMm(_)
        )
    };
    list.iter().filter(of_strain).map(|c| &c.0).collect()
}

impl DeckFrame {
    /// Returns the signatures of the regions that explain most of the residual of the gauges `off`. The regions are kept by place for
    /// [`DeckFrame::shells_of_region`].
    pub(super) fn regions_round(
        &mut self,
        job: &Job,
        frame: &StrainFrame,
        off: &[String],
    ) -> Result<Vec<StiffnessSignature>, Faults> {
        let Some(ground) = Ground::from_frame(self.fields.model(), self, frame, off) else {
            return Ok(vec![]);
        };
        let residual = Residual::from_frame(frame);
        let adjoint = self.adjoint(job, &ground)?;
        let tried = |(region, change): (Region, Vec<f64>)| TrialRegion {
            takes: residual.takes(frame, &change),
            region,
            change,
        };
        let look = |regions: Vec<Region>| -> Result<Vec<TrialRegion>, Faults> {
            let changes = adjoint.by_halving(job, &regions)?;
            Ok(regions.into_iter().zip(changes).map(tried).collect())
        };
        let mut all = best_first(look(ground.first_regions(LOOKS))?);
        for step in STEPS {
            let near: Vec<Region> = all
                .iter()
                .take(REFINED)
                .flat_map(|t| ground.regions_near(&t.region, step, LOOKS))
                .collect();
            let mut fresh: Vec<Region> = Vec::new();
            for r in near {
                let known = all.iter().any(|t| t.region.shells == r.shells)
                    || fresh.iter().any(|f| f.shells == r.shells);
                if !known && fresh.len() < LOOKS {
                    fresh.push(r);
                }
            }
            all.extend(look(fresh)?);
            all = best_first(all);
        }
        let n = (BUDGET / ground.model.grids.len().max(1)).clamp(KEPT, LEADING);
        let leading: Vec<Region> = keep_distinct_places(all, n)
            .into_iter()
            .map(|t| t.region)
            .collect();
        let half = (HALF / 100.0).exp();
        let halved = |r: &Region| DeckStiffnessChange::Shells(r.shells.clone(), half);
        let changes = self.changes_by(job, &leading.iter().map(halved).collect::<Vec<_>>())?;
        let solved = leading.into_iter().zip(changes).map(tried).collect();
        let kept = keep_distinct_places(best_first(solved), KEPT);
        self.regions = kept.iter().map(|t| t.region.clone()).collect();
        Ok(kept
            .into_iter()
            .map(|t| StiffnessSignature {
                of: StiffnessOf::Local,
                place: t.region.place,
                at_percent: vec![(HALF, t.change)],
                prior_percent: PRIOR,
            })
            .collect())
    }

    /// Solves the displacements under the job's loads, and the adjoint displacements of the gauge readings.
    fn adjoint(&self, job: &Job, ground: &Ground<'_>) -> Result<Readings<'_>, Faults> {
        let mut counted: Vec<usize> = (0..self.gauges.len()).collect();
        counted.sort_by(|a, b| {
            ground
                .distance_of_gauge(*a)
                .total_cmp(&ground.distance_of_gauge(*b))
        });
        counted.truncate(COUNTED);
        let terms: Vec<_> = counted
            .iter()
            .map(|g| self.gauges.get(*g).map_or_else(Vec::new, strain_terms))
            .collect();
        let adjoint = adjoint(job, self.fields.model(), &self.columns, &terms, &self.stop)?;
        Ok(Readings {
            adjoint,
            counted,
            n_gauges: self.gauges.len(),
            n_columns: self.columns.len(),
        })
    }

    /// Returns the shells of the region at `place`. The list is empty if there is no such region.
    pub(super) fn shells_of_region(&self, place: &str) -> Vec<usize> {
        let region = self.regions.iter().find(|r| r.place == place);
        region.map_or_else(Vec::new, |r| r.shells.clone())
    }
}

/// Adjoint solutions of the gauges that count.
struct Readings<'a> {
    adjoint: Adjoint<'a>,
    counted: Vec<usize>,
    n_gauges: usize,
    n_columns: usize,
}

impl Readings<'_> {
    /// Returns the first-order change of the influence matrix for half the stiffness of each region; zero for gauges that are not counted.
    fn by_halving(&self, job: &Job, regions: &[Region]) -> Result<Vec<Vec<f64>>, Faults> {
        let sets: Vec<&[usize]> = regions.iter().map(|r| r.shells.as_slice()).collect();
        let changes = self
            .adjoint
            .changes(&sets)
            .map_err(|e| of_solver(job, &e))?;
        let half = (HALF / 100.0).exp() - 1.0;
        let n_c = self.n_columns;
        let spread = |rows: Vec<f64>| {
            let mut out = vec![0.0; self.n_gauges * n_c];
            for (row, g) in rows.chunks_exact(n_c.max(1)).zip(&self.counted) {
                let cells = out.iter_mut().skip(g * n_c);
                cells
                    .zip(row)
                    .for_each(|(o, c)| *o = half * c / MICROSTRAIN);
            }
            blank_payload(job, self.adjoint.model(), &mut out, n_c);
            out
        };
        Ok(changes.into_iter().map(spread).collect())
    }
}

fn best_first(mut all: Vec<TrialRegion>) -> Vec<TrialRegion> {
    all.sort_by(|a, b| b.takes.total_cmp(&a.takes));
    all
}

/// Returns the first `n` regions at distinct places.
fn keep_distinct_places(all: Vec<TrialRegion>, n: usize) -> Vec<TrialRegion> {
    let mut out: Vec<TrialRegion> = Vec::new();
    for t in all {
        if out.len() < n && out.iter().all(|k| k.region.place != t.region.place) {
            out.push(t);
        }
    }
    out
}

/// Readings minus prediction over the runs that are fitted, each over its own standard deviation.
struct Residual {
    /// Run, gauge, residual, weight.
    entries: Vec<(usize, usize, f64, f64)>,
    nominal: StrainState,
}

impl Residual {
    fn from_frame(frame: &StrainFrame) -> Self {
        let nominal = StrainState::from_nominal_model(frame);
        let uncertainty = frame.relative_uncertainty();
        let runs = frame.observations.fit_runs();
        let entries = frame
            .observations
            .entries(&runs)
            .into_iter()
            .filter_map(|(run, g)| {
                let there = *nominal.strain(run).get(g)?;
                let sd = frame.noise_of(g).hypot(uncertainty.get(g)? * there);
                let weight = 1.0 / sd.max(f64::MIN_POSITIVE);
                Some((run, g, frame.observations.value(run, g) - there, weight))
            })
            .collect();
        Self { entries, nominal }
    }

    /// Returns the share of the squared residual that a change of the influence matrix explains with one amplitude.
    fn takes(&self, frame: &StrainFrame, change: &[f64]) -> f64 {
        let mut moved = self.nominal.clone();
        moved
            .influence
            .iter_mut()
            .zip(change)
            .for_each(|(i, d)| *i += d);
        let runs = 0..frame.n_runs();
        let rows: Vec<[Vec<f64>; 2]> = runs
            .map(|r| [self.nominal.strain(r), moved.strain(r)])
            .collect();
        let (mut rs, mut ss, mut rr) = (0.0, 0.0, 0.0);
        for &(run, g, residual, weight) in &self.entries {
            let Some([before, after]) = rows.get(run) else {
                continue;
            };
            let (Some(b), Some(a)) = (before.get(g), after.get(g)) else {
                continue;
            };
            let (s, r) = (weight * (a - b), weight * residual);
            rs += r * s;
            ss += s * s;
            rr += r * r;
        }
        if ss > 0.0 && rr > 0.0 {
            rs * rs / (ss * rr)
        } else {
            0.0
        }
    }
}
