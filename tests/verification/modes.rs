//! Compares modes with closed forms of beams and plates.

use crate::mesh::Bulk;
use strainbridge::fe::*;

const E: f64 = 210_000.0;
const RHO: f64 = 7.85e-9;

fn modes(b: &Bulk, spc: Option<u32>, count: usize) -> ModalSolution {
    solve_modes(&b.model(), spc, None, count, &SolveOptions::default())
        .unwrap_or_else(|e| panic!("{e}"))
}

fn assert_within(what: &str, got: f64, expected: f64, share: f64) {
    assert!(
        (got / expected - 1.0).abs() < share,
        "{what}: {got} for {expected}"
    );
}

/// Returns a slender bar and its length.
///
/// Shear changes Euler's frequencies by the share (h / l)^2, a few parts in ten thousand.
fn cantilever(n: u32) -> (Bulk, f64) {
    let length = 2000.0;
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,{E:?},,.3,7.85-9"));
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let g: Vec<u32> = (0..=n)
        .map(|i| b.grid([length * f64::from(i) / f64::from(n), 0.0, 0.0]))
        .collect();
    for i in 0..n as usize {
        b.card(&format!("CBAR,{},2,{},{},0.,1.,0.", i + 1, g[i], g[i + 1]));
    }
    b.hold("123456", [1]);
    (b, length)
}

#[test]
fn a_cantilever_vibrates_as_euler_states_and_its_modal_masses_are_those_of_the_clamped_beam() {
    let (b, l) = cantilever(80);
    let solved = modes(&b, Some(1), 6);
    assert_eq!(solved.rigid_motions, 0);
    let exact =
        |k: f64, i: f64| k * k / (l * l) * (E * i / (RHO * 200.0)).sqrt() / std::f64::consts::TAU;
    let expected = [
        exact(1.875_104, 4000.0),
        exact(1.875_104, 9000.0),
        exact(4.694_091, 4000.0),
        exact(4.694_091, 9000.0),
        exact(7.854_757, 4000.0),
        exact(7.854_757, 9000.0),
    ];
    for (mode, expected) in solved.modes.iter().zip(expected) {
        // With 80 elements and lumped mass the error is of the order of (pi / 80)^2 at the third bending mode.
        assert_within("frequency", mode.frequency, expected, 2e-3);
        assert!(mode.frequency_error < 1e-8, "{}", mode.frequency_error);
        assert!((mode.generalised_mass - 1.0).abs() < 1e-9);
    }
    // Blevins (1979), table 8-1: the first three bending modes of a clamped-free beam carry 61.3, 18.8 and 6.5 % of its mass.
    let mass = solved.mass.unwrap().mass;
    for (mode, share) in [(0, 0.613), (2, 0.188), (4, 0.0647)] {
        let got = solved.modes[mode].effective_mass[2] / mass;
        // Half of the mass of one grid is at the clamp, one part in 160.
        assert!((got - share).abs() < 0.008, "mode {mode}: {got}");
        assert!(solved.modes[mode].effective_mass[1] / mass < 1e-9);
    }
}

#[test]
fn a_mode_strains_as_its_shape_bends() {
    let (b, l) = cantilever(80);
    let mut model = b.model();
    // Recovery point C is 5 above the axis, along z.
    for p in &mut model.beam_properties {
        p.sections
            .iter_mut()
            .for_each(|s| s.1.recovery[0] = [0.0, 5.0]);
    }
    let solved = solve_modes(&model, Some(1), None, 1, &SolveOptions::default()).unwrap();
    let tip = solved.modes[0].shape[80][2];
    // For the clamped-free beam |w''(0)| = beta^2 |w(l)| at the clamp. The strain is z w''.
    let beta = 1.875_104 / l;
    let strain = solved.strain.cases[0].beams.stations[0][0].1[0];
    assert_within("strain", strain.abs(), 5.0 * beta * beta * tip.abs(), 5e-3);
}

