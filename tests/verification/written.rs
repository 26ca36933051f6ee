//! Solids, plies and quadratic shells in a written result file: the values read back equal the solution.

use crate::mesh::Bulk;
use nastran::op2::{EncodedBlock, Op2Writer};
use nastran::results::{Quantity, ResultsFile};
use strainbridge::fe::{Solution, ply_strains};
use strainbridge::report::{planned_blocks, rows_of_block, write_vtu};

#[test]
fn strain_of_solids_plies_and_curved_shells_survives_the_result_file() {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("MAT8,2,140000.,10000.,.3,5000.,5000.,5000.");
    b.card("PSOLID,5,1");
    b.card("PCOMP,1\n,2,0.5,30.,YES,2,0.7,-20.,YES");
    b.card("PSHELL,6,1,2.0,1,,1");
    let ids = b.patch(2, 1, |u, v| [20.0 * u, 10.0 * v, 0.0]);
    // A brick on the second element, and a curved element next to the first.
    let [p, q, r, s] = [ids[1][0], ids[2][0], ids[2][1], ids[1][1]];
    let top: Vec<u32> = [[10., 0., 5.], [20., 0., 5.], [20., 10., 5.], [10., 10., 5.]]
        .iter()
        .map(|x| b.grid(*x))
        .collect();
    b.card(&format!(
        "CHEXA,50,5,{p},{q},{r},{s},{},{}\n,{},{}",
        top[0], top[1], top[2], top[3]
    ));
    let (c, d) = (b.grid([20.0, 20.0, 0.0]), b.grid([10.0, 20.0, 0.0]));
    let m = [
        [15., 10., 0.],
        [20., 15., 1.],
        [15., 20., 0.],
        [10., 15., 1.],
    ]
    .map(|x| b.grid(x));
    b.card(&format!(
        "CQUAD8,60,6,{s},{r},{c},{d},{},{}\n,{},{}",
        m[0], m[1], m[2], m[3]
    ));
    b.hold("123456", ids[0].clone());
    b.force(top[2], [3.0, -2.0, 7.0]);
    b.force(c, [1.0, 4.0, -2.0]);
    let solved = b.solve();
    let (model, case) = (solved.model, solved.case);
    let solution = Solution {
        cases: vec![case.clone()],
        ..Solution::default()
    };
    let mut op2 = Op2Writer::new(Vec::new(), [1, 1, 2000]).unwrap();
    for plan in planned_blocks(&model, &solution) {
        let (block, rows) = rows_of_block(&model, &solution, plan);
        op2.write_encoded(&EncodedBlock::new(&block, &rows).unwrap())
            .unwrap();
    }
    let bytes = op2.finish().unwrap();
    let file = ResultsFile::read(&bytes, "written.op2").unwrap();
    let mut seen = Vec::new();
    // The file has single precision.
    let close = |a: f64, b: f64| assert!((a - b).abs() <= 1e-6 * b.abs() + 1e-12, "{a} for {b}");
    for (i, block) in file.blocks().iter().enumerate() {
        let rows = file.rows(i).unwrap();
        let element = block.element.map_or(0, |e| e.0);
        match (block.quantity, element) {
            (Quantity::Strain, 67) => {
                assert_eq!(rows.len(), 9);
                for (k, want) in case.solids.corners[0].iter().enumerate() {
                    assert_eq!(
                        rows.ids[1 + k].at,
                        model.grids[model.solids[0].grids[k].unwrap().us()].id
                    );
                    for (c, want) in want.iter().enumerate() {
                        close(rows.row(1 + k)[c], *want);
                    }
                }
                for (c, want) in case.solids.centre[0].iter().enumerate() {
                    close(rows.row(0)[c], *want);
                }
                seen.push(element);
            }
            (Quantity::Strain, 64) => {
                let ix = model.shell_ix(60).unwrap();
                for layer in 0..2 {
                    for c in 0..3 {
                        close(
                            rows.row(layer)[1 + c],
                            case.shells.centre[ix.us()][layer][c],
                        );
                        close(
                            rows.row(2 + layer)[1 + c],
                            case.shells.corners[ix.us()][0][layer][c],
                        );
                    }
                }
                seen.push(element);
            }
            (Quantity::PlyStrain, 95) => {
                assert_eq!(rows.len(), 4, "two elements of two plies");
                let ix = model.shell_ix(rows.ids[0].entity).unwrap();
                let plies = ply_strains(&model, ix, &case.shells.centre[ix.us()]);
                for (k, ply) in plies.iter().enumerate() {
                    for c in 0..3 {
                        close(rows.row(k)[c], ply[c]);
                    }
                }
                seen.push(element);
            }
            _ => {}
        }
    }
    seen.sort_unstable();
    assert_eq!(seen, [64, 67, 95]);
    let mut vtu = Vec::new();
    write_vtu(&model, &solution.cases, &mut vtu).unwrap();
    assert!(String::from_utf8_lossy(&vtu).contains("strain of solids"));
}
