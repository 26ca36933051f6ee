//! Digital Butterworth filters as second-order sections.

use super::error::SeriesError;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// One section: H(z) = (b0 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// b0, b1, b2.
    pub b: [f64; 3],
    /// a1, a2.
    pub a: [f64; 2],
}

/// What passes, Hz (3 dB edges of one pass).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pass {
    /// Below the edge.
    Low(f64),
    /// Above the edge.
    High(f64),
    /// Between the edges.
    Band(f64, f64),
}

/// Sections of a Butterworth filter of the given order (a band-pass has twice as many poles), by the bilinear transform with
/// edges pre-warped.
///
/// # Errors
/// [`SeriesError::Band`] when an edge is not between 0 and half the sample rate.
///
/// # Reference
/// Oppenheim & Schafer, Discrete-Time Signal Processing, 3rd ed. 2010, section 7.2.
pub fn butterworth(order: usize, pass: Pass, rate_hz: f64) -> Result<Vec<Section>, SeriesError> {
    let (low, high) = match pass {
        Pass::Low(f) => (f / 2.0, f),
        Pass::High(f) => (f, (f + rate_hz / 2.0) / 2.0),
        Pass::Band(a, b) => (a, b),
    };
    if !(low > 0.0 && low < high && high < rate_hz / 2.0) {
        return Err(SeriesError::Band {
            low_hz: low,
            high_hz: high,
            rate_hz,
        });
    }
    let warp = |f: f64| 2.0 * rate_hz * (PI * f / rate_hz).tan();
    let prototype = (0..order).map(|k| {
        Complex64::from_polar(
            1.0,
            PI * (2.0 * k as f64 + order as f64 + 1.0) / (2.0 * order as f64),
        )
    });
    let analog: Vec<Complex64> = match pass {
        Pass::Low(f) => prototype.map(|p| p * warp(f)).collect(),
        Pass::High(f) => prototype.map(|p| warp(f) / p).collect(),
        Pass::Band(a, b) => {
            let (width, centre2) = (warp(b) - warp(a), warp(a) * warp(b));
            prototype
                .flat_map(|p| {
                    let half = p * (width / 2.0);
                    let root = (half * half - centre2).sqrt();
                    [half + root, half - root]
                })
                .collect()
        }
    };
    let poles: Vec<Complex64> = analog
        .iter()
        .map(|s| (2.0 * rate_hz + s) / (2.0 * rate_hz - s))
        .collect();
    let mut sections: Vec<Section> = paired(&poles)
        .into_iter()
        .map(|denominator| match (pass, denominator) {
            (Pass::Band(..), [_, _]) => Section {
                b: [1.0, 0.0, -1.0],
                a: denominator,
            },
            (Pass::Low(_), [_, 0.0]) => Section {
                b: [1.0, 1.0, 0.0],
                a: denominator,
            },
            (Pass::Low(_), _) => Section {
                b: [1.0, 2.0, 1.0],
                a: denominator,
            },
            (Pass::High(_), [_, 0.0]) => Section {
                b: [1.0, -1.0, 0.0],
                a: denominator,
            },
            (Pass::High(_), _) => Section {
                b: [1.0, -2.0, 1.0],
                a: denominator,
            },
        })
        .collect();
    let at_hz = match pass {
        Pass::Low(_) => 0.0,
        Pass::High(_) => rate_hz / 2.0,
        Pass::Band(a, b) => {
            rate_hz / PI
                * ((PI * a / rate_hz).tan() * (PI * b / rate_hz).tan())
                    .sqrt()
                    .atan()
        }
    };
    for section in &mut sections {
        let gain = 1.0 / response(std::slice::from_ref(section), at_hz, rate_hz).norm();
        section.b.iter_mut().for_each(|b| *b *= gain);
    }
    Ok(sections)
}

/// Complex response of the sections at a frequency.
pub fn response(sections: &[Section], f_hz: f64, rate_hz: f64) -> Complex64 {
    let z1 = Complex64::from_polar(1.0, -2.0 * PI * f_hz / rate_hz);
    let z2 = z1 * z1;
    sections
        .iter()
        .map(|s| (s.b[0] + s.b[1] * z1 + s.b[2] * z2) / (1.0 + s.a[0] * z1 + s.a[1] * z2))
        .product()
}

/// Denominators (a1, a2) of conjugate pairs, then of real poles two by two; a single real pole has a2 = 0.
fn paired(poles: &[Complex64]) -> Vec<[f64; 2]> {
    // A pole counts as real when its imaginary part is rounding.
    const REAL: f64 = 1e-12;
    let mut out: Vec<[f64; 2]> = poles
        .iter()
        .filter(|p| p.im > REAL)
        .map(|p| [-2.0 * p.re, p.norm_sqr()])
        .collect();
    let real: Vec<f64> = poles
        .iter()
        .filter(|p| p.im.abs() <= REAL)
        .map(|p| p.re)
        .collect();
    out.extend(real.chunks(2).map(|c| match *c {
        [p, q] => [-(p + q), p * q],
        [p] => [-p, 0.0],
        _ => [0.0, 0.0],
    }));
    out
}
