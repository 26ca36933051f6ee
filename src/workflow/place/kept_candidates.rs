//! S of the candidates, kept between layouts of one job.

use super::pool::Kind;
use crate::job::{AngleStep, Candidates, Job, Keep, Placement};
use crate::placement::sites::Site;
use std::collections::HashMap;

/// Candidates of the widest choice of places so far. A narrower choice takes its rows from them, with the same bits as if they were computed again.
#[derive(Default)]
pub(super) struct KeptCandidates(Option<Kept>);

struct Kept {
    /// Keys of the job that the rows depend on.
    keys: RowKeys,
    places: HashMap<Site, u32>,
    kinds: Vec<Kind>,
}

/// Keys of a job that determine the rows of candidates, in addition to its model and loads.
#[derive(Clone, PartialEq)]
struct RowKeys {
    angles: AngleStep,
    candidates: Candidates,
    placement: Placement,
}

impl RowKeys {
    fn from_job(job: &Job) -> Self {
        Self {
            angles: job.candidates.angles,
            // Where gauges may go decides on the places, not on their rows.
            candidates: Candidates {
                properties: None,
                elements: None,
                sets: None,
                exclude_properties: None,
                exclude_elements: None,
                wanted_elements: None,
                file: None,
                ..job.candidates.clone()
            },
            placement: Placement {
                gauges: None,
                keep: Keep::None,
                ..job.placement.clone()
            },
        }
    }
}

impl KeptCandidates {
    /// Returns the candidates at these sites, if all sites are among the kept ones.
    pub fn find_kinds(&self, job: &Job, sites: &[Site]) -> Option<Vec<Kind>> {
        let kept = self.0.as_ref()?;
        let places: Option<Vec<u32>> = sites.iter().map(|s| kept.places.get(s).copied()).collect();
        let places = places.filter(|_| kept.keys == RowKeys::from_job(job))?;
        let is_ascending = places.windows(2).all(|p| p[0] < p[1]);
        is_ascending.then(|| {
            let kinds = kept.kinds.iter();
            let subset = |k: &Kind| Kind {
                bridge: k.bridge,
                candidates: k.candidates.subset(&places),
            };
            kinds.map(subset).collect()
        })
    }

    /// Keeps candidates if no others are kept, or if they have as many places. Returns the candidates.
    pub fn store(&mut self, job: &Job, sites: &[Site], kinds: Vec<Kind>) -> Vec<Kind> {
        let keys = RowKeys::from_job(job);
        let is_narrower = |k: &Kept| k.keys == keys && k.places.len() > sites.len();
        if !self.0.as_ref().is_some_and(is_narrower) {
            let places = sites.iter().enumerate().map(|(i, s)| (*s, i as u32));
            self.0 = Some(Kept {
                keys,
                places: places.collect(),
                kinds: kinds.clone(),
            });
        }
        kinds
    }
}
