//! `demo`: the truck story in a folder. Solve, place, glue and drive (simulated here), recover, reconcile, recover again, weigh the payload, stress,
//! report.

mod chapter;
mod jobs;
mod page;
mod simulated_measurements;

pub(super) use chapter::DECK_NAME;

use super::run::recover_and_save;
use crate::estimate::NORMAL_95;
use crate::fe::SolveOptions;
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::output::Output;
use crate::host::work::Work;
use crate::job::Job;
use crate::report::command::{Report, save, write_page};
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{Card, KeyNumber, Page};
use crate::units::UnitSystem;
use crate::workflow;
use chapter::{Chapter, DECK, Step, number_of, percent, percent_at_least};
use page::Figures;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Command name under which the manifest of the folder lists the input files that the demo writes.
const INPUTS: &str = "demo inputs";
/// Names of these input files.
const INPUT_NAMES: [&str; 10] = [
    "truck.bdf",
    "solve.toml",
    "place.toml",
    "strain.csv",
    "runs.csv",
    "recover.toml",
    "reconcile.toml",
    "recover_again.toml",
    "payload.toml",
    "respond.toml",
];

/// Default folder of the demo.
pub(super) const FOLDER: &str = "strainbridge-demo";

/// Result of the demo: the hidden effect, the effects found, and the errors of loads and payload before and after.
#[derive(Serialize)]
pub struct Story {
    /// Chapters of the story.
    steps: Vec<ChapterSummary>,
    /// Effects that `reconcile` named.
    named: Vec<String>,
    /// The effect that was hidden.
    hidden: String,
    /// Error of the wheel loads, rms, relative.
    wheel_force_error: BeforeAfter,
    /// Error of the payload, rms, relative.
    payload_error: f64,
    #[serde(skip)]
    chapters: Vec<Chapter>,
    #[serde(skip)]
    folder: PathBuf,
}

/// A chapter in `result.json`.
#[derive(Serialize)]
struct ChapterSummary {
    command: &'static str,
    folder: &'static str,
    words: String,
}

/// Without and with the effect in the model.
#[derive(Serialize)]
struct BeforeAfter {
    before: f64,
    after: f64,
}

impl Answer for Story {
    const COMMAND: &'static str = "demo";
    const RESULT: &'static str = "The story";

    fn verdict(&self) -> String {
        let [before, after] = [self.wheel_force_error.before, self.wheel_force_error.after];
        let (hidden, before) = (in_words(&self.hidden), percent(before));
        match self.named.contains(&self.hidden) {
            true => format!(
                "{hidden}, and `reconcile` finds it: with the sign corrected, the error of the wheel loads falls from {before} to {} (rms).",
                percent(after)
            ),
            false => format!(
                "{hidden}, and `reconcile` does not find it: the error of the wheel loads is {before} (rms)."
            ),
        }
    }
}

impl Report for Outcome<Story> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let figures = Figures {
            found: self.named.contains(&self.hidden),
            before: self.wheel_force_error.before,
            after: self.wheel_force_error.after,
            payload: self.payload_error,
        };
        Some(page::page(&self.chapters, &figures))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        Vec::new()
    }

    fn console(&self) -> Console {
        let row = |c: &Chapter| {
            let seconds = format!("{:.1} s", c.step.seconds);
            vec![c.folder.to_owned(), seconds, c.words.clone()]
        };
        let rows = self.chapters.iter().map(row).collect();
        let page = self.folder.join("report.html");
        Console::new(ConsoleTable::new("", &[], rows), None)
            .next(format!("open {} in a browser", page.display()))
    }
}

/// Runs the story in `folder`.
///
/// # Errors
/// A folder that cannot be written.
pub fn story(folder: &Path, cx: &Context) -> Result<Outcome<Story>, Faults> {
    let mut work = Work::new(cx);
    let units = StatedUnits::from_units(UnitSystem::MmTS, &jobs::report_units());
    let story = run_story(folder, &mut work)?;
    Ok(work.finish(units, story))
}

/// Solves, and chooses the gauges.
fn solve_and_place(
    folder: &Path,
    work: &mut Work,
    story: &mut Vec<Chapter>,
) -> Result<Vec<simulated_measurements::InstalledGauge>, Faults> {
    write(folder, "truck.bdf", DECK)?;
    let plan = write(folder, "solve.toml", &jobs::plan())?;
    let step = play(work, "solve", folder, "1-solve", &plan)?;
    story.push(Chapter {
        folder: "1-solve",
        title: "Solve",
        numbers: vec![
            number_of(&step.result["dofs"], "unknowns"),
            (
                format!("{:.1} s", step.seconds),
                "of computation".to_owned(),
            ),
        ],
        words: format!(
            "Nine unit loads on the free truck: {} unknowns, one factor.",
            step.result["dofs"]
        ),
        command: "solve",
        step,
    });
    let place = write(folder, "place.toml", &jobs::plan())?;
    let step = play(work, "place", folder, "2-place", &place)?;
    let gauges = simulated_measurements::InstalledGauge::read_gauges(&step.result);
    story.push(Chapter {
        folder: "2-place",
        title: "Place",
        numbers: vec![
            (
                percent_at_least(step.result["efficiency_bound"].as_f64().unwrap_or(0.0)),
                "of the best possible layout, proved".to_owned(),
            ),
            number_of(&step.result["candidates"]["rows"], "candidates"),
        ],
        words: format!(
            "{} gauges chosen out of {} candidates; at least {:.1} % of the best possible layout.",
            gauges.len(),
            step.result["candidates"]["rows"],
            100.0 * step.result["efficiency_bound"].as_f64().unwrap_or(0.0)
        ),
        command: "place",
        step,
    });
    Ok(gauges)
}

