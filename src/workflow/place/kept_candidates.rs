//! S of the candidates, kept between layouts of one job.

use super::pool::Kind;
use crate::job::{AngleStep, Candidates, Job, Keep, Placement};
use crate::placement::sites::Site;
use std::sync::Arc;

/// Candidates of the widest choice of places so far. A narrower choice takes its rows from them, with the same bits as if they were computed again.
#[derive(Default)]
pub(super) struct KeptCandidates(Option<Kept>);

struct Kept {
    keys: RowKeys,
    sites: Vec<Site>,
    kinds: Arc<Vec<Kind>>,
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
    pub fn find_kinds(&self, job: &Job, sites: &[Site]) -> Option<Arc<Vec<Kind>>> {
        let kept = self.0.as_ref()?;
        if kept.keys != RowKeys::from_job(job) {
            return None;
        }
        if kept.sites == sites {
            return Some(Arc::clone(&kept.kinds));
        }
        let places = places_among(&kept.sites, sites)?;
        let subset = |k: &Kind| Kind {
            bridge: k.bridge,
            candidates: k.candidates.subset(&places),
        };
        Some(Arc::new(kept.kinds.iter().map(subset).collect()))
    }

    /// Keeps candidates, unless the kept ones of the same job have more places. Returns the candidates.
    pub fn store(&mut self, job: &Job, sites: &[Site], kinds: Vec<Kind>) -> Arc<Vec<Kind>> {
        let (keys, kinds) = (RowKeys::from_job(job), Arc::new(kinds));
        let is_wider = |k: &Kept| k.keys == keys && k.sites.len() > sites.len();
        if !self.0.as_ref().is_some_and(is_wider) {
            self.0 = Some(Kept {
                keys,
                sites: sites.to_vec(),
                kinds: Arc::clone(&kinds),
            });
        }
        kinds
    }
}

/// Returns the indices of `sites` in `all`; `None` if a site is missing there. Both lists have the order of the model.
fn places_among(all: &[Site], sites: &[Site]) -> Option<Vec<u32>> {
    let mut at = all.iter().zip(0..);
    let place = |s: &Site| at.find(|(kept, _)| *kept == s).map(|(_, i)| i);
    sites.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::strain_tensor::Surface::{Bottom, Top};
    use crate::model::ShellIx;

    #[test]
    fn places_are_found_in_order_and_a_missing_one_is_seen() {
        let all = [(ShellIx(1), Top), (ShellIx(1), Bottom), (ShellIx(4), Top)];
        assert_eq!(places_among(&all, &all[1..]), Some(vec![1, 2]));
        assert_eq!(places_among(&all, &[]), Some(Vec::new()));
        assert_eq!(places_among(&all, &[(ShellIx(4), Bottom)]), None);
        assert_eq!(places_among(&all, &[(ShellIx(2), Top)]), None);
    }
}
