//! Where small regions of shells may lie: round the gauges that disagree.

use super::deck_frame::DeckFrame;
use super::region::Region;
use crate::estimate::median;
use crate::model::{Model, Shell, Vec3};
use crate::reconcile::strain::StrainFrame;

/// Radii of the first regions, over the distance between gauges.
const WIDTHS: [f64; 3] = [0.35, 1.2, 3.0];
/// Number of small regions for each wide region.
const WIDER: usize = 3;
/// Smallest ratio of all shells to the shells of a region. A larger region is the structure, not a place in it.
const FEW: usize = 4;

/// Shells on which regions may be placed.
pub(super) struct Ground<'a> {
    pub(super) model: &'a Model,
    /// Middles of the shells.
    middles: Vec<Vec3>,
    /// Places of all gauges.
    places: Vec<Vec3>,
    /// Places of the gauges that disagree.
    off: Vec<Vec3>,
    /// Usual distance from gauge to gauge, at least three elements.
    apart: f64,
    /// Usual size of an element at these gauges.
    element: f64,
}

impl<'a> Ground<'a> {
    pub(super) fn from_frame(
        model: &'a Model,
        deck: &DeckFrame,
        frame: &StrainFrame,
        off: &[String],
    ) -> Option<Self> {
        let middles: Vec<Vec3> = model
            .shells
            .iter()
            .map(|s| shell_middle(model, s))
            .collect();
        let places: Vec<Vec3> = deck.gauges.iter().map(|g| g.position).collect();
        let is_off = |g: &usize| frame.gauges.get(*g).is_some_and(|f| off.contains(&f.name));
        let off: Vec<Vec3> = (0..places.len())
            .filter(is_off)
            .filter_map(|g| places.get(g).copied())
            .collect();
        let nearest = |to: &Vec3, among: &[Vec3], least: f64| {
            let far = among.iter().map(|p| (p - to).norm()).filter(|d| *d > least);
            far.min_by(f64::total_cmp)
        };
        let own = off.iter().filter_map(|p| {
            let own = find_closest(&middles, p)?;
            nearest(middles.get(own)?, &middles, 0.0)
        });
        let element = median(own.collect())?;
        let next = places.iter().filter_map(|p| nearest(p, &places, element));
        let apart = median(next.collect()).unwrap_or(element).max(3.0 * element);
        Some(Self {
            model,
            middles,
            places,
            off,
            apart,
            element,
        })
    }

    /// Returns the distance of a gauge from the nearest gauge that disagrees.
    pub(super) fn distance_of_gauge(&self, gauge: usize) -> f64 {
        let Some(at) = self.places.get(gauge) else {
            return f64::INFINITY;
        };
        let far = self.off.iter().map(|p| (p - at).norm());
        far.fold(f64::INFINITY, f64::min)
    }

    fn region(&self, centre: Vec3, radius: f64) -> Option<Region> {
        let shell = find_closest(&self.middles, &centre)?;
        let inside = |m: &Vec3| (m - centre).norm() <= radius;
        Some(Region {
            place: self.model.shells.get(shell)?.id.to_string(),
            centre,
            radius,
            shells: (0..self.middles.len())
                .filter(|&i| self.middles.get(i).is_some_and(inside))
                .collect(),
        })
    }

    /// Returns shells, ordered by their distance from the nearest gauge that disagrees. Any two of these shells are at least `apart` from each other.
    fn thin_shells(&self, mut shells: Vec<usize>, apart: f64, n: usize) -> Vec<usize> {
        let key = |s: &usize| -> f64 {
            let Some(m) = self.middles.get(*s) else {
                return f64::INFINITY;
            };
            let mut far: Vec<f64> = self.off.iter().map(|p| (p - m).norm()).collect();
            far.sort_by(f64::total_cmp);
            // A shell between two gauges that disagree comes before a shell beyond either gauge.
            far.iter().take(2).sum()
        };
        shells.sort_by(|a, b| key(a).total_cmp(&key(b)));
        let mut out: Vec<usize> = Vec::new();
        for s in shells {
            let Some(m) = self.middles.get(s) else {
                continue;
            };
            let free = |k: &usize| self.middles.get(*k).is_none_or(|p| (p - m).norm() >= apart);
            if out.len() < n && out.iter().all(free) {
                out.push(s);
            }
        }
        out
    }

    /// Returns regions of a third of the gauges' distance near the gauges that disagree, then fewer and wider regions. A section of a member that is
    /// weaker over several gauges can't be found by growing a small region.
    pub(super) fn first_regions(&self, n: usize) -> Vec<Region> {
        let mut out: Vec<Region> = Vec::new();
        for (k, width) in WIDTHS.into_iter().enumerate() {
            let most = if k == 0 { n } else { n / WIDER };
            for r in self.regions_of((width * self.apart).max(1.2 * self.element), most) {
                let small = r.shells.len() * FEW <= self.middles.len();
                if (k == 0 || small) && out.iter().all(|o| o.shells != r.shells) {
                    out.push(r);
                }
            }
        }
        out
    }

    /// At most `n` regions of this radius round the gauges that disagree.
    fn regions_of(&self, radius: f64, n: usize) -> Vec<Region> {
        let close = |i: &usize| {
            let m = self.middles.get(*i);
            m.is_some_and(|m| self.off.iter().any(|p| (p - m).norm() <= self.apart))
        };
        let shells = (0..self.middles.len()).filter(close).collect();
        let chosen = self.thin_shells(shells, radius, n);
        chosen
            .into_iter()
            .filter_map(|s| self.region(*self.middles.get(s)?, radius))
            .collect()
    }

    /// Returns the regions round grids and shells about a region's middle, `step` of a radius apart, narrower, as wide and wider.
    pub(super) fn regions_near(&self, r: &Region, step: f64, n: usize) -> Vec<Region> {
        let reach = (1.5 * step * r.radius).max(0.8 * self.element);
        let grids = self.model.grids.iter().map(|g| g.x);
        let mut centres: Vec<Vec3> = (self.middles.iter().copied())
            .chain(grids)
            .filter(|x| (x - r.centre).norm() <= reach)
            .collect();
        centres.sort_by(|a, b| {
            (a - r.centre)
                .norm_squared()
                .total_cmp(&(b - r.centre).norm_squared())
        });
        let apart = (0.7 * step * r.radius).max(0.6 * self.element);
        let mut chosen: Vec<Vec3> = Vec::new();
        for c in centres {
            if chosen.len() < n && chosen.iter().all(|k| (k - c).norm() >= apart) {
                chosen.push(c);
            }
        }
        let around = |c: Vec3| {
            [1.0, 1.0 + 0.5 * step, 1.0 / (1.0 + 0.5 * step), 1.0 + step]
                .map(|times| self.region(c, times * r.radius))
        };
        let all = chosen.into_iter().flat_map(around).flatten();
        all.filter(|x| !x.shells.is_empty()).collect()
    }
}

fn shell_middle(model: &Model, s: &Shell) -> Vec3 {
    let corners = &s.grids[..s.shape.n_corners().min(s.grids.len())];
    let sum: Vec3 = corners
        .iter()
        .filter_map(|g| model.grids.get(g.us()))
        .map(|g| g.x)
        .sum();
    sum / corners.len().max(1) as f64
}

fn find_closest(places: &[Vec3], to: &Vec3) -> Option<usize> {
    let far = |i: &usize| {
        places
            .get(*i)
            .map_or(f64::INFINITY, |p| (p - to).norm_squared())
    };
    (0..places.len()).min_by(|a, b| far(a).total_cmp(&far(b)))
}
