//! Gauges on shells whose elements state their thickness. The skins are half the local thickness away from the
//! reference plane.
//!
//! MSC Nastran Quick Reference Guide, PSHELL: `T` in the defaults of Z1 and Z2 is the local thickness. If the
//! connection entry states a thickness, that one is the local thickness.

use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, place, respond, sensitivity};

const E: f64 = 200_000.0;
/// Force and moment per length of the edges x = -20 and x = 20.
const FORCE: f64 = 200.0;
const MOMENT: f64 = 200.0;

/// Returns a free square plate of 4 by 4 elements of 10 mm with PSHELL `property`. `corners` are the fields after PID
/// and grids of each element.
fn plate(property: &str, triangles: bool, corners: &str) -> String {
    let mut deck = String::from("SOL 101\nCEND\nLOAD = 2\nBEGIN BULK\nPARAM,INREL,-2\n");
    let grid = |i: u32, j: u32| 1 + i + 5 * j;
    for j in 0..5 {
        for i in 0..5 {
            let [x, y] = [i, j].map(|k| 10.0 * f64::from(k) - 20.0);
            deck += &format!("GRID,{},,{x:.1},{y:.1},0.\n", grid(i, j));
        }
        // Each grid of an element takes half of the load of the element.
        let length = if j == 0 || j == 4 { 5.0 } else { 10.0 };
        for (g, sign) in [(grid(0, j), -1.0), (grid(4, j), 1.0)] {
            let [f, m] = [FORCE, MOMENT].map(|v| sign * v * length);
            deck += &format!("FORCE,2,{g},,{f:.1},1.,0.,0.\nMOMENT,3,{g},,{m:.1},0.,1.,0.\n");
        }
    }
    for j in 0..4 {
        for i in 0..4 {
            let id = 1 + i + 4 * j;
            let [a, b, c, d] = [
                grid(i, j),
                grid(i + 1, j),
                grid(i + 1, j + 1),
                grid(i, j + 1),
            ];
            if triangles {
                deck += &format!("CTRIA3,{id},1,{a},{b},{c}{corners}\n");
                deck += &format!("CTRIA3,{},1,{a},{c},{d}{corners}\n", id + 100);
            } else {
                deck += &format!("CQUAD4,{id},1,{a},{b},{c},{d}{corners}\n");
            }
        }
    }
    deck + property + "\nMAT1,1,200000.,,.25,7.85-9\nENDDATA\n"
}

const HEAD: &str = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\nsupport = \"free\"\n[[load]]\nname = \"P\"\nload_set = 2\nexpected = 1.0\n[[load]]\nname = \"M\"\nload_set = 3\nexpected = 1.0\n";
const TWO_SIDES: &str = "[[gauge]]\nname = \"t\"\nelement = 6\nsurface = \"top\"\ndirection = [1, 0, 0]\n[[gauge]]\nname = \"b\"\nelement = 6\nsurface = \"bottom\"\ndirection = [1, 0, 0]\n";

fn files(deck: String, job: &str) -> InMemory {
    InMemory::default()
        .with_file("plate.bdf", deck)
        .with_file("job.toml", format!("{HEAD}{job}"))
}

/// Returns the strain along x at height `z` of a plate of thickness `t` under the force and the moment: `N / (E t)` and
/// `12 m z / (E t^3)`.
fn strain(t: f64, z: f64) -> [f64; 2] {
    [FORCE / (E * t), 12.0 * MOMENT * z / (E * t.powi(3))]
}

/// Returns the rows of S, strain.
fn rows(files: &InMemory) -> Vec<[f64; 2]> {
    let job = Job::read("job.toml", files).unwrap();
    let s = sensitivity(&job, &Context::new(files)).unwrap();
    let s = &s.prepared.sensitivity.values;
    (0..s.nrows()).map(|i| [s[(i, 0)], s[(i, 1)]]).collect()
}

fn assert_near(got: &[[f64; 2]], expected: [[f64; 2]; 2], of: &str) {
    assert_eq!(got.len(), 2, "{of}");
    for (g, e) in got.iter().flatten().zip(expected.as_flattened()) {
        assert!((g - e).abs() < 1e-9 * strain(4.0, 2.0)[1], "{of}: {g} {e}");
    }
}

