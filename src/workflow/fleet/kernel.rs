//! Evaluation of one record, without files or messages, on the threads of the current pool.

use super::conditioned_record::FleetRecord;
use super::day::{Day, GaugeDay, LoadDay};
use super::dead_parts::{blank_of, dead_parts, report_dead_parts};
use super::health::Health;
use super::record_recovery::{Part, RecordRecovery, UnderWay, count_pieces};
use super::sample_tests::{TestedSamples, findings_of};
use super::sampled_readings::{kept_columns, sample_readings};
use super::scale::{noise_of, scales};
use crate::finding::{Finding, list_few};
use crate::host::fault::{Fault, Faults};
use crate::input_faults::AlternativeRows;
use crate::job::correct::{Channel, channel_of, column_of, columns_wanted};
use crate::job::{Job, StrainCorrection};
use crate::linalg::Matrix;
use crate::measured::columns::{gauge_without_column, strain_without_gauge, unknown_columns};
use crate::measured::faults::record_fault;
use crate::measured::gauge_columns::find_gauge_columns;
use crate::recovery::ErrorModel;
use crate::recovery::clock;
use crate::recovery::dead_gauges::is_shown_dead;
use crate::recovery::history::{Filter, SampleLoads};
use crate::recovery::{MissingReadings, Sums, UNEXPLAINED, Widening, check_gaps};
use crate::sensitivity::{GaugeNoise, Sensitivity};
use crate::series::SeriesError;
use crate::series::constant_columns::{ColumnContents, Gives};
use crate::series::rainflow::{Counter, Law, Marks};
use crate::series::record::Record;
use crate::units::MICROSTRAIN;
use crate::workflow::recover::{ListedLoads, VerticalLoads, VibrationModel, silent_throughout};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Number of samples of these pieces that suffice to determine whether the vehicle moves.
const ENOUGH: usize = 200;

/// Result of one pass over a record.
struct Pass {
    counters: Vec<Counter>,
    health: Health,
    missing: MissingReadings,
    tested: TestedSamples,
    /// Number of samples with a missing reading, by the gauges that read.
    by_gauges: BTreeMap<Vec<usize>, u64>,
    /// Noise of each load for the count of its cycles, report unit.
    noise: Vec<f64>,
}

/// Inputs that all records of a job share.
pub struct Kernel {
    /// S of all gauges of the job.
    pub sensitivity: Sensitivity,
    /// Strain subtracted from readings, by gauge.
    pub zero: Vec<f64>,
    /// Stated errors.
    pub errors: ErrorModel,
    /// Noise variance of a reading minus zero, in units of the variance of a single reading.
    pub noise_factor: f64,
    /// Rows of S that gauges would have on the other surface or with an angle in radians, for all gauges of S.
    pub alternatives: Vec<AlternativeRows>,
    /// Vertical loads of the job.
    pub(super) vertical: VerticalLoads,
    /// Range of each load of S in its calibration, job units; `None` where the job states none.
    pub ranges: Vec<Option<[f64; 2]>>,
    /// Loads of S, then sums of loads, whose cycles are counted, with their units.
    pub listed: ListedLoads,
    /// Law of the damage of a cycle.
    pub law: Law,
    /// Width of a class, by load and sum, report units.
    pub widths: Vec<f64>,
    /// Job without its validation gauges: time unit of the records, known faults of channels, columns that are not read, `[conditioning]`.
    pub job: Job,
    /// Modes of the structure at all gauges of S; `None` for a job without `[dynamic]`.
    pub(super) vibration: Option<VibrationModel>,
    /// Records that are being recovered.
    pub(super) under_way: UnderWay,
}

