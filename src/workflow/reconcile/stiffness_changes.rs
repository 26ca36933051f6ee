//! The deck with another stiffness somewhere, and what that does to the influence matrix.

use super::deck_frame::DeckFrame;
use super::influence::{blank_payload, influence, small_changes, solve_each};
use crate::gauge::{Gauge, strain_terms};
use crate::host::fault::Faults;
use crate::job::Job;
use crate::model::{MaterialIx, MaterialKind, Model, ShellKind, ShellPropertyIx};
use std::collections::BTreeMap;

/// A change of the deck's stiffness, and its factor.
pub(super) enum DeckStiffnessChange {
    /// Stiffness of a bush, by id.
    Bush(String, f64),
    /// Moduli of some shells.
    Shells(Vec<usize>, f64),
    /// Thickness of some PSHELL cards.
    Thickness(Vec<u32>, f64),
}

impl DeckFrame {
    /// Returns the change of the influence matrix by each change of the deck, from solutions of the changed models on the mesh of the deck.
    pub(super) fn changes_by(
        &self,
        job: &Job,
        all: &[DeckStiffnessChange],
    ) -> Result<Vec<Vec<f64>>, Faults> {
        if all.is_empty() {
            return Ok(Vec::new());
        }
        let models = all.iter().map(|c| self.model_with(c));
        let (model, n) = (self.fields.model(), self.columns.len());
        solve_each(
            job,
            model,
            &self.columns,
            models,
            &self.stop,
            |model, solution| {
                let now = influence(job, model, &self.gauges, solution, n);
                now.iter().zip(&self.base).map(|(a, b)| a - b).collect()
            },
        )
    }

    /// Returns the change of the influence matrix by each change of the deck. If all gauges are on shells, one factor serves for all changes. The
    /// result is then exact for bushes, and of first order for shells. Otherwise the changes are computed as in [`Self::changes_by`].
    pub(super) fn small_changes_by(
        &self,
        job: &Job,
        all: &[DeckStiffnessChange],
    ) -> Result<Vec<Vec<f64>>, Faults> {
        let n = self.columns.len();
        let terms: Vec<_> = self.gauges.iter().map(strain_terms).collect();
        let on_shells = |(g, terms): (&Gauge, &Vec<_>)| terms.len() == g.arms.len();
        if !self.gauges.iter().zip(&terms).all(on_shells) {
            return self.changes_by(job, all);
        }
        let models = all.iter().map(|c| self.model_with(c));
        let (model, asked) = (self.fields.model(), (&*self.columns, &*terms));
        let Some(mut changes) = small_changes(job, model, asked, models, &self.stop)? else {
            return self.changes_by(job, all);
        };
        for change in &mut changes {
            blank_payload(job, model, change, n);
        }
        Ok(changes)
    }

    fn model_with(&self, changed: &DeckStiffnessChange) -> Model {
        match changed {
            DeckStiffnessChange::Bush(id, factor) => self.with_joint(id, *factor),
            DeckStiffnessChange::Shells(shells, factor) => {
                scale_shell_moduli(self.fields.model(), shells, *factor)
            }
            DeckStiffnessChange::Thickness(ids, factor) => self.with_properties(ids, *factor),
        }
    }

    fn with_joint(&self, place: &str, factor: f64) -> Model {
        let mut model = self.fields.model().clone();
        for b in model
            .bushes
            .iter_mut()
            .filter(|b| b.id.to_string() == place)
        {
            b.k.iter_mut().for_each(|k| *k *= factor);
        }
        model
    }

    /// Returns the ids of the PSHELL cards that are wanted.
    pub(super) fn shell_properties(&self, wanted: impl Fn(u32) -> bool) -> Vec<u32> {
        let cards = self.fields.deck.deck.cards.pshells.iter();
        cards.map(|p| p.card.id).filter(|id| wanted(*id)).collect()
    }

    /// Returns the model with a scaled thickness of these shell properties.
    fn with_properties(&self, ids: &[u32], factor: f64) -> Model {
        let mut deck = self.fields.deck.deck.clone();
        let cards = deck.cards.pshells.iter_mut();
        for p in cards.filter(|p| ids.contains(&p.card.id)) {
            p.card.t = p.card.t.map(|t| t * factor);
            p.card.z1 = p.card.z1.map(|z| z * factor);
            p.card.z2 = p.card.z2.map(|z| z * factor);
        }
        let shells = deck.cards.shells.iter_mut();
        for s in shells.filter(|s| ids.contains(&s.card.pid.unwrap_or(s.card.id))) {
            if let Some(card) = s.card.with_thickness_times(factor) {
                s.card = card;
            }
        }
        Model::from_deck(&deck).0
    }
}

/// Returns the model with the moduli of these shells times `factor`. The shells get separate properties and materials with the highest ids.
fn scale_shell_moduli(model: &Model, shells: &[usize], factor: f64) -> Model {
    let mut out = model.clone();
    let mut materials: BTreeMap<u32, MaterialIx> = BTreeMap::new();
    let mut properties: BTreeMap<u32, ShellPropertyIx> = BTreeMap::new();
    let next_material = out.materials.iter().map(|m| m.id).max().unwrap_or(0);
    let next_property = out.shell_properties.iter().map(|p| p.id).max().unwrap_or(0);
    for &s in shells {
        let Some(old) = out.shells.get(s).map(|s| s.property) else {
            continue;
        };
        let new = match properties.get(&old.0) {
            Some(new) => *new,
            None => {
                let Some(mut property) = out.shell_properties.get(old.us()).cloned() else {
                    continue;
                };
                let mut weaker = |m: MaterialIx, list: &mut Vec<crate::model::Material>| {
                    *materials.entry(m.0).or_insert_with(|| {
                        let Some(mut material) = list.get(m.us()).copied() else {
                            return m;
                        };
                        scale(&mut material.kind, factor);
                        let n = list.len() as u32;
                        material.id = next_material.saturating_add(n + 1);
                        list.push(material);
                        MaterialIx(n)
                    })
                };
                match &mut property.kind {
                    ShellKind::Homogeneous {
                        membrane,
                        bending,
                        shear,
                        coupling,
                        ..
                    } => {
                        for m in [membrane, bending, shear, coupling].into_iter().flatten() {
                            *m = weaker(*m, &mut out.materials);
                        }
                    }
                    ShellKind::Laminate { plies, .. } => {
                        for p in plies {
                            p.material = weaker(p.material, &mut out.materials);
                        }
                    }
                }
                let n = out.shell_properties.len() as u32;
                property.id = next_property.saturating_add(n + 1);
                out.shell_properties.push(property);
                *properties.entry(old.0).or_insert(ShellPropertyIx(n))
            }
        };
        if let Some(shell) = out.shells.get_mut(s) {
            shell.property = new;
        }
    }
    out
}

/// Multiplies all moduli by a factor. Poisson's ratio does not change.
fn scale(kind: &mut MaterialKind, factor: f64) {
    match kind {
        MaterialKind::Isotropic { e, g, .. } => {
            *e *= factor;
            *g *= factor;
        }
        MaterialKind::Anisotropic2d { g, .. } => g.iter_mut().for_each(|v| *v *= factor),
        MaterialKind::Orthotropic {
            e1,
            e2,
            g12,
            g1z,
            g2z,
            ..
        } => {
            for v in [e1, e2, g12, g1z, g2z] {
                *v *= factor;
            }
        }
        MaterialKind::Anisotropic3d { g, .. } => g.iter_mut().for_each(|v| *v *= factor),
    }
}
