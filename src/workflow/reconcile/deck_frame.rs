//! The static frame of a job with a deck: signatures of loads, masses, stiffness and gauge angles from the built-in solver.

use super::background::{Axis, ENTRY_SHARE, background, gradients};
use super::deck_loads::SignatureLoads;
pub(super) use super::deck_loads::unit;
use super::deck_thermal::UnitTemperatureModel;
use super::frame_columns::FrameColumns;
use super::influence::{influence, readings};
use super::model_part::{ModelPart, facts};
use super::refined_model::RefinedGaugeModel;
use super::region::Region;
use super::signature_table::TableColumn;
use crate::fe::UnitLoad;
use crate::finding::{Finding, Severity};
use crate::gauge::Gauge;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::input_faults::AlternativeRows;
use crate::job::{Ids, Job, JobLoad, LoadActs, LoadRole};
use crate::linalg::Matrix;
use crate::model::Model;
use crate::reconcile::strain::{GaugeFacts, PlaneStrainRow, Wiring};
use crate::sensitivity::from_cases;
use crate::stop::Stop;
use crate::strain_chain::built_in_solver::{support_of_job, unit_loads_kept};
use crate::strain_chain::{
    Fields, JobSensitivity, alternatives_of, lay_gauges, prepare_with_additional_loads,
};
use crate::units::KILO;
use std::collections::BTreeMap;

/// The model with everything needed to solve it again.
pub(super) struct DeckFrame {
    pub(super) fields: Fields,
    pub(super) gauges: Vec<Gauge>,
    pub(super) columns: Vec<UnitLoad>,
    /// Influence on the mesh of the deck, by the built-in solver.
    pub(super) base: Vec<f64>,
    /// Small regions whose stiffness is tried.
    pub(super) regions: Vec<Region>,
    /// Properties whose stiffness may be wrong together, by the name of the zone.
    pub(super) zones: BTreeMap<String, Ids>,
    /// The influence of the gauges if all of them are installed otherwise than stated.
    pub(super) alternatives: Vec<AlternativeRows>,
    /// Stops the solutions of changed models between two of them.
    pub(super) stop: Stop,
}

