//! Named spots: compares gauges chosen from a table of places and directions with an exhaustive search.

use strainbridge::host::context::InMemory;
use strainbridge::report::command::save;
use strainbridge::{Context, Faults, Job, place, sensitivity, study};

/// Returns a free strip of plates along x, 11 by 2 grids 20 mm apart, 2 mm thick, with a bar along its lower edge.
fn strip() -> String {
    let mut deck = String::from("SOL 101\nCEND\nBEGIN BULK\n");
    for i in 0..11 {
        for j in 0..2 {
            let (x, y) = (20.0 * f64::from(i), 20.0 * f64::from(j));
            deck += &format!("GRID,{},,{x:.1},{y:.1},0.\n", 1 + i + 100 * j);
        }
    }
    for i in 0..10 {
        let (a, b) = (1 + i, 2 + i);
        deck += &format!("CQUAD4,{},1,{a},{b},{},{}\n", 1 + i, b + 100, a + 100);
    }
    deck + "CBAR,51,2,4,5,0.,0.,1.\nPBAR,2,1,4.,2.,2.,4.\n,1.,1.,-1.,1.,-1.,-1.,1.,-1.\n\
            PSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\nENDDATA\n"
}

const HEAD: &str = r#"
units = "mm-t-s"
[model]
deck = "strip.bdf"
[[load]]
name = "left"
grid = 1
component = "FZ"
expected = 10.0
[[load]]
name = "middle"
grid = 6
component = "FZ"
expected = 20.0
"#;
const SIDE: &str = "[[load]]\nname = \"side\"\ngrid = 111\ncomponent = \"FY\"\nexpected = 40.0\n";
const SPOTS: &str = "[candidates]\nfile = \"spots.csv\"\n[placement]\n";

/// Twelve spots: name, element, side, angle, cost.
const LIST: [(&str, u32, &str, f64, f64); 12] = [
    ("rail 1", 2, "top", 0.0, 3.0),
    ("rail 2", 3, "bottom", 0.0, 1.0),
    ("S3", 4, "top", 45.0, 2.0),
    ("S4", 5, "top", 0.0, 4.0),
    ("S5", 5, "bottom", 30.0, 1.5),
    ("S6", 6, "top", 90.0, 1.0),
    ("S7", 6, "bottom", 0.0, 2.5),
    ("S8", 7, "top", -45.0, 1.0),
    ("S9", 8, "top", 0.0, 3.5),
    ("S10", 8, "bottom", 15.0, 2.0),
    ("S11", 9, "top", 0.0, 1.0),
    ("S12", 10, "bottom", 60.0, 1.0),
];

fn table(has_costs: bool) -> String {
    let mut text = String::from("name,element,surface,angle_deg");
    text += if has_costs { ",cost\n" } else { "\n" };
    for (name, element, side, angle, cost) in LIST {
        text += &format!("{name},{element},{side},{angle}");
        text += &if has_costs {
            format!(",{cost}\n")
        } else {
            "\n".into()
        };
    }
    text
}

fn files(job: &str, spots: &str) -> InMemory {
    InMemory::default()
        .with_file("strip.bdf", strip())
        .with_file("spots.csv", spots)
        .with_file("job.toml", format!("{HEAD}{job}"))
}

fn job(files: &InMemory) -> Job {
    Job::read("job.toml", files).unwrap()
}

fn collect_placement_faults(files: &InMemory) -> String {
    let faults: Faults = match Job::read("job.toml", files) {
        Ok(job) => place(&job, &Context::new(files)).err().unwrap(),
        Err(faults) => faults,
    };
    faults.to_string()
}

/// Returns the strain of loads of expected size at every spot, microstrain. The noise is 1 in these units.
fn rows(files: &InMemory) -> Vec<Vec<f64>> {
    let job = job(files);
    let s = sensitivity(&job, &Context::new(files)).unwrap();
    let s = &s.prepared.sensitivity;
    let names: Vec<&str> = LIST.iter().map(|l| l.0).collect();
    assert_eq!(s.gauges, names);
    let scaled = |g: usize| {
        let loads = job.loads.iter().enumerate();
        loads
            .map(|(l, load)| 1e6 * s.values[(g, l)] * load.expected.unwrap())
            .collect()
    };
    (0..s.gauges.len()).map(scaled).collect()
}

