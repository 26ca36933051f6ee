//! Integration points of triangles.

/// Points of degree 5 on the triangle with corners (0, 0), (1, 0) and (0, 1): r, s, weight. The weights sum to 1/2.
///
/// # Reference
/// J. Radon, Zur mechanischen Kubatur, Monatshefte für Mathematik 52 (1948).
pub(super) const RADON: [(f64, f64, f64); 7] = {
    const A: f64 = 0.101_286_507_323_456_3;
    const B: f64 = 0.470_142_064_105_115_1;
    const WA: f64 = 0.062_969_590_272_413_6;
    const WB: f64 = 0.066_197_076_394_253_1;
    [
        (1.0 / 3.0, 1.0 / 3.0, 0.1125),
        (A, A, WA),
        (1.0 - 2.0 * A, A, WA),
        (A, 1.0 - 2.0 * A, WA),
        (B, B, WB),
        (1.0 - 2.0 * B, B, WB),
        (B, 1.0 - 2.0 * B, WB),
    ]
};
