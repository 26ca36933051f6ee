//! The calibration in the units of reports.

use super::outcome::*;
use crate::calibrate::{Calibration, Dependence, LeftOut, Task, depends_on, known_of, next_runs};
use crate::estimate::student_95;
use crate::finding::{Finding, Severity};
use crate::strain_chain::LoadUnits;
use crate::units::{MICROSTRAIN, number};
use crate::workflow::recover::ListedLoads;
use std::collections::BTreeMap;

/// Probability by chance below which a dependence is reported.
const SIGNIFICANT: f64 = 0.01;

impl DependenceSummary {
    /// Returns a finding if the dependence is significant.
    pub(super) fn finding(&self) -> Option<Finding> {
        (self.chance < SIGNIFICANT).then(|| {
            let message = format!(
                "the strain of the runs depends on `{}`: recovered loads change by {:+.2} % per unit of it (± {:.2}, probability {:.1e} by chance)",
                self.column,
                100.0 * self.slope_rel,
                100.0 * student_95(self.dof) * self.sigma,
                self.chance
            );
            Finding::new(
                Severity::Warning,
                "calibration-depends-on-column",
                &self.column,
                message,
                "calibrate with the runs of one setting, or accept the width from the scatter",
            )
            .with_numbers(self.chance, SIGNIFICANT)
        })
    }
}

/// Returns the finding with the largest known load of each unit, if there is no model to compare its strain with.
pub(super) fn report_unchecked_loads(task: &Task, listed: &ListedLoads) -> Option<Finding> {
    if task.model.is_some() {
        return None;
    }
    let own = (0..task.loads.len()).map(|l| vec![(l, 1.0)]);
    let rows: Vec<Vec<(usize, f64)>> = own.chain(listed.sums.iter().cloned()).collect();
    let mut largest: BTreeMap<&str, (f64, String)> = BTreeMap::new();
    for (i, terms) in rows.iter().enumerate() {
        let unit = &listed.units[i];
        for r in 0..task.runs.len() {
            let size = known_of(task, r, terms).map_or(0.0, |v| (v * unit.factor).abs());
            if size > largest.get(unit.name.as_str()).map_or(0.0, |l| l.0) {
                let sentence = format!(
                    "{} {} (`{}` in run `{}`)",
                    number(size),
                    unit.name,
                    listed.names[i],
                    task.runs[r].run
                );
                largest.insert(&unit.name, (size, sentence));
            }
        }
    }
    let most = largest.values().map(|l| l.0).fold(0.0, f64::max);
    let each: Vec<String> = largest.into_values().map(|l| l.1).collect();
    let message = format!(
        "the job has no model that predicts the strain of the known loads, and their unit is not checked. The largest is {}",
        each.join("; ")
    );
    (!each.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "known-loads-unit-untested",
            "runs",
            message,
            "check whether this load was applied, and its unit ([runs] units)",
        )
        .with_numbers(most, 0.0)
    })
}

/// Largest ratio between the strains of two loads with the same unit. On the frames of nine trucks, the largest strains of vertical, lateral and
/// longitudinal wheel forces differ by factors of 8 to 20. Mixed units (kN and N) give a factor of 1,000.
const UNEVEN: f64 = 300.0;
/// Ratio of strain to noise below which the strain does not show a load.
const CLEAR: f64 = 6.0;

/// Returns the largest known size of a load; 0 if no run states it.
fn largest_known_load(task: &Task, l: usize) -> f64 {
    let known = task.runs.iter().map(|r| r.loads.mean[l].abs());
    known.fold(0.0, f64::max)
}

