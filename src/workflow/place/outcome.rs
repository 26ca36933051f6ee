//! Answer of `place`.

use crate::estimate::NORMAL_95;
use crate::fe::strain_tensor::Surface;
use crate::gauge::{Bridge, Gauge};
use crate::host::outcome::Answer;
use crate::host::words::count_of;
use crate::job::{Job, JobGauge, StatedPlace};
use crate::placement::Role;
use crate::sensitivity::Sensitivity;
use crate::strain_chain::{Conditioning, Fields, GaugeMeshError, LoadSigma};
use crate::units::{factor, half_width};
use serde::Serialize;
use std::sync::Arc;

/// A layout of gauges with its certificate.
#[derive(Serialize)]
pub struct CertifiedLayout {
    /// The gauges chosen.
    pub gauges: Vec<PlacedGauge>,
    /// Files for the workshop: the table of gauges and the gluing sheets.
    pub files: [&'static str; 4],
    /// Candidates that the gauges were chosen from.
    pub candidates: Candidates,
    /// Optimality criterion, as a job names it.
    pub criterion: &'static str,
    /// ln det(S'S), rows over their standard deviations.
    pub log_det: f64,
    /// Upper bound of `log_det` of all layouts of these candidates.
    pub upper_bound: f64,
    /// Certified lower bound on the efficiency, relative to the best possible layout, 0 to 1.
    pub efficiency_bound: f64,
    /// Whether the layout is proved to be the best.
    pub proved: bool,
    /// Nodes of the proof.
    pub nodes: usize,
    /// Costs, if they were counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
    /// Gauges that stay.
    pub kept: Vec<String>,
    /// Mesh error by gauge, if the job asks for it. The layout is corrected for the mesh error, and the weights include its possible remainder.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_error: Vec<GaugeMeshError>,
    /// Rank and condition numbers of S.
    #[serde(flatten)]
    pub conditioning: Conditioning,
    /// Least condition number that the search found, if it was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_condition_number_scaled: Option<f64>,
    /// One standard deviation of each load, report units.
    pub load_sigma: Vec<LoadSigma>,
    /// Gauge whose loss reduces the efficiency most.
    pub worst_loss: WorstLoss,
    /// Gauges kept for validation.
    pub reserved: Vec<ReservedGauge>,
    /// Quality of the job's gauges by these measures.
    pub installed: Option<InstalledLayout>,
    /// Results with other numbers of gauges, if the job asks for them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub how_many: Vec<CurvePoint>,
    /// S of the chosen gauges and of the gauges that stay.
    #[serde(skip)]
    pub sensitivity: Sensitivity,
    /// Model and strain fields.
    #[serde(skip)]
    pub fields: Arc<Fields>,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

/// Files for the workshop.
pub(super) const FILES: [&str; 4] = [
    "gauges.csv",
    "gluing_sheet.html",
    "gluing_sheet.csv",
    "gluing_sheet.md",
];

impl Answer for CertifiedLayout {
    const COMMAND: &'static str = "place";
    const RESULT: &'static str = "The layout";

    fn verdict(&self) -> String {
        let share = match self.proved {
            true => "the best possible layout (proved)".to_owned(),
            false => format!(
                "at least {:.1} % of the best possible layout",
                // Rounded down: it is a lower bound.
                (1000.0 * self.efficiency_bound).floor() / 10.0
            ),
        };
        let least_certain = self.least_certain().map_or_else(String::new, |l| {
            let half = half_width(NORMAL_95 * l.sigma());
            format!(", least certain load {} {half} {}", l.name, l.unit)
        });
        format!(
            "{} from {} candidates: {share}{least_certain}.",
            count_of(self.gauges.len(), "gauge"),
            self.candidates.rows
        )
    }
}

impl CertifiedLayout {
    /// Returns the half width of the 95 % interval of a load, divided by its expected size. `None` if the job states no size.
    pub fn share_of_expected(&self, load: &LoadSigma) -> Option<f64> {
        self.share_of(&load.name, load.sigma())
    }

    fn share_of(&self, name: &str, sigma: f64) -> Option<f64> {
        let of_job = self.job.loads.iter().find(|l| l.name == name)?;
        let factor = of_job
            .report_unit(&self.job.report_units)
            .map_or(1.0, |u| factor(self.job.units, u));
        let expected = of_job.expected? * factor;
        Some(NORMAL_95 * sigma / expected.abs())
    }

    /// Returns the largest half width of the 95 % interval of a load, divided by its expected size, and the name of the load. `sigmas` are names and
    /// standard deviations in report units. `None` if the job does not state the sizes of all loads. Combinations have no expected size.
    fn largest_share_of<'a>(
        &self,
        sigmas: impl Iterator<Item = (&'a str, f64)>,
    ) -> Option<(&'a str, f64)> {
        let is_known = self.job.loads.iter().all(|l| l.expected.is_some());
        let shares = sigmas.filter_map(|(name, sigma)| Some((name, self.share_of(name, sigma)?)));
        let largest = shares.max_by(|a, b| a.1.total_cmp(&b.1));
        largest.filter(|_| is_known)
    }

    /// Returns the load with the largest 95 % half width over its expected size, and this share. It uses `sigma` as recovered, like
    /// [`CertifiedLayout::largest_share_at`]. `None` if the job does not state the sizes of all loads.
    pub fn largest_share(&self) -> Option<(&str, f64)> {
        self.largest_share_of(self.load_sigma.iter().map(|l| (&*l.name, l.sigma)))
    }

    /// Returns the load and share of [`CertifiedLayout::largest_share`] for a point of the curve over the number of gauges.
    pub fn largest_share_at<'a>(&self, point: &'a CurvePoint) -> Option<(&'a str, f64)> {
        self.largest_share_of(point.load_sigma.iter().map(|l| (&*l.name, l.sigma)))
    }

    /// Returns the load with the widest interval over its expected size, where the job states the sizes of all loads.
    fn least_certain(&self) -> Option<&LoadSigma> {
        let sigmas = self.load_sigma.iter().map(|l| (&*l.name, l.sigma()));
        let (name, _) = self.largest_share_of(sigmas)?;
        self.load_sigma.iter().find(|l| l.name == name)
    }
}

/// Number of candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Candidates {
    /// Number of surfaces of elements.
    pub places: usize,
    /// Number of rows: places times angles and wirings.
    pub rows: usize,
}

