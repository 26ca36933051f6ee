//! The relations.

use crate::answers::{Answers, Asked, Measured, Source, answers};
use crate::cards::{FREE, Files, Form, Width};
use crate::frame::{Frame, Kind, Seat, System, Units, V};
use crate::structures::{ladder, oblique_rotation, plate};
use nalgebra::Matrix3;
use std::sync::OnceLock;

const ALL: (Asked, Source) = (Asked::All, Source::Solver);

/// The ladder, what is measured on it, and the answers.
fn base() -> &'static (Frame, Measured, Answers) {
    static BASE: OnceLock<(Frame, Measured, Answers)> = OnceLock::new();
    BASE.get_or_init(|| {
        let frame = ladder();
        let measured = Measured::from_base(&frame, FREE);
        let answers = answers(&frame, FREE, &measured, ALL);
        (frame, measured, answers)
    })
}

/// Fails where a number differs by more than `tolerance` of the largest of its group; `kept` selects the groups that are compared.
fn compare(base: &Answers, got: &Answers, tolerance: f64, kept: impl Fn(&str) -> bool) {
    let mut wrong = String::new();
    let mut worst = (0.0, "");
    for (group, items) in &base.0 {
        let Some(other) = got.0.get(group).filter(|_| kept(group)) else {
            assert!(!kept(group), "{group} is missing");
            continue;
        };
        let scale = items.values().fold(0.0_f64, |m, v| m.max(v.abs()));
        let names =
            |a: &std::collections::BTreeMap<String, f64>| a.keys().cloned().collect::<Vec<_>>();
        if names(items) != names(other) {
            wrong += &format!("{group}: {:?} became {:?}\n", names(items), names(other));
            continue;
        }
        for (name, value) in items {
            let off = (other[name] - value).abs() / scale;
            if !(off <= worst.0) {
                worst = (off, group);
            }
            if !(off <= tolerance) {
                wrong += &format!("{group}, {name}: {value:e} became {:e}\n", other[name]);
            }
        }
    }
    eprintln!("largest difference {:e} in {}", worst.0, worst.1);
    assert!(wrong.is_empty(), "{wrong}");
}

fn is_any_group(_: &str) -> bool {
    true
}

/// Asks the changed ladder and compares.
fn holds(tolerance: f64, change: impl Fn(&mut Frame)) {
    let (frame, measured, base) = base();
    let mut changed = frame.clone();
    change(&mut changed);
    let got = answers(&changed, FREE, measured, ALL);
    compare(base, &got, tolerance, is_any_group);
}

fn holds_in_form(form: Form) {
    let (frame, measured, base) = base();
    let got = answers(frame, form, measured, ALL);
    compare(base, &got, EQUAL, is_any_group);
}

/// The model is made of cards in the order of their ids, so that the arithmetic is the same (measured: 0).
const EQUAL: f64 = 0.0;

#[test]
fn the_order_of_cards_changes_nothing() {
    holds_in_form(Form {
        permuted: true,
        ..FREE
    });
}

#[test]
fn small_and_large_field_mean_what_free_field_means() {
    for width in [Width::Small, Width::Large] {
        holds_in_form(Form { width, ..FREE });
    }
}

#[test]
fn continuations_by_name_belong_to_their_cards_at_the_end_of_the_deck() {
    holds_in_form(Form {
        width: Width::Small,
        named: true,
        ..FREE
    });
}

#[test]
fn included_files_are_part_of_the_deck() {
    holds_in_form(Form {
        files: Files::Included,
        ..FREE
    });
}

#[test]
fn ids_are_names() {
    // Another order of elimination, whose rounding the load that is hardest to separate has a thousand times (measured: 2.0e-9).
    holds(3.9e-9, |f| f.ids = (6000, -3));
}

#[test]
fn the_order_of_gauges_columns_and_rows_changes_nothing() {
    let (frame, measured, base) = base();
    let mut changed = frame.clone();
    changed.reversed_tables = true;
    let got = answers(&changed, FREE, measured, ALL);
    // Errors are drawn by gauge, in their order. Sums over the gauges are added up in another order (measured: 9.0e-14).
    compare(base, &got, 1.7e-13, |group| !is_random_draw(group));
    compare_study(base, &got);
}

/// Whether a group is of random draws.
fn is_random_draw(group: &str) -> bool {
    group.starts_with("study")
}

