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
    after_help = "First steps:\n  strainbridge demo                               the truck story in a folder, in seconds\n  \
                  strainbridge check truck.bdf truck.op2          what is in your files\n  \
                  strainbridge init truck.bdf truck.op2           a commented job from them\n  \
                  strainbridge place job.toml                     where to glue gauges\n  \
                  strainbridge recover job.toml                   loads from measured strain\n\n\
                  Exit code: 0 done; 1 done, but an answer can't be relied on; 2 bad input, every fault listed;\n\
                  130 stopped by Ctrl-C, no half-written file is left.\n\
                  `strainbridge COMMAND --help` shows an example of each."
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// Version, commit where the build knows it, and features.
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

/// The commands; each has its file beside this one.
#[derive(clap::Subcommand, Debug)]
pub enum Command {
    /// The truck story in a folder: solve, place, recover, reconcile, weigh, report
    #[command(after_help = "Example:\n  strainbridge demo story && open story/report.html")]
    Demo(DemoArguments),
    /// Read decks, results or jobs; report what is in them and every fault
    #[command(
        after_help = "Example:\n  strainbridge check truck.bdf truck.op2\n  strainbridge check job.toml --json"
    )]
    Check(FilesArguments),
    /// Shell and bar strain of every static subcase, in the element and the basic frame, to strains.csv
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
    /// Write unit_loads.bdf: the job's deck with one unit-load subcase a load, ready for Nastran
    #[command(
        after_help = "Example:\n  strainbridge cases job.toml --out nastran && cd nastran && nastran unit_loads.bdf"
    )]
    Cases(JobArguments),
    /// Compute S of the job's gauges, or of its candidates: what each reads per unit of each load
    #[command(after_help = "Example:\n  strainbridge sensitivity job.toml")]
    Sensitivity(JobArguments),
    /// Choose gauges, with a certificate of how far from the best possible they are
    #[command(
        after_help = "Example:\n  strainbridge place job.toml    # job.out/gauges.csv, gauges.xlsx, gluing_sheet.html, report.html (report.pdf with feature pdf)"
    )]
    Place(JobArguments),
    /// Learn S from runs of known load, fused with the model's S where there is one
    #[command(
        after_help = "Example:\n  strainbridge calibrate job.toml --out cal && strainbridge recover cal/calibrated.toml"
    )]
    Calibrate(JobArguments),
    /// Recover loads from measured strain, with intervals
    #[command(after_help = "Example:\n  strainbridge recover job.toml --json | jq .loads")]
    Recover(JobArguments),
    /// Loads, cycles, damage and faults of many records on all cores, merged by vehicle
    #[command(
        after_help = "Example:\n  strainbridge fleet job.toml data/*.parquet --out fleet    # again, for what is new alone\n  \
                      strainbridge fleet job.toml data/*.parquet --out fleet --shard 3/64    # a part of them, on one of many machines\n  \
                      strainbridge fleet job.toml --out fleet    # merges what the folder holds"
    )]
    Fleet(FleetArguments),
    /// Repeat recovery under stated errors for a range of gauge counts and layouts
    #[command(after_help = "Example:\n  strainbridge study job.toml --threads 4")]
    Study(JobArguments),
    /// Strain and stress anywhere on the structure from recovered loads, by superposition: envelope, hot spots, histories
    #[command(
        after_help = "Example:\n  strainbridge respond job.toml    # job.out/envelope.vtu opens in ParaView"
    )]
    Respond(JobArguments),
    /// Mass and, if the data determine it, position of a payload, from strain, wheel forces or both
    #[command(after_help = "Example:\n  strainbridge payload job.toml")]
    Payload(JobArguments),
    /// Size and place lumped masses that bring the model's reactions to the measured ones; write the completed deck
    #[command(
        after_help = "Example:\n  strainbridge ballast job.toml    # job.out holds the completed deck"
    )]
    Ballast(JobArguments),
    /// Strain of a job's unit loads, or of a deck's static subcases, by the built-in solver
    #[command(
        after_help = "Example:\n  strainbridge solve truck.bdf --out solved    # solved/results.op2, solved/results.vtu"
    )]
    Solve(SolveArguments),
    /// Elastic modes of a job's or deck's structure, free or supported, with their shapes, effective masses and strain at gauges
    #[command(after_help = "Example:\n  strainbridge modes truck.bdf --modes 20 --out modes")]
    Modes(ModesArguments),
    /// Find where simulation and measurement disagree, name the missing effect, add it, show the gap shrink
    #[command(
        after_help = "Example:\n  strainbridge reconcile job.toml    # exit code 1: what it says can't be relied on"
    )]
    Reconcile(JobArguments),
    /// Vehicle parameters and wheel loads from accelerations
    #[command(after_help = "Example:\n  strainbridge identify vehicle.toml")]
    Identify(JobArguments),
    /// Recompute a result folder from its inputs and compare hashes and numbers
    #[command(
        after_help = "Example:\n  strainbridge verify job.out    # exit code 1: something differs"
    )]
    Verify(VerifyArguments),
    /// Remove what strainbridge keeps between runs
    #[command(after_help = "Example:\n  strainbridge cache clean --yes")]
    Cache(CacheArguments),
    /// Remove kept solutions of the built-in solver: short for `cache clean`
    #[command(after_help = "Example:\n  strainbridge clean --yes")]
    Clean(CleanArguments),
    /// What a finding means: cause, limit, remedy, an example
    #[command(
        after_help = "Example:\n  strainbridge explain loads-not-separable\n  strainbridge explain --list --json"
    )]
    Explain(ExplainArguments),
    /// Print the JSON schema of a job, for editors that complete and check TOML by it
    #[command(
        after_help = "Example:\n  strainbridge schema > job.schema.json    # and `#:schema job.schema.json` as first line of job.toml"
    )]
    Schema,
    /// Print the completions of a shell
    #[command(
        after_help = "Example:\n  strainbridge completions bash > ~/.local/share/bash-completion/completions/strainbridge"
    )]
    Completions(CompletionsArguments),
    /// Write man pages, one a command
    #[command(after_help = "Example:\n  strainbridge man ~/.local/share/man/man1")]
    Man(ManArguments),
}