/// Returns the determinant, by elimination.
fn determinant(mut m: Vec<Vec<f64>>) -> f64 {
    let mut out = 1.0;
    for c in 0..m.len() {
        let pivot = (c..m.len())
            .max_by(|a, b| m[*a][c].abs().total_cmp(&m[*b][c].abs()))
            .unwrap();
        if pivot != c {
            m.swap(pivot, c);
            out = -out;
        }
        out *= m[c][c];
        for r in c + 1..m.len() {
            let f = m[r][c] / m[c][c];
            for k in c..m.len() {
                m[r][k] -= f * m[c][k];
            }
        }
    }
    out
}

/// Returns ln det of the information of the rows in `subset`, with `known` added to the last diagonal entry.
fn value(rows: &[Vec<f64>], subset: u32, known: f64) -> f64 {
    let k = rows[0].len();
    let mut m = vec![vec![0.0; k]; k];
    m[k - 1][k - 1] = known;
    let chosen = rows
        .iter()
        .enumerate()
        .filter(|(i, _)| subset >> i & 1 == 1);
    for (_, row) in chosen {
        for (i, a) in row.iter().enumerate() {
            for (j, b) in row.iter().enumerate() {
                m[i][j] += a * b;
            }
        }
    }
    let det = determinant(m.clone());
    match known > 0.0 {
        // Criterion Ds: without the block of the nuisance load, which is the last one.
        true => det.ln() - m[k - 1][k - 1].ln(),
        false if det > 0.0 => det.ln(),
        false => f64::NEG_INFINITY,
    }
}

/// Returns the best of all subsets that `is_allowed` accepts: its value and its names.
fn find_best_subset(
    rows: &[Vec<f64>],
    known: f64,
    is_allowed: impl Fn(u32) -> bool,
) -> (f64, Vec<String>) {
    let all = (1_u32..1 << rows.len()).filter(|s| is_allowed(*s));
    let (value, subset) = all
        .map(|s| (value(rows, s, known), s))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap();
    let names = LIST
        .iter()
        .enumerate()
        .filter(|(i, _)| subset >> i & 1 == 1);
    (value, names.map(|(_, l)| l.0.to_owned()).collect())
}

#[test]
fn spots_are_the_best_subset_of_all_and_keep_their_names() {
    for count in [3_u32, 5, 8] {
        let files = files(&format!("{SIDE}{SPOTS}gauges = {count}\n"), &table(false));
        let placed = place(&job(&files), &Context::new(&files)).unwrap();
        let (value, names) = find_best_subset(&rows(&files), 0.0, |s| s.count_ones() == count);
        let chosen: Vec<&str> = placed.gauges.iter().map(|g| g.name.as_str()).collect();
        assert!(
            (placed.log_det - value).abs() < 1e-8,
            "{count}: {} {value}",
            placed.log_det
        );
        assert_eq!(chosen, names, "{count} gauges, in the order of the table");
        assert!(placed.proved);
        assert_eq!((placed.candidates.places, placed.candidates.rows), (12, 12));
    }
}

#[test]
fn a_nuisance_load_counts_as_known_to_its_expected_size() {
    let nuisance = format!("{SIDE}role = \"nuisance\"\n");
    let files = files(&format!("{nuisance}{SPOTS}gauges = 4\n"), &table(false));
    let placed = place(&job(&files), &Context::new(&files)).unwrap();
    // Columns are scaled by expected sizes. A load whose size is known adds 1.
    let (value, names) = find_best_subset(&rows(&files), 1.0, |s| s.count_ones() == 4);
    let chosen: Vec<&str> = placed.gauges.iter().map(|g| g.name.as_str()).collect();
    assert!(
        (placed.log_det - value).abs() < 1e-8,
        "{} {value}",
        placed.log_det
    );
    assert_eq!(chosen, names);
    // In every command, two gauges determine two loads together with a nuisance load of stated size.
    let two = self::files(&format!("{nuisance}{SPOTS}gauges = 2\n"), &table(false));
    let placed = place(&job(&two), &Context::new(&two)).unwrap();
    let of_two = format!("{nuisance}[gauges]\nfile = \"two.csv\"\n");
    let mut text = table(false).lines().next().unwrap().to_owned() + "\n";
    for line in table(false).lines().skip(1) {
        let is_chosen = |g: &strainbridge::workflow::place::PlacedGauge| {
            line.starts_with(&format!("{},", g.name))
        };
        if placed.gauges.iter().any(is_chosen) {
            text += &format!("{line}\n");
        }
    }
    let two = self::files(&of_two, "").with_file("two.csv", text);
    let s = sensitivity(&job(&two), &Context::new(&two)).unwrap();
    assert_eq!(s.prepared.sensitivity.gauges.len(), 2);
    assert!(
        s.findings
            .iter()
            .all(|f| f.code != "fewer-gauges-than-loads")
    );
}

