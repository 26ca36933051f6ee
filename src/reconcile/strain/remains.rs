//! Description of the residual after the best explanation: its gauges, its runs, its growth with the load.

use super::adequacy::Adequacy;
use super::bias::model_bias;
use super::covariance::Selection;
use super::frame::StrainFrame;
use super::prediction::predict;
use crate::estimate::rms;
use crate::reconcile::effect::Member;
use crate::reconcile::outcome::{ChannelGap, Misfit};

/// Returns one or two sentences on the residual of the fit runs under `members`.
pub fn remains(
    frame: &StrainFrame,
    members: &[Member<'_>],
    after: &Adequacy,
    strange: Option<&str>,
    withheld: Option<&[String]>,
) -> String {
    let rest = describe_excess_residual(frame, members, after, withheld);
    match (strange, strange.and_then(|_| model_bias(frame))) {
        (Some(words), Some(bias)) => format!("{bias}; or {words}; then: {rest}"),
        (Some(words), None) => format!("{words}; then: {rest}"),
        (None, _) => rest,
    }
}

/// Returns a text with the gauges that contribute most to the squared gap, and the gauges above their own floor.
pub fn sits(channels: &[ChannelGap], off: &[Misfit]) -> String {
    /// Largest number of gauges in a sentence.
    const MOST: usize = 5;
    /// Smallest share of the squared gap for which a gauge is listed.
    const SHARE: f64 = 0.05;
    let total: f64 = channels.iter().map(|c| c.before * c.before).sum();
    if total <= 0.0 {
        return "no gauge has a gap".into();
    }
    let share = |c: &ChannelGap| c.before * c.before / total;
    let mut sorted: Vec<&ChannelGap> = channels.iter().filter(|c| share(c) >= SHARE).collect();
    sorted.sort_by(|a, b| share(b).total_cmp(&share(a)));
    let named: Vec<String> = sorted
        .iter()
        .take(MOST)
        .map(|c| format!("{} {:.0} %", c.channel, 100.0 * share(c)))
        .collect();
    let spread = if named.is_empty() {
        "the gap is spread over all gauges".to_owned()
    } else {
        format!("share of the squared gap: {}", named.join(", "))
    };
    let beyond: Vec<&str> = off.iter().take(MOST).map(|m| m.name.as_str()).collect();
    if beyond.is_empty() {
        format!("{spread}; no gauge exceeds its own floor")
    } else {
        format!(
            "{spread}; gauges above their own floor: {}",
            beyond.join(", ")
        )
    }
}

/// Returns the text for a residual without a single gauge or run above its floor. `withheld` contains the reasons against the set if a gap is
/// present nevertheless.
fn none_alone(reduced_chi2: f64, withheld: Option<&[String]>) -> String {
    match withheld {
        None => {
            format!("no gauge and no run exceeds its floor (reduced chi-square {reduced_chi2:.2})")
        }
        Some(reasons) => format!(
            "no single gauge and no single run exceeds its floor (reduced chi-square {reduced_chi2:.2} over all), and no effect is identified: {}",
            match reasons {
                [] => "all gauges and runs together exceed their floor".to_owned(),
                list => list.join(", "),
            }
        ),
    }
}

/// Returns a text on the residual above the expected one: its gauges, its runs and its growth with the load.
fn describe_excess_residual(
    frame: &StrainFrame,
    members: &[Member<'_>],
    after: &Adequacy,
    withheld: Option<&[String]>,
) -> String {
    let list = |parts: &[Misfit]| {
        let mut sorted: Vec<&Misfit> = parts.iter().filter(|m| m.deviate > 3.0).collect();
        sorted.sort_by(|a, b| b.deviate.total_cmp(&a.deviate));
        sorted
            .iter()
            .take(4)
            .map(|m| format!("{} (reduced chi-square {:.1})", m.name, m.reduced_chi2))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let (gauges, runs) = (list(&after.gauges), list(&after.runs));
    if gauges.is_empty() && runs.is_empty() {
        return none_alone(after.fit, withheld);
    }
    let mut out = format!(
        "reduced chi-square {:.2} over all gauges and runs",
        after.fit
    );
    if let Some(reasons) = withheld.filter(|r| !r.is_empty()) {
        out += &format!("; nothing is named: {}", reasons.join(", "));
    }
    if !gauges.is_empty() {
        out += &format!("; gauges: {gauges}");
    }
    if !runs.is_empty() {
        out += &format!("; runs: {runs}");
    }
    let n_g = frame.n_gauges();
    let predicted = predict(frame, members);
    let points: Vec<(f64, f64)> = frame
        .observations
        .fit_runs()
        .iter()
        .map(|&r| {
            let s = Selection::of_runs(frame, &[r]);
            let p = s.pick(&predicted, n_g);
            let y = s.pick(&frame.observations.values, n_g);
            (
                rms(p.iter().copied()),
                rms(y.iter().zip(&p).map(|(a, b)| a - b)),
            )
        })
        .collect();
    match correlation(&points) {
        Some(c) if c > 0.7 => out + "; the gap grows with the load",
        Some(c) if c < 0.3 => out + "; the gap does not grow with the load",
        _ => out,
    }
}

/// Returns Pearson's correlation; `None` for constant data.
fn correlation(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let (mx, my) = (
        points.iter().map(|p| p.0).sum::<f64>() / n,
        points.iter().map(|p| p.1).sum::<f64>() / n,
    );
    let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let syy: f64 = points.iter().map(|p| (p.1 - my).powi(2)).sum();
    (sxx > 0.0 && syy > 0.0).then(|| sxy / (sxx * syy).sqrt())
}

#[cfg(test)]
mod tests {
    use super::none_alone;

    /// Tests that the text does not claim "nothing above the floor" if a gap is present, for any reason against the set.
    #[test]
    fn nothing_above_the_floor_is_reported_only_without_a_gap() {
        let reasons = ["three neighbours".to_owned()];
        for (withheld, expected) in [(&reasons[..], "three neighbours"), (&[], "together")] {
            let words = none_alone(1.0, Some(withheld));
            assert!(
                !words.contains("no gauge and no run exceeds its floor"),
                "{words}"
            );
            assert!(words.contains(expected), "{words}");
        }
        assert!(none_alone(1.0, None).contains("no gauge and no run exceeds its floor"));
    }
}
