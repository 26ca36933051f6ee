//! Properties that the job names with the names of the deck.

use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, place};

/// Returns a plate of 6 by 2 elements of 10 mm under forces along x and y. The left half is property 1, the right half
/// properties 2 and 3.
fn deck(names: [&str; 3]) -> String {
    let mut deck = String::from("SOL 101\nCEND\nBEGIN BULK\nPARAM,INREL,-2\n");
    let grid = |i: u32, j: u32| 1 + i + 7 * j;
    for j in 0..3 {
        for i in 0..7 {
            let [x, y] = [i, j].map(|k| 10.0 * f64::from(k));
            deck += &format!("GRID,{},,{x:.1},{y:.1},0.\n", grid(i, j));
        }
        for (i, sign) in [(0, -1.0), (6, 1.0)] {
            deck += &format!("FORCE,2,{},,100.,{sign:.1},0.,0.\n", grid(i, j));
        }
    }
    for i in 0..7 {
        for (j, sign) in [(0, -1.0), (2, 1.0)] {
            deck += &format!("FORCE,3,{},,100.,0.,{sign:.1},0.\n", grid(i, j));
        }
    }
    for j in 0..2 {
        for i in 0..6 {
            let corners = [
                grid(i, j),
                grid(i + 1, j),
                grid(i + 1, j + 1),
                grid(i, j + 1),
            ];
            let corners = corners.map(|g| g.to_string()).join(",");
            let property = if i < 3 { 1 } else { 2 + j };
            deck += &format!("CQUAD4,{},{property},{corners}\n", 1 + i + 6 * j);
        }
    }
    for (id, name) in (1..).zip(names) {
        deck += &format!("$* Property: {name}\nPSHELL,{id},1,2.,1,,1\n");
    }
    deck + "MAT1,1,200000.,,.25,7.85-9\nENDDATA\n"
}

fn files(names: [&str; 3], candidates: &str) -> InMemory {
    let head = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\nsupport = \"free\"\n\
                [[load]]\nname = \"X\"\nload_set = 2\nexpected = 1.0\n[[load]]\nname = \"Y\"\nload_set = 3\nexpected = 1.0\n\
                [placement]\ngauges = 3\n[candidates]\n";
    InMemory::default()
        .with_file("plate.bdf", deck(names))
        .with_file("job.toml", format!("{head}{candidates}\n"))
}

const NAMES: [&str; 3] = ["RailLeft", "RailRight", "Web"];

/// Returns the elements on which gauges are placed, or the faults.
fn place_gauges(files: &InMemory) -> Result<Vec<u32>, String> {
    let text = |faults: strainbridge::Faults| faults.to_string();
    let job = Job::read("job.toml", files).map_err(text)?;
    let answer = place(&job, &Context::new(files)).map_err(text)?;
    Ok(answer.gauges.iter().map(|g| g.element).collect())
}

#[test]
fn names_of_the_deck_stand_for_the_ids() {
    for (by_name, by_id) in [
        ("properties = [\"RailLeft\"]", "properties = [1]"),
        ("properties = \"railleft\"", "properties = 1"),
        ("properties = [\"Web\", 2]", "properties = [2, 3]"),
        (
            "exclude_properties = [\"RailLeft\"]",
            "exclude_properties = 1",
        ),
        (
            "properties = \"1 THRU 2\"",
            "properties = [\"RailLeft\", \"RailRight\"]",
        ),
    ] {
        let found = place_gauges(&files(NAMES, by_name)).unwrap();
        assert_eq!(
            found,
            place_gauges(&files(NAMES, by_id)).unwrap(),
            "{by_name}"
        );
    }
    let of_left = |e: &u32| (e - 1) % 6 < 3;
    let left = place_gauges(&files(NAMES, "properties = \"RailLeft\"")).unwrap();
    assert!(left.len() == 3 && left.iter().all(of_left), "{left:?}");
}

#[test]
fn unknown_and_ambiguous_names_are_refused() {
    let refused = |names, list: &str| place_gauges(&files(names, list)).unwrap_err();
    let text = refused(NAMES, "properties = [\"RailLeftt\"]");
    assert!(
        text.contains("candidates.properties") && text.contains("did you mean `RailLeft`"),
        "{text}"
    );
    let text = refused(["Rail", "Rail", "Web"], "exclude_properties = \"Rail\"");
    assert!(
        text.contains("properties 1, 2 are all called `Rail`"),
        "{text}"
    );
}
