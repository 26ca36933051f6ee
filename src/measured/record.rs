//! A record of any length, a piece at a time: readings, and the loads that a filter makes of them.

use super::conditioning_step::ConditioningStep;
use super::faults::record_fault;
use super::gauge_columns::{StrainColumn, find_gauge_columns};
use crate::finding::Finding;
use crate::host::fault::{Fault, Faults};
use crate::host::files::FileBytes;
use crate::job::correct::{Channel, channel_of, column_of};
use crate::job::{Job, SectionExtent};
use crate::recovery::clock;
use crate::recovery::dead_gauges::DeadGaugeSpan;
use crate::recovery::net::Series;
use crate::recovery::reading_plausibility::LARGEST_STRAIN;
use crate::series::SeriesError;
use crate::series::constant_columns::{self, ColumnContents, Gives};
use crate::series::record::{self as series, Clock, Column, Options, Times, open_record};
use crate::units::MICROSTRAIN;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;

/// Largest number of readings of a record, and of their errors, that are kept in memory: 0.8 GB.
pub(crate) const MOST_NUMBERS: usize = 100_000_000;

/// A record whose columns are read as strain.
#[derive(Clone)]
pub(crate) struct Record {
    inner: Arc<series::Record>,
    file: String,
    /// Gauge of each column, as the job names it.
    pub names: Vec<String>,
    /// Microstrain in one unit of each column; not a number where it is no strain.
    micro: Vec<f64>,
    /// Columns that are read, and what puts their readings right.
    columns: Vec<(Option<usize>, Channel)>,
    /// Readings that are treated as missing: column and samples.
    blank: Vec<(usize, Range<usize>)>,
    /// Changes of the readings by `[conditioning]`, which follows the corrections; `None` for a record without it.
    conditioning: Option<Vec<ConditioningStep>>,
    /// The record of the file and its columns before `[conditioning]`; `None` for a record without it.
    before: Option<(Arc<series::Record>, Vec<String>)>,
    /// Times of the samples, as the file states them.
    clock: Clock,
}

/// Channels that the rules of sections name.
pub(crate) fn section_channels(job: &Job) -> impl Iterator<Item = String> + '_ {
    let rules = job.sections.iter().filter_map(|s| match &s.extent {
        SectionExtent::Within(rule) => Some(&rule.ranges),
        SectionExtent::Times(_) | SectionExtent::File(_) => None,
    });
    rules.flatten().map(|r| r.0.clone())
}

impl Record {
    /// Opens the record in a strain file of a job, to read the columns `wanted` and the channels `also`. `time_unit_s` is used if the file states no
    /// unit of time.
    ///
    /// # Errors
    /// Faults of the file: its format, its times, units that are not units of strain.
    pub fn open(
        job: &Job,
        (file, time_unit_s): (&str, Option<f64>),
        bytes: FileBytes,
        (wanted, also): (&[String], &[String]),
    ) -> Result<Self, Faults> {
        let mut options = Self::options(job, time_unit_s, wanted);
        if !wanted.is_empty() {
            options.wanted.extend_from_slice(also);
        }
        let inner = open_record(Arc::new(bytes), &options).map_err(|e| record_fault(file, &e))?;
        Self::from_series(job, file, inner, wanted)
    }

    /// Returns how a record of a job is opened, to read the columns `wanted` and the temperature of `[conditioning]`.
    pub fn options(job: &Job, time_unit_s: Option<f64>, wanted: &[String]) -> Options {
        let mut wanted = wanted.to_vec();
        let temperature = job
            .conditioning
            .as_ref()
            .and_then(|c| c.temperature.as_ref());
        if let Some(t) = temperature.filter(|_| !wanted.is_empty()) {
            wanted.push(t.channel.clone());
        }
        Options {
            declared_hz: None,
            time_unit_s,
            wanted,
        }
    }

    /// Returns the record of a job with the columns of an open record, to read the columns `wanted`.
    ///
    /// # Errors
    /// Units that are not units of strain.
    pub fn from_series(
        job: &Job,
        file: &str,
        inner: series::Record,
        wanted: &[String],
    ) -> Result<Self, Faults> {
        let columns = find_gauge_columns(file, inner.columns(), wanted)?;
        let gauge = |c: &StrainColumn| column_of(&job.corrections, &c.name).to_owned();
        let micro = |c: &StrainColumn| c.microstrain.unwrap_or(f64::NAN);
        Ok(Self {
            names: columns.iter().map(gauge).collect(),
            file: file.to_owned(),
            micro: columns.iter().map(micro).collect(),
            columns: Vec::new(),
            blank: Vec::new(),
            conditioning: None,
            before: None,
            clock: inner.clock.clone(),
            inner: Arc::new(inner),
        })
    }

