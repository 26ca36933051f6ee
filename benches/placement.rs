//! Placement at the sizes of the README, with the certificate.
//!
//! The candidates are from a ladder frame (`../shared/benchmarks/frames/frame.py`) that this program solves. Solving and placing are two steps, so
//! that the measured memory is the memory of placing:
//!
//!     python ../shared/benchmarks/frames/frame.py --k 3 --loads none k3.bdf
//!     cargo bench --bench placement -- solve k3.bdf 6 k3_6.bin          # unit forces up at the wheels, or 36: all six components
//!     cargo bench --bench placement -- place k3_6.bin 12 5 0 6,9,20,40  # angles, every n-th element, spacing, gauges
//!
//! The matrices of `../shared/benchmarks/doptimal` are placed on one thread. That folder also contains the processor seconds of R's AlgDesign for
//! comparison:
//!
//!     cargo bench --bench placement -- anchors ../shared/benchmarks/doptimal

use nastran::bdf::{IncludeRequest, LoadedFile, Loader, read_deck};
use std::error::Error;
use std::io::Write;
use std::time::Instant;
use strainbridge::fe::{CaseResult, Corners, SolveOptions, UnitLoad, solve_unit_loads};
use strainbridge::gauge::{centre, to_side};
use strainbridge::model::{Model, Vec3};
use strainbridge::placement::candidates::{Angles, Candidates, Scatter};
use strainbridge::placement::exchange::Effort;
use strainbridge::placement::{Layout, Spec, place};

type Outcome = Result<(), Box<dyn Error>>;

/// Expected size of a force, N, and of a moment, N mm; noise is 1 microstrain.
const EXPECTED: [f64; 2] = [1e4, 1e7];

fn main() -> Outcome {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with("--"))
        .collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["solve", deck, loads, out] => solve(deck, loads.parse()?, out),
        ["place", file, angles, every, spacing, gauges, rest @ ..] => {
            let proof = rest.first().map_or(Ok(0.0), |w| w.parse())?;
            let gauges: Result<Vec<usize>, _> = gauges.split(',').map(str::parse).collect();
            on_frame(
                file,
                angles.parse()?,
                every.parse()?,
                spacing.parse()?,
                &gauges?,
                proof,
            )
        }
        ["anchors", folder] => anchors(folder),
        _ => {
            writeln!(std::io::stdout(), "see the head of benches/placement.rs")?;
            Ok(())
        }
    }
}

struct NoFiles;

impl Loader for NoFiles {
    fn load(&mut self, _: &IncludeRequest) -> Result<LoadedFile, String> {
        Err("benchmark decks have no includes".to_owned())
    }
}

