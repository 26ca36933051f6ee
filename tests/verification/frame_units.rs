//! Compares unit loads with inertia relief on a truck ladder frame with MYSTRAN
//! (`../shared/nastran/mystran_frame_units`).

use crate::decks::{find_shared_path, model_of};
use nastran::results::ResultsFile;
use strainbridge::fe::from_results::{ReadOptions, solution_from_file};
use strainbridge::fe::*;
use strainbridge::model::{Model, RigidKind, Vec3};

/// Returns the positions of a loaded grid and of the grids over which an RBE3 distributes its load.
fn footprint(model: &Model, loaded: strainbridge::model::GridIx) -> Vec<Vec3> {
    let mut x = vec![model.grids[loaded.us()].x];
    for r in &model.rigids {
        if let RigidKind::Mean {
            reference, arms, ..
        } = &r.kind
            && *reference == loaded
        {
            x.extend(arms.iter().map(|a| model.grids[a.2.us()].x));
        }
    }
    x
}

fn largest_principal_strain([ex, ey, g]: [f64; 3]) -> f64 {
    ((ex + ey) / 2.0).abs() + ((ex - ey) / 2.0).hypot(g / 2.0)
}

#[test]
fn vertical_wheel_loads_on_a_ladder_frame_strain_it_as_in_mystran() {
    let Some(deck) = find_shared_path("nastran/mystran_frame_units/frame.bdf") else {
        return;
    };
    let Some(op2) = find_shared_path("nastran/mystran_frame_units/frame.op2") else {
        return;
    };
    let (model, control) = model_of(&deck);
    let bytes = std::fs::read(op2).unwrap();
    let file = ResultsFile::read(&bytes, "frame.op2").unwrap();
    let theirs = solution_from_file(&model, "frame.op2", &file, &ReadOptions::default());
    let cases: Vec<LoadCase> = control
        .effective_subcases()
        .iter()
        .take(6)
        .map(|s| LoadCase {
            subcase: s.id,
            label: String::new(),
            loads: s.load.into_iter().map(UnitLoad::Set).collect(),
            spc: s.spc,
            mpc: s.mpc,
            relief: Relief::Automatic,
        })
        .collect();
    let (ours, report) =
        solve_cases(&model, &cases, &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(report.balance.iter().all(|b| b.residual < 1e-10));
    for (case, ours) in cases.iter().zip(&ours.cases) {
        let theirs = theirs
            .cases
            .iter()
            .find(|c| c.subcase == case.subcase)
            .unwrap();
        let set = model
            .load_sets
            .iter()
            .find(|s| UnitLoad::Set(s.sid) == case.loads[0])
            .unwrap();
        let strainbridge::model::Load::Force(grid, _) = set.loads[0].1 else {
            panic!("a force")
        };
        let near = footprint(&model, grid);
        let (mut difference, mut size) = (0.0, 0.0);
        let mut hot: Vec<(f64, f64)> = Vec::new();
        for (shell, reference) in theirs.shells.elements.iter().zip(&theirs.shells.centre) {
            let s = &model.shells[shell.us()];
            let centre = s.grids[..4]
                .iter()
                .map(|g| model.grids[g.us()].x)
                .sum::<Vec3>()
                / 4.0;
            if near.iter().any(|x| (x - centre).norm() <= 200.0) {
                continue;
            }
            let got = &ours.shells.centre[shell.us()];
            for (a, b) in got.iter().flatten().zip(reference.iter().flatten()) {
                difference += (a - b) * (a - b);
                size += b * b;
            }
            let peak = |s: &[[f64; 3]; 2]| {
                largest_principal_strain(s[0]).max(largest_principal_strain(s[1]))
            };
            hot.push((peak(reference), peak(got)));
        }
        let rms = (difference / size).sqrt();
        assert!(rms < 0.05, "subcase {}: rms {rms}", case.subcase);
        hot.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut relative: Vec<f64> = hot[..hot.len() / 10]
            .iter()
            .map(|(r, g)| (g / r - 1.0).abs())
            .collect();
        relative.sort_by(f64::total_cmp);
        let median = relative[relative.len() / 2];
        eprintln!(
            "MYSTRAN frame, subcase {}: median {median:.4}, 95 % {:.4}, rms {rms:.4}",
            case.subcase,
            relative[relative.len() * 95 / 100]
        );
        assert!(
            median < 0.015,
            "subcase {}: median of the hottest tenth {median}",
            case.subcase
        );
    }
}
