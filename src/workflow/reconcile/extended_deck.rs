//! The analyst's deck with named effects in it.

use super::deck_frame::{DeckFrame, unit};
use super::described_effects::effect_of;
use super::extended_loads::{SideLoad, cards};
use super::extended_model::DECK;
use super::influence::{readings, solve};
use super::one_file::one_file;
use super::stiffness::factor;
use crate::host::fault::Faults;
use crate::job::{Component, EffectSource, Job};
use crate::model::Model;
use crate::reconcile::strain::StiffnessOf;
use crate::units::KILO;
use nastran::bdf::{Edits, Field, MemoryLoader, ToFields, format_card, read_deck, write_edited};
use nastran::cards::{Bush, Orientation, Pbush};

/// An identified stiffness: its kind, place and size.
pub(super) type NamedStiffness = (StiffnessOf, String, f64);

impl DeckFrame {
    /// Returns the deck in one file, with thickened zones, changed joints, added masses and a load set of side loads. A comment precedes each edited
    /// card. Returns `None` if nothing changes or if the deck can't be written.
    pub(super) fn extend_deck(
        &self,
        job: &Job,
        stiffness: &[NamedStiffness],
        masses: &[(String, f64)],
        side: &[SideLoad],
    ) -> Option<Vec<u8>> {
        let deck = &self.fields.deck.deck;
        if stiffness.is_empty() && masses.is_empty() && side.is_empty() {
            return None;
        }
        let mut edits = Edits::default();
        for (of, place, percent) in stiffness {
            let factor = factor(job, *of, place, *percent)?;
            match of {
                StiffnessOf::Joint => self.change_joint(&mut edits, place, factor)?,
                StiffnessOf::Zone => {
                    let ids = self.zones.get(place)?;
                    let words = format!("zone {place}");
                    self.change_thickness(&mut edits, &words, |id| ids.contains(id), factor)?;
                }
                StiffnessOf::Described => match effect_of(job, place)?.source {
                    EffectSource::Thickness { property, .. } => {
                        self.change_thickness(&mut edits, place, |id| id == property, factor)?;
                    }
                    EffectSource::Bush { element, .. } => {
                        self.change_joint(&mut edits, &element.to_string(), factor)?;
                    }
                    EffectSource::Signature(_) => return None,
                },
                StiffnessOf::Local => return None,
            }
        }
        self.add_masses(&mut edits, job, masses)?;
        if !side.is_empty() {
            let sets = self.fields.model().load_sets.iter().map(|s| s.sid);
            let sid = sets.max().unwrap_or(0).checked_add(1)?;
            let note = comment_line("side loads as found, root mean square over the runs");
            edits.insert_cards(deck, &(note + &cards(job, sid, side)));
        }
        one_file(deck, write_edited(deck, &edits))
    }

    /// Scales the thickness of the shell properties `wanted`.
    fn change_thickness(
        &self,
        edits: &mut Edits,
        words: &str,
        wanted: impl Fn(u32) -> bool,
        factor: f64,
    ) -> Option<()> {
        let deck = &self.fields.deck.deck;
        let named = deck.cards.pshells.iter().filter(|p| wanted(p.card.id));
        for p in named {
            let c = &p.card;
            let scaled = |v: Option<f64>| v.map(|v| v * factor);
            let fields = [
                Field::from(c.id),
                c.mid1.into(),
                scaled(c.t).into(),
                c.mid2.into(),
                c.bending_ratio.into(),
                c.mid3.into(),
                c.shear_ratio.into(),
                c.nsm.into(),
                scaled(c.z1).into(),
                scaled(c.z2).into(),
                c.mid4.into(),
            ];
            edits
                .replace_card(
                    deck,
                    p.at,
                    &(comment_line(&format!("{words}: thickness times {factor:.4}"))
                        + &format_card("PSHELL", &fields)),
                )
                .ok()?;
        }
        let of_property =
            |pid: u32| wanted(pid) && deck.cards.pshells.iter().any(|p| p.card.id == pid);
        let shells = deck.cards.shells.iter();
        for s in shells.filter(|s| of_property(s.card.pid.unwrap_or(s.card.id))) {
            if let Some(card) = s.card.with_thickness_times(factor) {
                edits.replace_card(deck, s.at, &card.to_card()).ok()?;
            }
        }
        Some(())
    }

