//! `demo`: the truck story in a folder. Solve, place, glue and drive (made up here), recover, reconcile, recover again, weigh the payload,
//! stress, report.

mod chapter;
mod jobs;
mod page;
mod yard;

pub(super) use chapter::DECK_NAME;

use super::DemoArguments;
use super::run::recover_and_save;
use crate::app::context::Context;
use crate::app::fault::{Fault, Faults};
use crate::app::job::Job;
use crate::app::outcome::{Answer, Outcome};
use crate::app::{self, Closed, CommonArguments, JobArguments, Session};
use crate::fe::SolveOptions;
use crate::report::command::{Report, save};
use chapter::{Chapter, DECK};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Where the story goes if nobody says.
const FOLDER: &str = "strainbridge-demo";

/// Plays the story.
pub fn run(arguments: &DemoArguments, cx: &Context) -> Result<Closed, Faults> {
    Session::run("demo", &CommonArguments::default(), cx, |s| {
        story(arguments, s)
    })
}

fn story(arguments: &DemoArguments, session: &mut Session) -> Result<(), Faults> {
    let folder = arguments
        .common
        .out
        .clone()
        .or_else(|| arguments.folder.clone())
        .unwrap_or_else(|| PathBuf::from(FOLDER));
    session.put_units(crate::units::UnitSystem::MmTS, &jobs::report_units());
    // The first write makes the folder.
    session.output_at(&folder)?;
    let write = |name: &str, text: &str| -> Result<PathBuf, Faults> {
        let path = folder.join(name);
        std::fs::write(&path, text)
            .map_err(|e| {
                Faults::from(Fault::of(
                    path.display().to_string(),
                    "output",
                    format!("can't be written ({e})"),
                    "name another folder: strainbridge demo DIR",
                ))
            })
            .map(|()| path)
    };
    let mut story: Vec<Chapter> = Vec::new();
    write("truck.bdf", DECK)?;
    let plan = write("solve.toml", &jobs::plan(None))?;
    let step = play(session, "solve", &folder, "1-solve", &plan)?;
    story.push(Chapter {
        folder: "1-solve",
        words: format!(
            "Nine unit loads on the free truck: {} unknowns, one factor.",
            step.result["dofs"]
        ),
        command: "solve",
        step,
    });
    let place = write("place.toml", &jobs::plan(Some("1-solve/results.op2")))?;
    let step = play(session, "place", &folder, "2-place", &place)?;
    let gauges = yard::Glued::of(&step.result);
    story.push(Chapter {
        folder: "2-place",
        words: format!(
            "{} gauges chosen out of {} candidates; at least {:.1} % of the best possible layout.",
            gauges.len(),
            step.result["candidates"]["rows"],
            100.0 * step.result["efficiency_bound"].as_f64().unwrap_or(0.0)
        ),
        command: "place",
        step,
    });
    // The truck in the yard stands on uneven ground, its gauge factors scatter, its readings are noisy, and two wires are swapped.
    let yard = session.stage("drive the truck", |_| yard::drive(&gauges))?;
    write("strain.csv", &yard.strain_csv)?;
    write("runs.csv", &yard.runs_csv)?;
    let job = write("recover.toml", &jobs::recover("strain.csv"))?;
    let step = play(session, "recover", &folder, "3-recover", &job)?;
    let before = yard.error_of(&step.result);
    story.push(Chapter {
        folder: "3-recover",
        words: format!(
            "Wheel loads are off by {:.1} % (rms against what was measured), and the residual says that they can't be trusted.",
            100.0 * before
        ),
        command: "recover",
        step,
    });
    let job = write("reconcile.toml", &jobs::reconcile())?;
    let step = play(session, "reconcile", &folder, "4-reconcile", &job)?;
    let named: Vec<String> = step.result["named"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|n| n.as_str().map(str::to_owned))
        .collect();
    let gap = &step.result["gap"];
    story.push(Chapter {
        folder: "4-reconcile",
        words: format!(
            "Hidden was {}. Named: {}. Gap on runs never fitted: {:.1} % before, {:.1} % after.",
            yard.hidden,
            if named.is_empty() {
                "nothing".to_owned()
            } else {
                named.join(", ")
            },
            100.0 * gap["before"].as_f64().unwrap_or(f64::NAN),
            100.0 * gap["after"].as_f64().unwrap_or(f64::NAN)
        ),
        command: "reconcile",
        step,
    });
    let corrected = folder
        .join("4-reconcile")
        .join("strain_extended.csv")
        .is_file();
    let strain = if corrected {
        "4-reconcile/strain_extended.csv"
    } else {
        "strain.csv"
    };
    let job = write("recover_again.toml", &jobs::recover(strain))?;
    let step = play(session, "recover", &folder, "5-recover-again", &job)?;
    let after = yard.error_of(&step.result);
    story.push(Chapter {
        folder: "5-recover-again",
        words: format!(
            "With the effect in the model the wheel loads are off by {:.1} %.",
            100.0 * after
        ),
        command: "recover",
        step,
    });
    let job = write("payload.toml", &jobs::payload(strain))?;
    let step = play(session, "payload", &folder, "6-payload", &job)?;
    let off = yard.payload_error_of(&step.result);
    story.push(Chapter {
        folder: "6-payload",
        words: format!(
            "Payload size and place from strain and wheel forces: off by {:.1} % (rms).",
            100.0 * off
        ),
        command: "payload",
        step,
    });
    let job = write("respond.toml", &jobs::respond(strain))?;
    let step = play(session, "respond", &folder, "7-respond", &job)?;
    let hottest = &step.result["elements"][0];
    story.push(Chapter {
        folder: "7-respond",
        words: format!(
            "Hottest element {}: {:.0} ± {:.0} MPa in run {}.",
            hottest["element"],
            hottest["max_von_mises"].as_f64().unwrap_or(f64::NAN),
            hottest["sigma"].as_f64().unwrap_or(f64::NAN),
            hottest["at"].as_str().unwrap_or("")
        ),
        command: "respond",
        step,
    });
    for c in &story {
        session.say(format!(
            "{:<16} {:>6.1} s  {}",
            c.folder, c.step.seconds, c.words
        ));
    }
    session.say(format!("open {}", folder.join("report.html").display()));
    let steps: Vec<Value> = story
        .iter()
        .map(|c| json!({ "command": c.command, "folder": c.folder, "words": c.words }))
        .collect();
    session.put("steps", steps)?;
    session.put("named", named)?;
    session.put("hidden", &yard.hidden)?;
    session.put(
        "wheel_force_error",
        json!({ "before": before, "after": after }),
    )?;
    session.put("payload_error", off)?;
    let html = page::page(&story).to_html();
    session
        .output_at(&folder)?
        .write_bytes("report.html", html.as_bytes())
        .map_err(Faults::from)
}

