use super::*;

mod joined;

fn cycles_of(history: &[f64]) -> Vec<Cycle> {
    let mut out = Vec::new();
    let mut count = Rainflow::default();
    for (at, &value) in history.iter().enumerate() {
        count.push(Point { at, value }, &mut |c| out.push(c));
    }
    count.finish(&mut |c| out.push(c));
    out
}

/// Cycle counts by whole range, 1 to 10.
fn table(history: &[f64]) -> Vec<f64> {
    let mut counts = vec![0.0; 11];
    for c in cycles_of(history) {
        counts[c.range().round() as usize] += c.count;
    }
    counts
}

/// The history of ASTM E1049-85, Fig. 6: reversals A to I.
const FIG_6: [f64; 9] = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];

#[test]
fn the_worked_example_of_astm_e1049_fig_6_gives_its_table() {
    // Range: cycle counts, from the table beside Fig. 6: 10: 0, 9: 0.5, 8: 1.0, 7: 0, 6: 0.5, 5: 0, 4: 1.5, 3: 0.5, 2: 0, 1: 0.
    let expected = [0.0, 0.0, 0.0, 0.5, 1.5, 0.0, 0.5, 0.0, 1.0, 0.5, 0.0];
    assert_eq!(table(&FIG_6), expected);
    // In the text: the only full cycle is E-F.
    let whole: Vec<Cycle> = cycles_of(&FIG_6)
        .into_iter()
        .filter(|c| c.count == 1.0)
        .collect();
    assert_eq!(whole.len(), 1);
    assert_eq!((whole[0].from.at, whole[0].to.at), (4, 5));
}

#[test]
fn samples_between_reversals_and_repeated_ones_and_gaps_change_nothing() {
    let mut fine = Vec::new();
    for pair in FIG_6.windows(2) {
        fine.push(pair[0]);
        fine.push(pair[0]);
        fine.push(f64::NAN);
        fine.extend((1..5).map(|i| pair[0] + (pair[1] - pair[0]) * f64::from(i) / 5.0));
    }
    fine.push(FIG_6[8]);
    assert_eq!(table(&fine), table(&FIG_6));
}

#[test]
fn a_sine_is_one_cycle_a_period_and_a_constant_none() {
    let sine: Vec<f64> = (0..=4000)
        .map(|i| 3.0 * (std::f64::consts::TAU * f64::from(i) / 400.0).sin())
        .collect();
    let counted: f64 = cycles_of(&sine)
        .iter()
        .filter(|c| (c.range() - 6.0).abs() < 1e-9)
        .map(|c| c.count)
        .sum();
    // Ten periods that begin and end at zero: nine and a half from peak to valley, and the two ends.
    assert!((counted - 9.5).abs() < 1e-12, "{counted}");
    assert!(cycles_of(&[2.0; 50]).is_empty());
    assert!(cycles_of(&[]).is_empty());
}

#[test]
fn every_range_of_the_record_is_counted_once() {
    // Half cycles at both ends of each count add up to the way the signal goes up and down.
    let mut seed = 3_u64;
    let history: Vec<f64> = (0..5000)
        .map(|_| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((seed >> 40) % 1000) as f64
        })
        .collect();
    let way: f64 = history.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    let counted: f64 = cycles_of(&history)
        .iter()
        .map(|c| 2.0 * c.count * c.range())
        .sum();
    assert!((way - counted).abs() < 1e-6 * way, "{way} {counted}");
}

#[test]
fn damage_is_the_sum_of_powers_and_its_interval_holds_it() {
    let mut d = Damage::new(3.0, 9.0);
    for c in cycles_of(&FIG_6) {
        d.add(&c, 0.1);
    }
    // 0.5 3^3 + 1.5 4^3 + 0.5 6^3 + 8^3 + 0.5 9^3.
    let expected = 13.5 + 96.0 + 108.0 + 512.0 + 364.5;
    assert!((d.value - expected).abs() < 1e-9);
    assert!(d.low < d.value && d.value < d.high);
    assert_eq!(d.cycles, 4.0);
    assert_eq!(d.largest, 9.0);
    assert!((d.one_cycle(d.value).powi(3) - expected).abs() < 1e-9);
    let binned: f64 = d.bins.iter().map(|b| b.damage).sum();
    assert!((binned - d.value).abs() < 1e-9);
    let cycles: f64 = d.bins.iter().map(|b| b.cycles).sum();
    assert_eq!(cycles, d.cycles);
}
