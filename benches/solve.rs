//! Wall seconds of the solver on a deck: `cargo bench --bench solve -- DECK [LOADS] [MATRIX.mtx]`.
//!
//! Loads are vertical unit forces at grids spread over the model. With a third argument the supported stiffness goes to a Matrix
//! Market file, which `../shared/benchmarks/frames/pardiso_anchor.py` reads: run both in one sitting and compare.

use nastran::bdf::{IncludeRequest, Loaded, Loader, read_deck};
use std::io::Write;
use std::time::Instant;
use strainbridge::fe::{Corners, SolveOptions, UnitLoad, solve_unit_loads, supported_stiffness};
use strainbridge::model::{GridIx, Model, Vec3};

struct NoFiles;

impl Loader for NoFiles {
    fn load(&mut self, _: &IncludeRequest) -> Result<Loaded, String> {
        Err("benchmark decks have no includes".to_owned())
    }
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
    let start = Instant::now();
    let (_, report) = solve_unit_loads(
        &model,
        &loads,
        &SolveOptions {
            corners: Corners::Compute,
            ..SolveOptions::default()
        },
    )?;
    writeln!(
        out,
        "solve {count} loads {:.2} s: {} unknowns, {} entries, {:?}",
        start.elapsed().as_secs_f64(),
        report.dofs,
        report.factor_nonzeros,
        report.ordering
    )?;
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
