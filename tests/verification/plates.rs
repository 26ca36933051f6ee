//! Compares shells of real decks with strain and displacement of MSC and NX runs.

use crate::decks::{find_shared_path, model_of};
use crate::mesh::Bulk;
use nastran::results::{Quantity, ResultsFile};
use strainbridge::fe::from_results::{ReadOptions, solution_from_file};
use strainbridge::fe::*;
use strainbridge::model::Model;

/// Returns the principal strain with the largest magnitude for each element and surface: reference, built-in solver.
fn peaks(model: &Model, reference: &CaseResult, ours: &CaseResult, ids: &[u32]) -> Vec<(f64, f64)> {
    let largest = |[x, y, g]: [f64; 3]| ((x + y) / 2.0).abs() + ((x - y) / 2.0).hypot(g / 2.0);
    let mut out = Vec::new();
    let theirs = &reference.shells;
    for (shell, r) in theirs.elements.iter().zip(&theirs.centre) {
        let id = model.shells[shell.us()].id;
        if !ids.is_empty() && !ids.contains(&id) {
            continue;
        }
        let place = ours
            .shells
            .elements
            .iter()
            .position(|s| model.shells[s.us()].id == id);
        let got = ours.shells.centre[place.unwrap()];
        out.extend((0..2).map(|z| (largest(r[z]), largest(got[z]))));
    }
    out.sort_by(|a, b| b.0.total_cmp(&a.0));
    out
}

/// Returns the median of the relative differences of the first `n` peaks.
fn median_difference(peaks: &[(f64, f64)], n: usize) -> f64 {
    let mut d: Vec<f64> = peaks[..n]
        .iter()
        .map(|(r, g)| (g / r - 1.0).abs())
        .collect();
    d.sort_by(f64::total_cmp);
    d[d.len() / 2]
}

