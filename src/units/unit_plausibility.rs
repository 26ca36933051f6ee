//! Tests whether declared units agree with the deck.

use super::{Quantity, UnitSystem};
use crate::finding::{Finding, Severity};

/// Limits of a plausible Young's modulus, GPa: from soft plastics to the stiffest ceramics.
pub const MODULUS_LIMITS_GPA: [f64; 2] = [1.0, 1000.0];
/// Limits of a plausible density, kg/m^3: from foam cores to tungsten.
pub const DENSITY_LIMITS: [f64; 2] = [20.0, 25_000.0];

/// Returns the largest plausible size, in SI units, of a quantity of a structure's loads. The weight of the heaviest ships and buildings is a few
/// times 1e9 N, on arms of up to ten kilometres. Lengths include coordinates with a distant origin, as in a survey, where northings reach 1e7 m. A
/// larger number is in another unit or wrong. Numbers of load sets are multiples of the set.
pub fn largest_size(quantity: Option<Quantity>) -> f64 {
    match quantity {
        Some(Quantity::Force) | None => 1e11,
        Some(Quantity::Moment) => 1e15,
        Some(Quantity::Mass) => 1e10,
        Some(Quantity::Length) => 1e8,
        Some(Quantity::Stress) => 1e12,
        Some(Quantity::Acceleration) => 1e7,
    }
}

/// Returns findings on PARAM,UNITSYS, Young's moduli or densities that contradict the declared system. Moduli and densities are given by id and
/// value, densities times WTMASS.
///
/// Valid decks may contain dummy materials. Some implausible values are therefore a warning, and only if all are implausible, an error. For densities
/// this is a warning too, since a common factor of all masses does not change the strain of a balanced structure. It is an error if modulus and
/// density are both plausible for a metal in another system.
pub fn check_units(
    system: UnitSystem,
    unitsys: Option<&str>,
    moduli: &[(u32, f64)],
    densities: &[(u32, f64)],
) -> Vec<Finding> {
    let mut out = Vec::new();
    if let Some(text) = unitsys
        && UnitSystem::from_unitsys(text) != Some(system)
    {
        let severity = if UnitSystem::from_unitsys(text).is_some() {
            Severity::Error
        } else {
            Severity::Warning
        };
        out.push(Finding::new(
            severity,
            "units-contradict-unitsys",
            "PARAM,UNITSYS",
            format!(
                "the job states `{}`, and the deck states PARAM,UNITSYS,{}",
                system.name(),
                text.trim()
            ),
            "state the deck's units in `units` of the job, or correct the parameter",
        ));
    }
    let gpa = system.si(Quantity::Stress) / 1e9;
    out.extend(find_implausible_value(
        "Young's modulus",
        "GPa",
        "units-modulus",
        moduli,
        gpa,
        MODULUS_LIMITS_GPA,
        Severity::Error,
        system,
    ));
    // If the deck states its system, the densities are wrong, not the units.
    let is_stated = unitsys.and_then(UnitSystem::from_unitsys) == Some(system);
    let meant = metal_elsewhere(system, moduli, densities).filter(|_| !is_stated);
    let density = find_implausible_value(
        "density",
        "kg/m3",
        "units-density",
        densities,
        density_si(system),
        DENSITY_LIMITS,
        match meant {
            Some(_) => Severity::Error,
            None => Severity::Warning,
        },
        system,
    );
    out.extend(density.map(|f| match meant {
        Some(other) if f.severity == Severity::Error => named_elsewhere(f, other),
        _ => f,
    }));
    out
}

/// Returns the density unit of a system in kg/m^3.
fn density_si(system: UnitSystem) -> f64 {
    system.mass_kg() / system.length_m().powi(3)
}

/// Returns the distance of a modulus and a density (SI units) from a metal with 100 GPa and 5,000 kg/m^3. The distance is the sum of the absolute
/// logarithms of both ratios.
fn from_metal(e: f64, rho: Option<f64>) -> f64 {
    let from = |x: f64, usual: f64| (x / usual).ln().abs();
    from(e, 100e9) + rho.map_or(0.0, |r| from(r, 5000.0))
}

/// Returns the median of the positive values.
fn median_positive(values: &[(u32, f64)]) -> Option<f64> {
    let mut v: Vec<f64> = values.iter().map(|v| v.1).filter(|x| *x > 0.0).collect();
    v.sort_by(f64::total_cmp);
    v.get(v.len() / 2).copied()
}

/// Returns another system in which the median modulus and density are plausible for a metal. `None` if they are plausible for a metal in `system`, or
/// in no system.
fn metal_elsewhere(
    system: UnitSystem,
    moduli: &[(u32, f64)],
    densities: &[(u32, f64)],
) -> Option<UnitSystem> {
    /// Largest distance of a metal (`from_metal`). It is 1.8 for magnesium (45 GPa, 1,800 kg/m^3) and 2.7 for tungsten (400 GPa, 19,300 kg/m^3). For
    /// a metal in the units of another system it is 5.8 or more.
    const METALS: f64 = 3.0;
    let (e, rho) = (median_positive(moduli)?, median_positive(densities)?);
    let distance =
        |s: UnitSystem| from_metal(e * s.si(Quantity::Stress), Some(rho * density_si(s)));
    if distance(system) <= METALS {
        return None;
    }
    let mut others = UnitSystem::ALL.into_iter().filter(|s| *s != system);
    others.find(|s| distance(*s) <= METALS)
}

