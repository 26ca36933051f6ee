//! Whether the residual of a fitted model exceeds the errors of its sensors: then an effect is missing, and the parameters compensate for it.

use super::adjustment::Adjustment;
use super::layout::{Measures, Vehicle};
use super::loads::Blend;
use super::misfit::channel_residuals;
use super::motion::{Treatment, VehicleError, motion};
use crate::finding::{Finding, Severity};
use crate::series::channels::Channels;
use crate::series::detrend::rms;
use crate::units::number;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Possible factor between declared and true noise: the declared value is from a data sheet, or was estimated without excitation.
const NOISE_FACTOR: f64 = 1.5;
/// Standard deviations of declared tolerances that one job of a hundred exceeds.
const TOLERANCE_SD: f64 = 2.6;
/// Ratio of a misfit to the limit for 99 complete models of 100, from which the misfit is far above its floor. Nearer to the limit, the errors of
/// parameters are about as large as their intervals.
const FAR: f64 = 2.0;

/// Declared errors of the channels, one sd each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeclaredErrors {
    /// Noise of accelerometers, a sample; `None` if not declared.
    pub noise_acc: Option<f64>,
    /// Noise of wheel forces, a sample; `None` if not declared.
    pub noise_force: Option<f64>,
    /// Gain of every channel, a share.
    pub gain: f64,
    /// Synchronisation of every channel, s.
    pub sync_s: f64,
}

/// Expected misfit of a channel from sensor errors, and the misfit that 99 of 100 complete models do not exceed. Both in the channel's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelFloor {
    /// Channel.
    pub channel: String,
    /// Expected RMS misfit.
    pub expected: f64,
    /// RMS misfit from noise alone.
    pub noise: f64,
    /// RMS misfit that 99 of 100 complete models do not exceed.
    pub limit: f64,
}

/// Computes the floors of the misfit of every channel of a record by applying the declared errors a second time. It adds noise of the declared size,
/// and changes gains and timing by one sd each. The change of the residuals is equal to the contribution of these errors to the present residuals.
/// Empty if no noise is declared.
///
/// # Errors
/// Errors of [`motion`].
pub fn channel_floors(
    vehicle: &Vehicle,
    values: &[f64],
    blend: &Blend,
    record: &Channels,
    treatment: &Treatment,
    declared: &DeclaredErrors,
) -> Result<Vec<ChannelFloor>, VehicleError> {
    let sensors = (vehicle.sensors.iter()).map(|s| (&s.channel, declared.noise_acc, s.measures));
    let forces =
        (vehicle.wheels.iter()).map(|w| (&w.channel, declared.noise_force, Measures::Acceleration));
    let present: Vec<_> = sensors.chain(forces).filter(|c| record.has(c.0)).collect();
    if present
        .iter()
        .any(|c| c.1.is_none() || c.2 != Measures::Acceleration)
    {
        return Ok(vec![]);
    }
    let residuals = |record: &Channels, treatment: &Treatment| {
        let m = motion(vehicle, record, treatment)?;
        Ok::<_, VehicleError>(channel_residuals(vehicle, values, &m, blend))
    };
    let plain = residuals(record, treatment)?;
    let changes = |other: &[(String, Vec<f64>, f64)]| -> Vec<f64> {
        plain
            .iter()
            .zip(other)
            .map(|(a, b)| {
                let d: Vec<f64> = a.1.iter().zip(&b.1).map(|(x, y)| x - y).collect();
                rms(&d)
            })
            .collect()
    };
    let mut noisy = record.clone();
    let mut dice = ChaCha8Rng::seed_from_u64(1);
    for (name, sd, _) in &present {
        let sd = sd.unwrap_or(0.0);
        for c in noisy.list.iter_mut().filter(|c| c.name == **name) {
            // Add uniform noise of the given variance. The sum of many samples is normal in any case.
            let width = sd * 12f64.sqrt();
            c.samples
                .iter_mut()
                .for_each(|x| *x += width * (dice.random::<f64>() - 0.5));
        }
    }
    let noise = changes(&residuals(&noisy, treatment)?);
    let mut loose = vec![0.0; plain.len()];
    for (name, _, _) in &present {
        for (gain, delay_s) in [(1.0 + declared.gain, 0.0), (1.0, declared.sync_s)] {
            if gain == 1.0 && delay_s == 0.0 {
                continue;
            }
            let trial = Adjustment {
                gain,
                delay_s,
                ..Adjustment::none(name)
            };
            let moved = Treatment {
                adjust: treatment.adjust.iter().cloned().chain([trial]).collect(),
                ..treatment.clone()
            };
            let change = changes(&residuals(record, &moved)?);
            loose.iter_mut().zip(change).for_each(|(l, c)| *l += c * c);
        }
    }
    let of = |i: usize, noise_times: f64, sd: f64| {
        (noise_times * noise[i]).hypot(sd * f64::sqrt(loose[i]))
    };
    Ok(plain
        .iter()
        .enumerate()
        .map(|(i, (channel, ..))| ChannelFloor {
            channel: channel.clone(),
            expected: of(i, 1.0, 1.0),
            noise: noise[i],
            limit: of(i, NOISE_FACTOR, TOLERANCE_SD),
        })
        .collect())
}

/// Ratio of noise to reading from which a channel gives no information.
const DROWNED: f64 = 1.0;

/// Returns an error if a channel reads less than the stated noise explains. `share` is noise divided by the reading.
pub fn check_noise(channel: &str, share: f64, on: &str) -> Option<Finding> {
    (share >= DROWNED).then(|| {
        let message = format!(
            "The signal of `{channel}` in the band is below its stated noise ({on} data, factor {}): it gives no information. The assumed \
             unit is wrong, the stated noise is too large, or the body did not move.",
            number(share)
        );
        let remedy = "State the unit after the name of the channel, `f_wheel [kN]`, or the noise of the sensor.";
        let code = "readings-below-noise";
        Finding::new(Severity::Error, code, channel, message, remedy).with_numbers(share, DROWNED)
    })
}

/// Share of a channel that a useful model may leave unexplained: half of it, whatever noise and tolerances are.
const LOST: f64 = 0.5;

/// Returns an error if the model does not explain most of a channel, although no floor is stated.
pub fn check_lost(channel: &str, relative: f64, on: &str) -> Option<Finding> {
    if relative < LOST {
        return None;
    }
    let message = format!(
        "The model leaves {:.0} % of `{channel}` unexplained ({on} data): its parameters do not describe this vehicle.",
        100.0 * relative
    );
    let remedy = "Check signs and units of the channels, the band and the names of the columns; then run `reconcile` on this job.";
    let code = "model-incomplete";
    Some(Finding::new(Severity::Error, code, channel, message, remedy).with_numbers(relative, LOST))
}

/// Returns an error if the misfit of a channel is far above its floor.
pub fn check_adequacy(channel: &str, relative: f64, floor: [f64; 2], on: &str) -> Option<Finding> {
    let [expected, limit] = floor;
    if relative.is_nan() || relative <= FAR * limit {
        return None;
    }
    let message = format!(
        "The model leaves {:.1} % of `{channel}` unexplained ({on} data), and noise and tolerances explain {:.1} %. An effect is missing \
         in the model, and the parameters compensate for it beyond their intervals.",
        100.0 * relative,
        100.0 * expected
    );
    let remedy =
        "Run `reconcile` on this job: it identifies the missing effect and writes an extended job.";
    let finding = Finding::new(
        Severity::Error,
        "model-incomplete",
        channel,
        message,
        remedy,
    );
    Some(finding.with_numbers(relative, FAR * limit))
}
