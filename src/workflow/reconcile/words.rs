//! Effects and the verdict in words: on the terminal, on the page and in the extended job, the same for strain and motion.

use super::answer::{EffectFound, GapFound, Reconciled};
use crate::estimate::NORMAL_95;
use crate::reconcile::Verdict;
use crate::units::{number, plus_minus};

/// Returns an effect with its size and the half width of its 95 % interval: `rail_stiffness:L4: 14.8 ± 2.2 percent`.
pub fn effect_in_words(e: &EffectFound) -> String {
    match size_in_words(e).as_str() {
        "" => e.id.clone(),
        size => format!("{}: {size}", e.id),
    }
}

/// Returns the sizes of an effect, each with the half width of its 95 % interval, and their unit; empty for a cause or a fault without a size.
pub fn size_in_words(e: &EffectFound) -> String {
    let Some(found) = e.size.as_ref().filter(|s| !s.sizes.is_empty()) else {
        return String::new();
    };
    let pairs = found.sizes.iter().zip(&found.sigmas);
    let sizes: Vec<String> = pairs.map(|(v, s)| plus_minus(*v, NORMAL_95 * s)).collect();
    format!("{} {}", sizes.join(", "), found.unit)
}

/// Returns an effect as a clause of a sentence.
fn clause(e: &EffectFound) -> String {
    let kind = e.id.split(':').next().unwrap_or(&e.id);
    match (kind, &e.place) {
        ("sign_flip", Some(place)) => format!("{place} reads with reversed sign"),
        ("dead_channel", Some(place)) => format!("{place} gives no signal"),
        _ => effect_in_words(e),
    }
}

impl Reconciled {
    /// Returns the verdict as a sentence.
    pub(super) fn sentence(&self) -> String {
        let gap = &self.gap;
        match self.verdict {
            Verdict::Named => {
                let mut causes: Vec<String> = self.effects.iter().map(clause).collect();
                if causes.is_empty() {
                    causes = self.named.clone();
                }
                format!("Identified: {}{}.", causes.join("; "), closed(gap))
            }
            Verdict::None => format!(
                "Model and measurement agree within noise and stated uncertainty{}.",
                open(gap)
            ),
            Verdict::Unknown => format!(
                "Model and measurement disagree, and no known effect explains it{}.",
                open(gap)
            ),
            Verdict::BelowDetectability => format!(
                "An effect is indicated, too small for these data to identify{}.",
                open(gap)
            ),
        }
    }
}

/// The gap before and after, where one is known.
fn closed(gap: &GapFound) -> String {
    match gap.before.is_finite() && gap.after.is_finite() {
        true => format!(
            "; the gap falls from {} % to {} %",
            percent(gap.before),
            percent(gap.after)
        ),
        false => String::new(),
    }
}

/// The gap, where one is known, with the part that noise explains.
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