#[test]
fn a_simply_supported_plate_vibrates_as_navier_states() {
    let (a, c, t, n) = (1000.0, 700.0, 5.0, 40);
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,{E:?},,.3,7.85-9"));
    b.card(&format!("PSHELL,1,1,{t:?},1,,1"));
    let ids = b.patch(n, n, |x, y| [a * x, c * y, 0.0]);
    let edge = |i: usize, j: usize| i == 0 || j == 0 || i == n || j == n;
    for (i, row) in ids.iter().enumerate() {
        for (j, g) in row.iter().enumerate() {
            // In-plane motion and rotation about the normal are fixed everywhere. The edges are simply supported and do
            // not rotate about their normal.
            let dofs = match (edge(i, j), i == 0 || i == n, j == 0 || j == n) {
                (false, ..) => "126",
                (_, true, true) => "123456",
                (_, true, _) => "12346",
                _ => "12356",
            };
            b.hold(dofs, [*g]);
        }
    }
    let solved = modes(&b, Some(1), 5);
    let d = E * f64::powi(t, 3) / (12.0 * (1.0 - 0.09));
    let pi = std::f64::consts::PI;
    let mut exact: Vec<f64> = (1..4)
        .flat_map(|m| (1..4).map(move |k| (f64::from(m), f64::from(k))))
        .map(|(m, k)| 0.5 * pi * ((m / a).powi(2) + (k / c).powi(2)) * (d / (RHO * t)).sqrt())
        .collect();
    exact.sort_by(f64::total_cmp);
    for (mode, expected) in solved.modes.iter().zip(exact) {
        // The third mode has 13 elements per half wave along a side.
        assert_within("frequency", mode.frequency, expected, 0.01);
    }
}

#[test]
fn a_free_square_plate_has_six_rigid_motions_no_effective_mass_and_the_published_frequencies() {
    let (a, t, n) = (500.0, 5.0, 30);
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,{E:?},,.3,7.85-9"));
    b.card(&format!("PSHELL,1,1,{t:?},1,,1"));
    b.patch(n, n, |x, y| [a * x, a * y, 0.0]);
    let solved = modes(&b, None, 5);
    assert_eq!(solved.rigid_motions, 6);
    let d = E * f64::powi(t, 3) / (12.0 * (1.0 - 0.09));
    let unit = (d / (RHO * t)).sqrt() / (a * a) / std::f64::consts::TAU;
    // Free square plate with nu = .3, omega a^2 sqrt(rho t / D). Leissa, J. Sound Vib. 31 (1973) 257, gives the upper
    // bounds 13.489, 19.789, 24.432, 35.024. Bardell, J. Sound Vib. 151 (1991) 263, gives converged values. The fourth
    // and fifth are equal.
    for (mode, lambda) in solved
        .modes
        .iter()
        .zip([13.468, 19.596, 24.270, 34.801, 34.801])
    {
        assert_within("frequency", mode.frequency, lambda * unit, 0.01);
        let mass = solved.mass.unwrap().mass;
        assert!(mode.effective_mass[..3].iter().all(|m| m / mass < 1e-9));
    }
    assert!(solved.findings.iter().any(|f| f.code == "close-modes"));
}

#[test]
fn a_structure_without_mass_has_no_modes_and_a_finding_reports_it() {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let (a, e) = (b.grid([0.0; 3]), b.grid([100.0, 0.0, 0.0]));
    b.card(&format!("CBAR,1,2,{a},{e},0.,1.,0."));
    b.hold("123456", [a]);
    let error = solve_modes(&b.model(), Some(1), None, 3, &SolveOptions::default()).unwrap_err();
    assert_eq!(error, FeError::NoMassToVibrate);
}

#[test]
fn modes_that_are_no_longer_wanted_are_not_looked_for() {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let ids: Vec<u32> = (0..20)
        .map(|i| b.grid([50.0 * f64::from(i), 0.0, 0.0]))
        .collect();
    for ends in ids.windows(2) {
        b.card(&format!(
            "CBAR,{},2,{},{},0.,1.,0.",
            100 + ends[0],
            ends[0],
            ends[1]
        ));
    }
    let stop = strainbridge::stop::Stop::new();
    let options = SolveOptions {
        stop: stop.clone(),
        ..SolveOptions::default()
    };
    assert_eq!(
        solve_modes(&b.model(), None, None, 3, &options)
            .unwrap()
            .modes
            .len(),
        3
    );
    stop.ask();
    let error = solve_modes(&b.model(), None, None, 3, &options).unwrap_err();
    assert_eq!(error, FeError::Stopped);
}
