//! Rows of S for gauges whose installed position differs slightly from the nominal position.

use super::outcome::{CalibratedGauge, GlueSummary, InstalledGauge, InstalledPositionSummary};
use crate::calibrate::{GlueTolerance, InstalledPositionEstimate, MoveKind, OffDrawing};
use crate::finding::{Finding, Severity, list_few};
use crate::gauge::{CornerRows, Gauge, NominalGauge, Offset, centre, gauge_reading};
use crate::host::fault::{Fault, Faults};
use crate::job::{CalibrationKeys, Job};
use crate::linalg::Matrix;
use crate::model::Model;
use crate::sensitivity::LoadCaseOf;
use crate::strain_chain::{JobSensitivity, corrected_spec_of};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Sd of the tolerance over which a gauge may be looked for.
const REACH: f64 = 6.0;

/// Half step of the differences in place over the reach of a gauge: within its element and the next.
const PLACE_STEP: f64 = 0.5;

/// The job's gauges on its model. Their positions may change.
pub(super) struct Sites<'a> {
    model: &'a Model,
    corners: CornerRows,
    gauges: Vec<Option<NominalGauge<'a>>>,
    bridges: Vec<&'static str>,
    cases: Vec<LoadCaseOf<'a>>,
}

/// Returns the tolerances of `[calibration]`; `None` if both are zero.
pub(super) fn tolerance(keys: &CalibrationKeys) -> Option<GlueTolerance> {
    let stated = keys.position_tolerance > 0.0 || keys.angle_tolerance_deg > 0.0;
    stated.then(|| GlueTolerance {
        position: keys.position_tolerance,
        angle_rad: keys.angle_tolerance_deg.to_radians(),
    })
}

impl<'a> Sites<'a> {
    /// Returns the gauges of a job that has a model.
    ///
    /// # Errors
    /// S that is given: gauges can't be moved in a table. Ids that the deck lacks.
    pub fn from_job(
        job: &Job,
        prepared: &'a JobSensitivity,
        tolerance: GlueTolerance,
    ) -> Result<Self, Faults> {
        let fields = match &prepared.fields {
            Some(f) if job.sensitivity.is_none() => f,
            _ => {
                return Err(Fault::with_line(
                    &*job.file,
                    job.calibration.line,
                    "calibration.position_tolerance",
                    "gauges can be moved and turned only on a model, and the job gives S",
                    "delete position_tolerance and angle_tolerance_deg, or give a [model] and the gauges on it",
                )
                .into());
            }
        };
        let corners = fields.corner_rows(job);
        let reach = REACH * tolerance.position;
        let (mut gauges, mut bridges) = (Vec::new(), Vec::new());
        for g in &job.gauges {
            let spec = corrected_spec_of(fields.model(), job, g).map_err(Faults::from)?;
            let channels = spec.rosette.map_or(1, |r| r.legs().len());
            for _ in 0..channels {
                let channel = prepared.gauges.get(gauges.len());
                bridges.push(g.bridge.name());
                gauges.push(
                    channel
                        .and_then(|c| NominalGauge::new(fields.model(), &spec, c, corners, reach)),
                );
            }
        }
        Ok(Self {
            model: fields.model(),
            corners,
            gauges,
            bridges,
            cases: fields.load_cases(job),
        })
    }

    /// Returns the row of S of a gauge with an offset from its nominal position: along, across (job units of length), angle (radians).
    pub fn row(&self, gauge: usize, [along, across, angle_rad]: [f64; 3]) -> Option<Vec<f64>> {
        let (gauge, _) = self.gauges.get(gauge)?.as_ref()?.gauge_at_offset(Offset {
            along,
            across,
            angle_rad,
        })?;
        self.row_of(&gauge)
    }

    fn row_of(&self, gauge: &Gauge) -> Option<Vec<f64>> {
        let cases = self.cases.iter();
        cases
            .map(|l| Some(gauge_reading(gauge, l.case)? / l.applied))
            .collect()
    }

    /// Returns the change of a gauge's row per unit of movement along `way`; `None` if the surface or its strain does not determine it.
    fn slope(&self, gauge: usize, way: fn(f64) -> Offset, step: f64) -> Option<Vec<f64>> {
        let drawn = self.gauges.get(gauge)?.as_ref()?;
        drawn.slope(way, step, |g| self.row_of(g))
    }

    /// Returns the installed position of a gauge. `None` for a gauge on a bar.
    pub fn locate_gauge(
        &self,
        gauge: usize,
        glued: &InstalledPositionEstimate,
    ) -> Option<InstalledGauge> {
        let of = |kind| glued.find_move(kind).map_or(0.0, |m| m.value);
        let drawn = self.gauges.get(gauge)?.as_ref()?;
        let bridge = self.bridges.get(gauge)?;
        let (gauge, at) = drawn.gauge_at_offset(Offset {
            along: of(MoveKind::Along),
            across: of(MoveKind::Across),
            angle_rad: of(MoveKind::Turned),
        })?;
        Some(InstalledGauge {
            gauge,
            at,
            by_position: self.corners == CornerRows::Present,
            spec: drawn.spec().clone(),
            bridge,
            pair: drawn
                .spec()
                .pair
                .and_then(|p| Some((self.model.shells.get(p.shell.us())?.id, p.surface))),
            gain: glued.gain.value,
        })
    }
}

