//! A copy of the job that the effects go into.

use super::answer::Reconciliation;
use super::folder_paths::relative_path;
use super::redirect::redirect;
use super::words::effect_in_words;
use super::{motion_job, strain_job};
use crate::host::fault::{Fault, Faults};
use std::path::Path;
use toml::{Table, Value};

/// Returns the job with the named effects for folder `out`, with the effects in its title and its head; `None` without an extended model. Its file
/// names are relative to `out`. Files that the effects change are in `out`.
///
/// # Errors
/// A job that is no TOML, which is a mistake of the program.
pub fn extended_job(answer: &Reconciliation, out: &Path) -> Result<Option<String>, Faults> {
    let Some(extended) = &answer.extended_model else {
        return Ok(None);
    };
    let job = &answer.job;
    let mut table: Table = extended.job_text.parse().map_err(|e: toml::de::Error| {
        Faults::from(Fault::new(
            &*job.file,
            "job",
            e.to_string(),
            "write valid TOML",
        ))
    })?;
    redirect(&mut table, &relative_path(out, &job.folder));
    let title = table.get("title").and_then(Value::as_str).unwrap_or("job");
    let title = format!("{title}, with {}", answer.named.join(" and "));
    table.insert("title".into(), Value::String(title));
    if let Some(strain) = &answer.strain {
        strain_job::edit(&mut table, job, strain, extended);
    }
    if let Some(motion) = &answer.motion
        && let Some(Value::Table(section)) = table.get_mut("vehicle")
    {
        motion_job::edit(section, &motion.frame, &motion.outcome);
    }
    let body = toml::to_string(&table).map_err(|e| {
        Faults::from(Fault::new(
            extended.name,
            "job",
            e.to_string(),
            "report this as an error of the program",
        ))
    })?;
    let mut text =
        String::from("# The job with the identified effects; `size` and `sigma` as found.\n");
    for e in &answer.effects {
        text.push_str(&format!("# {}\n", effect_in_words(e)));
    }
    for r in answer.rivals.iter().filter(|r| r.indistinguishable) {
        text.push_str(&format!(
            "# {} fits the data equally well and is not included. Separate the two before you recover other load cases.\n",
            r.id
        ));
    }
    Ok(Some(text + &body))
}
