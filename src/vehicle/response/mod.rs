//! Response of a vehicle with known parameters to wheel forces, to a road, or to the recorded accelerations of some bodies.
//!
//! Between samples, every input is a cubic curve with continuous slope. For this input a linear vehicle is integrated exactly, by the matrix
//! exponential. Other vehicles are integrated by the Runge-Kutta method of order 4, with steps that are halved until the result settles.

mod cubic;
mod system;
#[cfg(test)]
mod tests;

use super::layout::Vehicle;
use super::term::Term;
use crate::linalg::Matrix;
use crate::linalg::exponential::exponential;
use crate::linalg::tall::left_inverse;
use system::{Coordinate, Moment, System};
use thiserror::Error;

/// Motion of a body that is known.
#[derive(Clone, Debug, PartialEq)]
pub enum PrescribedMotion {
    /// Acceleration of each motion of the body. Velocity and displacement are its integrals from rest.
    Accelerations(Vec<Vec<f64>>),
    /// Displacement of each motion of the body.
    Displacements(Vec<Vec<f64>>),
}

/// Inputs of a response, at one sample rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs {
    /// Samples per second.
    pub rate_hz: f64,
    /// Force of each wheel on its body, upwards, about its static load; `None` if it is not prescribed.
    pub forces: Vec<Option<Vec<f64>>>,
    /// Known motion of each body; `None` for a body that moves freely.
    pub motions: Vec<Option<PrescribedMotion>>,
    /// Link of the tyre of each wheel; `None` for a wheel without a tyre.
    pub tyres: Vec<Option<usize>>,
}

/// Limits of a response, each with its reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResponseRules {
    /// Least number of samples in a period of the fastest mode. With ten, the cubic curve follows a sine to 0.1 % of its amplitude.
    pub samples_per_period: f64,
    /// Largest change of a result, relative to its largest value, when the steps are halved. It is far below the error of any parameter.
    pub settled: f64,
    /// Most steps a sample. More are needed only if a force jumps, for example by friction with a very small velocity.
    pub most_steps: usize,
}

impl Default for ResponseRules {
    fn default() -> Self {
        Self {
            samples_per_period: 10.0,
            settled: 1e-6,
            most_steps: 512,
        }
    }
}

/// Response of every body, link and wheel, sampled like the inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Displacement, `[body][motion][sample]`, from the position at rest.
    pub displacement: Vec<Vec<Vec<f64>>>,
    /// Velocity.
    pub velocity: Vec<Vec<Vec<f64>>>,
    /// Acceleration; NaN where the displacement is an input.
    pub acceleration: Vec<Vec<Vec<f64>>>,
    /// Stretch of each link, `[link][sample]`.
    pub stretch: Vec<Vec<f64>>,
    /// Rate of the stretch of each link.
    pub rate: Vec<Vec<f64>>,
    /// Force of the terms of each link that depend on stretch, positive in tension.
    pub spring: Vec<Vec<f64>>,
    /// Force of the terms of each link that depend on the rate, positive in tension.
    pub damper: Vec<Vec<f64>>,
    /// Force of each wheel on its body, upwards, about its static load; `None` if the model does not determine it.
    pub wheels: Vec<Option<Vec<f64>>>,
    /// Highest natural frequency of the bodies that move freely, Hz; 0 without springs.
    pub fastest_hz: f64,
    /// Runge-Kutta steps a sample; `None` for exact integration.
    pub steps: Option<usize>,
    /// Change of the results, relative to their largest value, when the steps were halved for the last time; 0 for exact integration.
    pub step_error: f64,
}

