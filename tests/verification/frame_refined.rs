//! The ladder frame of `../shared/benchmarks/frames` (geometry of its docstring, flat, box rails) at two mesh sizes.
//!
//! The webs of open C rails bend locally at the cross members, and 40 mm elements do not show it. The median difference
//! there is 12 %, although MYSTRAN and the built-in solver agree within 1 % on the same mesh. Closed rails deform as
//! beams.

use crate::mesh::Bulk;
use std::collections::HashMap;
use std::sync::OnceLock;
use strainbridge::fe::*;
use strainbridge::model::{GridIx, Model, Vec3};

/// Side of a cell at k = 1, mm.
pub const CELL: f64 = 40.0;
pub const AXLES: [i32; 3] = [24, 132, 166];

/// Cells and grids of the frame on a lattice with the spacing CELL / k.
struct Frame {
    bulk: Bulk,
    k: i32,
    grids: HashMap<[i32; 3], u32>,
    /// Number of quadrilaterals added until now.
    quads: u32,
}

impl Frame {
    fn grid(&mut self, at: [i32; 3]) -> u32 {
        if let Some(g) = self.grids.get(&at) {
            return *g;
        }
        let step = CELL / f64::from(self.k);
        let x = at.map(|i| f64::from(i) * step);
        let g = self.bulk.grid([x[0], x[1] - 400.0, x[2]]);
        self.grids.insert(at, g);
        g
    }

    /// Adds a patch of `na` x `nb` cells of k = 1 from `origin` along `a` and `b`.
    fn patch(
        &mut self,
        origin: [i32; 3],
        a: [i32; 3],
        na: i32,
        b: [i32; 3],
        nb: i32,
        property: u32,
    ) {
        let k = self.k;
        let at = |i: i32, j: i32| -> [i32; 3] {
            std::array::from_fn(|c| origin[c] * k + i * a[c] + j * b[c])
        };
        for i in 0..na * k {
            for j in 0..nb * k {
                let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let g = corners.map(|c| self.grid(c));
                self.quads += 1;
                let card = format!(
                    "CQUAD4,{},{property},{},{},{},{}",
                    self.quads, g[0], g[1], g[2], g[3]
                );
                self.bulk.card(&card);
            }
        }
    }

    fn new(k: i32) -> Self {
        let mut f = Self {
            bulk: Bulk::default(),
            k,
            grids: HashMap::new(),
            quads: 0,
        };
        for card in [
            "MAT1,1,210000.,,.3,7.85-9",
            "PSHELL,8,1,8.0,1,,1",
            "PSHELL,6,1,6.0,1,,1",
        ] {
            f.bulk.card(card);
        }
        const X: [i32; 3] = [1, 0, 0];
        const Y: [i32; 3] = [0, 1, 0];
        const Z: [i32; 3] = [0, 0, 1];
        for (y, inward) in [(0, [0, 1, 0]), (20, [0, -1, 0])] {
            f.patch([0, y, 0], X, 188, Z, 6, 8);
            f.patch([0, y, 0], X, 188, inward, 2, 8);
            f.patch([0, y, 6], X, 188, inward, 2, 8);
            f.patch([0, y + 2 * inward[1], 0], X, 188, Z, 6, 8);
        }
        for x in [4, 34, 62, 92, 122, 152, 182] {
            f.patch([x, 0, 1], Y, 20, Z, 4, 6);
            f.patch([x, 0, 1], X, 2, Y, 20, 6);
            f.patch([x, 0, 5], X, 2, Y, 20, 6);
        }
        for (n, (at, mass, offset)) in [
            ([14, 0, 6], "0.25", "0.,0.,400."),
            ([14, 20, 6], "0.25", "0.,0.,400."),
            ([100, 0, 6], "0.1", "0.,-300.,-50."),
            ([110, 20, 6], "0.12", "0.,300.,-50."),
        ]
        .into_iter()
        .enumerate()
        {
            let g = f.grid(at.map(|i| i * k));
            f.bulk
                .card(&format!("CONM2,{},{g},,{mass},{offset}", 900_001 + n));
        }
        f
    }

    /// Adds the grid of a wheel 200 mm below and 60 mm outboard, on an RBE3 over 240 x 120 mm of the web.
    fn wheel(&mut self, axle: i32, right: bool) -> u32 {
        let (k, y) = (self.k, if right { 20 } else { 0 });
        let outboard = if right { 60.0 } else { -60.0 };
        let x = [
            f64::from(axle) * CELL,
            f64::from(y) * CELL - 400.0 + outboard,
            -200.0,
        ];
        let point = self.bulk.grid(x);
        let mut card = format!("RBE3,{},,{point},123456,1.0,123", 800_000 + point);
        let mut fields = 6;
        for i in (axle - 3) * k..=(axle + 3) * k {
            for l in 0..=3 * k {
                if fields % 8 == 0 {
                    card.push_str(",\n");
                }
                card.push_str(&format!(",{}", self.grids[&[i, y * k, l]]));
                fields += 1;
            }
        }
        self.bulk.card(&card);
        point
    }
}

