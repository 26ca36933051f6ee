//! Arguments as the user types them.

use std::path::PathBuf;

/// Strain gauges and a finite element model in, wheel loads with intervals out.
#[derive(clap::Parser, Debug)]
#[command(name = "strainbridge", version, about, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands; each has its file beside this one.
#[derive(clap::Subcommand, Debug)]
pub enum Command {
    /// The truck story in a folder: solve, place, recover, reconcile, weigh, report
    Demo(DemoArguments),
    /// Read decks, results or jobs; report what is in them and every fault
    Check(FilesArguments),
    /// Shell and bar strain of every static subcase, in the element and the basic frame, to strains.csv
    Strains(DeckArguments),
    /// Write a commented job.toml from a deck and its results
    Init(DeckArguments),
    /// Write unit_loads.bdf: the job's deck with one unit-load subcase a load, ready for Nastran
    Cases(JobArguments),
    /// Compute S of the job's gauges, or of its candidates: what each reads per unit of each load
    Sensitivity(JobArguments),
    /// Choose gauges, with a certificate of how far from the best possible they are
    Place(JobArguments),
    /// Recover loads from measured strain, with intervals
    Recover(JobArguments),
    /// Repeat recovery under stated errors for a range of gauge counts and layouts
    Study(JobArguments),
    /// Strain and stress anywhere on the structure from recovered loads, by superposition: envelope, hot spots, histories
    Respond(JobArguments),
    /// Mass and, where it can be told, position of a payload, from strain, wheel forces or both
    Payload(JobArguments),
    /// Size and place lumped masses that bring the model's reactions to the measured ones; write the completed deck
    Ballast(JobArguments),
    /// Strain of a job's unit loads, or of a deck's static subcases, by the built-in solver
    Solve(JobArguments),
    /// Find where simulation and measurement disagree, name the missing effect, add it, show the gap shrink
    Reconcile(JobArguments),
    /// Vehicle parameters and wheel loads from accelerations
    Identify(JobArguments),
}

/// Options of every command.
#[derive(clap::Args, Debug, Clone, Default)]
pub struct CommonArguments {
    /// Folder for result.json, tables and report (default: <job name>.out; `check` writes only with it)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print result.json, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
    /// Threads for parallel work (default: all cores)
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Neither take solutions of the built-in solver from the folder `<job name>.cache` nor keep them there
    #[arg(long)]
    pub no_cache: bool,
}

/// A command on a job.
#[derive(clap::Args, Debug)]
pub struct JobArguments {
    /// The job
    #[arg(value_name = "JOB.toml")]
    pub job: PathBuf,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: CommonArguments,
}

/// The story.
#[derive(clap::Args, Debug)]
pub struct DemoArguments {
    /// Folder for the story (default: strainbridge-demo)
    #[arg(value_name = "DIR")]
    pub folder: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: CommonArguments,
}

/// A command on files.
#[derive(clap::Args, Debug)]
pub struct FilesArguments {
    /// Decks, OP2, punch or H5 files, jobs
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: CommonArguments,
}

/// A command on a deck and its results.
#[derive(clap::Args, Debug)]
pub struct DeckArguments {
    /// The deck, or an OP2 that holds the mesh
    #[arg(value_name = "DECK")]
    pub deck: PathBuf,
    /// Result files
    #[arg(value_name = "RESULTS")]
    pub results: Vec<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: CommonArguments,
}