/// Solves all signatures. `channels` are the gauges in the order of the strain file.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    channels: &[String],
) -> Result<(ModelPart, DeckFrame), Faults> {
    let columns = |model: &Model| {
        Ok(SignatureLoads::from_job(job, &UnitTemperatureModel::from_job(job, model)?)?.columns)
    };
    let JobSensitivity {
        sensitivity,
        fields: Some(mut fields),
        gauges,
        ..
    } = prepare_with_additional_loads(work, &on_own_mesh(job), Some(&columns))?
    else {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "model",
            "S does not come from a model",
            "name the deck in [model]",
        )));
    };
    let gauges = in_order(job, gauges, channels)?;
    let s = FrameColumns::from_sensitivity(job, sensitivity, channels)?;
    let turned = lay_turned_gauges(work, job, &fields, channels)?;
    let heated = UnitTemperatureModel::from_job(job, fields.model())?;
    let model = &heated.model;
    let asked = SignatureLoads::from_job(job, &heated)?;
    let support = support_of_job(job, model)?;
    // Signatures come from a mesh of half the width, if it can be made. The mesh error is then computed, not assumed.
    let laid = [&gauges, &turned[0], &turned[1]];
    let finer = work.stage("refine", |_| RefinedGaugeModel::refine_model(model, laid));
    if let Err(why) = &finer {
        work.findings.push(mesh_unknown(job, why));
    }
    let finer = finer.ok();
    let set = job.reconcile.as_ref().map(|r| r.temperature_set);
    let heat = format!("temperature set {set:?}");
    let solution = work.stage("solve signatures", |w| match &finer {
        Some(f) => {
            let made = format!("mesh half as wide, {heat}");
            unit_loads_kept(
                w,
                (&fields.deck, &made),
                (&f.refined.model, support),
                &asked.loads,
            )
        }
        None => unit_loads_kept(w, (&fields.deck, &heat), (model, support), &asked.loads),
    })?;
    let n_c = asked.columns.len();
    let seen = match &finer {
        Some(f) => f.laid.each_ref(),
        None => laid,
    };
    let [mut table, at_45, at_90] = seen.map(|g| influence(job, model, g, &solution, n_c));
    let own = match fields.additional.take() {
        Some(solved) => solved,
        None => work.stage("solve signatures", |w| {
            unit_loads_kept(w, (&fields.deck, &heat), (model, support), &asked.columns)
        })?,
    };
    let by_solver = influence(job, model, &gauges, &own, n_c);
    let base = with_s(&by_solver, &s, n_c);
    let from_results = job.model.as_ref().is_some_and(|m| !m.results.is_empty());
    if from_results && finer.is_none() {
        table.clone_from(&base);
    }
    let rows_of = |work: &mut Work, job: &Job| {
        let laid = in_order(job, lay_gauges(work, job, &fields).ok()?, channels).ok()?;
        let rows = match &finer {
            Some(f) => influence(job, model, &f.lay(&laid, model)?, &solution, n_c),
            None if from_results => {
                let s = from_cases(&laid, &fields.load_cases(job)).ok()?;
                let s = FrameColumns::from_sensitivity(job, s, channels).ok()?;
                with_s(&influence(job, model, &laid, &own, n_c), &s, n_c)
            }
            None => influence(job, model, &laid, &solution, n_c),
        };
        let rows = Matrix::from_fn(channels.len(), n_c, |g, c| rows[g * n_c + c]);
        Some((channels.to_vec(), rows))
    };
    let alternatives = alternatives_of(work, job, channels, &rows_of);
    let column = |c: usize| readings(seen[0], &solution, c..c + 1);
    let mut part = asked.part(job, model, column);
    part.gauges = gauge_facts(job, channels, &gauges);
    part.tensors = plane_strain([&table, &at_45, &at_90], n_c);
    part.influence = table;
    let apparent: Vec<f64> = channels.iter().map(|c| apparent_strain(job, c)).collect();
    [part.thermal_uniform, part.thermal_gradient] =
        asked.thermal_strain(&heated, &apparent, &heated.rises(&gauges), column);
    let along = gradients(job, model, &gauges, &own, n_c, Axis::Along);
    let across = gradients(job, model, &gauges, &own, n_c, Axis::Across);
    // An S without its mesh error hardly differs from the S of the finer mesh. The change by halving the width then bounds the remaining error.
    let corrected = fields.mesh_error.is_some();
    let own_mesh = if corrected { &by_solver } else { &base };
    part.scatter = background(
        job,
        &part,
        finer.as_ref().map(|f| (own_mesh, f.refined.is_whole())),
        [&along, &across],
    );
    part.per_mm = Some(along);
    part.gauge_noise = s.gauge_noise(job)?;
    part.as_modelled = finer.is_some().then_some(base);
    let deck = DeckFrame {
        zones: super::zones::zones(job, fields.model(), &gauges)?,
        fields,
        gauges,
        columns: asked.columns,
        base: by_solver,
        regions: vec![],
        alternatives,
        stop: work.cx.progress.stop(),
    };
    part.stiffness = work.stage("solve zones", |_| deck.signatures(job))?;
    let described = deck.compute_signatures(&mut work.inputs, job, channels, &per_job_unit(job))?;
    part.stiffness.extend(described);
    Ok((part, deck))
}

/// Returns the job with S of the deck's own mesh, unless the job requests the mesh error. The gap then states the part of the mesh, and signatures
/// come from a finer mesh.
fn on_own_mesh(job: &Job) -> Job {
    let mut job = job.clone();
    if let Some(model) = &mut job.model {
        model.mesh_error.get_or_insert(false);
    }
    job
}

/// Lays the gauges turned by 45 and by 90 degrees. Their readings at three angles determine the in-plane strain.
fn lay_turned_gauges(
    work: &mut Work,
    job: &Job,
    fields: &Fields,
    channels: &[String],
) -> Result<Vec<Vec<Gauge>>, Faults> {
    let noted = work.findings.len();
    let mut turned = Vec::new();
    for degrees in [45.0, 90.0] {
        let mut other = job.clone();
        other.gauges.iter_mut().for_each(|g| g.angle_deg += degrees);
        turned.push(in_order(job, lay_gauges(work, &other, fields)?, channels)?);
    }
    work.findings.truncate(noted);
    Ok(turned)
}

