//! Identification records and table names of a block.

use crate::results::{Analysis, Block, Quantity, ShellForm};

/// Returns the table and sub-table name that MSC and NX use.
pub(super) fn names(quantity: Quantity) -> Option<(&'static str, &'static str)> {
    use Quantity as Q;
    Some(match quantity {
        Q::Displacement | Q::Eigenvector | Q::Velocity | Q::Acceleration => ("OUGV1", "OUGV1"),
        Q::SpcForce => ("OQG1", "OQG1"),
        Q::MpcForce => ("OQMG1", "OQMG1"),
        Q::AppliedLoad => ("OPG1", "OPG1"),
        Q::ElementForce => ("OEF1X", "OEF1"),
        Q::Stress => ("OES1X1", "OES1"),
        Q::Strain => ("OSTR1X", "OSTR1"),
        Q::PlyStress => ("OES1C", "OES1C"),
        Q::PlyStrain => ("OSTR1C", "OSTR1C"),
        Q::GridPointForce | Q::Other => return None,
    })
}

/// Returns the 146 words before the rows of a block. The device code is 1, the format 1 (real), and the load set is the subcase.
pub(super) fn ident(block: &Block, wide: usize) -> Vec<u8> {
    let mut words = [0_i32; 50];
    let subcase = i32::try_from(block.subcase).unwrap_or(i32::MAX);
    let analysis = analysis_code(block.analysis);
    let (w5, w6, w7) = step(block, subcase);
    let set = |words: &mut [i32; 50], pairs: &[(usize, i32)]| {
        for (number, value) in pairs {
            if let Some(word) = number.checked_sub(1).and_then(|i| words.get_mut(i)) {
                *word = *value;
            }
        }
    };
    set(
        &mut words,
        &[
            (1, analysis.saturating_mul(10).saturating_add(1)),
            (2, table_code(block.quantity)),
            (
                3,
                block.element.map_or(0, |e| i32::try_from(e.0).unwrap_or(0)),
            ),
            (4, subcase),
            (5, w5),
            (6, w6),
            (7, w7),
            (8, subcase),
            (9, 1),
            (10, i32::try_from(wide).unwrap_or(0)),
            (11, stress_code(block)),
        ],
    );
    let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    for title in &block.titles {
        let printable = title
            .chars()
            .map(|c| if c.is_ascii_graphic() { c as u8 } else { b' ' });
        let from = bytes.len();
        bytes.extend(printable.take(128));
        bytes.resize(from.saturating_add(128), b' ');
    }
    bytes
}

fn analysis_code(analysis: Analysis) -> i32 {
    match analysis {
        Analysis::Statics => 1,
        Analysis::Modes => 2,
        Analysis::Frequency => 5,
        Analysis::Transient => 6,
        Analysis::PreBuckling => 7,
        Analysis::PostBuckling => 8,
        Analysis::ComplexEigen => 9,
        Analysis::NonlinearStatics => 10,
        Analysis::Other(code) => code,
    }
}

/// Returns words 5 to 7. Statics: load set. Modes: mode, eigenvalue and frequency (sqrt(eigenvalue) / 2 pi). Frequency, transient and nonlinear
/// analyses: frequency, time or load factor.
fn step(block: &Block, subcase: i32) -> (i32, i32, i32) {
    let real = |x: f64| i32::from_le_bytes((x as f32).to_le_bytes());
    match block.analysis {
        Analysis::Modes | Analysis::PostBuckling | Analysis::ComplexEigen => (
            block.mode,
            real(block.step),
            real(block.step.abs().sqrt() / std::f64::consts::TAU),
        ),
        Analysis::Frequency | Analysis::Transient | Analysis::NonlinearStatics => {
            (real(block.step), 0, 0)
        }
        _ => (subcase, 0, 0),
    }
}

fn table_code(quantity: Quantity) -> i32 {
    use Quantity as Q;
    match quantity {
        Q::Displacement => 1,
        Q::AppliedLoad => 2,
        Q::SpcForce | Q::MpcForce => 3,
        Q::ElementForce => 4,
        Q::Stress | Q::Strain | Q::PlyStress | Q::PlyStrain => 5,
        Q::Eigenvector => 7,
        Q::Velocity => 10,
        Q::Acceleration => 11,
        Q::GridPointForce => 19,
        Q::Other => 0,
    }
}

/// Returns the stress code with the bits 1 von Mises, 2 and 8 strain, 4 fibre form of strain.
fn stress_code(block: &Block) -> i32 {
    let von_mises = i32::from(block.von_mises);
    match block.quantity {
        Quantity::Strain | Quantity::PlyStrain => {
            let fibre = if block.form == Some(ShellForm::Curvature) || block.form.is_none() {
                0
            } else {
                4
            };
            von_mises | 2 | 8 | fibre
        }
        Quantity::Stress | Quantity::PlyStress => von_mises,
        _ => 0,
    }
}
