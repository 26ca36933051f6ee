mod bundles;
mod condition;
mod region;
mod workshop;

use super::candidates::{Angles, Candidates, Choice, Scatter};
use super::{Criterion, Spec, angle_variance, place, quality};
use crate::linalg::spd;
use crate::stop::Stop;
use crate::support::bytes as shared;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn matrix(path: &str) -> Option<Vec<Vec<f64>>> {
    let text = String::from_utf8(shared(path)?).ok()?;
    let rows = text.lines().filter_map(|l| {
        l.split(',')
            .map(|v| v.trim().parse().ok())
            .collect::<Option<Vec<f64>>>()
    });
    Some(rows.filter(|r| !r.is_empty()).collect())
}

fn rows_of(m: &[Vec<f64>]) -> Candidates {
    Candidates::from_rows(
        m[0].len(),
        m.len(),
        Scatter::with_uniform_noise(1.0),
        |i, out| out.copy_from_slice(&m[i]),
    )
}

/// Returns the tensors of `ladder_T_k36_n2e4.npy` (float32, places x 3 x 36, C order).
fn tensors(k: usize) -> Option<(usize, Vec<f64>)> {
    let bytes = shared("benchmarks/doptimal/ladder_T_k36_n2e4.npy")?;
    let header = u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
    let v: Vec<f64> = bytes[10 + header..]
        .chunks_exact(4)
        .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))
        .collect();
    let n = v.len() / (3 * 36);
    let mut out = Vec::with_capacity(n * 3 * k);
    for p in 0..n {
        for l in 0..k {
            for c in 0..3 {
                out.push(v[(p * 3 + c) * 36 + l]);
            }
        }
    }
    Some((n, out))
}

fn grid15() -> Angles {
    Angles::Grid(
        (0..12)
            .map(|i| (15.0 * f64::from(i)).to_radians())
            .collect(),
    )
}

fn benchmark(name: &str) -> Option<Candidates> {
    Some(match name {
        "ladder_k6_n44" | "ladder_k6_n2e3" | "ladder_k36_n2e3" => {
            rows_of(&matrix(&format!("benchmarks/doptimal/{name}.csv"))?)
        }
        _ => {
            let k = if name.ends_with("first6") { 6 } else { 36 };
            let (n, t) = tensors(k)?;
            Candidates::from_tensors(
                k,
                n,
                grid15(),
                Scatter::with_uniform_noise(1.0),
                |p, out| {
                    out.copy_from_slice(&t[p * 3 * k..(p + 1) * 3 * k]);
                },
            )
        }
    })
}

#[test]
fn layouts_are_never_below_the_published_optfederov_and_reference_values_nor_above_the_bound() {
    let Some(text) = shared("benchmarks/doptimal/anchors.csv") else {
        return;
    };
    let text = String::from_utf8(text).unwrap();
    for line in text.lines().skip(1) {
        let f: Vec<&str> = line.split(',').collect();
        let Some(c) = benchmark(f[0]) else { return };
        let s: usize = f[3].parse().unwrap();
        let start = std::time::Instant::now();
        let got = place(&c, &Spec::new(s, c.n_loads())).unwrap();
        let num = |i: usize| f[i].parse::<f64>().ok();
        for known in [num(4), num(6)].into_iter().flatten() {
            assert!(
                got.log_det >= known - 1e-6,
                "{} s = {s}: {} below {known}",
                f[0],
                got.log_det
            );
        }
        let bound = num(7).unwrap();
        assert!(
            got.log_det <= bound + 1e-6,
            "{} s = {s}: above the bound of any method",
            f[0]
        );
        let slack = Spec::new(s, c.n_loads()).tolerance * c.n_loads() as f64;
        assert!(
            got.upper_bound <= bound + slack + 1e-6,
            "{} s = {s}: bound {}",
            f[0],
            got.upper_bound
        );
        let seconds = start.elapsed().as_secs_f64();
        eprintln!(
            "{} s = {s}: log det {:.6}, efficiency {:.4}, {} passes, {seconds:.4} s, {} nodes, {:?} alive, proved {}",
            f[0], got.log_det, got.efficiency_bound, got.passes, got.nodes, got.alive, got.proved
        );
    }
}

fn random_rows(rng: &mut ChaCha8Rng, n: usize, k: usize) -> Vec<Vec<f64>> {
    (0..n)
        .map(|_| (0..k).map(|_| rng.random_range(-1.0..1.0)).collect())
        .collect()
}

fn log_det(c: &Candidates, gauges: &[Choice], prior: &[f64]) -> f64 {
    let k = c.n_loads();
    let mut m = prior.to_vec();
    for &g in gauges {
        spd::add_outer(&mut m, &c.row(g), 1.0);
    }
    spd::cholesky(&m, k).map_or(f64::NEG_INFINITY, |l| spd::log_det(&l, k))
}

