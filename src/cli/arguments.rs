//! Arguments as the user types them.

use crate::fe::{HeatedStrain, SolveOptions};
use crate::workflow::fleet::{digests_of, name::Shard};
use crate::workflow::init::Purpose;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Strain gauges and a finite element model in, wheel loads with intervals out.
#[derive(clap::Parser, Debug)]
#[command(
    name = "strainbridge",
    version = version(),
    about,
    arg_required_else_help = true,
    after_help = "First steps:\n  strainbridge demo                               an example truck: jobs, results, report\n  \
                  strainbridge check truck.bdf truck.op2          contents and faults of your files\n  \
                  strainbridge init truck.bdf truck.op2           a commented job from these files\n  \
                  strainbridge place job.toml                     where to glue gauges\n  \
                  strainbridge recover job.toml                   loads from measured strain\n\n\
                  Exit code: 0 done; 1 done, but the answer is unreliable; 2 bad input, every fault is listed;\n\
                  130 stopped by Ctrl-C, no incomplete file remains.\n\
                  `strainbridge COMMAND --help` shows an example of each."
)]
pub struct Arguments {
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
}

/// Version, commit if the build has one, and features.
fn version() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let all = [
            ("parquet", cfg!(feature = "parquet")),
            ("mdf", cfg!(feature = "mdf")),
            ("pdf", cfg!(feature = "pdf")),
        ];
        let built: Vec<&str> = all.iter().filter(|f| f.1).map(|f| f.0).collect();
        let features = match built.as_slice() {
            [] => "no features".to_owned(),
            some => format!("features {}", some.join(", ")),
        };
        let commit = match env!("STRAINBRIDGE_COMMIT") {
            "" => String::new(),
            known => format!("commit {}, ", known.get(..10).unwrap_or(known)),
        };
        format!("{} ({commit}{features})", env!("CARGO_PKG_VERSION"))
    });
    &TEXT
}