    /// Returns the record with only these columns. Conditioned readings are corrected already.
    pub fn with_columns(self, mut columns: Vec<(Option<usize>, Channel)>) -> Self {
        if self.conditioning.is_some() {
            for (_, channel) in &mut columns {
                *channel = Channel {
                    ignore: channel.ignore,
                    ..Channel::without_correction()
                };
            }
        }
        Self { columns, ..self }
    }

    /// Returns the record with all columns of strain read, except the columns of the job's reserved gauges.
    pub fn with_all_strain(self, job: &Job) -> Self {
        let is_read =
            |c: &usize| !self.micro[*c].is_nan() && !job.reserved.contains(&self.names[*c]);
        let columns = (0..self.names.len()).filter(is_read);
        let columns = columns.map(|c| (Some(c), channel_of(&job.corrections, &self.names[c])));
        let columns = columns.collect();
        self.with_columns(columns)
    }

    /// Returns the record with the columns `wanted`, corrected. If `wanted` is empty, it contains all columns of strain.
    pub fn with_wanted_strain(self, job: &Job, wanted: &[String]) -> Self {
        let is_read = |c: &usize| {
            let name = column_of(&job.corrections, &self.names[*c]);
            let asked = wanted.is_empty() || wanted.iter().any(|w| w == name);
            asked
                && !self.micro[*c].is_nan()
                && !channel_of(&job.corrections, &self.names[*c]).ignore
        };
        let columns = (0..self.names.len()).filter(is_read);
        let columns = columns.map(|c| (Some(c), channel_of(&job.corrections, &self.names[c])));
        let columns = columns.collect();
        self.with_columns(columns)
    }

    /// Returns the record with conditioned readings, strain, one column for each column that is read. The result does not contain the column
    /// `except`.
    ///
    /// # Errors
    /// A record without samples.
    pub fn with_conditioned_readings(
        &self,
        readings: Vec<Vec<f64>>,
        times: (f64, f64),
        (conditioning, except): (Vec<ConditioningStep>, Option<&str>),
    ) -> Result<Self, Faults> {
        let mut names = self.names_read();
        let mut record = self.with_readings(readings, times)?;
        // Columns that are not read keep their names, so that columns without a gauge are reported.
        let others = self
            .names
            .iter()
            .filter(|n| !names.contains(n) && Some(n.as_str()) != except);
        let others: Vec<String> = others.cloned().collect();
        record.micro.resize(names.len() + others.len(), f64::NAN);
        names.extend(others);
        Ok(Self {
            names,
            conditioning: Some(conditioning),
            before: Some((Arc::clone(&self.inner), self.names.clone())),
            ..record
        })
    }

    /// Returns the columns of the file, or of the conditioned readings, microstrain, named after their gauges.
    pub fn into_series(self) -> Arc<series::Record> {
        self.inner
    }

    /// Returns the change of the readings by `[conditioning]`.
    pub fn conditioning_steps(&self) -> &[ConditioningStep] {
        self.conditioning.as_deref().unwrap_or_default()
    }

    /// Returns the unit of a column as the file states it; `None` if no column has the name.
    pub fn unit_of(&self, name: &str) -> Option<&str> {
        let (file, names) = self.file_columns();
        let column = names.iter().position(|n| n == name)?;
        file.columns().get(column).map(|c| c.unit.as_str())
    }

    /// Returns the numbers of a column as the file contains them; `None` if no column has the name.
    pub fn raw_column(&self, name: &str) -> Option<Result<Vec<f64>, SeriesError>> {
        let (file, names) = self.file_columns();
        let column = names.iter().position(|n| n == name)?;
        let mut out = Vec::with_capacity(self.clock().samples);
        for i in 0..file.n_pieces() {
            let read = file.read(i, &[Some(column)], &mut |block| {
                out.extend_from_slice(block.values);
                ControlFlow::Continue(())
            });
            if let Err(e) = read {
                return Some(Err(e));
            }
        }
        Some(Ok(out))
    }

