//! The difference of log evidence that a measurement is expected to bring between two explanations.

use super::alternative_misfit::residual_of_other;
use super::parameter_information::{ParameterInformation, Rows};
use super::view::{RecordEquations, View, Weight};
use crate::linalg::tall::{Triangle, solve, triangle};
use crate::reconcile::motion::design::Bins;

/// Returns half the squared misfit of the other explanation if the first one is true. `None` if both have different rows. The parameters of the other
/// explanation are free within the present record and declared tolerances.
///
/// The result is 1/2 min over x of |A x + d|^2 + |B x|^2 + |x / P|^2. Here d is the difference of both predicted readings over its standard
/// deviation. A are the columns of the other explanation in the new measurement, B its columns in the present record, and P the priors. Noise
/// contributes equally to both explanations.
pub(super) fn expected_evidence(
    known: &ParameterInformation,
    other: &View,
    truth: &View,
) -> Option<f64> {
    let other = match (other, truth) {
        (View::AtRest(o), View::AtRest(t)) if o.reading.len() == t.reading.len() => Rows {
            reading: (o.reading.iter().zip(&t.reading))
                .map(|(o, t)| o - t)
                .collect(),
            ..o.clone()
        },
        (View::Record(o), View::Record(t)) => o.rows(t)?,
        _ => return None,
    };
    if other.reading.iter().any(|d| !d.is_finite()) {
        return None;
    }
    let n_own = known.fit.columns.len();
    let mut columns: Vec<(Vec<f64>, Option<f64>)> = (known.fit.columns.iter())
        .zip(&other.own)
        .map(|(c, rows)| (rows.clone(), c.prior))
        .collect();
    columns.extend(other.scale.iter().map(|(_, rows)| (rows.clone(), None)));
    columns.extend(other.fresh);
    let n = columns.len();
    // Parameters that remain fixed have no column.
    let index = |c: &usize| match c.checked_sub(n_own) {
        None => *c,
        Some(k) => {
            let of = known.held.get(k);
            let at = other.scale.iter().position(|s| Some(&s.0) == of);
            at.map_or(usize::MAX, |at| n_own + at)
        }
    };
    let now = Triangle {
        columns: known.now.columns.iter().map(index).collect(),
        ..known.now.clone()
    };
    let priors: Vec<(usize, f64)> = (columns.iter().enumerate())
        .filter_map(|(k, c)| Some((k, c.1.filter(|sd| *sd > 0.0)?)))
        .collect();
    for (k, column) in columns.iter_mut().enumerate() {
        column
            .0
            .extend(priors.iter().map(|(of, sd)| match *of == k {
                true => 1.0 / sd,
                false => 0.0,
            }));
    }
    let mut target: Vec<f64> = other.reading.iter().map(|d| -d).collect();
    target.extend(vec![0.0; priors.len()]);
    let list: Vec<(usize, &[f64])> = (columns.iter().enumerate())
        .map(|(k, c)| (k, c.0.as_slice()))
        .chain([(n, target.as_slice())])
        .collect();
    let further = triangle(&list);
    let mut x = solve(&[(1.0, &now), (1.0, &further)], n).x;
    x.push(-1.0);
    let worth = 0.5 * (now.norm(&x).powi(2) + further.norm(&x).powi(2));
    worth.is_finite().then_some(worth)
}

impl RecordEquations {
    /// Returns the rows of this record, over its noise, times the root of the number of records. Their reading is the misfit to `truth`.
    fn rows(&self, truth: &Self) -> Option<Rows> {
        let times = self.repeats.sqrt();
        let rows = |bins: &[Bins], at_rest: Option<f64>| {
            let mut rows = self.whiten_bins(bins);
            rows.iter_mut().for_each(|v| *v *= times);
            if self.weight.is_some() {
                rows.push(at_rest.unwrap_or(0.0));
            }
            rows
        };
        let entry = |list: fn(&Weight) -> &[f64], k: usize| {
            let weight = self.weight.as_ref()?;
            list(weight).get(k).copied()
        };
        let (here, there) = (self.weight.as_ref(), truth.weight.as_ref());
        if here.is_some() != there.is_some() {
            return None;
        }
        let apart = here
            .zip(there)
            .map(|(h, t)| (h.weight - t.weight) / h.sigma);
        Some(Rows {
            reading: rows(&residual_of_other(self, truth)?, apart),
            own: (self.own.iter().enumerate())
                .map(|(k, c)| rows(c, entry(|w| &w.own, k)))
                .collect(),
            fresh: (self.fresh.iter().enumerate())
                .map(|(k, (c, sd))| (rows(c, entry(|w| &w.fresh, k)), *sd))
                .collect(),
            scale: (self.scale.iter().enumerate())
                .map(|(k, (i, c))| (*i, rows(c, entry(|w| &w.scale, k))))
                .collect(),
        })
    }
}
