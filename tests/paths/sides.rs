//! The side of a shell that a gauge is on, compared with closed forms.
//!
//! The plate is under a constant moment, and its strain is proportional to the height above its middle surface.

use strainbridge::finding::Finding;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, Severity, sensitivity};

/// Strain of the upper skin under the load: 100 N mm per mm on a plate of 2 mm, 150 MPa.
const BENT: f64 = 150.0 / 200_000.0;
/// Rounding error of the solution of a small plate, and of numbers in fields of eight characters.
const ROUNDING: f64 = 1e-9 * BENT;

/// Plate of 4 by 4 elements of 10 mm in the xy plane, 2 mm thick. Moments on two edges bend it about y.
struct Plate {
    /// Offset of every element along its normal.
    zoffs: f64,
    /// Elements whose normals point down.
    flipped: Vec<u32>,
    /// Z1 and Z2, if the property states them.
    fibres: &'static str,
}

impl Plate {
    fn new() -> Self {
        Self {
            zoffs: 0.0,
            flipped: Vec::new(),
            fibres: "",
        }
    }

    fn deck(&self) -> String {
        let mut deck = String::from("SOL 101\nCEND\nBEGIN BULK\nPARAM,INREL,-2\n");
        let grid = |i: u32, j: u32| 1 + i + 5 * j;
        for j in 0..5 {
            for i in 0..5 {
                let [x, y] = [i, j].map(|k| 10.0 * f64::from(k));
                deck += &format!("GRID,{},,{x:.1},{y:.1},0.\n", grid(i, j));
            }
            let moment = if j == 0 || j == 4 { 500.0 } else { 1000.0 };
            for (i, sign) in [(0, -1.0), (4, 1.0)] {
                deck += &format!("MOMENT,2,{},,{moment:.1},0.,{sign:.1},0.\n", grid(i, j));
            }
        }
        for j in 0..4 {
            for i in 0..4 {
                let id = 1 + i + 4 * j;
                let [a, b] = [grid(i, j), grid(i + 1, j)];
                let [c, d] = [grid(i + 1, j + 1), grid(i, j + 1)];
                let corners = match self.flipped.contains(&id) {
                    true => [a, d, c, b],
                    false => [a, b, c, d],
                };
                let corners = corners.map(|g| g.to_string()).join(",");
                deck += &format!("CQUAD4,{id},1,{corners},,{:.1}\n", self.zoffs);
            }
        }
        deck + "PSHELL,1,1,2.,1,,1,,\n" + self.fibres + "MAT1,1,200000.,,.25,7.85-9\nENDDATA\n"
    }

    fn files(&self, job: &str) -> InMemory {
        let head = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\nsupport = \"free\"\n[[load]]\nname = \"M\"\nload_set = 2\n";
        InMemory::default()
            .with_file("plate.bdf", self.deck())
            .with_file("job.toml", format!("{head}{job}"))
    }
}

/// Returns the readings under the load (strain) and the findings.
fn read(files: &InMemory) -> (Vec<f64>, Vec<Finding>) {
    let job = Job::read("job.toml", files).unwrap();
    let s = sensitivity(&job, &Context::new(files)).unwrap();
    let values = s.prepared.sensitivity.values.column(0);
    (values.iter().copied().collect(), s.findings.to_vec())
}

fn collect_job_faults(files: &InMemory) -> String {
    let faults: strainbridge::Faults = match Job::read("job.toml", files) {
        Ok(job) => sensitivity(&job, &Context::new(files)).err().unwrap(),
        Err(faults) => faults,
    };
    faults.iter().map(|f| format!("{f}\n")).collect()
}

fn severity(findings: &[Finding], code: &str) -> Option<Severity> {
    findings.iter().find(|f| f.code == code).map(|f| f.severity)
}

fn gauge(keys: &str) -> String {
    format!("[[gauge]]\nname = \"g\"\ndirection = [1, 0, 0]\n{keys}")
}

#[test]
fn a_point_next_to_an_element_decides_the_side() {
    // Mixed normals with an offset would not give a plate in pure bending.
    let plates = [
        (0.0, vec![7]),
        (0.0, Vec::new()),
        (1.0, Vec::new()),
        (3.0, Vec::new()),
        (-2.5, Vec::new()),
    ];
    for (zoffs, flipped) in plates {
        let plate = Plate {
            zoffs,
            flipped,
            ..Plate::new()
        };
        {
            for side in [1.0, -1.0] {
                let z = zoffs + side;
                let key = gauge(&format!("element = 7\nposition = [25.0, 15.0, {z:?}]\n"));
                let table = plate.files("[gauges]\nfile = \"g.csv\"\n").with_file(
                    "g.csv",
                    format!("name,element,x,y,z,dir_x,dir_y,dir_z\ng,7,25,15,{z},1,0,0\n"),
                );
                for files in [plate.files(&key), table] {
                    let (got, findings) = read(&files);
                    assert!(
                        (got[0] - side * BENT).abs() < ROUNDING,
                        "{zoffs} {side}: {got:?}"
                    );
                    assert_eq!(severity(&findings, "gauge-side-assumed"), None);
                }
            }
        }
    }
    // Without a point, the gauge is on the top.
    let (got, _) = read(&Plate::new().files(&gauge("element = 7\n")));
    assert!((got[0] - BENT).abs() < ROUNDING);
}

