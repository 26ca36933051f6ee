//! PBEAM: a beam with properties at stations along it.

use super::super::fault::DeckFaultKind;
use super::super::fields::Fields;
use super::property::recovery;
use crate::cards::{BeamStation, Pbeam};

/// A station as written. Blank properties are filled after all stations are read.
struct RawStation {
    x_xb: f64,
    output: bool,
    /// Values of A, I1, I2, I12, J and NSM.
    values: [Option<f64>; 6],
    recovery: [[f64; 2]; 4],
}

const VALUES: [&str; 6] = ["A", "I1", "I2", "I12", "J", "NSM"];

fn is_so(f: &Fields, i: usize) -> bool {
    f.is_word(i, "YES") || f.is_word(i, "NO") || f.is_word(i, "YESA")
}

pub(super) fn pbeam(f: &mut Fields) -> Pbeam {
    let id = f.id(0, "PID");
    let mid = f.id(1, "MID");
    let values_a = std::array::from_fn(|k| f.real_or(2 + k, VALUES[k.min(5)], 0.0));
    // The second line contains the stress points of end A, unless a station begins there.
    let mut i = 8;
    let mut points_a = [[0.0; 2]; 4];
    if !is_so(f, i) {
        points_a = recovery(f, i);
        i += 8;
    }
    let mut written = Vec::new();
    while is_so(f, i) {
        let word = f.word(i);
        let x_xb = f.required_real(i + 1, "X/XB");
        if !(x_xb > 0.0 && x_xb <= 1.0) {
            let found = f.word(i + 1);
            f.fault(
                i + 1,
                "X/XB",
                DeckFaultKind::OutOfRange {
                    found,
                    allowed: "more than 0, at most 1",
                },
            );
        }
        let values = std::array::from_fn(|k| f.opt_real(i + 2 + k, VALUES[k.min(5)]));
        i += 8;
        // YESA takes the stress points of end A. NO requests no stress and states no points; the section between stations then has the points of end
        // A, too.
        let mut points = points_a;
        if word == "YES" && !is_so(f, i) && i < f.len() {
            points = recovery(f, i);
            i += 8;
        }
        written.push(RawStation {
            x_xb,
            output: word != "NO",
            values,
            recovery: points,
        });
    }
    let b = |f: &mut Fields, k: usize, name| f.opt_real(i + k, name);
    Pbeam {
        id,
        mid,
        stations: stations(values_a, points_a, written),
        k: [b(f, 0, "K1"), b(f, 1, "K2")],
        s: [b(f, 2, "S1").unwrap_or(0.0), b(f, 3, "S2").unwrap_or(0.0)],
        nsi: [b(f, 4, "NSI(A)"), b(f, 5, "NSI(B)")],
        cw: [b(f, 6, "CW(A)"), b(f, 7, "CW(B)")],
        m: [
            [b(f, 8, "M1(A)"), b(f, 9, "M2(A)")],
            [b(f, 10, "M1(B)"), b(f, 11, "M2(B)")],
        ],
        n: [
            [b(f, 12, "N1(A)"), b(f, 13, "N2(A)")],
            [b(f, 14, "N1(B)"), b(f, 15, "N2(B)")],
        ],
    }
}

/// Fills blank properties and returns the stations: end B takes the values of end A, a station between the ends takes interpolated values.
fn stations(
    values_a: [f64; 6],
    points_a: [[f64; 2]; 4],
    mut written: Vec<RawStation>,
) -> Vec<BeamStation> {
    written.sort_by(|a, b| a.x_xb.total_cmp(&b.x_xb));
    let end_b = written.iter().rev().find(|w| w.x_xb >= 1.0);
    let values_b: [f64; 6] = match end_b {
        Some(w) => std::array::from_fn(|k| w.values[k].unwrap_or(values_a[k])),
        None => values_a,
    };
    let mut list = vec![station(0.0, true, values_a, points_a)];
    for w in &written {
        let filled = std::array::from_fn(|k| {
            w.values[k].unwrap_or(if w.x_xb >= 1.0 {
                values_b[k]
            } else {
                values_a[k] + w.x_xb * (values_b[k] - values_a[k])
            })
        });
        list.push(station(w.x_xb, w.output, filled, w.recovery));
    }
    if end_b.is_none() {
        list.push(station(1.0, true, values_a, points_a));
    }
    list
}

fn station(
    x_xb: f64,
    output: bool,
    [area, i1, i2, i12, j, nsm]: [f64; 6],
    recovery: [[f64; 2]; 4],
) -> BeamStation {
    BeamStation {
        x_xb,
        output,
        area,
        i1,
        i2,
        i12,
        j,
        nsm,
        recovery,
    }
}
