//! Where, when, at which frequency and at which size of the motion a gap is largest.

use super::gap::{EquationGap, RecordGap};
use serde::Serialize;

/// Stretch of frequency, time or size, and the gap there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stretch {
    /// Begin of the stretch: Hz, s, or size of the motion.
    pub from: f64,
    /// End of the stretch, in the unit of `from`.
    pub to: f64,
    /// Gap in the stretch, divided by the measured size in the whole record.
    pub gap: f64,
    /// Smallest gap of all stretches of this kind.
    pub least: f64,
}

/// The gap of one equation, and where it is largest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GapSits {
    /// Equation, such as `body b`.
    pub equation: String,
    /// Gap of the equation.
    pub gap: f64,
    /// Expected residual from sensor noise and tolerances.
    pub floor: f64,
    /// Band of frequency, Hz.
    pub band_hz: Option<Stretch>,
    /// Stretch of the record, s.
    pub time_s: Option<Stretch>,
    /// Size of the measured quantity, divided by its root mean square.
    pub size_over_rms: Option<Stretch>,
}

/// Returns every equation of a gap, the equation furthest above its floor first.
pub fn gap_sits(gap: &RecordGap) -> Vec<GapSits> {
    let above = |e: &&EquationGap| e.gap / e.floor.max(f64::MIN_POSITIVE);
    let mut sorted: Vec<&EquationGap> = gap.equations.iter().collect();
    sorted.sort_by(|a, b| above(b).total_cmp(&above(a)));
    sorted.into_iter().map(sits).collect()
}

fn sits(e: &EquationGap) -> GapSits {
    let times = &e.profile.by_time;
    // Time intervals are equally long. Bands and amplitude classes begin where the previous one ends.
    let begin = match times.as_slice() {
        [a, b, ..] => a[0] - (b[0] - a[0]),
        _ => 0.0,
    };
    GapSits {
        equation: e.name.clone(),
        gap: e.gap,
        floor: e.floor,
        band_hz: find_largest_gap(&e.by_band, 0.0),
        time_s: find_largest_gap(times, begin),
        size_over_rms: find_largest_gap(&e.profile.by_amplitude, 0.0),
    }
}

/// Returns the stretch with the largest gap; `stretches` are upper edges with gaps, ascending from `begin`.
fn find_largest_gap(stretches: &[[f64; 2]], begin: f64) -> Option<Stretch> {
    let edges = stretches.iter().map(|s| s[0]);
    let from = std::iter::once(begin).chain(edges);
    let least = stretches.iter().map(|s| s[1]).fold(f64::INFINITY, f64::min);
    from.zip(stretches)
        .map(|(from, [to, gap])| Stretch {
            from,
            to: *to,
            gap: *gap,
            least,
        })
        .max_by(|a, b| a.gap.total_cmp(&b.gap))
}

impl GapSits {
    /// Returns the gap and its largest stretches as a sentence.
    pub fn words(&self) -> String {
        let percent = |v: f64| format!("{:.2} %", 100.0 * v);
        let mut out = format!(
            "`{}`: gap {} of the measured quantity, floor {}",
            self.equation,
            percent(self.gap),
            percent(self.floor)
        );
        if let Some(b) = &self.band_hz {
            out += &format!(
                "; the largest part is between {:.1} and {:.1} Hz ({})",
                b.from,
                b.to,
                percent(b.gap)
            );
        }
        if let Some(t) = &self.time_s {
            out += &format!(
                "; largest from {:.1} to {:.1} s ({}; smallest eighth of the record {})",
                t.from,
                t.to,
                percent(t.gap),
                percent(t.least)
            );
        }
        if let Some(a) = &self.size_over_rms {
            out += &format!(
                "; largest at {:.2} to {:.2} times the root mean square of the motion ({}; smallest amplitude class {})",
                a.from,
                a.to,
                percent(a.gap),
                percent(a.least)
            );
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::{Stretch, find_largest_gap};

    #[test]
    fn the_largest_stretch_begins_where_the_one_before_ends() {
        let found = find_largest_gap(&[[4.0, 0.1], [6.0, 0.5], [8.0, 0.2]], 2.0);
        let expected = Stretch {
            from: 4.0,
            to: 6.0,
            gap: 0.5,
            least: 0.1,
        };
        assert_eq!(found, Some(expected));
        assert_eq!(find_largest_gap(&[], 0.0), None);
    }

    #[test]
    fn the_first_stretch_begins_at_the_beginning() {
        let found = find_largest_gap(&[[4.0, 0.9], [6.0, 0.5]], 2.0).map(|s| [s.from, s.to]);
        assert_eq!(found, Some([2.0, 4.0]));
    }
}
