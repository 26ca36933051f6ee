//! Structure with loads and gauges, and its conversion to a deck.

use crate::card;
use crate::cards::{Card, Field};
use nalgebra::{Matrix3, Vector3};

pub type V = Vector3<f64>;

/// Unit system of a job, with its units per millimetre, newton and kilogram.
#[derive(Clone, Copy)]
pub struct Units {
    pub name: &'static str,
    pub length: f64,
    pub force: f64,
    pub mass: f64,
}

pub const MM_T_S: Units = Units {
    name: "mm-t-s",
    length: 1.0,
    force: 1.0,
    mass: 1e-3,
};

/// Kind of a coordinate system.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    Rectangular,
    Cylindrical,
    Spherical,
}

/// Coordinate system. The columns of `axes` are its unit vectors.
#[derive(Clone)]
pub struct System {
    pub kind: Kind,
    pub origin: V,
    pub axes: Matrix3<f64>,
}

impl System {
    /// Returns the coordinates of a point, with angles in degrees.
    pub fn coordinates(&self, x: V) -> V {
        let local = self.axes.transpose() * (x - self.origin);
        let azimuth = local.y.atan2(local.x).to_degrees();
        match self.kind {
            Kind::Rectangular => local,
            Kind::Cylindrical => V::new(local.x.hypot(local.y), azimuth, local.z),
            Kind::Spherical => {
                let r = local.norm();
                V::new(r, (local.z / r).acos().to_degrees(), azimuth)
            }
        }
    }

    /// Returns the unit vectors at a point, as columns.
    pub fn axes_at(&self, x: V) -> Matrix3<f64> {
        let local = self.axes.transpose() * (x - self.origin);
        let (s, c) = local.y.atan2(local.x).sin_cos();
        let turned = match self.kind {
            Kind::Rectangular => Matrix3::identity(),
            Kind::Cylindrical => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
            Kind::Spherical => {
                let (st, ct) = (local.z / local.norm()).acos().sin_cos();
                Matrix3::new(st * c, ct * c, -s, st * s, ct * s, c, ct, -st, 0.0)
            }
        };
        self.axes * turned
    }
}

#[derive(Clone)]
pub struct Grid {
    pub tag: u32,
    pub x: V,
    /// Coordinate systems of the position and of the displacements. 0 is the basic system.
    pub cp: u32,
    pub cd: u32,
}

#[derive(Clone)]
pub struct Shell {
    pub tag: u32,
    pub property: u32,
    /// Tags of the corners in their order.
    pub corners: Vec<u32>,
    /// The order of the corners is the reverse of that in the base model.
    pub flipped: bool,
}

/// Place of a gauge.
#[derive(Clone)]
pub enum Seat {
    /// On a shell, given by its id.
    Shell { tag: u32, top: bool },
    /// At a point of the skin.
    Point(V),
    /// On a bar, at recovery point C and a share of its length.
    Bar { tag: u32, station: f64 },
}

#[derive(Clone)]
pub struct Gauge {
    pub name: String,
    pub seat: Seat,
    /// Position of the gauge, for directions in a coordinate system.
    pub at: V,
    /// Shell under the gauge, or 0 on a bar.
    pub shell: u32,
    pub direction: V,
    pub angle_deg: f64,
    pub system: u32,
    pub bridge: Option<&'static str>,
    pub rosette: bool,
    pub grid_length: f64,
}

#[derive(Clone)]
pub struct Load {
    pub name: &'static str,
    pub grid: u32,
    /// Unit vector. For a moment it is an axial vector.
    pub direction: V,
    pub moment: bool,
    pub system: u32,
    pub applied: f64,
    /// N or N mm.
    pub expected: f64,
}

/// Springs of a CBUSH between two grids, N/mm and N mm, and the vector of its orientation.
#[derive(Clone)]
pub struct Bush {
    pub grids: [u32; 2],
    pub k: [f64; 6],
    pub v: V,
}

/// A CONM2: kg, offset, and moments of inertia in kg mm2, in a coordinate system.
#[derive(Clone)]
pub struct Mass {
    pub grid: u32,
    pub mass: f64,
    pub offset: V,
    pub inertia: [f64; 3],
    pub system: u32,
}

