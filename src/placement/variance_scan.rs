//! The variance pass: `d_i = a_i' M^-1 a_i` of every candidate, the large ones kept.

use super::angle_variance::{self, Form, SAMPLES};
use super::candidates::{Angles, Candidates, Choice, LANES};
use rayon::prelude::*;

/// A candidate and its variance. For a continuous angle, the variance is an upper bound within 1e-7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CandidateVariance {
    /// `a' M^-1 a`.
    pub d: f64,
    /// The candidate.
    pub choice: Choice,
}

/// Candidates that a pass returns for a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// Every angle above the threshold.
    EachAngle,
    /// The best angle, if above the threshold.
    BestOfPlace,
}

/// Number of blocks in a task: fixed, so that results do not depend on the number of threads.
const CHUNK: usize = 512;

/// Returns the candidates with `d >= threshold`, by place and angle. Of each 4,096 places, it returns the `keep` largest. `linv` is the inverse of
/// the lower Cholesky factor of `M`, by rows.
pub fn price(
    c: &Candidates,
    linv: &[f64],
    threshold: f64,
    report: Report,
    keep: usize,
) -> Vec<CandidateVariance> {
    let k = c.n_loads();
    let comp = c.components();
    let w = pad(linv, k);
    let grid: Vec<f64> = match c.angles() {
        Angles::Grid(a) => a.clone(),
        _ => Vec::new(),
    };
    let phases: Vec<[f64; 4]> = grid.iter().map(|&t| angle_variance::phases(t)).collect();
    let samples: [[f64; 4]; SAMPLES] = std::array::from_fn(|i| {
        angle_variance::phases(std::f64::consts::PI * i as f64 / SAMPLES as f64)
    });
    let arch = pulp::Arch::new();
    let lists: Vec<Vec<CandidateVariance>> = c
        .blocks()
        .par_chunks((k * comp * LANES).max(1) * CHUNK)
        .enumerate()
        .map(|(chunk, data)| {
            let mut out = Vec::new();
            arch.dispatch(|| {
                for (b, block) in data.chunks_exact(k * comp * LANES).enumerate() {
                    let first = (chunk * CHUNK + b) * LANES;
                    let lanes = LANES.min(c.n_places() - first);
                    if comp == 1 {
                        let d = block_rows(&w, block, k);
                        for (lane, &raw) in d.iter().enumerate().take(lanes) {
                            let d = raw / c.fixed_variance(first + lane);
                            if d >= threshold {
                                out.push(CandidateVariance {
                                    d,
                                    choice: Choice {
                                        place: (first + lane) as u32,
                                        step: 0,
                                        angle: 0.0,
                                    },
                                });
                            }
                        }
                        continue;
                    }
                    let forms = block_tensors(&w, block, k);
                    for lane in 0..lanes {
                        let p = first + lane;
                        let g: Form = std::array::from_fn(|i| forms[i][lane]);
                        let (f, v) = (angle_variance::of_row(&g), c.variance(p));
                        if grid.is_empty() {
                            if !angle_variance::stays_under(&f, &v, threshold, &samples) {
                                let (angle, d) = angle_variance::largest_ratio(&f, &v, &samples);
                                if d >= threshold {
                                    out.push(CandidateVariance {
                                        d,
                                        choice: Choice {
                                            place: p as u32,
                                            step: 0,
                                            angle,
                                        },
                                    });
                                }
                            }
                            continue;
                        }
                        let mut best: Option<CandidateVariance> = None;
                        for (step, cs) in phases.iter().enumerate() {
                            let d = angle_variance::value(&f, cs) / angle_variance::value(&v, cs);
                            if d >= threshold {
                                let item = CandidateVariance {
                                    d,
                                    choice: Choice {
                                        place: p as u32,
                                        step: step as u16,
                                        angle: grid[step],
                                    },
                                };
                                match report {
                                    Report::EachAngle => out.push(item),
                                    Report::BestOfPlace if best.is_none_or(|b| d > b.d) => {
                                        best = Some(item)
                                    }
                                    Report::BestOfPlace => {}
                                }
                            }
                        }
                        out.extend(best);
                    }
                }
            });
            if out.len() > keep {
                out.select_nth_unstable_by(keep - 1, |a: &CandidateVariance, b| {
                    b.d.total_cmp(&a.d).then(order(a, b))
                });
                out.truncate(keep);
                out.sort_unstable_by(order);
            }
            out
        })
        .collect();
    lists.concat()
}

fn order(a: &CandidateVariance, b: &CandidateVariance) -> std::cmp::Ordering {
    (a.choice.place, a.choice.step).cmp(&(b.choice.place, b.choice.step))
}

/// Rows of the factor handled together.
const UNROLL: usize = 4;

/// `linv` with its rows padded by zeros to a multiple of [`UNROLL`].
fn pad(linv: &[f64], k: usize) -> Vec<f64> {
    let mut w = linv.to_vec();
    w.resize(k.div_ceil(UNROLL) * UNROLL * k, 0.0);
    w
}

#[inline(always)]
fn block_rows(w: &[f64], x: &[f64], k: usize) -> [f64; LANES] {
    let mut d = [0.0; LANES];
    for j in (0..k).step_by(UNROLL) {
        let mut y = [[0.0; LANES]; UNROLL];
        for (l, xl) in x.chunks_exact(LANES).take((j + UNROLL).min(k)).enumerate() {
            for (u, yu) in y.iter_mut().enumerate() {
                let c = w[(j + u) * k + l];
                for (v, &xv) in yu.iter_mut().zip(xl) {
                    *v += c * xv;
                }
            }
        }
        for yu in &y {
            for (v, &a) in d.iter_mut().zip(yu) {
                *v += a * a;
            }
        }
    }
    d
}

#[inline(always)]
fn block_tensors(w: &[f64], x: &[f64], k: usize) -> [[f64; LANES]; 6] {
    let mut g = [[0.0; LANES]; 6];
    for j in 0..k {
        let mut y = [[0.0; LANES]; 3];
        for (l, xl) in x.chunks_exact(3 * LANES).take(j + 1).enumerate() {
            let c = w[j * k + l];
            for (yc, xc) in y.iter_mut().zip(xl.chunks_exact(LANES)) {
                for (v, &xv) in yc.iter_mut().zip(xc) {
                    *v += c * xv;
                }
            }
        }
        for (form, (a, b)) in g
            .iter_mut()
            .zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)])
        {
            for (lane, v) in form.iter_mut().enumerate() {
                *v += y[a][lane] * y[b][lane];
            }
        }
    }
    g
}
