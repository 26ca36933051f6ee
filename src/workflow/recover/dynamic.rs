//! `[dynamic]`: the vibration of the structure taken out of a record, with the modes of the model.

use super::motion::{ModeInUse, Motion};
use super::task::Task;
use super::vibration_findings::{contradiction, vibration_finding};
use crate::estimate::NORMAL_95;
use crate::fe::{CaseResult, LoadCase, modal_loads};
use crate::finding::Finding;
use crate::gauge::gauge_reading;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{Damping, Dynamic, Job};
use crate::measured::record::{MOST_NUMBERS, Record};
use crate::recovery::ErrorModel;
use crate::recovery::dynamic::{
    AtRest, Dynamics, ElasticMode, ReadingCovariance, Unfit, estimate_modes, readings_at_rest,
    triangle, window,
};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::JobSensitivity;
use crate::strain_chain::built_in_solver::{ElasticModes, cases_of_job, faults_of, modes_kept};
use crate::strain_chain::deck::DeckModel;

/// Modes are solved up to at least this factor times the highest wanted frequency, and all solved modes are used. The next mode exceeds its
/// quasi-static response by an eighth at the highest frequency, and by a third at the end of the band. The uncertainty includes this error.
const MODES_UP_TO: f64 = 3.0;
/// Number of modes that the solver searches at first, and at most.
const FIRST_MODES: usize = 16;
const MOST_MODES: usize = 256;
/// Factor on the number of modes expected in the band, which assumes that they are as dense as the modes below.
const MARGIN: f64 = 1.25;

/// Readings without the vibration of the structure, and their errors.
pub(crate) struct QuasiStaticReadings {
    /// Strain by gauge, every sample; NaN if nothing is known.
    pub readings: Vec<Vec<f64>>,
    pub motion: Motion,
    /// Noise variance of a reading, in units of the variance of a reading as measured.
    pub noise_share: f64,
    /// Covariance of the readings beyond that noise.
    pub doubt: ReadingCovariance,
    /// Number of samples after which noise is independent.
    pub apart: usize,
    /// Number of samples that are blank in the quasi-static readings only.
    pub blank: usize,
    pub findings: Vec<Finding>,
}

impl QuasiStaticReadings {
    /// Returns the noise variance of a reading minus its zero, in units of the variance of a reading as measured. `measured` is this factor before
    /// the vibration was removed.
    pub fn noise_factor(&self, measured: f64) -> f64 {
        measured - 1.0 + self.noise_share
    }
}

/// Modes of the structure of a job with `[dynamic]`, at its gauges and loads.
#[derive(Clone, Debug)]
pub(crate) struct VibrationModel {
    /// Job file.
    file: String,
    asked: Dynamic,
    stated: Dynamics,
}

impl VibrationModel {
    /// Returns the modes at the gauges and loads of `s`; `None` for a job without `[dynamic]`.
    ///
    /// # Errors
    /// A job whose model has no modes, too many modes below the band, or a load or gauge that is not part of the model.
    pub fn of_job(
        work: &mut Work,
        job: &Job,
        prepared: &JobSensitivity,
        s: &Sensitivity,
    ) -> Result<Option<Self>, Faults> {
        let Some(asked) = &job.dynamic else {
            return Ok(None);
        };
        Ok(Some(Self {
            file: job.file.clone(),
            asked: asked.clone(),
            stated: dynamics(work, (job, prepared), asked, s)?,
        }))
    }

    /// Returns the modes at these gauges, in their order.
    pub fn of_gauges(&self, gauges: &[usize]) -> Self {
        let mut own = self.clone();
        for mode in &mut own.stated.modes {
            mode.strain = gauges.iter().map(|g| mode.strain[*g]).collect();
        }
        own
    }

    fn fault(&self, wrong: String, remedy: &str) -> Faults {
        let line = self.asked.line;
        Fault::with_line(&*self.file, line, "dynamic", wrong, remedy).into()
    }

    /// Checks that the readings of a record and their errors fit into memory.
    ///
    /// # Errors
    /// A record that is too long.
    pub fn check_length(&self, samples: usize, n: usize, step_s: f64) -> Result<(), Faults> {
        let errors = samples / window(&self.stated, 1.0 / step_s) * triangle(n);
        match samples.saturating_mul(n).saturating_add(errors) > MOST_NUMBERS {
            false => Ok(()),
            true => Err(self.fault(
                format!(
                    "the record has {samples} samples of {n} gauges. Readings and their errors must be held in memory while the \
                     vibration of the structure is subtracted"
                ),
                "cut the record into parts. The limit is 100 million numbers: readings, and half of the squared number of gauges in each \
                 period of `up_to_hz`",
            )),
        }
    }

