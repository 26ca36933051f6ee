//! The frame in which shell strain is reported.

use crate::model::{Mat3, Vec3};

/// Returns the rows x, y, z of the output frame in basic, from the corners.
///
/// Four corners: x = unit(unit(d13) - unit(d24)), z = unit(d13 x d24) (the bisector frame that MSC and NX use when OMID is absent).
/// Three corners: x along side 1-2, z = unit(side 12 x side 13). `None` where the corners span no area.
pub(crate) fn output_frame(corners: &[Vec3]) -> Option<Mat3> {
    let (x, z) = match corners {
        [a, b, c] => (b - a, (b - a).cross(&(c - a))),
        [a, b, c, d] => {
            let (d13, d24) = (c - a, d - b);
            (
                d13.try_normalize(0.0)? - d24.try_normalize(0.0)?,
                d13.cross(&d24),
            )
        }
        _ => return None,
    };
    let longest = corners
        .iter()
        .map(|c| (c - corners[0]).norm_squared())
        .fold(0.0, f64::max);
    if !(z.norm() > 1e-12 * longest) {
        return None;
    }
    let z = z.try_normalize(0.0)?;
    let x = (x - z * x.dot(&z)).try_normalize(0.0)?;
    Some(Mat3::from_rows(&[
        x.transpose(),
        z.cross(&x).transpose(),
        z.transpose(),
    ]))
}
