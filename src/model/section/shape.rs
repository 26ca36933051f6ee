//! Section types of PBARL and PBEAML.
//!
//! In the figures of the manual, element y points up and element z points to the right. The recovery points C, D, E and F are at the locations of the
//! figures. The element axis runs through the shear centre. Dimensions DIM1, DIM2 .. are `d[0]`, `d[1]` ..
//!
//! # Reference
//! MSC Nastran Quick Reference Guide, PBARL and PBEAML (figures of the types). Torsion: W. C. Young, Roark's Formulas for Stress and Strain, table 20
//! (bar), Bredt's formula (box), sum of b t^3 / 3 (open walls). Shear factors: the area fraction of the walls that carry the shear, times 5/6 if the
//! shear varies as in a rectangle. A solid circle has 0.9, a hollow circle 0.5.

use super::boxes::{double_box, hat_on_plate};
use super::massive::{bar, box1, circle, cross, hexagon};
use super::open::{
    angle, channel, channel2, h_section, hat, i_section, tee, tee1, tee2, z_section,
};
use super::parts::Shape;

/// Reason why dimensions give no section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum SectionFault {
    Unknown,
    Count { expected: usize },
    Shape,
}

/// Returns the section of that type.
pub(in super::super) fn bar_section(kind: &str, dims: &[f64]) -> Result<Shape, SectionFault> {
    let expected = match kind {
        "ROD" => 1,
        "TUBE" | "TUBE2" | "BAR" => 2,
        "HEXA" => 3,
        "BOX" | "CHAN" | "CHAN1" | "CHAN2" | "T" | "T1" | "T2" | "L" | "H" | "Z" | "HAT"
        | "CROSS" | "I1" => 4,
        "HAT1" => 5,
        "BOX1" | "I" => 6,
        "DBOX" => 10,
        _ => return Err(SectionFault::Unknown),
    };
    if dims.len() < expected {
        return Err(SectionFault::Count { expected });
    }
    let d = |i: usize| dims.get(i).copied().unwrap_or(0.0);
    let inner_may_be_zero = kind == "TUBE";
    let positive = dims
        .iter()
        .take(expected)
        .enumerate()
        .all(|(i, x)| *x > 0.0 || (inner_may_be_zero && i == 1 && *x == 0.0));
    if !positive || !dims.iter().all(|x| x.is_finite()) {
        return Err(SectionFault::Shape);
    }
    let shape = match kind {
        "ROD" => circle(d(0), 0.0),
        "TUBE" => circle(d(0), d(1)),
        "TUBE2" => circle(d(0), d(0) - d(1)),
        "BAR" => bar(d(0), d(1)),
        "BOX" => box1([d(0), d(1), d(2), d(2), d(3), d(3)]),
        "BOX1" => box1([d(0), d(1), d(2), d(3), d(4), d(5)]),
        "I" => i_section(d(0), d(1), d(2), d(3), d(4), d(5)),
        "I1" => {
            let (width, t) = (d(0) + d(1), (d(3) - d(2)) / 2.0);
            i_section(d(3), width, width, d(1), t, t)
        }
        "CHAN" => channel(d(0), d(1), d(2), d(3)),
        "CHAN1" => channel(d(0) + d(1), d(3), d(1), (d(3) - d(2)) / 2.0),
        "CHAN2" => channel2(d(0), d(1), d(2), d(3)),
        "T" => tee(d(0), d(1), d(2), d(3)),
        "T1" => tee1(d(0), d(1), d(2), d(3)),
        "T2" => tee2(d(0), d(1), d(2), d(3)),
        "L" => angle(d(0), d(1), d(2), d(3)),
        "H" => h_section(d(0), d(1) / 2.0, d(2), d(3)),
        "Z" => z_section(d(0), d(1), d(2), d(3)),
        "HAT" => hat(d(0), d(1), d(2), d(3)),
        "HAT1" => hat_on_plate([d(0), d(1), d(2), d(3), d(4)]),
        "DBOX" => double_box(std::array::from_fn(d)),
        "CROSS" => cross(d(0), d(1), d(2), d(3)),
        _ => hexagon(d(0), d(1), d(2)),
    };
    shape.ok_or(SectionFault::Shape)
}
