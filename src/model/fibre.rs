//! Fibre distances of a shell: where its surfaces are, along its normal.

use super::types::{Model, Shell, ShellProperty};

/// Distances Z1 (bottom) and Z2 (top) from the reference plane of a shell, at its centre and at its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fibres {
    /// Distances at the centre, where the thickness is the mean of the corners.
    pub centre: [f64; 2],
    /// Distances at the corners, in the order of the grids.
    pub corners: [[f64; 2]; 4],
}

impl Fibres {
    /// Returns the distances at a corner, or at the centre.
    pub fn distances_at(&self, corner: Option<usize>) -> [f64; 2] {
        let corner = corner.and_then(|k| self.corners.get(k));
        corner.copied().unwrap_or(self.centre)
    }
}

impl ShellProperty {
    /// Returns Z1 and Z2 at a point with this thickness: the stated values, or else half the local thickness below and above.
    ///
    /// # Reference
    /// MSC Nastran Quick Reference Guide, PSHELL, remark on Z1 and Z2. `T` in the defaults is the local thickness. It comes from the connection entry
    /// if that entry states thicknesses at the grids.
    pub fn fibres(&self, thickness: f64) -> [f64; 2] {
        let [z1, z2] = self.z;
        [
            z1.unwrap_or(-thickness / 2.0),
            z2.unwrap_or(thickness / 2.0),
        ]
    }
}

impl Model {
    /// Returns the fibre distances of a shell. NaN if the shell has no property.
    pub fn fibres(&self, shell: &Shell) -> Fibres {
        let n = shell.shape.n_corners();
        let mean = shell.thickness.iter().take(n).sum::<f64>() / n as f64;
        let property = self.shell_properties.get(shell.property.us());
        let z = |t: f64| property.map_or([f64::NAN; 2], |p| p.fibres(t));
        Fibres {
            centre: z(mean),
            corners: shell.thickness.map(z),
        }
    }
}
