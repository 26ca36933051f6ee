//! Loads of a record compared with the range of their calibration.

use super::kernel::Kernel;
use crate::finding::Finding;
use crate::recovery::history::Filter;
use crate::recovery::outside_calibration::CalibratedLoad;
use crate::workflow::recover::record_beyond_calibration;

impl Kernel {
    /// Returns findings on loads beyond the range of a calibrated S. `ends` contains the smallest and the largest value of each load, report units.
    pub(super) fn beyond_calibration(
        &self,
        filter: &Filter,
        ends: &[[f64; 2]],
        samples: usize,
    ) -> Vec<Finding> {
        let units = &self.listed.units;
        let end = |which: usize| -> Vec<f64> {
            let values = ends.iter().zip(units);
            values.map(|(e, u)| e[which] / u.factor).collect()
        };
        let (min, max) = (end(0), end(1));
        let largest = |(a, b): (&f64, &f64)| a.abs().max(b.abs());
        let sizes: Vec<f64> = min.iter().zip(&max).map(largest).collect();
        let factor = filter.coverage_factor();
        let halves: Vec<f64> = filter.sigma(&sizes).iter().map(|s| factor * s).collect();
        let loads = self.sensitivity.loads.iter().zip(units).zip(&self.ranges);
        let loads: Vec<(usize, CalibratedLoad)> = (loads.enumerate())
            .filter_map(|(l, ((load, unit), range))| {
                let load = CalibratedLoad {
                    name: &load.name,
                    range: range.filter(|_| load.wanted)?,
                    unit: (unit.factor, &unit.name),
                };
                Some((l, load))
            })
            .collect();
        let of = ("record", samples as u64);
        record_beyond_calibration(&loads, of, (&min, &max, &halves))
    }
}
