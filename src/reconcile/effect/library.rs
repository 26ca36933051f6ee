//! All effects that the frame's data allow, sensor faults first. This list is the only place that names them all.

use super::StrainEffect;
use super::card_gain::CardGain;
use super::cross_sensitivity::CrossSensitivity;
use super::dead_channel::DeadChannel;
use super::gain_drift::GainDrift;
use super::gauge_angle::GaugeAngle;
use super::gauge_gain::GaugeGain;
use super::gauge_position::GaugePosition;
use super::gauge_swap::GaugeSwap;
use super::global_scale::GlobalScale;
use super::intermittent_channel::IntermittentChannel;
use super::lateral_wheel_loads::LateralWheelLoads;
use super::model_discrepancy::ModelDiscrepancy;
use super::payload_gravity_missing::PayloadGravityMissing;
use super::payload_offset::PayloadOffset;
use super::rosette_legs::RosetteLegs;
use super::run_exchange::RunExchange;
use super::run_record::RunRecord;
use super::saturated_channel::SaturatedChannel;
use super::sign_flip::SignFlip;
use super::smooth_error::SmoothError;
use super::stiffness::Stiffness;
use super::thermal::ThermalStrain;
use super::unaccounted_mass::UnaccountedMass;
use super::uneven_ground::UnevenGround;
use super::wheel_scale::WheelScale;
use super::zero_drift::ZeroDrift;
use crate::reconcile::strain::StrainFrame;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Effect at a place, with its log prior weight, which decreases with the number of possible effects and places.
pub struct Candidate {
    /// The effect.
    pub effect: Box<dyn StrainEffect>,
    /// Natural log of the prior weight, negative.
    pub log_prior: f64,
}

/// An effect at every place where it could be.
type Everywhere = fn(&StrainFrame) -> Vec<Box<dyn StrainEffect>>;

fn box_effects<E: StrainEffect + 'static>(effects: Vec<E>) -> Vec<Box<dyn StrainEffect>> {
    effects
        .into_iter()
        .map(|e| Box::new(e) as Box<dyn StrainEffect>)
        .collect()
}

const LIBRARY: [Everywhere; 27] = [
    |f| box_effects(ZeroDrift::list_effects(f)),
    |f| box_effects(SignFlip::list_effects(f)),
    |f| box_effects(GaugeGain::list_effects(f)),
    |f| box_effects(GaugeSwap::list_effects(f)),
    |f| box_effects(RosetteLegs::list_effects(f)),
    |f| box_effects(GaugeAngle::list_effects(f)),
    |f| box_effects(GaugePosition::list_effects(f)),
    |f| box_effects(DeadChannel::list_effects(f)),
    |f| box_effects(SaturatedChannel::list_effects(f)),
    |f| box_effects(IntermittentChannel::list_effects(f)),
    |f| box_effects(CardGain::list_effects(f)),
    |f| box_effects(GainDrift::list_effects(f)),
    |f| box_effects(CrossSensitivity::list_effects(f)),
    |f| box_effects(WheelScale::list_effects(f)),
    |f| box_effects(RunExchange::list_effects(f)),
    |f| box_effects(RunRecord::list_effects(f)),
    |f| box_effects(PayloadGravityMissing::list_effects(f)),
    |f| box_effects(PayloadOffset::list_effects(f)),
    |f| box_effects(UnaccountedMass::list_effects(f)),
    |f| box_effects(UnevenGround::list_effects(f)),
    |f| box_effects(ThermalStrain::list_uniform_effects(f)),
    |f| box_effects(ThermalStrain::gradient(f)),
    |f| box_effects(LateralWheelLoads::list_effects(f)),
    |f| box_effects(Stiffness::list_effects(f)),
    |f| box_effects(Stiffness::list_described_effects(f)),
    |_| box_effects(vec![GlobalScale]),
    |_| box_effects(ModelDiscrepancy::list_effects()),
];

/// Returns the candidates of `frame`. If `only` is not empty, these are the effects whose id (or id with place) it lists. The general forms of
/// discrepancy, which are not named effects, are always included.
///
/// All possible effects have equal prior weights, and the places of an effect share its weight. The weights sum to one without the smooth error,
/// which has a further weight.
pub fn library(frame: &StrainFrame, only: &[String]) -> Vec<Candidate> {
    let wanted = |e: &dyn StrainEffect| {
        let full = super::full_id(e);
        only.is_empty()
            || e.discrepancy().is_some()
            || only.iter().any(|w| w == e.id() || *w == full)
    };
    let everywhere = LIBRARY.iter().map(|all| all(frame));
    let mut groups: Vec<Vec<Box<dyn StrainEffect>>> = everywhere
        .map(|group| group.into_iter().filter(|e| wanted(e.as_ref())).collect())
        .collect();
    groups.retain(|g: &Vec<_>| !g.is_empty());
    let n_groups = groups.len().max(1) as f64;
    let mut out = Vec::new();
    for group in groups {
        let log_prior = -(n_groups * group.len() as f64).ln();
        out.extend(
            group
                .into_iter()
                .map(|effect| Candidate { effect, log_prior }),
        );
    }
    let n = out.len();
    // The smooth error is one more hypothesis, and its lengths and amplitudes share its weight. It does not reduce the weights of the named effects.
    let smooth = box_effects(SmoothError::list_effects(frame));
    let log_prior = -((n_groups + 1.0) * smooth.len().max(1) as f64).ln();
    let smooth = smooth.into_iter();
    out.extend(smooth.map(|effect| Candidate { effect, log_prior }));
    if let Some(learnt) = &frame.learnt {
        for c in &mut out {
            // A fault of one or two gauges differs from the pattern of any load. A pattern over many gauges may resemble a load.
            let dof = match c.effect.gauges().len() {
                1 | 2 => learnt.dof_outside,
                _ => learnt.dof,
            };
            c.log_prior -= cost_of_estimate(dof, n);
        }
    }
    out
}

/// Returns the extra cost of naming one of `n` effects under a covariance estimated with `dof` degrees of freedom, natural log of odds. A deviation
/// in any one direction then follows Student's t. The deviation that one search of a hundred reaches by chance is therefore larger than under a known
/// covariance. The cost is half the difference of both squared deviations.
fn cost_of_estimate(dof: f64, n: usize) -> f64 {
    /// Chance of a false name in one search.
    const FALSE: f64 = 0.01;
    if !dof.is_finite() {
        return 0.0;
    }
    let beyond = 1.0 - 0.5 * FALSE / n.max(1) as f64;
    let known = Normal::standard().inverse_cdf(beyond);
    let estimated = StudentsT::new(0.0, 1.0, dof.max(1.0)).map_or(known, |t| t.inverse_cdf(beyond));
    0.5 * (estimated * estimated - known * known)
}
