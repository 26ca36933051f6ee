//! Strain of results compared with the strain that the built-in solver computes on the deck.

use crate::fe::{BeamField, CaseResult, PlaneStrain, ShellField};
use crate::model::ShellIx;

/// Difference between the strain of results and the strain of the built-in solver under the same load.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainDifference {
    /// Sum of the absolute differences over the sum of the larger absolute values: 0 for equal fields, 2 for fields of opposite sign.
    pub share: f64,
    /// Mean of the larger absolute values.
    pub mean: f64,
    /// Factor of the solved field that fits the results best (least squares).
    pub factor: f64,
    /// Cosine of the angle between both fields. It is 1 if the fields differ only by a positive factor.
    pub cosine: f64,
    /// Shells of both fields that are strained at least half as much as the mean of all shells. The number is the sum of the
    /// differences of a shell divided by the sum of its larger values, as in `share`.
    pub of_shells: Vec<(ShellIx, f64)>,
}

impl StrainDifference {
    /// Compares the strain of shells at the centre of both surfaces, and of bars at their stations. Elements without strain in one of the fields are
    /// not compared. `None` if no element has strain in both fields.
    pub fn compare(results: &CaseResult, solved: &CaseResult) -> Option<Self> {
        let shells = sums_of_shells(&results.shells, &solved.shells);
        let mean = shells.iter().map(|s| s.1.larger).sum::<f64>() / shells.len().max(1) as f64;
        let strained = shells.iter().filter(|s| s.1.larger > mean / 2.0);
        let of_shells = strained.map(|(ix, s)| (*ix, s.differences / s.larger));
        let of_shells = of_shells.collect();
        let mut sums = sums_of_beams(&results.beams, &solved.beams);
        shells
            .iter()
            .for_each(|(_, of_shell)| sums.add_up(of_shell));
        let ([rr, rs, ss], larger) = (sums.products, sums.larger);
        (larger > 0.0).then(|| Self {
            share: sums.differences / larger,
            mean: larger / sums.count as f64,
            factor: rs / ss.max(f64::MIN_POSITIVE),
            cosine: rs / (rr * ss).sqrt().max(f64::MIN_POSITIVE),
            of_shells,
        })
    }
}

/// Sums over the values of both fields.
#[derive(Default)]
struct Sums {
    count: usize,
    differences: f64,
    larger: f64,
    /// Results times results, results times solved, solved times solved.
    products: [f64; 3],
}

impl Sums {
    fn add(&mut self, result: f64, solved: f64) {
        if !(result.is_finite() && solved.is_finite()) {
            return;
        }
        self.count += 1;
        self.differences += (result - solved).abs();
        self.larger += result.abs().max(solved.abs());
        for (sum, product) in
            self.products
                .iter_mut()
                .zip([result * result, result * solved, solved * solved])
        {
            *sum += product;
        }
    }

    fn add_up(&mut self, other: &Self) {
        self.count += other.count;
        self.differences += other.differences;
        self.larger += other.larger;
        for (sum, product) in self.products.iter_mut().zip(other.products) {
            *sum += product;
        }
    }
}

/// Sums of each shell in both fields: strain at the centre of both surfaces.
fn sums_of_shells(results: &ShellField, solved: &ShellField) -> Vec<(ShellIx, Sums)> {
    let in_both = |(shell, result): (&ShellIx, &[PlaneStrain; 2])| {
        let row = solved.elements.binary_search(shell).ok()?;
        let mut sums = Sums::default();
        let values = solved.centre.get(row)?.iter().flatten();
        for (r, s) in result.iter().flatten().zip(values) {
            sums.add(*r, *s);
        }
        Some((*shell, sums))
    };
    let rows = results.elements.iter().zip(&results.centre);
    rows.filter_map(in_both).collect()
}

/// Sums of all bars in both fields: strain of the recovery points at the stations of the results.
fn sums_of_beams(results: &BeamField, solved: &BeamField) -> Sums {
    let mut sums = Sums::default();
    for (beam, stations) in results.elements.iter().zip(&results.stations) {
        for (station, points) in stations {
            let Some((values, _)) = solved.strain_at(*beam, *station) else {
                continue;
            };
            for (r, s) in points.iter().zip(values) {
                sums.add(*r, s);
            }
        }
    }
    sums
}
