//! A copy of the job that the effects go into.

use super::relative::relative;
use super::words::Sized;
use crate::app::Session;
use crate::app::fault::{Fault, Faults};
use crate::app::job::Job;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// The job as a table, the files it names found from the output folder.
pub(super) struct ExtendedJob {
    /// What is changed.
    pub table: Table,
    folder: PathBuf,
}

impl ExtendedJob {
    /// The job of `path`, titled after the effects.
    pub(super) fn of(
        job: &Job,
        path: &Path,
        session: &mut Session,
        ids: &[&str],
    ) -> Result<Self, Faults> {
        let text = session
            .inputs
            .read_text(Path::new(""), &job.file)
            .map_err(Faults::from)?;
        let mut table: Table = text.parse().map_err(|e: toml::de::Error| {
            Faults::from(Fault::of(
                &*job.file,
                "job",
                e.to_string(),
                "write valid TOML",
            ))
        })?;
        let folder = session.output_for(path)?.folder().to_owned();
        redirect(&mut table, &relative(&folder, &job.folder));
        let title = table.get("title").and_then(Value::as_str);
        let title = format!("{}, with {}", title.unwrap_or("job"), ids.join(" and "));
        table.insert("title".into(), Value::String(title));
        Ok(Self { table, folder })
    }

    /// Writes it as `name` beside the results, the effects in its head; its path, relative to the folder the command was called in.
    pub(super) fn write<'a>(
        self,
        name: &str,
        path: &Path,
        session: &mut Session,
        effects: impl Iterator<Item = Sized<'a>>,
    ) -> Result<String, Faults> {
        let mut text =
            String::from("# The job with the named effects in it; `size` and `sigma` as found.\n");
        for e in effects {
            text.push_str(&format!("# {}\n", e.in_words()));
        }
        let body = toml::to_string(&self.table).map_err(|e| {
            Faults::from(Fault::of(
                name,
                "job",
                e.to_string(),
                "report this as an error of the program",
            ))
        })?;
        text.push_str(&body);
        session
            .output_for(path)?
            .write_bytes(name, text.as_bytes())
            .map_err(Faults::from)?;
        let path = self.folder.join(name);
        Ok(path.display().to_string().replace('\\', "/"))
    }
}

/// Makes every file name of the job relative to the output folder.
pub(in crate::app) fn redirect(table: &mut Table, prefix: &str) {
    const FILE_KEYS: [&str; 9] = [
        "covariance",
        "file",
        "deck",
        "strain",
        "zero",
        "data",
        "loads",
        "result",
        "results",
    ];
    let join = |name: &str| {
        if Path::new(name).is_absolute() {
            name.to_owned()
        } else {
            format!("{prefix}/{name}")
        }
    };
    for (key, value) in table.iter_mut() {
        match value {
            Value::String(s) if FILE_KEYS.contains(&key.as_str()) => *s = join(s.as_str()),
            Value::String(s) if key == "hold_out" => *s = join(s.as_str()),
            Value::Array(items) if key == "results" => {
                for item in items.iter_mut() {
                    if let Value::String(s) = item {
                        *s = join(s.as_str());
                    }
                }
            }
            Value::Array(items) => items.iter_mut().for_each(|i| {
                if let Value::Table(t) = i {
                    redirect(t, prefix);
                }
            }),
            Value::Table(t) if key == "signatures" || key == "rail_stiffness" => {
                redirect_all(t, &join)
            }
            Value::Table(t) if key != "columns" => redirect(t, prefix),
            _ => {}
        }
    }
}

fn redirect_all(table: &mut Table, join: &dyn Fn(&str) -> String) {
    for (_, value) in table.iter_mut() {
        match value {
            Value::String(s) => *s = join(s.as_str()),
            Value::Table(t) => redirect_all(t, join),
            _ => {}
        }
    }
}
