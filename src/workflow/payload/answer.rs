//! The answer of `payload`.

use super::model::Parts;
use super::payload_findings::words;
use super::readings::{NetReading, Readings};
use super::task::Task;
use crate::host::outcome::{Answer, finite_or_none};
use crate::host::words::count_of;
use crate::job::Job;
use crate::payload::{PayloadRun, Place, WeighSpec, WeighedRun, Weighing};
use crate::strain_chain::{Conditioning, JobSensitivity};
use crate::units::{number, plus_minus};
use serde::Serialize;

/// Payloads weighed, report units.
#[derive(Serialize)]
pub struct WeighedPayloads {
    /// Payload of each run.
    pub payload: Vec<WeighedPayload>,
    /// Payload of each run from each gauge alone.
    pub by_gauge: Vec<SingleGauge>,
    /// Net reading of each gauge in each run: reading minus zero.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub net: Vec<NetReading>,
    /// Rank and condition numbers of S, if strain is used and S is from the model.
    #[serde(flatten)]
    pub conditioning: Option<Conditioning>,
    /// Runs with the data of the estimate.
    #[serde(skip)]
    pub runs: Vec<PayloadRun>,
    /// Complete result of the weighing.
    #[serde(skip)]
    pub weighing: Weighing,
    /// S and gauges, if strain is used.
    #[serde(skip)]
    pub prepared: Option<JobSensitivity>,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for WeighedPayloads {
    const COMMAND: &'static str = "payload";
    const RESULT: &'static str = "The payload";

    fn verdict(&self) -> String {
        let weighed = || self.payload.iter().filter(|p| p.refused.is_none());
        let refused = match self.payload.len() - weighed().count() {
            0 => String::new(),
            n => format!("; {} refused", count_of(n, "run")),
        };
        let (force, mass) = (self.job.report_units.force, self.job.report_units.mass);
        let words = |p: &WeighedPayload| {
            let mass = p
                .mass
                .map_or_else(String::new, |m| format!(" ({} {})", number(m), mass.name));
            format!("{} {}{mass}", p.weight(), force.name)
        };
        let half = |p: &WeighedPayload| p.half_width();
        let widest = weighed().max_by(|a, b| half(a).total_cmp(&half(b)));
        match (weighed().count(), widest) {
            (_, None) => "No run determines a payload.".to_owned(),
            (1, Some(one)) => format!("Payload of {}: {}{refused}.", one.run, words(one)),
            (n, Some(widest)) => format!(
                "{} weighed, least certain {}: {}{refused}.",
                count_of(n, "payload"),
                widest.run,
                words(widest)
            ),
        }
    }
}

/// One payload. A refused payload has no numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WeighedPayload {
    /// The run.
    pub run: String,
    /// Weight.
    pub force: Option<f64>,
    /// Standard deviation of the force.
    pub force_sigma: Option<f64>,
    /// Lower end of its 95 % interval.
    pub force_low: Option<f64>,
    /// Upper end of its 95 % interval.
    pub force_high: Option<f64>,
    /// Mass.
    pub mass: Option<f64>,
    /// Standard deviation of the mass.
    pub mass_sigma: Option<f64>,
    /// Place in plan.
    pub position: [Option<f64>; 2],
    /// Standard deviations of the position. `None` if the place is known.
    pub position_sigma: Option<[Option<f64>; 2]>,
    /// Region that contains the payload with a probability of 95 %; `None` if the place is known.
    pub region: Option<Ellipse>,
    /// Reason why there is no answer.
    pub refused: Option<String>,
    /// Unit of the weight.
    pub unit: String,
}

impl WeighedPayload {
    /// Returns the weight with its interval. The interval begins at zero if the structure may be empty.
    pub fn weight(&self) -> String {
        match (self.force, self.force_low, self.force_high) {
            (Some(force), Some(low), Some(high)) if low <= 0.0 => {
                format!("{} (0 to {})", number(force), number(high))
            }
            (Some(force), ..) => plus_minus(force, self.half_width()),
            _ => "-".to_owned(),
        }
    }

    /// Returns the half width of the 95 % interval of the weight.
    pub fn half_width(&self) -> f64 {
        match (self.force_low, self.force_high) {
            (Some(low), Some(high)) => (high - low) / 2.0,
            _ => f64::NAN,
        }
    }
}

