//! Residual of a measurement under an explanation, and how readings, faults and tolerances enter it.

use super::bench::{stroke_delay_rows, turn_over};
use super::measurement::{Measurement, is_driven};
use super::parameter_information::{ParameterInformation, Rows};
use crate::linalg::tall::left_inverse;
use crate::reconcile::motion::columns::{fault_columns, nuisance, parameter_column, slices};
use crate::reconcile::motion::corrections::adjustments;
use crate::reconcile::motion::design::{BinChannel, BinEquation, Bins, Design, design, size};
use crate::reconcile::motion::frame::MotionFrame;
use crate::reconcile::motion::motion_fit::MotionFit;
use crate::reconcile::motion::noise::{Background, UNDECLARED, Whitener, band_of, covariance};
use crate::reconcile::motion::part::ColumnOf;
use crate::reconcile::motion::response::responses;
use crate::series::channels::{Channel, Channels};
use crate::series::detrend::mean;
use crate::series::spectrum::Fourier;
use crate::series::window::WindowedTransform;
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::layout::Point;
use crate::vehicle::stretch::slow_stretches;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Residual of a measurement under an explanation at its present parameters, and the columns by which parameters change it.
pub(super) enum View {
    /// Equations of motion of a record, or the reading of one more sensor.
    Record(Box<RecordEquations>),
    /// Numbers measured at rest, with their rows. All explanations have the same numbers.
    AtRest(Rows),
}

/// A record under an explanation.
pub(super) struct RecordEquations {
    /// Residual by equation, with the present estimates of tolerances included.
    pub(super) left: Vec<Bins>,
    /// Whether each equation predicts the reading of a new channel. Its residual is then that reading, not an error of the record.
    pub(super) is_new: Vec<bool>,
    /// Contribution of the channels of the record to the equations.
    pub(super) channels: Vec<ChannelResponse>,
    /// Whitening by sensor noise and background.
    pub(super) whitener: Whitener,
    /// Columns of the fit before whitening, in the order of the fit.
    pub(super) own: Vec<Vec<Bins>>,
    /// Columns that the measurement adds, before whitening, with one standard deviation if it is known beforehand.
    pub(super) fresh: Vec<(Vec<Bins>, Option<f64>)>,
    /// Columns of the held parameters, by parameter index, if the measurement sets the scale of masses and springs.
    pub(super) scale: Vec<(usize, Vec<Bins>)>,
    /// Balance of weight, if the measurement adds it.
    pub(super) weight: Option<Weight>,
    /// Length of the measurement in records of this length.
    pub(super) repeats: f64,
}

/// A channel of the record.
pub(super) struct ChannelResponse {
    /// Name.
    pub(super) name: String,
    /// Power of the noise.
    pub(super) power: f64,
    /// Response of each equation to the corrected channel, by bin.
    pub(super) responses: Vec<Bins>,
    /// Ratio of the true value to the reading, by bin.
    pub(super) undone: Bins,
}

/// Balance of weight, with the entries of the columns of [`RecordEquations`], in the same order, divided by its standard deviation.
pub(super) struct Weight {
    /// Weight: g (sum of masses).
    pub(super) weight: f64,
    /// One standard deviation.
    pub(super) sigma: f64,
    /// Entries of the columns of the fit.
    pub(super) own: Vec<f64>,
    /// Entries of the columns that the measurement adds.
    pub(super) fresh: Vec<f64>,
    /// Entries of the columns of the held parameters.
    pub(super) scale: Vec<f64>,
}

/// Returns the residual and the columns of a measurement under an explanation; `None` if its equations cannot be formed.
pub(super) fn view(
    frame: &MotionFrame,
    measurement: &Measurement,
    known: &ParameterInformation,
    background: &Background,
) -> Option<View> {
    match measurement {
        Measurement::TurnOver => Some(View::AtRest(turn_over(frame, known.fit))),
        Measurement::Strike => Some(View::AtRest(stroke_delay_rows(frame, known.fit))),
        Measurement::Beside(at) => form_sensor_equation(frame, known.fit, *at).map(View::record),
        Measurement::Road(_)
        | Measurement::Part { .. }
        | Measurement::Longer(_)
        | Measurement::Forces(_)
        | Measurement::KnownMass { .. } => {
            form_drive_equations(frame, measurement, known, background).map(View::record)
        }
    }
}

