//! Fibre distances of a shell's surfaces.

use crate::model::{Model, Shell, ShellKind};

/// Z1 (bottom) and Z2 (top) of a shell, from its reference plane along its normal.
///
/// The property's; where those are the default, half the property's thickness, and the element has corner thicknesses of its own, half
/// their mean.
pub fn surface_z(model: &Model, shell: &Shell) -> [f64; 2] {
    let Some(property) = model.shell_properties.get(shell.property.us()) else {
        return [f64::NAN; 2];
    };
    let ShellKind::Homogeneous { t, .. } = property.kind else {
        return property.z;
    };
    if property.z != [-t / 2.0, t / 2.0] {
        return property.z;
    }
    let n = shell.shape.n_corners();
    let mean = shell.thickness.iter().take(n).sum::<f64>() / n as f64;
    if mean.is_finite() && mean > 0.0 {
        [-mean / 2.0, mean / 2.0]
    } else {
        property.z
    }
}