/// Returns the best of all subsets that follow the rule.
fn brute_force(
    c: &Candidates,
    all: &[Choice],
    s: usize,
    prior: &[f64],
    fits: &dyn Fn(&Choice, &Choice) -> bool,
) -> f64 {
    fn go(
        c: &Candidates,
        all: &[Choice],
        s: usize,
        prior: &[f64],
        fits: &dyn Fn(&Choice, &Choice) -> bool,
        from: usize,
        chosen: &mut Vec<Choice>,
    ) -> f64 {
        if chosen.len() == s {
            return log_det(c, chosen, prior);
        }
        let mut best = f64::NEG_INFINITY;
        for i in from..all.len() {
            if chosen.iter().all(|g| fits(g, &all[i])) {
                chosen.push(all[i]);
                best = best.max(go(c, all, s, prior, fits, i + 1, chosen));
                chosen.pop();
            }
        }
        best
    }
    go(c, all, s, prior, fits, 0, &mut Vec::new())
}

#[test]
fn bounds_hold_and_layouts_are_proved_the_best_of_all_subsets_on_a_thousand_small_problems() {
    let mut solved = 0;
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for trial in 0..1000 {
        let k = 2 + trial % 3;
        let n = 8 + trial % 5;
        let s = k + trial % 3;
        let m = random_rows(&mut rng, n, k);
        let spacing = if trial % 2 == 0 { 0.0 } else { 0.15 };
        let at: Vec<[f64; 3]> = (0..n)
            .map(|_| [rng.random_range(0.0..1.0), rng.random_range(0.0..0.3), 0.0])
            .collect();
        let c = rows_of(&m).with_positions(at.clone());
        let all: Vec<Choice> = (0..n as u32)
            .map(|place| Choice {
                place,
                step: 0,
                angle: 0.0,
            })
            .collect();
        let fits = |a: &Choice, b: &Choice| {
            spacing == 0.0
                || !super::spacing::too_close(at[a.place as usize], at[b.place as usize], spacing)
        };
        let mut spec = Spec::new(s, k);
        spec.spacing = spacing;
        if trial % 5 == 0 {
            for i in 0..k {
                spec.prior[i * k + i] = 0.1;
            }
        }
        let best = brute_force(&c, &all, s, &spec.prior, &fits);
        match place(&c, &spec) {
            Ok(got) => {
                assert!(
                    got.upper_bound >= best - 1e-9,
                    "trial {trial}: bound {} under {best}",
                    got.upper_bound
                );
                assert!(
                    got.log_det <= best + 1e-9,
                    "trial {trial}: a layout that breaks the rule"
                );
                solved += 1;
                assert!(got.proved, "trial {trial}: not proved");
                assert!(
                    got.log_det >= best - 1e-8,
                    "trial {trial}: {} proved, but {best} exists",
                    got.log_det
                );
            }
            Err(e) => assert!(
                best < -20.0,
                "trial {trial}: {e}, but a layout of log det {best} exists"
            ),
        }
    }
    assert!(solved > 800, "{solved}");
}

#[test]
fn a_search_cut_short_keeps_its_certificate() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let mut left_out = 0;
    for _ in 0..20 {
        let c = rows_of(&random_rows(&mut rng, 40, 4));
        let whole = place(&c, &Spec::new(7, 4)).unwrap();
        let stop = Stop::new();
        stop.ask();
        let spec = Spec {
            stop,
            ..Spec::new(7, 4)
        };
        let cut = place(&c, &spec).unwrap();
        // The layout has seven different rows. Its determinant is recomputed from the rows and compared with the optimum.
        let mut chosen: Vec<u32> = cut.gauges.iter().map(|g| g.place).collect();
        chosen.sort_unstable();
        chosen.dedup();
        assert_eq!((chosen.len(), cut.nodes), (7, 0));
        let own = log_det(&c, &cut.gauges, &spec.prior);
        assert!((cut.log_det - own).abs() < 1e-9, "{} {own}", cut.log_det);
        assert!(whole.proved);
        assert!(cut.upper_bound >= whole.log_det - 1e-9);
        let efficiency = ((own - whole.log_det) / 4.0).exp();
        assert!(cut.efficiency_bound <= efficiency + 1e-9);
        // A bound needs one pass.
        assert_eq!(cut.passes, 1);
        left_out += whole.nodes + whole.passes - cut.passes;
    }
    assert!(left_out > 0, "nothing was left out");
}

