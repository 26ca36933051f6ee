//! Jobs with all their files in memory, one of them damaged, and the commands that read them.

use super::{Context, InMemory, Job, Random, mutate};
use std::fmt;
use std::path::{Path, PathBuf};
use strainbridge::host::outcome::Outcome;
use strainbridge::{Faults, host};

/// Files of a folder of `examples/`.
pub struct Folder {
    name: String,
    jobs: Vec<PathBuf>,
    files: Vec<(PathBuf, Vec<u8>)>,
}

/// Folder with a damaged file, and the command that reads it.
pub struct Damaged {
    files: InMemory,
    bytes: Vec<u8>,
    job: PathBuf,
    command: Command,
    damaged: PathBuf,
}

type Ask = fn(&Path, &Context) -> Result<(), Faults>;
type Command = (&'static str, Ask);

/// Discards an answer. Its serialisation must not fail either.
fn check_serialisation<A: host::outcome::Answer>(outcome: Outcome<A>) -> Result<(), Faults> {
    outcome.to_json(&host::outcome::Tables::new()).unwrap();
    Ok(())
}

macro_rules! command {
    ($name:ident) => {
        (stringify!($name), |job, cx| {
            check_serialisation(strainbridge::$name(&Job::read(job, cx.files)?, cx)?)
        })
    };
}

/// Commands that the test runs.
///
/// `identify` and `study` are omitted because they take seconds, and `fleet` because it stores results in a folder.
/// `sensitivity`, `place` and `modes` test the deck and the solver of `solve`. `strains` and `init` have no job.
const COMMANDS: [Command; 11] = [
    ("check", |job, cx| {
        check_serialisation(strainbridge::check(&[job.to_owned()], cx)?)
    }),
    command!(cases),
    command!(sensitivity),
    command!(place),
    command!(recover),
    command!(respond),
    command!(payload),
    command!(ballast),
    command!(reconcile),
    command!(calibrate),
    ("modes", |job, cx| {
        check_serialisation(strainbridge::modes(&Job::read(job, cx.files)?, 4, cx)?)
    }),
];

/// Returns small jobs of every kind, except those that take seconds.
pub fn folders() -> Vec<Folder> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let all = ["bridge", "frame", "onboard"].map(|name| {
        let mut files: Vec<(PathBuf, Vec<u8>)> = std::fs::read_dir(examples.join(name))
            .unwrap()
            .map(|e| e.unwrap().path())
            .filter(|p| p.is_file())
            .map(|p| {
                (
                    PathBuf::from(p.file_name().unwrap()),
                    std::fs::read(&p).unwrap(),
                )
            })
            .collect();
        files.sort();
        let is_job = |p: &&PathBuf| p.extension().is_some_and(|e| e == "toml");
        let jobs = files.iter().map(|f| &f.0).filter(is_job).cloned().collect();
        Folder {
            name: name.to_owned(),
            jobs,
            files,
        }
    });
    all.into()
}

impl Folder {
    /// Returns the folder with one changed file, one of its jobs, and a command.
    pub fn damage_file(&self, random: &mut Random) -> Damaged {
        let job = &self.jobs[random.draw_below(self.jobs.len())];
        // In half of the cases the job itself, otherwise another file.
        let tables: Vec<&PathBuf> = self
            .files
            .iter()
            .map(|f| &f.0)
            .filter(|p| !self.jobs.contains(p))
            .collect();
        let damaged = match random.draw_below(2) {
            0 => job.clone(),
            _ => tables[random.draw_below(tables.len())].clone(),
        };
        let (mut files, mut changed) = (InMemory::default(), Vec::new());
        for (path, original) in &self.files {
            let mut bytes = original.clone();
            if *path == damaged {
                (0..=random.draw_below(3)).for_each(|_| mutate(&mut bytes, random));
                changed.clone_from(&bytes);
            }
            files = files.with_file(path, bytes);
        }
        // The command for which the job is made, or any command.
        let stem = job.file_stem().map_or("", |s| s.to_str().unwrap());
        let own = COMMANDS.iter().find(|c| stem.starts_with(c.0));
        let command = match (own, random.draw_below(4)) {
            (Some(own), 1..) => *own,
            _ => COMMANDS[random.draw_below(COMMANDS.len())],
        };
        Damaged {
            files,
            bytes: changed,
            job: job.clone(),
            command,
            damaged: Path::new(&self.name).join(damaged),
        }
    }
}

impl Damaged {
    /// Returns the bytes of the damaged file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Runs the command. Faults are a valid answer.
    pub fn run(&self) {
        let cx = Context::new(&self.files);
        let _ = (self.command.1)(&self.job, &cx);
    }
}

impl fmt::Display for Damaged {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{} of {} with {}",
            self.command.0,
            self.job.display(),
            self.damaged.display()
        )
    }
}
