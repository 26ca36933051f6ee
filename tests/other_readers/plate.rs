//! A small folded plate.

use nastran::bdf::{IncludeRequest, LoadedFile, Loader};
use std::fmt::Write;

/// Loader for a deck without INCLUDE.
pub struct NoFiles;

impl Loader for NoFiles {
    fn load(&mut self, _: &IncludeRequest) -> Result<LoadedFile, String> {
        Err("no include here".to_owned())
    }
}

/// Returns quadrilaterals with a fold, two triangles, and forces at two grids, each in a subcase.
pub fn deck() -> String {
    let mut deck = String::from(
        "SOL 101\nCEND\nSUBCASE 1\n  LOAD = 1\nSUBCASE 2\n  LOAD = 2\nBEGIN BULK\nPARAM,INREL,-2\n\
         MAT1,1,210000.,,.3,7.85-9\nPSHELL,1,1,2.0,1,,1\nFORCE,1,3,0,100.,0.,0.2,1.\nFORCE,2,11,0,50.,1.,0.,0.3\n",
    );
    for i in 0..5 {
        for j in 0..3 {
            let z = if j == 2 { 12.0 } else { f64::from(i) };
            let _ = writeln!(
                deck,
                "GRID,{},,{}.,{}.,{z:?}",
                3 * i + j + 1,
                20 * i,
                20 * j
            );
        }
    }
    for i in 0..4 {
        for j in 0..2 {
            let (a, id) = (3 * i + j + 1, 2 * i + j + 1);
            if i == 3 {
                let _ = writeln!(deck, "CTRIA3,{id},1,{a},{},{}", a + 3, a + 1);
                let _ = writeln!(deck, "CTRIA3,{},1,{},{},{}", id + 10, a + 1, a + 3, a + 4);
            } else {
                let _ = writeln!(deck, "CQUAD4,{id},1,{a},{},{},{}", a + 3, a + 4, a + 1);
            }
        }
    }
    deck.push_str("ENDDATA\n");
    deck
}