/// Model with its loads and gauges. Lengths are in mm, forces in N and masses in kg, independently of `units`.
#[derive(Clone)]
pub struct Frame {
    pub units: Units,
    pub grids: Vec<Grid>,
    pub shells: Vec<Shell>,
    /// Property tag and thickness.
    pub properties: Vec<(u32, f64)>,
    /// Tag, grids and orientation. All bars have property 9.
    pub bars: Vec<(u32, [u32; 2], V)>,
    pub bushes: Vec<Bush>,
    /// RBE3: tag, reference grid, grids.
    pub spreads: Vec<(u32, u32, Vec<u32>)>,
    pub masses: Vec<Mass>,
    /// The id is the position in the list, from 1.
    pub systems: Vec<System>,
    pub held: Vec<u32>,
    /// Forces of the first subcase of the deck: grid and vector.
    pub forces: Vec<(u32, V)>,
    pub loads: Vec<Load>,
    pub gauges: Vec<Gauge>,
    /// Transformation from the base model to this model.
    pub turn: Matrix3<f64>,
    /// ZOFFS of every shell.
    pub offset: f64,
    /// The id of tag t is `ids.0 + ids.1 t`.
    pub ids: (i64, i64),
    pub reversed_tables: bool,
}

impl Frame {
    pub fn id(&self, tag: u32) -> u32 {
        u32::try_from(self.ids.0 + self.ids.1 * i64::from(tag)).expect("an id")
    }

    /// Returns the tag of an id.
    pub fn tag(&self, id: u32) -> u32 {
        u32::try_from((i64::from(id) - self.ids.0) / self.ids.1).expect("a tag")
    }

    pub fn x(&self, tag: u32) -> V {
        let grid = self.grids.iter().find(|g| g.tag == tag);
        grid.expect("a grid").x
    }

    pub fn shell(&self, tag: u32) -> &Shell {
        let shell = self.shells.iter().find(|s| s.tag == tag);
        shell.expect("a shell")
    }

    /// Returns the mean of the corners of a shell.
    pub fn centre(&self, tag: u32) -> V {
        let corners = &self.shell(tag).corners;
        corners.iter().map(|c| self.x(*c)).sum::<V>() / corners.len() as f64
    }

    /// Returns the unit normal of a shell, by its corner order.
    pub fn shell_normal(&self, tag: u32) -> V {
        let c: Vec<V> = self.shell(tag).corners.iter().map(|c| self.x(*c)).collect();
        (c[2] - c[0]).cross(&(c[c.len() - 1] - c[1])).normalize()
    }

    pub fn is_mirrored(&self) -> bool {
        self.turn.determinant() < 0.0
    }

    /// Returns whether the top of a shell is the bottom in the base model.
    pub fn sides_exchanged(&self, tag: u32) -> bool {
        self.shell(tag).flipped != self.is_mirrored()
    }

    fn axes_of(&self, system: u32, at: V) -> Matrix3<f64> {
        match system {
            0 => Matrix3::identity(),
            s => self.systems[s as usize - 1].axes_at(at),
        }
    }

    /// Returns the components of a vector in a coordinate system at a point.
    pub fn components(&self, system: u32, at: V, v: V) -> V {
        self.axes_of(system, at).transpose() * v
    }

    pub fn coordinates(&self, system: u32, x: V) -> V {
        match system {
            0 => x,
            s => self.systems[s as usize - 1].coordinates(x),
        }
    }

    /// Returns the model after a rotation or mirroring about the origin, including its coordinate systems.
    #[must_use]
    pub fn transform(mut self, turn: Matrix3<f64>) -> Self {
        let axial = turn * turn.determinant();
        self.grids.iter_mut().for_each(|g| g.x = turn * g.x);
        self.bars.iter_mut().for_each(|b| b.2 = turn * b.2);
        self.bushes.iter_mut().for_each(|b| b.v = turn * b.v);
        self.masses
            .iter_mut()
            .for_each(|m| m.offset = turn * m.offset);
        // The second axis of a mirrored system is reversed, which makes the system right-handed again.
        let right = Matrix3::from_diagonal(&V::new(1.0, turn.determinant(), 1.0));
        for s in &mut self.systems {
            s.origin = turn * s.origin;
            s.axes = turn * s.axes * right;
        }
        self.forces.iter_mut().for_each(|f| f.1 = turn * f.1);
        for load in &mut self.loads {
            load.direction = if load.moment { axial } else { turn } * load.direction;
        }
        for g in &mut self.gauges {
            g.at = turn * g.at;
            g.direction = turn * g.direction;
            if let Seat::Point(x) = &mut g.seat {
                *x = turn * *x;
            }
        }
        self.turn = turn * self.turn;
        self
    }

