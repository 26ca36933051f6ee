//! Recorded loads of static runs compared with the strain that the model makes of them.

use crate::estimate::weighted_median;
use crate::finding::{Finding, Severity, list_few};
use crate::linalg::precision::Precision;
use crate::linalg::spd;
use crate::units::{Quantity, number};
use rayon::prelude::*;

/// Ratio of measured strain to the strain that the model makes of the loads, from which a unit is wrong. Units of force differ by 4.448 (pounds read
/// as newtons), 9.81 (kilograms) and 1000, and a model may take a tenth off the first. A smaller ratio may come from a badly scaled model (a wall of
/// half the thickness or less), which runs correct. A model with a larger stated error has a larger ratio, four of its sd.
pub const UNIT: f64 = 4.0;
/// Ratio below which a sign is wrong: -1, reduced by a third for errors, other loads and other gauges.
const SIGN: f64 = -1.0 / 3.0;
/// Standard deviations from which a gauge's readings determine the factor of a load.
const DETERMINED: f64 = 5.0;
/// Least response of a gauge to a load, as a share of the largest response of all gauges, to be used for this load.
const ANSWERS: f64 = 0.1;
/// Largest share of the sum of squares between readings and model that a fault of the records leaves after its correction.
const UNDONE: f64 = 0.25;
/// Largest such share that exchanged records leave. An effect that the model lacks may look like exchanged wheels: without a payload in the model,
/// two exchanges left 5 %.
const EXCHANGED: f64 = 0.02;
/// Share of the largest eigenvalue of the loads' squares from which the runs separate the loads.
const SEPARATED: f64 = 1e-6;
/// Sum of squares between readings and model, over the sum for noise, up to which there is no fault.
const BEYOND: f64 = 4.0;
/// Number of loads up to which two exchanged pairs are searched for: some thousand combinations.
const PAIRED: usize = 12;
/// Largest distance of a factor from the factor of a pair of units that it identifies.
pub const NEAR: f64 = 0.15;

/// Factors between readings and recorded loads, with the cause of each.
const UNITS: [(f64, &str); 9] = [
    (
        1e-3,
        "as if loads in N were read as kN, or readings in mm/m as microstrain",
    ),
    (1e3, "as if loads in kN were read as N"),
    (4.448, "as if loads in lbf were read as N"),
    (1.0 / 4.448, "as if loads in N were read as lbf"),
    (4.448e-3, "as if loads in lbf were read as kN"),
    (9.807, "as if loads in kgf were read as N"),
    (1.0 / 9.807, "as if loads in N were read as kgf"),
    (9.807e-3, "as if loads in kgf were read as kN"),
    (1e-6, "as if readings in m/m were read as microstrain"),
];

/// Static runs with recorded loads. Units are the caller's: strain of readings and of [`Self::strain_of`] are in one unit.
pub struct RecordedRuns<'a> {
    /// Names of the recorded loads.
    pub loads: Vec<&'a str>,
    /// Readings by run and gauge; NaN if one is missing.
    pub readings: Vec<Vec<f64>>,
    /// Strain of the model. Arguments are gauge, run, the load that acts, and the load whose record gives the size.
    pub strain_of: Box<dyn Fn(usize, usize, usize, usize) -> f64 + Sync + 'a>,
    /// Quantity of each load. Records of one quantity may be exchanged. `None` if the record of the load cannot belong to another load.
    pub quantities: Vec<Option<Quantity>>,
    /// Whether the record of a load in a run is accurate enough to compare.
    pub known: Vec<bool>,
    /// Gauges with their own faults, which do not count.
    pub excluded: Vec<usize>,
    /// Noise of a reading, 1 sd.
    pub noise: f64,
    /// Stated relative error of the model, 1 sd.
    pub model_rel: f64,
}

/// A fault of recorded loads or of all readings.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordFault {
    /// Loads whose records have the other sign, with the factor that the readings show; all of them: the readings may have it as well.
    Sign(Vec<(usize, f64)>),
    /// Loads whose records are in another unit, with the factor that the readings show.
    Unit(Vec<(usize, f64)>),
    /// Pairs of loads whose records are exchanged; share of the sum of squares that is left then.
    Exchanged(Vec<[usize; 2]>, f64),
}

