//! From cards to a model: every list in turn, faults collected.

use super::fault::{FaultKind, ModelFault};
use super::types::*;
use nastran::bdf::Deck;
use nastran::bdf::vocabulary::case_word;
use nastran::cards::{Cards, Param};
use nastran::place::Place;
use std::collections::{HashMap, HashSet};

/// State of a model that is being built.
pub(super) struct Builder<'a> {
    pub cards: &'a Cards,
    pub case_params: &'a [Param],
    pub unsupported_loads: &'a [UnsupportedCard],
    pub model: Model,
    pub faults: Vec<ModelFault>,
    pub frame_ix: HashMap<u32, FrameIx>,
    pub grid_ix: HashMap<u32, GridIx>,
    pub material_ix: HashMap<u32, MaterialIx>,
    pub element_ids: HashMap<u32, (&'static str, Place)>,
    /// Properties of bars (false) and beams (true) in the deck that have their own fault. They do not count as missing.
    pub refused_properties: HashSet<(bool, u32)>,
    /// Grids that only state the place of a connector (GS).
    pub points: Vec<GridIx>,
}

impl Model {
    /// Builds the model of the cards, and lists every fault.
    ///
    /// Elements whose grids are missing are left out; a shell whose property is missing stays in the mesh without stiffness. A model with a fault of
    /// weight [`super::FaultWeight::Error`] can be shown, but not solved.
    pub fn from_cards(cards: &Cards) -> (Model, Vec<ModelFault>) {
        let (structure, loads) = super::unsupported_cards::of_records(cards);
        let (mut model, faults) = Self::build(cards, &[], &loads);
        model.unsupported_cards = structure;
        (model, faults)
    }

    /// Builds the model of a deck and lists every fault. PARAMs of case control override PARAMs of bulk data, and properties keep their names.
    ///
    /// A model with a fault of weight [`super::FaultWeight::Error`] can be shown, but not solved.
    ///
    /// # Example
    /// The mass of a plate is `rho t a b`, and its centre of gravity is its middle:
    /// ```
    /// use nastran::bdf::{MemoryLoader, read_deck};
    /// use strainbridge::model::Model;
    ///
    /// # const DECK: &str = "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,300.,0.,0.\nGRID,3,,300.,200.,0.\nGRID,4,,0.,200.,0.
    /// # CQUAD4,7,1,1,2,3,4\nPSHELL,1,1,5.,1,,1\nMAT1,1,210000.,,.3,7.85-9\nENDDATA\n";
    /// let deck = read_deck("plate.bdf", DECK.into(), &mut MemoryLoader::default());
    /// let (model, faults) = Model::from_deck(&deck);
    /// assert!(faults.is_empty());
    /// assert_eq!(model.shells[model.shell_ix(7).unwrap().us()].id, 7);
    /// let weight = model.weight();
    /// assert!((weight.mass / (7.85e-9 * 5.0 * 300.0 * 200.0) - 1.0).abs() < 1e-12); // t
    /// assert!((weight.cg.x - 150.0).abs() < 1e-9 && (weight.cg.y - 100.0).abs() < 1e-9);
    /// ```
    pub fn from_deck(deck: &Deck) -> (Model, Vec<ModelFault>) {
        let (structure, loads) = super::unsupported_cards::of_deck(deck);
        let (case_params, differing) = super::case_params::params_of_case_control(deck);
        let (mut model, mut faults) = Self::build(&deck.cards, &case_params, &loads);
        model.unsupported_cards = structure;
        model.unsupported_cards.extend(differing);
        let (refused, missing) = super::nonstructural::add_selected(&mut model, deck);
        model.unsupported_cards.extend(refused);
        faults.extend(missing);
        let heated = super::material_at::heat_materials(&mut model, deck);
        model.unsupported_cards.extend(heated.refused);
        faults.extend(heated.faults);
        faults.extend(super::temperature_gaps::missing_temperatures(&model, deck));
        model.params.expanding_rigids = expanding_rigids(deck);
        model.mpc = deck.case_control.mpc_of_structure();
        let subcases = deck.case_control.effective_subcases();
        model.selected_spcs = subcases.iter().filter_map(|s| s.spc).collect();
        model.selected_spcs.sort_unstable();
        model.selected_spcs.dedup();
        model.property_names = super::property_names::property_names(deck);
        super::not_carried::attach_grids(deck, &mut faults);
        let faults = super::not_carried::name_cards(deck, &mut model, faults);
        (model, faults)
    }

    fn build(
        cards: &Cards,
        case_params: &[Param],
        unsupported_loads: &[UnsupportedCard],
    ) -> (Model, Vec<ModelFault>) {
        let mut b = Builder {
            cards,
            case_params,
            unsupported_loads,
            model: Model::default(),
            faults: Vec::new(),
            frame_ix: HashMap::new(),
            grid_ix: HashMap::new(),
            material_ix: HashMap::new(),
            element_ids: HashMap::new(),
            refused_properties: HashSet::new(),
            points: Vec::new(),
        };
        b.params();
        b.frames_and_grids();
        b.materials();
        b.shells();
        b.normals();
        b.beams();
        b.rods();
        b.bushes();
        b.springs();
        b.solids();
        b.shear_panels();
        b.masses();
        b.scalar_masses();
        b.rigids();
        b.joints();
        b.constraints();
        b.rigid_bushes();
        b.check_dependents();
        b.check_duplicates();
        b.loads();
        b.attachments();
        b.faults.sort_by_key(|f| f.at);
        (b.model, b.faults)
    }
}

