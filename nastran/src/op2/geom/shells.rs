//! Shells and shear panels.

use super::fields::Fields;
use crate::cards::{MaterialAngle, ShearPanel, Shell, ShellShape};

/// Reads CQUAD4, CQUADR: `eid pid g1..g4 theta zoffs blank tflag t1..t4`, 14 words; 15 with a material coordinate system or -1.
pub(super) fn quad4(shape: ShellShape) -> impl Fn(&mut Fields<'_>) -> Option<Shell> {
    move |f| {
        let mut shell = head(f, shape)?;
        shell.angle = theta(f)?;
        shell.zoffs = offset(f)?;
        f.skip(1)?;
        shell.tflag = flag(f)?;
        thicknesses(f, &mut shell)?;
        mcid(f, shell)
    }
}

/// Reads CTRIA3, CTRIAR: `eid pid g1..g3 theta zoffs blank blank tflag t1..t3`, 13 words; 14 with a material coordinate system or -1.
pub(super) fn tria3(shape: ShellShape) -> impl Fn(&mut Fields<'_>) -> Option<Shell> {
    move |f| {
        let mut shell = head(f, shape)?;
        shell.angle = theta(f)?;
        shell.zoffs = offset(f)?;
        f.skip(2)?;
        shell.tflag = flag(f)?;
        thicknesses(f, &mut shell)?;
        mcid(f, shell)
    }
}

/// Reads CQUAD8: `eid pid g1..g8 t1..t4 theta zoffs tflag`, 17 words; 16 without the flag, 18 with a material coordinate system or -1.
pub(super) fn quad8(f: &mut Fields<'_>) -> Option<Shell> {
    let mut shell = head(f, ShellShape::Quad8)?;
    thicknesses(f, &mut shell)?;
    shell.angle = theta(f)?;
    shell.zoffs = offset(f)?;
    shell.tflag = f.words_left() > 0 && flag(f)?;
    mcid(f, shell)
}

/// Reads CTRIA6: `eid pid g1..g6 theta zoffs t1..t3 tflag`, 14 words; 13 without the flag, 15 with a material coordinate system or -1.
pub(super) fn tria6(f: &mut Fields<'_>) -> Option<Shell> {
    let mut shell = head(f, ShellShape::Tria6)?;
    shell.angle = theta(f)?;
    shell.zoffs = offset(f)?;
    thicknesses(f, &mut shell)?;
    shell.tflag = f.words_left() > 0 && flag(f)?;
    mcid(f, shell)
}

/// Reads CSHEAR: `eid pid g1..g4`.
pub(super) fn shear_panel(f: &mut Fields<'_>) -> Option<ShearPanel> {
    Some(ShearPanel {
        id: f.id()?,
        pid: Some(f.id()?),
        grids: f.ids()?,
    })
}

fn head(f: &mut Fields<'_>, shape: ShellShape) -> Option<Shell> {
    let (id, pid) = (f.id()?, f.id()?);
    let mut grids = [0; 8];
    for (i, grid) in grids.iter_mut().take(shape.n_grids()).enumerate() {
        *grid = if i < shape.n_corners() {
            f.id()?
        } else {
            f.id_or_zero()?
        };
    }
    Some(Shell {
        id,
        pid: Some(pid),
        shape,
        grids,
        angle: MaterialAngle::Theta(0.0),
        zoffs: None,
        tflag: false,
        thickness: [None; 4],
    })
}

/// Returns the angle in degrees. The value is an angle, or 512 (MCID + 1), which exceeds every angle.
fn theta(f: &mut Fields<'_>) -> Option<MaterialAngle> {
    let theta = f.usual_real()?;
    Some(if theta > 511.0 {
        let mcid = theta / 512.0 - 1.0;
        if mcid < 0.0 || mcid > f64::from(i32::MAX) {
            return None;
        }
        MaterialAngle::Mcid(mcid.round() as u32)
    } else {
        MaterialAngle::Theta(theta)
    })
}

fn offset(f: &mut Fields<'_>) -> Option<Option<f64>> {
    Some(f.blank_or_real()?.filter(|z| *z != 0.0))
}

fn flag(f: &mut Fields<'_>) -> Option<bool> {
    match f.int()? {
        1 => Some(true),
        -1 | 0 | 2 => Some(false),
        _ => None,
    }
}

/// Reads corner thicknesses; -1 and 0 are blanks.
fn thicknesses(f: &mut Fields<'_>, shell: &mut Shell) -> Option<()> {
    let n = shell.shape.n_corners();
    for t in shell.thickness.iter_mut().take(n) {
        *t = Some(f.usual_real()?).filter(|t| *t > 1e-17);
    }
    Some(())
}

/// Reads the last word of newer versions: a material coordinate system, or -1.
fn mcid(f: &mut Fields<'_>, mut shell: Shell) -> Option<Shell> {
    if f.words_left() > 0 {
        match f.int()? {
            -1 => {}
            cid => shell.angle = MaterialAngle::Mcid(u32::try_from(cid).ok()?),
        }
    }
    Some(shell)
}