/// Why a response cannot be computed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ResponseError {
    /// A body without usable inertia.
    #[error("the inertia of body `{0}` is not positive")]
    Inertia(String),
    /// A term without an equation.
    #[error("link `{0}` has inertance, which cannot be simulated")]
    Inertance(String),
    /// Every motion is an input.
    #[error("the motion of every body is prescribed: no motion remains to be simulated")]
    NothingFree,
    /// Histories of different length, or of less than two samples.
    #[error("an input has {found} samples, expected {expected}")]
    Length {
        /// Samples found.
        found: usize,
        /// Samples of the first input, at least 2.
        expected: usize,
    },
    /// Too few samples in a period of the fastest mode.
    #[error(
        "the sample rate is {rate_hz:.4} Hz, but the fastest mode has {fastest_hz:.4} Hz: it needs {needed_hz:.4} Hz"
    )]
    TooCoarse {
        /// Samples per second.
        rate_hz: f64,
        /// Frequency of the fastest mode, Hz.
        fastest_hz: f64,
        /// Least sample rate, Hz.
        needed_hz: f64,
    },
    /// A motion that grows beyond bounds.
    #[error("the simulated motion grows beyond bounds at {at_s:.3} s")]
    Diverged {
        /// When.
        at_s: f64,
    },
    /// Steps that cannot be made short enough.
    #[error(
        "with {steps} steps a sample, results still change by {change:.1e} of their largest value"
    )]
    Unsettled {
        /// Steps a sample.
        steps: usize,
        /// Relative change of the result.
        change: f64,
    },
}

/// No displacement, velocity or acceleration of a vehicle is larger in any system of units.
const LARGEST: f64 = 1e12;

/// Computes the response of a vehicle from rest. `values` contains all parameters in the order of [`Vehicle::parameters`].
///
/// Equations: M q'' + sum over links of w F = sum over wheels of phi P, with F the sum of a link's terms (thesis 4.1, 5.1 to 5.5).
///
/// # Errors
/// [`ResponseError`] if an inertia is not positive, a term cannot be simulated, the sampling is too coarse, or the motion diverges.
///
/// # Example
/// A mass of 2 kg on a spring of 800 N/m without damper, under a constant force of 4 N, swings between 0 and twice the static displacement:
/// ```
/// use strainbridge::vehicle::preset::{PresetRequest, vehicle};
/// use strainbridge::vehicle::response::{Inputs, ResponseRules, compute_response};
///
/// let mass = vehicle(&PresetRequest { model: "oscillator".to_owned(), ..PresetRequest::default() })?;
/// let inputs = Inputs { rate_hz: 200.0, forces: vec![Some(vec![4.0; 400])], motions: vec![None], tyres: vec![None] };
/// let response = compute_response(&mass, &[2.0, 800.0, 0.0], &inputs, &ResponseRules::default())?;
/// for (i, x) in response.displacement[0][0].iter().enumerate() {
///     assert!((x - 0.005 * (1.0 - (20.0 * i as f64 / 200.0).cos())).abs() < 1e-12);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compute_response(
    vehicle: &Vehicle,
    values: &[f64],
    inputs: &Inputs,
    rules: &ResponseRules,
) -> Result<Response, ResponseError> {
    let n = check_length(inputs)?;
    let system = System::new(vehicle, values, inputs)?;
    if system.counts[0] == 0 {
        return Err(ResponseError::NothingFree);
    }
    let fastest_hz = system.fastest_hz();
    let needed_hz = rules.samples_per_period * fastest_hz;
    if inputs.rate_hz < needed_hz {
        return Err(ResponseError::TooCoarse {
            rate_hz: inputs.rate_hz,
            fastest_hz,
            needed_hz,
        });
    }
    let run = |steps: Option<usize>| -> Result<Response, ResponseError> {
        let states = match steps {
            None => exact_states(&system, inputs.rate_hz, n)?,
            Some(steps) => stepped_states(&system, inputs.rate_hz, n, steps)?,
        };
        Ok(response_of(vehicle, values, inputs, &system, &states))
    };
    let finish = |found: Response, steps: Option<usize>, step_error: f64| Response {
        fastest_hz,
        steps,
        step_error,
        ..found
    };
    if system.is_linear() {
        return Ok(finish(run(None)?, None, 0.0));
    }
    let mut steps = 1;
    let mut coarse = run(Some(steps))?;
    loop {
        steps *= 2;
        let fine = run(Some(steps))?;
        let change = largest_change(&coarse, &fine);
        if change <= rules.settled {
            return Ok(finish(fine, Some(steps), change));
        }
        if steps >= rules.most_steps {
            return Err(ResponseError::Unsettled { steps, change });
        }
        coarse = fine;
    }
}

