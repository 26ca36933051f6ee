//! Files and words of `sensitivity`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::host::words::counted;
use crate::job::Job;
use crate::report::page::Page;
use crate::report::scene::scene_of_job;
use crate::report::strain::{sensitivity_csv, sensitivity_page};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::load_units;
use crate::workflow::sensitivity::Sensed;

impl Report for Outcome<Sensed> {
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

    fn words(&self) -> String {
        let s = &self.prepared.sensitivity;
        format!(
            "S: {} x {}, rank {}, condition number {:.4} in job units, {:.4} scaled\n",
            counted(s.gauges.len(), "gauge"),
            counted(s.loads.len(), "load"),
            s.rank(),
            s.condition_number(),
            s.condition_number_scaled()
        )
    }
}

/// Columns of sensitivity.csv with their units: microstrain per job unit of the load.
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
