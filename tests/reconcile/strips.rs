//! A small structure with decks and jobs on any mesh.
//!
//! It has two strips of steel plate (1000 x 100 x 5 mm) side by side, tied by three bushes. Forces act across the
//! plates at six places, and gauges are on the top.

use super::hidden::drawn::Numbers;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Elements along a strip of the analyst's mesh. It has two elements across.
pub const ALONG: usize = 20;
/// Bushes: element id and station along the strips.
pub const BUSHES: [(usize, usize); 3] = [(9001, 0), (9002, 10), (9003, 20)];
/// Gauges on the analyst's mesh: strip, row, station.
pub const GAUGES: [(usize, usize, usize); 12] = [
    (1, 0, 2),
    (1, 1, 6),
    (1, 0, 9),
    (1, 1, 11),
    (1, 0, 15),
    (1, 1, 18),
    (2, 1, 1),
    (2, 0, 5),
    (2, 1, 8),
    (2, 0, 12),
    (2, 1, 13),
    (2, 0, 17),
];

/// Mesh that is finer by this factor.
pub struct Mesh(pub usize);

impl Mesh {
    pub fn grid(&self, strip: usize, row: usize, station: usize) -> usize {
        10_000 * strip + row * self.0 * (ALONG * self.0 + 1) + station * self.0 + 1
    }

    pub fn fine_grid(&self, strip: usize, row: usize, station: usize) -> usize {
        10_000 * strip + row * (ALONG * self.0 + 1) + station + 1
    }

    /// Returns the element at the middle of an element of the analyst's mesh.
    pub fn element(&self, strip: usize, row: usize, station: usize) -> usize {
        let half = self.0 / 2;
        let (row, station) = (row * self.0 + half, station * self.0 + half);
        100_000 * strip + row * ALONG * self.0 + station + 1
    }

    /// Returns the deck. The middle bush is `middle` times as stiff as the others.
    ///
    /// `heat` adds temperature set 31. It contains the temperatures of the cold strip and of the middle plane of the
    /// first strip. The last number is the gradient through the thickness of the first strip.
    pub fn deck(&self, middle: f64, heat: Option<[f64; 3]>) -> String {
        let mut out = String::from("SOL 101\nCEND\nBEGIN BULK\nPARAM,INREL,-2\nPARAM,POST,-1\n");
        out += "MAT1,1,2.+5,,.3,7.85-9,1.2-5\nPSHELL,1,1,5.,1,,1\n";
        let size = 50.0 / self.0 as f64;
        for strip in 1..=2 {
            for row in 0..=2 * self.0 {
                for station in 0..=ALONG * self.0 {
                    let (x, y) = (
                        size * station as f64,
                        size * row as f64 + 300.0 * (strip - 1) as f64,
                    );
                    let id = self.fine_grid(strip, row, station);
                    let _ = writeln!(out, "GRID,{id},,{x:.5},{y:.5},0.");
                }
            }
            for row in 0..2 * self.0 {
                for station in 0..ALONG * self.0 {
                    let id = 100_000 * strip + row * ALONG * self.0 + station + 1;
                    let g = |r, s| self.fine_grid(strip, r, s);
                    let corners = [
                        g(row, station),
                        g(row, station + 1),
                        g(row + 1, station + 1),
                        g(row + 1, station),
                    ];
                    let [a, b, c, d] = corners;
                    let _ = writeln!(out, "CQUAD4,{id},1,{a},{b},{c},{d}");
                    if let (1, Some([_, mean, gradient])) = (strip, heat) {
                        let _ = writeln!(out, "TEMPP1,31,{id},{mean:.4},{gradient:.4}");
                    }
                }
            }
        }
        if let Some([cold, ..]) = heat {
            let _ = writeln!(out, "TEMPD,31,{cold:.4}");
        }
        for (id, station) in BUSHES {
            let factor = if id == BUSHES[1].0 { middle } else { 1.0 };
            let property = if factor == 1.0 { 7 } else { 8 };
            let (a, b) = (self.grid(1, 2, station), self.grid(2, 0, station));
            let _ = writeln!(out, "CBUSH,{id},{property},{a},{b},,,,0");
        }
        for (id, factor) in [(7, 1.0), (8, middle)] {
            let k = |k: f64| k * factor;
            let _ = writeln!(
                out,
                "PBUSH,{id},K,{:.6},{:.6},{:.6},{:.6},{:.6},{:.6}",
                k(2e3),
                k(2e3),
                k(30.0),
                k(4e6),
                k(4e6),
                k(4e6)
            );
        }
        out + "ENDDATA\n"
    }