    /// The record of the file and the names of its columns. Conditioned readings are in memory, and the file contains all other channels.
    fn file_columns(&self) -> (&series::Record, &[String]) {
        match &self.before {
            Some((inner, names)) => (inner, names),
            None => (&self.inner, &self.names),
        }
    }

    /// Returns the gauges whose columns are read.
    pub fn names_read(&self) -> Vec<String> {
        let read = self.columns.iter().filter_map(|c| self.names.get(c.0?));
        read.cloned().collect()
    }

    /// Returns sums over all samples, microstrain, by column that is read.
    ///
    /// # Errors
    /// A piece that can't be read.
    pub fn sums(&self) -> Result<Vec<Series>, Fault> {
        let mut sums = vec![Series::default(); self.columns.len()];
        for i in 0..self.n_pieces() {
            self.each_microstrain(i, |_, values| {
                for row in values.chunks_exact(self.columns.len().max(1)) {
                    sums.iter_mut().zip(row).for_each(|(s, v)| s.add(*v));
                }
            })?;
        }
        Ok(sums)
    }

    /// Returns the first samples of the columns, microstrain, row by row. It returns at most `most` samples, and at most the first piece.
    ///
    /// # Errors
    /// A piece that can't be read.
    pub fn first_microstrain(&self, most: usize) -> Result<Vec<f64>, Fault> {
        let mut out = Vec::new();
        if self.n_pieces() > 0 {
            self.each_microstrain(0, |_, values| out.extend_from_slice(values))?;
        }
        out.truncate(most * self.columns.len());
        Ok(out)
    }

    /// Returns the record with blank readings in these spans: number of the column, and samples.
    pub fn with_blank_readings(self, blank: Vec<(usize, Range<usize>)>) -> Self {
        Self { blank, ..self }
    }

    /// Returns the samples of a part in which a gauge is dead. The gauge is stated by the number of its column.
    ///
    /// # Errors
    /// A piece that can't be read.
    pub fn extent(&self, stuck: &DeadGaugeSpan) -> Result<Range<usize>, Fault> {
        let column = self.columns.get(stuck.gauge).and_then(|c| c.0);
        let found =
            constant_columns::extent(&self.inner, column, stuck.gives, stuck.span, stuck.within);
        found.map_err(|e| record_fault(&self.file, &e))
    }

    /// Returns the content of each gauge's column in all of the record, of which the rows in `looked` are a part.
    ///
    /// # Errors
    /// A piece that can't be read.
    pub fn column_contents(&self, looked: &ColumnContents) -> Result<Vec<Gives>, Fault> {
        let columns: Vec<Option<usize>> = self.columns.iter().map(|c| c.0).collect();
        let found = looked.columns_in_record(&self.inner, &columns);
        found.map_err(|e| record_fault(&self.file, &e))
    }

    /// Returns the readings of every column that is read, strain, a column each.
    ///
    /// # Errors
    /// A piece that can't be read.
    pub fn columns(&self) -> Result<Vec<Vec<f64>>, Fault> {
        let n = self.columns.len();
        let mut out = vec![Vec::with_capacity(self.clock().samples); n];
        for i in 0..self.n_pieces() {
            self.each_strain_block(i, |strain| {
                for row in strain.chunks_exact(n.max(1)) {
                    out.iter_mut().zip(row).for_each(|(c, v)| c.push(*v));
                }
            })?;
        }
        Ok(out)
    }

    /// Returns this record with other readings, strain, one column for each gauge. The pair contains the time of the first sample and the time step,
    /// s.
    ///
    /// # Errors
    /// A record without samples.
    pub fn with_readings(
        &self,
        mut readings: Vec<Vec<f64>>,
        (start_s, step_s): (f64, f64),
    ) -> Result<Self, Fault> {
        readings
            .iter_mut()
            .flatten()
            .for_each(|v| *v /= MICROSTRAIN);
        let n = readings.len();
        let whole = series::MemoryRecord {
            columns: (self.names_read().iter())
                .map(|name| Column::of_channel(name, "um/m"))
                .collect(),
            times: Times::Even {
                start_s,
                step_s,
                samples: readings.first().map_or(0, Vec::len),
                unit_stated: !self.is_time_unit_open(),
            },
            samples: readings,
            stored: Vec::new(),
            others: Vec::new(),
        };
        let inner = series::Record::new(Box::new(whole), None, None)
            .map_err(|e| record_fault(&self.file, &e))?;
        let as_it_is = Channel::without_correction();
        Ok(Self {
            inner: Arc::new(inner),
            file: self.file.clone(),
            names: self.names.clone(),
            micro: vec![1.0; n],
            columns: (0..n).map(|c| (Some(c), as_it_is)).collect(),
            before: self.before.clone(),
            blank: Vec::new(),
            conditioning: self.conditioning.clone(),
            clock: self.clock.clone(),
        })
    }

