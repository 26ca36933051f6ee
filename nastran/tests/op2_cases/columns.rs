//! Converts the result and column names of pyNastran to those of this crate.

use nastran::results::Quantity;

/// Returns the quantity of a result of pyNastran. Fails for a name that is neither known nor listed as omitted.
pub fn quantity(result: &str) -> Quantity {
    match result {
        "displacements" => Quantity::Displacement,
        "velocities" => Quantity::Velocity,
        "accelerations" => Quantity::Acceleration,
        "eigenvectors" => Quantity::Eigenvector,
        "spc_forces" => Quantity::SpcForce,
        "mpc_forces" => Quantity::MpcForce,
        "load_vectors" | "applied_loads" => Quantity::AppliedLoad,
        "grid_point_forces" => Quantity::GridPointForce,
        _ => match result.split_once('.') {
            Some(("strain", what)) if what.contains("composite") => Quantity::PlyStrain,
            Some(("stress", what)) if what.contains("composite") => Quantity::PlyStress,
            Some(("strain", _)) => Quantity::Strain,
            Some(("stress", _)) => Quantity::Stress,
            Some(("force", _)) => Quantity::ElementForce,
            _ => {
                panic!("no quantity for pyNastran's {result}: add it to tests/op2_cases/columns.rs")
            }
        },
    }
}

/// Returns the position of each column of pyNastran among the columns of this crate.
pub fn positions(result: &str, theirs: &[&str], ours: &[&str]) -> Vec<usize> {
    theirs
        .iter()
        .map(|name| {
            let alias = alias(result, name);
            ours.iter()
                .position(|o| {
                    if alias.is_empty() {
                        o == name
                    } else {
                        alias.contains(o)
                    }
                })
                .unwrap_or_else(|| {
                    panic!("{result}: no column for pyNastran's {name} among {ours:?}")
                })
        })
        .collect()
}

/// Returns the column names of this crate for a column of pyNastran, if they differ.
fn alias(result: &str, name: &str) -> &'static [&'static str] {
    let force = result.starts_with("force");
    let solid = ["ctetra", "cpenta", "chexa", "cpyram"]
        .iter()
        .any(|e| result.contains(e));
    match name {
        "fiber_curvature" | "fiber_distance" => &["fiber"],
        "exy" => &["gxy", "xy"],
        "exx" | "oxx" if solid => &["xx"],
        "eyy" | "oyy" if solid => &["yy"],
        "ezz" | "ozz" => &["zz"],
        "txy" if solid => &["xy"],
        "eyz" | "tyz" => &["yz"],
        "exz" | "txz" => &["zx"],
        "emid" | "omid" => &["mid"],
        "emax" | "omax" if solid => &["max"],
        "emin" | "omin" if solid => &["min"],
        "von_mises" => &["vm"],
        "max_shear" if result.contains("cshear") => &["max"],
        "max_shear" if result.contains("composite") => &["vm"],
        "o11" | "e11" => &["s11"],
        "o22" | "e22" => &["s22"],
        "t12" | "e12" => &["s12"],
        "t1z" | "e1z" => &["s1z"],
        "t2z" | "e2z" => &["s2z"],
        "max_shear" => &["vm"],
        "avg_shear" => &["average"],
        "major" => &["smax"],
        "minor" => &["smin"],
        "SMa" => &["msa"],
        "SMt" => &["mst"],
        "MS" => &["ms"],
        "MS_tension" => &["mst"],
        "MS_compression" => &["msc"],
        "e1a" => &["s1a"],
        "e2a" => &["s2a"],
        "e3a" => &["s3a"],
        "e4a" => &["s4a"],
        "e1b" => &["s1b"],
        "e2b" => &["s2b"],
        "e3b" => &["s3b"],
        "e4b" => &["s4b"],
        "emaxa" => &["smaxa"],
        "emina" => &["smina"],
        "emaxb" => &["smaxb"],
        "eminb" => &["sminb"],
        "spring_strain" | "spring_stress" | "spring_force" => &["value"],
        "sd" | "station" => &["x_xb"],
        "sxc" if result.contains("10nodes") => &["s1"],
        "sxd" if result.contains("10nodes") => &["s2"],
        "sxe" if result.contains("10nodes") => &["s3"],
        "sxf" if result.contains("10nodes") => &["s4"],
        "mx" | "bmx" | "my" | "bmy" | "mxy" | "bmxy" if result.contains("cquad4_force") => {
            shell_force(name)
        }
        "tx" if force => &["qx"],
        "ty" if force => &["qy"],
        "fx" => &["t1"],
        "fy" => &["t2"],
        "mx" => &["r1"],
        "my" => &["r2"],
        "tx" | "force_x" => &["t1"],
        "ty" | "force_y" => &["t2"],
        "tz" | "force_z" | "fz" => &["t3"],
        "rx" | "moment_x" => &["r1"],
        "ry" | "moment_y" => &["r2"],
        "rz" | "moment_z" | "mz" => &["r3"],
        "f1" => &["t1"],
        "f2" => &["t2"],
        "f3" => &["t3"],
        "m1" if !force => &["r1"],
        "m2" if !force => &["r2"],
        "m3" => &["r3"],
        "bending_moment_a1" => &["m1a"],
        "bending_moment_a2" => &["m2a"],
        "bending_moment_b1" => &["m1b"],
        "bending_moment_b2" => &["m2b"],
        "bending_moment1" => &["m1"],
        "bending_moment2" => &["m2"],
        "axial_force" => &["axial"],
        "total_torque" => &["torque"],
        _ => &[],
    }
}

/// pyNastran calls the membrane forces of shells mx, my, mxy and the bending moments bmx, bmy, bmxy.
fn shell_force(name: &str) -> &'static [&'static str] {
    match name {
        "mx" => &["fx"],
        "my" => &["fy"],
        "mxy" => &["fxy"],
        "bmx" => &["mx"],
        "bmy" => &["my"],
        _ => &["mxy"],
    }
}