#[test]
fn continuous_angles_are_certified_over_a_fine_grid_and_not_worse_than_it() {
    let Some((n, t)) = tensors(6) else { return };
    let fill = |p: usize, out: &mut [f64]| out.copy_from_slice(&t[p * 18..(p + 1) * 18]);
    let sparse: Vec<u32> = (0..n as u32).step_by(10).collect();
    let continuous = Candidates::from_tensors(
        6,
        n,
        Angles::Continuous,
        Scatter::with_uniform_noise(1.0),
        fill,
    )
    .subset(&sparse);
    let fine = Angles::Grid((0..180).map(|i| f64::from(i).to_radians()).collect());
    let fine = Candidates::from_tensors(6, n, fine, Scatter::with_uniform_noise(1.0), fill)
        .subset(&sparse)
        .with_positions((0..sparse.len()).map(|i| [i as f64, 0.0, 0.0]).collect());
    for s in [6, 10] {
        let a = place(&continuous, &Spec::new(s, 6)).unwrap();
        let b = place(
            &fine,
            &Spec {
                spacing: 0.5,
                ..Spec::new(s, 6)
            },
        )
        .unwrap();
        assert!(
            a.log_det >= b.log_det - 1e-3,
            "{} against {} on a grid of one degree",
            a.log_det,
            b.log_det
        );
        assert!(a.upper_bound >= b.log_det);
        assert!(a.efficiency_bound > 0.93, "{}", a.efficiency_bound);
    }
}

#[test]
fn the_largest_variance_over_all_angles_is_an_upper_bound_of_a_dense_scan() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let samples: [[f64; 4]; angle_variance::SAMPLES] = std::array::from_fn(|i| {
        angle_variance::phases(std::f64::consts::PI * i as f64 / angle_variance::SAMPLES as f64)
    });
    for _ in 0..500 {
        let r: [[f64; 3]; 2] =
            std::array::from_fn(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let form: angle_variance::Form = std::array::from_fn(|i| {
            r.iter()
                .map(|v| v[[0, 1, 2, 0, 0, 1][i]] * v[[0, 1, 2, 1, 2, 2][i]])
                .sum()
        });
        let slope = angle_variance::of_slope(&form.map(|v| 0.3 * v));
        let v = [slope[0] + 0.5, slope[1], slope[2], slope[3], slope[4]];
        let (angle, d) =
            angle_variance::largest_ratio(&angle_variance::of_row(&form), &v, &samples);
        let ratio = |t: f64| {
            let (s, c) = t.sin_cos();
            let row = [c * c, s * s, s * c];
            let dc = [-2.0 * s * c, 2.0 * s * c, c * c - s * s];
            let q = |x: &[f64; 3]| r.iter().map(|v| spd::dot(v, x).powi(2)).sum::<f64>();
            q(&row) / (0.5 + 0.3 * q(&dc))
        };
        assert!((ratio(angle) - d).abs() <= 2e-7 * d.abs() + 1e-12);
        for i in 0..3600 {
            assert!(ratio(f64::from(i) * std::f64::consts::PI / 3600.0) <= d * (1.0 + 1e-12));
        }
    }
}

#[test]
fn a_spacing_is_kept_and_its_bound_is_below_the_one_without() {
    let Some(c) = benchmark("ladder_T_k36_n2e4_first6") else {
        return;
    };
    let at = (0..c.n_places())
        .map(|i| [(i / 4) as f64 * 10.0, (i % 4) as f64 * 10.0, 0.0])
        .collect();
    let c = c.with_positions(at);
    let free = place(&c, &Spec::new(20, 6)).unwrap();
    let spaced = place(
        &c,
        &Spec {
            spacing: 50.0,
            ..Spec::new(20, 6)
        },
    )
    .unwrap();
    for (i, a) in spaced.gauges.iter().enumerate() {
        for b in &spaced.gauges[..i] {
            let d = super::spacing::distance(
                c.positions()[a.place as usize],
                c.positions()[b.place as usize],
            );
            assert!(d >= 50.0 - 1e-6);
        }
    }
    assert!(spaced.upper_bound < free.upper_bound);
    assert!(spaced.efficiency_bound > 0.8, "{}", spaced.efficiency_bound);
}

#[test]
fn losing_a_gauge_multiplies_the_determinant_by_one_less_its_leverage() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let c = rows_of(&random_rows(&mut rng, 7, 3));
    let all: Vec<Choice> = (0..7)
        .map(|place| Choice {
            place,
            step: 0,
            angle: 0.0,
        })
        .collect();
    let q = quality::evaluate_layout(&c, &all, &[0.0; 9]).unwrap();
    for i in 0..7 {
        let rest: Vec<Choice> = all
            .iter()
            .enumerate()
            .filter(|(j, _)| *j != i)
            .map(|(_, g)| *g)
            .collect();
        let left = (log_det(&c, &rest, &[0.0; 9]) - log_det(&c, &all, &[0.0; 9])).exp();
        assert!((left - (1.0 - q.leverage[i])).abs() < 1e-12);
    }
    let exact = quality::evaluate_layout(&c, &all[..3], &[0.0; 9]).unwrap();
    assert_eq!(
        exact.worst_loss, 0.0,
        "as many gauges as loads: none may fail"
    );
}

