//! Consistent unit systems a deck can be written in.

use super::unit::{POUND_FORCE_N, Quantity, Unit};

/// Metres in an inch (exact).
const INCH_M: f64 = 0.0254;

/// A consistent unit system; time is in seconds in all of them. In each one, force is mass times acceleration without a factor.
///
/// # Example
/// ```
/// use strainbridge::units::{Quantity, UnitSystem};
///
/// let system = UnitSystem::from_name("mm-t-s").unwrap();
/// // A tonne times a millimetre per square second is a newton, and a newton per square millimetre is a megapascal.
/// assert_eq!(system.si(Quantity::Force), 1.0);
/// assert_eq!(system.unit(Quantity::Stress).name, "MPa");
/// assert!((system.si(Quantity::Stress) / 1e6 - 1.0).abs() < 1e-12);
/// assert_eq!(system.standard_gravity(), 9806.65);
/// // PARAM,UNITSYS of a deck names the system too.
/// assert_eq!(UnitSystem::from_unitsys("N-mm"), Some(system));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitSystem {
    /// metre, kilogram, second: newton, pascal.
    MKgS,
    /// millimetre, tonne, second: newton, megapascal.
    MmTS,
    /// millimetre, kilogram, second: millinewton, kilopascal.
    MmKgS,
    /// inch, pound-force, second: mass in lbf s^2 / in.
    InLbfS,
}

impl UnitSystem {
    /// All unit systems, as a job may name them.
    pub const ALL: [UnitSystem; 4] = [Self::MKgS, Self::MmTS, Self::MmKgS, Self::InLbfS];

    /// Returns the name of the system in a job.
    pub fn name(self) -> &'static str {
        match self {
            Self::MKgS => "m-kg-s",
            Self::MmTS => "mm-t-s",
            Self::MmKgS => "mm-kg-s",
            Self::InLbfS => "in-lbf-s",
        }
    }

    /// Returns the system with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// Returns the system that PARAM,UNITSYS names; `None` if it is not a known system.
    ///
    /// # Reference
    /// Simcenter writes `MN-MM` for millinewton and millimetre.
    pub fn from_unitsys(text: &str) -> Option<Self> {
        match text.trim().to_ascii_uppercase().as_str() {
            "N-M" | "M-N" => Some(Self::MKgS),
            "N-MM" | "MM-N" => Some(Self::MmTS),
            "MN-MM" | "MM-MN" => Some(Self::MmKgS),
            "LBF-IN" | "IN-LBF" => Some(Self::InLbfS),
            _ => None,
        }
    }

    /// Returns the unit of length in metres.
    pub fn length_m(self) -> f64 {
        match self {
            Self::MKgS => 1.0,
            Self::MmTS | Self::MmKgS => 1e-3,
            Self::InLbfS => INCH_M,
        }
    }

    /// Returns the unit of mass in kilograms.
    pub fn mass_kg(self) -> f64 {
        match self {
            Self::MKgS | Self::MmKgS => 1.0,
            Self::MmTS => 1e3,
            Self::InLbfS => POUND_FORCE_N / INCH_M,
        }
    }

    /// Returns the SI value of the system's unit of a quantity (`kg m / s^2` and so on). A number times this value is in SI units.
    pub fn si(self, quantity: Quantity) -> f64 {
        let (l, m) = (self.length_m(), self.mass_kg());
        match quantity {
            Quantity::Force => m * l,
            Quantity::Moment => m * l * l,
            Quantity::Length => l,
            Quantity::Mass => m,
            Quantity::Stress => m / l,
            Quantity::Acceleration => l,
        }
    }

    /// Returns the unit of a quantity in this system, with its name in reports.
    pub fn unit(self, quantity: Quantity) -> Unit {
        let name = match (self, quantity) {
            (Self::MKgS, Quantity::Force) | (Self::MmTS, Quantity::Force) => "N",
            (Self::MmKgS, Quantity::Force) => "mN",
            (Self::InLbfS, Quantity::Force) => "lbf",
            (Self::MKgS, Quantity::Moment) => "N m",
            (Self::MmTS, Quantity::Moment) => "N mm",
            (Self::MmKgS, Quantity::Moment) => "mN mm",
            (Self::InLbfS, Quantity::Moment) => "lbf in",
            (Self::MKgS, Quantity::Length) => "m",
            (Self::MmTS | Self::MmKgS, Quantity::Length) => "mm",
            (Self::InLbfS, Quantity::Length) => "in",
            (Self::MKgS | Self::MmKgS, Quantity::Mass) => "kg",
            (Self::MmTS, Quantity::Mass) => "t",
            (Self::InLbfS, Quantity::Mass) => "lbf s2/in",
            (Self::MKgS, Quantity::Stress) => "Pa",
            (Self::MmTS, Quantity::Stress) => "MPa",
            (Self::MmKgS, Quantity::Stress) => "kPa",
            (Self::InLbfS, Quantity::Stress) => "psi",
            (Self::MKgS, Quantity::Acceleration) => "m/s2",
            (Self::MmTS | Self::MmKgS, Quantity::Acceleration) => "mm/s2",
            (Self::InLbfS, Quantity::Acceleration) => "in/s2",
        };
        Unit {
            name,
            quantity,
            si: self.si(quantity),
        }
    }

    /// Returns standard gravity (9.80665 m/s^2) in this system.
    pub fn standard_gravity(self) -> f64 {
        9.806_65 / self.length_m()
    }
}