/// Returns whether case control asks for rigid elements that expand with temperature: RIGID = LAGRAN or LGELIM. The default is LINEAR.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, case control command RIGID, and remarks on ALPHA of RBE2.
fn expanding_rigids(deck: &Deck) -> bool {
    let lines = deck.case_control.lines.iter();
    let is_rigid = |name: &str| case_word(name).is_some_and(|word| word.name == "RIGID");
    let mut rigid = lines.filter(|l| !l.in_packet && is_rigid(&l.name));
    rigid.any(|l| {
        let text = l.text.to_ascii_uppercase();
        ["LAGR", "LGEL"].iter().any(|word| text.contains(word))
    })
}

impl Builder<'_> {
    pub(super) fn fault(&mut self, card: String, field: &'static str, at: Place, kind: FaultKind) {
        self.faults.push(ModelFault {
            card,
            field,
            at,
            kind,
        });
    }

    /// Returns the number if it is not negative. Otherwise it adds a fault and returns `None`.
    pub(super) fn not_negative(
        &mut self,
        what: &'static str,
        value: f64,
        card: &str,
        field: &'static str,
        at: Place,
    ) -> Option<()> {
        if value < 0.0 {
            let kind = FaultKind::Unsupported {
                what: format!("the negative {what} {value}"),
                remedy: "give a number of 0 or above",
            };
            self.fault(card.to_owned(), field, at, kind);
            return None;
        }
        Some(())
    }

    /// Returns the grid with this id; adds a fault if it is missing.
    pub(super) fn grid(
        &mut self,
        id: u32,
        card: &str,
        field: &'static str,
        at: Place,
    ) -> Option<GridIx> {
        let found = self.grid_ix.get(&id).copied();
        if found.is_none() {
            self.fault(
                card.to_owned(),
                field,
                at,
                FaultKind::Missing {
                    what: "grid",
                    id: id.into(),
                },
            );
        }
        found
    }

    /// Returns the coordinate system with this id; adds a fault if it is missing.
    pub(super) fn frame(
        &mut self,
        id: i64,
        card: &str,
        field: &'static str,
        at: Place,
    ) -> Option<FrameIx> {
        let found = u32::try_from(id)
            .ok()
            .and_then(|id| self.frame_ix.get(&id).copied());
        if found.is_none() {
            self.fault(
                card.to_owned(),
                field,
                at,
                FaultKind::Missing {
                    what: "coordinate system",
                    id,
                },
            );
        }
        found
    }

    /// Returns the material with this id; adds a fault if it is missing.
    pub(super) fn material(
        &mut self,
        id: u32,
        card: &str,
        field: &'static str,
        at: Place,
    ) -> Option<MaterialIx> {
        let found = self.material_ix.get(&id).copied();
        if found.is_none() {
            self.fault(
                card.to_owned(),
                field,
                at,
                FaultKind::Missing {
                    what: "material",
                    id: id.into(),
                },
            );
        }
        found
    }

    /// Registers an element id. If an element of the same card already has the id, it adds a fault and returns false.
    pub(super) fn element(&mut self, id: u32, card: &'static str, at: Place) -> bool {
        match self.element_ids.get(&id).copied() {
            None => {
                self.element_ids.insert(id, (card, at));
                true
            }
            Some((other, first)) if other == card => {
                self.fault(
                    format!("{card} {id}"),
                    "EID",
                    at,
                    FaultKind::Duplicate {
                        what: "element id",
                        first,
                    },
                );
                false
            }
            Some((other, first)) => {
                let other = format!("{other} {id}");
                self.fault(
                    format!("{card} {id}"),
                    "EID",
                    at,
                    FaultKind::SharedId { other, first },
                );
                true
            }
        }
    }

    /// Returns the location of a grid.
    pub(super) fn x(&self, g: GridIx) -> Vec3 {
        self.model
            .grids
            .get(g.us())
            .map_or_else(Vec3::zeros, |g| g.x)
    }

    /// Returns whether the grid is a scalar point.
    pub(super) fn is_scalar(&self, g: GridIx) -> bool {
        self.model.grids.get(g.us()).is_some_and(Grid::is_scalar)
    }

    /// Returns the axes of the displacement frame of a grid at its place, by rows.
    pub(super) fn cd_axes(&self, g: GridIx) -> Mat3 {
        self.model.cd_axes(g)
    }
}

impl Model {
    /// Returns the axes of a grid's displacement frame at the grid, by rows: `components = axes * basic`.
    pub fn cd_axes(&self, g: GridIx) -> Mat3 {
        let Some(grid) = self.grids.get(g.us()) else {
            return Mat3::identity();
        };
        self.frames
            .get(grid.cd.us())
            .map_or_else(Mat3::identity, |f| f.axes_at(grid.x))
    }

    /// Returns the grid of that id.
    pub fn grid_ix(&self, id: u32) -> Option<GridIx> {
        self.grids
            .binary_search_by_key(&id, |g| g.id)
            .ok()
            .map(|i| GridIx(i as u32))
    }

    /// Returns the shell of that id.
    pub fn shell_ix(&self, id: u32) -> Option<ShellIx> {
        self.shells
            .binary_search_by_key(&id, |s| s.id)
            .ok()
            .map(|i| ShellIx(i as u32))
    }

    /// Returns the CBAR or CBEAM of that id.
    pub fn beam_ix(&self, id: u32) -> Option<BeamIx> {
        self.beams
            .binary_search_by_key(&id, |s| s.id)
            .ok()
            .map(|i| BeamIx(i as u32))
    }

    /// Returns the coordinate system of that id.
    pub fn frame_ix(&self, id: u32) -> Option<FrameIx> {
        self.frames
            .iter()
            .position(|f| f.id == id)
            .map(|i| FrameIx(i as u32))
    }

    /// Returns the number of elements: those with stiffness, masses and rigid elements.
    pub fn n_elements(&self) -> usize {
        self.elements().count() + self.masses.len() + self.scalar_masses.len() + self.rigids.len()
    }
}
