//! Listed loads: the loads of S, then the sums of `[[combination]]`, with their units.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::{Combination, Job};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::{LoadUnits, load_units};

/// Names and units of the listed loads.
pub struct ListedLoads {
    /// Loads, then combinations.
    pub names: Vec<String>,
    /// Units of loads and combinations.
    pub units: Vec<LoadUnits>,
    /// Columns of S and their factors, one list per combination.
    pub sums: Vec<Vec<(usize, f64)>>,
}

/// Returns the loads of S and combinations of the job.
///
/// # Errors
/// Combinations of loads that S lacks, of forces with moments, or that bear a load's name.
pub fn list_load_columns(job: &Job, s: &Sensitivity) -> Result<ListedLoads, Faults> {
    let mut names: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    let mut units = load_units(job, &names);
    let mut faults = FaultList::new();
    let mut sums = Vec::new();
    for combination in &job.combinations {
        match terms_of(combination, s, &units) {
            Ok(terms) => {
                units.extend(terms.first().and_then(|t| units.get(t.0).cloned()));
                names.push(combination.name.clone());
                sums.push(terms);
            }
            Err((wrong, remedy)) => faults.push(Fault::with_line(
                &*job.file,
                combination.line,
                "combination.terms",
                wrong,
                remedy,
            )),
        }
    }
    Faults::check(faults)?;
    Ok(ListedLoads { names, units, sums })
}

/// Returns the columns and factors of a combination. The error contains what is wrong and what to do.
fn terms_of(
    combination: &Combination,
    s: &Sensitivity,
    units: &[LoadUnits],
) -> Result<Vec<(usize, f64)>, (String, &'static str)> {
    let name = &combination.name;
    if s.loads.iter().any(|l| l.name == *name) {
        let wrong = format!("`{name}` is the name of a load");
        return Err((wrong, "give the combination another name"));
    }
    let mut out: Vec<(usize, f64)> = Vec::new();
    for (load, factor) in &combination.terms {
        let Some(l) = s.loads.iter().position(|c| c.name == *load) else {
            let wrong = format!("S has no load `{load}`");
            return Err((wrong, "name loads of the job, or columns of S"));
        };
        if out.first().is_some_and(|f| units[f.0] != units[l]) {
            let wrong = format!("`{name}` adds forces and moments");
            return Err((wrong, "add loads of one unit"));
        }
        out.push((l, *factor));
    }
    Ok(out)
}
