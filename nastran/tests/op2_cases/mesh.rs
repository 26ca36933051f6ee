//! Compares cards of the geometry blocks with the mesh of pyNastran, which comes from the same blocks or from the deck of the run.

use nastran::cards::{
    Cards, CoordDefinition, CoordKind, MaterialAngle, ShellShape, SolidShape, SpringStiffness,
};
use nastran::op2::Op2;
use serde_json::Value;

/// Compares a case. Returns whether it has geometry blocks.
pub(crate) fn compare(case: &str, op2: &Op2<'_>, expected: &Value) -> bool {
    let (cards, notes) = op2.cards();
    let mesh = &expected["mesh"];
    if cards.grids.is_empty() || mesh.is_null() {
        return false;
    }
    let from_blocks = expected["mesh_source"] == "op2 geometry blocks";
    for (name, count) in mesh["cards"].as_object().unwrap() {
        // Decks may contain items that the solver does not write: unused cards and defaults.
        if let Some(got) = count_of(&cards, name) {
            // Springs between scalar points count together with springs between grids.
            let alike = match name.as_str() {
                "CELAS1" => &mesh["cards"]["CELAS3"],
                "CELAS2" => &mesh["cards"]["CELAS4"],
                _ => &Value::Null,
            };
            let want = (count.as_u64().unwrap() + alike.as_u64().unwrap_or(0)) as usize;
            // A deck that was edited after the run may contain more cards.
            let fits = if from_blocks {
                got == want
            } else {
                got <= want || may_differ(name)
            };
            assert!(fits, "{case}: {got} {name}, pyNastran {want}; {notes:?}");
        }
    }
    let missing = mesh["nodes"]
        .as_u64()
        .unwrap()
        .abs_diff(cards.grids.len() as u64);
    assert!(
        missing == 0 || (missing == 1 && !from_blocks),
        "{case}: grids"
    );
    for want in mesh["grids"].as_array().unwrap() {
        let Some(grid) = cards.grids.iter().find(|g| want["id"] == g.id) else {
            assert!(missing > 0, "{case}: no grid {}", want["id"]);
            continue;
        };
        // pyNastran replaces an explicit 0 by the value of GRDSET.
        let cd = grid.cd.unwrap();
        assert!(
            want["cd"] == cd || (cd == 0 && !from_blocks),
            "{case}: grid {} has cd {cd}",
            grid.id
        );
        let got = basic(&cards, grid.cp.unwrap(), grid.x, 0);
        for (w, g) in want["xyz_basic"].as_array().unwrap().iter().zip(got) {
            // The file has coordinates of the deck rounded to 32 bits.
            let w = w.as_f64().unwrap();
            assert!(
                (w - g).abs() <= 3e-7 * (1.0 + got.iter().fold(0.0, |a: f64, x| a.max(x.abs()))),
                "{case}: grid {}: {g}, pyNastran {w}",
                grid.id
            );
        }
    }
    for want in mesh["cquad4_frames"].as_array().unwrap_or(&Vec::new()) {
        let shell = cards
            .shells
            .iter()
            .find(|s| want["eid"] == s.id)
            .unwrap_or_else(|| panic!("{case}: no shell {}", want["eid"]));
        assert_eq!(
            want["pid"],
            shell.pid.unwrap(),
            "{case}: element {}",
            shell.id
        );
        let nodes: Vec<u64> = want["nodes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|n| n.as_u64().unwrap())
            .collect();
        assert!(
            nodes
                .iter()
                .zip(shell.grids)
                .all(|(w, g)| *w == u64::from(g)),
            "{case}: element {}: {nodes:?} {:?}",
            shell.id,
            shell.grids
        );
        match shell.angle {
            MaterialAngle::Mcid(cid) => assert_eq!(
                want["theta_mcid"].as_u64(),
                Some(u64::from(cid)),
                "{case}: element {}",
                shell.id
            ),
            MaterialAngle::Theta(theta) => {
                let w = want["theta_mcid"].as_f64().unwrap();
                assert!(
                    (w - theta).abs() <= 1e-6 * (1.0 + w.abs()),
                    "{case}: element {}: theta {theta}, pyNastran {w}",
                    shell.id
                );
            }
        }
    }
    true
}

/// Returns whether decks and files count cards with this name differently.
///
/// Examples are a grid that occurs twice, several SPC1 in one, PCOMP with their PSHELL, and parameters of the solver.
fn may_differ(name: &str) -> bool {
    matches!(
        name,
        "SPC"
            | "SPC1"
            | "SPCADD"
            | "PARAM"
            | "SUPORT"
            | "PELAS"
            | "PLOAD4"
            | "LOAD"
            | "PLOAD2"
            | "MPC"
            | "PCOMP"
    )
}

/// Returns the number of cards with this name, or `None` for a name without stored cards.
fn count_of(c: &Cards, name: &str) -> Option<usize> {
    let shells = |shape| c.shells.iter().filter(|s| s.shape == shape).count();
    let solids = |shape| c.solids.iter().filter(|s| s.shape == shape).count();
    let direct = |yes| {
        c.springs
            .iter()
            .filter(|s| matches!(s.stiffness, SpringStiffness::Direct { .. }) == yes)
            .count()
    };
    let coords = |kind, points| {
        c.coords
            .iter()
            .filter(|x| {
                x.kind == kind && matches!(x.definition, CoordDefinition::Points { .. }) == points
            })
            .count()
    };
    Some(match name {
        "GRID" => c.grids.len(),
        "CQUAD4" => shells(ShellShape::Quad4),
        "CQUADR" => shells(ShellShape::QuadR),
        "CQUAD8" => shells(ShellShape::Quad8),
        "CTRIA3" => shells(ShellShape::Tria3),
        "CTRIAR" => shells(ShellShape::TriaR),
        "CTRIA6" => shells(ShellShape::Tria6),
        "CSHEAR" => c.shear_panels.len(),
        "CBAR" => c.bars.len(),
        "CBEAM" => c.beams.len(),
        "CROD" => c.rods.iter().filter(|r| !r.is_tube).count(),
        "CTUBE" => c.rods.iter().filter(|r| r.is_tube).count(),
        "CONROD" => c.conrods.len(),
        "CBUSH" => c.bushes.len(),
        "CELAS1" => direct(false),
        "CELAS2" => direct(true),
        "CTETRA" => solids(SolidShape::Tetra),
        "CPENTA" => solids(SolidShape::Penta),
        "CHEXA" => solids(SolidShape::Hexa),
        "CPYRAM" => solids(SolidShape::Pyram),
        "CONM1" => c.conm1s.len(),
        "CONM2" => c.conm2s.len(),
        "RBAR" => c.rbars.len(),
        "RBE1" => c.rbe1s.len(),
        "RBE2" => c.rbe2s.len(),
        "RBE3" => c.rbe3s.len(),
        "MPC" => c.mpcs.len(),
        "SPC" => c.spcs.len(),
        "SPC1" => c.spc1s.len(),
        "SPCADD" => c.spcadds.len(),
        "SUPORT" => c.suports.len(),
        "FORCE" => c.forces.len(),
        "MOMENT" => c.moments.len(),
        "PLOAD1" => c.pload1s.len(),
        "PLOAD2" => c.pload2s.len(),
        "PLOAD4" => c.pload4s.len(),
        "GRAV" => c.gravs.len(),
        "LOAD" => c.loads.len(),
        "TEMPD" => c.tempds.len(),
        "PSHELL" => c.pshells.len(),
        "PCOMP" => c.pcomps.len(),
        "PSHEAR" => c.pshears.len(),
        "PBAR" => c.pbars.len(),
        "PBARL" => c.pbarls.len(),
        "PBEAM" => c.pbeams.len(),
        "PBEAML" => c.pbeamls.len(),
        "PROD" => c.prods.len(),
        "PTUBE" => c.ptubes.len(),
        "PBUSH" => c.pbushes.len(),
        "PELAS" => c.pelas.len(),
        "PSOLID" => c.psolids.len(),
        "MAT1" => c.mat1s.len(),
        "MAT8" => c.mat8s.len(),
        "MAT9" => c.mat9s.len(),
        "CORD1R" => coords(CoordKind::Rectangular, false),
        "CORD2R" => coords(CoordKind::Rectangular, true),
        "CORD2C" => coords(CoordKind::Cylindrical, true),
        "CORD2S" => coords(CoordKind::Spherical, true),
        _ => return None,
    })
}

/// Returns a point of system `cid` in the basic system.
fn basic(cards: &Cards, cid: u32, x: [f64; 3], depth: usize) -> [f64; 3] {
    if cid == 0 {
        return x;
    }
    assert!(depth < 20, "coordinate systems refer to each other");
    let coord = cards
        .coords
        .iter()
        .find(|c| c.id == cid)
        .unwrap_or_else(|| panic!("no coordinate system {cid}"));
    let (a, b, c) = match coord.definition {
        CoordDefinition::Points { rid, a, b, c } => (
            basic(cards, rid, a, depth + 1),
            basic(cards, rid, b, depth + 1),
            basic(cards, rid, c, depth + 1),
        ),
        CoordDefinition::Grids(ids) => {
            let [a, b, c] = ids.map(|id| {
                let g = cards.grids.iter().find(|g| g.id == id).unwrap();
                basic(cards, g.cp.unwrap(), g.x, depth + 1)
            });
            (a, b, c)
        }
    };
    let sub = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let cross = |p: [f64; 3], q: [f64; 3]| {
        [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ]
    };
    let unit = |p: [f64; 3]| {
        let n = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
        p.map(|v| v / n)
    };
    let k = unit(sub(b, a));
    let j = unit(cross(k, sub(c, a)));
    let i = cross(j, k);
    let local = match coord.kind {
        CoordKind::Rectangular => x,
        CoordKind::Cylindrical => [
            x[0] * x[1].to_radians().cos(),
            x[0] * x[1].to_radians().sin(),
            x[2],
        ],
        CoordKind::Spherical => {
            let (theta, phi) = (x[1].to_radians(), x[2].to_radians());
            [
                x[0] * theta.sin() * phi.cos(),
                x[0] * theta.sin() * phi.sin(),
                x[0] * theta.cos(),
            ]
        }
    };
    std::array::from_fn(|n| a[n] + local[0] * i[n] + local[1] * j[n] + local[2] * k[n])
}