/// A job, records, which of them.
#[derive(clap::Args, Debug)]
pub struct FleetArguments {
    /// The job, with [fleet] file_name
    #[arg(value_name = "JOB")]
    pub job: PathBuf,
    /// Records, folders of records, or patterns such as data/**/*.parquet; without any, the results in the output folder are merged
    #[arg(value_name = "FILES")]
    pub files: Vec<PathBuf>,
    /// A text file with a path a line, or - for standard input; its records are processed in addition to FILES
    #[arg(long = "files", value_name = "LIST")]
    pub list: Option<PathBuf>,
    /// Do one part of the files, such as 3/64
    #[arg(long, value_name = "N/OF", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Folder where the results of single files are kept, for tasks that share one (default: that of --out)
    #[arg(long, value_name = "DIR")]
    pub kept: Option<PathBuf>,
    /// What `sha256sum` lists of the records: one that is listed and whose result is kept is not read again while its size and time are the same
    #[arg(long, value_name = "FILE", value_parser = digests)]
    pub digests: Option<BTreeMap<String, String>>,
    /// What every command is asked
    #[command(flatten)]
    pub common: CommonArguments,
}

fn digests(path: &str) -> Result<BTreeMap<String, String>, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("can't be read: {e}"))?;
    digests_of(&text)
}

fn shard(text: &str) -> Result<Shard, String> {
    Shard::of(text).ok_or_else(|| "expected a part such as 3/64, counted from 1".to_owned())
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
    /// What every command takes.
    #[command(flatten)]
    pub common: CommonArguments,
}

/// Which finding.
#[derive(clap::Args, Debug)]
pub struct ExplainArguments {
    /// Its code, as findings state it in brackets
    #[arg(value_name = "CODE", required_unless_present_any = ["list", "reference"])]
    pub code: Option<String>,
    /// All codes
    #[arg(long)]
    pub list: bool,
    /// Write the reference of job keys, fields, columns, findings and exit codes into this folder
    #[arg(long, value_name = "DIR")]
    pub reference: Option<PathBuf>,
    /// What every command takes.
    #[command(flatten)]
    pub common: CommonArguments,
}

/// What is verified.
#[derive(clap::Args, Debug)]
pub struct VerifyArguments {
    /// The folder that a command wrote
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// What every command takes.
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

/// Tasks on kept solutions.
#[derive(clap::Subcommand, Debug)]
pub enum CacheTask {
    /// Remove kept solutions of the built-in solver
    #[command(after_help = "Example:\n  strainbridge cache clean --yes")]
    Clean(CleanArguments),
}

/// What is removed.
#[derive(clap::Args, Debug)]
pub struct CleanArguments {
    /// The folder with kept solutions (default: the user's folder for caches)
    #[arg(value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
    /// Remove them without a question
    #[arg(short, long)]
    pub yes: bool,
    /// What every command takes.
    #[command(flatten)]
    pub common: CommonArguments,
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
    /// Neither take solutions of the built-in solver from those kept nor keep them
    #[arg(long)]
    pub no_cache: bool,
    /// Say faults and findings of severity error alone
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say every finding, equal ones too, and seconds by stage
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

/// A deck or job to be solved.
#[derive(clap::Args, Debug)]
pub struct SolveArguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub job: JobArguments,
    /// Write the total strain of heated structures, thermal expansion included (the apparent strain of a gauge that compensates nothing);
    /// without it the mechanical strain, which a gauge compensated for its material reads
    #[arg(long)]
    pub total_strain: bool,
    /// Elastic modes computed in addition to the strain; 0: none
    #[arg(long, value_name = "N", default_value_t = crate::workflow::solve::MODES)]
    pub modes: usize,
}

impl SolveArguments {
    /// Whether it is a job that is to be solved, not a deck.
    pub(super) fn is_job(&self) -> bool {
        let extension = self.job.job.extension();
        extension.is_some_and(|e| e.eq_ignore_ascii_case("toml"))
    }

    /// What is asked of the solver.
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
    /// How many
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
    /// The first file.
    pub(super) fn first(&self) -> &Path {
        self.files.first().map_or(Path::new(""), |f| f)
    }
}

/// What a job is written from, and for.
#[derive(clap::Args, Debug)]
pub struct InitArguments {
    /// The deck, or an OP2 that holds the mesh; `--for identify` and `--for calibrate` do without
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
    /// The deck, where one is given.
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