    /// Returns the readings of a record without the vibration of the structure. `readings` are strain by gauge of `s`, every sample. `go_on` returns
    /// an error if the work is stopped.
    ///
    /// # Errors
    /// - The band does not fit the sampling rate.
    /// - The gauges do not determine the loads in the band.
    /// - The record is too short or does not determine the damping.
    pub fn remove(
        &self,
        s: &Sensitivity,
        errors: ErrorModel,
        readings: &[Vec<f64>],
        (step_s, file): (f64, &str),
        go_on: &dyn Fn() -> Result<(), Faults>,
    ) -> Result<QuasiStaticReadings, Faults> {
        let (asked, stated) = (&self.asked, &self.stated);
        let noise = errors.noise_variance(1.0).sqrt();
        let open = asked.damping == Damping::Estimate;
        let with = (readings, 1.0 / step_s);
        let estimated = estimate_modes(s, stated, open, (noise, errors.model_rel), with);
        let estimated = estimated.map_err(|e| self.fault(e.to_string(), remedy_of(&e)))?;
        if open && estimated.is_none() {
            return Err(self.fault(
                "the record does not determine the damping: this takes more gauges than loads, a mode below 1.5 `up_to_hz`, and a \
                 stretch without gaps"
                    .to_owned(),
                "state the damping as a number, or add gauges",
            ));
        }
        let dynamics = estimated.as_ref().map_or(stated, |e| &e.dynamics);
        go_on()?;
        let rested = readings_at_rest(s, dynamics, noise, readings, 1.0 / step_s);
        let rested = rested.map_err(|e| self.fault(e.to_string(), remedy_of(&e)))?;
        let motion = motion_of((stated, dynamics), &rested, step_s);
        if rested.known == 0 && rested.read > 0 {
            return Err(self.fault(
                format!(
                    "no stretch of the record with readings of the same gauges is longer than {:.4} s. A quasi-static sample depends on \
                     half of that time",
                    2.0 * motion.blank_s
                ),
                "record a longer time, or state a higher `up_to_hz`",
            ));
        }
        let contradicted = estimated
            .as_ref()
            .and_then(|e| contradiction((stated, open), e, file));
        let removed = vibration_finding(&motion, asked, file);
        Ok(QuasiStaticReadings {
            noise_share: rested.noise_share,
            doubt: rested.doubt,
            apart: independent_spacing(dynamics, step_s),
            blank: rested.blank,
            motion,
            readings: rested.readings,
            findings: std::iter::once(removed).chain(contradicted).collect(),
        })
    }
}

/// Returns the record without the vibration of the structure, and its errors, if the job asks for it.
///
/// # Errors
/// Returns the errors of [`VibrationModel::of_job`] and [`VibrationModel::remove`], or a fault of a record that is too long.
pub(super) fn remove_vibration(
    work: &mut Work,
    task: &Task,
    record: &Record,
    s: &Sensitivity,
) -> Result<Option<(Record, QuasiStaticReadings)>, Faults> {
    let Some(model) = VibrationModel::of_job(work, task.job, task.prepared, s)? else {
        return Ok(None);
    };
    let (first_s, step_s) = record.first_and_step();
    model.check_length(record.clock().samples, s.gauges.len(), step_s)?;
    let readings = record.columns()?;
    work.go_on()?;
    let of_record = (step_s, &*task.measured.strain.given);
    let mut removed = work.stage("vibration", |w| {
        model.remove(s, task.errors, &readings, of_record, &|| w.go_on())
    })?;
    drop(readings);
    work.findings.append(&mut removed.findings);
    let readings = std::mem::take(&mut removed.readings);
    let record = record.with_readings(readings, (first_s, step_s))?;
    Ok(Some((record, removed)))
}

/// Returns the number of samples between independent noise values. White noise in a band up to `f` is independent at a spacing of `1 / (2 f)`.
fn independent_spacing(dynamics: &Dynamics, step_s: f64) -> usize {
    (0.5 / (dynamics.up_to_hz * step_s)).ceil().max(1.0) as usize
}

fn remedy_of(e: &Unfit) -> &'static str {
    match e {
        Unfit::Rate { .. } => "state a lower `up_to_hz`, or sample faster",
        Unfit::Untold { .. } => {
            "state a lower `up_to_hz`, add gauges, or give nuisance loads `expected`"
        }
        Unfit::Narrow { .. } => {
            "state a higher `up_to_hz`, or give a record with a lower sample rate"
        }
        Unfit::Large { .. } => {
            "recover with fewer gauges, or state a lower `up_to_hz`, which takes fewer modes"
        }
        Unfit::Rings { .. } => {
            "state a lower `up_to_hz`, or add gauges for the loads that are measured least"
        }
    }
}