#[test]
fn a_surface_that_contradicts_the_point_is_an_error() {
    let code = "gauge-side-contradicted";
    for place in ["element = 7\n", ""] {
        let with = |surface: &str, z: f64| {
            let keys = format!("{place}surface = \"{surface}\"\nposition = [25.0, 15.0, {z:?}]\n");
            read(&Plate::new().files(&gauge(&keys)))
        };
        for (surface, sign) in [("top", 1.0), ("bottom", -1.0)] {
            let (got, findings) = with(surface, -sign);
            assert!((got[0] - sign * BENT).abs() < ROUNDING);
            assert_eq!(
                severity(&findings, code),
                Some(Severity::Error),
                "{surface}"
            );
            for near in [sign, 0.0, -0.4 * sign] {
                assert_eq!(severity(&with(surface, near).1, code), None, "{near}");
            }
            // A point far from the plate may belong to another part.
            let (_, findings) = with(surface, -4.0 * sign);
            assert_eq!(severity(&findings, code), Some(Severity::Warning));
        }
    }
    // The distance refers to the stated side.
    let keys = gauge("surface = \"top\"\nposition = [25.0, 15.0, -1.0]\n");
    let (_, findings) = read(&Plate::new().files(&keys));
    let found = findings
        .iter()
        .find(|f| f.code == "gauge-at-nearest-surface");
    assert!(found.unwrap().message.contains("2.0000 from the stated"));
    // A table may state the middle of the element, which is in the plane of its grids.
    let offset = Plate {
        zoffs: 1.0,
        ..Plate::new()
    };
    let keys = gauge("element = 7\nsurface = \"top\"\nposition = [25.0, 15.0, 0.0]\n");
    let (_, findings) = read(&offset.files(&keys));
    assert_eq!(severity(&findings, code), Some(Severity::Warning));
}

#[test]
fn a_point_on_the_middle_surface_needs_a_surface() {
    for place in ["element = 7\n", ""] {
        for z in [0.0, 0.05, -0.05] {
            let at = format!("{place}position = [25.0, 15.0, {z:?}]\n");
            let of = |keys: &str| read(&Plate::new().files(&gauge(&format!("{at}{keys}")))).1;
            let code = "gauge-side-assumed";
            assert_eq!(severity(&of(""), code), Some(Severity::Warning), "{at}");
            assert_eq!(severity(&of("surface = \"bottom\"\n"), code), None);
        }
    }
}

#[test]
fn fibres_off_the_skin_are_named_and_do_not_move_the_skin() {
    let plate = Plate {
        fibres: ",0.,2.\n",
        ..Plate::new()
    };
    let at = |z: f64| {
        let keys = gauge(&format!("position = [25.0, 15.0, {z:?}]\n"));
        read(&plate.files(&keys))
    };
    // Strain is proportional to the height. At height 2 it is twice the strain of the skin, at 0 it is zero.
    for (z, expected, field) in [(1.0, 2.0 * BENT, "Z2 = 2"), (-1.0, 0.0, "Z1 = 0")] {
        let (got, findings) = at(z);
        assert!((got[0] - expected).abs() < ROUNDING, "{z}: {got:?}");
        let found = findings
            .iter()
            .find(|f| f.code == "fibre-off-skin")
            .unwrap();
        assert!(found.message.contains(field), "{}", found.message);
        assert!(
            found.message.contains(&format!("The skin is at {z}")),
            "{}",
            found.message
        );
        assert_eq!(severity(&findings, "gauge-side-contradicted"), None);
    }
    // Fibres at the skins cause no finding.
    let stated = Plate {
        fibres: ",-1.,1.\n",
        ..Plate::new()
    };
    let (_, findings) = read(&stated.files(&gauge("element = 7\n")));
    assert_eq!(severity(&findings, "fibre-off-skin"), None);
}

