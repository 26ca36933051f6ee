//! The command line: arguments in, one call of the application, exit code out. Nothing is decided here.

mod arguments;
mod demo;
mod explain;
mod interrupt;
mod manual;
#[cfg(feature = "open")]
mod open;
mod progress;
mod reporter;
mod run;
mod upkeep;

pub use arguments::*;

use crate::host::fault::Fault;
use crate::{job, workflow};
use clap::CommandFactory;
use reporter::print;
use run::Run;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The paths of a list in a file, or on standard input.
fn read_file_list(list: &Path) -> Result<Vec<PathBuf>, Fault> {
    let is_input = list == Path::new("-");
    let shown = match is_input {
        true => "standard input".to_owned(),
        false => list.display().to_string(),
    };
    let mut text = String::new();
    let read = match is_input {
        true => std::io::stdin().read_to_string(&mut text).map(drop),
        false => std::fs::read_to_string(list).map(|t| text = t),
    };
    read.map_err(|e| {
        let wrong = format!("the list cannot be read ({e})");
        Fault::new(
            &*shown,
            "--files",
            wrong,
            "name a text file with one path in each line",
        )
    })?;
    workflow::fleet::records::paths_of_list(&shown, &text)
}

/// Runs the command and returns the exit code: 0 done, 1 done with error findings, 2 bad input.
pub fn run(arguments: Arguments) -> ExitCode {
    interrupt::watch();
    match arguments.command {
        Command::Strains(a) => Run::from_arguments(&a.common, &a.deck).files(&a.deck, |cx| {
            workflow::strains::strains(&a.deck, &a.results, cx)
        }),
        Command::Check(a) => Run::from_arguments(&a.common, a.first_file()).check(&a.files),
        Command::Init(a) => Run::from_arguments(&a.common, a.main()).init(&a),
        Command::Cases(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::cases::cases)
        }
        Command::Place(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::place::place)
        }
        #[cfg(feature = "open")]
        Command::Open(a) => open::open(&a),
        Command::Calibrate(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::calibrate::calibrate)
        }
        Command::Recover(a) => Run::from_arguments(&a.common, &a.job).recover(&a.job),
        Command::Fleet(a) => {
            let run = Run::from_arguments(&a.common, &a.job);
            let folder = run.folder(&a.job);
            // Shards run at the same time. Each therefore writes its answer into a separate folder.
            let answer = match a.shard {
                Some(s) => folder.join(format!("shard-{}-of-{}", s.number, s.of)),
                None => folder.clone(),
            };
            let spec = workflow::fleet::FleetSpec {
                folder: a.kept.unwrap_or(folder),
                files: a.files,
                shard: a.shard,
                digests: a.digests.unwrap_or_default(),
            };
            run.job_into(&a.job, &answer, |job, cx| {
                let mut spec = spec;
                if let Some(list) = &a.list {
                    spec.files.extend(read_file_list(list)?);
                }
                workflow::fleet::fleet(job, &spec, cx)
            })
        }
        Command::Sensitivity(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::sensitivity::sensitivity)
        }
        Command::Ballast(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::ballast::ballast)
        }
        Command::Payload(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::payload::payload)
        }
        Command::Respond(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::respond::respond)
        }
        Command::Study(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::study::study)
        }
        Command::Demo(a) => {
            let run = Run::from_arguments(&a.common, demo::DECK_NAME.as_ref());
            let folder = a.common.out.clone().or(a.folder);
            let folder = folder.unwrap_or_else(|| demo::FOLDER.into());
            run.ask_into(&folder, |cx| demo::story(&folder, cx))
        }
        Command::Solve(a) => {
            let (run, options) = (Run::from_arguments(&a.job.common, &a.job.job), a.options());
            if a.is_job() {
                run.job(&a.job.job, |job, cx| {
                    workflow::solve::solve(job, options, cx)
                })
            } else {
                let deck = &a.job.job;
                run.files(deck, |cx| workflow::solve::solve_deck(deck, options, cx))
            }
        }
        Command::Modes(a) => Run::from_arguments(&a.common, &a.input).files(&a.input, |cx| match a
            .input
            .extension()
        {
            Some(e) if e.eq_ignore_ascii_case("toml") => {
                let job = job::Job::read(&a.input, cx.files)?;
                workflow::modes::modes(&job, a.modes, cx)
            }
            _ => workflow::modes::modes_of_deck(&a.input, a.modes, cx),
        }),
        Command::Reconcile(a) => {
            let run = Run::from_arguments(&a.common, &a.job);
            let folder = run.folder(&a.job);
            run.job_into(&a.job, &folder, |job, cx| {
                let mut found = workflow::reconcile::reconcile(job, cx)?;
                found.answer.put_into(&folder);
                Ok(found)
            })
        }
        Command::Identify(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::identify::identify)
        }
        Command::Simulate(a) => {
            Run::from_arguments(&a.common, &a.job).job(&a.job, workflow::simulate::simulate)
        }
        Command::Verify(a) => upkeep::verify(&a),
        Command::Cache(CacheArguments {
            task: CacheTask::Clean(a),
        })
        | Command::Clean(a) => upkeep::clean(&a),
        Command::Explain(a) => explain::explain(&a),
        Command::Man(a) => manual::man(&a),
        Command::Schema => print(job::schema::job_schema().as_bytes()),
        Command::Completions(a) => {
            let mut text = Vec::new();
            clap_complete::generate(
                a.shell,
                &mut Arguments::command(),
                "strainbridge",
                &mut text,
            );
            print(&text)
        }
    }
}
