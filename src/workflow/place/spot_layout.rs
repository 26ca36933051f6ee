//! Layouts of named spots: chosen one by one, or within a budget.

use super::chosen_layout::{ChoiceRefusal, ChosenLayout};
use super::job_gauge_rows::{GluingEffect, gluing_effects};
use super::pool::Kind;
use super::spots::{LaidSpot, Leg};
use super::task::Task;
use crate::gauge::{Bridge, Gauge};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::NamedSpot;
use crate::job::readings::readings_of;
use crate::placement::bundles::{BundleSpec, Bundles, place_bundles};
use crate::placement::candidates::{Candidates, Scatter};
use crate::placement::{Layout, Loss, PlaceError, Spec};
use crate::sensitivity::NoStrain;
use crate::strain_chain::{lay_gauges, without_strain};

impl Task<'_> {
    /// Lays the spots of the job's table onto the model, with the strain and the scatter of each reading.
    ///
    /// # Errors
    /// Spots that can't be laid or have no strain, and keys of `[placement]` that contradict the table.
    pub fn lay_spots(&mut self, work: &mut Work) -> Result<(), Faults> {
        let job = self.job;
        let (Some(stated), Some(as_gauges)) = (&job.candidates.spots, job.with_spots_as_gauges())
        else {
            return Ok(());
        };
        self.check_budget()?;
        let mut laid = lay_gauges(work, &as_gauges, self.fields)?.into_iter();
        let legs_of = |spot: &NamedSpot| -> Vec<Gauge> {
            laid.by_ref().take(readings_of(&spot.gauge).len()).collect()
        };
        let legs: Vec<Vec<Gauge>> = stated.iter().map(legs_of).collect();
        let absent = legs.iter().filter_map(|l| self.s_of(l).err());
        let missing: Vec<NoStrain> = absent.flatten().collect();
        if !missing.is_empty() {
            return Err(without_strain(&as_gauges, &missing));
        }
        let pairs = stated.iter().zip(&legs);
        let pairs = pairs.flat_map(|(s, legs)| legs.iter().map(move |l| (l, Some(&s.gauge))));
        let mut effects = gluing_effects(self, &pairs.collect::<Vec<_>>()).into_iter();
        let spots = stated.iter().zip(legs).map(|(spot, legs)| {
            let of_legs = effects.by_ref().take(legs.len());
            self.laid_spot(spot, legs.into_iter().zip(of_legs.collect::<Vec<_>>()))
        });
        let spots: Vec<LaidSpot> = spots.collect();
        self.sites = spots
            .iter()
            .flat_map(|s| &s.legs)
            .filter_map(|l| l.site)
            .collect();
        self.spots = Some(spots);
        Ok(())
    }

    /// Returns the number of places that gauges are chosen from.
    pub fn n_places(&self) -> usize {
        self.spots.as_ref().map_or(self.sites.len(), Vec::len)
    }

    fn laid_spot(
        &self,
        spot: &NamedSpot,
        legs: impl Iterator<Item = (Gauge, Option<GluingEffect>)>,
    ) -> LaidSpot {
        let p = &self.job.placement;
        let leg = |(gauge, glued): (Gauge, Option<GluingEffect>)| {
            let one = std::slice::from_ref(&gauge);
            let s = self.s_of(one).ok()?;
            let more = [glued.as_ref().map_or(0.0, |g| g.variance)];
            let mut rows = self.rows_of(one, &s, p.model_uncertainty_rel, &more);
            Some(Leg {
                strain: rows.strain.pop()?,
                sd: rows.sd.pop()?,
                turn: glued.as_ref().map_or(0.0, |g| g.turn),
                angle: glued.as_ref().map_or(gauge.angle_rad, |g| g.angle),
                site: glued.map(|g| g.site),
                gauge,
            })
        };
        let legs: Vec<Leg> = legs.filter_map(leg).collect();
        LaidSpot {
            stated: spot.gauge.clone(),
            cost: spot.cost.unwrap_or(legs.len() as f64),
            legs,
        }
    }

    /// Refuses keys that limit a layout twice, or not at all.
    fn check_budget(&self) -> Result<(), Faults> {
        let (job, p) = (self.job, &self.job.placement);
        let file = job
            .candidates
            .file
            .as_ref()
            .map_or("", |f| f.given.as_str());
        let mut faults = FaultList::new();
        let mut fault = |field: &str, wrong: String, remedy: &str| {
            let field = format!("placement.{field}");
            faults.push(Fault::with_line(&*job.file, p.line, field, wrong, remedy));
        };
        match (p.budget, p.gauges) {
            (None, _) if job.candidates.has_costs() => fault(
                "budget",
                format!(
                    "`{file}` states costs, and the job does not state how much a layout may cost"
                ),
                "state `budget`, the largest total cost in the unit of the column `cost`, or delete that column",
            ),
            (Some(_), Some(_)) => fault(
                "gauges",
                "`gauges` and `budget` both limit the layout of named spots".to_owned(),
                "state one of the two",
            ),
            (Some(_), None) if !p.curve.is_empty() => fault(
                "curve",
                "`curve` counts gauges, and `budget` limits their cost".to_owned(),
                "delete one of the two",
            ),
            _ => {}
        }
        let is_priced = p.budget.is_some() || job.candidates.has_costs();
        if is_priced && p.loss == Loss::Optimised {
            fault(
                "loss",
                "\"optimise\" is for spots without costs or a budget".to_owned(),
                "write loss = \"judge\": the loss of each gauge is then reported",
            );
        }
        Faults::check(faults)
    }
}