impl RecordedRuns<'_> {
    fn n_gauges(&self) -> usize {
        self.readings.first().map_or(0, Vec::len)
    }

    fn runs(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.readings.len()).filter(|r| self.known.get(*r).copied().unwrap_or(true))
    }

    fn gauges(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.n_gauges()).filter(|g| !self.excluded.contains(g))
    }

    fn reading_at(&self, g: usize, r: usize) -> Option<f64> {
        let value = self.readings.get(r)?.get(g).copied()?;
        value.is_finite().then_some(value)
    }

    /// Returns the root of the sum of squares of a load's strain at a gauge.
    fn answer(&self, g: usize, l: usize) -> f64 {
        let squares: f64 = self
            .runs()
            .map(|r| (self.strain_of)(g, r, l, l).powi(2))
            .sum();
        squares.sqrt()
    }

    /// Returns the sum of squares that noise makes.
    fn noise_squares(&self) -> f64 {
        let readings = self.gauges().flat_map(|g| self.runs().map(move |r| (g, r)));
        let n = readings
            .filter(|(g, r)| self.reading_at(*g, *r).is_some())
            .count();
        n as f64 * self.noise.powi(2)
    }

    /// Returns gauge, run and reading minus the model of each reading, with a factor for each load.
    fn differences(&self, factor: &[f64]) -> Vec<(usize, usize, f64)> {
        let readings = self.gauges().flat_map(|g| self.runs().map(move |r| (g, r)));
        let each = readings.filter_map(|(g, r)| Some((g, r, self.reading_at(g, r)?)));
        each.map(|(g, r, y)| {
            let loads = factor.iter().enumerate();
            let model = loads.map(|(l, c)| c * (self.strain_of)(g, r, l, l));
            (g, r, y - model.sum::<f64>())
        })
        .collect()
    }
}

/// Returns the faults of the records that explain most of the difference between readings and model. The list is empty if the records are right, or
/// if something else is wrong.
///
/// For each gauge, `y_r = sum_l c_l e_l(r)` is solved for the factors `c_l` by least squares, with `e_l` the strain of load `l` by the model. All
/// loads have one factor if the runs do not separate them. The factor of a load is the median over gauges, weighted by its strain there. Exchanged
/// records are searched for pair by pair. A fault counts only if undoing it leaves at most a quarter of the sum of squares. For exchanged records the
/// limit is a fiftieth. If no fault of single loads counts, one factor for all loads is tried.
pub fn faults_of_recorded_loads(runs: &RecordedRuns) -> Vec<RecordFault> {
    let k = runs.loads.len();
    let as_recorded = runs.differences(&vec![1.0; k]);
    let base = squares(&as_recorded);
    if base <= BEYOND * runs.noise_squares() {
        return Vec::new();
    }
    let factors = factors_of_loads(runs);
    let beyond = |c: f64| {
        let unit = UNIT.max(1.0 + 4.0 * runs.model_rel);
        c.abs() > unit || c.abs() < 1.0 / unit
    };
    let (units, rest): (Vec<_>, Vec<_>) = factors.iter().partition(|(_, c)| beyond(*c));
    let signs: Vec<(usize, f64)> = rest.into_iter().filter(|(_, c)| *c < SIGN).collect();
    let mut undone = vec![1.0; k];
    for (l, c) in units.iter().chain(&signs) {
        undone[*l] = if beyond(*c) { *c } else { -1.0 };
    }
    let by_factor = match units.is_empty() && signs.is_empty() {
        true => f64::INFINITY,
        false => squares(&runs.differences(&undone)) / base,
    };
    let (pairs, by_exchange) = exchanges(runs, &as_recorded);
    if by_exchange < by_factor && by_exchange < EXCHANGED {
        return vec![RecordFault::Exchanged(pairs, by_exchange)];
    }
    if by_factor > UNDONE {
        return common_unit(runs).into_iter().collect();
    }
    let unit = (!units.is_empty()).then_some(RecordFault::Unit(units));
    let sign = (!signs.is_empty()).then_some(RecordFault::Sign(signs));
    unit.into_iter().chain(sign).collect()
}

/// Returns the findings on [`faults_of_recorded_loads`], one error for each fault. `file` names the file of the records.
pub fn findings_of_recorded_loads(runs: &RecordedRuns, file: &str) -> Vec<Finding> {
    let faults = faults_of_recorded_loads(runs);
    faults.iter().map(|f| finding(runs, file, f)).collect()
}