/// Commands; each has a file in this folder.
#[derive(clap::Subcommand, Debug)]
pub enum Command {
    /// Write an example truck into a folder: solve, place, recover, reconcile, weigh, report
    #[command(after_help = "Example:\n  strainbridge demo story && open story/report.html")]
    Demo(DemoArguments),
    /// Read decks, results or jobs; report their contents and every fault
    #[command(
        after_help = "Example:\n  strainbridge check truck.bdf truck.op2\n  strainbridge check job.toml --json"
    )]
    Check(FilesArguments),
    /// Write shell and bar strain of every static subcase to strains.csv, in element and basic frame
    #[command(after_help = "Example:\n  strainbridge strains truck.bdf truck.op2 --out strains")]
    Strains(DeckArguments),
    /// Write a commented job.toml from a deck and its results
    #[command(
        after_help = "Example:\n  strainbridge init truck.bdf truck.op2 --out .    # then read job.toml and correct it\n  \
                      strainbridge init truck.bdf --for payload    # with the sections that `payload` needs\n  \
                      strainbridge init --for identify",
        mut_arg("out", |a| a.help("Folder for job.toml and result.json (default: job.toml alone, in the current folder)"))
    )]
    Init(InitArguments),
    /// Write unit_loads.bdf: the deck of the job with one unit-load subcase for each load, ready for Nastran
    #[command(
        after_help = "Example:\n  strainbridge cases job.toml --out nastran && cd nastran && nastran unit_loads.bdf"
    )]
    Cases(JobArguments),
    /// Compute S of the gauges or candidates of a job: the reading of each for a unit of each load
    #[command(after_help = "Example:\n  strainbridge sensitivity job.toml")]
    Sensitivity(JobArguments),
    /// Choose gauges, with a bound on the distance from the best layout
    #[command(
        after_help = "Example:\n  strainbridge place job.toml    # job.out/gauges.csv, gauges.xlsx, gluing_sheet.html, report.html (report.pdf with feature pdf)"
    )]
    Place(JobArguments),
    /// Plan gauges live in the browser: mark elements, move gauges, place again, save
    #[cfg(feature = "open")]
    #[command(
        after_help = "Example:\n  strainbridge open job.toml\n  strainbridge open job.toml --port 8765 --no-browser    # on a server; then on your machine: ssh -L 8765:127.0.0.1:8765 HOST"
    )]
    Open(OpenArguments),
    /// Compute S from runs with known loads, combined with the model's S if there is a model
    #[command(
        after_help = "Example:\n  strainbridge calibrate job.toml --out cal && strainbridge recover cal/calibrated.toml"
    )]
    Calibrate(JobArguments),
    /// Recover loads from measured strain, with intervals
    #[command(after_help = "Example:\n  strainbridge recover job.toml --json | jq .loads")]
    Recover(JobArguments),
    /// Recover loads, cycles, damage and channel faults of many records, merged by vehicle
    #[command(
        after_help = "Example:\n  strainbridge fleet job.toml data/*.parquet --out fleet    # again: processes new records only\n  \
                      strainbridge fleet job.toml data/*.parquet --out fleet --shard 3/64    # one part, on one of many machines\n  \
                      strainbridge fleet job.toml --out fleet    # merges the results in the folder"
    )]
    Fleet(FleetArguments),
    /// Repeat recovery under stated errors for a range of gauge counts and layouts
    #[command(after_help = "Example:\n  strainbridge study job.toml --threads 4")]
    Study(JobArguments),
    /// Compute strain and stress of the structure from recovered loads: envelope, hot spots, histories
    #[command(
        after_help = "Example:\n  strainbridge respond job.toml    # job.out/envelope.vtu opens in ParaView"
    )]
    Respond(JobArguments),
    /// Compute mass and, if the data determine it, position of a payload, from strain, wheel forces or both
    #[command(after_help = "Example:\n  strainbridge payload job.toml")]
    Payload(JobArguments),
    /// Find lumped masses that match the model's reactions to the measured ones; write the completed deck
    #[command(
        after_help = "Example:\n  strainbridge ballast job.toml    # job.out contains the completed deck"
    )]
    Ballast(JobArguments),
    /// Solve the unit loads of a job, or the static subcases of a deck, with the built-in solver
    #[command(
        after_help = "Example:\n  strainbridge solve truck.bdf --out solved    # solved/results.op2, solved/results.vtu"
    )]
    Solve(SolveArguments),
    /// Compute elastic modes of the free or supported structure: shapes, effective masses and strain at gauges
    #[command(after_help = "Example:\n  strainbridge modes truck.bdf --modes 20 --out modes")]
    Modes(ModesArguments),
    /// Find where simulation and measurement disagree, and the missing effect; write the job with this effect
    #[command(
        after_help = "Example:\n  strainbridge reconcile job.toml    # exit code 1: the answer is unreliable"
    )]
    Reconcile(JobArguments),
    /// Identify vehicle parameters and wheel loads from accelerations
    #[command(after_help = "Example:\n  strainbridge identify vehicle.toml")]
    Identify(JobArguments),
    /// Simulate a vehicle with known parameters, from wheel forces, from a road or from recorded accelerations
    #[command(
        after_help = "Example:\n  strainbridge simulate vehicle.toml    # writes response.csv"
    )]
    Simulate(JobArguments),
    /// Recompute a result folder from its inputs and compare hashes and numbers
    #[command(
        after_help = "Example:\n  strainbridge verify job.out    # exit code 1: something differs"
    )]
    Verify(VerifyArguments),
    /// Remove data that strainbridge stores between runs
    #[command(after_help = "Example:\n  strainbridge cache clean --yes")]
    Cache(CacheArguments),
    /// Remove stored solutions of the built-in solver: short for `cache clean`
    #[command(after_help = "Example:\n  strainbridge clean --yes")]
    Clean(CleanArguments),
    /// Explain a finding: cause, limit, remedy, example
    #[command(
        after_help = "Example:\n  strainbridge explain loads-not-separable\n  strainbridge explain --list --json"
    )]
    Explain(ExplainArguments),
    /// Print the JSON schema of a job, for editors that complete and check TOML
    #[command(
        after_help = "Example:\n  strainbridge schema > job.schema.json    # and `#:schema job.schema.json` as first line of job.toml"
    )]
    Schema,
    /// Print the completions of a shell
    #[command(
        after_help = "Example:\n  strainbridge completions bash > ~/.local/share/bash-completion/completions/strainbridge"
    )]
    Completions(CompletionsArguments),
    /// Write one man page for each command
    #[command(after_help = "Example:\n  strainbridge man ~/.local/share/man/man1")]
    Man(ManArguments),
}