/// A gauge that placement chose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlacedGauge {
    /// Name of the gauge.
    pub name: String,
    /// Element id.
    pub element: u32,
    /// `top` or `bottom`.
    pub surface: &'static str,
    /// Position of the gauge, basic frame.
    pub position: [f64; 3],
    /// Unit vector of the axis, basic frame.
    pub direction: [f64; 3],
    /// Angle from the element x axis, right-handed about the element normal.
    pub angle_deg: f64,
    /// Angle as seen from outside by the technician. On the bottom it turns in the opposite direction.
    pub angle_seen_deg: f64,
    /// Leverage of the gauge.
    pub leverage: f64,
    /// Sum of the strains under the expected loads, microstrain.
    pub expected_microstrain: f64,
    /// Wiring.
    pub bridge: &'static str,
    /// Purpose of the gauge.
    pub role: Role,
    /// Standard deviation of the reading, microstrain.
    pub sd_microstrain: f64,
    /// Error of the angle, degrees, that moves some load by 5 % of its expected size; `None` if no error does.
    pub angle_budget_deg: Option<f64>,
    /// Error of the place, model units, that moves some load by 5 % of its expected size; `None` if no error does.
    pub position_budget: Option<f64>,
    /// Strain of the gauge under each load of expected size.
    pub strain_by_load: Vec<StrainOfLoad>,
    /// Nearest reference point, and the vector from there to the gauge, basic frame.
    #[serde(skip)]
    pub reference: Option<(String, [f64; 3])>,
    /// Spot of the job's table, as stated there. `None` for a gauge that the search placed.
    #[serde(skip)]
    pub spot: Option<JobGauge>,
    /// Gauge as laid onto the model.
    #[serde(skip)]
    pub gauge: Gauge,
}