impl Kernel {
    /// Computes the result of a record. Reports gauges that are missing (no column), dead or stuck, and recovers the loads from the other gauges.
    ///
    /// # Errors
    /// Faults of the record that prevent the recovery of its loads.
    pub fn day(&self, opened: FleetRecord) -> Result<Day, Faults> {
        let FleetRecord {
            record,
            clock,
            is_low_pass,
            corrections,
            mut findings,
        } = opened;
        let mut r = self.prepare_recovery(&record, &corrections, &mut findings)?;
        let mut pass = self.pass(&record, &r)?;
        let dead = dead_parts(&record, &r, &pass.tested, self.errors, self.noise_factor)?;
        r.blank = blank_of(&dead);
        // Noise is a property of the readings as measured; vibration is removed with a filter.
        let noise_as_measured = pass.health.noise();
        let quasi_static = self.remove_vibration(&record, &mut r, &mut findings)?;
        let is_changed = quasi_static.is_some();
        let record = quasi_static.map_or(record, Arc::new);
        if is_changed || !r.blank.is_empty() {
            // The second pass leaves out vibration, and the readings of gauges where they are dead.
            pass = self.pass(&record, &r)?;
        }
        // The finding on the vibration states the samples that its filter leaves blank.
        let by_filter = pass.missing.gaps == r.blank_by_filter;
        let stated = |f: &Finding| !(by_filter && f.code == "samples-with-gaps");
        let gaps = check_gaps("samples", &r.sensitivity, &pass.missing);
        findings.extend(gaps.into_iter().filter(stated));
        let tested = std::mem::take(&mut pass.tested);
        let mut ends = tested.ends();
        let time_s = |i| record.clock.time_s(i);
        let (mut widened, noise) = self.test_samples(&r, tested, time_s, &mut findings);
        if noise.is_some()
            && let Some(filter) = widened.take()
        {
            // Another pass uses the weights for the noise that the record shows.
            r.filter = filter;
            pass = self.pass(&record, &r)?;
            ends = pass.tested.ends();
        }
        let filter = widened.as_ref().unwrap_or(&r.filter);
        findings.extend(self.check_range_and_sign(filter, &ends, record.clock.samples));
        let scales = scales(&r, filter, pass.missing.whole, &pass.by_gauges);
        let loads = pass.counters.into_iter().zip(&self.listed.names);
        let loads = loads
            .zip(&self.listed.units)
            .zip(pass.noise.iter().zip(scales))
            .map(|(((c, name), unit), (noise, scale))| LoadDay {
                name: name.clone(),
                unit: unit.name.clone(),
                noise: *noise,
                scale,
                tally: c.finish(),
            });
        let leverage = &r.filter.gain_of_all_gauges().leverage;
        // Time without readings adds no counted damage.
        let missing = &pass.missing;
        let known = missing.whole + missing.known_in_gaps.iter().max().copied().unwrap_or(0);
        let mut gauges = pass.health.days(&r.sensitivity.gauges, leverage);
        for (gauge, noise) in gauges.iter_mut().zip(noise_as_measured) {
            if is_changed || is_low_pass {
                gauge.noise = if is_low_pass { f64::NAN } else { noise };
            }
        }
        let hours = |samples: f64| samples / record.clock.rate_hz / 3600.0;
        findings.extend(report_dead_parts(&dead, &mut gauges, &record.clock));
        gauges.extend(r.silent.iter().map(|name| GaugeDay::without_readings(name)));
        let place = |g: &GaugeDay| self.sensitivity.gauges.iter().position(|n| *n == g.name);
        gauges.sort_by_key(place);
        Ok(Day {
            rate_hz: record.clock.rate_hz,
            hours: hours(known as f64),
            missing: clock.missing,
            loads: loads.collect(),
            gauges,
            findings,
        })
    }

    /// The record, recovered and counted.
    fn pass(&self, record: &Record, r: &RecordRecovery) -> Result<Pass, Fault> {
        let k = self.listed.names.len();
        let noise = noise_of(r);
        let counter = |l: usize| {
            let at = |v: &[f64]| v.get(l).copied().unwrap_or(1.0);
            Counter::new(l, k, at(&noise), at(&self.widths), self.law)
        };
        let marks = Marks::new(&noise);
        let mut pass = Pass {
            counters: (0..k).map(counter).collect(),
            health: Health::new(&r.s),
            missing: MissingReadings::new(k),
            tested: r.tested_samples(),
            by_gauges: BTreeMap::new(),
            noise,
        };
        let here = self.under_way.begin();
        let mut pieces = 0..record.n_pieces();
        let mut parts: Vec<Part> = Vec::new();
        // Pieces are counted while the next pieces are decoded.
        while !pieces.is_empty() {
            let group: Vec<usize> = pieces.by_ref().take(here.pieces()).collect();
            let decode = || group.par_iter().map(|p| r.part(record, *p, &marks));
            let (next, ()) = rayon::join(
                || decode().collect::<Result<_, _>>(),
                || count_pieces(&mut pass.counters, &parts),
            );
            parts = next.map_err(|e: SeriesError| record_fault("record", &e))?;
            for part in &mut parts {
                pass.health.merge(&part.health);
                pass.missing.merge(&part.missing);
                pass.tested.merge(std::mem::take(&mut part.tested));
                for (gauges, n) in std::mem::take(&mut part.by_gauges) {
                    *pass.by_gauges.entry(gauges).or_insert(0) += n;
                }
            }
        }
        count_pieces(&mut pass.counters, &parts);
        Ok(pass)
    }

