//! Compares candidates with gauges built at the same places.

use crate::command::find_shared_path;
use strainbridge::fe::CaseResult;
use strainbridge::fe::from_results::{ReadOptions, solution_from_file};
use strainbridge::fe::strain_tensor::Surface;
use strainbridge::gauge::{
    Bridge, CornerRows, GaugeSpec, build, gauge_reading, strain_gradient_gauge,
};
use strainbridge::model::{Model, ShellIx};
use strainbridge::placement::angle_variance;
use strainbridge::placement::candidates::{Angles, Choice, Scatter};
use strainbridge::placement::gradient::forms;
use strainbridge::placement::sites::{Site, axis_of, bridges};
use strainbridge::sensitivity::{Load, LoadCaseOf};

fn frame() -> Option<(Model, Vec<CaseResult>)> {
    let case = find_shared_path("nastran/mystran_frame_units")?;
    let read = nastran::bdf::read_deck(
        "frame.bdf",
        std::fs::read(case.join("frame.bdf")).unwrap(),
        &mut nastran::bdf::MemoryLoader::default(),
    );
    let (model, _) = Model::from_deck(&read);
    let bytes = std::fs::read(case.join("frame.op2")).unwrap();
    let file = nastran::results::ResultsFile::read(&bytes, "frame.op2").unwrap();
    let solution = solution_from_file(&model, "frame.op2", &file, &ReadOptions::default());
    Some((model, solution.cases.into_iter().take(3).collect()))
}

fn loads(cases: &[CaseResult]) -> Vec<LoadCaseOf<'_>> {
    cases
        .iter()
        .enumerate()
        .map(|(i, case)| LoadCaseOf {
            load: Load::from_name(format!("F{i}")),
            applied: 1000.0,
            case,
        })
        .collect()
}

const WIRINGS: [Bridge; 4] = [
    Bridge::Quarter,
    Bridge::HalfBending,
    Bridge::FullBending,
    Bridge::Shear,
];

fn some_sites(model: &Model) -> Vec<Site> {
    (0..model.shells.len() as u32)
        .step_by(97)
        .flat_map(|i| [Surface::Bottom, Surface::Top].map(|s| (ShellIx(i), s)))
        .collect()
}

#[test]
fn rows_of_candidates_are_what_gauges_of_the_same_wiring_read() {
    let Some((model, cases)) = frame() else {
        return;
    };
    let (loads, sites) = (loads(&cases), some_sites(&model));
    let scales = [10_000.0, 5_000.0, 2_000.0];
    for bridge in WIRINGS {
        let scatter = Scatter::with_uniform_noise(1.0);
        let c = bridges(
            &model,
            &sites,
            bridge,
            &loads,
            &scales,
            Angles::Continuous,
            scatter,
        );
        for (place, &(shell, surface)) in sites.iter().enumerate() {
            let angle = 0.1 + 0.37 * place as f64;
            let spec = GaugeSpec {
                surface: Some(surface),
                bridge,
                angle_rad: axis_of(bridge, angle),
                ..GaugeSpec::place_on_shell("g", shell)
            };
            let gauge = build(&model, &spec, CornerRows::Absent)
                .unwrap()
                .0
                .remove(0);
            let row = c.row(Choice {
                place: place as u32,
                step: 0,
                angle,
            });
            for (l, load) in loads.iter().enumerate() {
                let read = gauge_reading(&gauge, load.case).unwrap() * scales[l] / 1000.0 * 1e6;
                assert!(
                    (row[l] - read).abs() < 1e-9 * (1.0 + read.abs()),
                    "{bridge:?} {place}: {} {read}",
                    row[l]
                );
            }
        }
    }
}

#[test]
fn forms_of_misplacement_are_the_changes_of_gauges_moved_along_both_directions() {
    let Some((model, cases)) = frame() else {
        return;
    };
    let (loads, sites) = (loads(&cases), some_sites(&model));
    let scales = [10_000.0, 5_000.0, 2_000.0];
    let mut compared = 0;
    for bridge in [Bridge::Quarter, Bridge::HalfBending] {
        let forms = forms(&model, &sites, bridge, &loads, &scales, 1.0);
        for (&(shell, surface), form) in sites.iter().zip(&forms) {
            let spec = |angle_rad: f64| GaugeSpec {
                surface: Some(surface),
                bridge,
                angle_rad,
                ..GaugeSpec::place_on_shell("g", shell)
            };
            for angle in [0.0, 0.6, 1.5] {
                let one = |t: f64| {
                    build(&model, &spec(t), CornerRows::Absent)
                        .unwrap()
                        .0
                        .remove(0)
                };
                let gauge = one(angle);
                let ways = [
                    one(0.0).direction,
                    one(std::f64::consts::FRAC_PI_2).direction,
                ];
                // On these rectangles, the neighbours are along the axes of the element. A fit along each axis then
                // equals the fit in the plane.
                let square: Option<f64> = ways
                    .into_iter()
                    .map(|w| {
                        let g = strain_gradient_gauge(&gauge, &model, w)?;
                        let mut sum = 0.0;
                        for (l, load) in loads.iter().enumerate() {
                            sum +=
                                (gauge_reading(&g, load.case)? * scales[l] / 1000.0 * 1e6).powi(2);
                        }
                        Some(sum)
                    })
                    .sum();
                let Some(square) = square else { continue };
                let form = angle_variance::value(
                    &angle_variance::of_row(form),
                    &angle_variance::phases(angle),
                );
                // The limit is 1e-4, because of the small share that keeps a direction without neighbours at zero.
                assert!(
                    (form - square).abs() < 1e-4 * (square + 1e-6),
                    "{bridge:?} {shell:?} {form} {square}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 100, "{compared}");
}