/// Payload and stress with the corrected gauge; the error of the payload.
fn run_payload_and_respond(
    folder: &Path,
    work: &mut Work,
    story: &mut Vec<Chapter>,
    corrected: &dyn Fn(String) -> String,
    measured: &simulated_measurements::SimulatedMeasurements,
) -> Result<f64, Faults> {
    let strain = "strain.csv";
    let job = write(folder, "payload.toml", &corrected(jobs::payload(strain)))?;
    let step = play(work, "payload", folder, "6-payload", &job)?;
    let off = measured.payload_error_of(&step.result);
    story.push(Chapter {
        folder: "6-payload",
        title: "Payload",
        numbers: vec![
            (percent(off), "error of the payload".to_owned()),
            (
                step.result["payload"]
                    .as_array()
                    .map_or(0, Vec::len)
                    .to_string(),
                "runs".to_owned(),
            ),
        ],
        words: format!(
            "Payload size and place from strain and wheel forces: error {:.1} % (rms).",
            100.0 * off
        ),
        command: "payload",
        step,
    });
    let job = write(folder, "respond.toml", &corrected(jobs::respond(strain)))?;
    let step = play(work, "respond", folder, "7-respond", &job)?;
    let hottest = &step.result["elements"][0];
    story.push(Chapter {
        folder: "7-respond",
        title: "Respond",
        numbers: vec![
            number_of(&hottest["max_von_mises"], "MPa, largest stress"),
            number_of(&hottest["element"], "element with the largest stress"),
        ],
        words: format!(
            "Largest stress in element {}: {:.0} ± {:.0} MPa in run {}.",
            hottest["element"],
            hottest["max_von_mises"].as_f64().unwrap_or(f64::NAN),
            NORMAL_95 * hottest["sigma"].as_f64().unwrap_or(f64::NAN),
            hottest["at"].as_str().unwrap_or("")
        ),
        command: "respond",
        step,
    });
    Ok(off)
}

fn run_story(folder: &Path, work: &mut Work) -> Result<Story, Faults> {
    Output::check_free(folder, &INPUT_NAMES)?;
    std::fs::create_dir_all(folder).map_err(|e| unwritable_folder_fault(folder, &e))?;
    let mut story: Vec<Chapter> = Vec::new();
    let gauges = solve_and_place(folder, work, &mut story)?;
    // The truck stands on uneven ground, its gauge factors scatter, its readings are noisy, and two wires are swapped.
    let measured = work.stage("drive the truck", |_| {
        simulated_measurements::simulate(&gauges)
    })?;
    write(folder, "strain.csv", &measured.strain_csv)?;
    write(folder, "runs.csv", &measured.runs_csv)?;
    let job = write(folder, "recover.toml", &jobs::recover("strain.csv"))?;
    let mut step = play(work, "recover", folder, "3-recover", &job)?;
    step.card = step.card.with_figure(&measured.figure_of(&step.result));
    let before = measured.error_of(&step.result);
    story.push(Chapter {
        folder: "3-recover",
        title: "Recover",
        numbers: vec![
            (percent(before), "error of the wheel loads".to_owned()),
            number_of(&step.result["residual_rms_microstrain"], "microstrain residual"),
        ],
        words: format!(
            "Wheel loads deviate by {:.1} % (rms) from the measured loads, and the residual shows that they are unreliable.",
            100.0 * before
        ),
        command: "recover",
        step,
    });
    let job = write(folder, "reconcile.toml", &jobs::reconcile())?;
    let step = play(work, "reconcile", folder, "4-reconcile", &job)?;
    let named: Vec<String> = step.result["named"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|n| n.as_str().map(str::to_owned))
        .collect();
    let gap = &step.result["gap"];
    story.push(Chapter {
        folder: "4-reconcile",
        title: "Reconcile",
        numbers: vec![
            (
                percent(gap["before"].as_f64().unwrap_or(f64::NAN)),
                "gap on held-out runs, before".to_owned(),
            ),
            (
                percent(gap["after"].as_f64().unwrap_or(f64::NAN)),
                "after".to_owned(),
            ),
        ],
        words: format!(
            "{}. Identified: {}. Gap on held-out runs: {:.1} % before, {:.1} % after.",
            in_words(&measured.hidden),
            match named.as_slice() {
                [] => "nothing".to_owned(),
                [one] if *one == measured.hidden => "the same".to_owned(),
                all => all.join(", "),
            },
            100.0 * gap["before"].as_f64().unwrap_or(f64::NAN),
            100.0 * gap["after"].as_f64().unwrap_or(f64::NAN)
        ),
        command: "reconcile",
        step,
    });
    // The corrections found for the channels apply to the next steps.
    let corrections = corrections_of(&folder.join("4-reconcile").join("job_extended.toml"));
    let strain = "strain.csv";
    let corrected = |job: String| format!("{job}\n{corrections}");
    let job = corrected(jobs::recover(strain));
    let job = write(folder, "recover_again.toml", &job)?;
    let mut step = play(work, "recover", folder, "5-recover-again", &job)?;
    step.card = step.card.with_figure(&measured.figure_of(&step.result));
    let after = measured.error_of(&step.result);
    story.push(Chapter {
        folder: "5-recover-again",
        title: "Recover again",
        numbers: vec![
            (percent(after), "error of the wheel loads".to_owned()),
            number_of(
                &step.result["residual_rms_microstrain"],
                "microstrain residual",
            ),
        ],
        words: format!(
            "With the effect in the model the wheel loads deviate by {:.1} %.",
            100.0 * after
        ),
        command: "recover",
        step,
    });
    let off = run_payload_and_respond(folder, work, &mut story, &corrected, &measured)?;
    let step = |c: &Chapter| ChapterSummary {
        command: c.command,
        folder: c.folder,
        words: c.words.clone(),
    };
    Ok(Story {
        steps: story.iter().map(step).collect(),
        named,
        hidden: measured.hidden.clone(),
        wheel_force_error: BeforeAfter { before, after },
        payload_error: off,
        chapters: story,
        folder: folder.to_owned(),
    })
}

