//! Tables of an identification.

use super::restoring_forces::{asked_force, find_determined_links};
use crate::vehicle::chassis::{ChassisForce, LeafSeat, SpringForce, split_leaf};
use crate::vehicle::identify::Identification;
use crate::vehicle::loads::{LoadHistory, link_forces};
use crate::vehicle::motion::Motion;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Returns `parameters.csv`: name, value, sigma, low, high, unit, identifiable; blank for an undetermined number.
pub fn write_parameters(found: &Identification) -> String {
    let mut out = String::from("name,value,sigma,low,high,unit,identifiable\n");
    let number = |v: Option<f64>| v.map_or(String::new(), |v| format!("{v:.9e}"));
    for p in &found.parameters {
        let (low, high) = (p.interval.map(|i| i[0]), p.interval.map(|i| i[1]));
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{}",
            p.name,
            number(p.value),
            number(p.sigma),
            number(low),
            number(high),
            p.unit,
            p.identifiable
        );
    }
    out
}

/// Returns `loads.csv`: time, then each wheel force in the band (about its mean) with its 95 % interval, and the measured force.
pub fn write_wheel_forces(
    found: &Identification,
    history: &LoadHistory,
    measured: &Motion,
) -> String {
    let mut out = String::from("time");
    let used: Vec<usize> = (0..history.names.len())
        .filter(|&i| history.values[i].iter().any(|v| v.is_finite()))
        .collect();
    for &i in &used {
        let n = &history.names[i];
        let _ = write!(out, ",{n},{n}.low,{n}.high");
        if measured.forces[i].is_some() {
            let _ = write!(out, ",{n}.measured");
        }
    }
    out.push('\n');
    if used.is_empty() {
        return out;
    }
    for t in 0..measured.n_samples() {
        let _ = write!(out, "{:.6}", history.start_s + t as f64 / history.rate_hz);
        for &i in &used {
            let v = history.values[i][t];
            let half = found.coverage_factor * history.sigma[i];
            if half.is_finite() {
                let _ = write!(out, ",{v:.6e},{:.6e},{:.6e}", v - half, v + half);
            } else {
                let _ = write!(out, ",{v:.6e},,");
            }
            if let Some(m) = &measured.forces[i] {
                let _ = write!(out, ",{:.6e}", m[t]);
            }
        }
        out.push('\n');
    }
    out
}

/// Returns `restoring_force.csv`: mean link force and number of samples by bins of stretch and its rate. The force is from the model and, if a single
/// link carries the body, from the motion of the body.
pub fn write_restoring_force(found: &Identification, motion: &Motion) -> String {
    const BINS: usize = 15;
    let mut out = String::from("link,stretch,rate,force_model,force_measured,samples\n");
    let v = &found.vehicle;
    let forces = link_forces(v, &found.values, motion);
    for l in find_determined_links(found) {
        let link = &v.links[l];
        let (d, r) = (&motion.stretch[l], &motion.rate[l]);
        let largest = |x: &[f64]| x.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let (dm, rm) = (largest(d), largest(r));
        let asked = asked_force(found, motion, l);
        let measured = |t: usize| asked.as_ref().map_or(f64::NAN, |a| a[t]);
        let bin = |x: f64, m: f64| (((x / m + 1.0) / 2.0 * BINS as f64) as usize).min(BINS - 1);
        let mut cells = vec![(0.0, 0.0, 0usize); BINS * BINS];
        if dm <= 0.0 || rm <= 0.0 {
            continue;
        }
        for t in 0..d.len() {
            let cell = &mut cells[bin(d[t], dm) * BINS + bin(r[t], rm)];
            cell.0 += forces[l][t];
            cell.1 += measured(t);
            cell.2 += 1;
        }
        let centre = |i: usize, m: f64| ((i as f64 + 0.5) / BINS as f64 * 2.0 - 1.0) * m;
        for (i, (model, seen, n)) in cells.iter().enumerate().filter(|(_, c)| c.2 > 0) {
            let n_f = *n as f64;
            let seen = if seen.is_finite() {
                format!("{:.6e}", seen / n_f)
            } else {
                String::new()
            };
            let _ = writeln!(
                out,
                "{},{:.6e},{:.6e},{:.6e},{seen},{n}",
                link.name,
                centre(i / BINS, dm),
                centre(i % BINS, rm),
                model / n_f
            );
        }
    }
    out
}

/// Returns `chassis_forces.csv` with a column for time and columns for forces, limited to the band, about their means, positive upwards.
///
/// - Each sprung body has its force from mass and from springs.
/// - Each spring has its force on the chassis. A leaf spring also has its vertical forces at hanger and shackle, and its force along the frame.
/// - The ends of the 95 % interval follow, of the force on each body from mass, and of each spring.
pub fn write_chassis_forces(
    forces: &[ChassisForce],
    leaves: &BTreeMap<String, LeafSeat>,
    motion: &Motion,
) -> String {
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    let mut intervals: Vec<(String, Vec<f64>)> = Vec::new();
    let mut bound = |place: &str, force: &[f64], half: &[f64]| {
        for (end, sign) in [("low", -1.0), ("high", 1.0)] {
            let at = force.iter().zip(half).map(|(f, h)| f + sign * h).collect();
            intervals.push((format!("{place}.{end}"), at));
        }
    };
    for f in forces {
        columns.push((format!("{}.by_mass", f.body), f.by_mass.clone()));
        bound(&f.body, &f.by_mass, &f.by_mass_half);
        if !f.by_springs.is_empty() {
            columns.push((format!("{}.by_springs", f.body), f.by_springs.clone()));
        }
        for SpringForce { link, force, half } in &f.springs {
            columns.push((link.clone(), force.clone()));
            bound(link, force, half);
            if let Some(seat) = leaves.get(link) {
                for (k, part) in ["hanger", "shackle", "horizontal"].iter().enumerate() {
                    let at = force.iter().map(|v| split_leaf(*v, *seat)[k]).collect();
                    columns.push((format!("{link}.{part}"), at));
                }
            }
        }
    }
    columns.extend(intervals);
    let mut out = String::from("time");
    columns.iter().for_each(|c| {
        let _ = write!(out, ",{}", c.0);
    });
    out.push('\n');
    for t in 0..motion.n_samples() {
        let _ = write!(out, "{:.6}", motion.start_s + t as f64 / motion.rate_hz);
        for (_, values) in &columns {
            let _ = write!(out, ",{:.6e}", values[t]);
        }
        out.push('\n');
    }
    out
}