    /// Returns the number of the first sample of a piece.
    pub fn first_of(&self, piece: usize) -> usize {
        self.inner.span(piece).0
    }

    /// Returns the time of a sample, s.
    pub fn time_s(&self, sample: usize) -> f64 {
        self.clock.time_s(sample)
    }

    /// Returns the times of the samples.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Returns the time of the first sample and between samples, s.
    pub fn first_and_step(&self) -> (f64, f64) {
        let clock = self.clock();
        (clock.start_s, 1.0 / clock.rate_hz)
    }

    /// Returns whether the unit of the times is unknown: neither file nor job states it, and the size of the times does not show it.
    pub fn is_time_unit_open(&self) -> bool {
        !self.inner.is_time_unit_stated()
    }

    pub fn file(&self) -> &str {
        &self.file
    }

    pub fn n_pieces(&self) -> usize {
        self.inner.n_pieces()
    }

    pub fn n_columns(&self) -> usize {
        self.columns.len()
    }

    /// Passes the readings of a piece, as strain, to `sink`, block by block.
    ///
    /// # Errors
    /// A piece that can't be read.
    pub fn each_strain_block(&self, i: usize, mut sink: impl FnMut(&[f64])) -> Result<(), Fault> {
        let n = self.columns.len().max(1);
        self.each_microstrain(i, |first, values| {
            values.iter_mut().for_each(|v| *v *= MICROSTRAIN);
            constant_columns::blank_readings(values, n, first, &self.blank);
            sink(values);
        })
    }

    /// Hands the readings of a piece on, microstrain, a block at a time with the number of its first sample.
    fn each_microstrain(
        &self,
        i: usize,
        mut sink: impl FnMut(usize, &mut [f64]),
    ) -> Result<(), Fault> {
        let n = self.columns.len().max(1);
        let columns: Vec<Option<usize>> = self.columns.iter().map(|c| c.0).collect();
        let micro_of = |c: &Option<usize>| c.and_then(|c| self.micro.get(c)).copied();
        let right: Vec<(f64, Channel)> = self
            .columns
            .iter()
            .map(|(c, channel)| (micro_of(c).unwrap_or(f64::NAN), *channel))
            .collect();
        let mut strain = Vec::new();
        let read = self.inner.read(i, &columns, &mut |block| {
            strain.clear();
            for row in block.values.chunks_exact(n) {
                let put_right = |(v, (micro, c)): (&f64, &(f64, Channel))| c.put_right(v * micro);
                strain.extend(row.iter().zip(&right).map(put_right));
            }
            sink(block.first, &mut strain);
            ControlFlow::Continue(())
        });
        read.map_err(|e| record_fault(&self.file, &e))
    }

    /// Returns the times, s, and readings of a piece, strain.
    pub fn piece(&self, i: usize) -> Result<(Vec<f64>, Vec<f64>), Fault> {
        let mut values = Vec::new();
        self.each_strain_block(i, |strain| values.extend_from_slice(strain))?;
        Ok((self.times(i), values))
    }

    /// Returns the number of readings of a piece that are too large to be strain after subtraction of `zero`.
    pub fn count_impossible_readings(&self, i: usize, zero: &[f64]) -> Result<u64, Fault> {
        let mut n = 0;
        self.each_strain_block(i, |strain| {
            for row in strain.chunks_exact(zero.len().max(1)) {
                let large = |(v, z): &(&f64, &f64)| (**v - **z).abs() > LARGEST_STRAIN;
                n += row.iter().zip(zero).filter(large).count() as u64;
            }
        })?;
        Ok(n)
    }

    pub fn times(&self, i: usize) -> Vec<f64> {
        let (from, to) = self.inner.span(i);
        (from..to).map(|s| self.time_s(s)).collect()
    }

    /// Returns the findings on the times of the record.
    pub fn findings(&self) -> Vec<Finding> {
        clock::check_time_steps(&self.file, self.clock())
    }
}
