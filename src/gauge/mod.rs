//! Reading of a gauge in a strain field.
//!
//! [`GaugeSpec`] states installed position and wiring. [`build`] places it on the model's surface and returns [`Gauge`]s: lists of arms.
//! Each arm is a linear functional of the strain at one place, so that `reading = sum coefficient . strain`.

mod arms;
mod bar_run;
mod beam;
mod build;
mod element_distance;
mod error;
mod grid;
mod grid_average;
mod installed_position;
mod off_skin;
mod on_refined;
mod side;
mod spec;
mod stated_side;
mod strain_gradient;
mod surface;
mod unverified_elements;

pub use arms::{Arm, Gauge, Spot, gauge_reading, shell_strain, strain_terms};
pub use build::build;
pub use element_distance::{ElementDistance, distance_to_beam, distance_to_shell};
pub use error::GaugeError;
pub use grid_average::SMOOTH;
pub use installed_position::{NominalGauge, Offset};
pub use off_skin::off_skin;
pub use on_refined::{change_by_refining, on_refined};
pub use side::{away_from, opposite_side};
pub use spec::{Bridge, CornerRows, GaugePlace, GaugeSpec, Pair, Rosette};
pub use stated_side::{BetweenSkins, between_skins};
pub use strain_gradient::strain_gradient_gauge;
pub use surface::{Foot, centre, nearest_skin, to_side};
pub use unverified_elements::on_unverified_elements;

#[cfg(test)]
mod tests;
