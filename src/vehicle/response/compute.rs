//! The response of a vehicle.

use super::integrate::{exact_states, input_at, stepped_states};
use super::system::{Coordinate, Moment, System};
use super::types::{Inputs, PrescribedMotion, Response, ResponseError, ResponseRules};
use crate::linalg::tall::left_inverse;
use crate::vehicle::layout::Vehicle;
use crate::vehicle::term::Term;

/// Computes the response of a vehicle from rest. `values` contains all parameters in the order of [`Vehicle::parameters`].
///
/// Equations (thesis 4.1, 5.1 to 5.5): `M q'' + sum over links of w F = sum over wheels of phi P`, with F the sum of a link's terms.
///
/// # Errors
/// [`ResponseError`] if an inertia is not positive, a term cannot be simulated, the sampling is too coarse, or the motion diverges.
///
/// # Example
/// A mass of 2 kg is on a spring of 800 N/m without damper. Under a constant force of 4 N it swings between 0 and twice the static displacement:
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

/// Returns the load of each wheel on a tyre at rest, upwards on the wheel. It follows from the weight of the bodies and the stiffness of all springs.
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