/// Returns the fault that all loads, or all readings, are in another unit, by one factor for all gauges and loads. Readings that are too small for
/// their noise determine no factor of a single load, but still this one: `c = sum y m / sum m^2` with the strain `m` of the model, sd
/// `noise / sqrt(sum m^2)`.
fn common_unit(runs: &RecordedRuns) -> Option<RecordFault> {
    let k = runs.loads.len();
    let without_loads = runs.differences(&vec![0.0; k]);
    let as_recorded = runs.differences(&vec![1.0; k]);
    let each = without_loads.iter().zip(&as_recorded);
    let each = each.map(|(y, d)| (y.2, y.2 - d.2));
    let (product, model) = each.fold((0.0, 0.0), |(p, m), (y, of_model)| {
        (p + y * of_model, m + of_model * of_model)
    });
    let c = product / model;
    let is_determined = c.abs() > DETERMINED * runs.noise / model.sqrt();
    let is_small = c.abs() < 1.0 / UNIT.max(1.0 + 4.0 * runs.model_rel);
    // A load that does not act, such as a payload on its own wheels, also leaves little of the model. The rest of the readings then remains.
    let most = (UNDONE * squares(&without_loads)).max(BEYOND * runs.noise_squares());
    if !(is_determined && is_small) || squares(&runs.differences(&vec![c; k])) > most {
        return None;
    }
    let acts = |l: &usize| runs.gauges().any(|g| runs.answer(g, *l) > 0.0);
    let acting = (0..k).filter(acts);
    Some(RecordFault::Unit(acting.map(|l| (l, c)).collect()))
}

/// Returns load and factor of each load whose factor the readings determine.
fn factors_of_loads(runs: &RecordedRuns) -> Vec<(usize, f64)> {
    let acts = |l: &usize| runs.gauges().any(|g| runs.answer(g, *l) > 0.0);
    let acting: Vec<usize> = (0..runs.loads.len()).filter(acts).collect();
    if acting.is_empty() {
        return Vec::new();
    }
    let groups: Vec<Vec<usize>> = match has_separable_loads(runs, &acting) {
        true => acting.iter().map(|l| vec![*l]).collect(),
        false => vec![acting.clone()],
    };
    let mut found: Vec<Vec<(f64, f64)>> = vec![Vec::new(); groups.len()];
    let weight = |a: usize, g: usize| -> f64 { groups[a].iter().map(|l| runs.answer(g, *l)).sum() };
    let most: Vec<f64> = (0..groups.len())
        .map(|a| runs.gauges().map(|g| weight(a, g)).fold(0.0, f64::max))
        .collect();
    for g in runs.gauges() {
        for (a, factor) in factors_at(runs, g, &groups) {
            let weight = weight(a, g);
            if weight > ANSWERS * most[a] {
                found[a].push((factor, weight));
            }
        }
    }
    let each = groups.iter().zip(&mut found);
    each.filter_map(|(loads, f)| Some((loads, weighted_median(f)?)))
        .flat_map(|(loads, c)| loads.iter().map(move |l| (*l, c)))
        .collect()
}

/// Returns whether the runs separate the loads that act, with runs to spare.
fn has_separable_loads(runs: &RecordedRuns, acting: &[usize]) -> bool {
    let k = acting.len();
    let mut gram = vec![0.0; k * k];
    for g in runs.gauges() {
        let sizes: Vec<f64> = acting.iter().map(|l| runs.answer(g, *l)).collect();
        for r in runs.runs() {
            let each = acting.iter().zip(&sizes);
            let row: Vec<f64> = each
                .map(|(l, size)| match *size > 0.0 {
                    true => (runs.strain_of)(g, r, *l, *l) / size,
                    false => 0.0,
                })
                .collect();
            spd::add_outer(&mut gram, &row, 1.0);
        }
    }
    let values = spd::eigenvalues(&gram, k);
    let ends = values.first().zip(values.last());
    runs.runs().count() > k && ends.is_some_and(|(a, b)| *a > SEPARATED * b)
}

