//! Readings and influence with named effects in them: what the extended model holds.

use super::frame::StrainFrame;
use crate::reconcile::effect::Extension;

/// What undoes a channel's fault in its readings.
#[derive(Clone, Debug, PartialEq)]
pub enum Correction {
    /// Reading = (reading - offset of the run) * factor.
    Affine {
        /// Gauge.
        gauge: usize,
        /// Subtracted first, microstrain, by run.
        offset: Vec<f64>,
        /// Then multiplied.
        factor: f64,
    },
    /// Channel `to[i]` gets what channel `from[i]` read.
    Permute {
        /// Gauges that felt the strain.
        to: Vec<usize>,
        /// Channels that read it.
        from: Vec<usize>,
    },
    /// The channel says nothing: its readings are left blank.
    Blank(usize),
}

impl Correction {
    /// The corrections that `extensions` ask for; those of structure and loads ask for none.
    pub fn of(frame: &StrainFrame, extensions: &[&Extension]) -> Vec<Self> {
        let at = |name: &str| frame.gauges.iter().position(|g| g.name == name);
        let mut out = Vec::new();
        for e in extensions {
            match e {
                Extension::Channel {
                    id,
                    gauge,
                    size,
                    unit,
                } => {
                    let gauges: Vec<usize> = gauge.split('+').filter_map(at).collect();
                    let Some(&first) = gauges.first() else {
                        continue;
                    };
                    let none = vec![0.0; frame.n_runs()];
                    let affine = |offset, factor| Self::Affine {
                        gauge: first,
                        offset,
                        factor,
                    };
                    match *id {
                        "sign_flip" => out.push(affine(none, -1.0)),
                        "gauge_gain" if *size != 0.0 => out.push(affine(none, 1.0 / size)),
                        "zero_drift" => {
                            let n = frame.n_runs();
                            let creeps = unit.ends_with("last run");
                            let share = |r: usize| {
                                if creeps {
                                    (r + 1) as f64 / n.max(1) as f64
                                } else {
                                    1.0
                                }
                            };
                            out.push(affine((0..n).map(|r| size * share(r)).collect(), 1.0));
                        }
                        "gauge_swap" if gauges.len() == 2 => out.push(Self::Permute {
                            to: gauges.clone(),
                            from: gauges.iter().rev().copied().collect(),
                        }),
                        "rosette_legs" => {
                            // The extension lists, channel by channel in file order, the leg that was read.
                            let mut channels = gauges.clone();
                            channels.sort_unstable();
                            out.push(Self::Permute {
                                to: gauges,
                                from: channels,
                            });
                        }
                        "dead_channel" | "saturated_channel" => out.push(Self::Blank(first)),
                        _ => {}
                    }
                }
                Extension::Mass { place, kilogram } => {
                    // Its strain is the same in all runs: part of the zero.
                    let Some(mass) = frame.masses.iter().find(|m| m.place == *place) else {
                        continue;
                    };
                    for (gauge, per_kg) in mass.per_kg.iter().enumerate() {
                        out.push(Self::Affine {
                            gauge,
                            offset: vec![kilogram * per_kg; frame.n_runs()],
                            factor: 1.0,
                        });
                    }
                }
                _ => {}
            }
        }
        out
    }
}

/// Readings with the corrections applied, `n_runs x n_gauges`.
pub fn corrected_readings(frame: &StrainFrame, corrections: &[Correction]) -> Vec<f64> {
    let n_g = frame.n_gauges();
    let mut out = frame.observations.values.clone();
    for (run, row) in out.chunks_exact_mut(n_g.max(1)).enumerate() {
        for c in corrections {
            match c {
                Correction::Affine {
                    gauge,
                    offset,
                    factor,
                } => {
                    if let Some(cell) = row.get_mut(*gauge) {
                        *cell = (*cell - offset.get(run).copied().unwrap_or(0.0)) * factor;
                    }
                }
                Correction::Permute { to, from } => {
                    let read: Vec<f64> = from
                        .iter()
                        .map(|&g| row.get(g).copied().unwrap_or(f64::NAN))
                        .collect();
                    for (&g, v) in to.iter().zip(read) {
                        if let Some(cell) = row.get_mut(g) {
                            *cell = v;
                        }
                    }
                }
                Correction::Blank(gauge) => {
                    if let Some(cell) = row.get_mut(*gauge) {
                        *cell = f64::NAN;
                    }
                }
            }
        }
    }
    out
}

/// Influence with the structural effects in it, `None` where `extensions` hold none.
pub fn extended_influence(frame: &StrainFrame, extensions: &[&Extension]) -> Option<Vec<f64>> {
    use crate::reconcile::effect::{Member, full_id, library};
    let mut wanted: Vec<(String, Vec<f64>)> = Vec::new();
    for e in extensions {
        match e {
            Extension::Scale(factor) => {
                wanted.push(("global_scale".into(), vec![100.0 * (factor - 1.0)]));
            }
            Extension::Stiffness { id, place, percent } => {
                wanted.push((format!("{id}:{place}"), vec![*percent]));
            }
            Extension::Channel {
                id, gauge, size, ..
            } if *id == "gauge_angle" || *id == "gauge_position" => {
                wanted.push((format!("{id}:{gauge}"), vec![*size]));
            }
            _ => {}
        }
    }
    if wanted.is_empty() {
        return None;
    }
    let ids: Vec<String> = wanted.iter().map(|w| w.0.clone()).collect();
    let candidates = library(frame, &ids);
    let mut members = Vec::new();
    for (id, parameters) in &wanted {
        let found = candidates
            .iter()
            .find(|c| full_id(c.effect.as_ref()) == *id)?;
        members.push(Member {
            effect: found.effect.as_ref(),
            parameters,
        });
    }
    Some(super::state::StrainState::with(frame, &members).influence)
}