/// Returns the change of the rows of S with the installed angle and position of each gauge. Returns `None` if S is given or if all gauges are on
/// bars.
///
/// # Errors
/// The errors of [`Sites::from_job`].
pub(super) fn off_drawing(
    job: &Job,
    prepared: &JobSensitivity,
) -> Result<Option<OffDrawing>, Faults> {
    let model = match &prepared.fields {
        Some(f) if job.sensitivity.is_none() => f.model(),
        _ => return Ok(None),
    };
    let reaches = prepared.gauges.iter().filter_map(|g| {
        let shell = model.shells.get(model.shell_ix(g.element)?.us())?;
        let middle = centre(model, shell)?;
        let first = model.grids.get(shell.grids.first()?.us())?;
        Some((first.x - middle).norm())
    });
    let mut reaches: Vec<f64> = reaches.collect();
    reaches.sort_by(f64::total_cmp);
    let Some(&reach) = reaches.get(reaches.len() / 2) else {
        return Ok(None);
    };
    let tolerance = GlueTolerance {
        position: reach,
        angle_rad: 0.0,
    };
    let sites = Sites::from_job(job, prepared, tolerance)?;
    let (n, k) = prepared.sensitivity.values.shape();
    let zeros = Matrix::zeros(n, k);
    let mut out = OffDrawing {
        turned: zeros.clone(),
        crossed: zeros.clone(),
        along: zeros.clone(),
        across: zeros,
        reach,
    };
    for g in 0..n {
        let between = |from: f64, to: f64| -> Option<Vec<f64>> {
            let (a, b) = (
                sites.row(g, [0.0, 0.0, from])?,
                sites.row(g, [0.0, 0.0, to])?,
            );
            Some(b.iter().zip(&a).map(|(b, a)| b - a).collect())
        };
        // The reading at the angle x is c + a cos(2x) + b sin(2x). The difference of the readings at +45 and -45 degrees is exactly 2b, which
        // is the derivative at 0.
        let turns = [between(-FRAC_PI_4, FRAC_PI_4), between(0.0, FRAC_PI_2)];
        let [Some(turned), Some(crossed)] = turns else {
            continue;
        };
        let ways: [fn(f64) -> Offset; 2] = [Offset::shift_along, Offset::shift_across];
        let [along, across] = ways.map(|way| {
            let slope = sites.slope(g, way, PLACE_STEP * reach);
            slope.unwrap_or_else(|| vec![0.0; k])
        });
        for l in 0..k {
            out.turned[(g, l)] = turned[l];
            out.crossed[(g, l)] = crossed[l];
            out.along[(g, l)] = along[l];
            out.across[(g, l)] = across[l];
        }
    }
    Ok(Some(out))
}

/// Returns the installed position and gain of a gauge from the runs, in job units of length and degrees.
pub(super) fn summary(glued: &InstalledPositionEstimate) -> InstalledPositionSummary {
    let of = |kind, unit: f64| {
        glued.find_move(kind).map(|m| GlueSummary {
            value: m.value * unit,
            sigma: m.sigma * unit,
            told: m.is_determined(),
        })
    };
    InstalledPositionSummary {
        along: of(MoveKind::Along, 1.0),
        across: of(MoveKind::Across, 1.0),
        angle_deg: of(MoveKind::Turned, 1f64.to_degrees()),
        gain: GlueSummary {
            value: glued.gain.value,
            sigma: glued.gain.sigma,
            told: glued.gain.is_determined(),
        },
    }
}

/// Returns a note on positions, angles and gains that the runs do not determine; `None` if the runs determine all of them.
pub(super) fn report_undetermined_values(gauges: &[CalibratedGauge]) -> Option<Finding> {
    type Size = fn(&InstalledPositionSummary) -> Option<GlueSummary>;
    let sizes: [(&str, Size); 4] = [
        ("place along the axis", |a| a.along),
        ("place across it", |a| a.across),
        ("angle", |a| a.angle_deg),
        ("gain", |a| Some(a.gain)),
    ];
    let mut parts = Vec::new();
    let mut count = 0;
    for (what, size) in sizes {
        let names: Vec<&str> = gauges
            .iter()
            .filter(|g| g.as_glued.as_ref().and_then(size).is_some_and(|s| !s.told))
            .map(|g| g.name.as_str())
            .collect();
        count += names.len();
        if !names.is_empty() {
            parts.push(format!("{what} of {}", list_few(&names)));
        }
    }
    (count > 0).then(|| {
        Finding::new(
            Severity::Info,
            "installed-positions-uncertain",
            "calibration",
            format!(
                "the runs reduce the stated variance of these values by less than half: {}",
                parts.join("; ")
            ),
            "apply loads for which the strain under these gauges changes most over their length, or measure their position",
        )
        .with_numbers(count as f64, 0.0)
    })
}
