//! Recovers two loads with intervals from three gauges with known sensitivity. The readings have errors; all files are in memory.

use std::error::Error;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, recover};

const JOB: &str = r#"
units = "m-kg-s"
load = [{ name = "left" }, { name = "right" }]
sensitivity = { file = "s.csv" }
measured = { strain = "strain.csv", noise_microstrain = 1.0 }
"#;

/// Microstrain per newton.
const S: &str = "gauge,left,right\nG1,0.10,0.02\nG2,0.02,0.10\nG3,0.05,0.05\n";
/// Readings under 2000 N and 1000 N, each with an error of one microstrain.
const STRAIN: &str = "run,G1,G2,G3\nR1,221,139,151\n";

/// Recovers the loads, and compares them with the applied loads.
pub fn main() -> Result<(), Box<dyn Error>> {
    let files = InMemory::default()
        .with_file("job.toml", JOB)
        .with_file("s.csv", S)
        .with_file("strain.csv", STRAIN);
    let job = Job::read("job.toml", &files)?;
    let found = recover(&job, &Context::new(&files))?;
    let loads = found.runs().ok_or("a table of runs")?;
    for (load, truth) in loads.loads.iter().zip([2000.0, 1000.0]) {
        let half = 0.5 * (load.high - load.low);
        println!(
            "{} = {:.0} +- {half:.0} {}",
            load.name, load.value, load.unit
        );
        assert!(load.low <= truth && truth <= load.high);
    }
    Ok(())
}
