//! Finds the gauge with reversed polarity among eight gauges under two known loads, and the residual after its correction.

use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, reconcile};

const JOB: &str = r#"
units = "m-kg-s"
sensitivity = { file = "s.csv", per = { force = "kN" } }
measured = { strain = "strain.csv", noise_microstrain = 1.0, hold_out = ["R8", "R9"] }
runs = { file = "runs.csv", units = { force = "kN" }, noise = { force = 0.02 } }
reconcile = { path = "static" }
"#;

/// Returns S, readings with a scatter below a microstrain, and loads; gauge `G5` has reversed polarity.
fn tables() -> [String; 3] {
    let s = |g: u8, l: u8| 20.0 * (f64::from(g) * (1.3 + 0.7 * f64::from(l))).sin();
    let load = |r: u8, l: u8| 3.0 + 2.5 * ((2.1 + f64::from(l)) * f64::from(r + 1)).cos();
    let mut out = ["gauge,left,right\n", "run", "run,left,right\n"].map(str::to_owned);
    for g in 1..=8 {
        out[0] += &format!("G{g},{},{}\n", s(g, 0), s(g, 1));
        out[1] += &format!(",G{g}");
    }
    for r in 0..10 {
        out[2] += &format!("R{r},{},{}\n", load(r, 0), load(r, 1));
        out[1] += &format!("\nR{r}");
        for g in 1..=8 {
            let strain = s(g, 0) * load(r, 0) + s(g, 1) * load(r, 1);
            let scatter = 0.8 * (f64::from((r * 5 + g * 3) % 7) / 3.0 - 1.0);
            out[1] += &format!(",{}", if g == 5 { -strain } else { strain } + scatter);
        }
    }
    out
}

/// Identifies the gauge.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [s, strain, runs] = tables();
    let files = InMemory::default()
        .with_file("job.toml", JOB)
        .with_file("s.csv", s);
    let files = files
        .with_file("strain.csv", strain)
        .with_file("runs.csv", runs);
    let job = Job::read("job.toml", &files)?;
    let found = reconcile(&job, &Context::new(&files))?;
    let (before, after) = (100.0 * found.gap.before, 100.0 * found.gap.after);
    println!(
        "{:?}: gap {before:.1} % before, {after:.1} % after",
        found.named
    );
    assert_eq!(found.named, ["sign_flip:G5"]);
    assert!(after < 0.1 * before);
    Ok(())
}
