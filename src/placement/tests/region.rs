//! Borders and rims of holes.

use crate::model::Model;
use crate::placement::region::{borders, free_edges, hole_rims};
use nastran::bdf::{IncludeRequest, LoadedFile, Loader, read_deck};

struct NoIncludes;

impl Loader for NoIncludes {
    fn load(&mut self, _: &IncludeRequest) -> Result<LoadedFile, String> {
        Err("no includes".to_owned())
    }
}

/// Builds quads on a lattice of `n x m` grids located by `at`. `taken(i, j)` selects cells with a quad, `closed` joins the last column to the first.
fn lattice(
    [n, m]: [usize; 2],
    at: impl Fn(usize, usize) -> [f64; 3],
    taken: impl Fn(usize, usize) -> bool,
    closed: usize,
) -> Model {
    let mut deck = "BEGIN BULK\nMAT1,1,210000.,,.3\nPSHELL,1,1,2.,1\n".to_owned();
    for i in 0..n {
        for j in 0..m {
            let [x, y, z] = at(i, j);
            deck += &format!("GRID,{},,{x:.4},{y:.4},{z:.4}\n", i * m + j + 1);
        }
    }
    let mut id = 0;
    for i in 0..n - 1 + closed {
        for j in 0..m - 1 {
            if taken(i, j) {
                id += 1;
                let grid = |a: usize, b: usize| (i + a) % n * m + j + b + 1;
                deck += &format!(
                    "CQUAD4,{id},1,{},{},{},{}\n",
                    grid(0, 0),
                    grid(1, 0),
                    grid(1, 1),
                    grid(0, 1)
                );
            }
        }
    }
    deck += "ENDDATA\n";
    let deck = read_deck("plate.bdf", deck.into_bytes(), &mut NoIncludes);
    Model::from_cards(&deck.cards).0
}

#[test]
fn rims_of_holes_are_distinguished_from_the_border_of_a_plate_flat_or_bent() {
    for bend in [0.0, 0.03] {
        // A hole of 2 x 2 cells and one of a single cell.
        let out = |i, j| (2..4).contains(&i) && (2..4).contains(&j) || (i, j) == (6, 4);
        let plate = lattice(
            [9, 7],
            |i, j| {
                let (x, y) = (10.0 * i as f64, 10.0 * j as f64);
                [x, y, bend * x * (80.0 - x) / 8.0]
            },
            |i, j| !out(i, j),
            0,
        );
        assert_eq!(free_edges(&plate).len(), 28 + 8 + 4);
        assert_eq!(hole_rims(&plate).len(), 8 + 4, "bend {bend}");
        assert_eq!(borders(&plate).len(), 28);
        for [a, b] in hole_rims(&plate) {
            for x in [a, b] {
                assert!(x.x > 15.0 && x.x < 75.0 && x.y > 15.0 && x.y < 55.0);
            }
        }
    }
}

#[test]
fn open_ends_of_a_tube_are_borders_and_the_hole_in_its_wall_is_not() {
    let tube = lattice(
        [12, 5],
        |i, j| {
            let t = std::f64::consts::TAU * i as f64 / 12.0;
            [20.0 * t.cos(), 20.0 * t.sin(), 10.0 * j as f64]
        },
        |i, j| (i, j) != (4, 1),
        1,
    );
    assert_eq!(borders(&tube).len(), 24);
    assert_eq!(hole_rims(&tube).len(), 4);
}
