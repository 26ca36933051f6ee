//! Report files and console output of `sensitivity`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::job::Job;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page};
use crate::report::scene::scene_of_job;
use crate::report::strain::{sensitivity_csv, sensitivity_page};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::load_units;
use crate::units::{MICROSTRAIN, number};
use crate::workflow::sensitivity::ComputedSensitivity;

impl Report for Outcome<ComputedSensitivity> {
    const FILES: &'static [&'static str] = &["result.json", "report.html", "sensitivity.csv"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let s = &self.prepared.sensitivity;
        out.declare("sensitivity.csv", columns(&self.job, s));
        out.write("sensitivity.csv", |w| sensitivity_csv(w, s))?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let s = &self.prepared.sensitivity;
        let scene = scene_of_job(&self.job, &self.prepared);
        let page = sensitivity_page(&self.job.title, s, scene.as_ref(), &self.findings);
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let c = &self.conditioning;
        let scaled = c.condition_number_scaled.map_or("∞".to_owned(), number);
        vec![
            KeyNumber::new(self.gauges.to_string(), "gauges or candidates"),
            KeyNumber::new(self.loads.len().to_string(), "loads"),
            KeyNumber::new(format!("{} of {}", c.rank, self.loads.len()), "rank"),
            KeyNumber::new(
                scaled,
                "scaled condition number; below 50 the loads separate well",
            ),
        ]
    }

    fn result_table(&self) -> ConsoleTable {
        let s = &self.prepared.sensitivity;
        let of_job = |l: usize| self.report_units_of_loads.get(l).map_or("", String::as_str);
        let row = |(l, name): (usize, &String)| {
            let column = (0..s.gauges.len()).map(|g| 1e6 * s.values[(g, l)]);
            let (gauge, most) = column.enumerate().fold((0, 0.0_f64), |best, (g, v)| {
                match v.abs() > best.1.abs() {
                    true => (g, v),
                    false => best,
                }
            });
            let at = s.gauges.get(gauge).cloned().unwrap_or_default();
            vec![name.clone(), number(most), at, of_job(l).to_owned()]
        };
        let rows = self.loads.iter().enumerate().map(row).collect();
        let head = ["load", "µε per job unit", "at gauge", "report unit"];
        ConsoleTable::new("Largest sensitivity by load", &head, rows)
    }

    fn console(&self) -> Console {
        let s = &self.prepared.sensitivity;
        let units = columns(&self.job, s);
        let row = |(l, (name, unit)): (usize, &(String, String))| {
            let of_gauge = |g: usize| s.values[(g, l)];
            let larger = |a: &usize, b: &usize| of_gauge(*a).abs().total_cmp(&of_gauge(*b).abs());
            let most = (0..s.gauges.len()).max_by(larger);
            let value = most.map_or(f64::NAN, of_gauge) / MICROSTRAIN;
            let gauge = most.and_then(|g| s.gauges.get(g)).cloned();
            let gauge = gauge.unwrap_or_default();
            vec![name.clone(), number(value), unit.clone(), gauge]
        };
        // The first column names the gauge.
        let rows: Vec<Vec<String>> = units.iter().skip(1).enumerate().map(row).collect();
        let short = |r: &Vec<String>| r.iter().take(2).cloned().collect();
        let compact = rows.iter().map(short).collect();
        let head = ["load", "largest", "unit", "gauge"];
        let table = ConsoleTable::new("Largest sensitivity to each load", &head, rows);
        let title = "Largest sensitivity to each load, units in sensitivity.csv";
        let compact = ConsoleTable::new(title, &["load", "largest"], compact);
        let command = match self.job.measured {
            Some(_) => "recover",
            None => "place",
        };
        let next = format!("run `strainbridge {command} {}`", self.job.file);
        Console::new(table, Some("sensitivity.csv"))
            .or(compact)
            .next(next)
    }
}

/// Returns the columns of sensitivity.csv with their units: microstrain per job unit of the load.
pub(super) fn columns(job: &Job, s: &Sensitivity) -> Vec<(String, String)> {
    let names: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    let units = load_units(job, &names).into_iter().map(|u| {
        if u.of_job.is_empty() {
            "microstrain".to_owned()
        } else {
            format!("microstrain/({})", u.of_job)
        }
    });
    let gauge = ("gauge".to_owned(), String::new());
    std::iter::once(gauge)
        .chain(names.iter().cloned().zip(units))
        .collect()
}