    pub fn job(&self, measured: &str) -> String {
        let mut out = String::from(
            "title = \"Two strips\"\nunits = \"mm-t-s\"\nreport_units = { force = \"kN\", moment = \"kN m\", length = \"m\" }\n[model]\ndeck = \"deck.bdf\"\nmesh_error = false\n",
        );
        for (name, (strip, row, station)) in LOADS {
            let grid = self.grid(strip, row, station);
            let _ = write!(
                out,
                "[[load]]\nname = \"{name}\"\ngrid = {grid}\ncomponent = \"FZ\"\n"
            );
        }
        for (k, (strip, row, station)) in GAUGES.into_iter().enumerate() {
            let element = self.element(strip, row, station);
            let _ = write!(
                out,
                "[[gauge]]\nname = \"G{k:02}\"\nelement = {element}\nsurface = \"top\"\ndirection = [1, 0, 0]\n"
            );
        }
        out + measured
    }
}

/// Names and places of the forces.
pub const LOADS: [(&str, (usize, usize, usize)); 6] = [
    ("A", (1, 0, 0)),
    ("B", (1, 0, 10)),
    ("C", (1, 0, 20)),
    ("D", (2, 2, 0)),
    ("E", (2, 2, 10)),
    ("F", (2, 2, 20)),
];

/// Runs a command that must end without an error, and returns its output folder.
pub fn run(command: &str, job: &Path) -> PathBuf {
    ends(command, job, 0).0
}

/// Runs a command that must end with this code, and returns its output folder and its messages.
pub fn ends(command: &str, job: &Path, code: i32) -> (PathBuf, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg(command)
        .arg(job)
        .output()
        .expect("the program runs");
    let printed = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(code), "{command}: {printed}");
    (job.with_extension("out"), printed)
}

/// Returns S of a folder's job, microstrain per N, gauges by loads.
pub fn sensitivity(out: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(out.join("sensitivity.csv")).expect("S");
    let row = |l: &str| {
        l.split(',')
            .skip(1)
            .map(|v| v.parse().expect("a number"))
            .collect()
    };
    text.lines().skip(1).map(row).collect()
}

/// Returns `strain.csv` and `runs.csv` of 14 runs under forces up to 50 N, with noise of half a microstrain (uniform:
/// 0.87 peak).
///
/// `truth` is S of the true structure, microstrain per N. `besides` is the additional strain of each gauge in a run.
pub fn simulate_measured_tables(
    truth: &[Vec<f64>],
    mut besides: impl FnMut(usize) -> Vec<f64>,
) -> [String; 2] {
    let mut numbers = Numbers(7);
    let mut runs = String::from("run,A,B,C,D,E,F\n");
    let mut strain = String::from("run");
    (0..GAUGES.len()).for_each(|k| {
        let _ = write!(strain, ",G{k:02}");
    });
    strain.push('\n');
    for r in 1..=14 {
        let forces: Vec<f64> = (0..LOADS.len()).map(|_| 50.0 * numbers.next()).collect();
        let kn: Vec<String> = forces.iter().map(|f| format!("{:.6}", f / 1e3)).collect();
        let _ = writeln!(runs, "R{r:02},{}", kn.join(","));
        let more = besides(r);
        let read = truth.iter().zip(more).map(|(row, more)| {
            let clean: f64 = row.iter().zip(&forces).map(|(a, f)| a * f).sum();
            format!("{:.3}", clean + more + 0.87 * numbers.next())
        });
        let read: Vec<String> = read.collect();
        let _ = writeln!(strain, "R{r:02},{}", read.join(","));
    }
    [strain, runs]
}

/// Creates a folder for the test, and returns a function that writes files into it.
pub fn workplace(name: &str) -> (PathBuf, impl Fn(&str, &str)) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    let here = folder.clone();
    let write = move |name: &str, text: &str| {
        let path = here.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("created");
        std::fs::write(path, text).expect("written");
    };
    (folder, write)
}

/// Part of the job that describes 14 runs, four of them held out.
pub const MEASURED: &str = "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\nmodel_uncertainty_rel = 0.005\n\
     hold_out = [\"R11\", \"R12\", \"R13\", \"R14\"]\n\
     [runs]\nfile = \"runs.csv\"\nunits = { force = \"kN\" }\nnoise = { force = 0.0001 }\n[reconcile]\npath = \"static\"\n";

/// Returns `result.json` of a folder.
pub fn result(out: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(out.join("result.json")).expect("result.json");
    serde_json::from_str(&text).expect("valid json")
}