/// A job, records, and the part of the records to process.
#[derive(clap::Args, Debug)]
pub struct FleetArguments {
    /// The job, with fleet file_name
    #[arg(value_name = "JOB")]
    pub job: PathBuf,
    /// Records, folders of records, or patterns such as data/**/*.parquet; without any, the results in the output folder are merged
    #[arg(value_name = "FILES")]
    pub files: Vec<PathBuf>,
    /// Text file with one path in each line, or - for standard input; its records are processed in addition to FILES
    #[arg(long = "files", value_name = "LIST")]
    pub list: Option<PathBuf>,
    /// Process one part of the files, such as 3/64
    #[arg(long, value_name = "N/OF", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Folder for the results of single files, for tasks that share it (default: the folder of --out)
    #[arg(long, value_name = "DIR")]
    pub kept: Option<PathBuf>,
    /// Output of `sha256sum` for the records. A listed record with a stored result is not read again if its size and time are unchanged
    #[arg(long, value_name = "FILE", value_parser = digests)]
    pub digests: Option<BTreeMap<String, String>>,
    /// Options of every command
    #[command(flatten)]
    pub common: CommonArguments,
}

fn digests(path: &str) -> Result<BTreeMap<String, String>, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("can't be read: {e}"))?;
    digests_of(&text)
}

fn shard(text: &str) -> Result<Shard, String> {
    Shard::parse(text).ok_or_else(|| "expected a part such as 3/64, counted from 1".to_owned())
}

/// Which shell.
#[derive(clap::Args, Debug)]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

/// Where man pages go.
#[derive(clap::Args, Debug)]
pub struct ManArguments {
    /// Folder for the pages
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Options of every command.
    #[command(flatten)]
    pub common: CommonArguments,
}

/// Which finding.
#[derive(clap::Args, Debug)]
pub struct ExplainArguments {
    /// Code of the finding, as findings state it in brackets
    #[arg(value_name = "CODE", required_unless_present_any = ["list", "reference"])]
    pub code: Option<String>,
    /// All codes
    #[arg(long)]
    pub list: bool,
    /// Write the reference of job keys, fields, columns, findings and exit codes into this folder
    #[arg(long, value_name = "DIR")]
    pub reference: Option<PathBuf>,
    /// Options of every command.
    #[command(flatten)]
    pub common: CommonArguments,
}

/// Arguments of `verify`: the folder to verify.
#[derive(clap::Args, Debug)]
pub struct VerifyArguments {
    /// The folder that a command wrote
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// Options of every command.
    #[command(flatten)]
    pub common: CommonArguments,
}

/// Tasks on the cache of solutions.
#[derive(clap::Args, Debug)]
pub struct CacheArguments {
    /// The task
    #[command(subcommand)]
    pub task: CacheTask,
}

/// Commands on the cache of stored solutions.
#[derive(clap::Subcommand, Debug)]
pub enum CacheTask {
    /// Remove stored solutions of the built-in solver
    #[command(after_help = "Example:\n  strainbridge cache clean --yes")]
    Clean(CleanArguments),
}

/// Arguments of `cache clean`: the folder whose stored solutions it removes.
#[derive(clap::Args, Debug)]
pub struct CleanArguments {
    /// Folder with stored solutions (default: the user's folder for caches)
    #[arg(value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
    /// Remove them without asking
    #[arg(short, long)]
    pub yes: bool,
    /// Options of every command.
    #[command(flatten)]
    pub common: CommonArguments,
}