    /// Tests samples of the record as `recover` does and adds the findings. Returns the estimate with the intervals that the residuals require, and
    /// the noise of the gauges. `None` if the stated errors remain valid, or if no interval is reliable.
    fn test_samples(
        &self,
        r: &RecordRecovery,
        tested: TestedSamples,
        time_s: impl Fn(usize) -> f64,
        findings: &mut Vec<Finding>,
    ) -> (Option<Filter>, Option<GaugeNoise>) {
        let with = (self.errors, r.noise_factor, r.errors_beyond.as_deref());
        let installed = self.alternatives.iter().map(|a| a.of_gauges(&r.used));
        let installed: Vec<AlternativeRows> = installed.collect();
        let recoveries = tested.recover_loads((&r.sensitivity, &installed), with, time_s);
        let Some(first) = recoveries.first() else {
            return (None, None);
        };
        let (widening, noise) = (first.widening.clone(), first.noise.clone());
        let found = findings_of(recoveries);
        let explained = found.iter().all(|f| f.code != UNEXPLAINED);
        findings.extend(found);
        if !explained || (widening == Widening::none() && noise.is_none()) {
            return (None, None);
        }
        let s = Sensitivity {
            noise: noise.clone().or(r.sensitivity.noise.clone()),
            ..r.sensitivity.clone()
        };
        (self.filter(&s, r, widening), noise)
    }

    /// Returns the filter of a record with other S or intervals; `None` if S contains numbers that are not finite.
    pub(super) fn filter(
        &self,
        s: &Sensitivity,
        r: &RecordRecovery,
        widening: Widening,
    ) -> Option<Filter> {
        let zero = r.zero.clone();
        let filter = Filter::new(s, zero, self.errors, r.noise_factor, &r.typical, widening);
        filter.map(|mut filter| {
            if let Some(errors) = &r.errors_beyond {
                filter.add_reading_covariance(errors.clone());
            }
            filter.combine(&self.listed.sums);
            filter
        })
    }

    /// Returns whether the readings of a record are in memory as a whole.
    pub(super) fn holds_whole_records(&self) -> bool {
        self.vibration.is_some() || self.job.conditioning.is_some()
    }

    /// Returns the columns that a record is read for.
    pub fn wanted_columns(&self) -> Vec<String> {
        let gauges = self.sensitivity.gauges.iter().chain(&self.job.reserved);
        columns_wanted(&self.job.corrections, gauges)
    }