/// Returns all subsets of `s` places of `n`.
fn subsets(n: usize, s: usize) -> impl Iterator<Item = Vec<usize>> {
    (0..1_u32 << n)
        .filter(move |bits| bits.count_ones() as usize == s)
        .map(move |bits| (0..n).filter(|i| bits >> i & 1 == 1).collect())
}

#[test]
fn layouts_for_small_variances_are_proved_the_best_of_all_subsets() {
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    for trial in 0..300 {
        let (k, n) = (2 + trial % 3, 9 + trial % 3);
        let s = k + trial % 3;
        let c = rows_of(&random_rows(&mut rng, n, k));
        let mut l = vec![0.0; k * k];
        if trial % 2 == 0 {
            // A criterion: one weight for each load. In a third of the trials the first load is not wanted.
            (0..k).for_each(|i| {
                l[i * k + i] = if trial % 3 == 0 && i == 0 {
                    0.0
                } else {
                    1.0 + i as f64
                }
            });
        } else {
            // I criterion: variance of the prediction along some rows.
            for b in random_rows(&mut rng, 3, k) {
                spd::add_outer(&mut l, &b, 1.0);
            }
        }
        let mut spec = Spec {
            criterion: Criterion::Linear(l.clone()),
            ..Spec::new(s, k)
        };
        if trial % 5 == 0 {
            (0..k).for_each(|i| spec.prior[i * k + i] = 0.5);
        }
        // Independent of the code under test: tr(L M^-1) by solving M x = column of L.
        let spread = |places: &[usize]| -> f64 {
            let mut m = spec.prior.clone();
            for &p in places {
                let row = c.row(Choice {
                    place: p as u32,
                    step: 0,
                    angle: 0.0,
                });
                spd::add_outer(&mut m, &row, 1.0);
            }
            let m = crate::linalg::Matrix::from_row_slice(k, k, &m);
            let l = crate::linalg::Matrix::from_row_slice(k, k, &l);
            m.lu().solve(&l).map_or(f64::INFINITY, |x| x.trace())
        };
        let best = subsets(n, s)
            .map(|p| spread(&p))
            .filter(|v| *v > 0.0)
            .fold(f64::INFINITY, f64::min);
        let got = place(&c, &spec).unwrap();
        let own: Vec<usize> = got.gauges.iter().map(|g| g.place as usize).collect();
        assert!((spread(&own) / (-got.log_det / k as f64).exp() - 1.0).abs() < 1e-6);
        assert!(got.proved, "trial {trial}: {got:?}");
        assert!(
            spread(&own) <= best * (1.0 + 1e-7),
            "trial {trial}: {} above {best}",
            spread(&own)
        );
    }
}

#[test]
fn ds_layouts_are_proved_the_best_of_all_subsets() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for trial in 0..200 {
        let (k, n) = (3 + trial % 2, 9 + trial % 3);
        let (q, s) = (1 + trial % 2, k + trial % 3);
        let c = rows_of(&random_rows(&mut rng, n, k));
        let mut spec = Spec {
            criterion: Criterion::Ds(q),
            ..Spec::new(s, k)
        };
        if trial % 3 == 0 {
            (0..q).for_each(|i| spec.prior[i * k + i] = 1.0);
        }
        let value = |places: &[usize]| {
            let rows: Vec<Vec<f64>> = places
                .iter()
                .map(|&p| {
                    c.row(Choice {
                        place: p as u32,
                        step: 0,
                        angle: 0.0,
                    })
                })
                .collect();
            quality::value(&rows, &spec.prior, k, &spec.criterion).unwrap_or(f64::NEG_INFINITY)
        };
        let best = subsets(n, s)
            .map(|p| value(&p))
            .fold(f64::NEG_INFINITY, f64::max);
        let got = place(&c, &spec).unwrap();
        let own: Vec<usize> = got.gauges.iter().map(|g| g.place as usize).collect();
        assert!((value(&own) - got.log_det).abs() < 1e-9);
        assert!(
            got.upper_bound >= best - 1e-9,
            "trial {trial}: {} under {best}",
            got.upper_bound
        );
        assert!(
            got.proved && got.log_det >= best - 1e-8,
            "trial {trial}: {best} against {got:?}"
        );
    }
}