/// Returns a finding on a load with far less strain than another load of its unit, although this strain exceeds the noise. Returns `None` for a job
/// with a model.
pub(super) fn report_uneven_loads(
    task: &Task,
    found: &Calibration,
    listed: &ListedLoads,
) -> Option<Finding> {
    if task.model.is_some() {
        return None;
    }
    let values = &found.sensitivity.values;
    let size = |l: usize| {
        values
            .column(l)
            .iter()
            .fold(0.0, |a: f64, v| a.max(v.abs()))
    };
    let all = 0..task.loads.len();
    let odd = all.clone().find_map(|a| {
        let others = all
            .clone()
            .filter(|&b| listed.units[b].name == listed.units[a].name);
        let most = others.max_by(|b, c| size(*b).total_cmp(&size(*c)))?;
        let times = size(most) / size(a);
        let read = size(a) * largest_known_load(task, a) > CLEAR * task.noise;
        (read && times > UNEVEN).then_some((a, most, times))
    });
    odd.map(|(a, most, times)| {
        Finding::new(
            Severity::Warning,
            "known-loads-unit-doubtful",
            listed.names[a].clone(),
            format!(
                "one {} of this load causes {} times less strain than one of `{}`: the recorded units may differ",
                listed.units[a].name,
                number(times),
                listed.names[most]
            ),
            "check the known loads of both in the runs file, and [runs] units",
        )
        .with_numbers(times, UNEVEN)
    })
}

/// Returns the best next run.
pub(super) fn next_run(
    task: &Task,
    found: &Calibration,
    units: &[LoadUnits],
) -> Option<NextRunSummary> {
    let size = |l: usize| match largest_known_load(task, l) {
        known if known > 0.0 => Some(known),
        _ => task.loads[l].expected,
    };
    let sizes: Vec<Option<f64>> = (0..task.loads.len()).map(size).collect();
    let other = sizes.iter().flatten().copied().fold(0.0, f64::max);
    let sizes: Vec<f64> = sizes.into_iter().map(|s| s.unwrap_or(other)).collect();
    let best = next_runs(found, task.noise, &sizes)
        .ok()?
        .into_iter()
        .next()?;
    let unit = &units[best.load];
    Some(NextRunSummary {
        loads: task
            .loads
            .iter()
            .zip(units)
            .zip(&best.loads)
            .map(|((l, u), f)| (l.name.clone(), f * u.factor))
            .collect(),
        information: best.information,
        load: task.loads[best.load].name.clone(),
        sigma_before: best.sigma_before * unit.factor,
        sigma_after: best.sigma_after * unit.factor,
        unit: unit.name.clone(),
    })
}

/// Returns the test on a column.
pub(super) fn dependence(
    task: &Task,
    found: &Calibration,
    column: &(String, Vec<f64>),
) -> Option<DependenceSummary> {
    let Dependence {
        slope_rel,
        sigma,
        chance,
        dof,
    } = depends_on(task, &found.left_out, &column.1)?;
    Some(DependenceSummary {
        column: column.0.clone(),
        slope_rel,
        sigma,
        chance,
        dof,
    })
}

