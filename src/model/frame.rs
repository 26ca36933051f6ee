//! Coordinate systems: from their own coordinates and axes to basic.

use super::types::{Frame, Mat3, Vec3};
use nastran::cards::CoordKind;

/// Share of the distance to the origin under which a point counts as on the axis of a cylindrical or spherical system.
const ON_AXIS: f64 = 1e-12;

impl Frame {
    /// Returns the basic frame.
    pub fn basic() -> Frame {
        Frame {
            id: 0,
            kind: CoordKind::Rectangular,
            origin: Vec3::zeros(),
            axes: Mat3::identity(),
        }
    }

    /// Returns the frame with the origin A, a point B on z and a point C in the x-z plane, all in basic coordinates. `None` if the three points are
    /// collinear.
    pub fn from_points(id: u32, kind: CoordKind, a: Vec3, b: Vec3, c: Vec3) -> Option<Frame> {
        let z = unit(b - a)?;
        let to_c = c - a;
        let y = z.cross(&to_c);
        // Tests the sine of the angle between both directions against the rounding of the points.
        if !(y.norm() > 1e-9 * to_c.norm()) {
            return None;
        }
        let y = unit(y)?;
        let x = y.cross(&z);
        Some(Frame {
            id,
            kind,
            origin: a,
            axes: Mat3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]),
        })
    }

    /// Returns the basic location of a point given in this system's coordinates. Angles are in degrees.
    ///
    /// Theta of a cylindrical system is about z. Theta of a spherical system is from z, and phi is about z.
    ///
    /// # Example
    /// ```
    /// use nastran::cards::CoordKind;
    /// use strainbridge::model::{Frame, Vec3};
    ///
    /// let cylinder = Frame { kind: CoordKind::Cylindrical, ..Frame::basic() };
    /// let x = cylinder.to_basic([2.0, 90.0, 5.0]);
    /// assert!((x - Vec3::new(0.0, 2.0, 5.0)).norm() < 1e-12);
    /// // There the first axis is radial and the second tangential.
    /// let tangential = cylinder.vector_to_basic([0.0, 1.0, 0.0], x);
    /// assert!((tangential - Vec3::new(-1.0, 0.0, 0.0)).norm() < 1e-12);
    /// let sphere = Frame { kind: CoordKind::Spherical, ..Frame::basic() };
    /// assert!((sphere.to_basic([2.0, 90.0, 90.0]) - Vec3::new(0.0, 2.0, 0.0)).norm() < 1e-12);
    /// ```
    pub fn to_basic(&self, x: [f64; 3]) -> Vec3 {
        let [a, b, c] = x;
        let local = match self.kind {
            CoordKind::Rectangular => Vec3::new(a, b, c),
            CoordKind::Cylindrical => {
                let (s, co) = b.to_radians().sin_cos();
                Vec3::new(a * co, a * s, c)
            }
            CoordKind::Spherical => {
                let (st, ct) = b.to_radians().sin_cos();
                let (sp, cp) = c.to_radians().sin_cos();
                Vec3::new(a * st * cp, a * st * sp, a * ct)
            }
        };
        self.origin + self.axes.tr_mul(&local)
    }

    /// Returns the axes of vector components at the basic location `x`, by rows. A rectangular system has its own axes. A cylindrical system has the
    /// radial, tangential and z axes, a spherical system the radial, theta and phi axes. The angle of a point on the axis is 0.
    pub fn axes_at(&self, x: Vec3) -> Mat3 {
        if self.kind == CoordKind::Rectangular {
            return self.axes;
        }
        let p = self.axes * (x - self.origin);
        let r = p.x.hypot(p.y);
        let (cp, sp) = if r > ON_AXIS * p.norm() {
            (p.x / r, p.y / r)
        } else {
            (1.0, 0.0)
        };
        let local = match self.kind {
            CoordKind::Cylindrical => Mat3::new(cp, sp, 0.0, -sp, cp, 0.0, 0.0, 0.0, 1.0),
            _ => {
                let n = p.norm();
                let (ct, st) = if n > 0.0 {
                    (p.z / n, r / n)
                } else {
                    (1.0, 0.0)
                };
                Mat3::new(st * cp, st * sp, ct, ct * cp, ct * sp, -st, -sp, cp, 0.0)
            }
        };
        local * self.axes
    }

    /// Returns the basic vector of components counted in this system at the basic location `at`.
    pub fn vector_to_basic(&self, v: [f64; 3], at: Vec3) -> Vec3 {
        self.axes_at(at).tr_mul(&Vec3::from(v))
    }
}

/// Returns the unit vector. `None` for a vector without length.
pub(crate) fn unit(v: Vec3) -> Option<Vec3> {
    let n = v.norm();
    (n > 0.0 && n.is_finite()).then(|| v / n)
}