/// Returns the load of each wheel on a tyre at rest, from the weight of the bodies and the stiffness of all springs, upwards on the wheel.
///
/// The result is `None` for a wheel without a tyre, for a vehicle with nonlinear springs, and if springs do not carry every body.
///
/// # Errors
/// [`ResponseError`] as [`compute_response`].
pub fn static_wheel_loads(
    vehicle: &Vehicle,
    values: &[f64],
    inputs: &Inputs,
    gravity: f64,
) -> Result<Vec<Option<f64>>, ResponseError> {
    let system = System::new(vehicle, values, inputs)?;
    if system.counts[0] == 0 {
        return Err(ResponseError::NothingFree);
    }
    let stretch = system
        .static_stretch(gravity)
        .filter(|_| system.is_linear());
    let of_tyre = |tyre: &Option<usize>| {
        let link = (*tyre)?;
        let term = vehicle.links[link]
            .terms
            .iter()
            .position(|t| *t == Term::Stiffness)?;
        let rate = values.get(vehicle.term_index(link, term))?;
        Some(-rate * stretch.as_ref()?.get(link)?)
    };
    Ok(inputs.tyres.iter().map(of_tyre).collect())
}

/// Number of samples of every input.
fn check_length(inputs: &Inputs) -> Result<usize, ResponseError> {
    let motions = inputs.motions.iter().flatten().flat_map(|m| match m {
        PrescribedMotion::Accelerations(x) | PrescribedMotion::Displacements(x) => x,
    });
    let mut lengths = inputs.forces.iter().flatten().chain(motions).map(Vec::len);
    let expected = lengths.next().unwrap_or(0);
    let different = lengths.find(|n| *n != expected);
    match different {
        Some(found) => Err(ResponseError::Length { found, expected }),
        None if expected < 2 => Err(ResponseError::Length {
            found: expected,
            expected: 2,
        }),
        None => Ok(expected),
    }
}

/// Largest difference of link forces and accelerations of two runs, relative to the largest value of its list.
fn largest_change(a: &Response, b: &Response) -> f64 {
    let lists = |r: &Response| -> Vec<Vec<f64>> {
        let motions = r.acceleration.iter().flatten();
        motions.chain(&r.spring).chain(&r.damper).cloned().collect()
    };
    let change = |(x, y): (&Vec<f64>, &Vec<f64>)| {
        let size = y.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let pairs = x.iter().zip(y).map(|(a, b)| (a - b).abs());
        let difference = pairs.filter(|d| d.is_finite()).fold(0.0, f64::max);
        if size > 0.0 { difference / size } else { 0.0 }
    };
    lists(a)
        .iter()
        .zip(&lists(b))
        .map(change)
        .fold(0.0, f64::max)
}

/// Curves of all inputs between samples `i` and `i + 1`.
fn curves(system: &System, rate_hz: f64, i: usize, out: &mut Vec<[f64; 4]>) {
    out.clear();
    let [forces, accelerations, displacements] = &system.samples;
    let all = forces.iter().chain(accelerations).chain(displacements);
    out.extend(all.map(|x| cubic::coefficients(x, i)));
    let of_displacements = out[forces.len() + accelerations.len()..].to_vec();
    out.extend(
        of_displacements
            .into_iter()
            .map(|p| cubic::derivative(p, rate_hz)),
    );
}

/// Inputs at sample `i` of `n`.
fn input_at(system: &System, rate_hz: f64, i: usize, out: &mut [f64]) {
    let [forces, accelerations, displacements] = &system.samples;
    let all = forces.iter().chain(accelerations).chain(displacements);
    let rates = displacements.iter().map(|x| rate_hz * cubic::slope(x, i));
    let values = all.map(|x| x[i]).chain(rates);
    out.iter_mut().zip(values).for_each(|(o, v)| *o = v);
}

