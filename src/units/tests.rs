use super::*;

#[test]
fn every_system_is_consistent_force_is_mass_times_acceleration() {
    for s in UnitSystem::ALL {
        let f = s.mass_kg() * s.length_m();
        assert!(
            (s.unit(Quantity::Force).si / f - 1.0).abs() < 1e-15,
            "{}",
            s.name()
        );
        for q in [
            Quantity::Force,
            Quantity::Moment,
            Quantity::Length,
            Quantity::Mass,
            Quantity::Stress,
        ] {
            let named = find_unit(q, s.unit(q).name).unwrap();
            assert!(
                (named.si / s.unit(q).si - 1.0).abs() < 1e-14,
                "{} {}",
                s.name(),
                q.word()
            );
        }
    }
}

#[test]
fn steel_is_plausible_in_its_own_units_and_only_there() {
    // Steel: 210 GPa, 7850 kg/m^3 in each system (in-lbf-s: 30.46e6 psi, 7.345e-4 lbf s^2/in^4).
    let steel = [
        (UnitSystem::MKgS, 210e9, 7850.0),
        (UnitSystem::MmTS, 210e3, 7.85e-9),
        (UnitSystem::MmKgS, 210e6, 7.85e-6),
        (UnitSystem::InLbfS, 30.46e6, 7.345e-4),
    ];
    for (system, e, rho) in steel {
        for other in UnitSystem::ALL {
            let found = check_units(other, None, &[(1, e)], &[(1, rho)]);
            assert_eq!(
                found.is_empty(),
                other == system,
                "{} read as {}: {found:?}",
                system.name(),
                other.name()
            );
        }
    }
}

#[test]
fn a_number_that_is_not_known_is_a_dash() {
    assert_eq!(
        (number(f64::NAN), format_fixed(f64::NAN, 2)),
        ("-".into(), "-".into())
    );
    assert_eq!(
        (number(f64::INFINITY), format_fixed(f64::INFINITY, 2)),
        ("∞".into(), "-".into())
    );
    assert_eq!(
        (number(0.5), format_fixed(0.5, 2)),
        ("0.5000".into(), "0.50".into())
    );
}

/// Tests two wrong systems in which the modulus alone fits some material: 2.1e5 psi is a plastic, 3e7 kPa a light metal.
#[test]
fn densities_of_no_material_are_an_error_where_all_is_a_metal_in_another_system() {
    let tested = |declared, unitsys, e, rho| {
        let found = check_units(declared, unitsys, &[(1, e)], &[(1, rho)]);
        let of_density = found.iter().find(|f| f.code == "units-density").unwrap();
        (of_density.severity, of_density.remedy.clone())
    };
    use crate::finding::Severity::{Error, Warning};
    for (declared, right, e, rho) in [
        (UnitSystem::InLbfS, "mm-t-s", 210e3, 7.85e-9),
        (UnitSystem::InLbfS, "mm-t-s", 70e3, 2.7e-9),
        (UnitSystem::MmKgS, "in-lbf-s", 30.46e6, 7.345e-4),
    ] {
        let (severity, remedy) = tested(declared, None, e, rho);
        assert_eq!(severity, Error, "{right}");
        assert!(remedy.contains(right), "{remedy}");
    }
    // The weight density of steel in place of its mass density, and a deck that states its system.
    assert_eq!(tested(UnitSystem::InLbfS, None, 30.46e6, 0.2836).0, Warning);
    let of_weight_density = tested(UnitSystem::InLbfS, Some("IN-LBF"), 210e3, 7.85e-9);
    assert_eq!(of_weight_density.0, Warning);
}

#[test]
fn a_contradiction_with_unitsys_is_an_error() {
    let found = check_units(UnitSystem::MmTS, Some("MN-MM"), &[], &[]);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].code, "units-contradict-unitsys");
    assert!(check_units(UnitSystem::MmKgS, Some("MN-MM"), &[], &[]).is_empty());
}

#[test]
fn factors_go_from_model_to_report_units() {
    assert_eq!(
        factor(UnitSystem::MmTS, find_unit(Quantity::Force, "kN").unwrap()),
        1e-3
    );
    assert!(
        (factor(
            UnitSystem::MmTS,
            find_unit(Quantity::Moment, "kN m").unwrap()
        ) - 1e-6)
            .abs()
            < 1e-20
    );
    assert!(
        (factor(UnitSystem::MmKgS, find_unit(Quantity::Force, "N").unwrap()) - 1e-3).abs() < 1e-18
    );
    // 1 lbf s^2/in is a mass of 386.0886 lb.
    let lb = factor(UnitSystem::InLbfS, find_unit(Quantity::Mass, "lb").unwrap());
    assert!((lb - 386.0886).abs() < 1e-3, "{lb}");
}

#[test]
fn the_likely_system_is_one_that_the_check_accepts_and_none_where_none_is() {
    // Steel in the units of each system.
    for system in UnitSystem::ALL {
        let e = 2.1e11 / system.si(Quantity::Stress);
        let rho = 7850.0 / (system.mass_kg() / system.length_m().powi(3));
        let found = likely_system(None, &[(1, e)], &[(1, rho)]);
        assert_eq!(found, Some(system));
    }
    // A modulus of 1 is not plausible for a material in any system.
    assert_eq!(likely_system(None, &[(1, 1.0)], &[]), None);
    assert_eq!(likely_system(None, &[], &[]), None);
    assert_eq!(
        likely_system(Some("MN-MM"), &[], &[]),
        UnitSystem::from_unitsys("MN-MM")
    );
}

#[test]
fn a_coordinate_of_a_survey_is_a_length_of_a_structure_and_one_beyond_the_earth_is_none() {
    // A quarter of the meridian, 10,002 km, is the largest northing; the earth's circumference is 4e7 m.
    let most = largest_size(Some(Quantity::Length));
    assert!(most > 1.001e7 && most < 1e9);
}
