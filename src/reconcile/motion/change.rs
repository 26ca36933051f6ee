//! Changes by an effect: terms of a link, coupling links, a mass, a channel.

use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::layout::{Link, MassStep, Vehicle};
use crate::vehicle::term::Term;

/// A change of the model or of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Terms on a link of the analyst's vehicle.
    Terms {
        /// The link.
        link: usize,
        /// The terms.
        terms: Vec<Term>,
    },
    /// New links.
    Links(Vec<Link>),
    /// A mass that changes.
    Step(MassStep),
    /// A channel reads a multiple of the truth.
    Gain {
        /// The channel.
        channel: String,
    },
    /// A channel reads late (or, negative, early).
    Delay {
        /// The channel.
        channel: String,
    },
    /// The clock of a channel runs off: it reads later with every second.
    Clock {
        /// The channel.
        channel: String,
    },
    /// A channel lost samples, or wrote some twice, at a moment of the fitted record.
    Slip {
        /// The channel.
        channel: String,
        /// When, s of the record's time.
        at_s: f64,
    },
    /// A channel passed through a low-pass filter, and the other channels did not.
    Lag {
        /// The channel.
        channel: String,
        /// Order of the filter: see [`crate::vehicle::adjustment::Lag`].
        order: u8,
    },
    /// A mains line on a channel.
    Line {
        /// The channel.
        channel: String,
        /// Frequency of the line, Hz.
        hz: f64,
    },
    /// A channel reads with reversed sign.
    Flip {
        /// The channel.
        channel: String,
    },
    /// Two accelerometers are exchanged.
    Swap {
        /// One channel.
        a: String,
        /// The other channel.
        b: String,
    },
}

/// A vehicle with changes in it, and where each change's parameters are.
#[derive(Clone, Debug)]
pub struct ChangedVehicle {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// For each change, indices of its parameters in `vehicle.parameters()`.
    pub own: Vec<Vec<usize>>,
    /// Indices of the analyst's parameters, in the analyst's order.
    pub base: Vec<usize>,
}

/// Returns the vehicle with all its changes. A change of a channel has no effect here, except for an exchange of channels.
pub fn assemble(base: &Vehicle, changes: &[&Change]) -> ChangedVehicle {
    let mut vehicle = base.clone();
    let mut places: Vec<Vec<Place>> = Vec::new();
    for change in changes {
        let mut own = Vec::new();
        match change {
            Change::Terms { link, terms } => {
                if let Some(l) = vehicle.links.get_mut(*link) {
                    for t in terms {
                        own.push(Place::Term(*link, l.terms.len()));
                        l.terms.push(*t);
                    }
                }
            }
            Change::Links(links) => {
                for l in links {
                    own.extend((0..l.terms.len()).map(|t| Place::Term(vehicle.links.len(), t)));
                    vehicle.links.push(l.clone());
                }
            }
            Change::Step(step) => {
                own.push(Place::Step(vehicle.steps.len()));
                vehicle.steps.push(*step);
            }
            Change::Swap { a, b } => {
                for s in &mut vehicle.sensors {
                    if s.channel == *a {
                        s.channel.clone_from(b);
                    } else if s.channel == *b {
                        s.channel.clone_from(a);
                    }
                }
            }
            Change::Gain { .. }
            | Change::Delay { .. }
            | Change::Clock { .. }
            | Change::Slip { .. }
            | Change::Lag { .. }
            | Change::Line { .. }
            | Change::Flip { .. } => {}
        }
        places.push(own);
    }
    let index = |p: &Place| match p {
        Place::Term(l, t) => vehicle.term_index(*l, *t),
        Place::Step(s) => vehicle.step_index(*s),
    };
    let n_inertias = vehicle.term_index(0, 0);
    let mut kept: Vec<usize> = (0..n_inertias).collect();
    for (l, link) in base.links.iter().enumerate() {
        kept.extend((0..link.terms.len()).map(|t| vehicle.term_index(l, t)));
    }
    kept.extend((0..base.steps.len()).map(|s| vehicle.step_index(s)));
    ChangedVehicle {
        own: places
            .iter()
            .map(|o| o.iter().map(index).collect())
            .collect(),
        base: kept,
        vehicle,
    }
}

enum Place {
    Term(usize, usize),
    Step(usize),
}

