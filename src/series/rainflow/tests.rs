use super::*;

mod joined_tallies;

fn cycles_of(history: &[f64]) -> Vec<Cycle> {
    let mut out = Vec::new();
    let mut count = Rainflow::default();
    for (at, &value) in history.iter().enumerate() {
        count.push(Point { at, value }, &mut |c| out.push(c));
    }
    count.finish(&mut |c| out.push(c));
    out
}

/// Returns cycle counts by whole range, 1 to 10.
fn table(history: &[f64]) -> Vec<f64> {
    let mut counts = vec![0.0; 11];
    for c in cycles_of(history) {
        counts[c.range().round() as usize] += c.count;
    }
    counts
}

/// Returns the history of ASTM E1049-85, Fig. 6: reversals A to I.
const FIG_6: [f64; 9] = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];

#[test]
fn the_worked_example_of_astm_e1049_fig_6_gives_its_table() {
    // Cycle counts by range, from the table next to Fig. 6: 10: 0, 9: 0.5, 8: 1.0, 7: 0, 6: 0.5, 5: 0, 4: 1.5, 3: 0.5, 2: 0, 1: 0.
    let expected = [0.0, 0.0, 0.0, 0.5, 1.5, 0.0, 0.5, 0.0, 1.0, 0.5, 0.0];
    assert_eq!(table(&FIG_6), expected);
    // The text states that the only full cycle is E-F.
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
    // Ten periods that begin and end at zero contain nine and a half cycles from peak to valley, and the two ends.
    assert!((counted - 9.5).abs() < 1e-12, "{counted}");
    assert!(cycles_of(&[2.0; 50]).is_empty());
    assert!(cycles_of(&[]).is_empty());
}

#[test]
fn every_range_of_the_record_is_counted_once() {
    // The ranges of all half cycles add up to the total path of the signal up and down.
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

#[test]
fn a_tally_counts_what_samples_taken_one_by_one_give() {
    let mut seed = 11_u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 40) as f64 / (1_u64 << 24) as f64
    };
    let rough: Vec<f64> = (0..3000)
        .map(|i| 4.0 * (0.01 * f64::from(i)).sin() + next())
        .collect();
    let rounded: Vec<f64> = rough.iter().map(|v| (v * 2.0).round() / 2.0).collect();
    let mut broken = rough.clone();
    broken[700..720].fill(f64::NAN);
    broken[1500] = f64::INFINITY;
    for history in [rough, rounded, broken] {
        let mut cycles = std::collections::BTreeMap::new();
        let mut levels = std::collections::BTreeMap::new();
        let mut count = Rainflow::default();
        let class = |v: f64| (v / 0.25).floor() as i32;
        let mut before: Option<f64> = None;
        for (at, &value) in history.iter().enumerate() {
            count.push(Point { at, value }, &mut |c| {
                *cycles
                    .entry((class(c.from.value), class(c.to.value)))
                    .or_insert(0) += 1;
            });
            if value.is_finite() {
                for border in before.map_or(1, class) + 1..=before.map_or(0, |_| class(value)) {
                    *levels.entry(border).or_insert(0) += 1;
                }
                before = Some(value);
            }
        }
        let mut counter = Counter::new(0, 1, 0.0, 0.25, Law::from_slope(5.0));
        counter.push(&history[..1], &[]);
        counter.push(&history[1..2300], &[]);
        counter.push(&history[2300..], &[]);
        let tally = counter.finish();
        assert_eq!(
            tally.cycles,
            cycles
                .into_iter()
                .map(|((a, b), n)| (a, b, n))
                .collect::<Vec<_>>()
        );
        assert_eq!(tally.levels, levels.into_iter().collect::<Vec<_>>());
        let open: Vec<(usize, f64)> = count
            .residue(&mut |_| ())
            .iter()
            .map(|r| (r.point.at, r.point.value))
            .collect();
        let [own, ..] = &tally.residues;
        assert_eq!(
            own.iter().map(|l| (l.at, l.value)).collect::<Vec<_>>(),
            open
        );
        assert!(own.iter().all(|l| l.loads == [l.value]));
        let known = history.iter().filter(|v| v.is_finite());
        assert_eq!(
            tally.max.unwrap().value,
            known.clone().fold(f64::MIN, |a, v| a.max(*v))
        );
        assert_eq!(
            tally.min.unwrap().value,
            known.clone().fold(f64::MAX, |a, v| a.min(*v))
        );
        assert_eq!(tally.missing, history.len() - known.count());
    }
}