/// Returns the model, and the strain at the element centres under a vertical force at each wheel.
fn solve_wheel_loads(k: i32) -> (Model, Solution) {
    let mut frame = Frame::new(k);
    let wheels: Vec<u32> = AXLES
        .into_iter()
        .flat_map(|a| [(a, false), (a, true)])
        .map(|(a, right)| frame.wheel(a, right))
        .collect();
    let model = frame.bulk.model();
    let loads: Vec<UnitLoad> = wheels
        .iter()
        .map(|g| UnitLoad::AtGrid {
            grid: model.grid_ix(*g).unwrap(),
            force: Vec3::new(0.0, 0.0, 1000.0),
            moment: Vec3::zeros(),
        })
        .collect();
    let options = SolveOptions {
        corners: Corners::Leave,
        ..SolveOptions::default()
    };
    let (solution, _) =
        solve_unit_loads(&model, &loads, &options).unwrap_or_else(|e| panic!("{e}"));
    (model, solution)
}

/// Returns the meshes of 40 and 13.3 mm, which are solved once for all tests.
pub fn meshes() -> &'static [(Model, Solution); 2] {
    static MESHES: OnceLock<[(Model, Solution); 2]> = OnceLock::new();
    MESHES.get_or_init(|| [solve_wheel_loads(1), solve_wheel_loads(3)])
}

/// Returns the centre and plane of an element, as a key.
///
/// An element of the coarse mesh and the middle one of the nine fine elements in its place have the same key.
pub fn of_place(model: &Model, i: usize) -> ([i64; 3], [u8; 3]) {
    let s = &model.shells[i];
    let c = centre(model, &s.grids);
    let side = model.grids[s.grids[1].us()].x - model.grids[s.grids[0].us()].x;
    let across = model.grids[s.grids[3].us()].x - model.grids[s.grids[0].us()].x;
    let n = side.cross(&across);
    (
        [c.x, c.y, c.z].map(|v| (v * 100.0).round() as i64),
        [n.x, n.y, n.z].map(|v| (v.abs() > 1e-6 * n.norm()) as u8),
    )
}

pub fn centre(model: &Model, grids: &[GridIx]) -> Vec3 {
    grids[..4]
        .iter()
        .map(|g| model.grids[g.us()].x)
        .sum::<Vec3>()
        / 4.0
}

fn largest_principal_strain(s: &[[f64; 3]; 2]) -> f64 {
    let one = |[x, y, g]: [f64; 3]| ((x + y) / 2.0).abs() + ((x - y) / 2.0).hypot(g / 2.0);
    one(s[0]).max(one(s[1]))
}

#[test]
fn strain_of_a_40_mm_mesh_is_within_2_percent_of_that_of_13_mm_where_it_is_hot() {
    let [(coarse, a), (fine, b)] = meshes();
    let by_place: HashMap<_, usize> = (0..fine.shells.len())
        .map(|i| (of_place(fine, i), i))
        .collect();
    let mut all: Vec<f64> = Vec::new();
    for (load, (axle, y)) in AXLES
        .into_iter()
        .flat_map(|x| [(x, -400.0), (x, 400.0)])
        .enumerate()
    {
        let x = f64::from(axle) * CELL;
        let mut hot: Vec<(f64, f64)> = Vec::new();
        for (i, s) in coarse.shells.iter().enumerate() {
            let c = centre(coarse, &s.grids);
            // The element must be more than 200 mm away from the patch of the load.
            let gap = Vec3::new(
                ((c.x - x).abs() - 120.0).max(0.0),
                (c.y - y).abs(),
                (c.z - 120.0).max(0.0),
            );
            if gap.norm() > 200.0 {
                let f = by_place[&of_place(coarse, i)];
                hot.push((
                    largest_principal_strain(&b.cases[load].shells.centre[f]),
                    largest_principal_strain(&a.cases[load].shells.centre[i]),
                ));
            }
        }
        hot.sort_by(|p, q| q.0.total_cmp(&p.0));
        let mut difference: Vec<f64> = hot[..hot.len() / 10]
            .iter()
            .map(|(fine, coarse)| (coarse / fine - 1.0).abs())
            .collect();
        difference.sort_by(f64::total_cmp);
        eprintln!(
            "frame, 40 against 13 mm, load {load}: median {:.4}, 95 % {:.4}",
            difference[difference.len() / 2],
            difference[difference.len() * 95 / 100]
        );
        all.append(&mut difference);
    }
    all.sort_by(f64::total_cmp);
    let median = all[all.len() / 2];
    assert!(median < 0.02, "median of six loads {median}");
}