impl View {
    fn record(r: RecordEquations) -> Self {
        Self::Record(Box::new(r))
    }
}

/// Forms the equations of motion of a further drive.
///
/// The motion is the present one with the same filter at every channel, minus the channel errors that explain its residual under one explanation
/// ([`super::alternative_misfit`]). It obeys that explanation to first order in the difference of two explanations. The residual of the other
/// explanation is the difference of the forces of both at that motion.
fn form_drive_equations(
    frame: &MotionFrame,
    measurement: &Measurement,
    known: &ParameterInformation,
    background: &Background,
) -> Option<RecordEquations> {
    let fit = known.fit;
    let mut frame = frame.clone();
    let whole = frame.data.n_samples();
    frame.data = truncate_record(&frame.data);
    let shorter = whole as f64 / frame.data.n_samples().max(1) as f64;
    frame.data = match measurement {
        Measurement::Road(_) | Measurement::Part { .. } => {
            apply_gain(&frame.data, |f| measurement.gain(f))
        }
        _ => frame.data,
    };
    let forces: &[String] = match measurement {
        Measurement::Forces(list) => list,
        _ => &[],
    };
    for channel in forces {
        let n = frame.data.n_samples();
        frame.data.list.push(Channel {
            name: channel.clone(),
            unit: String::new(),
            samples: vec![0.0; n],
        });
    }
    let adjust = adjustments(&frame, &fit.parts);
    let v = &fit.assembled.vehicle;
    let mut values = fit.values.clone();
    if let Measurement::KnownMass { body, mass } = measurement
        && let Some(m) = values.get_mut(v.inertia_index(*body, 0, 0))
    {
        *m += mass;
    }
    let slow = slow_stretches(v, &values, &frame.data, &adjust);
    let mut d = design(&frame, v, &frame.data, &adjust, slow).ok()?;
    let left = d.residual(&values);
    let sets_scale = !forces.is_empty() && !is_driven(&fit.design);
    give_forces(&frame, &mut d, &left, forces, sets_scale)?;
    let h = responses(&d, &values);
    let louder = scale_background(&frame, &fit.design, &d, background, |f| measurement.gain(f));
    let whitener =
        Whitener::from_covariance(&covariance(&frame, &d, &h, &louder), d.equations.len());
    let mut out = with_columns(&frame, fit, &d, &h, left, whitener);
    out.repeats = measurement.repeats() * shorter;
    out.is_new = (d.equations.iter())
        .map(|e| fit.design.equations.iter().all(|n| n.name != e.name))
        .collect();
    out.channels.retain(|c| !forces.contains(&c.name));
    let fixed = |i: &usize| frame.known.contains_key(&v.parameters()[*i].name);
    let fresh: Vec<usize> = (0..fit.values.len())
        .filter(|i| d.has(*i) && !fit.free.contains(i) && !known.held.contains(i) && !fixed(i))
        .collect();
    let column = |i: usize| -> Vec<Bins> {
        let c = parameter_column(&d, i);
        c.into_iter().map(<[Complex64]>::to_vec).collect()
    };
    let n_channels = out.fresh.len();
    out.fresh.extend(fresh.iter().map(|&i| (column(i), None)));
    if sets_scale {
        out.scale = known.held.iter().map(|&i| (i, column(i))).collect();
    }
    if !forces.is_empty() {
        out.weight = weight(&frame, fit, &fresh, known, n_channels, sets_scale);
    }
    Some(out)
}

