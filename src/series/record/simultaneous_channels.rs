//! Channels of one file that were sampled at the same times.

use super::span::EVEN;
use crate::series::error::SeriesError;

/// Times of the samples of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sampling {
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Time between samples, s. It is 0 if another channel contains the times.
    pub step_s: f64,
    /// Number of samples.
    pub samples: usize,
    /// Number of the channel that contains the times, if there is one.
    pub times: Option<usize>,
    /// Whether the file states the unit of its steps.
    pub unit_stated: bool,
}

impl Sampling {
    /// Returns whether the samples of both were taken together: no time differs by more than the share of a step that counts as even.
    fn is_same(&self, other: &Self) -> bool {
        let start = (self.start_s - other.start_s).abs();
        let drift = (self.step_s - other.step_s).abs() * self.samples as f64;
        self.samples == other.samples
            && self.times == other.times
            && start + drift <= EVEN * self.step_s
    }
}

/// Returns the sampling of the main channels, and for each channel whether it was sampled together with them. The main channels are the group with
/// most of the `wanted` names. If no name is wanted, they are the group with most numbers. `None` if no channel has samples.
///
/// # Errors
/// Wanted channels that were sampled at other times.
pub(super) fn sampled_together(
    channels: &[(&str, Sampling)],
    wanted: &[String],
) -> Result<Option<(Sampling, Vec<bool>)>, SeriesError> {
    let is_wanted = |name: &str| wanted.iter().any(|w| w == name);
    let weight = |of: &Sampling| {
        let same = channels.iter().filter(|c| c.1.is_same(of));
        let asked = same.clone().filter(|c| is_wanted(c.0)).count();
        (asked, same.count().saturating_mul(of.samples))
    };
    let sampled = channels.iter().filter(|c| c.1.samples > 0);
    let Some((_, main)) = sampled.max_by_key(|c| weight(&c.1)) else {
        return Ok(None);
    };
    let together: Vec<bool> = channels.iter().map(|c| c.1.is_same(main)).collect();
    let apart = channels.iter().zip(&together);
    let names: Vec<String> = apart
        .filter(|(c, together)| !**together && is_wanted(c.0))
        .map(|(c, _)| c.0.to_owned())
        .collect();
    match names.is_empty() {
        true => Ok(Some((*main, together))),
        false => Err(SeriesError::Apart { names }),
    }
}
