//! Text of effects and of the verdict for the terminal, the page and the extended job, in common for strain and motion.

use super::answer::{EffectFound, GapFound, Reconciliation};
use crate::estimate::NORMAL_95;
use crate::finding::list_few;
use crate::reconcile::Verdict;
use crate::units::{number, plus_minus};

/// Returns an effect with its size and the half width of its 95 % interval: `rail_stiffness:L4: 14.8 ± 2.2 percent`.
pub fn effect_in_words(e: &EffectFound) -> String {
    match size_in_words(e).as_str() {
        "" => e.id.clone(),
        size => format!("{}: {size}", e.id),
    }
}

/// Returns the sizes of an effect, each with the half width of its 95 % interval, and their unit. The text is empty for a cause or a fault without a
/// size.
pub fn size_in_words(e: &EffectFound) -> String {
    let Some(found) = e.size.as_ref().filter(|s| !s.sizes.is_empty()) else {
        return String::new();
    };
    let pairs = found.sizes.iter().zip(&found.sigmas);
    let sizes: Vec<String> = pairs.map(|(v, s)| plus_minus(*v, NORMAL_95 * s)).collect();
    match found.unit.as_str() {
        "1" => sizes.join(", "),
        unit => format!("{} {unit}", sizes.join(", ")),
    }
}

/// Returns an effect as a clause of a sentence: what, where and how large, with the half width of the 95 % interval.
fn clause(e: &EffectFound) -> String {
    let (kind, place) = (
        e.id.split(':').next().unwrap_or(&e.id),
        e.place.as_deref().unwrap_or(""),
    );
    let Some(found) = &e.size else {
        return e.id.clone();
    };
    let pairs: Vec<(f64, f64)> = (found.sizes.iter().copied())
        .zip(found.sigmas.iter().map(|s| NORMAL_95 * s))
        .collect();
    let both = place.replace('+', " and ");
    match (kind, pairs.as_slice()) {
        ("sign_flip", _) => format!("{place} reads with reversed sign"),
        ("dead_channel", _) => format!("{place} gives no signal"),
        ("gauge_swap", _) => format!("the columns of {both} are exchanged"),
        ("run_exchange", _) => format!("the readings of runs {both} are exchanged"),
        ("rail_stiffness", [(v, half)]) => {
            format!(
                "zone {place} is {} than the model",
                stiffness_in_words(*v, *half)
            )
        }
        ("joint_stiffness" | "local_stiffness", [(v, half)]) => {
            // The size is the natural log of the stiffness times 100.
            let percent = |log: f64| 100.0 * (0.01 * log).exp_m1();
            let half = 0.5 * (percent(v + half) - percent(v - half));
            format!(
                "{place} is {} than the model",
                stiffness_in_words(percent(*v), half)
            )
        }
        ("gauge_gain" | "accel_gain", [(v, half)]) => {
            format!(
                "{place} reads {} times the true value",
                plus_minus(*v, *half)
            )
        }
        ("gauge_angle", [(v, half)]) => {
            format!("{place} is turned by {} degrees", plus_minus(*v, *half))
        }
        ("zero_drift", [(v, half), ..]) => format!(
            "the zero of {place} is off by {} {}",
            plus_minus(*v, *half),
            found.unit
        ),
        ("unaccounted_mass", [(v, half)]) => {
            format!("the model lacks {} kg at {place}", plus_minus(*v, *half))
        }
        ("thermal_uniform", [(v, half)]) => format!(
            "the temperature differs from the temperature of the zeros by {} degC (rms over the runs)",
            plus_minus(*v, *half)
        ),
        ("lateral_wheel_loads", sizes) if sizes.len() == SIDE.len() => {
            let each = SIDE.iter().zip(sizes);
            let each = each.map(|((name, unit), (v, half))| {
                format!("{name} {} {unit}", plus_minus(*v, *half))
            });
            let each: Vec<String> = each.collect();
            format!("the wheels carry side loads: {} (rms)", each.join(", "))
        }
        _ => effect_in_words(e),
    }
}

/// Components of side loads in the order of their sizes, with their units.
const SIDE: [(&str, &str); 5] = [
    ("FX", "kN"),
    ("FY", "kN"),
    ("MX", "kN m"),
    ("MY", "kN m"),
    ("MZ", "kN m"),
];

