//! Elements with stiffness of all kinds as one list, with their common data. If the kinds differ, a `match` lists every kind.

use super::{Beam, GridIx, Joint, Model, Shell, Solid};

/// One element, stated by its index in the list of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ElementRef {
    Shell(usize),
    Beam(usize),
    Rod(usize),
    Bush(usize),
    Joint(usize),
    Spring(usize),
    Solid(usize),
    ShearPanel(usize),
}

impl Model {
    /// Returns every element with stiffness, kind by kind.
    pub(crate) fn elements(&self) -> impl Iterator<Item = ElementRef> + use<> {
        (0..self.shells.len())
            .map(ElementRef::Shell)
            .chain((0..self.beams.len()).map(ElementRef::Beam))
            .chain((0..self.rods.len()).map(ElementRef::Rod))
            .chain((0..self.bushes.len()).map(ElementRef::Bush))
            .chain((0..self.joints.len()).map(ElementRef::Joint))
            .chain((0..self.springs.len()).map(ElementRef::Spring))
            .chain((0..self.solids.len()).map(ElementRef::Solid))
            .chain((0..self.shear_panels.len()).map(ElementRef::ShearPanel))
    }

    /// Returns the id.
    pub(crate) fn element_id(&self, element: ElementRef) -> u32 {
        match element {
            ElementRef::Shell(i) => self.shells[i].id,
            ElementRef::Beam(i) => self.beams[i].id,
            ElementRef::Rod(i) => self.rods[i].id,
            ElementRef::Bush(i) => self.bushes[i].id,
            ElementRef::Joint(i) => self.joints[i].id,
            ElementRef::Spring(i) => self.springs[i].id,
            ElementRef::Solid(i) => self.solids[i].id,
            ElementRef::ShearPanel(i) => self.shear_panels[i].id,
        }
    }

    /// Returns the kind of the element for messages.
    pub(crate) fn element_word(&self, element: ElementRef) -> &'static str {
        match element {
            ElementRef::Shell(i) => self.shells[i].shape.card(),
            ElementRef::Beam(i) if self.beams[i].is_beam => "CBEAM",
            ElementRef::Beam(_) => "CBAR",
            ElementRef::Rod(_) => "rod",
            ElementRef::Bush(_) => "CBUSH",
            ElementRef::Joint(i) => self.joints[i].card.name(),
            ElementRef::Spring(_) => "spring",
            ElementRef::Solid(i) => self.solids[i].shape.card(),
            ElementRef::ShearPanel(_) => "CSHEAR",
        }
    }

    /// Returns the grids and scalar points of the element, each once, in the order of its stiffness.
    pub(crate) fn element_grids(&self, element: ElementRef) -> Vec<GridIx> {
        match element {
            ElementRef::Shell(i) => self.shells[i].all_grids(),
            ElementRef::Beam(i) => self.beams[i].all_grids(),
            ElementRef::Rod(i) => self.rods[i].grids.to_vec(),
            ElementRef::Bush(i) => {
                let (a, b) = self.bushes[i].grids;
                [Some(a), b].into_iter().flatten().collect()
            }
            ElementRef::Joint(i) => self.joints[i].all_grids(),
            ElementRef::Spring(i) => {
                let ends = self.springs[i].ends.iter().flatten();
                let mut grids: Vec<GridIx> = ends.map(|e| e.0).collect();
                grids.dedup();
                grids
            }
            ElementRef::Solid(i) => self.solids[i].all_grids(),
            ElementRef::ShearPanel(i) => self.shear_panels[i].grids.to_vec(),
        }
    }
}

impl Shell {
    /// Returns the sides with a mid-side grid. For other sides the model repeats the first corner.
    pub(crate) fn middles(&self) -> impl Iterator<Item = usize> {
        let n = self.shape.n_corners();
        (0..self.shape.n_grids() - n).filter(move |side| self.grids[n + side] != self.grids[*side])
    }

    /// Returns the corners, then the existing mid-side grids.
    pub(crate) fn all_grids(&self) -> Vec<GridIx> {
        let n = self.shape.n_corners();
        let middles = self.middles().map(|side| self.grids[n + side]);
        self.grids[..n].iter().copied().chain(middles).collect()
    }
}

impl Beam {
    /// Returns the ends, then the scalar points of warping.
    pub(crate) fn all_grids(&self) -> Vec<GridIx> {
        let points = self.warping.into_iter().flatten();
        self.grids.into_iter().chain(points).collect()
    }
}

impl Joint {
    /// Returns the grids of both ends, ascending.
    pub(crate) fn all_grids(&self) -> Vec<GridIx> {
        let motion = self.ends.iter().flat_map(|e| &e.motion);
        let mut grids: Vec<GridIx> = motion.map(|m| m.0).collect();
        grids.sort_unstable();
        grids.dedup();
        grids
    }
}

impl Solid {
    /// Returns the corners, then the existing mid-edge grids.
    pub(crate) fn all_grids(&self) -> Vec<GridIx> {
        self.grids.iter().flatten().copied().collect()
    }
}