    /// The gauges that read, and the filter from them.
    fn prepare_recovery(
        &self,
        record: &Record,
        corrections: &[StrainCorrection],
        findings: &mut Vec<Finding>,
    ) -> Result<RecordRecovery, Faults> {
        let all = &self.sensitivity;
        let gauges = all.gauges.iter().chain(&self.job.reserved);
        let wanted = columns_wanted(corrections, gauges);
        let columns = find_gauge_columns("record", record.columns(), &wanted)?;
        let names: Vec<String> = columns
            .iter()
            .map(|c| column_of(corrections, &c.name).to_owned())
            .collect();
        let others = names.iter().filter(|n| !self.job.reserved.contains(n));
        let others: Vec<String> = others.cloned().collect();
        let unknown = strain_without_gauge("", &others, &all.gauges);
        findings.extend(unknown);
        let unknown = unknown_columns(&others, &all.gauges);
        let named = columns.iter().enumerate();
        let places: HashMap<&str, (usize, f64)> = named
            .filter_map(|(i, c)| Some((c.name.as_str(), (i, c.microstrain?))))
            .collect();
        let mut found = Vec::new();
        for (g, name) in all.gauges.iter().enumerate() {
            let channel = channel_of(corrections, name);
            if channel.ignore {
                continue;
            }
            match places.get(column_of(corrections, name)) {
                Some(&(c, micro)) => found.push((g, c, line_of(micro, channel))),
                None => findings.push(gauge_without_column("", &[name], &unknown)),
            }
        }
        let sampled = sample_readings(record, &found)?;
        let step_s = 1.0 / record.clock.rate_hz;
        let stated = record.is_time_unit_stated();
        if let Some(f) = clock::check(step_s, &sampled, found.len()).filter(|_| !stated) {
            return Err(Fault::from_finding("record", "time", &f).into());
        }
        let n = found.len();
        let mut alive = Vec::new();
        let mut looked = ColumnContents::new(n);
        looked.look(&sampled);
        // Columns are classified over the whole record. `dead_parts` reports gauges that fail in a part of it.
        let columns: Vec<Option<usize>> = found.iter().map(|f| Some(f.1)).collect();
        let given = looked.columns_in_record(record, &columns);
        let mut given = given.map_err(|e| record_fault("record", &e))?;
        self.wake(&found, &sampled, &mut given);
        for (&(g, c, scale), gives) in found.iter().zip(given) {
            let name = all.gauges.get(g).map_or("", String::as_str);
            match gives {
                Gives::Signal => alive.push((g, c, scale)),
                Gives::OneValue | Gives::Nothing => {
                    findings.extend(silent_throughout(&[name], gives));
                }
            }
        }
        let alive_values = kept_columns(&sampled, &found, &alive);
        let silent = found.iter().filter(|f| alive.iter().all(|a| a.0 != f.0));
        let names = silent.filter_map(|f| all.gauges.get(f.0)).cloned();
        Ok(RecordRecovery {
            silent: names.collect(),
            samples: record.clock.samples,
            ..self.build_recovery(&alive, &alive_values)?
        })
    }

    /// Treats columns with a constant value as signals unless the other gauges show that the strain there changes or has another value. The vehicle
    /// is then at standstill, or its load is too small to change a coarse reading.
    fn wake(&self, found: &[(usize, usize, [f64; 2])], sampled: &[f64], given: &mut [Gives]) {
        let n_gauges = self.sensitivity.gauges.len();
        let by_gauge = found.iter().zip(&*given);
        let used = by_gauge.filter(|g| *g.1 == Gives::Signal).map(|g| g.0.0);
        let used: Vec<usize> = used.collect();
        let rows = sampled.chunks_exact(found.len().max(1));
        let step = (rows.len() / ENOUGH).max(1);
        let of_gauges = |row: &[f64]| {
            let mut out = vec![f64::NAN; n_gauges];
            for ((g, ..), v) in found.iter().zip(row) {
                if let Some(slot) = out.get_mut(*g) {
                    *slot = *v;
                }
            }
            out
        };
        let rows: Vec<Vec<f64>> = rows.step_by(step).map(of_gauges).collect();
        let whole = |row: &&Vec<f64>| {
            used.iter()
                .all(|g| row.get(*g).is_some_and(|v| v.is_finite()))
        };
        let rows: Vec<&Vec<f64>> = rows.iter().filter(whole).collect();
        if used.is_empty() || rows.is_empty() {
            return;
        }
        let (errors, factor) = (self.errors, self.noise_factor);
        for (gives, (g, ..)) in given.iter_mut().zip(found) {
            let dead = || is_shown_dead(&self.sensitivity, &used, &rows, *g, errors, factor);
            if *gives == Gives::OneValue && !dead() {
                *gives = Gives::Signal;
            }
        }
    }

