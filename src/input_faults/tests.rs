//! Faults planted in recorded loads of random structures. Each fault is found, and without a fault there is no finding.

use super::{RecordFault, RecordedRuns, faults_of_recorded_loads, findings_of_recorded_loads};
use crate::finding::Severity;
use crate::linalg::Matrix;
use crate::units::Quantity;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const LOADS: [&str; 4] = ["A.FZ", "B.FZ", "A.FY", "B.FY"];
const NOISE: f64 = 1.0;

/// Influence of four loads at twelve gauges, ten runs of recorded loads, and readings of a structure that deviates from the model by 3 %.
struct SyntheticRuns {
    influence: Matrix,
    records: Vec<Vec<f64>>,
    readings: Vec<Vec<f64>>,
}

impl SyntheticRuns {
    fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut within = |size: f64| random.random_range(-size..size);
        let influence = Matrix::from_fn(12, LOADS.len(), |_, _| within(20.0));
        let records: Vec<Vec<f64>> = (0..10)
            .map(|_| (0..LOADS.len()).map(|_| within(10.0)).collect())
            .collect();
        let gains: Vec<f64> = (0..12).map(|_| 1.0 + within(0.05)).collect();
        let readings = records
            .iter()
            .map(|f| {
                let row = |g: usize| (0..f.len()).map(|l| influence[(g, l)] * f[l]).sum::<f64>();
                (0..12)
                    .map(|g| gains[g] * row(g) + within(1.7 * NOISE))
                    .collect()
            })
            .collect();
        Self {
            influence,
            records,
            readings,
        }
    }

    fn runs(&self) -> RecordedRuns<'_> {
        RecordedRuns {
            loads: LOADS.to_vec(),
            readings: self.readings.clone(),
            strain_of: Box::new(|g, r, l, from| self.influence[(g, l)] * self.records[r][from]),
            quantities: vec![Some(Quantity::Force); LOADS.len()],
            known: vec![true; self.records.len()],
            excluded: Vec::new(),
            noise: NOISE,
            model_rel: 0.01,
        }
    }

    fn scale_records(mut self, factors: [f64; 4]) -> Self {
        for record in &mut self.records {
            record.iter_mut().zip(factors).for_each(|(f, c)| *f *= c);
        }
        self
    }
}

#[test]
fn right_records_of_a_model_that_is_off_by_three_percent_are_no_fault() {
    for seed in 0..200 {
        let planted = SyntheticRuns::new(seed);
        assert_eq!(faults_of_recorded_loads(&planted.runs()), [], "{seed}");
    }
}

#[test]
fn reversed_records_are_named_and_no_others() {
    for seed in 0..50 {
        let planted = SyntheticRuns::new(seed).scale_records([1.0, 1.0, -1.0, -1.0]);
        let found = findings_of_recorded_loads(&planted.runs(), "runs.csv");
        assert_eq!(found.len(), 1, "{seed}: {found:?}");
        assert_eq!(found[0].code, "input-sign-reversed");
        assert_eq!(found[0].subject, "A.FY, B.FY");
        assert_eq!(found[0].severity, Severity::Error);
        let all = SyntheticRuns::new(seed).scale_records([-1.0; 4]);
        let found = findings_of_recorded_loads(&all.runs(), "runs.csv");
        assert_eq!(found[0].subject, "all", "{seed}: {found:?}");
        assert_eq!(found.len(), 1);
    }
}

#[test]
fn records_in_another_unit_are_named_with_the_pair_of_units() {
    for seed in 0..50 {
        for (factor, words) in [
            (1e3, "N were read as kN"),
            (1e-3, "kN were read as N"),
            (1.0 / 4.448, "lbf were read as N"),
        ] {
            let planted = SyntheticRuns::new(seed).scale_records([factor; 4]);
            let found = findings_of_recorded_loads(&planted.runs(), "runs.csv");
            assert_eq!(found.len(), 1, "{seed} {factor}: {found:?}");
            assert_eq!(
                (found[0].code, found[0].subject.as_str()),
                ("input-unit", "all")
            );
            assert!(found[0].message.contains(words), "{}", found[0].message);
        }
    }
}

#[test]
fn exchanged_records_are_named_as_pairs() {
    for seed in 0..50 {
        let mut planted = SyntheticRuns::new(seed);
        planted.records.iter_mut().for_each(|f| f.swap(0, 1));
        let found = faults_of_recorded_loads(&planted.runs());
        assert!(
            matches!(found.as_slice(), [RecordFault::Exchanged(pairs, _)] if *pairs == [[0, 1]]),
            "{seed}: {found:?}"
        );
        planted.records.iter_mut().for_each(|f| f.swap(2, 3));
        let found = faults_of_recorded_loads(&planted.runs());
        let RecordFault::Exchanged(pairs, _) = &found[0] else {
            panic!("{seed}: {found:?}");
        };
        let mut pairs = pairs.clone();
        pairs.sort_unstable();
        assert_eq!(pairs, [[0, 1], [2, 3]], "{seed}");
    }
}

#[test]
fn an_effect_that_no_record_explains_is_left_to_others() {
    // Half of the gauges have the readings of another structure.
    for seed in 0..50 {
        let (mut planted, other) = (SyntheticRuns::new(seed), SyntheticRuns::new(seed + 1000));
        for (run, strange) in planted.readings.iter_mut().zip(&other.readings) {
            run[..6].copy_from_slice(&strange[..6]);
        }
        assert_eq!(faults_of_recorded_loads(&planted.runs()), [], "{seed}");
    }
}
