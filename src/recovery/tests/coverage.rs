//! Coverage of the 95 % intervals over 2,000 seeded trials.
//!
//! The limits are 95 +- 1.5 %. With 2,000 trials of six or nine loads each, the standard deviation of the share is .3 %.

use super::super::history::{Filter, SampleLoads};
use super::super::*;
use super::records::many_nuisances;
use super::{KN, NOISE, draw_normal, frame};
use crate::sensitivity::Sensitivity;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const TRIALS: u64 = 2000;

/// Returns a trial: true loads, strain.
fn draw(s: &Sensitivity, seed: u64, size: impl Fn(usize) -> f64) -> (Vec<f64>, Vec<f64>) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let f: Vec<f64> = (0..s.loads.len())
        .map(|l| size(l) * draw_normal(&mut rng))
        .collect();
    let strain = s
        .values
        .row_iter()
        .map(|row| {
            row.iter().zip(&f).map(|(s, f)| s * f).sum::<f64>()
                + NOISE.noise * draw_normal(&mut rng)
        })
        .collect();
    (f, strain)
}

fn assert_covers(what: &str, covered: u64, of: u64) {
    let share = covered as f64 / of as f64;
    println!("{what}: {:.1} % of {of} intervals", 100.0 * share);
    assert!((0.935..=0.965).contains(&share), "{what}: {share}");
}

/// Tests runs one by one. The gauge `silent` has no reading.
fn of_runs(s: &Sensitivity, size: impl Fn(usize) -> f64, silent: Option<usize>) {
    let (mut covered, mut of) = (0, 0);
    for seed in 0..TRIALS {
        let (f, mut strain) = draw(s, seed, &size);
        if let Some(g) = silent {
            strain[g] = f64::NAN;
        }
        let readings = Readings {
            run: "R".into(),
            strain,
            noise_factor: 1.0,
        };
        let got = recover(s, &[readings], NOISE);
        for l in (0..f.len()).filter(|l| s.loads[*l].wanted) {
            let [low, high] = got.runs[0].estimate.interval(l);
            covered += u64::from(low <= f[l] && f[l] <= high);
            of += 1;
        }
    }
    let dead = silent.map_or("", |_| ", a channel dead");
    assert_covers(&format!("runs, {} loads{dead}", s.loads.len()), covered, of);
}

/// Tests all trials as one record as the application does, on 200 of its samples.
fn of_record(s: &Sensitivity, size: impl Fn(usize) -> f64, silent: Option<usize>) {
    let (n, k) = (s.gauges.len(), s.loads.len());
    let trials: Vec<(Vec<f64>, Vec<f64>)> = (0..TRIALS)
        .map(|seed| {
            let (f, mut strain) = draw(s, seed, &size);
            if let Some(g) = silent {
                strain[g] = f64::NAN;
            }
            (f, strain)
        })
        .collect();
    let readings_of_trials: Vec<Readings> = trials
        .iter()
        .step_by(10)
        .map(|t| Readings {
            run: "t".into(),
            strain: t.1.clone(),
            noise_factor: 1.0,
        })
        .collect();
    let recovery = recover(s, &readings_of_trials, NOISE);
    let filter = Filter::new(
        s,
        vec![0.0; n],
        NOISE,
        1.0,
        &recovery.typical,
        recovery.widening,
    )
    .unwrap();
    let samples: Vec<f64> = trials.iter().flat_map(|t| t.1.clone()).collect();
    let (mut out, mut sums) = (SampleLoads::default(), Sums::new(n, k));
    filter.apply(&samples, 1.0, &mut out, &mut sums);
    let (mut covered, mut of) = (0, 0);
    let mut gaps = out.gaps.iter().peekable();
    for (i, ((f, _), got)) in trials.iter().zip(out.values.chunks_exact(k)).enumerate() {
        let gap = gaps.next_if(|g| g.0 == i).and_then(|g| g.1.clone());
        let sigma = match &gap {
            Some(gain) => filter.sigma_with(gain, got),
            None => filter.sigma(got),
        };
        assert_eq!(gap.is_some(), silent.is_some());
        for l in (0..k).filter(|l| s.loads[*l].wanted) {
            covered += u64::from((got[l] - f[l]).abs() <= filter.coverage_factor() * sigma[l]);
            of += 1;
        }
    }
    let dead = silent.map_or("", |_| ", a channel dead");
    assert_covers(&format!("a record, {k} loads{dead}"), covered, of);
}

#[test]
fn runs_and_records_of_the_frame_cover() {
    let Some(frame) = frame(9) else { return };
    of_runs(&frame.s, |_| 10.0 * KN, None);
    of_record(&frame.s, |_| 10.0 * KN, None);
}

#[test]
fn runs_and_records_with_one_dead_channel_cover() {
    let Some(frame) = frame(9) else { return };
    of_runs(&frame.s, |_| 10.0 * KN, Some(4));
    of_record(&frame.s, |_| 10.0 * KN, Some(4));
}

#[test]
fn runs_and_records_with_more_loads_than_gauges_cover_where_nuisance_loads_state_their_size() {
    let s = many_nuisances();
    let size = |l: usize| s.loads[l].expected.unwrap_or(0.0);
    of_runs(&s, size, None);
    of_record(&s, size, None);
}
