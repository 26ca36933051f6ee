//! CQUAD4, CQUADR, CQUAD8, CTRIA3, CTRIAR, CTRIA6, CSHEAR.

use super::super::fault::DeckFaultKind;
use super::super::fields::{Fields, Value};
use crate::cards::{MaterialAngle, ShearPanel, Shell, ShellShape, Snorm};

/// Positions of the fields after the grids.
struct Layout {
    shape: ShellShape,
    angle: usize,
    zoffs: usize,
    tflag: usize,
    thickness: usize,
}

fn layout(name: &[u8]) -> Layout {
    let (shape, angle, zoffs, tflag, thickness) = match name {
        b"CQUADR" => (ShellShape::QuadR, 6, 7, 9, 10),
        b"CQUAD8" => (ShellShape::Quad8, 14, 15, 16, 10),
        b"CTRIA3" => (ShellShape::Tria3, 5, 6, 9, 10),
        b"CTRIAR" => (ShellShape::TriaR, 5, 6, 9, 10),
        b"CTRIA6" => (ShellShape::Tria6, 8, 9, 13, 10),
        _ => (ShellShape::Quad4, 6, 7, 9, 10),
    };
    Layout {
        shape,
        angle,
        zoffs,
        tflag,
        thickness,
    }
}

pub(super) fn shell(f: &mut Fields) -> Shell {
    let at = layout(f.name);
    let id = f.id(0, "EID");
    let pid = f.opt_id(1, "PID");
    let n_corners = at.shape.n_corners();
    let mut grids = [0; 8];
    for (k, grid) in grids.iter_mut().take(at.shape.n_grids()).enumerate() {
        *grid = if k < n_corners {
            f.id(2 + k, "G")
        } else {
            f.opt_id(2 + k, "G").unwrap_or(0)
        };
    }
    let mut thickness = [None; 4];
    for (k, t) in thickness.iter_mut().take(n_corners).enumerate() {
        *t = f.opt_real(at.thickness + k, "T");
    }
    Shell {
        id,
        pid,
        shape: at.shape,
        grids,
        angle: angle(f, at.angle),
        zoffs: f.opt_real(at.zoffs, "ZOFFS"),
        tflag: f.opt_id(at.tflag, "TFLAG").unwrap_or(0) == 1,
        thickness,
    }
}

/// Reads THETA or MCID: an integer is a coordinate system, a real is an angle, and a blank is the angle 0.
fn angle(f: &mut Fields, i: usize) -> MaterialAngle {
    match f.value(i) {
        Value::Blank => MaterialAngle::Theta(0.0),
        Value::Real(theta) => MaterialAngle::Theta(theta),
        Value::Integer(n) => match u32::try_from(n) {
            Ok(cid) => MaterialAngle::Mcid(cid),
            Err(_) => {
                let found = f.word(i);
                f.fault(
                    i,
                    "MCID",
                    DeckFaultKind::OutOfRange {
                        found,
                        allowed: "0 and more",
                    },
                );
                MaterialAngle::Theta(0.0)
            }
        },
        Value::Text => {
            f.opt_real(i, "THETA");
            MaterialAngle::Theta(0.0)
        }
    }
}

pub(super) fn shear_panel(f: &mut Fields) -> ShearPanel {
    ShearPanel {
        id: f.id(0, "EID"),
        pid: f.opt_id(1, "PID"),
        grids: [f.id(2, "G1"), f.id(3, "G2"), f.id(4, "G3"), f.id(5, "G4")],
    }
}

pub(super) fn snorm(f: &mut Fields) -> Snorm {
    Snorm {
        grid: f.id(0, "GID"),
        cid: f.opt_id(1, "CID").unwrap_or(0),
        n: f.reals(2, ["N1", "N2", "N3"]),
    }
}
