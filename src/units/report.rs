//! The units that a report counts in.

use super::system::UnitSystem;
use super::unit::{Quantity, Unit};

/// The units of a report, and of the files a job names.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ReportUnits {
    pub force: Unit,
    pub moment: Unit,
    pub length: Unit,
    pub mass: Unit,
    pub stress: Unit,
}

impl ReportUnits {
    /// Returns the units of a system.
    pub fn from_system(system: UnitSystem) -> Self {
        Self {
            force: system.unit(Quantity::Force),
            moment: system.unit(Quantity::Moment),
            length: system.unit(Quantity::Length),
            mass: system.unit(Quantity::Mass),
            stress: system.unit(Quantity::Stress),
        }
    }

    /// Returns the unit of a quantity. Accelerations are reported in SI.
    pub fn unit(&self, quantity: Quantity) -> Unit {
        match quantity {
            Quantity::Force => self.force,
            Quantity::Moment => self.moment,
            Quantity::Length => self.length,
            Quantity::Mass => self.mass,
            Quantity::Stress => self.stress,
            Quantity::Acceleration => Unit {
                name: "m/s2",
                quantity,
                si: 1.0,
            },
        }
    }
}

/// Returns the factor from model units to a unit: `value_in_unit = value_in_system * factor`. Both measure the quantity of `to`.
///
/// # Example
/// ```
/// use strainbridge::units::{Quantity, UnitSystem, factor, find_unit};
///
/// let kilonewton = find_unit(Quantity::Force, "kN").unwrap();
/// assert!((5000.0 * factor(UnitSystem::MmTS, kilonewton) - 5.0).abs() < 1e-12); // N
/// // A pound is 0.45359237 kg exactly; a mass of the inch system is in lbf s^2 / in.
/// let pound = find_unit(Quantity::Mass, "lb").unwrap();
/// let gravity = UnitSystem::InLbfS.standard_gravity();
/// assert!((factor(UnitSystem::InLbfS, pound) / gravity - 1.0).abs() < 1e-12);
/// ```
pub fn factor(from: UnitSystem, to: Unit) -> f64 {
    from.si(to.quantity) / to.si
}