/// Returns `calibration` of `result.json`.
pub(super) fn words(
    task: &Task,
    found: &Calibration,
    listed: &ListedLoads,
    next_run: Option<NextRunSummary>,
    dependence: Option<DependenceSummary>,
) -> CalibrationSummary {
    let left_out = |l: &LeftOut| {
        let mut estimate = l.estimate.clone();
        let k = task.loads.len();
        estimate.widen(found.coverage.factor);
        estimate.add_sums(&listed.names[k..], &listed.sums);
        let own = (0..k).map(|l| vec![(l, 1.0)]);
        let rows = own.chain(listed.sums.iter().cloned());
        let one = |(i, terms): (usize, Vec<(usize, f64)>)| {
            let unit = &listed.units[i];
            let [low, high] = estimate.interval(i);
            LeftOutLoad {
                name: listed.names[i].clone(),
                known: known_of(task, l.number, &terms).map(|known| known * unit.factor),
                value: estimate.values[i] * unit.factor,
                sigma: estimate.sigma(i) * unit.factor,
                unit: unit.name.clone(),
                low: low * unit.factor,
                high: high * unit.factor,
            }
        };
        LeftOutSummary {
            run: estimate.run.clone(),
            distance: (l.distance / l.loads.max(1) as f64).sqrt(),
            loads: rows.enumerate().map(one).collect(),
        }
    };
    let terms = |u: &crate::calibrate::UndeterminedCombination| -> BTreeMap<String, f64> {
        task.loads
            .iter()
            .zip(&u.terms)
            .map(|(l, t)| (l.name.clone(), *t))
            .collect()
    };
    CalibrationSummary {
        runs: task.runs.len() - found.refused.len(),
        prior: if task.model.is_some() {
            "model"
        } else {
            "none"
        },
        gauges: found
            .shifts
            .iter()
            .enumerate()
            .map(|(g, s)| CalibratedGauge {
                name: s.name.clone(),
                shift: s.shift,
                scale: s.scale,
                looks_like: s.word.name(),
                as_glued: found
                    .as_glued
                    .get(g)
                    .map(super::installed_positions::summary),
            })
            .collect(),
        repeat_scatter_rel: found.repeat_scatter_rel,
        noise_rel: found.noise_rel,
        range: ranges(
            listed,
            task.loads.iter().map(|l| l.name.as_str()),
            &found.range.loads,
        ),
        strain_range: (task.gauges.iter().zip(&found.range.strain))
            .filter(|(_, r)| r[0].is_finite())
            .map(|(g, r)| (g.clone(), r.map(|v| v / MICROSTRAIN)))
            .collect(),
        terms: match found.common_zero.is_empty() {
            true => "linear",
            false => "intercept",
        },
        lack_of_fit: (found.lack_of_fit.tests.iter())
            .map(|t| LackOfFitSummary {
                test: t.term.name(),
                p: t.p,
            })
            .collect(),
        held_out_error: found.lack_of_fit.held_out.map(|h| HeldOutSummary {
            linear_percent: 100.0 * h.linear,
            intercept_percent: 100.0 * h.intercept,
            recommended: match found.lack_of_fit.recommends_intercept() {
                Some(true) => "intercept",
                _ => "linear",
            },
        }),
        residuals: residuals(task, found, listed),
        checks: Vec::new(),
        coverage: CoverageSummary {
            held: found.coverage.held,
            of: found.coverage.of,
            factor: found.coverage.factor,
        },
        next_run,
        model_error: found.model_error.map(|e| ModelErrorSummary {
            common_rel: e.common,
            entry_rel: e.entry,
        }),
        left_out: found.left_out.iter().map(left_out).collect(),
        refused: found
            .refused
            .iter()
            .map(|r| task.runs[*r].run.clone())
            .collect(),
        undetermined: found.undetermined.iter().map(terms).collect(),
        dependence,
    }
}

/// Ranges by load, report units; a load that no run states has none.
fn ranges<'a>(
    listed: &ListedLoads,
    names: impl Iterator<Item = &'a str>,
    ranges: &[[f64; 2]],
) -> BTreeMap<String, [f64; 2]> {
    let all = names.zip(&listed.units).zip(ranges);
    all.filter(|(_, r)| r[0].is_finite())
        .map(|((name, unit), r)| (name.to_owned(), r.map(|v| v * unit.factor)))
        .collect()
}

/// Returns recovered minus known loads over the runs, by load.
fn residuals(task: &Task, found: &Calibration, listed: &ListedLoads) -> Vec<LoadResidual> {
    let fitted = found.recover_used_runs(task.noise, &task.runs);
    let rms = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len().max(1) as f64).sqrt();
    let one = |l: usize| {
        let full = found.range.largest_load(l);
        let percent = |run: usize, value: f64| {
            let known = known_of(task, run, &[(l, 1.0)])?;
            Some(100.0 * (value - known) / full)
        };
        let of_fit = fitted
            .iter()
            .filter_map(|(run, c)| percent(*run, c.estimate.values[l]));
        let of_fit: Vec<f64> = of_fit.filter(|v| v.is_finite()).collect();
        let left = found.left_out.iter().filter_map(|o| {
            let off = percent(o.number, o.estimate.values[l])?;
            off.is_finite().then_some((off, &o.estimate.run))
        });
        let left: Vec<(f64, &String)> = left.collect();
        let offs: Vec<f64> = left.iter().map(|o| o.0).collect();
        let worst = left.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let unit = &listed.units[l];
        (full > 0.0 && !of_fit.is_empty()).then(|| LoadResidual {
            load: listed.names[l].clone(),
            full_scale: full * unit.factor,
            unit: unit.name.clone(),
            rms_percent: rms(&of_fit),
            max_percent: of_fit.iter().fold(0.0, |a, v| f64::max(a, v.abs())),
            left_out_rms_percent: worst.map(|_| rms(&offs)),
            left_out_max_percent: worst.map(|w| w.0.abs()),
            left_out_max_run: worst.map(|w| w.1.clone()),
        })
    };
    (0..task.loads.len())
        .filter(|l| task.loads[*l].wanted)
        .filter_map(one)
        .collect()
}