/// Modes of the job's structure at the gauges and loads of S.
fn dynamics(
    work: &mut Work,
    (job, prepared): (&Job, &JobSensitivity),
    asked: &Dynamic,
    s: &Sensitivity,
) -> Result<Dynamics, Faults> {
    let fault = |field: &str, wrong: String, remedy: &str| {
        Faults::from(Fault::with_line(
            &*job.file, asked.line, field, wrong, remedy,
        ))
    };
    let Some(fields) = &prepared.fields else {
        return Err(fault(
            "dynamic",
            "S is given without a model: the modes of the structure are unknown".to_owned(),
            "give a [model], or delete [dynamic] and low-pass filter the strain",
        ));
    };
    let deck = &fields.deck;
    let cases = cases_of_job(job, deck)?;
    let end_hz = MODES_UP_TO * asked.up_to_hz;
    let (solved, further) = modes_up_to(work, deck, &cases, end_hz)?;
    let last = solved.hz.last().copied();
    if further && last.is_some_and(|f| f < end_hz) {
        return Err(fault(
            "dynamic.up_to_hz",
            format!("the structure has more than {MOST_MODES} modes below {end_hz:.4} Hz"),
            "state a lower `up_to_hz`",
        ));
    }
    let work_of =
        modal_loads(&deck.model, &cases, &solved.shapes).map_err(|e| faults_of(&e, deck))?;
    let mut columns = Vec::with_capacity(s.loads.len());
    for load in &s.loads {
        let Some(l) = job.loads.iter().position(|l| l.name == load.name) else {
            return Err(fault(
                "load",
                format!("the place of load `{}` is not known", load.name),
                "give it a [[load]] with `grid` and `component`, or delete [dynamic]",
            ));
        };
        columns.push(l);
    }
    let strain_of = |case: &CaseResult| -> Result<Vec<f64>, Faults> {
        let at = |name: &String| {
            let gauge = prepared.gauges.iter().find(|g| g.name == *name);
            gauge.and_then(|g| gauge_reading(g, case)).ok_or_else(|| {
                fault(
                    "gauge",
                    format!("gauge `{name}` has no strain in the structure's modes"),
                    "delete it, or move it to an element of the deck",
                )
            })
        };
        s.gauges.iter().map(at).collect()
    };
    // The estimate sets a damping that is not stated.
    let damping_at = |hz: f64| asked.damping.stated_at(hz).unwrap_or(f64::NAN);
    let modes = (0..solved.hz.len())
        .map(|j| {
            let of_load = |l: &usize| work_of[*l][j] / job.loads[*l].applied;
            Ok(ElasticMode {
                hz: solved.hz[j],
                strain: strain_of(&solved.strain.cases[j])?,
                work: columns.iter().map(of_load).collect(),
                damping: damping_at(solved.hz[j]),
                frequency_sd: asked.frequency_uncertainty_rel,
                damping_sd: asked.damping_uncertainty_rel,
            })
        })
        .collect::<Result<_, Faults>>()?;
    Ok(Dynamics {
        modes,
        further_hz: last.filter(|_| further),
        further_damping: damping_at(last.unwrap_or(asked.up_to_hz)),
        up_to_hz: asked.up_to_hz,
    })
}

/// Returns the modes of the structure with the support of the cases, up to `end_hz` and beyond, and whether there may be further modes.
fn modes_up_to(
    work: &mut Work,
    deck: &DeckModel,
    cases: &[LoadCase],
    end_hz: f64,
) -> Result<(ElasticModes, bool), Faults> {
    let spc = cases.first().and_then(|c| c.spc);
    let mut count = FIRST_MODES;
    loop {
        let solved = modes_kept(work, deck, spc, count)?;
        let last = solved.hz.last().copied().unwrap_or(f64::INFINITY);
        let further = solved.hz.len() == count;
        if last >= end_hz || !further || count == MOST_MODES {
            return Ok((solved, further));
        }
        let as_dense = (MARGIN * count as f64 * end_hz / last).ceil() as usize;
        count = as_dense.min(MOST_MODES);
    }
}

fn motion_of((stated, dynamics): (&Dynamics, &Dynamics), rested: &AtRest, step_s: f64) -> Motion {
    let share = |(moves, load): (&f64, &f64)| Some((moves / load).sqrt()).filter(|r| r.is_finite());
    Motion {
        up_to_hz: dynamics.up_to_hz,
        modes_hz: dynamics.modes.iter().map(|m| m.hz).collect(),
        modes: (stated.modes.iter().zip(&dynamics.modes))
            .map(|(stated, used)| ModeInUse::new(stated, used))
            .collect(),
        blank_s: rested.reach as f64 * step_s,
        change_rel: rested.motion.iter().zip(&rested.load).map(share).collect(),
    }
}

impl ModeInUse {
    fn new(stated: &ElasticMode, used: &ElasticMode) -> Self {
        let ends = |value: f64, sd: f64| [-1.0, 1.0].map(|s| value * (s * NORMAL_95 * sd).exp());
        let [hz_low, hz_high] = ends(used.hz, used.frequency_sd);
        let [damping_low, damping_high] = ends(used.damping, used.damping_sd);
        Self {
            model_hz: stated.hz,
            hz: used.hz,
            hz_low,
            hz_high,
            damping: used.damping,
            damping_low,
            damping_high,
            estimated: used.frequency_sd < 0.7 * stated.frequency_sd
                || used.damping_sd < 0.7 * stated.damping_sd,
        }
    }
}