#[test]
fn the_second_side_left_out_is_the_opposite_one_in_space() {
    let half = |keys: &str| gauge(&format!("bridge = \"half-bending\"\nelement2 = 10\n{keys}"));
    for flipped in [vec![], vec![10], vec![7], vec![7, 10]] {
        let own = if flipped.contains(&7) { -1.0 } else { 1.0 };
        let plate = Plate {
            flipped,
            ..Plate::new()
        };
        for (keys, sign) in [
            ("element = 7\n", own),
            ("element = 7\nsurface = \"top\"\n", own),
            ("element = 7\nsurface = \"bottom\"\n", -own),
            ("element = 7\nposition = [25, 15, 1]\n", 1.0),
            ("element = 7\nposition = [25, 15, -1]\n", -1.0),
        ] {
            let (got, _) = read(&plate.files(&half(keys)));
            // Twice the strain of a skin, because the reading is the difference of both skins.
            let expected = 2.0 * sign * BENT;
            assert!((got[0] - expected).abs() < 2.0 * ROUNDING, "{keys}{got:?}");
        }
    }
    let same = half("element = 7\nsurface = \"top\"\nsurface2 = \"top\"\n");
    let (got, _) = read(&Plate::new().files(&same));
    assert!(got[0].abs() < 2.0 * ROUNDING);
    // A stated point may put the first pair on the side that is stated for the second one.
    let keys =
        "bridge = \"half-bending\"\nelement = 7\nposition = [25, 15, -1]\nsurface2 = \"bottom\"\n";
    let text = collect_job_faults(&Plate::new().files(&gauge(keys)));
    assert!(text.contains("surface2: gauge `g`: both pairs"), "{text}");
}

#[test]
fn a_recovery_point_at_a_position_is_refused() {
    let keys = gauge("position = [25, 15, 1]\npoint = \"C\"\n");
    let text = collect_job_faults(&Plate::new().files(&keys));
    assert!(text.contains("job.toml:12: gauge.point"), "{text}");
    let table = Plate::new()
        .files("[gauges]\nfile = \"g.csv\"\n")
        .with_file("g.csv", "name,x,y,z,point\ng,25,15,1,C\n");
    let text = collect_job_faults(&table);
    assert!(text.contains("g.csv:2: point"), "{text}");
}

#[test]
fn a_column_of_sides_has_sides_of_the_shell_or_of_the_vehicle() {
    let table = |column: &str, word: &str| {
        Plate::new()
            .files("[gauges]\nfile = \"g.csv\"\n")
            .with_file(
                "g.csv",
                format!("name,element,{column},dir_x,dir_y,dir_z\ng,7,{word},1,0,0\n"),
            )
    };
    for (word, sign) in [("top", 1.0), ("Bottom", -1.0), ("", 1.0)] {
        let (got, _) = read(&table("side", word));
        assert!((got[0] - sign * BENT).abs() < ROUNDING, "{word}: {got:?}");
    }
    for word in ["upper", "lower", "Z1", "outside"] {
        let text = collect_job_faults(&table("side", word));
        assert!(text.contains("g.csv:2: surface"), "{word}: {text}");
    }
    // A finding names the column for the side of the vehicle as not read. Its remedy does not suggest another name.
    for (column, word) in [("side", "left"), ("nx", "0.0"), ("kg", "1")] {
        let (_, findings) = read(&table(column, word));
        let found = findings
            .iter()
            .find(|f| f.code == "column-not-read")
            .unwrap();
        assert!(
            !found.remedy.contains("rename"),
            "{column}: {}",
            found.remedy
        );
    }
    let (_, findings) = read(&table("memberr", "A"));
    let found = findings
        .iter()
        .find(|f| f.code == "column-not-read")
        .unwrap();
    assert!(
        found.remedy.contains("`memberr` to `member`"),
        "{}",
        found.remedy
    );
}

/// A cantilever of one bar under an axial force, with the recovery point C only.
#[test]
fn a_bar_gauge_at_a_point_without_coordinates_is_named() {
    let deck = "SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,100.,0.,0.\nCBAR,1,1,1,2,0.,0.,1.\nPBAR,1,1,10.,100.,100.,100.\n\
                ,1.,1.\nMAT1,1,200000.,,.25\nSPC1,1,123456,1\nFORCE,2,2,,1000.,1.,0.,0.\nENDDATA\n";
    let of = |point: &str| {
        let job = format!(
            "units = \"mm-t-s\"\n[model]\ndeck = \"bar.bdf\"\nsupport = 1\n[[load]]\nname = \"P\"\nload_set = 2\n\
             [[gauge]]\nname = \"g\"\nelement = 1\npoint = \"{point}\"\n"
        );
        read(
            &InMemory::default()
                .with_file("bar.bdf", deck)
                .with_file("job.toml", job),
        )
    };
    for (point, expected) in [("C", None), ("D", Some(Severity::Warning))] {
        let (got, findings) = of(point);
        // 100 MPa.
        assert!((got[0] - 100.0 / 200_000.0).abs() < 1e-12, "{got:?}");
        assert_eq!(severity(&findings, "bar-point-on-axis"), expected);
    }
}
