//! A job's text, and the same job written into another folder.

use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::Job;
use std::path::Path;
use toml::{Table, Value};

/// Returns the original text of the job.
///
/// # Errors
/// A file that can't be read.
pub(crate) fn text_of(work: &mut Work, job: &Job) -> Result<String, Faults> {
    work.inputs
        .read_text(Path::new(""), &job.file)
        .map_err(Faults::from)
}

/// Makes every file name of the job relative to the output folder.
pub(crate) fn redirect(table: &mut Table, prefix: &str) {
    const FILE_KEYS: [&str; 11] = [
        "common_zero",
        "covariance",
        "file",
        "deck",
        "strain",
        "zero",
        "data",
        "loads",
        "result",
        "results",
        "signature",
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_a_job_is_found_from_the_folder_of_its_answer() {
        let mut job: Table = "[model]\ndeck = \"a.bdf\"\nresults = [\"a.op2\"]\n\
             [[reconcile.effect]]\nid = \"bracket\"\nsignature = \"bracket.csv\"\n\
             [candidates]\nfile = \"picked.toml\"\n"
            .parse()
            .unwrap();
        redirect(&mut job, "..");
        let text = toml::to_string(&job).unwrap();
        for name in ["a.bdf", "a.op2", "bracket.csv", "picked.toml"] {
            assert!(text.contains(&format!("\"../{name}\"")), "{text}");
        }
        assert!(text.contains("id = \"bracket\""));
    }
}