/// Writes strain tensors (microstrain at the expected loads) and positions of both sides of every shell, as f64, little endian. The order is: number
/// of places, number of loads, then for each place x y z, and exx eyy gxy for each load.
fn solve(path: &str, count: usize, out: &str) -> Outcome {
    let deck = read_deck(path, std::fs::read(path)?, &mut NoFiles);
    let (model, _) = Model::from_cards(&deck.cards);
    let first = if model.grid_ix(9_000_001).is_some() {
        9_000_001
    } else {
        9_001
    };
    let mut loads = Vec::new();
    let mut scales = Vec::new();
    // The components are FZ FX FY MX MY MZ, each at six wheels.
    for component in [2, 0, 1, 3, 4, 5].into_iter().take(count.div_ceil(6)) {
        for wheel in 0..6 {
            let mut unit = Vec3::zeros();
            unit[component % 3] = 1.0;
            let force = component < 3;
            loads.push(UnitLoad::AtGrid {
                grid: model.grid_ix(first + wheel).ok_or("no wheel grids")?,
                force: if force { unit } else { Vec3::zeros() },
                moment: if force { Vec3::zeros() } else { unit },
            });
            scales.push(EXPECTED[usize::from(!force)] * 1e6);
        }
    }
    let options = SolveOptions {
        corners: Corners::Leave,
        ..SolveOptions::default()
    };
    let (solution, report) = solve_unit_loads(&model, &loads, &options)?;
    let mut file = std::io::BufWriter::new(std::fs::File::create(out)?);
    let mut put = |v: f64| file.write_all(&v.to_le_bytes());
    put(2.0 * model.shells.len() as f64)?;
    put(loads.len() as f64)?;
    for (i, shell) in model.shells.iter().enumerate() {
        let x = centre(&model, shell).ok_or("a shell without area")?;
        let grid = |c: usize| model.grids[shell.grids[c].us()].x;
        let z = (grid(2) - grid(0)).cross(&(grid(3) - grid(1))).normalize();
        for side in strainbridge::fe::strain_tensor::Surface::BOTH {
            let at = x + z * to_side(&model, shell, side);
            for v in [at.x, at.y, at.z] {
                put(v)?;
            }
            for (case, scale) in solution.cases.iter().zip(&scales) {
                let case: &CaseResult = case;
                for v in case.shells.centre[i][side.ix()] {
                    put(v * scale)?;
                }
            }
        }
    }
    writeln!(
        std::io::stdout(),
        "{} unknowns, {} shells, {} loads",
        report.dofs,
        model.shells.len(),
        loads.len()
    )?;
    Ok(())
}

fn on_frame(
    path: &str,
    angles: usize,
    every: usize,
    spacing: f64,
    gauges: &[usize],
    proof: f64,
) -> Outcome {
    let mut out = std::io::stdout();
    let bytes = std::fs::read(path)?;
    let number = |i: usize| {
        let mut b = [0; 8];
        b.copy_from_slice(&bytes[8 * i..8 * i + 8]);
        f64::from_le_bytes(b)
    };
    let (all, k) = (number(0) as usize, number(1) as usize);
    let width = 3 + 3 * k;
    // Select both sides of every n-th shell.
    let places: Vec<usize> = (0..all).filter(|p| (p / 2) % every == 0).collect();
    let step = std::f64::consts::PI / angles as f64;
    let grid = if angles == 0 {
        Angles::Continuous
    } else {
        Angles::Grid((0..angles).map(|i| step * i as f64).collect())
    };
    let start = Instant::now();
    let fill = |p: usize, row: &mut [f64]| {
        for (i, v) in row.iter_mut().enumerate() {
            *v = number(2 + places[p] * width + 3 + i);
        }
    };
    let at = |p: &usize| std::array::from_fn(|i| number(2 + p * width + i));
    let c = Candidates::from_tensors(
        k,
        places.len(),
        grid,
        Scatter::with_uniform_noise(1.0),
        fill,
    )
    .with_positions(places.iter().map(at).collect());
    writeln!(
        out,
        "{} places, {} rows, {k} loads, spacing {spacing}; made in {:.3} s",
        c.n_places(),
        c.n_rows(),
        start.elapsed().as_secs_f64()
    )?;
    for &s in gauges {
        let spec = Spec {
            spacing,
            proof,
            effort: Effort {
                starts: 4,
                perturbations: if k > 12 { 40 } else { 4 },
                seed: 1,
            },
            ..Spec::new(s, k)
        };
        let before = processor_seconds();
        let start = Instant::now();
        let l = place(&c, &spec)?;
        let wall = start.elapsed().as_secs_f64();
        let cpu = processor_seconds().zip(before).map(|(a, b)| a - b);
        say(&mut out, s, &l, wall, cpu)?;
    }
    writeln!(out, "peak memory {:?} MB", peak_memory_mb())?;
    Ok(())
}

fn say(out: &mut impl Write, s: usize, l: &Layout, wall: f64, cpu: Option<f64>) -> Outcome {
    writeln!(
        out,
        "{s:3} gauges: at least {:.4} of the best, log det {:.5}, proved {} ({} nodes, {:?} left), {} passes, {wall:.4} s wall, {cpu:.2?} s processor",
        l.efficiency_bound, l.log_det, l.proved, l.nodes, l.alive, l.passes
    )?;
    Ok(())
}