    /// Gives a bush a separate property, the old one times `factor`.
    fn change_joint(&self, edits: &mut Edits, place: &str, factor: f64) -> Option<()> {
        let deck = &self.fields.deck.deck;
        let bushes = &deck.cards.bushes;
        let bush = bushes.iter().find(|b| b.card.id.to_string() == place)?;
        let pid = bush.card.pid.unwrap_or(bush.card.id);
        let old = deck.cards.pbushes.iter().find(|p| p.card.id == pid)?.card;
        let c = &deck.cards;
        let others = c.pshells.iter().map(|p| p.card.id);
        let others = others.chain(c.pbars.iter().map(|p| p.card.id));
        let others = others.chain(c.pbarls.iter().map(|p| p.card.id));
        let others = others.chain(c.pbeams.iter().map(|p| p.card.id));
        let others = others.chain(c.pbeamls.iter().map(|p| p.card.id));
        let others = others.chain(c.prods.iter().map(|p| p.card.id));
        let others = others.chain(c.ptubes.iter().map(|p| p.card.id));
        let others = others.chain(c.pcomps.iter().map(|p| p.card.id));
        let others = others.chain(c.psolids.iter().map(|p| p.card.id));
        let others = others.chain(c.pelas.iter().map(|p| p.card.id));
        let highest = others.chain(c.pbushes.iter().map(|p| p.card.id)).max();
        // The id is above all others, and is different for every bush.
        let id = highest?.checked_add(bush.card.id)?;
        edits.insert_cards(
            deck,
            &(comment_line(&format!("joint {place}: stiffness times {factor:.4}"))
                + &pbush(&Pbush {
                    id,
                    k: old.k.map(|k| k * factor),
                    ..old
                })),
        );
        let card = cbush(&Bush {
            pid: Some(id),
            ..bush.card
        });
        let note = comment_line(&format!("joint {place}: its separate property is {id}"));
        edits.replace_card(deck, bush.at, &(note + &card)).ok()
    }

    fn add_masses(&self, edits: &mut Edits, job: &Job, masses: &[(String, f64)]) -> Option<()> {
        let deck = &self.fields.deck.deck;
        let shells = self.fields.model().shells.iter().map(|s| s.id);
        let taken = shells
            .chain(deck.cards.conm2s.iter().map(|c| c.card.id))
            .max();
        for (k, (place, kilogram)) in (1u32..).zip(masses) {
            let grid = *job.reconcile.as_ref()?.places.get(place)?;
            let mass = kilogram / job.units.mass_kg();
            let fields = [
                Field::from(taken.unwrap_or(0).checked_add(k)?),
                grid.into(),
                Field::Blank,
                mass.into(),
            ];
            let note = comment_line(&format!("a mass that the model lacked at {place}"));
            edits.insert_cards(deck, &(note + &format_card("CONM2", &fields)));
        }
        Some(())
    }
}

impl DeckFrame {
    /// Returns the change of the strain of a kilogram's weight at grid `id` by the written deck, microstrain by gauge. Under inertia relief a mass in
    /// the model accelerates with the model. `None` if the grid does not exist.
    ///
    /// # Errors
    /// The faults that stop the solver.
    pub(super) fn weight_gains(
        &self,
        job: &Job,
        written: &[u8],
        id: u32,
    ) -> Result<Option<Vec<f64>>, Faults> {
        let deck = read_deck(DECK, written.to_vec(), &mut MemoryLoader::default());
        let model = Model::from_deck(&deck).0;
        let strain = |model: &Model| -> Result<Option<Vec<f64>>, Faults> {
            let Some(grid) = model.grid_ix(id) else {
                return Ok(None);
            };
            let weight = unit(job, grid, Component::FZ, -job.gravity_m_s2() / KILO);
            let solution = solve(job, model, &[weight], &self.stop)?;
            Ok(Some(readings(&self.gauges, &solution, 0..1)))
        };
        let (Some(now), Some(before)) = (strain(&model)?, strain(self.fields.model())?) else {
            return Ok(None);
        };
        Ok(Some(now.iter().zip(&before).map(|(a, b)| a - b).collect()))
    }
}

/// Returns a comment line before an edited card.
fn comment_line(words: &str) -> String {
    format!("$ reconcile: {words}\n")
}

fn pbush(p: &Pbush) -> String {
    let word = |w: &str| Field::Text(w.into());
    let mut fields = vec![Field::from(p.id), word("K")];
    for (k, rigid) in p.k.iter().zip(p.rigid) {
        fields.push(if rigid { word("RIGID") } else { (*k).into() });
    }
    for (name, values) in [("B", p.b), ("GE", p.ge)] {
        fields.extend([Field::Blank, word(name)]);
        fields.extend(values.map(Field::from));
    }
    fields.extend([Field::Blank, word("RCV")]);
    fields.extend(p.recovery.map(Field::from));
    format_card("PBUSH", &fields)
}

fn cbush(b: &Bush) -> String {
    let mut fields = vec![
        Field::from(b.id),
        b.pid.into(),
        b.grids.0.into(),
        b.grids.1.into(),
    ];
    match b.orientation {
        Orientation::Grid(g) => fields.extend([g.into(), Field::Blank, Field::Blank]),
        Orientation::Vector(v) => fields.extend(v.map(Field::from)),
        _ => fields.extend([Field::Blank, Field::Blank, Field::Blank]),
    }
    fields.push(b.cid.into());
    fields.push(b.s.into());
    if let Some(ocid) = b.ocid {
        fields.push(ocid.into());
        fields.extend(b.offset.map(Field::from));
    }
    format_card("CBUSH", &fields)
}
