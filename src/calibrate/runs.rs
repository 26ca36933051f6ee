//! Findings on runs that contradict the other runs.

use super::held_out::suspects;
use super::types::{LeftOut, Task};
use crate::finding::{Finding, Severity};

/// Share of a run's loads above which one load counts as the only load of the run.
const WHOLE: f64 = 0.8;

/// Returns the findings on refused runs (errors of the table, most likely) and on runs far off that were kept.
pub(super) fn findings(
    task: &Task,
    left_out: &[LeftOut],
    refused: &[(usize, LeftOut)],
) -> Vec<Finding> {
    let mut out: Vec<Finding> = refused.iter().map(|(_, l)| refusal(task, l)).collect();
    let suspect = suspects(left_out);
    for l in left_out.iter().filter(|l| suspect.contains(&l.number)) {
        let far = (l.distance / l.loads.max(1) as f64).sqrt();
        out.push(
            Finding::new(
                Severity::Warning,
                "run-deviates",
                &l.estimate.run,
                format!("run `{}` deviates by {far:.1} sigma from the other runs: {}. It is used", l.estimate.run, words(task, l)),
                "check its place, its zero and its label; exclude it with `[calibration] runs` if it is wrong",
            )
            .with_numbers(far, 1.0),
        );
    }
    out
}

fn refusal(task: &Task, l: &LeftOut) -> Finding {
    let far = (l.distance / l.loads.max(1) as f64).sqrt();
    Finding::new(
        Severity::Warning,
        "run-contradicts",
        &l.estimate.run,
        format!(
            "run `{}` contradicts the others by {far:.0} sigma and is not used: {}",
            l.estimate.run,
            words(task, l)
        ),
        "correct its label or its zero in the files",
    )
    .with_numbers(far, 1.0)
}

/// Describes how the loads determined by the strain differ from the known loads of the run.
fn words(task: &Task, l: &LeftOut) -> String {
    let main = |f: &[f64]| -> Option<usize> {
        let all: f64 = f.iter().map(|v| v.abs()).sum();
        (0..f.len()).find(|i| f[*i].abs() > WHOLE * all && all > 0.0)
    };
    let largest = |f: &[f64]| (0..f.len()).max_by(|a, b| f[*a].abs().total_cmp(&f[*b].abs()));
    let name = |i: usize| task.loads.get(i).map_or("", |l| l.name.as_str());
    if let (Some(stated), Some(found)) = (main(&l.known), largest(&l.estimate.values))
        && stated != found
    {
        return format!(
            "the stated load is `{}`, and the strain fits `{}`, as with a wrong label",
            name(stated),
            name(found)
        );
    }
    let (known, found): (f64, f64) = (l.known.iter().sum(), l.estimate.values.iter().sum());
    let ratio = if known == 0.0 {
        f64::NAN
    } else {
        found / known
    };
    if l.misfit > STRANGE {
        return format!(
            "its strain fits no loads (and {:.0} % of the known sum), as with a wrong zero or a faulty gauge",
            100.0 * ratio
        );
    }
    format!(
        "its strain corresponds to {:.0} % of the known sum, as with a zero under load, another load or another place",
        100.0 * ratio
    )
}

/// Misfit (chi2 over its degrees of freedom) above which no loads explain the strain.
const STRANGE: f64 = 3.0;