    /// Returns component and sign of a load in its coordinate system.
    pub fn component(&self, load: &Load) -> (String, f64) {
        let c = self.components(load.system, self.x(load.grid), load.direction);
        let i = c.iamax();
        assert!(
            (c[i].abs() - 1.0).abs() < 1e-9,
            "{} is along no axis",
            load.name
        );
        let kind = if load.moment { 'M' } else { 'F' };
        let axis = ['X', 'Y', 'Z'][i];
        (format!("{kind}{axis}"), c[i].signum())
    }

    /// Returns the job units of the load per N or N mm.
    pub fn load_unit(&self, load: &Load) -> f64 {
        let u = self.units;
        u.force * if load.moment { u.length } else { 1.0 }
    }

    /// Returns the cards of the bulk data.
    pub fn cards(&self) -> Vec<Card> {
        let mut out = self.mesh_cards();
        out.extend(self.property_cards());
        out.extend(self.load_cards());
        out
    }

    fn mesh_cards(&self) -> Vec<Card> {
        let l = self.units.length;
        let id = |tag: u32| Field::from(self.id(tag));
        let optional = |system: u32| {
            if system == 0 {
                Field::Blank
            } else {
                system.into()
            }
        };
        let mut out: Vec<Card> = Vec::new();
        for g in &self.grids {
            let mut x = self.coordinates(g.cp, g.x);
            let kind = (g.cp > 0).then(|| self.systems[g.cp as usize - 1].kind);
            match kind.unwrap_or(Kind::Rectangular) {
                Kind::Rectangular => x *= l,
                Kind::Cylindrical => (x.x, x.z) = (x.x * l, x.z * l),
                Kind::Spherical => x.x *= l,
            }
            let (cp, cd) = (optional(g.cp), optional(g.cd));
            out.push(card!("GRID", self.id(g.tag), cp, x.x, x.y, x.z, cd));
        }
        for s in &self.shells {
            let name = if s.corners.len() == 4 {
                "CQUAD4"
            } else {
                "CTRIA3"
            };
            let mut fields = vec![id(s.tag), id(s.property)];
            fields.extend(s.corners.iter().map(|c| id(*c)));
            if self.offset != 0.0 {
                fields.extend([Field::Blank, (self.offset * l).into()]);
            }
            out.push(Card(name, fields));
        }
        for (tag, [a, b], v) in &self.bars {
            let v = self.in_displacements(*a, *v);
            out.push(card!(
                "CBAR",
                id(*tag),
                id(9),
                id(*a),
                id(*b),
                v.x,
                v.y,
                v.z
            ));
        }
        for (i, bush) in (0..).zip(&self.bushes) {
            let [a, b] = bush.grids;
            let v = self.in_displacements(a, bush.v);
            out.push(card!(
                "CBUSH",
                id(800 + i),
                id(820 + i),
                id(a),
                id(b),
                v.x,
                v.y,
                v.z
            ));
        }
        for (tag, reference, grids) in &self.spreads {
            let mut fields = vec![id(*tag), Field::Blank, id(*reference), "123456".into()];
            fields.extend([1.0.into(), "123".into()]);
            fields.extend(grids.iter().map(|g| id(*g)));
            out.push(Card("RBE3", fields));
        }
        out
    }

    /// Returns the components of an orientation vector in the displacement frame of its first grid.
    fn in_displacements(&self, grid: u32, v: V) -> V {
        let g = self.grids.iter().find(|g| g.tag == grid).expect("a grid");
        self.components(g.cd, g.x, v)
    }