impl PlacedGauge {
    /// Returns the length of the gauge's grid: the length in its spot, else the length of the candidates.
    pub fn grid_length(&self, of_candidates: f64) -> f64 {
        self.spot.as_ref().map_or(of_candidates, |s| s.grid_length)
    }

    /// Returns the gauge as a job states it, like its row of `gauges.csv`; `of_candidates` is the grid length of the candidates.
    pub fn to_job_gauge(&self, of_candidates: f64) -> JobGauge {
        if let Some(spot) = &self.spot {
            return spot.clone();
        }
        JobGauge {
            name: self.gauge.name.clone(),
            place: StatedPlace::Element(self.gauge.element),
            position: Some(self.position),
            surface: self.gauge.surface,
            surface_stated: true,
            direction: Some(self.direction),
            cid: 0,
            angle_deg: 0.0,
            bridge: Bridge::from_name(self.bridge).unwrap_or(Bridge::Quarter),
            bridge_factor: 1.0,
            grid_length: self.grid_length(of_candidates),
            pair: None,
            rosette: None,
            transverse_sensitivity: 0.0,
            role: self.role,
            member: String::new(),
            file: String::new(),
            line: 0,
        }
    }

    /// Returns the angle as the technician sees that side.
    pub(super) fn seen_deg(gauge: &Gauge) -> f64 {
        let deg = gauge.angle_rad.to_degrees();
        match gauge.surface {
            Surface::Top => deg,
            Surface::Bottom if deg == 90.0 => deg,
            Surface::Bottom => -deg,
        }
    }
}

/// Strain of a gauge under one load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StrainOfLoad {
    /// Load.
    pub name: String,
    /// Strain.
    pub microstrain: f64,
}

/// Effect of the loss of one gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstLoss {
    /// The gauge.
    pub gauge: String,
    /// Leverage of the gauge.
    pub leverage: f64,
    /// Efficiency without the gauge, 0 to 1.
    pub efficiency_left: f64,
}

/// A gauge kept for validation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReservedGauge {
    /// Name of the gauge.
    pub name: String,
    /// Standard deviation of the reading predicted from the other gauges. It includes the noise of the reading.
    pub prediction_sd_microstrain: f64,
}

/// Evaluation of the installed layout.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InstalledLayout {
    /// Number of gauges.
    pub gauges: usize,
    /// Rank of S of the gauges, if they don't separate the loads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// Quality of the gauges, if they separate the loads.
    #[serde(flatten)]
    pub quality: Option<InstalledQuality>,
}

/// Quality of the installed gauges.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InstalledQuality {
    /// ln det(S'S) with noise alone.
    pub log_det: Option<f64>,
    /// Upper bound of `log_det` of all layouts with the same number of gauges.
    pub upper_bound: Option<f64>,
    /// Condition number of S in strain per job unit.
    pub condition_number: Option<f64>,
    /// Condition number of S with its columns multiplied by `expected`, or else normalised.
    pub condition_number_scaled: Option<f64>,
    /// One standard deviation of each load, report units.
    pub load_sigma: Vec<LoadSigma>,
    /// Gauge whose loss reduces the efficiency most.
    pub worst_loss: WorstLoss,
}

/// Results with one number of gauges.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Number of gauges.
    pub gauges: usize,
    /// Certified share of the best possible layout with this number of gauges.
    pub efficiency_bound: f64,
    /// Scaled condition number.
    pub condition_number_scaled: Option<f64>,
    /// Efficiency after the worst loss.
    pub worst_loss: f64,
    /// Standard deviation of each load.
    pub load_sigma: Vec<BoughtSigma>,
}

/// One standard deviation of a load, and its decrease by the last gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoughtSigma {
    /// Load.
    pub name: String,
    /// One standard deviation, report units.
    pub sigma: f64,
    /// Report unit.
    pub unit: String,
    /// Decrease relative to the previous count, for each added gauge.
    pub less_by_a_gauge: Option<f64>,
}
