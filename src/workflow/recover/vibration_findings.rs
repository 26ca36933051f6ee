//! Findings on the vibration of a structure in a record.

use super::motion::Motion;
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::job::{Damping, Dynamic};
use crate::recovery::dynamic::{Deviation, Dynamics, EstimatedModes, RULES};
use crate::units::number;

/// Returns the error that the record contradicts the modes. A frequency or a damping then differs from its stated value by more than its stated
/// uncertainty. Otherwise, no frequency and damping of the modes explains the vibration.
pub(super) fn contradiction(
    (stated, open_damping): (&Dynamics, bool),
    found: &EstimatedModes,
    file: &str,
) -> Option<Finding> {
    let off = |(j, by_kind): (usize, &[Option<Deviation>; 2])| {
        let of_kind = |(kind, d): (usize, &Option<Deviation>)| {
            // An estimated damping has no stated value from which it could deviate.
            let d = d.as_ref().filter(|_| kind == 0 || !open_damping)?;
            let off = d.standard_deviations_off()?.abs();
            (off > RULES.contradicted_sd).then_some((off, j, kind, *d))
        };
        let worst = by_kind.iter().enumerate().filter_map(of_kind);
        worst.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let modes = found.deviations.iter().enumerate().filter_map(off);
    let worst = modes.max_by(|a, b| a.0.total_cmp(&b.0));
    let what = match worst {
        Some((off, j, kind, deviation)) => {
            let (mode, used) = (&stated.modes[j], &found.dynamics.modes[j]);
            let half = |value: f64| number(NORMAL_95 * deviation.sd * value);
            let shown = match kind {
                0 => format!(
                    "mode {} vibrates at {} ± {} Hz in the record and at {} Hz in the model",
                    j + 1,
                    number(used.hz),
                    half(used.hz),
                    number(mode.hz)
                ),
                _ => format!(
                    "mode {} at {} Hz has a damping of {} ± {} in the record and a stated damping of {}",
                    j + 1,
                    number(mode.hz),
                    number(used.damping),
                    half(used.damping),
                    number(mode.damping)
                ),
            };
            format!(
                "{shown}, a difference of {off:.1} stated standard deviations, limit {}",
                RULES.contradicted_sd
            )
        }
        None if found.unexplained > RULES.unexplained && found.over_noise > RULES.over_noise => {
            format!(
                "with the best frequencies and damping of the modes, {:.0} % of the mean square of the vibration remains unexplained in the residual, limit {:.0} %",
                100.0 * found.unexplained,
                100.0 * RULES.unexplained
            )
        }
        None => return None,
    };
    Some(Finding::new(
        Severity::Error,
        "modes-contradicted",
        file,
        format!("{what}; recovered loads contain the vibration that remains"),
        "correct the stiffness or the mass of the model, state a larger `frequency_uncertainty_rel`, or set `damping = \"estimate\"`",
    ))
}

/// Returns the finding on the vibration that was removed from the record.
pub(super) fn vibration_finding(motion: &Motion, asked: &Dynamic, file: &str) -> Finding {
    let known: Option<Vec<f64>> = motion.change_rel.iter().copied().collect();
    let most = known.map(|k| k.into_iter().fold(0.0_f64, f64::max));
    let as_at_rest = match most {
        Some(most) => format!(
            "without the correction, a load would be wrong by up to {:.1} % of its rms about the mean",
            100.0 * most
        ),
        None => "the error of the loads without the correction is not known".to_owned(),
    };
    let first = motion.modes_hz.first();
    let first = first.map_or_else(String::new, |f| format!(", the first at {f:.2} Hz"));
    let damping = match &asked.damping {
        Damping::Uniform(damping) => format!("damping {damping}"),
        Damping::Bands(_) => "damping by band".to_owned(),
        Damping::Estimate => "damping estimated from the record".to_owned(),
    };
    let finding = Finding::new(
        Severity::Info,
        "vibration-taken-out",
        file,
        format!(
            "loads up to {} Hz, with {} modes{first}, {damping}: {as_at_rest}; {:.3} s at either end and next to gaps are blank",
            asked.up_to_hz,
            motion.modes_hz.len(),
            motion.blank_s
        ),
        "",
    );
    match most {
        Some(most) => finding.with_numbers(most, 0.0),
        None => finding,
    }
}

/// Returns the warning that `[dynamic]` has no effect on runs.
pub(super) fn without_record() -> Finding {
    Finding::new(
        Severity::Warning,
        "dynamic-without-record",
        "dynamic",
        "the strain file contains runs, which are treated as quasi-static: [dynamic] has no effect",
        "name a record, or delete [dynamic]",
    )
}
