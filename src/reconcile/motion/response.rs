//! Response of the residual of each equation to one unit in each channel.

use super::design::Design;
use crate::linalg::tall::left_inverse;
use crate::vehicle::term::Term;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Returns the responses `[equation][channel][bin]`, in the order of the design's equations and channels; nonlinear terms by their mean slope.
pub fn responses(design: &Design, values: &[f64]) -> Vec<Vec<Vec<Complex64>>> {
    let v = &design.vehicle;
    let value = |i: usize| {
        values
            .get(i)
            .copied()
            .filter(|x| x.is_finite())
            .unwrap_or(0.0)
    };
    // Share of each sensor in each motion of its body.
    let weights: Vec<Option<Vec<Vec<f64>>>> = (0..v.bodies.len())
        .map(|b| {
            let rows: Vec<Vec<f64>> = v
                .sensors
                .iter()
                .filter(|s| s.at.body == b)
                .map(|s| v.functions(&s.at))
                .collect();
            left_inverse(&rows)
        })
        .collect();
    let slopes = slopes(design, values);
    let changed = changed_masses(design, values);
    let share = |body: usize, motion: usize, sensor: usize| -> f64 {
        let Some(own) = (v.sensors[sensor].at.body == body).then(|| {
            (0..v.sensors.len())
                .filter(|&s| v.sensors[s].at.body == body)
                .position(|s| s == sensor)
        }) else {
            return 0.0;
        };
        match (own, &weights[body]) {
            (Some(k), Some(w)) => w[motion][k],
            _ => 0.0,
        }
    };
    design
        .equations
        .iter()
        .map(|e| {
            design
                .channels
                .iter()
                .map(|c| {
                    if let Some(w) = v.wheels.iter().find(|w| w.channel == c.name) {
                        let phi = if w.at.body == e.body {
                            v.functions(&w.at)[e.motion]
                        } else {
                            0.0
                        };
                        return vec![Complex64::new(-phi, 0.0); design.f_hz.len()];
                    }
                    let Some(s) = v.sensors.iter().position(|s| s.channel == c.name) else {
                        return vec![Complex64::default(); design.f_hz.len()];
                    };
                    let n = v.bodies[e.body].shape.n();
                    let mut inertia: f64 = (0..n)
                        .map(|i| value(v.inertia_index(e.body, i, e.motion)) * share(e.body, i, s))
                        .sum();
                    if e.motion == 0 {
                        inertia += changed[e.body] * share(e.body, 0, s);
                    }
                    let mut paths: Vec<(f64, [f64; 3])> = Vec::new();
                    for (link, slope) in v.links.iter().zip(&slopes) {
                        let here: f64 = link
                            .ends
                            .iter()
                            .filter(|x| x.1.body == e.body)
                            .map(|(w, p)| w * v.functions(p)[e.motion])
                            .sum();
                        let there: f64 = link
                            .ends
                            .iter()
                            .filter(|x| x.1.body == v.sensors[s].at.body)
                            .map(|(w, p)| {
                                w * v
                                    .functions(p)
                                    .iter()
                                    .enumerate()
                                    .map(|(i, phi)| phi * share(p.body, i, s))
                                    .sum::<f64>()
                            })
                            .sum();
                        if here != 0.0 && there != 0.0 {
                            paths.push((here * there, *slope));
                        }
                    }
                    design
                        .f_hz
                        .iter()
                        .map(|f| {
                            let w = 2.0 * PI * f;
                            let link: Complex64 = paths
                                .iter()
                                .map(|(g, [k, c, b])| Complex64::new(b - k / (w * w), -c / w) * *g)
                                .sum();
                            // Signals of displacement sensors were converted to accelerations before.
                            link + inertia
                        })
                        .collect()
                })
                .collect()
        })
        .collect()
}

/// Returns the mass that changes of mass add to each body, mean over the record.
fn changed_masses(design: &Design, values: &[f64]) -> Vec<f64> {
    let v = &design.vehicle;
    let mut out = vec![0.0; v.bodies.len()];
    for (s, step) in v.steps.iter().enumerate() {
        let value = values.get(v.step_index(s)).filter(|x| x.is_finite());
        if let (Some(value), Some(out)) = (value, out.get_mut(step.body)) {
            *out += value * design.mean_done(|t_s| step.share_at(t_s));
        }
    }
    out
}

/// Returns the mean slope of each link's law over stretch, rate and acceleration of stretch.
fn slopes(design: &Design, values: &[f64]) -> Vec<[f64; 3]> {
    let v = &design.vehicle;
    v.links
        .iter()
        .enumerate()
        .map(|(l, link)| {
            let (d, rate) = (&design.motion.stretch[l], &design.motion.rate[l]);
            let mut out = [0.0; 3];
            for (t, term) in link.terms.iter().enumerate() {
                let c = values
                    .get(v.term_index(l, t))
                    .copied()
                    .filter(|x| x.is_finite())
                    .unwrap_or(0.0);
                match term {
                    Term::Stiffness => out[0] += c,
                    Term::Damping => out[1] += c,
                    Term::Inertance => out[2] += c,
                    _ if c != 0.0 => {
                        // Statistical linearisation: regression of the term on stretch and rate.
                        let (mut fd, mut fv, mut dd, mut vv) = (0.0, 0.0, 0.0, 0.0);
                        for (i, (d, r)) in d.iter().zip(rate).enumerate() {
                            let t_s = design.motion.start_s + i as f64 / design.motion.rate_hz;
                            let f = term.basis_at(*d, *r, t_s);
                            fd += f * d;
                            fv += f * r;
                            dd += d * d;
                            vv += r * r;
                        }
                        if dd > 0.0 && vv > 0.0 {
                            out[0] += c * fd / dd;
                            out[1] += c * fv / vv;
                        }
                    }
                    _ => {}
                }
            }
            out
        })
        .collect()
}