#[test]
fn a_gauge_reads_the_skin_of_the_thickness_that_its_element_states() {
    let both = |t: f64, z: f64| [strain(t, z), strain(t, -z)];
    let property = "PSHELL,1,1,2.,1,,1";
    for (deck, expected, of) in [
        (
            plate(property, false, "\n,,,4.,4.,4.,4."),
            both(4.0, 2.0),
            "T1 to T4",
        ),
        (
            plate(property, false, "\n,,1,2.,2.,2.,2."),
            both(4.0, 2.0),
            "TFLAG",
        ),
        (
            plate(property, true, "\n,,,4.,4.,4."),
            both(4.0, 2.0),
            "CTRIA3",
        ),
        (
            plate("PSHELL,1,1,,1,,1", false, "\n,,,4.,4.,4.,4."),
            both(4.0, 2.0),
            "without T",
        ),
        (plate(property, false, ""), both(2.0, 1.0), "T of PSHELL"),
        (
            plate("PSHELL,1,1,2.,1,,1,,,\n,-.5,.5", false, "\n,,,4.,4.,4.,4."),
            both(4.0, 0.5),
            "stated Z1 and Z2",
        ),
        (
            plate("PSHELL,1,1,2.,1,,1,,,\n,,.5", false, "\n,,,4.,4.,4.,4."),
            [strain(4.0, 0.5), strain(4.0, -2.0)],
            "stated Z2",
        ),
    ] {
        assert_near(&rows(&files(deck, TWO_SIDES)), expected, of);
    }
}

#[test]
fn a_place_on_the_skin_of_the_stated_thickness_is_found_there() {
    let at = |z: f64| {
        format!(
            "[[gauge]]\nname = \"g{z}\"\nposition = [-5.0, -5.0, {z:.1}]\ndirection = [1, 0, 0]\n"
        )
    };
    for (zoffs, low, high) in [("", -2.0, 2.0), (",,2.", 0.0, 4.0)] {
        let deck = plate(
            "PSHELL,1,1,2.,1,,1",
            false,
            &format!("{zoffs}\n,,,4.,4.,4.,4."),
        );
        let found = rows(&files(deck, &(at(high) + &at(low))));
        // The force at the grids is below the middle of a plate with an offset, so it bends the plate too.
        let arm = if zoffs.is_empty() { 0.0 } else { -2.0 };
        let of = |z: f64| {
            let [pull, bend] = strain(4.0, z);
            [pull + bend * arm * FORCE / MOMENT, bend]
        };
        assert_near(&found, [of(2.0), of(-2.0)], zoffs);
    }
}

#[test]
fn placed_gauges_and_stress_are_at_the_skin_of_the_stated_thickness() {
    let deck = plate("PSHELL,1,1,2.,1,,1", false, "\n,,,4.,4.,4.,4.");
    let plan = files(
        deck.clone(),
        "[candidates]\nangle_step_deg = 90\n[placement]\ngauges = 2\n",
    );
    let job = Job::read("job.toml", &plan).unwrap();
    let placed = place(&job, &Context::new(&plan)).unwrap();
    assert!(placed.gauges.iter().all(|g| g.position[2].abs() == 2.0));
    // A moment of 1 gives the stress 6 m / t^2 along x and none across.
    let asked = files(
        deck,
        &format!(
            "{TWO_SIDES}[measured]\nstrain = \"s.csv\"\nnoise_microstrain = 0.1\n[respond]\nelements = \"6\"\nloads = \"l.csv\"\n"
        ),
    )
    .with_file("s.csv", "run,t,b\nR,1,1\n")
    .with_file("l.csv", "run,P,M\nR,0,1\n");
    let job = Job::read("job.toml", &asked).unwrap();
    let answer = respond(&job, &Context::new(&asked)).unwrap();
    let stress = 6.0 * MOMENT / 16.0;
    for element in &answer.elements {
        let got = element.max_von_mises;
        assert!((got - stress).abs() < 1e-6 * stress, "{got} {stress}");
    }
}