#[test]
fn the_budget_limits_the_total_cost_of_the_best_subset() {
    let cost = |s: u32| -> f64 {
        let chosen = LIST.iter().enumerate().filter(|(i, _)| s >> i & 1 == 1);
        chosen.map(|(_, l)| l.4).sum()
    };
    for budget in [5.0, 8.5, 14.0] {
        let files = files(&format!("{SIDE}{SPOTS}budget = {budget}\n"), &table(true));
        let placed = place(&job(&files), &Context::new(&files)).unwrap();
        let (value, names) = find_best_subset(&rows(&files), 0.0, |s| cost(s) <= budget);
        let chosen: Vec<&str> = placed.gauges.iter().map(|g| g.name.as_str()).collect();
        assert!(
            (placed.log_det - value).abs() < 1e-8,
            "{budget}: {} {value}",
            placed.log_det
        );
        assert_eq!(chosen, names, "{budget}");
        assert!(placed.upper_bound >= value - 1e-9);
        let paid: f64 = LIST
            .iter()
            .filter(|l| names.contains(&l.0.to_owned()))
            .map(|l| l.4)
            .sum();
        assert_eq!(placed.cost, Some(paid));
        assert!(placed.findings.iter().all(|f| f.code != "gauges-assumed"));
    }
}

/// A job that reads the table of gauges of a plan gets the S of the plan: bridges, grids, rosettes, positions and
/// points of bars.
#[test]
fn chosen_spots_read_the_same_from_the_table_of_gauges() {
    let spots = "name,element,surface,dir_x,dir_y,dir_z,angle_deg,x,y,z,bridge,bridge_factor,grid_length,rosette,point,member\n\
                 A,3,top,1,0,0,10,,,,full-bending,4,3,,,\"rail, left\"\n\
                 B,,bottom,1,1,0,,93,7,-1,,,4,,,\n\
                 C,51,,,,,,,,,,,,,D,\n\
                 R,8,top,,,,20,,,,,,,rectangular,,\n";
    let files = files(&format!("{SPOTS}gauges = 6\n"), spots);
    let placed = place(&job(&files), &Context::new(&files)).unwrap();
    let names: Vec<&str> = placed.gauges.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["A", "B", "C", "R.a", "R.b", "R.c"]);
    assert_eq!(placed.cost, Some(6.0), "a rosette takes three channels");
    let mut table = Vec::new();
    strainbridge::report::strain::gauges_csv(&mut table, &placed.gauges, 0.0).unwrap();
    let again = self::files("[gauges]\nfile = \"gauges.csv\"\n", "").with_file("gauges.csv", table);
    let read = job(&again);
    assert_eq!(read.gauges[0].member, "rail, left");
    let s = sensitivity(&read, &Context::new(&again)).unwrap();
    let s = &s.prepared.sensitivity;
    assert_eq!(s.gauges, names);
    let size = placed.sensitivity.values.amax();
    for (a, b) in s.values.iter().zip(placed.sensitivity.values.iter()) {
        assert!((a - b).abs() < 1e-12 * size, "{a} {b}");
    }
}