/// Sets the channels `forces` to the external forces that the equations of motion require, with their noise.
fn give_forces(
    frame: &MotionFrame,
    d: &mut Design,
    left: &[Bins],
    forces: &[String],
    sets_scale: bool,
) -> Option<()> {
    /// Noise of a force channel without declared noise, as a share of the force: a typical value of load cells.
    const NOISE: f64 = 0.01;
    if forces.is_empty() {
        return Some(());
    }
    let v = d.vehicle.clone();
    for channel in forces {
        let at = v.wheels.iter().find(|w| w.channel == *channel)?.at;
        let own: Vec<usize> = (0..v.wheels.len())
            .filter(|&w| v.wheels[w].at.body == at.body)
            .collect();
        let place = own.iter().position(|&w| v.wheels[w].channel == *channel)?;
        let equations: Vec<usize> = (0..d.equations.len())
            .filter(|&e| d.equations[e].body == at.body)
            .collect();
        // Matrix of body motions by wheels. Its inverse gives wheel forces from the residuals of the equations of the body.
        let rows: Vec<Vec<f64>> = equations
            .iter()
            .map(|&e| {
                let motion = d.equations[e].motion;
                let phi = |w: &usize| v.functions(&v.wheels[*w].at).get(motion).copied();
                own.iter().map(|w| phi(w).unwrap_or(0.0)).collect()
            })
            .collect();
        let inverse = left_inverse(&rows)?;
        let mut bins: Bins = vec![Complex64::default(); d.f_hz.len()];
        for (share, &e) in inverse.get(place)?.iter().zip(&equations) {
            bins.iter_mut()
                .zip(left.get(e)?)
                .for_each(|(b, l)| *b += l * *share);
        }
        let rms = size(&bins) / (bins.len().max(1) as f64).sqrt();
        let assumed = NOISE * rms * d.thinning.sqrt();
        let noise = frame.noise_force.filter(|_| !sets_scale).unwrap_or(assumed);
        let c = d.channels.iter_mut().find(|c| c.name == *channel)?;
        c.bins = bins;
        c.noise = Some(noise);
    }
    Some(())
}

/// Returns the balance of weight that force channels add; `None` if the bodies do not rest on wheels or its standard deviation is not positive.
fn weight(
    frame: &MotionFrame,
    fit: &MotionFit,
    fresh: &[usize],
    known: &ParameterInformation,
    n_channels: usize,
    sets_scale: bool,
) -> Option<Weight> {
    let v = &fit.assembled.vehicle;
    if !v.rests_on_wheels(&frame.bodies) {
        return None;
    }
    let masses = v.masses(&frame.bodies);
    let sum: f64 = masses
        .iter()
        .filter_map(|&i| fit.values.get(i).filter(|m| m.is_finite()))
        .sum();
    let sigma = frame.rules.zero_force.hypot(frame.gain_tolerance) * frame.gravity * sum.abs();
    if !(sigma > 0.0) {
        return None;
    }
    let entry = |i: usize| match masses.contains(&i) {
        true => frame.gravity / sigma,
        false => 0.0,
    };
    let own = fit.column_of.iter().map(|of| match of {
        ColumnOf::Parameter(i) => entry(*i),
        _ => 0.0,
    });
    Some(Weight {
        weight: frame.gravity * sum,
        sigma,
        own: own.collect(),
        fresh: (std::iter::repeat_n(0.0, n_channels))
            .chain(fresh.iter().map(|&i| entry(i)))
            .collect(),
        scale: match sets_scale {
            true => known.held.iter().map(|&i| entry(i)).collect(),
            false => vec![],
        },
    })
}