fn play(
    session: &mut Session,
    command: &'static str,
    folder: &Path,
    out: &str,
    job: &Path,
) -> Result<Closed, Faults> {
    let arguments = JobArguments {
        job: job.to_owned(),
        common: CommonArguments {
            out: Some(folder.join(out)),
        },
    };
    let cx = session.cx;
    let run = |work: fn(&JobArguments, &mut Session) -> Result<(), Faults>| {
        Session::run(command, &arguments.common, &cx, |s| work(&arguments, s))
    };
    session.stage(command, |_| match command {
        "solve" => asked(
            &app::solve::solve(&Job::read(job, cx.files)?, solving(), &cx)?,
            &folder.join(out),
        ),
        "place" => asked(
            &app::place::place(&Job::read(job, cx.files)?, &cx)?,
            &folder.join(out),
        ),
        "recover" => {
            let (job, folder) = (Job::read(job, cx.files)?, folder.join(out));
            let (outcome, json) = recover_and_save(&job, &cx, &folder)?;
            Ok(closed(&outcome, json, &folder))
        }
        "reconcile" => {
            let mut found = app::reconcile::reconcile(&Job::read(job, cx.files)?, &cx)?;
            found.answer.put_into(&folder.join(out));
            asked(&found, &folder.join(out))
        }
        "payload" => asked(
            &app::payload::payload(&Job::read(job, cx.files)?, &cx)?,
            &folder.join(out),
        ),
        _ => asked(
            &app::respond::respond(&Job::read(job, cx.files)?, &cx)?,
            &folder.join(out),
        ),
    })
}

/// An outcome written into its folder.
fn asked<A: Answer>(outcome: &Outcome<A>, folder: &Path) -> Result<Closed, Faults>
where
    Outcome<A>: Report,
{
    Ok(closed(outcome, save(outcome, folder)?, folder))
}

/// An outcome whose files are written.
fn closed<A: Answer>(outcome: &Outcome<A>, json: String, folder: &Path) -> Closed
where
    Outcome<A>: Report,
{
    Closed {
        json,
        text: outcome.words(),
        findings: outcome.findings.clone(),
        notes: outcome.notes.clone(),
        folder: Some(folder.to_owned()),
        faults: Vec::new(),
        result: serde_json::to_value(&outcome.answer).unwrap_or_default(),
        seconds: outcome.seconds.total(),
    }
}

/// What the story asks of the solver.
fn solving() -> SolveOptions {
    SolveOptions {
        modes: app::solve::MODES,
        ..SolveOptions::default()
    }
}