#[test]
fn faults_of_spots_have_file_line_field_and_remedy() {
    let plain = "name,element,surface,angle_deg\nA,3,top,0\nB,5,top,0\nC,6,top,0\n";
    let three = format!("{SPOTS}gauges = 3\n");
    let tables = [
        (
            "name,element,surface,angle_deg\nA,3,top,0\nB,999,top,0\n",
            "spots.csv:3: element: gauge `B`: the deck has no shell 999",
        ),
        (
            "name,element,surface,angle_deg\nA,3,top,0\na,4,top,0\n",
            "spots.csv:3: name: ",
        ),
        (
            "name,element,surface,angle_deg\nA,3,top,0\nB,4,top,\n",
            "spots.csv:3: dir_x: spot `B`: the direction is not stated",
        ),
        (
            "name,element,surface\nA,3,top\n",
            "spots.csv:2: dir_x: spot `A`: the direction is not stated",
        ),
        (
            "name,surface,angle_deg\nA,top,0\n",
            "spots.csv:2: element: spot `A`: the place is not stated",
        ),
        (
            "name,element,surface,angle_deg,cost\nA,3,top,0,-2\n",
            "spots.csv:2: cost: `-2`, expected a cost above 0",
        ),
        (
            "name,element,surface,angle_deg,cost\nA,3,top,0,1\nB,4,top,0,\n",
            "spots.csv:3: cost: the cost is blank",
        ),
        (
            "name,element,surface,angle_dg\nA,3,top,0\n",
            "spots.csv:1: angle_dg: `angle_dg` is not a column",
        ),
        (
            "name,element,surface,angle_deg\nA,3,side,0\n",
            "spots.csv:2: surface: `side` is not a valid surface",
        ),
        (
            "name,element,surface,angle_deg,role\nA,3,top,0,validation\n",
            "spots.csv:2: role: spot `A`",
        ),
        ("name,element,surface,angle_deg\n", "spots.csv"),
        (
            plain.split("C,").next().unwrap(),
            "add spots to `spots.csv`",
        ),
    ];
    for (table, expected) in tables {
        let printed = collect_placement_faults(&files(&three, table));
        assert!(printed.contains(expected), "{expected}\n{printed}");
    }
    let of_candidates =
        |key: &str| format!("[candidates]\nfile = \"spots.csv\"\n{key}\n[placement]\ngauges = 3\n");
    let mut jobs = Vec::new();
    for key in [
        "properties = [1]",
        "elements = [1]",
        "surfaces = [\"top\"]",
        "angle_step_deg = 15",
        "grid_length = 3.0",
        "bridge = \"quarter\"",
        "rosette = \"delta\"",
        "exclude_elements = [1]",
        "wanted_elements = [1]",
        "boxes = [[[0, 1], [0, 1]]]",
        "clear_of = { edges = 3 }",
    ] {
        let name = key.split(' ').next().unwrap();
        jobs.push((
            of_candidates(key),
            format!("candidates.{name}: `file` is a table of spots"),
        ));
    }
    for (key, expected) in [
        ("gauges = 3\nsymmetric = \"y\"", "placement.symmetric: "),
        ("gauges = 3\ncosts = { quarter = 2 }", "placement.costs: "),
        (
            "gauges = 3\nbudget = 2",
            "placement.gauges: `gauges` and `budget` both limit",
        ),
        ("budget = 3\ncurve = [3]", "placement.curve: "),
    ] {
        jobs.push((format!("{SPOTS}{key}\n"), expected.to_owned()));
    }
    for (job, expected) in jobs {
        let printed = collect_placement_faults(&files(&job, plain));
        assert!(
            printed.contains(&format!(": {expected}")),
            "{expected}\n{printed}"
        );
        assert!(printed.contains("job.toml:"), "{printed}");
    }
    let printed = collect_placement_faults(&files(&three, &table(true)));
    assert!(
        printed.contains("placement.budget: `spots.csv` states costs"),
        "{printed}"
    );
    let keep = "[[gauge]]\nname = \"A\"\nelement = 3\n[candidates]\nfile = \"spots.csv\"\n[placement]\ngauges = 1\nkeep = \"all\"\n";
    let printed = collect_placement_faults(&files(keep, plain));
    assert!(
        printed.contains("spots.csv:2: name: spot `A`: [placement] `keep` names"),
        "{printed}"
    );
}

