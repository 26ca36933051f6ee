//! Shell rows of one subcase.

use super::blocks::shell_corners;
use super::ids::Ids;
use super::tally::{Irregularity, Tally};
use crate::fe::strain_tensor::{strain_from_curvature, strain_from_stress};
use crate::fe::{PlaneStrain, ShellField};
use crate::model::{Fibres, MaterialKind, Model, Shell, ShellIx, ShellKind};
use nastran::results::{Block, Quantity, Rows, ShellForm, columns};
use std::sync::Arc;

/// Fibre distances count as equal up to this share of the thickness: single precision with room for the deck's rounding.
const FIBRE_TOLERANCE: f64 = 1e-4;

/// Collector of the shell rows of one subcase, block by block.
pub(super) struct ShellCollector<'m> {
    model: &'m Model,
    /// Slot of each shell of the model.
    slots: Vec<u32>,
    elements: Vec<ShellIx>,
    centre: Vec<[PlaneStrain; 2]>,
    corners: Vec<[[PlaneStrain; 2]; 4]>,
    has_corners: bool,
    from_stress: bool,
}

const NONE: u32 = u32::MAX;
const NO_STRAIN: [PlaneStrain; 2] = [[f64::NAN; 3]; 2];

impl<'m> ShellCollector<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            slots: vec![NONE; model.shells.len()],
            elements: Vec::new(),
            centre: Vec::new(),
            corners: Vec::new(),
            has_corners: false,
            from_stress: false,
        }
    }

    /// Returns whether the rows are shell strain or stress at two fibres.
    pub(super) fn takes(rows: &Rows) -> bool {
        rows.columns == columns::SHELL_STRAIN || rows.columns == columns::SHELL_STRESS
    }

    /// Adds a block of strain or stress rows.
    pub(super) fn add(&mut self, block: &Block, rows: &Rows, tally: &mut Tally) {
        let mut ids = Ids::new(&self.model.shells, |s| s.id);
        let mut current: Option<(u32, Option<Target>)> = None;
        let mut i = 0;
        while let Some(first) = rows.ids.get(i) {
            let pair = rows.ids.get(i + 1).filter(|second| {
                (first.layer, second.layer) == (1, 2)
                    && (first.entity, first.at) == (second.entity, second.at)
            });
            if pair.is_none() {
                tally.add(Irregularity::Unpaired, first.entity);
                i += 1;
                continue;
            }
            let fibres = [row(rows, i), row(rows, i + 1)];
            i += 2;
            let target = match current {
                Some((entity, target)) if entity == first.entity => target,
                _ => {
                    // `deck_result_consistency` reports elements that the model lacks.
                    let target = ids
                        .find(first.entity)
                        .and_then(|ix| self.target(ix, block, &fibres, tally));
                    current = Some((first.entity, target));
                    target
                }
            };
            let Some(target) = target else { continue };
            self.store_fibres(target, first.at, &fibres, tally);
        }
    }

    /// Returns the target of the rows of shell `ix`. `None` if the rows cannot be used.
    fn target(
        &mut self,
        ix: usize,
        block: &Block,
        fibres: &[[f64; 4]; 2],
        tally: &mut Tally,
    ) -> Option<Target> {
        let shell = self.model.shells.get(ix)?;
        if shell_corners(block).is_some_and(|n| n != shell.shape.n_corners()) {
            tally.add(Irregularity::OtherType, shell.id);
            return None;
        }
        let z = self.model.fibres(shell);
        let law = match block.quantity {
            Quantity::Stress => {
                let law = isotropic_constants(self.model, shell);
                tally.add(
                    if law.is_some() {
                        Irregularity::ShellFromStress
                    } else {
                        Irregularity::NotIsotropic
                    },
                    shell.id,
                );
                Law::Stress(law?)
            }
            _ if block.form == Some(ShellForm::Curvature) => Law::Curvature(z),
            _ => Law::Fibre,
        };
        if !matches!(law, Law::Curvature(_)) {
            let z = z.centre;
            let thickness = (z[1] - z[0]).abs();
            // The fibre distances of an unsupported property are unknown.
            let known = thickness > 0.0;
            for (fibre, z) in fibres.iter().zip(z).filter(|_| known) {
                if (fibre[0] - z).abs() > FIBRE_TOLERANCE * thickness {
                    tally.add_measured(Irregularity::OtherFibres, shell.id, fibre[0], z);
                    break;
                }
            }
        }
        self.from_stress |= matches!(law, Law::Stress(_));
        let slot = self.slots.get_mut(ix)?;
        if *slot == NONE {
            *slot = u32::try_from(self.elements.len()).ok()?;
            self.elements.push(ShellIx(u32::try_from(ix).ok()?));
            self.centre.push(NO_STRAIN);
            self.corners.push([NO_STRAIN; 4]);
        }
        Some(Target {
            slot: *slot as usize,
            law,
        })
    }

    fn store_fibres(&mut self, target: Target, at: u32, fibres: &[[f64; 4]; 2], tally: &mut Tally) {
        if at == 0 {
            if let Some(centre) = self.centre.get_mut(target.slot) {
                *centre = target.strain(fibres, None);
            }
            return;
        }
        let Some(shell) = self
            .elements
            .get(target.slot)
            .and_then(|e| self.model.shells.get(e.us()))
        else {
            return;
        };
        let id = |i: usize| {
            shell
                .grids
                .get(i)
                .and_then(|g| self.model.grids.get(g.us()))
                .map(|g| g.id)
        };
        match (0..shell.shape.n_corners()).find(|&i| id(i) == Some(at)) {
            Some(corner) => {
                self.has_corners = true;
                if let Some(place) = self
                    .corners
                    .get_mut(target.slot)
                    .and_then(|c| c.get_mut(corner))
                {
                    *place = target.strain(fibres, Some(corner));
                }
            }
            None => tally.add(Irregularity::ForeignCorner, shell.id),
        }
    }

    /// Returns the field with ascending elements.
    pub(super) fn finish(self) -> ShellField {
        let mut order: Vec<usize> = (0..self.elements.len()).collect();
        let sorted = self.elements.is_sorted();
        if !sorted {
            order.sort_by_key(|&i| self.elements.get(i));
        }
        let pick = |i: &usize| self.elements.get(*i).copied();
        let (centre, corners) = if sorted {
            (
                self.centre,
                if self.has_corners {
                    self.corners
                } else {
                    Vec::new()
                },
            )
        } else {
            let centre = order
                .iter()
                .filter_map(|&i| self.centre.get(i).copied())
                .collect();
            let corners = order
                .iter()
                .filter(|_| self.has_corners)
                .filter_map(|&i| self.corners.get(i).copied())
                .collect();
            (centre, corners)
        };
        let elements = Arc::new(order.iter().filter_map(pick).collect());
        ShellField {
            elements,
            centre,
            corners,
            from_stress: self.from_stress,
        }
    }
}

