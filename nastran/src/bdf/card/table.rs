//! MATT1, TABLEM1 to TABLEM4.

use super::super::fault::DeckFaultKind;
use super::super::fields::Fields;
use crate::cards::{MaterialTable, MaterialTableForm, Matt1};

const PROPERTIES: [&str; 10] = [
    "T(E)", "T(G)", "T(NU)", "T(RHO)", "T(A)", "T(TREF)", "T(GE)", "T(ST)", "T(SC)", "T(SS)",
];

pub(super) fn matt1(f: &mut Fields) -> Matt1 {
    let id = f.id(0, "MID");
    let mut tables = [None; 10];
    for (k, (table, name)) in tables.iter_mut().zip(PROPERTIES).enumerate() {
        *table = f.opt_id(1 + k, name).filter(|&id| id > 0);
    }
    Matt1 { id, tables }
}

/// Reads TABLEM1 to TABLEM4: parameters on the first line, points or coefficients from the second line up to ENDT.
pub(super) fn material_table(f: &mut Fields) -> MaterialTable {
    let id = f.id(0, "TID");
    let (form, used) = match f.name {
        b"TABLEM1" => (MaterialTableForm::Replaces(points(f)), 0),
        b"TABLEM2" => {
            let x1 = f.real_or(1, "X1", 0.0);
            let points = points(f);
            (MaterialTableForm::Shifted { x1, points }, 1)
        }
        b"TABLEM3" => {
            let x = [f.real_or(1, "X1", 0.0), divisor(f)];
            let points = points(f);
            (MaterialTableForm::Scaled { x, points }, 2)
        }
        _ => {
            let x = [
                f.real_or(1, "X1", 0.0),
                divisor(f),
                f.required_real(3, "X3"),
                f.required_real(4, "X4"),
            ];
            let a = coefficients(f);
            (MaterialTableForm::Series { x, a }, 4)
        }
    };
    let words = (1 + used..8).map(|i| f.word(i));
    let asked: Vec<String> = words
        .filter(|w| !["", "0", "LINEAR"].contains(&w.as_str()))
        .collect();
    MaterialTable {
        id,
        form,
        options: asked.join(", "),
    }
}

/// Reads X2, the divisor.
fn divisor(f: &mut Fields) -> f64 {
    let x2 = f.required_real(2, "X2");
    if x2 == 0.0 && !f.is_blank(2) {
        let found = f.word(2);
        let allowed = "a number other than 0";
        f.fault(2, "X2", DeckFaultKind::OutOfRange { found, allowed });
    }
    x2
}

/// Returns the index of ENDT, or of the end of the card.
fn end_of_table(f: &Fields) -> usize {
    (8..f.len())
        .find(|&i| f.is_word(i, "ENDT"))
        .unwrap_or(f.len())
}

/// Returns the index after the last pair. ENDT may be in either field of the pair that follows.
fn end_of_pairs(f: &Fields) -> usize {
    match end_of_table(f) {
        end if end < f.len() => end - end % 2,
        end => end,
    }
}

/// Reads pairs of x and y, without pairs marked SKIP. The values of x must ascend, or descend. Two equal values are a jump.
fn points(f: &mut Fields) -> Vec<(f64, f64)> {
    let end = end_of_pairs(f);
    let mut points = Vec::new();
    for i in (8..end).step_by(2) {
        let skipped = f.is_word(i, "SKIP") || f.is_word(i + 1, "SKIP");
        if !skipped && !(f.is_blank(i) && f.is_blank(i + 1)) {
            points.push((f.required_real(i, "x"), f.required_real(i + 1, "y")));
        }
    }
    if points.len() < 2 {
        f.fault(8, "x1", DeckFaultKind::Missing);
    }
    let ordered = |less: fn(&f64, &f64) -> bool| {
        let mut pairs = points.windows(2);
        pairs.all(|w| matches!(w, [a, b] if less(&a.0, &b.0)))
    };
    if !(ordered(f64::le) || ordered(f64::ge)) {
        let found = "values of x out of order".to_owned();
        let allowed = "ascending, or descending";
        f.fault(8, "x", DeckFaultKind::OutOfRange { found, allowed });
    }
    points
}

fn coefficients(f: &mut Fields) -> Vec<f64> {
    let end = end_of_table(f);
    if end == 8 {
        f.fault(8, "A0", DeckFaultKind::Missing);
    }
    (8..end).map(|i| f.real_or(i, "A", 0.0)).collect()
}