#[test]
fn a_spot_that_is_too_close_to_another_is_not_chosen_with_it() {
    let spots = "name,element,surface,angle_deg\nA,5,top,0\nA2,5,top,10\nB,6,top,0\nC,2,top,0\n";
    let free = files(&format!("{SPOTS}gauges = 2\n"), spots);
    let free = place(&job(&free), &Context::new(&free)).unwrap();
    let apart = files(&format!("{SPOTS}gauges = 2\nspacing = 30\n"), spots);
    let apart = place(&job(&apart), &Context::new(&apart)).unwrap();
    let x: Vec<f64> = apart.gauges.iter().map(|g| g.position[0]).collect();
    assert!((x[0] - x[1]).abs() >= 30.0, "{x:?}");
    assert!(apart.log_det <= free.log_det + 1e-9);
}

#[test]
fn a_study_names_the_gauges_of_each_layout() {
    let asked = "[study]\nlayouts = [\"given\", \"random\", \"D\"]\ngauges = [3, 5]\ntrials = 50\n";
    let given = "[[gauge]]\nname = \"G1\"\nelement = 3\n[[gauge]]\nname = \"G2\"\nelement = 5\nangle_deg = 30\n\
                 [[gauge]]\nname = \"G3\"\nelement = 8\nsurface = \"bottom\"\n";
    let text = format!("{SIDE}{given}[candidates]\nfile = \"spots.csv\"\n{asked}");
    let files = files(&text, &table(false));
    let found = study(&job(&files), &Context::new(&files)).unwrap();
    let rows = rows(&self::files(
        &format!("{SIDE}{SPOTS}gauges = 3\n"),
        &table(false),
    ));
    for count in [3_u32, 5] {
        let of = |layout: &str| {
            let mut all = found.study.iter();
            all.find(|r| r.layout == layout && r.gauges == count as usize)
        };
        assert_eq!(
            of("D").unwrap().names,
            find_best_subset(&rows, 0.0, |s| s.count_ones() == count).1
        );
        assert!(of("random").unwrap().names.is_empty());
        let given = of("given").map(|r| r.names.join(" "));
        assert_eq!(given.as_deref(), (count == 3).then_some("G1 G2 G3"));
    }
    let layouts: Vec<(&str, usize, usize)> = found
        .layouts
        .iter()
        .map(|l| (l.layout.as_str(), l.gauges, l.chosen.len()))
        .collect();
    assert_eq!(layouts, [("given", 3, 3), ("D", 3, 3), ("D", 5, 5)]);
    let folder = scratch("study");
    save(&found, &folder).unwrap();
    let table = std::fs::read_to_string(folder.join("layouts.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 3 + 3 + 5, "{table}");
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let five = found.layouts[2].chosen.iter().map(|g| g.name.as_str());
    assert!(page.contains(&five.collect::<Vec<_>>().join(", ")));
    // The rows of one layout are a table of gauges.
    let of_five = table
        .lines()
        .filter(|l| l.starts_with("layout,") || l.starts_with("D,5,"));
    let of_five: String = of_five.map(|l| format!("{l}\n")).collect();
    let again = self::files(&format!("{SIDE}[gauges]\nfile = \"five.csv\"\n"), "")
        .with_file("five.csv", of_five);
    let s = sensitivity(&job(&again), &Context::new(&again)).unwrap();
    let s = &s.prepared.sensitivity;
    for (g, name) in s.gauges.iter().enumerate() {
        let spot = LIST.iter().position(|l| l.0 == name).unwrap();
        for (l, expected) in [10.0, 20.0, 40.0].into_iter().enumerate() {
            let strain = 1e6 * s.values[(g, l)] * expected;
            assert!(
                (strain - rows[spot][l]).abs() < 1e-9 * (1.0 + strain.abs()),
                "{name}"
            );
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// With a given S, spots need neither place nor direction. Their names are rows of the table.
#[test]
fn a_study_of_a_given_s_chooses_among_named_spots() {
    let job_text = "units = \"m-kg-s\"\nload = [{ name = \"a\", expected = 1.0 }, { name = \"b\", expected = 1.0 }]\n\
                    [sensitivity]\nfile = \"s.csv\"\n[candidates]\nfile = \"spots.csv\"\n\
                    [study]\nlayouts = [\"D\"]\ngauges = [2]\ntrials = 20\n";
    // Without G1, G2 and G4 have the largest determinant: 3 x 2.
    let files = InMemory::default()
        .with_file("job.toml", job_text)
        .with_file("s.csv", "gauge,a,b\nG1,9,0\nG2,3,0\nG3,1,1\nG4,0,2\n")
        .with_file("spots.csv", "name\nG2\nG3\nG4\n");
    let found = study(&job(&files), &Context::new(&files)).unwrap();
    assert_eq!(found.study[0].names, ["G2", "G4"]);
    let files = files.with_file("spots.csv", "name\nG2\nG7\n");
    let faults = study(&job(&files), &Context::new(&files))
        .err()
        .unwrap()
        .to_string();
    assert!(
        faults.contains("spots.csv:3: name: the table of [sensitivity] has no row `G7`"),
        "{faults}"
    );
}

#[test]
fn a_table_corrected_by_hand_is_not_overwritten_by_place_or_study() {
    let text = format!(
        "{SIDE}[candidates]\nfile = \"spots.csv\"\n[placement]\ngauges = 4\n[study]\nlayouts = [\"D\"]\ngauges = [4]\ntrials = 20\n"
    );
    let files = files(&text, &table(false));
    let job = job(&files);
    let folder = scratch("corrected");
    let placed = place(&job, &Context::new(&files)).unwrap();
    let found = study(&job, &Context::new(&files)).unwrap();
    save(&placed, &folder).unwrap();
    save(&found, &folder).unwrap();
    save(&placed, &folder).unwrap();
    for name in ["gauges.csv", "layouts.csv"] {
        let path = folder.join(name);
        let before = std::fs::read_to_string(&path).unwrap();
        let corrected = before.replacen("top", "bottom", 1);
        assert_ne!(before, corrected);
        std::fs::write(&path, &corrected).unwrap();
        let faults = match name {
            "gauges.csv" => save(&placed, &folder).unwrap_err(),
            _ => save(&found, &folder).unwrap_err(),
        };
        let printed = faults.to_string();
        assert!(
            printed.contains(name) && printed.contains("was changed after"),
            "{printed}"
        );
        assert_eq!(std::fs::read_to_string(&path).unwrap(), corrected);
        std::fs::write(&path, &before).unwrap();
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// If the gauges that a search chose are listed as spots, they have the same uncertainty and the same gluing sheet.
#[test]
fn spots_have_the_uncertainty_of_the_same_gauges_found_by_a_search() {
    let errors = "gauges = 5\nnoise_microstrain = 0.5\nangle_tolerance_deg = 1.0\nposition_tolerance = 2.0\n\
                  model_uncertainty_rel = 0.01\ngauge_factor_rel = 0.01\n";
    let searched = files(&format!("{SIDE}[placement]\n{errors}"), "");
    let searched = place(&job(&searched), &Context::new(&searched)).unwrap();
    let mut table = Vec::new();
    strainbridge::report::strain::gauges_csv(&mut table, &searched.gauges, 0.0).unwrap();
    let listed = files(&format!("{SIDE}{SPOTS}{errors}"), "").with_file("spots.csv", table);
    let listed = place(&job(&listed), &Context::new(&listed)).unwrap();
    assert!((listed.log_det - searched.log_det).abs() < 1e-9);
    for (a, b) in listed.load_sigma.iter().zip(&searched.load_sigma) {
        let (glued, of_search) = (a.sigma_as_glued.unwrap(), b.sigma_as_glued.unwrap());
        assert!((a.sigma / b.sigma - 1.0).abs() < 1e-9, "{}", a.name);
        assert!((glued / of_search - 1.0).abs() < 1e-9, "{}", a.name);
    }
    for (a, b) in listed.gauges.iter().zip(&searched.gauges) {
        assert_eq!((&a.name, a.element), (&b.name, b.element));
        for (x, y) in [
            (a.angle_budget_deg, b.angle_budget_deg),
            (a.position_budget, b.position_budget),
        ] {
            assert!((x.unwrap() / y.unwrap() - 1.0).abs() < 1e-6, "{}", a.name);
        }
    }
}

fn scratch(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("strainbridge-spots-{name}-{}", std::process::id()))
}
