//! The job of `models/truck-shell`: a plan that a technician can glue.

use crate::program::{codes, run, scratch};
use std::collections::HashMap;

fn list(v: &serde_json::Value) -> &[serde_json::Value] {
    v.as_array().map_or(&[], Vec::as_slice)
}

fn point(v: &serde_json::Value) -> [f64; 3] {
    [0, 1, 2].map(|i| v[i].as_f64().unwrap())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = [0, 1, 2].map(|i| a[i] - b[i]);
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
}

/// Returns the grids of bars, springs and RBE2, from the lines of the deck in fields of eight characters.
fn joint_grids(deck: &str) -> Vec<[f64; 3]> {
    let fields = |line: &str| -> Vec<String> {
        let chars: Vec<char> = line.chars().collect();
        let text = |c: &[char]| c.iter().collect::<String>().trim().to_owned();
        chars.chunks(8).map(text).collect()
    };
    let (mut grids, mut named) = (HashMap::new(), Vec::new());
    for line in deck.lines() {
        let f = fields(line);
        match f.first().map(String::as_str) {
            Some("GRID") => {
                let x = [3, 4, 5].map(|i| f[i].parse::<f64>().unwrap());
                grids.insert(f[1].clone(), x);
            }
            Some("CBAR" | "CBUSH" | "CROD") => named.extend([f[3].clone(), f[4].clone()]),
            Some("RBE2") => {
                named.push(f[2].clone());
                named.extend(f[4..].iter().filter(|id| !id.is_empty()).cloned());
            }
            _ => {}
        }
    }
    named
        .iter()
        .filter_map(|id| grids.get(id))
        .copied()
        .collect()
}

#[test]
fn the_job_of_the_model_gives_a_plan_that_a_technician_can_glue() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("models/truck-shell");
    let folder = scratch("plan_of_the_model");
    for name in ["job.toml", "truck.bdf"] {
        std::fs::copy(root.join(name), folder.join(name)).unwrap();
    }
    let job = folder.join("job.toml");
    let out = folder.join("out");
    let (code, result, err) = run(&["place", job.to_str().unwrap()], &out);
    assert_eq!((code, codes(&result, "error").len()), (0, 0), "{err}");
    let gauges = list(&result["gauges"]);
    assert_eq!(gauges.len(), 30);
    let joints = joint_grids(&std::fs::read_to_string(root.join("truck.bdf")).unwrap());
    // 76 bars, 10 springs and 4 rods name two grids each.
    assert!(joints.len() > 180, "{}", joints.len());
    for (i, g) in gauges.iter().enumerate() {
        let at = point(&g["position"]);
        let nearest = joints.iter().map(|j| distance(at, *j));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest >= 110.0, "{g}: a joint is {nearest} mm away");
        for other in &gauges[..i] {
            let apart = distance(at, point(&other["position"]));
            // Gauges on both sides of one plate are at one place.
            let opposite = g["element"] == other["element"] && g["surface"] != other["surface"];
            assert!(opposite || apart >= 50.0, "{g} {other}: {apart} mm");
        }
    }
    // A ruler places a gauge within 2 mm. The intervals contain this tolerance.
    for wheel in list(&result["load_sigma"]).iter().take(6) {
        let [glued, exact] = ["sigma_as_glued", "sigma"].map(|k| wheel[k].as_f64().unwrap());
        // Measured: half widths of 3.9 to 5.4 kN for wheel loads of 25 kN.
        assert!(exact <= glued && 1.96 * glued < 8.0, "{wheel}");
    }
    let sheet = std::fs::read_to_string(out.join("gluing_sheet.html")).unwrap();
    for g in gauges {
        assert!(sheet.contains(g["name"].as_str().unwrap()), "{g}");
    }
}
