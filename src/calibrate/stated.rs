//! Known loads against what the model makes of them: a wrong unit, a wrong sign. A prior that is off by such a factor must not be learnt from:
//! all that the loads cause would count as scatter of the runs.

use super::start::is_known;
use super::types::{KnownRun, Task};
use super::unknown::SPANNED;
use crate::finding::{Finding, Severity};
use crate::linalg::median::weighted_median;
use crate::linalg::precision::Precision;
use crate::linalg::spd;
use crate::units::number;

/// Ratio of strain to what the model makes of the loads from which a unit is wrong: units of force differ by 4.448 (pounds read as newtons),
/// 9.81 (kilograms) and 1000, and a model may take a tenth off the first. Below it may be the model, badly scaled (a wall of half the thickness
/// or less), which honest runs put right; one whose error is stated to be larger has a larger ratio, four of its sd.
const UNIT: f64 = 4.0;
/// Ratio under which a sign is wrong: -1 with a third of it lost to errors, other loads and other gauges.
const SIGN: f64 = -1.0 / 3.0;
/// Standard deviations from which a gauge tells a load.
const TOLD: f64 = 5.0;
/// Share of the largest answer of any gauge to a load from which a gauge is asked about it.
const ASKED: f64 = 0.1;

/// Loads whose strain is some [`UNIT`] times what the model says, or of the other sign, in most of the gauges.
///
/// By gauge `y_r = sum_l c_l S_l f_rl` is solved for the factors `c_l` by least squares, for one common factor where the runs do not tell the
/// loads apart; the factor of a load is the median over gauges, each with the weight `|S_l|`. Gauges that are `wrongly_wired` have no vote.
pub(super) fn check(task: &Task, used: &[usize], wrongly_wired: &[usize]) -> Vec<Finding> {
    let Some(model) = &task.model else {
        return Vec::new();
    };
    let k = task.loads.len();
    let all: Vec<&KnownRun> = used.iter().filter_map(|r| task.runs.get(*r)).collect();
    let size = |l: usize| {
        let each = all.iter().map(|r| r.loads.mean.get(l).copied());
        each.flatten().fold(0.0_f64, |a, f| a.max(f.abs()))
    };
    let sizes: Vec<f64> = (0..k).map(size).collect();
    let known = all.iter().copied().filter(|r| is_known(r, &sizes));
    let runs: Vec<&KnownRun> = known.collect();
    let acting: Vec<usize> = (0..k).filter(|l| sizes[*l] > 0.0).collect();
    if acting.is_empty() {
        return Vec::new();
    }
    let answer = |g: usize, l: usize| model.values[(g, l)] * sizes[l];
    let apart = told_apart(&runs, &acting, &sizes);
    // Factor and weight, by what is asked for: each load, or all of them.
    let asked: Vec<Vec<usize>> = match apart {
        true => acting.iter().map(|l| vec![*l]).collect(),
        false => vec![acting.clone()],
    };
    let mut found: Vec<Vec<(f64, f64)>> = vec![Vec::new(); asked.len()];
    let gauges: Vec<usize> = (0..task.gauges.len())
        .filter(|g| !wrongly_wired.contains(g))
        .collect();
    for &g in &gauges {
        let columns = |r: &KnownRun| -> Vec<f64> {
            let of = |loads: &Vec<usize>| -> f64 {
                let each = loads
                    .iter()
                    .map(|l| model.values[(g, *l)] * r.loads.mean[*l]);
                each.sum()
            };
            asked.iter().map(of).collect()
        };
        for (a, factor) in factors(task, &runs, g, columns) {
            let weight = |g: usize| asked[a].iter().map(|l| answer(g, *l).abs()).sum::<f64>();
            let most = gauges.iter().map(|g| weight(*g)).fold(0.0, f64::max);
            if weight(g) > ASKED * most {
                found[a].push((factor, weight(g)));
            }
        }
    }
    let of: Vec<(String, f64)> = asked
        .iter()
        .zip(&mut found)
        .filter_map(|(loads, f)| {
            let names = loads.iter().map(|l| task.loads[*l].name.as_str());
            Some((names.collect::<Vec<_>>().join(", "), weighted_median(f)?))
        })
        .collect();
    let unit = UNIT.max(1.0 + 4.0 * model.uncertainty_rel);
    let beyond = |c: f64| c.abs() > unit || c.abs() < 1.0 / unit;
    let (other, rest): (Vec<_>, Vec<_>) = of.into_iter().partition(|(_, c)| beyond(*c));
    let sign: Vec<(String, f64)> = rest.into_iter().filter(|(_, c)| *c < SIGN).collect();
    [wrong_unit(&other, unit), wrong_sign(&sign)]
        .into_iter()
        .flatten()
        .collect()
}