/// Returns the factors of groups of loads that the readings of a gauge determine, by number of the group.
fn factors_at(runs: &RecordedRuns, g: usize, groups: &[Vec<usize>]) -> Vec<(usize, f64)> {
    let row = |r: usize| -> Vec<f64> {
        let of = |loads: &Vec<usize>| loads.iter().map(|l| (runs.strain_of)(g, r, *l, *l)).sum();
        groups.iter().map(of).collect()
    };
    let rows: Vec<(Vec<f64>, f64)> = runs
        .runs()
        .filter_map(|r| Some((row(r), runs.reading_at(g, r)?)))
        .collect();
    let norm = |c: usize| rows.iter().map(|r| r.0[c] * r.0[c]).sum::<f64>().sqrt();
    let norms: Vec<f64> = (0..groups.len()).map(norm).collect();
    // A load without strain at this gauge in the model cannot be scaled.
    let kept: Vec<usize> = (0..groups.len()).filter(|c| norms[*c] > 0.0).collect();
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
    let Some(inverse) = Precision::from_covariance(&gram, k) else {
        return Vec::new();
    };
    let amounts = inverse.apply(&right);
    let left = |(x, y): &(Vec<f64>, f64)| (y - spd::dot(&unit(x), &amounts)).powi(2);
    let rest: f64 = rows.iter().map(left).sum();
    let spare = rows.len().saturating_sub(k).max(1) as f64;
    let variance = (rest / spare).max(runs.noise * runs.noise);
    let sure =
        |(i, b): &(usize, &f64)| b.abs() > DETERMINED * (variance * inverse.entry(*i, *i)).sqrt();
    let each = amounts.iter().enumerate().filter(sure);
    each.map(|(i, b)| (kept[i], b / norms[kept[i]])).collect()
}

/// Returns the sum of squares of differences.
fn squares(differences: &[(usize, usize, f64)]) -> f64 {
    differences.iter().map(|d| d.2 * d.2).sum()
}

/// Returns the pair of exchanged records, or the two pairs, that explain most, and the share of the sum of squares that is left then.
fn exchanges(runs: &RecordedRuns, as_recorded: &[(usize, usize, f64)]) -> (Vec<[usize; 2]>, f64) {
    let k = runs.loads.len();
    let base = squares(as_recorded);
    let left = |pairs: &[[usize; 2]]| {
        let exchanged = as_recorded.iter().map(|&(g, r, difference)| {
            let strain = |l: usize, from: usize| (runs.strain_of)(g, r, l, from);
            let change = |[a, b]: &[usize; 2]| {
                strain(*a, *a) - strain(*a, *b) + strain(*b, *b) - strain(*b, *a)
            };
            (difference + pairs.iter().map(change).sum::<f64>()).powi(2)
        });
        exchanged.sum::<f64>() / base
    };
    let quantity = |l: usize| runs.quantities.get(l).copied().flatten();
    let all = (0..k).flat_map(|a| (a + 1..k).map(move |b| [a, b]));
    let alike = all.filter(|[a, b]| quantity(*a).is_some() && quantity(*a) == quantity(*b));
    let alike: Vec<[usize; 2]> = alike.collect();
    let least = |tried: Vec<Vec<[usize; 2]>>| {
        let each = tried.into_par_iter().map(|pairs| {
            let left = left(&pairs);
            (pairs, left)
        });
        each.min_by(|x, y| x.1.total_cmp(&y.1))
    };
    let Some(one) = least(alike.iter().map(|p| vec![*p]).collect()) else {
        return (Vec::new(), f64::INFINITY);
    };
    if k > PAIRED {
        return one;
    }
    let two = alike.iter().enumerate().flat_map(|(i, p)| {
        let later = alike.iter().skip(i + 1);
        let apart = later.filter(|q| !q.iter().any(|l| p.contains(l)));
        apart.map(|q| vec![*p, *q])
    });
    match least(two.collect()) {
        // A second pair must explain most of the residual of the first pair.
        Some(two) if two.1 < UNDONE * one.1 => two,
        _ => one,
    }
}