/// Returns the finding, extended by the system in which the deck is probably written.
fn named_elsewhere(f: Finding, other: UnitSystem) -> Finding {
    Finding {
        message: format!(
            "{}. In `{}` modulus and density both fit a metal.",
            f.clause(),
            other.name()
        ),
        remedy: format!(
            "Write `units = \"{}\"` in the job if the deck is in it, else correct the densities of the deck.",
            other.name()
        ),
        ..f
    }
}

#[allow(clippy::too_many_arguments)]
fn find_implausible_value(
    what: &str,
    unit: &str,
    code: &'static str,
    values: &[(u32, f64)],
    factor: f64,
    limits: [f64; 2],
    where_all_are: Severity,
    system: UnitSystem,
) -> Option<Finding> {
    let stated: Vec<(u32, f64)> = values
        .iter()
        .filter(|v| v.1 != 0.0)
        .map(|v| (v.0, v.1 * factor))
        .collect();
    let bad: Vec<(u32, f64)> = stated
        .iter()
        .copied()
        .filter(|v| !(limits[0]..=limits[1]).contains(&v.1))
        .collect();
    let first = bad.first()?;
    let severity = if bad.len() == stated.len() {
        where_all_are
    } else {
        Severity::Warning
    };
    let others = if bad.len() > 1 {
        format!(" (and {} more)", bad.len() - 1)
    } else {
        String::new()
    };
    let limit = if first.1 < limits[0] {
        limits[0]
    } else {
        limits[1]
    };
    Some(
        Finding::new(
            severity,
            code,
            format!("material {}", first.0),
            format!(
                "in `{}` the {what} of material {}{others} is {:.3e} {unit}, outside {} to {} {unit}",
                system.name(),
                first.0,
                first.1,
                limits[0],
                limits[1]
            ),
            "check `units` of the job against the deck; for weight densities PARAM,WTMASS must be set",
        )
        .with_numbers(first.1, limit),
    )
}

/// Returns the system in which the numbers of a deck are most plausible. PARAM,UNITSYS decides if it names a system.
///
/// Otherwise it is the system whose modulus and density are nearest to 100 GPa and 5,000 kg/m^3 on a logarithmic scale. These values are
/// between the values of steel, aluminium, titanium and plastics. Only systems whose Young's moduli [`check_units`] accepts count.
/// `None` without a modulus, or if all systems contradict the deck.
///
/// # Example
/// ```
/// use strainbridge::units::{UnitSystem, likely_system};
///
/// // Steel by material id: 210 GPa and 7850 kg/m^3 in three systems.
/// let system = |e, rho| likely_system(None, &[(1, e)], &[(1, rho)]);
/// assert_eq!(system(2.1e11, 7850.0), Some(UnitSystem::MKgS));
/// assert_eq!(system(2.1e5, 7.85e-9), Some(UnitSystem::MmTS));
/// assert_eq!(system(3.0e7, 7.3e-4), Some(UnitSystem::InLbfS));
/// assert_eq!(likely_system(Some("N-MM"), &[], &[]), Some(UnitSystem::MmTS));
/// ```
pub fn likely_system(
    unitsys: Option<&str>,
    moduli: &[(u32, f64)],
    densities: &[(u32, f64)],
) -> Option<UnitSystem> {
    if let Some(system) = unitsys.and_then(UnitSystem::from_unitsys) {
        return Some(system);
    }
    let e = median_positive(moduli)?;
    let rho = median_positive(densities);
    let distance = |s: &UnitSystem| {
        let rho = rho.map(|r| r * density_si(*s));
        from_metal(e * s.si(Quantity::Stress), rho)
    };
    let accepted = |s: &UnitSystem| {
        let found = check_units(*s, None, moduli, densities);
        found.iter().all(|f| f.severity < Severity::Error)
    };
    UnitSystem::ALL
        .into_iter()
        .filter(accepted)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Typical size of a load on a structure whose loads are unknown, SI units. It is the wheel force of a light truck, and its moment on an arm of 0.2
/// m.
const TYPICAL_FORCE_N: f64 = 1e4;
const TYPICAL_MOMENT_N_M: f64 = 2e3;

/// Returns the typical size of an unknown force or moment in the units of a deck; `None` for other quantities.
pub fn typical_load(system: UnitSystem, quantity: Quantity) -> Option<f64> {
    let si = match quantity {
        Quantity::Force => TYPICAL_FORCE_N,
        Quantity::Moment => TYPICAL_MOMENT_N_M,
        _ => return None,
    };
    Some(si / system.si(quantity))
}

/// Returns whether a force or moment has the size of a unit load. This is a power of ten in the units of the deck, at most a hundredth of
/// [`typical_load`]. Such loads scale an influence coefficient and do not show the size of the loads of a vehicle.
pub fn is_unit_load(system: UnitSystem, quantity: Quantity, size: f64) -> bool {
    let exponent = size.abs().log10();
    let is_power = (exponent - exponent.round()).abs() < 1e-9;
    is_power && typical_load(system, quantity).is_some_and(|t| size.abs() <= t / 100.0)
}