/// An ellipse in plan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ellipse {
    /// Half axes, the longer first.
    pub half_axes: [f64; 2],
    /// Angle of the longer half axis from the first axis of the plan.
    pub angle_deg: f64,
}

/// Payload of a run from one gauge alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SingleGauge {
    /// The run.
    pub run: String,
    /// The gauge.
    pub name: String,
    /// Weight.
    pub estimate: Option<f64>,
    /// Standard deviation of the estimate.
    pub sigma: Option<f64>,
    /// Whether the gauge is used.
    pub used: bool,
    /// Reason why the gauge is used or not.
    pub reason: String,
}

/// Returns a value if it is not refused.
fn accepted_value(r: &WeighedRun, v: f64) -> Option<f64> {
    if r.refused.is_some() {
        None
    } else {
        finite_or_none(v)
    }
}

/// Ratio of the standard deviation of a single gauge to the standard deviation of the answer. Above it, the gauge contributes less than a thousandth
/// of the answer.
const CARRIES: f64 = 32.0;

/// Returns the answer.
pub(super) fn report_payload(
    task: &Task,
    parts: Parts,
    readings: Readings,
    spec: &WeighSpec,
    weighing: Weighing,
) -> WeighedPayloads {
    let job = task.job;
    let payload = weighing
        .runs
        .iter()
        .map(|r| payload_of_run(task, spec, r))
        .collect();
    let mut by_gauge: Vec<SingleGauge> = Vec::new();
    for r in &weighing.runs {
        for (g, name) in parts.model.gauges.iter().enumerate() {
            let verdict = weighing.gauges.iter().find(|v| v.name == *name);
            let estimate = r.estimates.get(g).copied().unwrap_or(f64::NAN);
            let sigma = r.estimate_sigma.get(g).copied().unwrap_or(f64::NAN);
            // The share of a gauge in the mean is proportional to 1 / sigma^2.
            let carries = !(sigma > CARRIES * r.sigma);
            by_gauge.push(SingleGauge {
                run: r.run.clone(),
                name: name.clone(),
                estimate: finite_or_none(estimate),
                sigma: r.estimate_sigma.get(g).copied().and_then(finite_or_none),
                used: verdict.is_some_and(|v| v.used) && estimate.is_finite() && carries,
                reason: match verdict {
                    None => "no gauge gives a possible payload".to_owned(),
                    Some(v) if v.used && estimate.is_finite() && !carries => {
                        "too weak: the gauge has less than a thousandth of the weight in the answer"
                            .to_owned()
                    }
                    Some(v) => v.reason.clone(),
                },
            });
        }
    }
    let modelled = parts.prepared.as_ref().filter(|p| p.fields.is_some());
    WeighedPayloads {
        payload,
        by_gauge,
        net: readings.net,
        conditioning: modelled.map(|p| Conditioning::from_sensitivity(&p.sensitivity)),
        runs: readings.runs,
        weighing,
        prepared: parts.prepared,
        job: job.clone(),
    }
}

fn payload_of_run(task: &Task, spec: &WeighSpec, r: &WeighedRun) -> WeighedPayload {
    let free = spec.place == Place::Free;
    let (half_axes, angle) = r.ellipse();
    let spread = [0, 3].map(|k| accepted_value(r, r.shift_covariance[k].max(0.0).sqrt()));
    WeighedPayload {
        run: r.run.clone(),
        force: accepted_value(r, r.force),
        force_sigma: accepted_value(r, r.sigma),
        force_low: accepted_value(r, r.interval[0]),
        force_high: accepted_value(r, r.interval[1]),
        mass: accepted_value(r, r.force / task.weight_of_mass),
        mass_sigma: accepted_value(r, r.sigma / task.weight_of_mass),
        position: [0, 1].map(|k| accepted_value(r, task.nominal[k] + r.shift[k])),
        position_sigma: free.then_some(spread),
        region: (free && r.refused.is_none()).then(|| Ellipse {
            half_axes,
            angle_deg: angle.to_degrees(),
        }),
        refused: r.refused.map(|x| words(task, &x)),
        unit: task.job.report_units.force.name.to_owned(),
    }
}
