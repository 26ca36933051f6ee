use super::*;
use crate::stop::Stop;

/// Scorer with five candidates of independent gains. It requests a stop after a number of scored sets.
struct CountingScorer {
    stop: Stop,
    last: usize,
    scored: usize,
    screened: usize,
}

impl CountingScorer {
    fn stopped_after(last: usize) -> Self {
        let stop = Stop::new();
        if last == 0 {
            stop.ask();
        }
        Self {
            stop,
            last,
            scored: 0,
            screened: 0,
        }
    }
}

const GAIN: [f64; 5] = [50.0, 40.0, 30.0, 20.0, -1.0];

impl Scorer for CountingScorer {
    type Fit = ();

    fn score(
        &mut self,
        set: &[usize],
        _: Option<(&ScoredSet<()>, Option<&Addition>)>,
    ) -> Option<ScoredSet<()>> {
        self.scored += 1;
        if self.scored == self.last {
            self.stop.ask();
        }
        Some(ScoredSet {
            set: set.to_vec(),
            log_evidence: set.iter().map(|c| GAIN[*c]).sum(),
            fit: (),
        })
    }

    fn screen(&mut self, base: &ScoredSet<()>) -> Vec<Addition> {
        self.screened += 1;
        let new = (0..GAIN.len()).filter(|c| !base.set.contains(c));
        new.map(|candidate| Addition {
            candidate,
            gain: GAIN[candidate],
            parameters: Vec::new(),
            sizes: Vec::new(),
        })
        .collect()
    }

    fn is_compatible_pair(&self, _: usize, _: usize) -> bool {
        true
    }

    fn kin(&self, candidate: usize) -> usize {
        candidate
    }

    fn is_stopped(&self) -> bool {
        self.stop.is_asked()
    }
}

const BREADTH: Breadth = Breadth {
    largest: 4,
    beam: 3,
    tries: 4,
    decisive: 4.6,
};

#[test]
fn a_search_that_is_stopped_scores_and_screens_nothing_more() {
    let mut whole = CountingScorer::stopped_after(usize::MAX);
    let best = settle(&search(&mut whole, BREADTH), BREADTH.decisive).unwrap();
    assert_eq!(best.set, [0, 1, 2, 3]);
    for last in 1..whole.scored {
        let mut cut = CountingScorer::stopped_after(last);
        search(&mut cut, BREADTH);
        assert_eq!(cut.scored, last);
        assert!(cut.screened <= whole.screened);
        assert!(last > 1 || cut.screened == 0);
    }
}

#[test]
fn a_search_near_known_sets_that_is_stopped_scores_the_empty_one_alone() {
    let mut before = CountingScorer::stopped_after(usize::MAX);
    let known = search(&mut before, BREADTH);
    let mut cut = CountingScorer::stopped_after(0);
    search_near(&mut cut, BREADTH, &known[..8]);
    assert_eq!((cut.scored, cut.screened), (1, 0));
}