/// Forms the equation for the reading of one more accelerometer at `at`, predicted from the other sensors of the rigid body.
fn form_sensor_equation(
    frame: &MotionFrame,
    fit: &MotionFit,
    at: Point,
) -> Option<RecordEquations> {
    let mut d = (*fit.design).clone();
    let v = d.vehicle.clone();
    let own: Vec<usize> = (0..v.sensors.len())
        .filter(|&s| v.sensors[s].at.body == at.body)
        .collect();
    let rows: Vec<Vec<f64>> = own.iter().map(|&s| v.functions(&v.sensors[s].at)).collect();
    let shares = left_inverse(&rows)?;
    let phi = v.functions(&at);
    let n = d.f_hz.len();
    let mut h: Vec<Vec<Complex64>> = (d.channels.iter())
        .map(|c| {
            let k = own.iter().position(|&s| v.sensors[s].channel == c.name);
            let share = k.map_or(0.0, |k| {
                phi.iter().zip(&shares).map(|(p, w)| p * w[k]).sum()
            });
            vec![Complex64::new(share, 0.0); n]
        })
        .collect();
    let mut window = WindowedTransform::new(d.motion.n_samples(), d.motion.rate_hz, d.band);
    let mut reading: Bins = vec![Complex64::default(); n];
    for (phi, q) in phi.iter().zip(d.motion.bodies.get(at.body)?) {
        reading
            .iter_mut()
            .zip(window.bins(q))
            .for_each(|(r, q)| *r += q * *phi);
    }
    d.channels.push(BinChannel {
        name: String::new(),
        bins: reading.clone(),
        noise: frame.noise_acc,
        gain: 1.0,
        lags: vec![],
    });
    h.push(vec![Complex64::new(-1.0, 0.0); n]);
    d.equations = vec![BinEquation {
        name: String::new(),
        body: at.body,
        motion: 0,
        columns: vec![],
        target: vec![Complex64::default(); n],
    }];
    let h = vec![h];
    let s = covariance(frame, &d, &h, &Background::default());
    let whitener = Whitener::from_covariance(&s, 1);
    Some(with_columns(frame, fit, &d, &h, vec![reading], whitener))
}

/// Returns the record with the columns of the fit and the columns of new tolerances.
fn with_columns(
    frame: &MotionFrame,
    fit: &MotionFit,
    d: &Design,
    h: &[Vec<Vec<Complex64>>],
    mut left: Vec<Bins>,
    whitener: Whitener,
) -> RecordEquations {
    let nothing = || vec![Bins::new(); d.equations.len()];
    let mut tolerances: Vec<Option<(ColumnOf, Vec<Bins>, f64)>> = nuisance(frame, d, h, &fit.parts)
        .into_iter()
        .map(Some)
        .collect();
    let mut take = |is_gain: bool, name: &str| -> Option<Vec<Bins>> {
        let own = |of: &ColumnOf| match of {
            ColumnOf::Gain(c) => is_gain && d.channels[*c].name == name,
            ColumnOf::Delay(c) => !is_gain && d.channels[*c].name == name,
            _ => false,
        };
        let at = tolerances
            .iter_mut()
            .find(|t| t.as_ref().is_some_and(|t| own(&t.0)))?;
        at.take().map(|t| t.1)
    };
    let mut own = Vec::new();
    for (k, of) in fit.column_of.iter().enumerate() {
        let column = match of {
            ColumnOf::Parameter(i) => {
                let c = parameter_column(d, *i);
                Some(c.into_iter().map(<[Complex64]>::to_vec).collect())
            }
            ColumnOf::Fault(p) => {
                let part = &fit.parts[*p];
                fault_columns(d, h, &part.shape, part.fault)
                    .into_iter()
                    .next()
            }
            // The phase of a line differs in every record.
            ColumnOf::Line(_) => None,
            ColumnOf::Gain(c) => take(true, &fit.design.channels[*c].name),
            ColumnOf::Delay(c) => take(false, &fit.design.channels[*c].name),
        };
        let column: Vec<Bins> = column.unwrap_or_else(nothing);
        let is_tolerance = matches!(of, ColumnOf::Gain(_) | ColumnOf::Delay(_));
        if let (true, Some(x)) = (is_tolerance, fit.estimates.get(k)) {
            for (l, c) in left.iter_mut().zip(&column) {
                l.iter_mut().zip(c).for_each(|(l, c)| *l += c * *x);
            }
        }
        own.push(column);
    }
    let adjust = adjustments(frame, &fit.parts);
    RecordEquations {
        left,
        is_new: vec![true; d.equations.len()],
        channels: channel_entries(d, h, &adjust),
        whitener,
        own,
        fresh: (tolerances.into_iter().flatten())
            .map(|(_, c, sd)| (c, Some(sd)))
            .collect(),
        scale: vec![],
        weight: None,
        repeats: 1.0,
    }
}

