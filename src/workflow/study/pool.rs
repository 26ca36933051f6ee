//! Gauges that a study can choose from, with how their rows change when they are turned or shifted.

use super::gauges::LayoutGauge;
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::gauge::{Gauge, GaugePlace, GaugeSpec, build, gauge_reading, to_side};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::readings::readings_of;
use crate::job::{Job, suggest};
use crate::model::{Model, Vec3};
use crate::sensitivity::{Load, LoadCaseOf, Sensitivity, from_cases};
use crate::strain_chain::{
    Fields, WantedAt, corrected_spec_of, lay_gauges, read_fields, without_strain,
};
use crate::study::PoolGauge;

/// Gauges with the place of each.
#[derive(Clone, Default)]
pub(super) struct Pool {
    /// Rows of S.
    pub gauges: Vec<PoolGauge>,
    /// Name and place by gauge.
    pub places: Vec<LayoutGauge>,
}

impl Pool {
    /// Returns the number of gauges.
    pub fn len(&self) -> usize {
        self.gauges.len()
    }

    /// Returns whether there is no gauge.
    pub fn is_empty(&self) -> bool {
        self.gauges.is_empty()
    }

    fn push(&mut self, (gauge, place): (PoolGauge, LayoutGauge)) {
        self.gauges.push(gauge);
        self.places.push(place);
    }
}

/// Gauges, loads and model for the layouts.
pub(super) struct StudyInputs {
    /// Loads: the columns of S.
    pub loads: Vec<Load>,
    /// The job's gauges; empty without.
    pub pool: Pool,
    /// The spots of `[candidates] file`; `None` without a table of spots.
    pub spots: Option<Pool>,
    /// S of the job's gauges.
    pub installed: Option<Sensitivity>,
    /// Model and fields; `None` where S is given.
    pub fields: Option<Fields>,
}

/// Returns S of the job's gauges, as all commands compute it. It returns the model alone if the job has neither gauges nor S.
///
/// # Errors
/// Faults of the deck, the results, the gauges.
pub(super) fn prepare(work: &mut Work, job: &Job) -> Result<StudyInputs, Faults> {
    if job.sensitivity.is_none() && job.gauges.is_empty() {
        let fields = read_fields(work, job, WantedAt::Anywhere)?;
        let cases = fields.load_cases(job);
        return Ok(StudyInputs {
            spots: spots_on_model(work, job, &fields)?,
            loads: cases.into_iter().map(|c| c.load).collect(),
            pool: Pool::default(),
            installed: None,
            fields: Some(fields),
        });
    }
    let prepared = crate::strain_chain::prepare(work, job)?;
    let s = prepared.sensitivity;
    // With a given S, the model has no strain for gauges that are turned or moved.
    let fields = prepared.fields.filter(|_| job.sensitivity.is_none());
    let (pool, spots) = match &fields {
        None => (of_table(&s, 0..s.gauges.len()), spots_in_table(job, &s)?),
        Some(fields) => (
            pool_on_model(fields, job, &prepared.gauges, &s)?,
            spots_on_model(work, job, fields)?,
        ),
    };
    Ok(StudyInputs {
        loads: s.loads.clone(),
        pool,
        spots,
        installed: Some(s),
        fields,
    })
}

/// Returns rows of a given S, which states no places.
fn of_table(s: &Sensitivity, rows: impl Iterator<Item = usize>) -> Pool {
    let mut pool = Pool::default();
    for g in rows {
        let row = s.values.row(g).iter().copied().collect();
        let gauge = PoolGauge {
            row,
            turned: None,
            slope: None,
        };
        pool.push((gauge, LayoutGauge::without_place(&s.gauges[g])));
    }
    pool
}

/// Returns the spots of the job's table by their rows in a given S.
fn spots_in_table(job: &Job, s: &Sensitivity) -> Result<Option<Pool>, Faults> {
    let Some(spots) = &job.candidates.spots else {
        return Ok(None);
    };
    let (mut rows, mut faults) = (Vec::new(), FaultList::new());
    for spot in spots.iter().map(|s| &s.gauge) {
        for name in readings_of(spot) {
            match s.gauges.iter().position(|g| *g == name) {
                Some(row) => rows.push(row),
                None => faults.push(Fault::with_line(
                    &*spot.file,
                    spot.line,
                    "name",
                    format!("the table of [sensitivity] has no row `{name}`"),
                    suggest::remedy(&name, s.gauges.iter().map(String::as_str)),
                )),
            }
        }
    }
    Faults::check(faults)?;
    Ok(Some(of_table(s, rows.into_iter())))
}

/// Returns the spots of the job's table on the model.
fn spots_on_model(work: &mut Work, job: &Job, fields: &Fields) -> Result<Option<Pool>, Faults> {
    let Some(as_gauges) = job.with_spots_as_gauges() else {
        return Ok(None);
    };
    let laid = lay_gauges(work, &as_gauges, fields)?;
    let s = from_cases(&laid, &fields.load_cases(job))
        .map_err(|missing| without_strain(&as_gauges, &missing))?;
    pool_on_model(fields, &as_gauges, &laid, &s).map(Some)
}

/// Returns the gauges of a job, laid onto the model, with their rows of S.
fn pool_on_model(
    fields: &Fields,
    job: &Job,
    laid: &[Gauge],
    s: &Sensitivity,
) -> Result<Pool, Faults> {
    let cases = fields.load_cases(job);
    let mut pool = Pool::default();
    for g in &job.gauges {
        let spec = corrected_spec_of(fields.model(), job, g).map_err(Faults::from)?;
        let n = spec.rosette.map_or(1, |r| r.legs().len());
        for leg in 0..n {
            let i = pool.len();
            let row = s.values.row(i).iter().copied().collect();
            let place = LayoutGauge::from_gauge(&laid[i], &spec);
            pool.push((variants(fields, job, &cases, &spec, leg, row), place));
        }
    }
    Ok(pool)
}