    fn build_recovery(
        &self,
        alive: &[(usize, usize, [f64; 2])],
        sampled: &[f64],
    ) -> Result<RecordRecovery, Fault> {
        let all = &self.sensitivity;
        let k = all.loads.len();
        let used: Vec<usize> = alive.iter().map(|a| a.0).collect();
        if used.is_empty() {
            return Err(Fault::new(
                "record",
                "gauge",
                "no column has the name of a gauge of the job, or none of these has readings",
                "name the columns after the gauges, and check the export of the record",
            ));
        }
        let s = Sensitivity {
            gauges: used
                .iter()
                .filter_map(|g| all.gauges.get(*g))
                .cloned()
                .collect(),
            loads: all.loads.clone(),
            values: Matrix::from_fn(used.len(), k, |i, l| all.values[(used[i], l)]),
            uncertainty: all.uncertainty.as_ref().map(|u| u.of_gauges(&used)),
            noise: all.noise.as_ref().map(|n| n.of_gauges(&used)),
        };
        let zero: Vec<f64> = used
            .iter()
            .map(|g| self.zero.get(*g).copied().unwrap_or(0.0))
            .collect();
        let singular = || {
            let wrong = "S contains numbers that are not finite";
            Fault::new("record", "sensitivity", wrong, "check the table of S")
        };
        let plain = Filter::new(
            &s,
            zero.clone(),
            self.errors,
            self.noise_factor,
            &vec![0.0; k],
            Widening::none(),
        )
        .ok_or_else(singular)?;
        if plain.gain_of_all_gauges().rank < k {
            let names: Vec<&str> = s.gauges.iter().map(String::as_str).collect();
            let wrong = format!(
                "the gauges do not separate the loads: only {} have readings",
                list_few(&names)
            );
            let remedy = "repair the other gauges";
            return Err(Fault::new("record", "gauge", wrong, remedy));
        }
        // Typical loads determine the weight of the model's error. The expected loads of the job are used, so that the loads of a sample do not
        // depend on where its record is cut.
        let scaled: Vec<f64> = sampled.to_vec();
        let (mut loads, mut sums) = (SampleLoads::default(), Sums::new(used.len(), k));
        plain.apply(&scaled, 1.0, &mut loads, &mut sums);
        let mean = |sum: f64, count: u64| (sum / count.max(1) as f64).sqrt();
        let expected = s.loads.iter().map(|l| l.expected.filter(|e| *e > 0.0));
        let typical = expected.collect::<Option<Vec<f64>>>().unwrap_or_else(|| {
            let of_record = |l| mean(sums.sum_of_squares[l], sums.known_samples(l));
            (0..k).map(of_record).collect()
        });
        let noise = self.errors.noise;
        if noise > 0.0
            && sums.missing.whole > 0
            && sums
                .reading
                .iter()
                .enumerate()
                .all(|(g, q)| mean(*q, sums.read(g)) < 1e-3 * noise)
        {
            return Err(Fault::new(
                "record",
                "readings-below-noise",
                "every reading is less than a thousandth of the stated noise: the unit may be strain, not microstrain",
                "state readings in microstrain (strain times 1e6)",
            ));
        }
        let factors: Vec<f64> = self.listed.units.iter().map(|u| u.factor).collect();
        let row = |g: usize| factors.iter().enumerate().map(move |(l, f)| (g, l, *f));
        // Sums of loads cause no strain in addition to their loads.
        let values = |(g, l, f)| if l < k { s.values[(g, l)] / f } else { 0.0 };
        let values = |g: usize| row(g).map(values).collect();
        let by_row = (0..used.len()).map(values).collect();
        let mut r = RecordRecovery {
            filter: plain,
            silent: Vec::new(),
            noise_factor: self.noise_factor,
            errors_beyond: None,
            apart: 1,
            blank_by_filter: 0,
            sensitivity: s,
            typical,
            columns: alive.iter().map(|a| Some(a.1)).collect(),
            scale: [0, 1].map(|i| alive.iter().map(|a| a.2[i]).collect()),
            zero,
            blank: Vec::new(),
            samples: 0,
            s: by_row,
            used,
            factors,
        };
        r.filter = self
            .filter(&r.sensitivity, &r, Widening::none())
            .ok_or_else(singular)?;
        Ok(r)
    }
}

/// Strain from a reading: it times the first, plus the second.
fn line_of(micro: f64, channel: Channel) -> [f64; 2] {
    [micro, -channel.offset].map(|v| v * MICROSTRAIN / channel.factor)
}
