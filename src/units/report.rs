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
    /// The system's own units.
    pub fn of(system: UnitSystem) -> Self {
        Self {
            force: system.unit(Quantity::Force),
            moment: system.unit(Quantity::Moment),
            length: system.unit(Quantity::Length),
            mass: system.unit(Quantity::Mass),
            stress: system.unit(Quantity::Stress),
        }
    }

    /// The unit of a quantity; accelerations are reported in SI.
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

/// Factor from model units to a unit: `value_in_unit = value_in_system * factor`.
pub fn factor(from: UnitSystem, to: Unit) -> f64 {
    from.si(to.quantity) / to.si
}