/// Returns the pool gauge of a specification on the model, with its place.
pub(super) fn on_model(
    fields: &Fields,
    job: &Job,
    cases: &[LoadCaseOf],
    spec: &GaugeSpec,
) -> Option<(PoolGauge, LayoutGauge)> {
    let (gauges, _) = build(fields.model(), spec, fields.corner_rows(job)).ok()?;
    let gauge = gauges.first()?;
    let row = row_of(gauge, cases)?;
    let place = LayoutGauge::from_gauge(gauge, spec);
    Some((variants(fields, job, cases, spec, 0, row), place))
}

fn row_of(gauge: &Gauge, cases: &[LoadCaseOf]) -> Option<Vec<f64>> {
    cases
        .iter()
        .map(|c| gauge_reading(gauge, c.case).map(|v| v / c.applied))
        .collect()
}

/// Returns a gauge with its variants: turned by 45 and 90 degrees, and moved to the neighbouring elements.
fn variants(
    fields: &Fields,
    job: &Job,
    cases: &[LoadCaseOf],
    spec: &GaugeSpec,
    leg: usize,
    row: Vec<f64>,
) -> PoolGauge {
    let model = fields.model();
    let corners = fields.corner_rows(job);
    let laid = |spec: &GaugeSpec| -> Option<Gauge> {
        build(model, spec, corners).ok()?.0.into_iter().nth(leg)
    };
    let turned = |by: f64| {
        row_of(
            &laid(&GaugeSpec {
                angle_rad: spec.angle_rad + by,
                ..spec.clone()
            })?,
            cases,
        )
    };
    let quarter = std::f64::consts::FRAC_PI_4;
    let is_beam = matches!(spec.place, GaugePlace::Beam { .. });
    let turned = if is_beam {
        None
    } else {
        turned(quarter)
            .zip(turned(2.0 * quarter))
            .map(|(a, b)| [a, b])
    };
    let here = laid(spec);
    let slope = here.filter(|_| !is_beam).and_then(|g| {
        let [x, y] = [0, 1].map(|k| slope(model, &laid, spec, &g, cases, k));
        Some([x?, y?])
    });
    PoolGauge { row, turned, slope }
}

/// Cosine between normals up to which a neighbour counts as the same plate.
const SAME_PLATE: f64 = 0.98;

/// Returns the change of the row per length along direction `k` of the element, from the neighbours on both sides in the same plate. A single
/// neighbour gives a one-sided difference. Without neighbours the change is zero.
fn slope(
    model: &Model,
    laid: &dyn Fn(&GaugeSpec) -> Option<Gauge>,
    spec: &GaugeSpec,
    here: &Gauge,
    cases: &[LoadCaseOf],
    k: usize,
) -> Option<Vec<f64>> {
    let ix = model.shell_ix(here.element)?;
    let shell = model.shells.get(ix.us())?;
    let axes = shell_axes(model, shell, ShellPlace::Centre)?;
    let along: Vec3 = axes.row(k).transpose();
    let corners: Vec<Vec3> = shell.grids[..shell.shape.n_corners()]
        .iter()
        .filter_map(|g| model.grids.get(g.us()).map(|g| g.x))
        .collect();
    let reach = corners.iter().map(|x| x.dot(&along));
    let size =
        reach.clone().fold(f64::NEG_INFINITY, f64::max) - reach.fold(f64::INFINITY, f64::min);
    let middle = corners.iter().sum::<Vec3>() / corners.len() as f64;
    // The neighbour is searched from the skin, so that its side is the same side in space.
    let skin = here.normal * to_side(model, shell, here.surface);
    let mut ends: Vec<(f64, Vec<f64>)> = Vec::new();
    for sign in [-1.0, 1.0] {
        let at = middle + skin + along * (sign * size);
        let moved = GaugeSpec {
            place: GaugePlace::Nearest(at),
            direction: Some(here.direction),
            angle_rad: 0.0,
            surface: None,
            rosette: None,
            ..spec.clone()
        };
        let Some(g) = laid(&moved) else { continue };
        if g.outward().dot(&here.outward()) < SAME_PLATE {
            continue;
        }
        // With centre strain, a gauge reads the centre of its element. The distance is then the distance of the centres.
        let other = model
            .shell_ix(g.element)
            .and_then(|i| model.shells.get(i.us()));
        let centre = other.map(|s| {
            let n = s.shape.n_corners();
            let sum: Vec3 = s.grids[..n]
                .iter()
                .filter_map(|g| model.grids.get(g.us()).map(|g| g.x))
                .sum();
            sum / n as f64
        })?;
        let distance = (centre - middle).dot(&along);
        if let Some(row) = row_of(&g, cases).filter(|_| distance.abs() > 0.1 * size) {
            ends.push((distance, row));
        }
    }
    let own = row_of(here, cases)?;
    Some(match ends.as_slice() {
        [(a, low), (b, high)] => low
            .iter()
            .zip(high)
            .map(|(l, h)| (h - l) / (b - a))
            .collect(),
        [(d, row)] => row.iter().zip(&own).map(|(r, o)| (r - o) / d).collect(),
        _ => vec![0.0; cases.len()],
    })
}
