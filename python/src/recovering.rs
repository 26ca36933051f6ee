//! Loads from bare readings.

use crate::array::Named;
use crate::fault::{argument_fault, raise};
use crate::work::{Asked, run};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::time::Instant;
use strainbridge::finding::Finding;
use strainbridge::host::context::Progress;
use strainbridge::linalg::Matrix;
use strainbridge::recovery::history::{Filter, SampleLoads};
use strainbridge::recovery::reading_plausibility::LARGEST_STRAIN;
use strainbridge::recovery::{
    ErrorModel, Gain, MissingReadings, NOT_SOLVABLE, Readings, Recovery, Widening, check_gaps,
    recover, recover_samples,
};
use strainbridge::sensitivity::{Load, Sensitivity, check_separability};
use strainbridge::stop::Stop;
use strainbridge::units::MICROSTRAIN;
use strainbridge::{Fault, Faults, Severity};

const S: Named = Named {
    function: "recover_rows",
    name: "S",
    axes: "gauges x loads",
};
const STRAIN: Named = Named {
    name: "strain",
    axes: "runs x gauges",
    ..S
};

/// Number of runs up to which each run is tested with its residual, as in the command. Of a longer record, this number of samples is tested.
const MOST_RUNS: usize = 2000;
/// Number of samples in a block.
const BLOCK: usize = 8192;

/// Loads, and the data for their intervals.
struct Recovered {
    /// `k` numbers per run.
    loads: Vec<f64>,
    /// Half width of the interval of each load, if every gauge reads.
    half: Vec<f64>,
    /// Runs whose intervals have other widths, with these widths, `k` per run.
    others: Vec<(usize, Vec<f64>)>,
    /// `k x k` by rows, if every gauge reads.
    covariance: Vec<f64>,
    findings: Vec<Finding>,
}

/// Returns the loads of every row of `strain`, by name.
#[pyfunction]
#[pyo3(signature = (s, strain, noise, threads))]
pub(crate) fn recover_rows<'py>(
    py: Python<'py>,
    s: &Bound<'py, PyAny>,
    strain: &Bound<'py, PyAny>,
    noise: f64,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let s = S.matrix(s)?;
    let strain = STRAIN.matrix(strain)?;
    let (n, k, runs) = (s.shape()[0], s.shape()[1], strain.shape()[0]);
    if strain.shape()[1] != n {
        let said = format!("it has {} columns and S has {n} rows", strain.shape()[1]);
        return Err(STRAIN.fault(
            py,
            &said,
            "give one column for each gauge, in the order of S",
        ));
    }
    let (rows, samples) = (s.as_slice()?, strain.as_slice()?);
    let asked = Asked {
        threads,
        progress: None,
    };
    let found = run(py, &asked, |heard| {
        let begin = Instant::now();
        let found = recover_readings(rows, k, samples, noise, &heard.stop())?;
        Ok((found, begin.elapsed().as_secs_f64()))
    })?;
    let (found, seconds) = found.map_err(|f: Faults| raise(py, f))?;
    let findings: Vec<_> = found.findings.into_iter().map(parts).collect();
    let (at, widths): (Vec<i64>, Vec<Vec<f64>>) =
        found.others.into_iter().map(|(i, w)| (i as i64, w)).unzip();
    let others = (widths.len(), widths.concat());
    let out = PyDict::new(py);
    let matrix = |v: Vec<f64>, shape: [usize; 2]| -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_vec(py, v).reshape(shape)
    };
    out.set_item("loads", matrix(found.loads, [runs, k])?)?;
    out.set_item("covariance", matrix(found.covariance, [k, k])?)?;
    out.set_item("half", PyArray1::from_vec(py, found.half))?;
    out.set_item("others", PyArray1::from_vec(py, at))?;
    out.set_item("other_halves", matrix(others.1, [others.0, k])?)?;
    out.set_item("findings", findings)?;
    // The time in the library, which shows the cost of the call.
    out.set_item("seconds", seconds)?;
    Ok(out)
}

/// Parts of a finding.
type Parts = (
    String,
    &'static str,
    String,
    String,
    Option<f64>,
    Option<f64>,
    String,
);

fn parts(f: Finding) -> Parts {
    let severity = format!("{:?}", f.severity).to_lowercase();
    (
        severity, f.code, f.subject, f.message, f.measured, f.limit, f.remedy,
    )
}