    fn property_cards(&self) -> Vec<Card> {
        let Units {
            length: l,
            force: f,
            mass: m,
            ..
        } = self.units;
        let id = |tag: u32| Field::from(self.id(tag));
        let stress = f / (l * l);
        let rho = 7.85e-6 * m / (l * l * l);
        let mut out = vec![card!(
            "MAT1",
            id(1),
            2.1e5 * stress,
            "",
            0.3,
            rho,
            1.2e-5,
            20.0
        )];
        for (tag, t) in &self.properties {
            out.push(card!("PSHELL", id(*tag), id(1), t * l, id(1), "", id(1)));
        }
        if !self.bars.is_empty() {
            let i = |v: f64| v * l.powi(4);
            out.push(card!(
                "PBAR",
                id(9),
                id(1),
                600.0 * l * l,
                i(45000.),
                i(20000.),
                i(52000.),
                "",
                "",
                15.0 * l,
                0.0,
                -15.0 * l,
                0.0
            ));
        }
        for (n, bush) in (0..).zip(&self.bushes) {
            let mut fields = vec![id(820 + n), "K".into()];
            let k = bush.k.iter().enumerate();
            fields.extend(k.map(|(c, k)| Field::from(k * if c < 3 { f / l } else { f * l })));
            out.push(Card("PBUSH", fields));
        }
        for (n, mass) in (0..).zip(&self.masses) {
            let x = self.components(mass.system, self.x(mass.grid), mass.offset) * l;
            let [a, b, c] = mass.inertia.map(|i| i * m * l * l);
            out.push(card!(
                "CONM2",
                id(860 + n),
                id(mass.grid),
                mass.system,
                mass.mass * m,
                x.x,
                x.y,
                x.z,
                "",
                a,
                "",
                b,
                "",
                "",
                c
            ));
        }
        for (n, s) in (1..).zip(&self.systems).filter(|s| self.uses(s.0)) {
            let name = match s.kind {
                Kind::Rectangular => "CORD2R",
                Kind::Cylindrical => "CORD2C",
                Kind::Spherical => "CORD2S",
            };
            let points = [
                s.origin,
                s.origin + 100.0 * s.axes.column(2),
                s.origin + 100.0 * s.axes.column(0),
            ];
            let mut fields = vec![Field::from(n), Field::Blank];
            fields.extend(
                points
                    .iter()
                    .flat_map(|p| [p.x, p.y, p.z])
                    .map(|v| (v * l).into()),
            );
            out.push(Card(name, fields));
        }
        out
    }

    /// Returns whether the deck or the job uses a coordinate system.
    fn uses(&self, system: u32) -> bool {
        let grids = self.grids.iter().flat_map(|g| [g.cp, g.cd]);
        let masses = self.masses.iter().map(|m| m.system);
        let loads = self.loads.iter().map(|l| l.system);
        let gauges = self.gauges.iter().map(|g| g.system);
        let mut used = grids.chain(masses).chain(loads).chain(gauges);
        used.any(|s| s == system)
    }

    /// Returns loads and supports of the subcases of the deck.
    fn load_cards(&self) -> Vec<Card> {
        let Units {
            length: l,
            force: f,
            ..
        } = self.units;
        let id = |tag: u32| Field::from(self.id(tag));
        let mut out: Vec<Card> = Vec::new();
        let holds = self.held.iter();
        out.extend(holds.map(|g| card!("SPC1", 1, "123456", id(*g))));
        for (grid, v) in &self.forces {
            out.push(card!("FORCE", 1, id(*grid), 0, f, v.x, v.y, v.z));
        }
        // Gravity of 9.81 m/s2. Lengths are per s2 in every unit system.
        let down = self.turn * V::new(0.1, 0.2, -1.0);
        out.push(card!("GRAV", 2, 0, 9810.0 * l, down.x, down.y, down.z));
        for s in &self.shells[..6] {
            let sign = if self.sides_exchanged(s.tag) {
                -1.0
            } else {
                1.0
            };
            out.push(card!("PLOAD4", 3, id(s.tag), sign * 0.01 * f / (l * l)));
        }
        out.push(card!("TEMPD", 4, 50.0));
        for g in self.grids.iter().take(8) {
            out.push(card!("TEMP", 4, id(g.tag), 60.0));
        }
        out
    }

    /// Returns the case control with the four subcases of the deck.
    pub fn control(&self) -> String {
        let case = |n: u32, kind: &str| format!("SUBCASE {n}\nSPC = 1\n{kind} = {n}\n");
        let loads = (1..=3).map(|n| case(n, "LOAD")).collect::<String>();
        format!(
            "STRAIN(FIBER) = ALL\n{loads}{}",
            case(4, "TEMPERATURE(LOAD)")
        )
    }
}
