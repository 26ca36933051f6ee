//! Variance of a gauge's reading at one place as a function of its angle, and its largest value over all angles.
//!
//! The row of angle `t` is `c(t)' T`, `c = (cos^2 t, sin^2 t, sin t cos t)`, so any quadratic form of it is a trigonometric polynomial of
//! degree two in `u = 2 t`: `a0 + a1 cos u + b1 sin u + a2 cos 2u + b2 sin 2u`.

/// Coefficients `[a0, a1, b1, a2, b2]`.
pub type Trig = [f64; 5];

/// Symmetric 3 x 3 forms as `[xx, yy, gg, xy, xg, yg]` over (exx, eyy, gxy).
pub type Form = [f64; 6];

/// Returns the form `c(t)' G c(t)`.
pub fn of_row(g: &Form) -> Trig {
    let [xx, yy, gg, xy, xg, yg] = *g;
    let pp = xx + yy + 2.0 * xy;
    let mm = xx + yy - 2.0 * xy;
    [
        0.25 * (pp + 0.5 * (mm + gg)),
        0.5 * (xx - yy),
        0.5 * (xg + yg),
        0.125 * (mm - gg),
        0.25 * (xg - yg),
    ]
}

/// Returns the form `c'(t)' H c'(t)`, with `c'` the derivative by the angle `t` in radians.
pub fn of_slope(h: &Form) -> Trig {
    let [xx, yy, gg, xy, xg, yg] = *h;
    let mm = xx + yy - 2.0 * xy;
    [0.5 * (mm + gg), 0.0, 0.0, 0.5 * (gg - mm), -(xg - yg)]
}

/// Returns the value at the angle whose double has these cosines and sines (`[cos u, sin u, cos 2u, sin 2u]`).
pub fn value(p: &Trig, cs: &[f64; 4]) -> f64 {
    p[0] + p[1] * cs[0] + p[2] * cs[1] + p[3] * cs[2] + p[4] * cs[3]
}

/// Returns `[cos u, sin u, cos 2u, sin 2u]` of the angle `t`, with `u = 2 t`.
pub fn phases(t: f64) -> [f64; 4] {
    let (s, c) = (2.0 * t).sin_cos();
    [c, s, c * c - s * s, 2.0 * s * c]
}

/// Samples over half a turn from which the search starts.
pub const SAMPLES: usize = 16;

/// Returns by how much a polynomial can exceed the larger of two neighbouring samples: `h^2/8 max |p''|` in `u`.
fn overshoot(p: &Trig, h: f64) -> f64 {
    h * h / 8.0 * (p[1].hypot(p[2]) + 4.0 * p[3].hypot(p[4]))
}

fn subtract_scaled(f: &Trig, v: &Trig, lambda: f64) -> Trig {
    std::array::from_fn(|i| f[i] - lambda * v[i])
}

/// Returns whether `f / v` is certainly below `limit` at every angle (`v` is positive).
pub fn stays_under(f: &Trig, v: &Trig, limit: f64, samples: &[[f64; 4]; SAMPLES]) -> bool {
    let g = subtract_scaled(f, v, limit);
    let slack = overshoot(&g, std::f64::consts::TAU / SAMPLES as f64);
    samples.iter().all(|cs| value(&g, cs) + slack < 0.0)
}

/// Relative amount by which [`largest_ratio`] may return more than the true maximum, so that it is never less.
const CERTIFIED_EXCESS: f64 = 1e-7;

/// Returns the angle in `[0, pi)` where `f / v` is largest, and an upper bound of this maximum (at most `1e-7` relative above it).
pub fn largest_ratio(f: &Trig, v: &Trig, samples: &[[f64; 4]; SAMPLES]) -> (f64, f64) {
    let ratio = |t: f64| {
        let cs = phases(t);
        value(f, &cs) / value(v, &cs)
    };
    let step = std::f64::consts::PI / SAMPLES as f64;
    let at: [f64; SAMPLES] = std::array::from_fn(|i| value(f, &samples[i]) / value(v, &samples[i]));
    let mut best = (f64::NEG_INFINITY, 0.0);
    for i in 0..SAMPLES {
        if at[i] >= at[(i + 1) % SAMPLES] && at[i] >= at[(i + SAMPLES - 1) % SAMPLES] {
            let t = local_maximum(&ratio, step * i as f64, step);
            let r = ratio(t);
            if r > best.0 {
                best = (r, t);
            }
        }
    }
    // Certify the maximum: f - lambda v must be negative everywhere. A positive point is a better lambda.
    for _ in 0..8 {
        let g = subtract_scaled(f, v, best.0 * (1.0 + CERTIFIED_EXCESS) + f64::MIN_POSITIVE);
        match first_above(&g, 0.0, std::f64::consts::TAU, 0) {
            None => break,
            Some(u) => {
                let t = local_maximum(&ratio, u / 2.0, step / 4.0);
                if ratio(t) <= best.0 {
                    break;
                }
                best = (ratio(t), t);
            }
        }
    }
    (
        best.1.rem_euclid(std::f64::consts::PI),
        best.0 * (1.0 + CERTIFIED_EXCESS),
    )
}

/// Golden-section search in `[t - h, t + h]`.
fn local_maximum(f: &impl Fn(f64) -> f64, t: f64, h: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (t - h, t + h);
    let (mut x, mut y) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..36 {
        if fx >= fy {
            (b, y, fy) = (y, x, fx);
            x = b - GOLDEN * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + GOLDEN * (b - a);
            fy = f(y);
        }
    }
    0.5 * (a + b)
}

/// A point `u` in `[a, b]` where `g > 0`, found by halving; `None` where `g <= 0` is proved down to the rounding of `g`.
fn first_above(g: &Trig, a: f64, b: f64, depth: u32) -> Option<f64> {
    let at = |u: f64| value(g, &phases(u / 2.0));
    let mid = 0.5 * (a + b);
    if at(mid) > 0.0 {
        return Some(mid);
    }
    if depth > 3 && at(a).max(at(b)) + overshoot(g, b - a) <= 0.0 {
        return None;
    }
    // Below this width the overshoot is under the rounding error of g itself.
    if depth > 26 {
        return None;
    }
    first_above(g, a, mid, depth + 1).or_else(|| first_above(g, mid, b, depth + 1))
}