/// The hidden effect as a clause.
fn in_words(hidden: &str) -> String {
    match hidden.strip_prefix("sign_flip:") {
        Some(gauge) => format!("Gauge {gauge} has reversed polarity on purpose"),
        None => format!("The effect {hidden} is hidden on purpose"),
    }
}

fn write(folder: &Path, name: &str, text: &str) -> Result<PathBuf, Faults> {
    let mut out = Output::begin(folder)?;
    out.write_bytes(name, text.as_bytes())?;
    out.commit_with_earlier_files(INPUTS)?;
    Ok(folder.join(name))
}

fn unwritable_folder_fault(path: &Path, e: &std::io::Error) -> Fault {
    let shown = path.display().to_string();
    let remedy = "name another folder: strainbridge demo DIR";
    Fault::new(
        shown,
        "output",
        format!("the folder cannot be written ({e})"),
        remedy,
    )
}

/// Runs a command of the story and writes its files.
fn play(
    work: &mut Work,
    command: &'static str,
    folder: &Path,
    out: &str,
    job: &Path,
) -> Result<Step, Faults> {
    let cx = work.cx.clone();
    let folder = folder.join(out);
    work.stage(command, |_| {
        let job = Job::read(job, cx.files)?;
        match command {
            "solve" => save_step(
                &workflow::solve::solve(&job, solve_options(), &cx)?,
                &folder,
            ),
            "place" => save_step(&workflow::place::place(&job, &cx)?, &folder),
            "recover" => Ok(step_of(&recover_and_save(&job, &cx, &folder)?.0)),
            "reconcile" => {
                let mut found = workflow::reconcile::reconcile(&job, &cx)?;
                found.answer.put_into(&folder);
                save_step(&found, &folder)
            }
            "payload" => save_step(&workflow::payload::payload(&job, &cx)?, &folder),
            _ => save_step(&workflow::respond::respond(&job, &cx)?, &folder),
        }
    })
}

/// An outcome written into its folder.
fn save_step<A: Answer>(outcome: &Outcome<A>, folder: &Path) -> Result<Step, Faults>
where
    Outcome<A>: Report,
{
    save(outcome, folder)?;
    Ok(step_of(outcome))
}

fn step_of<A: Answer>(outcome: &Outcome<A>) -> Step
where
    Outcome<A>: Report,
{
    Step {
        result: serde_json::to_value(&outcome.answer).unwrap_or_default(),
        findings: outcome.findings.clone(),
        card: Card::of_page("", outcome.page().as_ref(), A::COMMAND == "recover"),
        seconds: outcome.seconds.total(),
    }
}

/// Returns the options of the solver for the demo.
fn solve_options() -> SolveOptions {
    SolveOptions {
        modes: workflow::solve::MODES,
        ..SolveOptions::default()
    }
}

/// Returns the `[[correction]]` entries of a job as text; empty if it has none.
fn corrections_of(job: &Path) -> String {
    let text = std::fs::read_to_string(job).unwrap_or_default();
    let mut table: toml::Table = text.parse().unwrap_or_default();
    table.retain(|key, _| key == "correction");
    toml::to_string(&table).unwrap_or_default()
}