/// Returns the spots as candidates with fixed rows.
pub(super) fn kind(task: &Task, spots: &[LaidSpot]) -> Kind {
    let k = task.cases.len();
    let noise = task.job.placement.noise_microstrain;
    let first: Vec<&Leg> = spots.iter().filter_map(|s| s.legs.first()).collect();
    let scatter = Scatter {
        extra: first.iter().map(|l| l.sd * l.sd - noise * noise).collect(),
        ..Scatter::with_uniform_noise(noise)
    };
    let fill = |spot: usize, row: &mut [f64]| row.copy_from_slice(&first[spot].strain);
    Kind {
        bridge: Bridge::Quarter,
        candidates: Candidates::from_rows(k, first.len(), scatter, fill)
            .with_positions(positions(spots)),
    }
}

fn positions(spots: &[LaidSpot]) -> Vec<[f64; 3]> {
    let at = spots.iter().map(LaidSpot::position);
    at.map(|x| [x.x, x.y, x.z]).collect()
}

/// Returns the spots of a layout, in the order of the table.
pub(super) fn of_layout(
    spots: &[LaidSpot],
    layout: &Layout,
    least_condition: Option<f64>,
) -> ChosenLayout {
    let mut chosen: Vec<usize> = layout.gauges.iter().map(|c| c.place as usize).collect();
    chosen.sort_unstable();
    let channels = chosen.iter().filter_map(|&i| spots.get(i));
    ChosenLayout {
        channels: channels.flat_map(LaidSpot::channels).collect(),
        log_det: layout.log_det,
        upper_bound: layout.upper_bound,
        efficiency_bound: layout.efficiency_bound,
        proved: layout.proved,
        nodes: layout.nodes,
        cost: None,
        least_condition,
    }
}

/// Chooses spots, rosettes with all their legs, within the budget.
pub(super) fn within_budget(
    task: &Task,
    spots: &[LaidSpot],
    spec: &Spec,
) -> Result<ChosenLayout, ChoiceRefusal> {
    let mut bundles = Bundles::new(task.cases.len(), positions(spots));
    for (i, spot) in spots.iter().enumerate() {
        let rows: Vec<Vec<f64>> = spot.legs.iter().map(Leg::row).collect();
        bundles.add(&rows, spot.cost, [i as u32; 2]);
    }
    let budget = task.job.placement.budget.unwrap_or(spec.gauges as f64);
    let of_bundles = BundleSpec {
        budget,
        spacing: spec.spacing,
        prior: spec.prior.clone(),
        criterion: spec.criterion.clone(),
        tolerance: spec.tolerance,
        effort: spec.effort,
    };
    let layout = place_bundles(&bundles, &of_bundles).map_err(|e| {
        ChoiceRefusal::By(match e {
            PlaceError::Singular { loads, .. } => PlaceError::Singular {
                gauges: count_affordable(spots, budget),
                loads,
            },
            e => e,
        })
    })?;
    let chosen = || layout.bundles.iter().filter_map(|&u| spots.get(u));
    Ok(ChosenLayout {
        channels: chosen().flat_map(LaidSpot::channels).collect(),
        log_det: layout.log_det,
        upper_bound: layout.upper_bound,
        efficiency_bound: layout.efficiency_bound,
        proved: false,
        nodes: 0,
        cost: Some(chosen().map(|s| s.cost).sum()),
        least_condition: None,
    })
}

/// Returns the largest number of spots that the budget pays for.
fn count_affordable(spots: &[LaidSpot], budget: f64) -> usize {
    let mut costs: Vec<f64> = spots.iter().map(|s| s.cost).collect();
    costs.sort_by(f64::total_cmp);
    let sums = costs.iter().scan(0.0, |sum, cost| {
        *sum += cost;
        Some(*sum)
    });
    sums.take_while(|sum| *sum <= budget).count()
}
