//! Rules of the quick reference guides for decks, tested through the commands.

use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, cases, sensitivity};

const E: f64 = 210_000.0;
const LENGTH: f64 = 1_000.0;
const INERTIA: f64 = 100_000.0;
const FORCE: f64 = 100.0;
/// Distance of recovery point C from the axis.
const Y: f64 = 20.0;

/// Returns a cantilever along x with a force along y at its free end. Its second moment doubles linearly along its
/// length.
fn cantilever(station: &str) -> String {
    format!(
        "SOL 101\nCEND\nSPC = 1\nLOAD = 11\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,{LENGTH:.1},0.,0.\nCBEAM,10,1,1,2,0.,1.,0.\n\
         PBEAM,1,1,800.,{INERTIA:.1},30000.,,1.+5\n,{Y:.1},0.,-{Y:.1},0.\n,{station}\n\
         MAT1,1,{E:.1},,.3\nSPC1,1,123456,1\nFORCE,11,2,,{FORCE:.1},0.,1.,0.\nENDDATA\n"
    )
}

#[test]
fn a_gauge_between_stations_reads_the_points_of_end_a_where_a_station_asks_for_no_stress() {
    let station = |so: &str| format!("{so},1.,1600.,{:.1},60000.,,2.+5", 2.0 * INERTIA);
    let shares = [0.0, 0.4, 0.9];
    let gauge = |s: f64| {
        format!("[[gauge]]\nname = \"g{s}\"\nelement = 10\npoint = \"C\"\nstation = {s:.1}\n")
    };
    let gauges: String = shares.map(gauge).concat();
    for so in ["NO", "YESA"] {
        let files = InMemory::default()
            .with_file("beam.bdf", cantilever(&station(so)))
            .with_file("job.toml", format!("units = \"mm-t-s\"\n[model]\ndeck = \"beam.bdf\"\n[[load]]\nname = \"P\"\nload_set = 11\n{gauges}"));
        let job = Job::read("job.toml", &files).unwrap();
        let s = sensitivity(&job, &Context::new(&files)).unwrap();
        for (share, got) in shares
            .iter()
            .zip(s.prepared.sensitivity.values.column(0).iter())
        {
            let moment = FORCE * LENGTH * (1.0 - share);
            let right = moment * Y / (E * INERTIA * (1.0 + share));
            assert!(
                (got.abs() - right).abs() < 1e-9 * right,
                "{so} {share}: {got} {right}"
            );
        }
    }
}

#[test]
fn unit_loads_of_a_deck_with_one_subcase_number_twice_are_refused() {
    let deck = cantilever("NO,1.").replace(
        "LOAD = 11\n",
        "SUBCASE 1\nLOAD = 11\nSUBCASE 1\nLOAD = 11\n",
    );
    let files = InMemory::default().with_file("beam.bdf", deck).with_file(
        "job.toml",
        "units = \"mm-t-s\"\n[model]\ndeck = \"beam.bdf\"\n[[load]]\nname = \"P\"\nload_set = 11\n",
    );
    let job = Job::read("job.toml", &files).unwrap();
    let faults = cases(&job, &Context::new(&files))
        .err()
        .unwrap()
        .to_string();
    assert!(faults.contains("beam.bdf:6: SUBCASE 1"), "{faults}");
}