/// Recovers the loads of readings, `n` per run.
fn recover_readings(
    rows: &[f64],
    k: usize,
    samples: &[f64],
    noise: f64,
    stop: &Stop,
) -> Result<Recovered, Faults> {
    if !(noise > 0.0 && noise.is_finite()) {
        let remedy = "give one standard deviation of a reading, in the unit of the readings";
        return Err(
            argument_fault(S.function, "noise", "it is not a positive number", remedy).into(),
        );
    }
    let n = rows.len().checked_div(k).unwrap_or(0);
    if n == 0 {
        let remedy = "give one row for each gauge and one column for each load";
        return Err(argument_fault(S.function, "S", "it is empty", remedy).into());
    }
    if let Some(at) = rows.iter().position(|v| !v.is_finite()) {
        let said = format!("row {}, column {} is not a finite number", at / k, at % k);
        return Err(argument_fault(S.function, "S", &said, "leave that gauge out").into());
    }
    if samples.is_empty() {
        return Err(argument_fault(
            S.function,
            "strain",
            "it has no rows",
            "give one row for each run",
        )
        .into());
    }
    // One pass over the record is sufficient, because readings between the tested samples are rarely in another unit.
    let judged: Vec<f64> = judged_rows(samples, n)
        .flat_map(|(_, row)| row.to_vec())
        .collect();
    match in_unit(rows, k, samples, noise, unit_of(&judged), stop)? {
        Some(found) => Ok(found),
        None => in_unit(rows, k, samples, noise, unit_of(samples), stop)?.ok_or_else(|| {
            argument_fault(
                S.function,
                "strain",
                "its numbers are indistinguishable",
                "check its unit",
            )
            .into()
        }),
    }
}

/// Recovers the loads with `unit` as the strain of a unit of the readings. Returns `None` if a reading is too large for this unit.
fn in_unit(
    rows: &[f64],
    k: usize,
    samples: &[f64],
    noise: f64,
    unit: f64,
    stop: &Stop,
) -> Result<Option<Recovered>, Faults> {
    let n = rows.len() / k;
    let s = Sensitivity {
        gauges: (0..n).map(|g| format!("row {g}")).collect(),
        loads: (0..k)
            .map(|l| Load::from_name(format!("column {l}")))
            .collect(),
        values: Matrix::from_fn(n, k, |g, l| rows[g * k + l] * unit),
        uncertainty: None,
        noise: None,
    };
    let mut findings = check_separability(&s);
    check_separable(&s, &findings)?;
    let errors = ErrorModel {
        noise: noise * unit,
        model_rel: 0.0,
    };
    let runs = samples.len() / n;
    let judged = if runs > MOST_RUNS {
        recover_samples(&s, readings(samples, n, unit), errors)
    } else {
        recover(&s, &readings(samples, n, unit), errors)
    };
    let s = judged.s(&s);
    let all: Vec<usize> = (0..n).collect();
    let whole = Gain::new(&s, &all, errors, 1.0, &judged.typical)
        .filter(|gain| (0..k).all(|l| gain.is_seen(l)))
        .ok_or_else(|| {
            argument_fault(S.function, "S", "it cannot be solved", "check its numbers")
        })?;
    let covariance = whole.covariance(&judged.typical, &judged.widening);
    let half: Vec<f64> = (0..k)
        .map(|l| judged.widening.coverage_factor * covariance[l * k + l].max(0.0).sqrt())
        .collect();
    let Rows {
        loads,
        others,
        missing,
    } = if runs <= MOST_RUNS {
        of_runs(&judged, &half)
    } else {
        match of_record(&s, samples, unit, errors, &judged, stop)? {
            Some(found) => found,
            None => return Ok(None),
        }
    };
    // All gauges together determine every load, so a missing load in a row is a gap, for any number of rows.
    let said = judged.findings.into_iter();
    findings.extend(said.filter(|f| f.code != NOT_SOLVABLE));
    findings.extend(check_gaps(STRAIN.name, &s, &missing));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Ok(Some(Recovered {
        loads,
        half,
        others,
        covariance,
        findings,
    }))
}

/// Returns the strain of one unit of the readings: microstrain, or a power of two that permits all of them.
fn unit_of(samples: &[f64]) -> f64 {
    let largest = samples.par_iter().filter(|v| v.is_finite());
    let largest = largest.map(|v| v.abs()).reduce(|| 0.0, f64::max);
    if largest * MICROSTRAIN <= LARGEST_STRAIN {
        MICROSTRAIN
    } else {
        (-largest.log2().ceil() - 1.0).exp2()
    }
}

/// Returns faults if loads can't be separated.
fn check_separable(s: &Sensitivity, findings: &[Finding]) -> Result<(), Faults> {
    let (rank, k) = (s.rank(), s.loads.len());
    let errors = findings.iter().filter(|f| f.severity == Severity::Error);
    let mut faults: Vec<Fault> = errors
        .map(|f| Fault::from_finding(S.function, "S", f))
        .collect();
    if rank < k && faults.is_empty() {
        let said = format!("its rank is {rank}, and it has {k} columns");
        faults.push(argument_fault(
            S.function,
            "S",
            &said,
            "drop loads with the same effect",
        ));
    }
    Faults::check(faults)
}

