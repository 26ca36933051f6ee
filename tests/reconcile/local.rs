//! A small region of a plate with reduced stiffness (a crack), hidden in a mesh three times as fine. The job states no
//! zone.

use super::strips::{
    ALONG, GAUGES, MEASURED, Mesh, result, run, sensitivity, simulate_measured_tables, workplace,
};
use std::path::Path;

/// Strip of the analyst's mesh that contains the region, and the ranges of its rows and stations.
struct Crack {
    strip: usize,
    rows: [f64; 2],
    stations: [f64; 2],
}

impl Crack {
    /// Returns the deck of a mesh with the moduli of the region multiplied by a factor.
    fn in_deck(&self, mesh: &Mesh, factor: f64) -> String {
        let m = mesh.0;
        let inside = |id: usize| {
            let k = id % 100_000 - 1;
            let of = |n: usize, [from, to]: [f64; 2]| {
                let middle = (n as f64 + 0.5) / m as f64;
                from <= middle && middle <= to
            };
            id / 100_000 == self.strip
                && of(k / (ALONG * m), self.rows)
                && of(k % (ALONG * m), self.stations)
        };
        let line = |l: &str| -> String {
            let fields: Vec<&str> = l.split(',').collect();
            match fields.as_slice() {
                ["CQUAD4", id, "1", rest @ ..] if inside(id.parse().expect("an id")) => {
                    format!("CQUAD4,{id},2,{}\n", rest.join(","))
                }
                ["ENDDATA"] => format!(
                    "MAT1,2,{:.4},,.3,7.85-9,1.2-5\nPSHELL,2,2,5.,2,,2\nENDDATA\n",
                    2e5 * factor
                ),
                _ => format!("{l}\n"),
            }
        };
        mesh.deck(1.0, None).lines().map(line).collect()
    }

    /// Returns the middle of the region, mm.
    fn middle(&self) -> [f64; 2] {
        let mean = |[a, b]: [f64; 2]| 50.0 * 0.5 * (a + b);
        [
            mean(self.stations),
            mean(self.rows) + 300.0 * (self.strip - 1) as f64,
        ]
    }
}

/// Returns the middle of an element of the analyst's mesh, mm.
fn middle_of(element: &str) -> [f64; 2] {
    let id: usize = element.parse().expect("an element");
    let k = id % 100_000 - 1;
    let at = |n: usize| 50.0 * (n as f64 + 0.5);
    [
        at(k % ALONG),
        at(k / ALONG) + 300.0 * (id / 100_000 - 1) as f64,
    ]
}

/// Returns the result of `reconcile` for a structure with a crack. A factor of one means no crack.
fn reconcile_crack(name: &str, crack: &Crack, factor: f64) -> serde_json::Value {
    let (folder, write) = workplace(name);
    write("true/deck.bdf", &crack.in_deck(&Mesh(3), factor));
    write("true/job.toml", &Mesh(3).job(""));
    let truth = sensitivity(&run("sensitivity", &folder.join("true/job.toml")));
    let [strain, runs] = simulate_measured_tables(&truth, |_| vec![0.0; GAUGES.len()]);
    write("model/strain.csv", &strain);
    write("model/runs.csv", &runs);
    write("model/deck.bdf", &Mesh(1).deck(1.0, None));
    write("model/job.toml", &Mesh(1).job(MEASURED));
    result(&run("reconcile", &folder.join("model/job.toml")))
}

fn list_named_effects(result: &serde_json::Value) -> Vec<&str> {
    let list = result["named"].as_array().expect("a list");
    list.iter().filter_map(|n| n.as_str()).collect()
}

#[test]
fn a_region_that_lost_stiffness_is_named_where_it_is_and_not_as_several_bad_gauges() {
    for (k, (strip, rows, stations)) in [
        (1, [0.0, 2.0], [8.0, 12.0]),
        (2, [0.0, 2.0], [12.0, 15.0]),
        (1, [0.0, 1.0], [8.0, 11.0]),
        (2, [0.0, 2.0], [7.0, 9.0]),
    ]
    .into_iter()
    .enumerate()
    {
        let crack = Crack {
            strip,
            rows,
            stations,
        };
        let r = reconcile_crack(&format!("reconcile_local_{k}"), &crack, 0.45);
        let named = list_named_effects(&r);
        let printed = format!(
            "{k}: {} {named:?} {} {}",
            r["verdict"], r["best_attempt"], r["rivals"]
        );
        let [one] = named.as_slice() else {
            panic!("{printed}");
        };
        let place = one.strip_prefix("local_stiffness:").expect(&printed);
        let (found, truth) = (middle_of(place), crack.middle());
        let off = (found[0] - truth[0]).hypot(found[1] - truth[1]);
        assert!(off <= 100.0, "{printed} {off}");
        // If the region is as wide as the strip, the size is 100 times the natural logarithm of the modulus factor,
        // within a few hundredths. If a part of the strip carries on next to the region, shape and size of the region
        // compensate each other.
        let size = r["effects"][0]["size"].as_f64().expect("a size");
        let whole = rows == [0.0, 2.0];
        assert!(
            !whole || (size - 100.0 * 0.45f64.ln()).abs() < 4.0,
            "{printed}"
        );
        assert!(size < -20.0, "{printed}");
        // No property contains exactly the region, so no deck is written. A finding gives the reason, and the page
        // shows the place.
        assert!(r["extended_model"].is_null(), "{printed}");
        let findings = r["findings"].as_array().expect("findings");
        let is_said = |f: &serde_json::Value| f["code"] == "effect-not-in-model";
        assert!(findings.iter().any(is_said), "{printed}");
        let page = Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(format!("reconcile_local_{k}/model/job.out/report.html"));
        let page = std::fs::read_to_string(page).expect("the page");
        assert!(
            page.contains(&format!("stiffness less than in the model: {one}")),
            "{printed}"
        );
    }
}

#[test]
fn two_gauges_far_apart_with_gains_of_their_own_are_no_crack() {
    let (folder, write) = workplace("reconcile_local_gains");
    write("true/deck.bdf", &Mesh(3).deck(1.0, None));
    write("true/job.toml", &Mesh(3).job(""));
    let mut truth = sensitivity(&run("sensitivity", &folder.join("true/job.toml")));
    for (gauge, gain) in [(1, 1.3), (10, 0.6)] {
        truth[gauge].iter_mut().for_each(|v| *v *= gain);
    }
    let [strain, runs] = simulate_measured_tables(&truth, |_| vec![0.0; GAUGES.len()]);
    write("model/strain.csv", &strain);
    write("model/runs.csv", &runs);
    write("model/deck.bdf", &Mesh(1).deck(1.0, None));
    write("model/job.toml", &Mesh(1).job(MEASURED));
    let r = result(&run("reconcile", &folder.join("model/job.toml")));
    let named = list_named_effects(&r);
    assert!(
        named.iter().all(|n| !n.starts_with("local_stiffness")),
        "{named:?}"
    );
    assert!(
        named.is_empty() || named == ["gauge_gain:G01", "gauge_gain:G10"],
        "{named:?}"
    );
}

#[test]
fn a_plate_without_a_crack_has_none() {
    let nowhere = Crack {
        strip: 1,
        rows: [0.0, 2.0],
        stations: [8.0, 12.0],
    };
    let r = reconcile_crack("reconcile_local_none", &nowhere, 1.0);
    assert_ne!(r["verdict"], "unknown");
    assert!(list_named_effects(&r).is_empty(), "{}", r["named"]);
}
