//! A truck ladder frame, unit loads with inertia relief, against MYSTRAN (`../shared/nastran/mystran_frame_units`).

use crate::decks::{model_of, shared};
use strainbridge::fe::*;

#[test]
fn vertical_wheel_loads_on_a_ladder_frame_strain_it_as_mystran_says() {
    let Some(path) = shared("nastran/mystran_frame_units/frame.bdf") else { return };
    let (model, case_control) = model_of(&path);
    let cases: Vec<LoadCase> = case_control.effective_subcases().iter().take(6).map(|s| LoadCase {
        subcase: s.id, label: s.label.clone().unwrap_or_default(), loads: vec![UnitLoad::Set(s.load.unwrap())],
        spc: s.spc, mpc: s.mpc, relief: relief_of(&model, s.spc, s.suport1) }).collect();
    let t = std::time::Instant::now();
    let (solution, report) = solve_cases(&model, &cases, &SolveOptions::default()).unwrap();
    eprintln!("{:?} {report:?} {:?}", t.elapsed(), solution.findings);
}
