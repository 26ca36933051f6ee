//! PBARL and PBEAML: bars and beams by cross-section.

use super::super::fault::DeckFaultKind;
use super::super::fields::Fields;
use crate::cards::{BeamlStation, Pbarl, Pbeaml};

/// Returns the number of dimensions of a section type; `None` for an unknown type.
fn n_dims(section: &str) -> Option<usize> {
    Some(match section {
        "ROD" => 1,
        "TUBE" | "TUBE2" | "BAR" => 2,
        "HEXA" => 3,
        "CHAN" | "T" | "BOX" | "CROSS" | "H" | "T1" | "I1" | "CHAN1" | "Z" | "CHAN2" | "T2"
        | "HAT" | "L" => 4,
        "HAT1" => 5,
        "I" | "BOX1" => 6,
        "DBOX" => 10,
        _ => return None,
    })
}

/// Reads the dimensions from field `first` on. A blank inner radius of a TUBE is 0. Blank thicknesses of a DBOX take another dimension: DIM5 to DIM8
/// take DIM4, and DIM9 and DIM10 take DIM6.
fn dims(
    f: &mut Fields,
    first: usize,
    section: &str,
    n: usize,
    of_end_a: Option<&[f64]>,
) -> Vec<f64> {
    let mut all: Vec<f64> = Vec::with_capacity(n);
    for k in 0..n {
        let given = f.opt_real(first + k, "DIM");
        let of_type = match (section, k) {
            ("TUBE", 1) => Some(0.0),
            ("DBOX", 4..=7) => all.get(3).copied(),
            ("DBOX", 8 | 9) => all.get(5).copied(),
            _ => None,
        };
        let default = of_end_a.and_then(|a| a.get(k).copied()).or(of_type);
        if given.is_none() && default.is_none() && f.is_blank(first + k) {
            f.fault(first + k, "DIM", DeckFaultKind::Missing);
        }
        all.push(given.or(default).unwrap_or(0.0));
    }
    all
}

/// Returns the number of dimensions of a section. An unknown type has dimensions up to the last field.
fn count(f: &mut Fields, section: &str) -> usize {
    if section.is_empty() {
        f.fault(3, "TYPE", DeckFaultKind::Missing);
    }
    n_dims(section).unwrap_or_else(|| f.len().saturating_sub(8))
}

pub(super) fn pbarl(f: &mut Fields) -> Pbarl {
    let id = f.id(0, "PID");
    let mid = f.id(1, "MID");
    let section = f.word(3);
    let n = count(f, &section);
    let dims = dims(f, 8, &section, n, None);
    let nsm = f.real_or(8 + n, "NSM", 0.0);
    Pbarl {
        id,
        mid,
        section,
        dims,
        nsm,
    }
}

/// Reads PBEAML: end A, then SO, X/XB, dimensions and NSM for every station. A blank dimension takes the value of end A.
pub(super) fn pbeaml(f: &mut Fields) -> Pbeaml {
    let id = f.id(0, "PID");
    let mid = f.id(1, "MID");
    let section = f.word(3);
    let n = count(f, &section);
    let dims_a = dims(f, 8, &section, n, None);
    let nsm = f.real_or(8 + n, "NSM(A)", 0.0);
    let mut stations = vec![BeamlStation {
        x_xb: 0.0,
        output: true,
        dims: dims_a.clone(),
        nsm,
    }];
    let mut i = 9 + n;
    while i < f.len() {
        let output = !f.is_word(i, "NO");
        if !f.is_blank(i) && !f.is_text(i) {
            let found = f.word(i);
            f.fault(
                i,
                "SO",
                DeckFaultKind::NotOneOf {
                    found,
                    allowed: "YES, NO",
                },
            );
        }
        let x_xb = f.real_or(i + 1, "X/XB", 1.0);
        let dims = dims(f, i + 2, &section, n, Some(&dims_a));
        stations.push(BeamlStation {
            x_xb,
            output,
            dims,
            nsm: f.real_or(i + 2 + n, "NSM", 0.0),
        });
        i += 3 + n;
    }
    stations.sort_by(|a, b| a.x_xb.total_cmp(&b.x_xb));
    Pbeaml {
        id,
        mid,
        section,
        stations,
    }
}