/// Returns the influence matrix with the S of the job in the columns of the wanted loads. The other columns come from the built-in solver, also if
/// the results of the job are from Nastran.
fn with_s(by_solver: &[f64], s: &FrameColumns, n_columns: usize) -> Vec<f64> {
    let mut base = by_solver.to_vec();
    for (c, (_, column)) in s.wanted_columns().iter().enumerate() {
        for (row, v) in base.chunks_exact_mut(n_columns).zip(column) {
            row[c] = *v;
        }
    }
    base
}

/// In-plane strain `exx, eyy, gxy` under each gauge, from what it reads at 0, 45 and 90 degrees.
fn plane_strain([at_0, at_45, at_90]: [&[f64]; 3], n_columns: usize) -> Vec<PlaneStrainRow> {
    let one = |i: usize| [at_0[i], at_90[i], 2.0 * at_45[i] - at_0[i] - at_90[i]];
    let rows = (0..at_0.len()).step_by(n_columns.max(1));
    rows.map(|first| (first..first + n_columns).map(one).collect())
        .collect()
}

/// Returns the properties of the gauges from the job, with their places on the model.
fn gauge_facts(job: &Job, channels: &[String], gauges: &[Gauge]) -> Vec<GaugeFacts> {
    let length_m = job.units.length_m();
    let one = |(channel, laid): (&String, &Gauge)| GaugeFacts {
        // In-plane strain is in the axes of the gauge, with its wiring included.
        angle_deg: 0.0,
        wiring: Wiring::Quarter,
        position: Some([0, 1, 2].map(|k| laid.position[k] * length_m)),
        ..facts(job, channel)
    };
    channels.iter().zip(gauges).map(one).collect()
}

/// Returns the names of the wanted loads, with 1 kN or 1 kN m in units of the job. Tables are in microstrain per unit of the job, as in
/// sensitivity.csv.
pub(super) fn per_job_unit(job: &Job) -> Vec<TableColumn> {
    let wanted = job.loads.iter().filter(|l| l.role == LoadRole::Wanted);
    let per = |l: &JobLoad| match l.acts {
        LoadActs::AtGrid { component, .. } => KILO / job.units.si(component.quantity()),
        LoadActs::Set(_) | LoadActs::Named => 1.0,
    };
    let column = |l: &JobLoad| TableColumn {
        names: vec![l.name.clone()],
        factor: per(l),
    };
    wanted.map(column).collect()
}

/// Apparent strain of a channel's wiring, microstrain a degree.
fn apparent_strain(job: &Job, channel: &str) -> f64 {
    let bridge = job
        .gauges
        .iter()
        .find(|g| g.name == channel)
        .map_or("quarter", |g| g.bridge.name());
    let given = job.reconcile.as_ref();
    given
        .and_then(|r| r.thermal_microstrain_per_degc.get(bridge).copied())
        .unwrap_or(0.0)
}

/// Channels in the order of the strain file.
fn in_order(job: &Job, laid: Vec<Gauge>, channels: &[String]) -> Result<Vec<Gauge>, Faults> {
    let find = |name: &String| {
        laid.iter()
            .find(|g| g.name == *name)
            .cloned()
            .ok_or_else(|| {
                let wrong = format!(
                    "the strain file has a column `{name}`, and the job has no gauge of this name"
                );
                Fault::new(&*job.file, "gauge", wrong, "name the gauges as the columns")
            })
    };
    let (mut out, mut faults) = (Vec::new(), FaultList::new());
    for name in channels {
        match find(name) {
            Ok(g) => out.push(g),
            Err(f) => faults.push(f),
        }
    }
    Faults::check(faults)?;
    Ok(out)
}

/// Returns the finding that no finer mesh was solved, with the assumption that is used instead.
fn mesh_unknown(job: &Job, why: &str) -> Finding {
    let stated = job
        .measured
        .as_ref()
        .map_or(0.0, |m| m.model_uncertainty_rel);
    Finding::new(
        Severity::Warning,
        "mesh-not-checked",
        "model",
        format!(
            "the mesh error of the strain is unknown, since no finer mesh was solved: {why}. Each influence coefficient is assumed \
             uncertain by {:.2} % (1 sd), {:.0} % of the stated model uncertainty",
            100.0 * ENTRY_SHARE * stated,
            100.0 * ENTRY_SHARE
        ),
        "compare the strain at the gauges with the strain of a finer mesh, and state `model_uncertainty_rel` accordingly",
    )
}
