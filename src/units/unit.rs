//! Single units and what a report uses.

/// Newtons in a pound-force (exact: 0.45359237 kg times 9.80665 m/s^2).
pub(super) const POUND_FORCE_N: f64 = 4.448_221_615_260_5;

/// Quantity that a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Quantity {
    Force,
    Moment,
    Length,
    Mass,
    Stress,
    Acceleration,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 6] = [
        Self::Force,
        Self::Moment,
        Self::Length,
        Self::Mass,
        Self::Stress,
        Self::Acceleration,
    ];

    /// Returns the name of the quantity in a job.
    pub fn word(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Moment => "moment",
            Self::Length => "length",
            Self::Mass => "mass",
            Self::Stress => "stress",
            Self::Acceleration => "acceleration",
        }
    }
}

/// A unit: `value_si = value * si`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Name of the unit, as files write it.
    pub name: &'static str,
    /// Quantity of the unit.
    pub quantity: Quantity,
    /// Size of the unit in SI units.
    pub si: f64,
}

/// Every unit that a job may name.
pub const UNITS: [Unit; 33] = {
    use Quantity::*;
    const fn u(name: &'static str, quantity: Quantity, si: f64) -> Unit {
        Unit { name, quantity, si }
    }
    [
        u("N", Force, 1.0),
        u("kN", Force, 1e3),
        u("MN", Force, 1e6),
        u("mN", Force, 1e-3),
        u("lbf", Force, POUND_FORCE_N),
        u("kip", Force, 1e3 * POUND_FORCE_N),
        u("kgf", Force, 9.806_65),
        u("N m", Moment, 1.0),
        u("kN m", Moment, 1e3),
        u("N mm", Moment, 1e-3),
        u("kN mm", Moment, 1.0),
        u("mN mm", Moment, 1e-6),
        u("lbf in", Moment, POUND_FORCE_N * 0.0254),
        u("lbf ft", Moment, POUND_FORCE_N * 0.3048),
        u("m", Length, 1.0),
        u("cm", Length, 1e-2),
        u("mm", Length, 1e-3),
        u("in", Length, 0.0254),
        u("ft", Length, 0.3048),
        u("kg", Mass, 1.0),
        u("g", Mass, 1e-3),
        u("t", Mass, 1e3),
        u("lb", Mass, 0.453_592_37),
        u("lbf s2/in", Mass, POUND_FORCE_N / 0.0254),
        u("slug", Mass, POUND_FORCE_N / 0.3048),
        u("Pa", Stress, 1.0),
        u("kPa", Stress, 1e3),
        u("MPa", Stress, 1e6),
        u("GPa", Stress, 1e9),
        u("psi", Stress, POUND_FORCE_N / (0.0254 * 0.0254)),
        u("m/s2", Acceleration, 1.0),
        u("mm/s2", Acceleration, 1e-3),
        u("in/s2", Acceleration, 0.0254),
    ]
};

/// Returns the unit of a quantity by its name; `None` for an unknown name. Moments may be written `kN m`, `kN*m`, `kN.m`, `kNm`.
///
/// # Example
/// ```
/// use strainbridge::units::{Quantity, find_unit};
///
/// let names = ["kN m", "kN*m", "kNm"];
/// assert!(names.iter().all(|n| find_unit(Quantity::Moment, n).is_some_and(|u| u.si == 1e3)));
/// // A unit of another quantity is not found.
/// assert_eq!(find_unit(Quantity::Force, "kN m"), None);
/// // A foot is 0.3048 m exactly, and contains 12 inches.
/// let metres = |name| find_unit(Quantity::Length, name).map_or(f64::NAN, |u| u.si);
/// assert!((metres("ft") - 12.0 * metres("in")).abs() < 1e-15);
/// ```
pub fn find_unit(quantity: Quantity, name: &str) -> Option<Unit> {
    let plain = |s: &str| {
        s.chars()
            .filter(|c| !matches!(c, ' ' | '*' | '.' | '-' | '^'))
            .map(|c| if c == '²' { '2' } else { c })
            .collect::<String>()
    };
    let wanted = plain(name);
    UNITS
        .into_iter()
        .find(|u| u.quantity == quantity && plain(u.name) == wanted)
}

/// Returns the names of the units of a quantity, for messages.
pub fn unit_names(quantity: Quantity) -> Vec<&'static str> {
    UNITS
        .iter()
        .filter(|u| u.quantity == quantity)
        .map(|u| u.name)
        .collect()
}
