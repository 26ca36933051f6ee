//! Filtering forwards and backwards: no phase, the response squared.

use super::butterworth::Section;

/// x filtered by the sections forwards, then backwards.
///
/// Ends are extended by odd reflection over 3 (2 n + 1) samples for n sections (less for first-order ones), each pass starts in
/// the steady state of its first sample: the conventions of `scipy.signal.sosfiltfilt`, so results agree to rounding.
///
/// # Reference
/// Gustafsson, Determining the initial states in forward-backward filtering, IEEE Trans. Signal Proc. 44 (1996) 988.
pub fn filtfilt(sections: &[Section], x: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 2 {
        return x.to_vec();
    }
    let zeros_b = sections.iter().filter(|s| s.b[2] == 0.0).count();
    let zeros_a = sections.iter().filter(|s| s.a[1] == 0.0).count();
    let pad = (3 * (2 * sections.len() + 1 - zeros_b.min(zeros_a))).min(n - 1);
    let mut long = Vec::with_capacity(n + 2 * pad);
    long.extend((1..=pad).rev().map(|i| 2.0 * x[0] - x[i]));
    long.extend_from_slice(x);
    long.extend((1..=pad).map(|i| 2.0 * x[n - 1] - x[n - 1 - i]));
    run(sections, &mut long);
    long.reverse();
    run(sections, &mut long);
    long.reverse();
    long[pad..pad + n].to_vec()
}

/// One pass in place (transposed direct form II), from the steady state of the first sample.
fn run(sections: &[Section], x: &mut [f64]) {
    let mut level = x.first().copied().unwrap_or(0.0);
    for Section { b, a } in sections {
        let dc = (b[0] + b[1] + b[2]) / (1.0 + a[0] + a[1]);
        let mut s2 = (b[2] - a[1] * dc) * level;
        let mut s1 = (b[1] - a[0] * dc) * level + s2;
        level *= dc;
        for v in x.iter_mut() {
            let y = b[0] * *v + s1;
            s1 = b[1] * *v - a[0] * y + s2;
            s2 = b[2] * *v - a[1] * y;
            *v = y;
        }
    }
}
