//! Report files and console output of `calibrate`.

use super::sensitivity::columns;
use super::{Report, mistake, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::page::{KeyNumber, Page};
use crate::report::strain::{
    GLUED_COLUMNS, calibrate_page, sensitivity_csv, write_installed_positions,
};
use crate::strain_chain::covariance_bytes;
use crate::units::{MICROSTRAIN, Quantity, half_width, number, percent};
use crate::workflow::calibrate::{CalibratedSensitivity, CheckLoad, LeftOutLoad, calibrated_job};

/// Table of the gauges at their installed positions, as determined from the runs. A job can name it as its gauges.
const INSTALLED_GAUGES_FILE: &str = "gauges_as_glued.csv";

impl Report for Outcome<CalibratedSensitivity> {
    const FILES: &'static [&'static str] = &[
        "result.json",
        "report.html",
        "sensitivity.csv",
        "calibration.bin",
        "calibrated.toml",
        "left_out.csv",
        "coefficients.csv",
    ];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let s = &self.sensitivity;
        out.declare("sensitivity.csv", columns(&self.job, s));
        out.write("sensitivity.csv", |w| sensitivity_csv(w, s))?;
        let bytes = covariance_bytes(s)
            .ok_or_else(|| mistake("calibration.bin", &"S has no covariance"))?;
        out.write_bytes("calibration.bin", &bytes)?;
        let text = calibrated_job(self, out.folder())?;
        out.write_bytes("calibrated.toml", text.as_bytes())?;
        out.declare(
            "left_out.csv",
            [
                ("run", ""),
                ("load", ""),
                ("known", ""),
                ("value", ""),
                ("sigma", ""),
                ("unit", ""),
                ("low", ""),
                ("high", ""),
            ],
        );
        out.write("left_out.csv", |w| {
            writeln!(w, "run,load,known,value,sigma,unit,low,high")?;
            for r in &self.calibration.left_out {
                for l in &r.loads {
                    writeln!(
                        w,
                        "{},{},{},{},{},{},{},{}",
                        csv_cell(&r.run),
                        csv_cell(&l.name),
                        l.known.map_or_else(String::new, |k| k.to_string()),
                        l.value,
                        l.sigma,
                        csv_cell(&l.unit),
                        l.low,
                        l.high
                    )?;
                }
            }
            Ok(())
        })?;
        let halves = s.half_widths();
        out.declare(
            "coefficients.csv",
            [
                ("gauge", ""),
                ("load", ""),
                ("value", ""),
                ("half_width", ""),
                ("unit", ""),
            ],
        );
        out.write("coefficients.csv", |w| {
            writeln!(w, "gauge,load,value,half_width,unit")?;
            for (g, gauge) in s.gauges.iter().enumerate() {
                for (l, load) in s.loads.iter().enumerate() {
                    let [value, half] = [s.values[(g, l)], halves[(g, l)]].map(|v| v / MICROSTRAIN);
                    let (gauge, name) = (csv_cell(gauge), csv_cell(&load.name));
                    writeln!(w, "{gauge},{name},{value},{half},microstrain per job unit")?;
                }
            }
            Ok(())
        })?;
        if !self.found.common_zero.is_empty() {
            out.declare(
                "common_zero.csv",
                [("gauge", ""), ("common_zero", "microstrain")],
            );
            out.write("common_zero.csv", |w| {
                writeln!(w, "gauge,common_zero")?;
                for (gauge, zero) in s.gauges.iter().zip(&self.found.common_zero) {
                    writeln!(w, "{},{}", csv_cell(gauge), zero / MICROSTRAIN)?;
                }
                Ok(())
            })?;
        }
        if !self.calibration.checks.is_empty() {
            write_checks(out, &self.calibration.checks)?;
        }
        if !self.glued.is_empty() {
            let length = self.job.units.unit(Quantity::Length).name;
            let unit = |u: &'static str| if u == "L" { length } else { u };
            out.declare(
                INSTALLED_GAUGES_FILE,
                GLUED_COLUMNS.map(|(c, u)| (c, unit(u))),
            );
            out.write(INSTALLED_GAUGES_FILE, |w| {
                write_installed_positions(w, &self.job, &self.calibration.gauges, &self.glued)
            })?;
        }
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let page = calibrate_page(&self.job.title, self, &self.findings);
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let c = &self.calibration;
        let mut numbers = vec![
            KeyNumber::new(
                format!("{} of {}", c.coverage.held, c.coverage.of),
                "left-out runs within their 95 % intervals",
            ),
            KeyNumber::new(c.runs.to_string(), "calibration runs"),
        ];
        let scatter = c
            .repeat_scatter_rel
            .map(|v| KeyNumber::new(percent(v), "scatter between repeats"));
        numbers.extend(scatter);
        numbers.push(KeyNumber::new(percent(c.noise_rel), "noise, of the strain"));
        let changed = c.gauges.iter().filter(|g| g.looks_like != "none").count();
        numbers.push(KeyNumber::new(
            format!("{changed} of {}", c.gauges.len()),
            "gauges deviate from the model",
        ));
        numbers
    }

    fn console(&self) -> Console {
        let left_out = &self.calibration.left_out;
        let first = left_out.first().map_or(&[][..], |r| &r.loads);
        let row = |(l, load): (usize, &LeftOutLoad)| {
            let of_load = || left_out.iter().filter_map(|r| r.loads.get(l));
            let errors: Vec<f64> = of_load().filter_map(|o| Some(o.value - o.known?)).collect();
            let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
            let half = of_load().map(|o| (o.high - o.low) / 2.0);
            vec![
                load.name.clone(),
                number(mean.sqrt()),
                half_width(half.fold(f64::NAN, f64::max)),
                load.unit.clone(),
            ]
        };
        let rows: Vec<Vec<String>> = first.iter().enumerate().map(row).collect();
        let head = ["load", "error rms", "widest ± 95 %", "unit"];
        let table = ConsoleTable::new("Loads of runs left out one by one", &head, rows);
        let short = |row: &Vec<String>| {
            let [name, error, half, unit] = row.as_slice() else {
                return row.clone();
            };
            vec![name.clone(), format!("{error} ({half}) {unit}")]
        };
        let rows = table.rows.iter().map(short).collect();
        let title =
            "Loads of runs left out one by one: error rms (widest half width of the 95 % interval)";
        let compact = ConsoleTable::new(title, &[], rows);
        Console::new(table, Some("left_out.csv"))
            .or(compact)
            .next("run `strainbridge recover calibrated.toml` in the folder of this result")
    }
}

/// Check loads, a row each.
fn write_checks(out: &mut Output, checks: &[CheckLoad]) -> Result<(), Faults> {
    out.declare(
        "check_loads.csv",
        [
            ("run", ""),
            ("load", ""),
            ("applied", ""),
            ("recovered", ""),
            ("low", ""),
            ("high", ""),
            ("unit", ""),
            ("inside", ""),
        ],
    );
    out.write("check_loads.csv", |w| {
        writeln!(w, "run,load,applied,recovered,low,high,unit,inside")?;
        for c in checks {
            let names = [&c.run, &c.load, &c.unit].map(|n| csv_cell(n));
            let [run, load, unit] = names;
            let numbers = format!("{},{},{},{}", c.applied, c.recovered, c.low, c.high);
            writeln!(w, "{run},{load},{numbers},{unit},{}", c.inside)?;
        }
        Ok(())
    })?;
    Ok(())
}