/// Returns the channels of a design with their noise, their responses and the corrections `adjust`.
fn channel_entries(
    d: &Design,
    h: &[Vec<Vec<Complex64>>],
    adjust: &[Adjustment],
) -> Vec<ChannelResponse> {
    let one = |(c, channel): (usize, &BinChannel)| {
        let n = channel.bins.len().max(1) as f64;
        let assumed = UNDECLARED * size(&channel.bins) / n.sqrt();
        let own = Adjustment::of_channel(adjust, &channel.name);
        let undone = |f: &f64| {
            let one = Complex64::new(1.0, 0.0);
            own.as_ref()
                .map_or(one, |a| a.inverse_response(2.0 * PI * f))
        };
        ChannelResponse {
            name: channel.name.clone(),
            power: channel.noise.unwrap_or(assumed).powi(2),
            responses: h.iter().map(|e| e[c].clone()).collect(),
            undone: d.f_hz.iter().map(undone).collect(),
        }
    };
    d.channels.iter().enumerate().map(one).collect()
}

impl RecordEquations {
    /// Returns unit-variance rows of a column, or of a residual.
    pub(super) fn whiten_bins(&self, bins: &[Bins]) -> Vec<f64> {
        self.whitener.rows(&slices(bins))
    }
}

/// Returns at most the first 65 536 samples of a record. They represent the whole record, since a road is similar from mile to mile.
fn truncate_record(record: &Channels) -> Channels {
    const SAMPLES: usize = 65_536;
    let mut out = record.clone();
    out.list
        .iter_mut()
        .for_each(|c| c.samples.truncate(SAMPLES));
    out
}

/// Returns a record with every motion multiplied by a real gain at each frequency. Means do not change.
fn apply_gain(record: &Channels, gain: impl Fn(f64) -> f64) -> Channels {
    let (mut out, _) = record.with_gaps_filled();
    let mut fourier = Fourier::default();
    for c in &mut out.list {
        let middle = mean(&c.samples);
        let moved: Vec<f64> = c.samples.iter().map(|x| x - middle).collect();
        let s = fourier
            .spectrum(&moved, record.rate_hz)
            .times(|f| Complex64::new(gain(f), 0.0));
        let samples = fourier.samples(&s, 1);
        c.samples = samples.iter().map(|x| x + middle).collect();
    }
    out
}

/// Scales the power of the unexplained background by the mean squared gain of the motion in each band.
fn scale_background(
    frame: &MotionFrame,
    now: &Design,
    d: &Design,
    background: &Background,
    gain: impl Fn(f64) -> f64,
) -> Background {
    let of_band = |band: usize| -> f64 {
        let own = d.f_hz.iter().filter(|f| band_of(frame, **f) == band);
        let (sum, n) = own.fold((0.0, 0usize), |(s, n), f| (s + gain(*f).powi(2), n + 1));
        sum / n.max(1) as f64
    };
    // An equation that was not compared before has no background.
    let row = |e: &BinEquation| -> Vec<f64> {
        let at = now.equations.iter().position(|n| n.name == e.name);
        let own = at.and_then(|at| background.power.get(at));
        let bands = own.into_iter().flatten().enumerate();
        bands.map(|(band, p)| p * of_band(band)).collect()
    };
    Background {
        power: d.equations.iter().map(row).collect(),
    }
}