/// Returns a change of stiffness in percent as `15.8 ± 0.4 % less stiff`.
fn stiffness_in_words(percent: f64, half: f64) -> String {
    let way = if percent < 0.0 { "less" } else { "more" };
    format!("{} % {way} stiff", plus_minus(percent.abs(), half))
}

impl Reconciliation {
    /// Returns the verdict as text: what is wrong, where, how large, how certain, and what to do.
    pub(super) fn sentence(&self) -> String {
        let gap = &self.gap;
        match self.verdict {
            Verdict::Named => {
                let mut causes: Vec<String> = self.effects.iter().map(clause).collect();
                if causes.is_empty() {
                    causes = self.named.clone();
                }
                format!(
                    "Identified: {}{}{}.{}",
                    causes.join("; "),
                    self.gauges_closed(),
                    closed_gap_in_words(gap),
                    self.confidence_in_words()
                )
            }
            Verdict::None => format!(
                "Model and measurement agree within noise and stated uncertainty{}.",
                open(gap)
            ),
            Verdict::Unknown => format!(
                "Model and measurement disagree, and no known effect explains it{}.{}",
                open(gap),
                self.nearest_explanation()
            ),
            Verdict::BelowDetectability => format!(
                "The data indicate an effect that is too small to identify{}.{}",
                open(gap),
                self.nearest_explanation()
            ),
        }
    }

    /// Returns the gauges that the effects explain as text, worst first. Their gap exceeds their own expected residual before the effects, and not
    /// after them.
    fn gauges_closed(&self) -> String {
        /// Gauges that one sentence names at most.
        const MOST: usize = 4;
        let Some(strain) = &self.strain else {
            return String::new();
        };
        let still = |name: &str| strain.gauges_off.iter().any(|m| m.name == name);
        let off = strain.gauges_off_before.iter();
        let names: Vec<&str> = off.map(|m| m.name.as_str()).filter(|n| !still(n)).collect();
        let residuals = |after: bool| {
            let own = strain.outcome.channels.iter();
            let own = own.filter(|c| names.iter().take(MOST).any(|n| *n == c.channel));
            let own = own.map(|c| if after { c.after } else { c.before });
            own.fold(0.0f64, f64::max)
        };
        match names.len() {
            0 => String::new(),
            _ => format!(
                "; {} {} off by up to {} microstrain, and now by up to {} microstrain",
                list_few(&names[..names.len().min(MOST)]),
                if names.len() == 1 { "was" } else { "were" },
                number(residuals(false)),
                number(residuals(true))
            ),
        }
    }

    /// Returns the confidence in the identified set, in words.
    fn confidence_in_words(&self) -> String {
        let strain = self.strain.as_ref();
        strain.map_or_else(String::new, |s| {
            format!(" {} of 100 resampled run sets agree.", s.wins_of_100)
        })
    }

    /// Returns the sentence on the nearest explanation, for a gap without an identified effect.
    fn nearest_explanation(&self) -> String {
        let attempt = self.best_attempt.iter().flatten();
        let attempt: Vec<String> = attempt.map(clause).collect();
        let near = match (attempt.is_empty(), self.rivals.first()) {
            (false, _) => attempt.join("; "),
            (true, Some(r)) => r.id.clone(),
            (true, None) => return String::new(),
        };
        format!(" Nearest explanation, not applied: {near}.")
    }
}

/// Returns the gap before and after, if it is known.
fn closed_gap_in_words(gap: &GapFound) -> String {
    match gap.before.is_finite() && gap.after.is_finite() {
        true => format!(
            "; the gap falls from {} % to {} %",
            percent(gap.before),
            percent(gap.after)
        ),
        false => String::new(),
    }
}

/// Returns the gap, if it is known, with the part that noise explains.
fn open(gap: &GapFound) -> String {
    let floor = gap.floor.filter(|f| f.is_finite());
    let floor = floor.map_or_else(String::new, |f| {
        format!(
            ", {} % expected from noise and stated uncertainty",
            percent(f)
        )
    });
    match gap.before.is_finite() {
        true => format!(": gap {} %{floor}", percent(gap.before)),
        false => String::new(),
    }
}

fn percent(share: f64) -> String {
    number(100.0 * share)
}
