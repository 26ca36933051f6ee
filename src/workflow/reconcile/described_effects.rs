//! Signatures of effects that the user describes: from a table, or from a solution of the edited deck.

use super::deck_frame::DeckFrame;
use super::signature_table::{SignatureTable, TableColumn};
use super::stiffness_changes::DeckStiffnessChange;
use crate::host::fault::{Fault, Faults};
use crate::host::files::Inputs;
use crate::job::{DescribedEffect, EffectSource, Job, NamedFile};
use crate::reconcile::strain::{StiffnessOf, StiffnessSignature};

/// Returns the hypothesis of this id.
pub(super) fn effect_of<'a>(job: &'a Job, id: &str) -> Option<&'a DescribedEffect> {
    effects(job).iter().find(|e| e.id == id)
}

/// Returns the factor on a thickness or a stiffness at a size: 1 at size 0, the job's factor at size 1. A thickness is linear in the size. A
/// stiffness is a power, so that twice a softening to a half gives a quarter. Returns `None` for a table.
pub(super) fn factor_at(source: &EffectSource, size: f64) -> Option<f64> {
    match source {
        EffectSource::Thickness { factor, .. } => Some(1.0 + size * (factor - 1.0)),
        EffectSource::Bush { factor, .. } if *factor > 0.0 => Some(factor.powf(size)),
        EffectSource::Bush { factor, .. } => Some(1.0 + size * (factor - 1.0)),
        EffectSource::Signature(_) => None,
    }
}

/// Returns the hypotheses of `[[reconcile.effect]]`, in job order.
pub(super) fn effects(job: &Job) -> &[DescribedEffect] {
    job.reconcile
        .as_ref()
        .map_or(&[], |r| r.described.as_slice())
}

/// Returns the signatures of the hypotheses with a table. An `edit` requires a deck.
///
/// # Errors
/// Tables that can't be read, or an edit without a deck.
pub(super) fn from_tables(
    inputs: &mut Inputs,
    job: &Job,
    channels: &[String],
    columns: &[TableColumn],
    n_columns: usize,
) -> Result<Vec<StiffnessSignature>, Faults> {
    let one = |e: &DescribedEffect| match &e.source {
        EffectSource::Signature(file) => Ok(signature(
            e,
            from_table(inputs, job, file, channels, columns, n_columns)?,
        )),
        _ => Err(Faults::from(Fault::with_line(
            &*job.file,
            e.line,
            "reconcile.effect.edit",
            format!("`{}` edits a deck, and the job gives S", e.id),
            "give a `signature`, or the deck in `[model]`",
        ))),
    };
    effects(job).iter().map(one).collect()
}

/// Reads the tables of the hypotheses as a check, and discards them.
///
/// # Errors
/// Tables that can't be read, gauges that a table lacks.
pub(super) fn check_inputs(
    inputs: &mut Inputs,
    job: &Job,
    channels: &[String],
    columns: &[TableColumn],
) -> Result<(), Faults> {
    for e in effects(job) {
        if let EffectSource::Signature(file) = &e.source {
            from_table(inputs, job, file, channels, columns, columns.len())?;
        }
    }
    Ok(())
}

fn signature(e: &DescribedEffect, change: Vec<f64>) -> StiffnessSignature {
    StiffnessSignature {
        of: StiffnessOf::Described,
        place: e.id.clone(),
        at_percent: vec![(1.0, change)],
        prior_percent: e.prior,
    }
}

fn from_table(
    inputs: &mut Inputs,
    job: &Job,
    file: &NamedFile,
    channels: &[String],
    columns: &[TableColumn],
    n_columns: usize,
) -> Result<Vec<f64>, Faults> {
    let t = SignatureTable::read(inputs, job, file, channels)?;
    let mut change = vec![0.0; channels.len() * n_columns];
    let named = |c: &TableColumn| Some((c.names.iter().find(|n| t.has(n))?.clone(), c.factor));
    let known: Vec<(usize, (String, f64))> = (columns.iter().enumerate())
        .filter_map(|(k, c)| Some((k, named(c)?)))
        .collect();
    if known.is_empty() {
        return Err(Faults::from(Fault::new(
            &*file.given,
            "header",
            "no column has the name of a load",
            "give a column for each load, with the name of the load or of its column of S",
        )));
    }
    for (c, (name, factor)) in known {
        for (g, v) in t.column(&name, factor)?.into_iter().enumerate() {
            if let Some(cell) = change.get_mut(g * n_columns + c) {
                *cell = v;
            }
        }
    }
    t.note_unread(inputs);
    Ok(change)
}

impl DeckFrame {
    /// Computes the signatures of all hypotheses of a job with a deck.
    ///
    /// # Errors
    /// Tables that can't be read, edits of items that the deck lacks, and errors of the solver.
    pub(super) fn compute_signatures(
        &self,
        inputs: &mut Inputs,
        job: &Job,
        channels: &[String],
        columns: &[TableColumn],
    ) -> Result<Vec<StiffnessSignature>, Faults> {
        let n = self.columns.len();
        let mut out = Vec::new();
        for e in effects(job) {
            let change = match &e.source {
                EffectSource::Signature(file) => {
                    from_table(inputs, job, file, channels, columns, n)?
                }
                _ => self.described_change(job, e, 1.0)?,
            };
            out.push(signature(e, change));
        }
        Ok(out)
    }

    /// Returns the change of the influence matrix by an edit of the deck at a size.
    pub(super) fn described_change(
        &self,
        job: &Job,
        e: &DescribedEffect,
        size: f64,
    ) -> Result<Vec<f64>, Faults> {
        let lacks = |what: String| {
            Faults::from(Fault::with_line(
                &*job.file,
                e.line,
                "reconcile.effect.edit",
                format!("the deck has no {what}"),
                "correct the id",
            ))
        };
        let factor = factor_at(&e.source, size).unwrap_or(1.0);
        let changed = match &e.source {
            EffectSource::Thickness { property, .. } => {
                let ids = self.shell_properties(|id| id == *property);
                if ids.is_empty() {
                    return Err(lacks(format!("PSHELL {property}")));
                }
                DeckStiffnessChange::Thickness(ids, factor)
            }
            EffectSource::Bush { element, .. } => {
                if !self.fields.model().bushes.iter().any(|b| b.id == *element) {
                    return Err(lacks(format!("CBUSH {element}")));
                }
                DeckStiffnessChange::Bush(element.to_string(), factor)
            }
            // A table does not change the deck.
            EffectSource::Signature(_) => return Ok(vec![0.0; self.base.len()]),
        };
        let mut changes = self.changes_by(job, &[changed])?;
        Ok(changes.pop().unwrap_or_default())
    }
}