/// Names of loads, and the same with their factors.
fn list(loads: &[(String, f64)]) -> (String, String) {
    let names: Vec<&str> = loads.iter().map(|(name, _)| name.as_str()).collect();
    let each: Vec<String> = loads
        .iter()
        .map(|(name, c)| format!("{name} {} times", number(*c)))
        .collect();
    (names.join(", "), each.join("; "))
}

fn wrong_unit(loads: &[(String, f64)], limit: f64) -> Option<Finding> {
    let (names, each) = list(loads);
    let first = loads.first()?;
    let finding = Finding::new(
        Severity::Error,
        "known-loads-unit",
        names,
        format!(
            "the strain of the runs is far from what the model makes of their known loads ({each}): the loads are in another unit than they are \
             read in, or the model's are"
        ),
        "state the unit of the runs file ([runs] units = { force = \"kN\" }), and check `applied` and the units of the job",
    );
    Some(finding.with_numbers(first.1, limit))
}

fn wrong_sign(loads: &[(String, f64)]) -> Option<Finding> {
    let (names, each) = list(loads);
    let first = loads.first()?;
    let finding = Finding::new(
        Severity::Error,
        "known-loads-sign",
        names,
        format!(
            "most gauges read against the model's sign ({each} what it makes of the known loads): these loads have the wrong sign, or the gauges"
        ),
        "turn the sign of these loads in the runs file, or of the gauges: [[correction]] sign = -1",
    );
    Some(finding.with_numbers(first.1, SIGN))
}

/// Whether the runs tell the loads that act from each other, with runs to spare.
fn told_apart(runs: &[&KnownRun], acting: &[usize], sizes: &[f64]) -> bool {
    let k = acting.len();
    let mut gram = vec![0.0; k * k];
    for r in runs {
        let phi: Vec<f64> = acting
            .iter()
            .map(|l| r.loads.mean[*l] / sizes[*l])
            .collect();
        spd::add_outer(&mut gram, &phi, 1.0);
    }
    let values = spd::eigenvalues(&gram, k);
    let (least, most) = (values.first(), values.last());
    runs.len() > k && least.zip(most).is_some_and(|(a, b)| *a > SPANNED * b)
}

/// Factors on columns that a gauge's readings tell, by number of the column.
fn factors(
    task: &Task,
    runs: &[&KnownRun],
    g: usize,
    columns: impl Fn(&KnownRun) -> Vec<f64>,
) -> Vec<(usize, f64)> {
    let rows: Vec<(Vec<f64>, f64)> = runs
        .iter()
        .filter_map(|r| {
            Some((
                columns(r),
                r.strain.get(g).copied().filter(|v| v.is_finite())?,
            ))
        })
        .collect();
    let width = rows.first().map_or(0, |r| r.0.len());
    let norm = |c: usize| rows.iter().map(|r| r.0[c] * r.0[c]).sum::<f64>().sqrt();
    let norms: Vec<f64> = (0..width).map(norm).collect();
    // A load that this gauge does not answer to by the model can't be scaled.
    let kept: Vec<usize> = (0..width).filter(|c| norms[*c] > 0.0).collect();
    let k = kept.len();
    if k == 0 {
        return Vec::new();
    }
    let (mut gram, mut right) = (vec![0.0; k * k], vec![0.0; k]);
    let unit = |x: &[f64]| -> Vec<f64> { kept.iter().map(|c| x[*c] / norms[*c]).collect() };
    for (x, y) in &rows {
        let x = unit(x);
        spd::add_outer(&mut gram, &x, 1.0);
        right.iter_mut().zip(&x).for_each(|(b, x)| *b += x * y);
    }
    let Some(inverse) = Precision::of(&gram, k) else {
        return Vec::new();
    };
    let amounts = inverse.apply(&right);
    let left = |(x, y): &(Vec<f64>, f64)| (y - spd::dot(&unit(x), &amounts)).powi(2);
    let rest: f64 = rows.iter().map(left).sum();
    let spare = rows.len().saturating_sub(k).max(1) as f64;
    let variance = (rest / spare).max(task.noise * task.noise);
    let told = |(i, b): &(usize, &f64)| b.abs() > TOLD * (variance * inverse.entry(*i, *i)).sqrt();
    amounts
        .iter()
        .enumerate()
        .filter(told)
        .map(|(i, b)| (kept[i], b / norms[kept[i]]))
        .collect()
}