/// Compares other draws of the same errors: four standard deviations of the difference of two estimates. An error that is a product, of an
/// angle and a load, has a kurtosis of 9: its deviation is estimated to `sqrt(8 / 4 n)` of itself.
fn compare_study(base: &Answers, got: &Answers) {
    let trials = crate::job::TRIALS as f64;
    for (group, items) in base.0.iter().filter(|g| g.0.starts_with("study: ")) {
        if group.ends_with("errors") {
            continue;
        }
        let other = &got.0[group];
        if let Some(sd) = items.get("sd") {
            let off = (other["sd"] / sd).ln().abs();
            assert!(
                off < 4.0 * (2.0 * 8.0 / 4.0 / trials).sqrt(),
                "{group}: {sd} became {}",
                other["sd"]
            );
        } else {
            let off = (other[""] - items[""]).abs();
            let spread = (0.05_f64 * 0.95 * 2.0 / trials).sqrt();
            assert!(
                off < 4.0 * spread,
                "{group}: {} became {}",
                items[""],
                other[""]
            );
        }
    }
}

#[test]
fn a_rotated_structure_gives_equal_answers() {
    let (frame, measured, base) = base();
    let mut changed = frame.clone().transform(oblique_rotation());
    changed.loads.iter_mut().for_each(|l| l.system = 1);
    let got = answers(
        &changed,
        FREE,
        measured,
        (Asked::WithoutPayload, Source::Solver),
    );
    // Coordinates are rounded to 15 digits, stiffness is summed in another frame, and the load that is hardest to separate has a thousand
    // times the rounding of the strain (measured: 6.0e-9).
    compare(base, &got, 1.1e-8, |group| !group.starts_with("payload"));
}

/// A quarter turn: the box about the structure, in which a payload may be, turns with it.
#[test]
fn a_structure_rotated_about_the_vertical_gives_the_same_payload() {
    let turn = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let (frame, measured, base) = base();
    let mut changed = frame.clone().transform(turn);
    for load in changed
        .loads
        .iter_mut()
        .filter(|l| l.name.ends_with(['X', 'Y']))
    {
        load.system = 1;
    }
    let got = answers(&changed, FREE, measured, ALL);
    // Stiffness is summed in another frame, of the same digits (measured: 2.7e-9).
    compare(base, &got, 5.3e-9, is_any_group);
}

#[test]
fn a_mirrored_structure_gives_equal_answers() {
    let mirror = Matrix3::from_diagonal(&V::new(1.0, -1.0, 1.0));
    let (frame, measured, base) = base();
    let got = answers(&frame.clone().transform(mirror), FREE, measured, ALL);
    // Signs change, and with them the frames of the elements (measured: 9.4e-12).
    compare(base, &got, 1.8e-11, |group| {
        !is_random_draw(group) && !group.starts_with("place: expected")
    });
    compare_study(base, &got);
}

/// Asks the ladder with the corners of some shells numbered the other way round. Angles are drawn about the other normal.
fn holds_flipped(tolerance: f64, which: impl Fn(usize) -> bool) {
    let (frame, measured, base) = base();
    let mut changed = frame.clone();
    for (i, shell) in changed.shells.iter_mut().enumerate() {
        if which(i) {
            shell.corners.reverse();
            shell.flipped = true;
        }
    }
    let got = answers(&changed, FREE, measured, ALL);
    compare(base, &got, tolerance, |group| !is_random_draw(group));
    compare_study(base, &got);
}

#[test]
fn shells_with_reversed_normals_give_equal_answers_on_their_other_side() {
    // The stiffness of each shell is summed in another frame (measured: 7.6e-9).
    holds_flipped(1.5e-8, |_| true);
}

#[test]
fn shells_with_normals_to_either_side_give_equal_answers() {
    // The stiffness of a quarter of the shells is summed in another frame (measured: 4.2e-9).
    holds_flipped(8.3e-9, |i| i % 4 == 1);
}

#[test]
fn the_first_corner_of_a_shell_is_any_of_them() {
    // The stiffness of each shell is summed in a turned frame (measured: 4.6e-9).
    holds(9.1e-9, |f| {
        for (i, s) in f.shells.iter_mut().enumerate() {
            let by = 1 + i % (s.corners.len() - 1);
            s.corners.rotate_left(by);
        }
    });
}

#[test]
fn strain_does_not_depend_on_the_unit_system() {
    let systems = [
        ("m-kg-s", 1e-3, 1.0, 1.0),
        ("mm-kg-s", 1.0, 1e3, 1.0),
        ("in-lbf-s", 1.0 / 25.4, 1.0 / LBF, 0.0254 / LBF),
    ];
    for (name, length, force, mass) in systems {
        eprintln!("{name}");
        // Every number of the deck is rounded to other digits (measured: 1.4e-8, 1.9e-8 and 1.1e-8).
        holds(3.7e-8, |f| {
            f.units = Units {
                name,
                length,
                force,
                mass,
            };
        });
    }
}

/// N a pound-force.
const LBF: f64 = 4.448_221_615_260_5;

