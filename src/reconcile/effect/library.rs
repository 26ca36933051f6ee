//! All effects that the frame's data allow, sensor faults first.

use super::StrainEffect;
use super::dead_channel::DeadChannel;
use super::gauge_angle::GaugeAngle;
use super::gauge_gain::GaugeGain;
use super::gauge_position::GaugePosition;
use super::gauge_swap::GaugeSwap;
use super::global_scale::GlobalScale;
use super::lateral_wheel_loads::LateralWheelLoads;
use super::payload_gravity_missing::PayloadGravityMissing;
use super::payload_offset::PayloadOffset;
use super::rosette_legs::RosetteLegs;
use super::saturated_channel::SaturatedChannel;
use super::sign_flip::SignFlip;
use super::stiffness::Stiffness;
use super::stranger::Stranger;
use super::thermal::Thermal;
use super::unaccounted_mass::UnaccountedMass;
use super::uneven_ground::UnevenGround;
use super::zero_drift::ZeroDrift;
use crate::reconcile::strain::StrainFrame;

/// An effect at a place, with what it costs to name it: the log of how many others could have been named.
pub struct Candidate {
    /// The effect.
    pub effect: Box<dyn StrainEffect>,
    /// Natural log of the prior weight, negative.
    pub log_prior: f64,
}

/// The candidates of `frame`; with `only` not empty, those whose id (or id with place) it lists.
pub fn library(frame: &StrainFrame, only: &[String]) -> Vec<Candidate> {
    let mut groups: Vec<Vec<Box<dyn StrainEffect>>> = Vec::new();
    fn boxed<E: StrainEffect + 'static>(effects: Vec<E>) -> Vec<Box<dyn StrainEffect>> {
        effects
            .into_iter()
            .map(|e| Box::new(e) as Box<dyn StrainEffect>)
            .collect()
    }
    groups.push(boxed(ZeroDrift::all(frame)));
    groups.push(boxed(SignFlip::all(frame)));
    groups.push(boxed(GaugeGain::all(frame)));
    groups.push(boxed(GaugeSwap::all(frame)));
    groups.push(boxed(RosetteLegs::all(frame)));
    groups.push(boxed(GaugeAngle::all(frame)));
    groups.push(boxed(GaugePosition::all(frame)));
    groups.push(boxed(DeadChannel::all(frame)));
    groups.push(boxed(SaturatedChannel::all(frame)));
    groups.push(boxed(PayloadGravityMissing::all(frame)));
    groups.push(boxed(PayloadOffset::all(frame)));
    groups.push(boxed(UnaccountedMass::all(frame)));
    groups.push(boxed(UnevenGround::all(frame)));
    let (uniform, gradient): (Vec<_>, Vec<_>) = Thermal::all(frame)
        .into_iter()
        .partition(|t| t.id() == "thermal_uniform");
    groups.push(boxed(uniform));
    groups.push(boxed(gradient));
    groups.push(boxed(LateralWheelLoads::all(frame)));
    groups.push(boxed(Stiffness::all(frame)));
    groups.push(boxed(vec![GlobalScale]));
    groups.push(boxed(Stranger::all()));
    groups.retain(|g| !g.is_empty());
    let n_groups = groups.len().max(1) as f64;
    let mut out = Vec::new();
    for group in groups {
        let log_prior = -(n_groups * group.len() as f64).ln();
        for effect in group {
            let wanted = only
                .iter()
                .any(|w| w == effect.id() || *w == super::full_id(effect.as_ref()));
            if only.is_empty() || wanted || effect.outside().is_some() {
                out.push(Candidate { effect, log_prior });
            }
        }
    }
    out
}