/// Returns the processor seconds of this process so far, to a hundredth; `None` if the system does not report them.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |i: usize| fields.get(i)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn anchors(folder: &str) -> Outcome {
    let mut out = std::io::stdout();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for line in std::fs::read_to_string(format!("{folder}/anchors.csv"))?
        .lines()
        .skip(1)
    {
        let f: Vec<&str> = line.split(',').collect();
        let c = matrix(folder, f[0])?;
        let (s, k) = (f[3].parse::<usize>()?, c.n_loads());
        let efforts = if k > 12 {
            [("quick", 1, 32, 0.0), ("longer", 4, 60, 0.0)]
        } else {
            [("quick", 4, 4, 0.0), ("proof", 8, 12, 1e10)]
        };
        for (name, starts, perturbations, proof) in efforts {
            let spec = Spec {
                effort: Effort {
                    starts,
                    perturbations,
                    seed: 1,
                },
                proof,
                ..Spec::new(s, k)
            };
            let repeats = if k > 12 { 4 } else { 40 };
            let before = processor_seconds().unwrap_or(0.0);
            let mut layout = None;
            let wall = Instant::now();
            one.install(|| -> Result<(), String> {
                for _ in 0..repeats {
                    layout = Some(place(&c, &spec).map_err(|e| e.to_string())?);
                }
                Ok(())
            })?;
            let wall = wall.elapsed().as_secs_f64() / f64::from(repeats);
            let cpu = (processor_seconds().unwrap_or(0.0) - before) / f64::from(repeats);
            let Some(l) = layout else { continue };
            let other = |i: usize| f.get(i).and_then(|v| v.parse::<f64>().ok());
            let above =
                |i: usize| other(i).map_or("-".into(), |v| format!("{:+.6}", l.log_det - v));
            writeln!(
                out,
                "{:25} {s:3} {name:6}: over AlgDesign {}, over reference {}, at least {:.4}, proved {}, {cpu:.5} s processor ({wall:.5} wall), AlgDesign {:.0} times that",
                f[0],
                above(4),
                above(6),
                l.efficiency_bound,
                l.proved,
                other(5).map_or(f64::NAN, |v| v / cpu)
            )?;
        }
    }
    Ok(())
}

fn matrix(folder: &str, name: &str) -> Result<Candidates, Box<dyn Error>> {
    let scatter = Scatter::with_uniform_noise(1.0);
    if let Some(rest) = name.strip_prefix("ladder_T_k36_n2e4") {
        let k = if rest.is_empty() { 36 } else { 6 };
        let bytes = std::fs::read(format!("{folder}/ladder_T_k36_n2e4.npy"))?;
        let header = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let v: Vec<f64> = bytes[10 + header..]
            .chunks_exact(4)
            .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))
            .collect();
        let grid = (0..12)
            .map(|i| (15.0 * f64::from(i)).to_radians())
            .collect();
        let fill = |p: usize, row: &mut [f64]| {
            for l in 0..k {
                for c in 0..3 {
                    row[3 * l + c] = v[(3 * p + c) * 36 + l];
                }
            }
        };
        return Ok(Candidates::from_tensors(
            k,
            v.len() / 108,
            Angles::Grid(grid),
            scatter,
            fill,
        ));
    }
    let text = std::fs::read_to_string(format!("{folder}/{name}.csv"))?;
    let rows: Result<Vec<Vec<f64>>, _> = text
        .lines()
        .map(|l| l.split(',').map(str::parse).collect())
        .collect();
    let rows = rows?;
    let k = rows.first().map_or(0, Vec::len);
    Ok(Candidates::from_rows(k, rows.len(), scatter, |i, row| {
        row.copy_from_slice(&rows[i])
    }))
}
