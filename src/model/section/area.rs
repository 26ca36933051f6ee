//! Area integrals of rectangles and polygons.

/// Area, centroid and second moments about the centroid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub area: f64,
    /// Centroid (y, z).
    pub centroid: [f64; 2],
    /// Integral y^2 dA.
    pub yy: f64,
    /// Integral z^2 dA.
    pub zz: f64,
    /// Integral y z dA.
    pub yz: f64,
}

/// A rectangle from low to high in y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rectangle {
    pub y: [f64; 2],
    pub z: [f64; 2],
}

impl Rectangle {
    fn polygon(self) -> [[f64; 2]; 4] {
        let ([y0, y1], [z0, z1]) = (self.y, self.z);
        [[y0, z0], [y1, z0], [y1, z1], [y0, z1]]
    }
}

/// The area of rectangles that don't overlap.
pub(super) fn of_rectangles(parts: &[Rectangle]) -> Area {
    let polygons: Vec<Vec<[f64; 2]>> = parts.iter().map(|r| r.polygon().to_vec()).collect();
    of_polygons(&polygons)
}

/// Returns the area of polygons (y, z) that don't overlap, corners in either turn.
///
/// Sums over the sides of a polygon (Green's theorem) about the origin, moved to the centroid at the end.
pub(super) fn of_polygons(polygons: &[Vec<[f64; 2]>]) -> Area {
    let mut sum = [0.0_f64; 6];
    for p in polygons {
        let mut s = [0.0_f64; 6];
        for (a, b) in p.iter().zip(p.iter().cycle().skip(1)) {
            let ([y0, z0], [y1, z1]) = (*a, *b);
            let c = y0 * z1 - y1 * z0;
            s[0] += c / 2.0;
            s[1] += c * (y0 + y1) / 6.0;
            s[2] += c * (z0 + z1) / 6.0;
            s[3] += c * (y0 * y0 + y0 * y1 + y1 * y1) / 12.0;
            s[4] += c * (z0 * z0 + z0 * z1 + z1 * z1) / 12.0;
            s[5] += c * (y0 * z1 + 2.0 * y0 * z0 + 2.0 * y1 * z1 + y1 * z0) / 24.0;
        }
        let turn = s[0].signum();
        sum.iter_mut().zip(s).for_each(|(t, v)| *t += turn * v);
    }
    let [area, sy, sz, yy, zz, yz] = sum;
    let centroid = [sy / area, sz / area];
    Area {
        area,
        centroid,
        yy: yy - area * centroid[0] * centroid[0],
        zz: zz - area * centroid[1] * centroid[1],
        yz: yz - area * centroid[0] * centroid[1],
    }
}