#[test]
fn the_hottest_strain_of_a_plate_agrees_with_msc() {
    let (Some(deck), Some(op2)) = (
        find_shared_path("nastran/msc_plate/plate.bdf"),
        find_shared_path("nastran/msc_plate/plate.op2"),
    ) else {
        return;
    };
    let (model, control) = model_of(&deck);
    let bytes = std::fs::read(op2).unwrap();
    let file = ResultsFile::read(&bytes, "plate.op2").unwrap();
    let theirs = solution_from_file(&model, "plate.op2", &file, &ReadOptions::default());
    let s = control.effective_subcases()[0].clone();
    let case = LoadCase {
        subcase: s.id,
        label: String::new(),
        loads: s.load.into_iter().map(UnitLoad::Set).collect(),
        spc: s.spc,
        mpc: s.mpc,
        relief: Relief::None,
    };
    let (ours, _) =
        solve_cases(&model, &[case], &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let peaks = peaks(&model, &theirs.cases[0], &ours.cases[0], &[]);
    assert_eq!(peaks.len(), 50);
    let (hot, all) = (median_difference(&peaks, 5), median_difference(&peaks, 50));
    eprintln!("msc_plate: median of the hottest tenth {hot:.5}, of all {all:.5}");
    assert!(hot < 0.05 && all < 0.05, "{hot} {all}");
}

/// Six shells cut out of a model with all kinds of elements. The displacements of one side are enforced, and the forces
/// from the rest of the model act on the other side.
#[test]
fn shells_cut_out_of_an_nx_model_move_and_strain_as_they_did_there() {
    let (Some(deck), Some(op2)) = (
        find_shared_path("nastran/nx_static_shell_bar/static_solid_shell_bar.bdf"),
        find_shared_path("nastran/nx_static_shell_bar/static_solid_shell_bar.op2"),
    ) else {
        return;
    };
    const SHELLS: std::ops::RangeInclusive<u32> = 6..=11;
    const HELD: [u32; 4] = [1, 2, 3, 4];
    const LOADED: [u32; 4] = [14, 15, 16, 17];
    let (whole, _) = model_of(&deck);
    let bytes = std::fs::read(op2).unwrap();
    let file = ResultsFile::read(&bytes, "op2").unwrap();
    let theirs = solution_from_file(&whole, "op2", &file, &ReadOptions::default());
    let reference = &theirs.cases[0];
    let mut b = Bulk::default();
    b.card("MAT1,1,2.9+7,1.1+7,.32,.283");
    b.card("PSHELL,4,1,.25,1,,1");
    let displacement = |id: u32| reference.displacement[whole.grid_ix(id).unwrap().us()];
    for id in HELD.into_iter().chain(LOADED) {
        let x = whole.grids[whole.grid_ix(id).unwrap().us()].x;
        b.card(&format!("GRID,{id},,{:?},{:?},{:?}", x.x, x.y, x.z));
    }
    for s in whole.shells.iter().filter(|s| SHELLS.contains(&s.id)) {
        let n = s.shape.n_corners();
        let ids: Vec<String> = s.grids[..n]
            .iter()
            .map(|g| whole.grids[g.us()].id.to_string())
            .collect();
        b.card(&format!("{},{},4,{}", s.shape.card(), s.id, ids.join(",")));
    }
    for id in HELD {
        for (i, u) in displacement(id).iter().enumerate() {
            b.card(&format!("SPC,1,{id},{},{u:.9E}", i + 1));
        }
    }
    let block = file
        .blocks()
        .iter()
        .position(|b| b.quantity == Quantity::GridPointForce)
        .unwrap();
    let rows = file.rows(block).unwrap();
    for id in LOADED {
        let mut f = [0.0; 6];
        for (i, row) in rows.ids.iter().enumerate() {
            if row.entity == id && SHELLS.contains(&row.at) {
                // The force of the shells on the grid. The rest of the model exerts the opposite force.
                f.iter_mut().zip(rows.row(i)).for_each(|(f, v)| *f -= v);
            }
        }
        b.card(&format!(
            "FORCE,1,{id},0,1.0,{:.9E},{:.9E},{:.9E}",
            f[0], f[1], f[2]
        ));
        b.card(&format!(
            "MOMENT,1,{id},0,1.0,{:.9E},{:.9E},{:.9E}",
            f[3], f[4], f[5]
        ));
    }
    let ours = b.solve();
    let largest = LOADED
        .iter()
        .flat_map(|g| displacement(*g)[..3].to_vec())
        .fold(0.0_f64, |a, v| a.max(v.abs()));
    for id in LOADED {
        for (c, (got, expected)) in ours
            .displacement_at(id)
            .iter()
            .zip(displacement(id))
            .take(3)
            .enumerate()
        {
            assert!(
                (got - expected).abs() < 0.02 * largest,
                "grid {id} {c}: {got:e} for {expected:e}, largest {largest:e}"
            );
        }
    }
    let ids: Vec<u32> = SHELLS.collect();
    // Element indices differ between the two models, so the reference elements are found by id.
    let mut renamed = reference.clone();
    let kept: Vec<usize> = reference
        .shells
        .elements
        .iter()
        .enumerate()
        .filter(|(_, s)| ids.contains(&whole.shells[s.us()].id))
        .map(|(i, _)| i)
        .collect();
    renamed.shells.elements = std::sync::Arc::new(
        kept.iter()
            .map(|&i| {
                let id = whole.shells[reference.shells.elements[i].us()].id;
                let at = ours.model.shells.iter().position(|s| s.id == id).unwrap();
                strainbridge::model::ShellIx(at as u32)
            })
            .collect(),
    );
    renamed.shells.centre = kept.iter().map(|&i| reference.shells.centre[i]).collect();
    let peaks = peaks(&ours.model, &renamed, &ours.case, &ids);
    assert_eq!(peaks.len(), 12);
    let (hot, all) = (median_difference(&peaks, 3), median_difference(&peaks, 12));
    eprintln!("nx_static_shell_bar: median of the hottest quarter {hot:.5}, of all {all:.5}");
    assert!(hot < 0.05, "{hot}; {peaks:?}");
}