/// Returns the corrections of a frame, joined with the correction of one channel.
pub fn with_adjustment(list: &[Adjustment], more: Adjustment) -> Vec<Adjustment> {
    let mut out = list.to_vec();
    match out.iter_mut().find(|a| a.channel == more.channel) {
        Some(a) => a.join(&more),
        None => out.push(more),
    }
    out
}

impl Change {
    /// Returns shapes of the same kind with a slightly smaller and larger constant; empty if the shape has no constant to find.
    ///
    /// `gravity` is the acceleration of gravity with which a change of mass enters the balance.
    pub fn neighbours(&self, step: f64, gravity: f64) -> Vec<Self> {
        /// Either side of the present constant.
        const SIDES: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];
        /// Number of closely spaced times that are tested on either side.
        const DENSE: i32 = 18;
        /// Constants of terms need no finer step.
        const FINEST: f64 = 0.005;
        /// Seconds for each unit step in the time of a change of mass.
        const SPAN_S: f64 = 12.0;
        let vary = |make: &dyn Fn(f64) -> Option<Self>| {
            SIDES.iter().filter_map(|s| make(s * step)).collect()
        };
        match self {
            Self::Terms { link, terms } if step > FINEST => vary(&|s| {
                let mut terms = terms.clone();
                let mut varied = false;
                for t in &mut terms {
                    match t {
                        Term::Friction { velocity } => {
                            *velocity *= (2.0 * s).exp();
                            varied = true;
                        }
                        Term::BumpStop { gap, .. } => {
                            *gap *= (0.5 * s).exp();
                            varied = true;
                        }
                        Term::DeadZone { gap } => {
                            *gap *= (2.0 * s).exp();
                            varied = true;
                        }
                        Term::StiffnessChange { at_s, over_s } => {
                            *at_s += SPAN_S * s;
                            *over_s = 0.0;
                            varied = true;
                        }
                        _ => {}
                    }
                }
                varied.then_some(Self::Terms { link: *link, terms })
            }),
            // The band filter turns a step into a wave, so the residual has many local minima over the time of the step. The first trial times are
            // therefore dense.
            Self::Step(m) if step > 0.05 => (-DENSE..=DENSE)
                .flat_map(|i| {
                    let least = if step > 0.1 { 0.15 } else { 0.02 };
                    let apart = f64::max(least, 0.5 * m.over_s / f64::from(DENSE));
                    [0.0, gravity].map(|gravity| {
                        Self::Step(MassStep {
                            at_s: m.at_s + 0.5 * m.over_s + f64::from(i) * apart,
                            over_s: 0.0,
                            gravity,
                            ..*m
                        })
                    })
                })
                .collect(),
            Self::Step(m) => {
                let mut out = vary(&|s| {
                    Some(Self::Step(MassStep {
                        at_s: m.at_s + SPAN_S * s,
                        ..*m
                    }))
                });
                if m.over_s > 0.0 && step > FINEST {
                    out.extend(vary(&|s| {
                        Some(Self::Step(MassStep {
                            over_s: m.over_s * (2.0 * s).exp(),
                            ..*m
                        }))
                    }));
                }
                out
            }
            // Filters of both orders act like a delay at low frequency. Only a fit distinguishes them.
            Self::Lag { channel, order } if step > 0.1 => vec![Self::Lag {
                channel: channel.clone(),
                order: 3 - order,
            }],
            Self::Slip { channel, at_s } => vary(&|s| {
                Some(Self::Slip {
                    channel: channel.clone(),
                    at_s: at_s + SPAN_S * s,
                })
            }),
            _ => vec![],
        }
    }

    /// Returns the faulty channel; `None` if the change is not a fault of one channel.
    pub fn channel(&self) -> Option<&str> {
        match self {
            Self::Gain { channel }
            | Self::Delay { channel }
            | Self::Clock { channel }
            | Self::Slip { channel, .. }
            | Self::Lag { channel, .. }
            | Self::Line { channel, .. }
            | Self::Flip { channel } => Some(channel),
            Self::Terms { .. } | Self::Links(_) | Self::Step(_) | Self::Swap { .. } => None,
        }
    }

    /// Returns the factor from a fault's parameter to its stated size: 1e6 for the rate of a clock, stated in millionths, and otherwise 1.
    pub fn stated_size_factor(&self) -> f64 {
        match self {
            Self::Clock { .. } => 1e6,
            _ => 1.0,
        }
    }
}