/// Returns the rows to test, with their numbers: all of a few runs; of a record [`MOST_RUNS`] samples, evenly spread.
fn judged_rows(samples: &[f64], n: usize) -> impl Iterator<Item = (usize, &[f64])> {
    let runs = samples.len() / n;
    let judged = runs.min(MOST_RUNS);
    (0..judged).map(move |i| {
        let at = i * runs / judged;
        (at, &samples[at * n..][..n])
    })
}

/// Returns the readings to test.
fn readings(samples: &[f64], n: usize, unit: f64) -> Vec<Readings> {
    judged_rows(samples, n)
        .map(|(at, row)| Readings {
            run: at.to_string(),
            strain: row.iter().map(|v| v * unit).collect(),
            noise_factor: 1.0,
        })
        .collect()
}

/// Loads of all rows.
struct Rows {
    /// Loads, `k` per row.
    loads: Vec<f64>,
    /// Rows whose intervals have another width, with these widths.
    others: Vec<(usize, Vec<f64>)>,
    /// Counts of missing readings in the rows.
    missing: MissingReadings,
}

/// Returns the loads of recovered runs, and the widths that differ from `half`.
fn of_runs(judged: &Recovery, half: &[f64]) -> Rows {
    let mut missing = MissingReadings::new(half.len());
    for r in &judged.runs {
        if r.residual.iter().all(|v| v.is_finite()) {
            missing.whole += 1;
            continue;
        }
        missing.gaps += 1;
        for (l, known) in missing.known_in_gaps.iter_mut().enumerate() {
            *known += u64::from(r.determines_load(l));
        }
    }
    let loads = judged.runs.iter().flat_map(|r| r.estimate.values.clone());
    let others = judged.runs.iter().enumerate().filter_map(|(i, r)| {
        let e = &r.estimate;
        let own: Vec<f64> = (0..half.len())
            .map(|l| e.coverage_factor * e.sigma(l))
            .collect();
        let alike = own
            .iter()
            .zip(half)
            .all(|(a, b)| (a - b).abs() <= 1e-12 * b);
        (!alike).then_some((i, own))
    });
    Rows {
        loads: loads.collect(),
        others: others.collect(),
        missing,
    }
}

/// Recovers the loads of a record, streamed through one estimate, and the widths of samples in which a gauge has no reading.
///
/// Returns `None` if a reading is too large to be strain in this unit.
fn of_record(
    s: &Sensitivity,
    samples: &[f64],
    unit: f64,
    errors: ErrorModel,
    judged: &Recovery,
    stop: &Stop,
) -> Result<Option<Rows>, Faults> {
    let (n, k) = (s.gauges.len(), s.loads.len());
    let widening: Widening = judged.widening.clone();
    let filter =
        Filter::new(s, vec![0.0; n], errors, 1.0, &judged.typical, widening).ok_or_else(|| {
            argument_fault(S.function, "S", "it cannot be solved", "check its numbers")
        })?;
    let blocks: Vec<(SampleLoads, MissingReadings, usize)> = samples
        .par_chunks(BLOCK * n)
        .map(|block| {
            let mut out = SampleLoads {
                values: Vec::with_capacity(block.len() / n * k),
                gaps: Vec::new(),
            };
            // After a stop request, the result is left empty.
            if stop.is_asked() {
                return (out, MissingReadings::new(k), 0);
            }
            let mut missing = MissingReadings::new(k);
            filter.loads_of(block, unit, &mut out, &mut missing);
            // An infinite reading is impossible in any unit.
            let impossible = match missing.impossible {
                0 => 0,
                _ => block
                    .iter()
                    .filter(|v| v.is_finite() && (*v * unit).abs() > LARGEST_STRAIN)
                    .count(),
            };
            (out, missing, impossible)
        })
        .collect();
    if blocks.iter().any(|b| b.2 > 0) {
        return Ok(None);
    }
    let (mut others, mut missing) = (Vec::new(), MissingReadings::new(k));
    for (number, (block, of_block, _)) in blocks.iter().enumerate() {
        missing.merge(of_block);
        for (at, gain) in &block.gaps {
            let f = &block.values[at * k..][..k];
            let sigma = match gain {
                Some(gain) => filter.sigma_with(gain, f),
                None => vec![f64::NAN; k],
            };
            let factor = filter.coverage_factor();
            others.push((
                number * BLOCK + at,
                sigma.iter().map(|v| factor * v).collect(),
            ));
        }
    }
    let mut loads = Vec::with_capacity(samples.len() / n * k);
    for (block, ..) in blocks {
        loads.extend_from_slice(&block.values);
    }
    Ok(Some(Rows {
        loads,
        others,
        missing,
    }))
}
