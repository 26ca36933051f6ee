//! Decks that a test writes, and that the reader and the solver of the project process.

use nastran::bdf::{IncludeRequest, LoadedFile, Loader, read_deck};
use std::fmt::Write;
use strainbridge::fe::*;
use strainbridge::model::{Model, ModelFault};

struct NoFiles;

impl Loader for NoFiles {
    fn load(&mut self, _: &IncludeRequest) -> Result<LoadedFile, String> {
        Err("no include here".to_owned())
    }
}

/// Returns mass, centre of gravity and mass matrix as the solver reports them, without a load case.
pub fn mass_of(model: &Model) -> MassProperties {
    let solved = solve_displacements(model, &[], &SolveOptions::default());
    let report = solved.unwrap_or_else(|e| panic!("{e}")).report;
    report.mass.unwrap()
}

/// Returns the lowest elastic modes of a free structure.
pub fn free_modes(model: &Model, mpc: Option<u32>, count: usize) -> ModalSolution {
    solve_modes(model, None, mpc, count, &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Bulk data in free format, added card by card.
#[derive(Default)]
pub struct Bulk {
    pub text: String,
    grids: u32,
    elements: u32,
}

impl Bulk {
    /// Starts a deck with shell property 1 of thickness `t` on material 1.
    pub fn shell(e: f64, nu: f64, t: f64) -> Self {
        let mut b = Self::default();
        b.card(&format!("MAT1,1,{e:?},,{nu:?}"));
        b.card(&format!("PSHELL,1,1,{t:?},1,,1"));
        b
    }

    pub fn card(&mut self, card: &str) {
        let _ = writeln!(self.text, "{card}");
    }

    /// Adds a grid in large field format, with sixteen characters per field, and returns its id.
    pub fn grid(&mut self, x: [f64; 3]) -> u32 {
        self.grids += 1;
        let f = |v: f64| {
            let s = format!("{v:.9E}");
            format!("{s:>16}")
        };
        let id = self.grids;
        let _ = writeln!(
            self.text,
            "GRID*   {id:16}{:16}{}{}\n*       {}",
            "",
            f(x[0]),
            f(x[1]),
            f(x[2])
        );
        id
    }

    /// Adds a lattice of (n + 1) x (m + 1) grids and n x m quadrilaterals, and returns the grid ids by [i][j].
    pub fn patch(
        &mut self,
        n: usize,
        m: usize,
        at: impl Fn(f64, f64) -> [f64; 3],
    ) -> Vec<Vec<u32>> {
        let ids: Vec<Vec<u32>> = (0..=n)
            .map(|i| {
                (0..=m)
                    .map(|j| self.grid(at(i as f64 / n as f64, j as f64 / m as f64)))
                    .collect()
            })
            .collect();
        for i in 0..n {
            for j in 0..m {
                self.quad([ids[i][j], ids[i + 1][j], ids[i + 1][j + 1], ids[i][j + 1]]);
            }
        }
        ids
    }

    pub fn quad(&mut self, g: [u32; 4]) {
        self.elements += 1;
        self.card(&format!(
            "CQUAD4,{},1,{},{},{},{}",
            self.elements, g[0], g[1], g[2], g[3]
        ));
    }

    pub fn tria(&mut self, g: [u32; 3]) {
        self.elements += 1;
        self.card(&format!(
            "CTRIA3,{},1,{},{},{}",
            self.elements, g[0], g[1], g[2]
        ));
    }

    pub fn hold(&mut self, dofs: &str, grids: impl IntoIterator<Item = u32>) {
        for g in grids {
            self.card(&format!("SPC1,1,{dofs},{g}"));
        }
    }

    pub fn force(&mut self, grid: u32, f: [f64; 3]) {
        self.card(&format!(
            "FORCE,1,{grid},0,1.0,{:?},{:?},{:?}",
            f[0], f[1], f[2]
        ));
    }

    pub fn model(&self) -> Model {
        self.read_model().0
    }

    /// Returns the model and its faults.
    pub fn read_model(&self) -> (Model, Vec<ModelFault>) {
        let deck = read_deck(
            "test.bdf",
            format!("BEGIN BULK\n{}ENDDATA\n", self.text).into_bytes(),
            &mut NoFiles,
        );
        assert!(deck.faults.is_empty(), "{:?}", deck.faults);
        Model::from_cards(&deck.cards)
    }

    /// Solves for load set 1 with SPC set 1.
    pub fn solve(&self) -> Solved {
        self.solve_loads(vec![UnitLoad::Set(1)])
    }

    /// Solves for temperature set 9 with SPC set 1.
    pub fn solve_hot(&self) -> Solved {
        self.solve_hot_with(&SolveOptions::default())
    }

    /// Solves for temperature set 9 with SPC set 1 and the given options.
    pub fn solve_hot_with(&self, options: &SolveOptions) -> Solved {
        let hot = UnitLoad::Temperature {
            set: 9,
            initial: None,
        };
        self.solve_with(vec![hot], options)
    }

    /// Solves for the sum of several loads with SPC set 1.
    pub fn solve_loads(&self, loads: Vec<UnitLoad>) -> Solved {
        self.solve_with(loads, &SolveOptions::default())
    }

    fn solve_with(&self, loads: Vec<UnitLoad>, options: &SolveOptions) -> Solved {
        let model = self.model();
        let case = LoadCase {
            subcase: 1,
            label: String::new(),
            loads,
            spc: Some(1),
            mpc: None,
            relief: Relief::None,
        };
        let (mut solution, _) =
            solve_cases(&model, &[case], options).unwrap_or_else(|e| panic!("{e}"));
        Solved {
            case: solution.cases.remove(0),
            model,
        }
    }
}

/// One solved case.
pub struct Solved {
    pub model: Model,
    pub case: CaseResult,
}

impl Solved {
    /// Returns the displacement of a grid.
    pub fn displacement_at(&self, grid: u32) -> [f64; 6] {
        self.case.displacement[self.model.grid_ix(grid).unwrap().us()]
    }
}

/// Prints `got / reference` for the table in the README (`cargo test --test verification -- --nocapture`), without a
/// limit.
pub fn record(what: &str, got: f64, reference: f64) {
    assert_near(what, got, reference, f64::INFINITY);
}

/// Fails and prints both numbers if `got / reference` differs from one by more than `tolerance`.
#[track_caller]
pub fn assert_near(what: &str, got: f64, reference: f64, tolerance: f64) {
    let ratio = got / reference;
    eprintln!("{what}: {ratio:.4} of {reference}");
    assert!(
        (ratio - 1.0).abs() <= tolerance,
        "{what}: {ratio:.4} of the reference {reference}, tolerance {tolerance}"
    );
}