/// States at all samples, exact for cubic inputs.
fn exact_states(system: &System, rate_hz: f64, n: usize) -> Result<Vec<Vec<f64>>, ResponseError> {
    let (m, k) = (system.n_states(), system.n_inputs());
    let h = 1.0 / rate_hz;
    // y' = A y + B u with u(s) = p0 + p1 s + p2 s^2 + p3 s^3. The derivatives of u are further states, so that one exponential contains all integrals.
    let mut a = Matrix::zeros(m + 4 * k, m + 4 * k);
    let (mut y, mut u) = (vec![0.0; m], vec![0.0; k]);
    let (mut moment, mut rates) = (Moment::default(), vec![0.0; m]);
    for j in 0..m + k {
        let unit = if j < m { &mut y[j] } else { &mut u[j - m] };
        *unit = 1.0;
        system.rates(&y, &u, &mut moment, &mut rates);
        rates
            .iter()
            .enumerate()
            .for_each(|(i, v)| a[(i, j)] = h * v);
        let unit = if j < m { &mut y[j] } else { &mut u[j - m] };
        *unit = 0.0;
    }
    for j in 0..3 * k {
        a[(m + j, m + k + j)] = 1.0;
    }
    let e = exponential(&a).ok_or(ResponseError::Diverged { at_s: 0.0 })?;
    let factorial = [1.0, 1.0, 2.0, 6.0];
    let mut states = Vec::with_capacity(n);
    let mut next = vec![0.0; m];
    let mut pieces = Vec::new();
    for i in 0..n {
        check_bounds(&y, i, rate_hz)?;
        states.push(y.clone());
        if i + 1 == n {
            break;
        }
        curves(system, rate_hz, i, &mut pieces);
        next.fill(0.0);
        for (j, v) in y.iter().enumerate() {
            next.iter_mut()
                .enumerate()
                .for_each(|(i, x)| *x += e[(i, j)] * v);
        }
        for (j, p) in pieces.iter().enumerate() {
            for order in 0..4 {
                let v = factorial[order] * p[order];
                let column = m + order * k + j;
                next.iter_mut()
                    .enumerate()
                    .for_each(|(i, x)| *x += e[(i, column)] * v);
            }
        }
        std::mem::swap(&mut y, &mut next);
    }
    Ok(states)
}

/// States at all samples by the Runge-Kutta method of order 4.
fn stepped_states(
    system: &System,
    rate_hz: f64,
    n: usize,
    steps: usize,
) -> Result<Vec<Vec<f64>>, ResponseError> {
    let (m, k) = (system.n_states(), system.n_inputs());
    let h = 1.0 / (rate_hz * steps as f64);
    let mut y = vec![0.0; m];
    let mut rates = [const { Vec::new() }; 4].map(|_: Vec<f64>| vec![0.0; m]);
    let (mut middle, mut u) = (vec![0.0; m], vec![0.0; k]);
    let mut moment = Moment::default();
    let mut pieces: Vec<[f64; 4]> = Vec::new();
    let mut states = Vec::with_capacity(n);
    for i in 0..n {
        check_bounds(&y, i, rate_hz)?;
        states.push(y.clone());
        if i + 1 == n {
            break;
        }
        curves(system, rate_hz, i, &mut pieces);
        for step in 0..steps {
            for (stage, (at, of)) in [(0.0, 0), (0.5, 0), (0.5, 1), (1.0, 2)]
                .into_iter()
                .enumerate()
            {
                let s = (step as f64 + at) / steps as f64;
                u.iter_mut()
                    .zip(&pieces)
                    .for_each(|(u, p)| *u = cubic::value_at(*p, s));
                middle.copy_from_slice(&y);
                if stage > 0 {
                    middle
                        .iter_mut()
                        .zip(&rates[of])
                        .for_each(|(x, r)| *x += at * h * r);
                }
                system.rates(&middle, &u, &mut moment, &mut rates[stage]);
            }
            for (j, x) in y.iter_mut().enumerate() {
                *x += h / 6.0 * (rates[0][j] + 2.0 * (rates[1][j] + rates[2][j]) + rates[3][j]);
            }
        }
    }
    Ok(states)
}

fn check_bounds(y: &[f64], i: usize, rate_hz: f64) -> Result<(), ResponseError> {
    let inside = y.iter().all(|v| v.abs() < LARGEST);
    inside.then_some(()).ok_or(ResponseError::Diverged {
        at_s: i as f64 / rate_hz,
    })
}