/// Options of every command.
#[derive(clap::Args, Debug, Clone, Default)]
pub struct CommonArguments {
    /// Folder for result.json, tables and report (default: job.out for job.toml; `check` writes only with it)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print result.json, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
    /// Threads for parallel work (default: all cores)
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Neither use nor store solutions of the built-in solver
    #[arg(long)]
    pub no_cache: bool,
    /// Print only faults and findings of severity error
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print every finding, equal ones too, and seconds by stage
    #[arg(short, long)]
    pub verbose: bool,
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

/// A job for the live page.
#[cfg(feature = "open")]
#[derive(clap::Args, Debug)]
pub struct OpenArguments {
    /// The job
    #[arg(value_name = "JOB.toml")]
    pub job: PathBuf,
    /// Port of 127.0.0.1 (default: a free one)
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Print the address, and do not open a browser
    #[arg(long)]
    pub no_browser: bool,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: CommonArguments,
}

/// A deck or job to be solved.
#[derive(clap::Args, Debug)]
pub struct SolveArguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub job: JobArguments,
    /// Write the total strain of heated structures, with thermal expansion (the strain of an uncompensated gauge). Without this option it is
    /// the mechanical strain, which a gauge reads that is compensated for its material
    #[arg(long)]
    pub total_strain: bool,
    /// Elastic modes computed in addition to the strain; 0: none
    #[arg(long, value_name = "N", default_value_t = crate::workflow::solve::MODES)]
    pub modes: usize,
}

impl SolveArguments {
    /// Returns whether the file to solve is a job, not a deck.
    pub(super) fn is_job(&self) -> bool {
        let extension = self.job.job.extension();
        extension.is_some_and(|e| e.eq_ignore_ascii_case("toml"))
    }

    /// Returns the options of the solver.
    pub fn options(&self) -> SolveOptions {
        SolveOptions {
            heated: match self.total_strain {
                true => HeatedStrain::Total,
                false => HeatedStrain::Mechanical,
            },
            modes: self.modes,
            ..SolveOptions::default()
        }
    }
}

/// A deck or job whose modes are wanted.
#[derive(clap::Args, Debug)]
pub struct ModesArguments {
    /// The deck, or a job
    #[arg(value_name = "DECK|JOB.toml")]
    pub input: PathBuf,
    /// Number of modes
    #[arg(long, value_name = "N", default_value_t = crate::workflow::solve::MODES)]
    pub modes: usize,
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

impl FilesArguments {
    /// Returns the first file.
    pub(super) fn first_file(&self) -> &Path {
        self.files.first().map_or(Path::new(""), |f| f)
    }
}

/// Arguments of `init`: the deck and result files that the job is written from, and the command that it is for.
#[derive(clap::Args, Debug)]
pub struct InitArguments {
    /// The deck, or an OP2 that contains the mesh; `--for identify` and `--for calibrate` need no deck
    #[arg(value_name = "DECK", required_unless_present = "purpose")]
    pub deck: Option<PathBuf>,
    /// Result files
    #[arg(value_name = "RESULTS")]
    pub results: Vec<PathBuf>,
    /// Write the sections that this command needs: payload, identify, reconcile or calibrate
    #[arg(long = "for", value_name = "COMMAND", value_parser = purpose)]
    pub purpose: Option<Purpose>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: CommonArguments,
}

impl InitArguments {
    /// Returns the path of the deck. It is empty if no deck is given.
    pub(super) fn main(&self) -> &Path {
        self.deck.as_deref().unwrap_or(Path::new(""))
    }
}

fn purpose(text: &str) -> Result<Purpose, String> {
    let found = Purpose::ALL.iter().find(|p| p.0 == text);
    let names = || Purpose::ALL.map(|p| p.0).join(", ");
    found
        .map(|p| p.1)
        .ok_or_else(|| format!("expected one of {}", names()))
}

/// A command on a deck and its results.
#[derive(clap::Args, Debug)]
pub struct DeckArguments {
    /// The deck, or an OP2 that contains the mesh
    #[arg(value_name = "DECK")]
    pub deck: PathBuf,
    /// Result files
    #[arg(value_name = "RESULTS")]
    pub results: Vec<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: CommonArguments,
}
