//! Directors: the shell normal at each corner, shared by the shells of a grid that meet smoothly (PARAM,SNORM).

use crate::model::{GridIx, GridNormal, Model, Shell, Vec3};
use std::collections::{HashMap, HashSet};

/// Director at each corner of a shell. For a triangle the fourth director repeats the third.
pub(crate) type CornerDirectors = [Vec3; 4];

/// Normals of the element's own surface at its corners; zero where the shape is degenerate.
fn corner_normals(model: &Model, shell: &Shell) -> CornerDirectors {
    let n = shell.shape.n_corners();
    let x = |k: usize| model.grids[shell.grids[k % n].us()].x;
    let mut normals = [Vec3::zeros(); 4];
    for (k, normal) in normals.iter_mut().enumerate().take(n) {
        *normal = (x(k + 1) - x(k))
            .cross(&(x(k + n - 1) - x(k)))
            .try_normalize(0.0)
            .unwrap_or_else(Vec3::zeros);
    }
    if n == 3 {
        normals[3] = normals[2];
    }
    normals
}

/// Computes the directors of every shell at its corners.
///
/// The director is the normal that SNORM gives a grid. Without SNORM, it is the mean normal of the shells at the grid, if all their normals are
/// within `snorm_rad` of the mean. Otherwise it is the shell's own normal.
///
/// Shells of opposite orientation share a normal too, each with its own sign. With an angle of zero or less, shells share no normals.
pub(crate) fn shared_normals(model: &Model) -> Vec<CornerDirectors> {
    let own: Vec<CornerDirectors> = model
        .shells
        .iter()
        .map(|s| corner_normals(model, s))
        .collect();
    if model.params.snorm_rad <= 0.0 {
        return own;
    }
    let given: HashMap<GridIx, Vec3> = model.normals.iter().map(|n| (n.grid, n.n)).collect();
    let limit = model.params.snorm_rad.cos();
    let mut reference = vec![Vec3::zeros(); model.grids.len()];
    let mut sum = vec![Vec3::zeros(); model.grids.len()];
    let corners = |shell: &Shell| shell.grids.into_iter().take(shell.shape.n_corners());
    for (shell, normals) in model.shells.iter().zip(&own) {
        for (g, n) in corners(shell).zip(normals) {
            let (reference, sum) = (&mut reference[g.us()], &mut sum[g.us()]);
            if *reference == Vec3::zeros() {
                *reference = *n;
            }
            *sum += n * reference.dot(n).signum();
        }
    }
    sum.iter_mut()
        .for_each(|s| *s = s.try_normalize(0.0).unwrap_or_else(Vec3::zeros));
    let mut shared = vec![true; model.grids.len()];
    for (shell, normals) in model.shells.iter().zip(&own) {
        for (g, n) in corners(shell).zip(normals) {
            shared[g.us()] &= sum[g.us()].dot(n).abs() >= limit;
        }
    }
    let mut result = own;
    for (shell, normals) in model.shells.iter().zip(&mut result) {
        for (g, n) in corners(shell).zip(normals.iter_mut()) {
            if let Some(given) = given.get(&g) {
                *n = given * given.dot(n).signum();
            } else if shared[g.us()] {
                *n = sum[g.us()] * sum[g.us()].dot(n).signum();
            }
        }
        if shell.shape.n_corners() == 3 {
            normals[3] = normals[2];
        }
    }
    result
}

/// Returns the normals of SNORM that the formulation refuses. The angle between such a normal and the normal of a shell at its grid exceeds
/// PARAM,SNORM, or PARAM,SNORM turns shared normals off.
pub(crate) fn normals_beyond(model: &Model) -> Vec<&GridNormal> {
    let given: HashMap<GridIx, &GridNormal> = model.normals.iter().map(|n| (n.grid, n)).collect();
    if given.is_empty() {
        return Vec::new();
    }
    let limit = model.params.snorm_rad.cos();
    let mut beyond = HashSet::new();
    for shell in &model.shells {
        let corners = shell.grids.into_iter().take(shell.shape.n_corners());
        for (g, own) in corners.zip(corner_normals(model, shell)) {
            let far =
                |n: &&GridNormal| model.params.snorm_rad <= 0.0 || n.n.dot(&own).abs() < limit;
            if given.get(&g).copied().is_some_and(|n| far(&n)) {
                beyond.insert(g);
            }
        }
    }
    let all = model.normals.iter();
    all.filter(|n| beyond.contains(&n.grid)).collect()
}
