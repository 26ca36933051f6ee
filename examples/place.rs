//! Places four gauges on a cantilever strip for two tip loads. The input is a deck, the output a layout with its certificate; all files are in
//! memory.

use std::error::Error;
use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, place};

/// Returns a deck of a strip of ten plates along x, 2 mm thick, clamped at x = 0.
fn deck() -> Result<String, std::fmt::Error> {
    let mut deck = String::from("SOL 101\nCEND\nSPC = 1\nBEGIN BULK\n");
    for i in 0..11 {
        for (row, y) in [(0, 0.0), (100, 20.0)] {
            writeln!(deck, "GRID,{},,{}.,{y:.1},0.", 1 + i + row, 20 * i)?;
        }
    }
    for i in 1..11 {
        writeln!(deck, "CQUAD4,{i},1,{i},{},{},{}", i + 1, i + 101, i + 100)?;
    }
    Ok(deck + "PSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\nSPC1,1,123456,1,101\nENDDATA\n")
}

const JOB: &str = r#"
units = "mm-t-s"
model = { deck = "strip.bdf" }
load = [
    { name = "left", grid = 11, component = "FZ", expected = 5.0 },
    { name = "right", grid = 111, component = "FZ", expected = 5.0 },
]
placement = { gauges = 4, spacing = 10.0, model_uncertainty_rel = 0.02 }
"#;

/// Places the gauges, and prints the certified efficiency.
pub fn main() -> Result<(), Box<dyn Error>> {
    let files = InMemory::default()
        .with_file("strip.bdf", deck()?)
        .with_file("job.toml", JOB);
    let job = Job::read("job.toml", &files)?;
    let plan = place(&job, &Context::new(&files))?;
    for gauge in &plan.gauges {
        let (name, element) = (&gauge.name, gauge.element);
        println!("{name}: element {element}, {:.0} deg", gauge.angle_deg);
    }
    println!("at least {:.3} of the best", plan.efficiency_bound);
    assert!(plan.efficiency_bound > 0.9 && plan.is_reliable());
    Ok(())
}