fn row(rows: &Rows, i: usize) -> [f64; 4] {
    match rows.row(i) {
        [z, x, y, xy, ..] => [*z, *x, *y, *xy],
        _ => [f64::NAN; 4],
    }
}

/// Slot for the rows of an element, and the conversion of these rows to strain.
#[derive(Clone, Copy)]
struct Target {
    slot: usize,
    law: Law,
}

#[derive(Clone, Copy)]
enum Law {
    Fibre,
    Curvature(Fibres),
    /// E, G, nu.
    Stress([f64; 3]),
}

impl Target {
    /// Strain at the surfaces, at a corner or the centre, from rows of fibre distance and three components.
    fn strain(self, fibres: &[[f64; 4]; 2], corner: Option<usize>) -> [PlaneStrain; 2] {
        let values = fibres.map(|[_, x, y, xy]| [x, y, xy]);
        match self.law {
            Law::Fibre => values,
            Law::Curvature(z) => z
                .distances_at(corner)
                .map(|z| strain_from_curvature(values[0], values[1], z)),
            Law::Stress([e, g, nu]) => values.map(|s| strain_from_stress(s, e, g, nu)),
        }
    }
}

/// E, G, nu of a shell that is one isotropic material in membrane and bending.
fn isotropic_constants(model: &Model, shell: &Shell) -> Option<[f64; 3]> {
    let property = model.shell_properties.get(shell.property.us())?;
    let ShellKind::Homogeneous {
        membrane, bending, ..
    } = property.kind
    else {
        return None;
    };
    let law = |ix: crate::model::MaterialIx| match model.materials.get(ix.us())?.kind {
        MaterialKind::Isotropic { e, g, nu, .. } => Some([e, g, nu]),
        _ => None,
    };
    match (membrane, bending) {
        (Some(m), Some(b)) => law(m).filter(|&l| m == b || law(b) == Some(l)),
        (Some(one), None) | (None, Some(one)) => law(one),
        (None, None) => None,
    }
}
