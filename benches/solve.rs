//! Measures wall seconds of the solver on a deck: `cargo bench --bench solve -- DECK [LOADS] [MATRIX.mtx]`.
//!
//! Loads are vertical unit forces at grids spread over the model. With a third argument the supported stiffness is written to a Matrix Market file,
//! which `../shared/benchmarks/frames/pardiso_anchor.py` reads. Run both directly after each other and compare.
//!
//! `--paper`: work and longest chain of the elimination tree, and the possible speed-up with many threads.
//! `--zones`: time of ten variants on one factor, relative to the time of the solution. In each variant a fortieth of the shells is a tenth thicker.

use nastran::bdf::{IncludeRequest, LoadedFile, Loader, read_deck};
use std::io::Write;
use std::time::Instant;
use strainbridge::fe::{
    Corners, SolveOptions, Support, UnitLoad, factor_on_paper, solve_unit_loads, solve_variants,
    supported_stiffness,
};
use strainbridge::model::{GridIx, Model, Vec3};

struct NoFiles;

impl Loader for NoFiles {
    fn load(&mut self, _: &IncludeRequest) -> Result<LoadedFile, String> {
        Err("benchmark decks have no includes".to_owned())
    }
}

/// Number of zones that are changed, one at a time.
const ZONES: usize = 10;

/// Returns the model with one zone a tenth thicker.
fn thicken_zone(model: &Model, zone: usize) -> Model {
    let mut out = model.clone();
    let n = out.shells.len();
    let shells = out.shells.iter_mut().skip(zone * n / ZONES);
    for s in shells.take(n / (4 * ZONES)) {
        s.thickness = s.thickness.map(|t| 1.1 * t);
    }
    out
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout();
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with("--"))
        .collect();
    let Some(path) = arguments.first() else {
        writeln!(
            out,
            "give a deck: cargo bench --bench solve -- DECK [LOADS] [MATRIX.mtx]"
        )?;
        return Ok(());
    };
    let count: usize = arguments.get(1).and_then(|a| a.parse().ok()).unwrap_or(18);
    let start = Instant::now();
    let deck = read_deck(path, std::fs::read(path)?, &mut NoFiles);
    let (model, _) = Model::from_cards(&deck.cards);
    writeln!(out, "read {:.2} s", start.elapsed().as_secs_f64())?;
    let loads: Vec<UnitLoad> = (0..count)
        .map(|i| {
            let shell = &model.shells[i * model.shells.len() / count];
            UnitLoad::AtGrid {
                grid: GridIx(shell.grids[0].0),
                force: Vec3::z(),
                moment: Vec3::zeros(),
            }
        })
        .collect();
    let options = SolveOptions {
        corners: Corners::Compute,
        ..SolveOptions::default()
    };
    let start = Instant::now();
    let (_, report) = solve_unit_loads(&model, &loads, &options)?;
    let solved = start.elapsed().as_secs_f64();
    writeln!(
        out,
        "solve {count} loads {solved:.2} s: {} unknowns, {} entries, {:?}",
        report.dofs, report.factor_nonzeros, report.ordering
    )?;
    if std::env::args().any(|a| a == "--zones") {
        let start = Instant::now();
        let variants = (0..ZONES).map(|zone| thicken_zone(&model, zone));
        let support = Support::without_spc(&model);
        let read = |_: &Model, s: &strainbridge::fe::Solution| s.cases.len();
        solve_variants(&model, support, &loads, variants, &options, read)?;
        let took = start.elapsed().as_secs_f64();
        let share = took / solved;
        writeln!(out, "{ZONES} zones {took:.2} s, {share:.2} solutions")?;
    }
    if std::env::args().any(|a| a == "--paper") {
        let (work, threads) = factor_on_paper(&model)?;
        let (all, chain) = (1e-9 * work.total, work.total / work.longest);
        writeln!(
            out,
            "{all:.1} thousand million multiplications, {chain:.1} times the longest chain"
        )?;
        for (n, busiest) in threads {
            writeln!(
                out,
                "{n} threads: {:.2} times as fast",
                work.total / busiest
            )?;
        }
    }
    if let Some(matrix) = arguments.get(2) {
        let (n, entries) = supported_stiffness(&model)?;
        let mut file = std::io::BufWriter::new(std::fs::File::create(matrix)?);
        writeln!(
            file,
            "%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {}",
            entries.len()
        )?;
        for (r, c, v) in entries {
            writeln!(file, "{} {} {v:e}", r + 1, c + 1)?;
        }
    }
    Ok(())
}
