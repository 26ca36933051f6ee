//! Files and words of `calibrate`.

use super::sensitivity::columns;
use super::{Report, mistake, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::csv_cell;
use crate::report::page::Page;
use crate::report::strain::{GLUED_COLUMNS, calibrate_page, glued_csv, sensitivity_csv};
use crate::strain_chain::covariance_bytes;
use crate::units::{MICROSTRAIN, Quantity};
use crate::workflow::calibrate::{Calibrated, CheckLoad, calibrated_job};
use std::fmt::Write as _;

/// The gauges where the runs say that they sit, as a table that a job can name.
const GLUED: &str = "gauges_as_glued.csv";

impl Report for Outcome<Calibrated> {
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
            out.declare(GLUED, GLUED_COLUMNS.map(|(c, u)| (c, unit(u))));
            out.write(GLUED, |w| {
                glued_csv(w, &self.job, &self.calibration.gauges, &self.glued)
            })?;
        }
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let page = calibrate_page(&self.job.title, self, &self.findings);
        Some(page)
    }

    fn words(&self) -> String {
        let c = &self.calibration;
        let prior = match c.prior {
            "model" => "with the model's S",
            _ => "without a model",
        };
        let mut text = format!(
            "S of {} gauges and {} loads from {} runs, {prior}\n",
            self.sensitivity.gauges.len(),
            self.sensitivity.loads.len(),
            c.runs
        );
        if let Some(scatter) = c.repeat_scatter_rel {
            let _ = writeln!(
                text,
                "repeats scatter by {:.1} % of the strain, noise makes {:.2} %",
                100.0 * scatter,
                100.0 * c.noise_rel
            );
        }
        let _ = writeln!(
            text,
            "left out one by one: {} of {} runs held, intervals times {:.2}",
            c.coverage.held, c.coverage.of, c.coverage.factor
        );
        if c.terms == "intercept" {
            let _ = writeln!(text, "with a common zero of each gauge: common_zero.csv");
        }
        if !c.checks.is_empty() {
            let inside = c.checks.iter().filter(|l| l.inside).count();
            let _ = writeln!(
                text,
                "check loads: {inside} of {} within their 95 % intervals (check_loads.csv)",
                c.checks.len()
            );
        }
        if !self.glued.is_empty() {
            let _ = writeln!(
                text,
                "gauges as glued: {GLUED}, a table for [gauges] of a job"
            );
        }
        if let Some(n) = &c.next_run {
            let loads: Vec<String> = n
                .loads
                .iter()
                .filter(|(_, v)| **v != 0.0)
                .map(|(k, v)| format!("{k} {v:.4}"))
                .collect();
            let _ = writeln!(
                text,
                "next run worth making: {} ({}: sigma of {:.3} becomes {:.3} {})",
                loads.join(", "),
                n.load,
                n.sigma_before,
                n.sigma_after,
                n.unit
            );
        }
        text
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
