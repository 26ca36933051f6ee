//! MAT1, MAT2, MAT8, MAT9.

use super::super::fields::Fields;
use crate::cards::{Mat1, Mat2, Mat8, Mat9};

pub(super) fn mat1(f: &mut Fields) -> Mat1 {
    Mat1 {
        id: f.id(0, "MID"),
        e: f.opt_real(1, "E"),
        g: f.opt_real(2, "G"),
        nu: f.opt_real(3, "NU"),
        rho: f.real_or(4, "RHO", 0.0),
        alpha: f.real_or(5, "A", 0.0),
        tref: f.real_or(6, "TREF", 0.0),
        ge: f.real_or(7, "GE", 0.0),
        limits: [
            f.opt_real(8, "ST"),
            f.opt_real(9, "SC"),
            f.opt_real(10, "SS"),
        ],
    }
}

pub(super) fn mat2(f: &mut Fields) -> Mat2 {
    Mat2 {
        id: f.id(0, "MID"),
        g: f.reals(1, ["G11", "G12", "G13", "G22", "G23", "G33"]),
        rho: f.real_or(7, "RHO", 0.0),
        alpha: f.reals(8, ["A1", "A2", "A3"]),
        tref: f.real_or(11, "TREF", 0.0),
        ge: f.real_or(12, "GE", 0.0),
    }
}

pub(super) fn mat8(f: &mut Fields) -> Mat8 {
    Mat8 {
        id: f.id(0, "MID"),
        e1: f.required_real(1, "E1"),
        e2: f.required_real(2, "E2"),
        nu12: f.real_or(3, "NU12", 0.0),
        g12: f.real_or(4, "G12", 0.0),
        g1z: f.opt_real(5, "G1Z"),
        g2z: f.opt_real(6, "G2Z"),
        rho: f.real_or(7, "RHO", 0.0),
        alpha: f.reals(8, ["A1", "A2"]),
        tref: f.real_or(10, "TREF", 0.0),
    }
}

pub(super) fn mat9(f: &mut Fields) -> Mat9 {
    Mat9 {
        id: f.id(0, "MID"),
        g: std::array::from_fn(|k| f.real_or(1 + k, "G", 0.0)),
        rho: f.real_or(22, "RHO", 0.0),
        alpha: f.reals(23, ["A1", "A2", "A3", "A4", "A5", "A6"]),
        tref: f.real_or(29, "TREF", 0.0),
        ge: f.real_or(30, "GE", 0.0),
    }
}
