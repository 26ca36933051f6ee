//! Properties of bars and beams.

use super::fields::Fields;
use crate::cards::{BeamStation, BeamlStation, Pbar, Pbarl, Pbeam, Pbeaml};

/// Reads PBAR: `pid mid a i1 i2 j nsm fe c1 c2 d1 d2 e1 e2 f1 f2 k1 k2 i12`.
pub(super) fn pbar(f: &mut Fields<'_>) -> Option<Pbar> {
    let (id, mid) = (f.id()?, f.id()?);
    let [area, i1, i2, j, nsm, _] = f.reals()?;
    let recovery = [f.reals()?, f.reals()?, f.reals()?, f.reals()?];
    Some(Pbar {
        id,
        mid,
        area,
        i1,
        i2,
        j,
        nsm,
        recovery,
        k: [or_blank(f)?, or_blank(f)?],
        i12: f.read_real()?,
    })
}

/// Reads PBARL: `pid mid group group type type dimensions.. nsm -1`.
pub(super) fn pbarl(f: &mut Fields<'_>) -> Option<Pbarl> {
    let (id, mid, section, mut dims) = section(f)?;
    let nsm = dims.pop()?;
    Some(Pbarl {
        id,
        mid,
        section,
        dims,
        nsm,
    })
}

/// Reads PBEAML: the beginning of PBARL, then `so x/xb dimensions.. nsm` at each of up to 11 stations. Unused stations are zero.
pub(super) fn pbeaml(f: &mut Fields<'_>) -> Option<Pbeaml> {
    let (id, mid, section, values) = section(f)?;
    let width = n_dims(&section)?.checked_add(3)?;
    let mut stations: Vec<BeamlStation> = Vec::new();
    for station in values.chunks_exact(width) {
        let [so, x_xb, dims @ .., nsm] = station else {
            return None;
        };
        if !stations.iter().any(|s| s.x_xb == *x_xb) {
            stations.push(BeamlStation {
                x_xb: *x_xb,
                output: *so != 0.0,
                dims: dims.to_vec(),
                nsm: *nsm,
            });
        }
    }
    stations.sort_by(|a, b| a.x_xb.total_cmp(&b.x_xb));
    (!stations.is_empty()).then_some(Pbeaml {
        id,
        mid,
        section,
        stations,
    })
}

/// Reads PBEAM: `pid mid n ccf x`, 11 stations of `so x/xb a i1 i2 i12 j nsm c1 c2 d1 d2 e1 e2 f1 f2`, then
/// `k1 k2 s1 s2 nsi(a) nsi(b) cw(a) cw(b) m1(a) m2(a) m1(b) m2(b) n1(a) n2(a) n1(b) n2(b)`. `None` for a PBCOMP, which has the same form with other
/// numbers instead of `so`.
pub(super) fn pbeam(f: &mut Fields<'_>) -> Option<Pbeam> {
    let (id, mid) = (f.id()?, f.id()?);
    f.skip(3)?;
    let mut stations: Vec<BeamStation> = Vec::new();
    for _ in 0..11 {
        let [so, x_xb, area, i1, i2, i12, j, nsm] = f.reals()?;
        let recovery = [f.reals()?, f.reals()?, f.reals()?, f.reals()?];
        if !(so == 0.0 || so == 1.0) || !(0.0..=1.0).contains(&x_xb) {
            return None;
        }
        if stations.is_empty() || (x_xb > 0.0 && !stations.iter().any(|s| s.x_xb == x_xb)) {
            stations.push(BeamStation {
                x_xb,
                output: so == 1.0,
                area,
                i1,
                i2,
                i12,
                j,
                nsm,
                recovery,
            });
        }
    }
    stations.sort_by(|a, b| a.x_xb.total_cmp(&b.x_xb));
    // A station without stress output states no points; it takes the points of end A, as in a deck.
    let points_a = stations.first().map_or([[0.0; 2]; 4], |s| s.recovery);
    for station in stations.iter_mut().filter(|s| !s.output) {
        station.recovery = points_a;
    }
    if let Some(last) = stations.last().filter(|s| s.x_xb < 1.0).copied() {
        stations.push(BeamStation { x_xb: 1.0, ..last });
    }
    let k = [Some(f.read_real()?), Some(f.read_real()?)];
    let s = f.reals()?;
    let mut pairs = [[None; 2]; 6];
    for value in pairs.as_flattened_mut() {
        *value = f.blank_or_real()?;
    }
    let [nsi, cw, ma, mb, na, nb] = pairs;
    Some(Pbeam {
        id,
        mid,
        stations,
        k,
        s,
        nsi,
        cw,
        m: [ma, mb],
        n: [na, nb],
    })
}

/// Reads property, material, type, and the values up to -1.
fn section(f: &mut Fields<'_>) -> Option<(u32, u32, String, Vec<f64>)> {
    let (id, mid) = (f.id()?, f.id()?);
    f.skip(2)?;
    let kind = f.text(2)?;
    let mut values = Vec::new();
    while f.peek()? != -1 {
        values.push(f.read_real()?);
    }
    f.skip(1)?;
    Some((id, mid, kind, values))
}

/// Returns the number of dimensions of a PBEAML section type.
fn n_dims(section: &str) -> Option<usize> {
    Some(match section {
        "ROD" => 1,
        "TUBE" | "BAR" | "TUBE2" => 2,
        "HEXA" => 3,
        "CHAN" | "T" | "BOX" | "CROSS" | "H" | "T1" | "I1" | "CHAN1" | "Z" | "CHAN2" | "T2"
        | "HAT" | "L" => 4,
        "HAT1" => 5,
        "I" | "BOX1" => 6,
        "DBOX" => 10,
        _ => return None,
    })
}

fn or_blank(f: &mut Fields<'_>) -> Option<Option<f64>> {
    Some(f.blank_or_real()?.filter(|x| *x != 0.0))
}