/// Motions, link forces and wheel forces of a run.
fn response_of(
    vehicle: &Vehicle,
    values: &[f64],
    inputs: &Inputs,
    system: &System,
    states: &[Vec<f64>],
) -> Response {
    let n = states.len();
    let empty = || -> Vec<Vec<Vec<f64>>> {
        let of_body = |shape: usize| vec![Vec::with_capacity(n); shape];
        vehicle
            .bodies
            .iter()
            .map(|b| of_body(b.shape.n()))
            .collect()
    };
    let of_links = || vec![Vec::with_capacity(n); vehicle.links.len()];
    let mut out = Response {
        displacement: empty(),
        velocity: empty(),
        acceleration: empty(),
        stretch: of_links(),
        rate: of_links(),
        spring: of_links(),
        damper: of_links(),
        wheels: vec![],
        fastest_hz: 0.0,
        steps: None,
        step_error: 0.0,
    };
    let mut u = vec![0.0; system.n_inputs()];
    let mut moment = Moment::default();
    for (i, y) in states.iter().enumerate() {
        input_at(system, inputs.rate_hz, i, &mut u);
        system.moment(y, &u, &mut moment);
        for (b, first) in system.first.iter().enumerate() {
            for j in 0..out.displacement[b].len() {
                out.displacement[b][j].push(moment.displacement[first + j]);
                out.velocity[b][j].push(moment.velocity[first + j]);
                out.acceleration[b][j].push(moment.acceleration[first + j]);
            }
        }
        for (l, [stretch, rate, spring, damper]) in moment.links.iter().enumerate() {
            out.stretch[l].push(*stretch);
            out.rate[l].push(*rate);
            out.spring[l].push(*spring);
            out.damper[l].push(*damper);
        }
    }
    out.wheels = (0..vehicle.wheels.len())
        .map(|w| wheel_force(vehicle, values, inputs, system, &out, w))
        .collect();
    out
}

/// Force of a wheel: an input, the force of its tyre, or the force that the known motion of its body needs.
fn wheel_force(
    vehicle: &Vehicle,
    values: &[f64],
    inputs: &Inputs,
    system: &System,
    found: &Response,
    wheel: usize,
) -> Option<Vec<f64>> {
    if let Some(Some(force)) = inputs.forces.get(wheel) {
        return Some(force.clone());
    }
    if let Some(Some(tyre)) = inputs.tyres.get(wheel) {
        let pairs = found.spring.get(*tyre)?.iter().zip(&found.damper[*tyre]);
        return Some(pairs.map(|(k, c)| -(k + c)).collect());
    }
    let body = vehicle.wheels[wheel].at.body;
    let coordinate = system.coordinates.get(system.first[body])?;
    if !matches!(coordinate, Coordinate::Accelerated(_)) {
        return None;
    }
    let own: Vec<usize> = (0..vehicle.wheels.len())
        .filter(|&w| vehicle.wheels[w].at.body == body)
        .collect();
    let columns: Vec<Vec<f64>> = own
        .iter()
        .map(|&w| vehicle.functions(&vehicle.wheels[w].at))
        .collect();
    let motions = &found.acceleration[body];
    let rows: Vec<Vec<f64>> = (0..motions.len())
        .map(|j| columns.iter().map(|c| c[j]).collect())
        .collect();
    let inverse = left_inverse(&rows)?;
    let place = own.iter().position(|&w| w == wheel)?;
    let mut force = vec![0.0; motions.first().map_or(0, Vec::len)];
    for (j, share) in inverse[place].iter().enumerate() {
        for (i, a) in motions.iter().enumerate() {
            let m = share * values.get(vehicle.inertia_index(body, i, j))?;
            force.iter_mut().zip(a).for_each(|(f, a)| *f += m * a);
        }
        for (l, link) in vehicle.links.iter().enumerate() {
            let ends = link.ends.iter().filter(|e| e.1.body == body);
            let weight: f64 = ends.map(|(w, p)| w * vehicle.functions(p)[j]).sum();
            let pull = found.spring[l].iter().zip(&found.damper[l]);
            let add = |(f, (k, c)): (&mut f64, (&f64, &f64))| *f += share * weight * (k + c);
            force.iter_mut().zip(pull).for_each(add);
        }
    }
    Some(force)
}