fn finding(runs: &RecordedRuns, file: &str, fault: &RecordFault) -> Finding {
    let name = |l: usize| runs.loads.get(l).copied().unwrap_or_default();
    let acting = |l: &usize| runs.gauges().any(|g| runs.answer(g, *l) > 0.0);
    let n_acting = (0..runs.loads.len()).filter(acting).count();
    let is_all = |n: usize| n > 1 && n == n_acting;
    let subject = |list: &[(usize, f64)]| match is_all(list.len()) {
        true => "all".to_owned(),
        false => list_few(&list.iter().map(|(l, _)| name(*l)).collect::<Vec<_>>()),
    };
    let factors = |list: &[(usize, f64)]| {
        let each = list
            .iter()
            .map(|(l, c)| format!("{} {}", name(*l), number(*c)));
        list_few(&each.collect::<Vec<_>>())
    };
    match fault {
        RecordFault::Sign(list) => {
            let what = match is_all(list.len()) {
                true => {
                    "all recorded loads or all readings have reversed sign, or all gauges are on the opposite surface"
                }
                false => "these recorded loads have reversed sign",
            };
            Finding::new(
                Severity::Error,
                "input-sign-reversed",
                subject(list),
                format!(
                    "the readings are about -1 times the strain that the model predicts from {file} (factors: {}): {what}",
                    factors(list)
                ),
                "correct the sign of these columns of the runs file, or write a [[correction]] with sign = -1 for each gauge. ISO and SAE \
                 axes differ in Y and Z",
            )
            .with_numbers(list.first().map_or(-1.0, |l| l.1), SIGN)
        }
        RecordFault::Unit(list) => {
            let first = list.first().map_or(1.0, |l| l.1);
            let near = |u: &&(f64, &str)| (first.abs() / u.0 - 1.0).abs() < NEAR;
            let called = UNITS.iter().find(near).map_or("", |u| u.1);
            let comma = if called.is_empty() { "" } else { ", " };
            Finding::new(
                Severity::Error,
                "input-unit",
                subject(list),
                format!(
                    "the readings are a multiple of the strain that the model predicts from {file} (factors: {}){comma}{called}: a unit is wrong",
                    factors(list)
                ),
                "state the unit of the runs file ([runs] units = { force = \"kN\" }), and check `applied`, the units of the job and of the readings",
            )
            .with_numbers(first, UNIT.max(1.0 + 4.0 * runs.model_rel))
        }
        RecordFault::Exchanged(pairs, left) => {
            let names: Vec<String> = pairs
                .iter()
                .map(|[a, b]| format!("{}, {}", name(*a), name(*b)))
                .collect();
            let words: Vec<String> = pairs
                .iter()
                .map(|[a, b]| format!("{} and {}", name(*a), name(*b)))
                .collect();
            Finding::new(
                Severity::Error,
                "inputs-exchanged",
                list_few(&names),
                format!(
                    "the recorded loads {} are exchanged in {file}: with the columns exchanged back, {} % of the squared difference between readings and model remains",
                    list_few(&words),
                    number(100.0 * left)
                ),
                "exchange the names of these columns of the runs file, or state them in [runs] columns",
            )
            .with_numbers(*left, EXCHANGED)
        }
    }
}

/// Returns the finding on recorded payloads if the wheel forces and the strain both contradict their weight by one factor. `payload` is their place
/// among the loads. `weights` and `sums` are recorded weight and sum of the wheel forces by run in one unit, `sum_sd` is the noise of a sum.
///
/// The factor is the slope of the sums over the weights, so that the weight of the empty structure in the sums does not matter. Wheel forces alone or
/// strain alone are no evidence, because some wheels may have no sensor.
pub fn recorded_mass_contradicted(
    runs: &RecordedRuns,
    payload: usize,
    (weights, sums): (&[f64], &[f64]),
    sum_sd: f64,
) -> Option<Finding> {
    let n = weights.len().min(sums.len()) as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (weight, sum) = (mean(weights), mean(sums));
    let squares: f64 = weights.iter().map(|w| (w - weight).powi(2)).sum();
    let each = weights.iter().zip(sums);
    let by_wheels = each.map(|(w, s)| (w - weight) * (s - sum)).sum::<f64>() / squares;
    let by_wheels = by_wheels.abs();
    let off = (by_wheels - 1.0).abs();
    if !(off > NEAR && off > DETERMINED * sum_sd / squares.sqrt()) {
        return None;
    }
    let of_strain = factors_of_loads(runs).into_iter().find(|f| f.0 == payload);
    let by_strain = of_strain?.1.abs();
    ((by_strain / by_wheels - 1.0).abs() < NEAR).then(|| {
        Finding::new(
            Severity::Error,
            "recorded-mass-contradicts",
            runs.loads.get(payload).copied().unwrap_or_default(),
            format!(
                "the wheel forces change by {} times the recorded payload weights, and the strain by {} times: the recorded masses are wrong",
                number(by_wheels),
                number(by_strain)
            ),
            "check the masses of the runs file and their unit",
        )
        .with_numbers(by_wheels, 1.0)
    })
}