#[test]
fn places_and_displacements_are_the_same_in_cylindrical_and_spherical_systems() {
    // Radii and angles are rounded to 15 digits (measured: 1.8e-9).
    holds(3.6e-9, |f| {
        for (i, g) in f.grids.iter_mut().enumerate() {
            g.cp = [0, 3, 4, 3][i % 4];
            g.cd = [4, 0, 3][i % 3];
        }
    });
}

/// Asks the ladder with every gauge that `which` takes in one of the coordinate systems, in turn.
fn holds_in_systems(tolerance: f64, which: impl Fn(&Seat) -> bool) {
    holds(tolerance, |f| {
        let gauges = f.gauges.iter_mut().filter(|g| which(&g.seat));
        for (gauge, system) in gauges.zip([3, 4, 1].into_iter().cycle()) {
            gauge.system = system;
        }
    });
}

#[test]
fn directions_of_gauges_by_element_are_the_same_in_any_system() {
    // Directions are rounded to 15 digits (measured: 1.1e-13).
    holds_in_systems(2.2e-13, |seat| matches!(seat, Seat::Shell { .. }));
}

#[test]
fn places_and_directions_of_gauges_by_position_are_the_same_in_any_system() {
    // Places and directions are rounded to 15 digits (measured: 5.3e-13).
    holds_in_systems(1e-12, |seat| matches!(seat, Seat::Point(_)));
}

#[test]
fn a_load_in_a_cylindrical_system_acts_along_the_axes_at_its_grid() {
    let (frame, measured, base) = base();
    let mut changed = frame.clone();
    // Radial at the third wheel is y, along the axis is z.
    let origin = changed.x(321) - V::new(0.0, 500.0, 0.0);
    changed.systems.push(System {
        kind: Kind::Cylindrical,
        origin,
        axes: Matrix3::identity(),
    });
    let system = changed.systems.len() as u32;
    for load in changed.loads.iter_mut().filter(|l| l.grid == 321) {
        load.system = system;
    }
    let ask = (Asked::WithoutPayload, Source::Solver);
    let got = answers(&changed, FREE, measured, ask);
    // The axes at the grid are those of the basic frame to the last digit (measured: 0).
    compare(base, &got, EQUAL, |group| !group.starts_with("payload"));
}

#[test]
fn the_size_of_the_applied_load_changes_nothing() {
    // Rounding of a factor and a division (measured: 3.3e-11).
    holds(6.5e-11, |f| {
        for (i, load) in f.loads.iter_mut().enumerate() {
            load.applied = [-2.5, 1e4, 0.01][i % 3];
        }
    });
}

#[test]
fn loads_counted_the_other_way_round_are_negative() {
    let (frame, measured, base) = base();
    let mut changed = frame.clone();
    changed.loads.iter_mut().for_each(|l| l.system = 2);
    let ask = (Asked::WithoutPayload, Source::Solver);
    let got = answers(&changed, FREE, measured, ask);
    let kept = |group: &str| {
        !["payload", "study", "place: expected"]
            .iter()
            .any(|s| group.starts_with(s))
    };
    // A change of sign rounds nothing (measured: 0).
    compare(base, &got, EQUAL, kept);
    compare_study(base, &got);
}

#[test]
fn results_of_a_file_are_those_of_the_solver() {
    let (frame, measured, base) = base();
    let got = answers(frame, FREE, measured, (Asked::All, Source::Results));
    // Strain in single precision, times the condition of the loads (measured: 8.5e-7).
    compare(base, &got, 1.6e-6, |group| !is_random_draw(group));
    compare_study(base, &got);
}

#[test]
fn an_offset_plate_is_where_its_grids_and_offset_put_it() {
    let frame = plate(0.0);
    let measured = Measured::from_base(&frame, FREE);
    let base = answers(&frame, FREE, &measured, ALL);
    for offset in [3.0, -3.0, 14.0] {
        eprintln!("offset {offset}");
        let got = answers(&plate(offset), FREE, &measured, ALL);
        // Reactions and displacements are those of the grids, which moved; both sides of a plate that bends are as good for a layout.
        let kept = |group: &str| {
            let differ = [
                "solve: displacement",
                "solve: reactions",
                "solve: strain",
                "solve: centre",
            ];
            // So are they for the largest stress of an element.
            let ties = [
                "place: axes",
                "place: expected",
                "place: sd",
                "respond: sd",
                "respond: stress",
            ];
            let mut left_out = differ.iter().chain(&ties);
            !left_out.any(|s| group.starts_with(s))
        };
        // Arms of the offset are products and sums that the grids in the middle do without (measured: 8.2e-12, 8.2e-12 and 3.9e-12).
        compare(&base, &got, 1.6e-11, kept);
    }
}
