//! `fleet` changes readings by `[conditioning]` and `[dynamic]` as `recover` does.

use std::path::Path;
use strainbridge::finding::Finding;
use strainbridge::host::context::{Files, InMemory};
use strainbridge::workflow::fleet::{Fleet, FleetSpec};
use strainbridge::{Context, Job, fleet, recover};

/// Returns the results of `fleet` and the extremes of each load by `recover`, for the record `strain.csv` of a job.
pub fn fleet_and_extremes(
    name: &str,
    files: &InMemory,
    job: &str,
) -> (Fleet, Vec<Finding>, Vec<[f64; 2]>) {
    let job = format!("{job}\n[fleet]\nfile_name = \"{{vehicle}}_{{day}}.csv\"\n");
    let files = files.clone().with_file("job.toml", job);
    let read = || Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let recovered = recover(&read(), &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let loads = recovered.answer.record().unwrap().loads.iter();
    let extremes = loads.map(|l| [l.min, l.max]).collect();
    let strain = files.load(Path::new("strain.csv")).unwrap().to_vec();
    let files = files.with_file("T1_1.csv", strain);
    let folder = std::env::temp_dir().join(format!(
        "strainbridge-in-fleet-{name}-{}",
        std::process::id()
    ));
    let spec = FleetSpec {
        files: vec!["T1_1.csv".into()],
        folder: folder.clone(),
        ..FleetSpec::default()
    };
    let job = Job::read("job.toml", &files).unwrap();
    let found = fleet(&job, &spec, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let _ = std::fs::remove_dir_all(&folder);
    (found.answer, found.findings.to_vec(), extremes)
}

/// Checks that both commands found the same extremes of every load. They read the same numbers, so that only rounding differs.
pub fn check_extremes(fleet: &Fleet, findings: &[Finding], extremes: &[[f64; 2]]) {
    assert_eq!(fleet.vehicles.len(), 1, "{findings:?}");
    let loads = &fleet.vehicles[0].loads;
    assert_eq!(loads.len(), extremes.len());
    for (load, [min, max]) in loads.iter().zip(extremes) {
        let span = max - min;
        for (got, expected) in [(load.min, min), (load.max, max)] {
            let off = (got.unwrap() - expected).abs() / span;
            assert!(off < 1e-9, "{}: {got:?} {expected}", load.load);
        }
    }
}
