//! MDF4 records.

use super::channels::{Channel, Channels, SeriesError};
use super::csv::rate_of;
use falcon_mdf::{ChannelGroup, Mf4File};

/// Times of two groups that are the same to this share of a step count as one clock.
const SAME: f64 = 1e-3;

/// Channels sampled together, physical values with their units: those of the channel group that holds most of `wanted` (most numbers,
/// where none is named), with every group on the same times; text is left out. An invalid sample is NaN.
///
/// # Errors
/// A file that can't be read, a group without times, uneven times, a rate other than the declared one, wanted channels on other times.
pub fn read_mdf(
    bytes: &[u8],
    declared_hz: Option<f64>,
    wanted: &[String],
) -> Result<Channels, SeriesError> {
    let broken = |e: falcon_mdf::Mf4Error| SeriesError::Mdf(e.to_string());
    let file = Mf4File::from_bytes(bytes.to_vec()).map_err(broken)?;
    let groups: Vec<&ChannelGroup> = file
        .data_groups()
        .iter()
        .flat_map(|d| &d.channel_groups)
        .filter(|g| values(g).next().is_some())
        .collect();
    let names = |g: &ChannelGroup| -> Vec<String> { values(g).map(|c| c.name.clone()).collect() };
    let weight = |g: &ChannelGroup| {
        let asked = names(g).iter().filter(|n| wanted.contains(n)).count();
        (
            asked,
            g.sample_count.saturating_mul(g.channels.len() as u64),
        )
    };
    let Some(main) = groups.iter().copied().max_by_key(|g| weight(g)) else {
        return Err(SeriesError::Mdf("it holds no channels".into()));
    };
    let times_of = |g: &ChannelGroup| match g.channels.iter().find(|c| c.is_time_channel()) {
        Some(c) => file.channel_timestamps(c).map(Some),
        None => Ok(None),
    };
    let times = times_of(main).map_err(broken)?;
    let (rate_hz, start_s) = match &times {
        Some(t) => rate_of(t, &(1..=t.len()).collect::<Vec<_>>(), declared_hz)?,
        None => (declared_hz.ok_or(SeriesError::NoRate)?, 0.0),
    };
    let together = |other: &Option<Vec<f64>>| match (&times, other) {
        (Some(a), Some(b)) => {
            let near = |(a, b): (&f64, &f64)| (a - b).abs() * rate_hz <= SAME;
            a.len() == b.len() && a.iter().zip(b).all(near)
        }
        _ => false,
    };
    let mut list: Vec<Channel> = Vec::new();
    let mut apart: Vec<String> = Vec::new();
    for group in groups {
        let fits = std::ptr::eq(group, main) || together(&times_of(group).map_err(broken)?);
        if !fits {
            apart.extend(names(group).into_iter().filter(|n| wanted.contains(n)));
            continue;
        }
        for c in values(group) {
            let signal = file.signal(c).map_err(broken)?;
            let mut samples = signal.values_f64().map_err(broken)?;
            if let Some(valid) = signal.validity() {
                for (v, valid) in samples.iter_mut().zip(valid) {
                    *v = if valid { *v } else { f64::NAN };
                }
            }
            list.push(Channel {
                name: c.name.clone(),
                unit: c.unit.clone(),
                samples,
            });
        }
    }
    if !apart.is_empty() {
        return Err(SeriesError::Apart { names: apart });
    }
    Ok(Channels {
        start_s,
        ..Channels::from_list(rate_hz, list)?
    })
}

/// Channels that hold numbers and are not the group's clock.
fn values(g: &ChannelGroup) -> impl Iterator<Item = &falcon_mdf::Channel> {
    let channels = g.channels.iter();
    channels.filter(|c| !c.is_master() && c.is_numeric())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_mdf_is_refused() {
        for bytes in [&b"MDF     4.10    "[..], &[0; 300], b""] {
            assert!(matches!(
                read_mdf(bytes, None, &[]),
                Err(SeriesError::Mdf(_))
            ));
        }
    }
}
