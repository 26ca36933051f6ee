//! Axles, springs, rods, masses and load points on either frame.

use crate::deck::{DeckText, Field};
use crate::fields;
use crate::parameters::{INCH, Mass, Truck};

/// Side of a rail.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Side {
    Left,
    Right,
}

impl Side {
    fn sign(self) -> f64 {
        if self == Self::Left { -1.0 } else { 1.0 }
    }
}

/// A grid of a rail.
pub struct RailPoint {
    pub id: u32,
    pub x: [f64; 3],
    pub side: Side,
}

/// Grids of the frame on which parts can be mounted.
pub struct Frame {
    pub rail_points: Vec<RailPoint>,
    /// Grids in the middle of each cross member's web.
    pub member_centres: Vec<(String, Vec<u32>)>,
}

impl Frame {
    /// Sorts the grids by id, so that every run writes the same deck.
    pub fn sort_by_id(mut self) -> Self {
        self.rail_points.sort_by_key(|p| p.id);
        self.member_centres
            .iter_mut()
            .for_each(|m| m.1.sort_unstable());
        self
    }

    /// Returns the grids of a rail near a station, between two heights; if the mesh is a line of bars, the nearest grid.
    fn rail_grids_near(&self, side: Side, x: f64, reach: f64, z: [f64; 2]) -> Vec<u32> {
        let on_side = || self.rail_points.iter().filter(move |p| p.side == side);
        let found: Vec<u32> = on_side()
            .filter(|p| (p.x[0] - x).abs() <= reach && p.x[2] > z[0] && p.x[2] < z[1])
            .map(|p| p.id)
            .collect();
        if found.len() >= 4 {
            return found;
        }
        on_side()
            .min_by(|a, b| (a.x[0] - x).abs().total_cmp(&(b.x[0] - x).abs()))
            .map(|p| vec![p.id])
            .unwrap_or_default()
    }
}

const WHEELS: [&str; 6] = ["LF", "RF", "LM", "RM", "LR", "RR"];
const WHEEL_BASE: u32 = 900_001;
const PAYLOAD_GRID: u32 = 900_101;
const MASS_BASE: u32 = 900_201;
const AXLE_TUBE: u32 = 61;
const FRONT_LEAF: u32 = 62;
const REAR_LEAF: u32 = 63;
const ROD: u32 = 64;
const HANGER: u32 = 71;
const SHACKLE: u32 = 72;
const TRUNNION: u32 = 73;
const LEAF_END: u32 = 74;
const MASSLESS: u32 = 2;

/// Adds all parts except the frame.
pub fn add(truck: &Truck, frame: &Frame, deck: &mut DeckText) {
    properties(truck, deck);
    let axles = &truck.axles;
    let front = axle(
        truck,
        deck,
        0,
        axles.front_in,
        axles.front_half_track,
        truck.axle_mass.front,
    );
    let middle = axle(
        truck,
        deck,
        2,
        axles.middle_in,
        axles.rear_half_track,
        truck.axle_mass.middle,
    );
    let rear = axle(
        truck,
        deck,
        4,
        axles.rear_in,
        axles.rear_half_track,
        truck.axle_mass.rear,
    );
    for side in [Side::Left, Side::Right] {
        front_spring(truck, frame, deck, side, &front);
        rear_spring(truck, frame, deck, side, &middle, &rear);
    }
    for axle in [&middle, &rear] {
        torque_rods(truck, frame, deck, axle);
    }
    for (i, mass) in truck.mass.iter().chain(&truck.compensating).enumerate() {
        add_mass(truck, frame, deck, MASS_BASE + i as u32, mass);
    }
    let p = &truck.payload;
    deck.comment("Component: payload");
    deck.grid_with_id(
        PAYLOAD_GRID,
        [p.station_in * INCH, 0.0, truck.rails.z()[1] + p.above_rail],
    );
    let top = truck.rails.z()[1];
    let mut arms: Vec<u32> = frame
        .rail_points
        .iter()
        .filter(|r| {
            r.x[0] >= p.feet_in[0] * INCH
                && r.x[0] <= p.feet_in[1] * INCH
                && (r.x[2] > top - 1.0
                    || (r.x[2] - truck.rails.z_mid()).abs() < 1e-6
                        && frame.rail_points.len() < 1000)
        })
        .map(|r| r.id)
        .collect();
    arms.sort_unstable();
    deck.rbe3(PAYLOAD_GRID, &arms);
}

struct Axle {
    x: f64,
    seats: [u32; 2],
    centre: u32,
}

fn seat_y(truck: &Truck) -> f64 {
    truck.rails.web_y() - truck.rails.flange / 2.0
}

fn properties(truck: &Truck, deck: &mut DeckText) {
    let m = &truck.material;
    deck.card(
        "MAT1",
        fields![1_u32, m.youngs_modulus, "", m.poisson, m.density],
    );
    deck.card(
        "MAT1",
        fields![MASSLESS, m.youngs_modulus, "", m.poisson, 0.0],
    );
    let (a, b) = (
        truck.axles.tube_outer,
        truck.axles.tube_outer - 2.0 * truck.axles.tube_wall,
    );
    let inertia = (a.powi(4) - b.powi(4)) / 12.0;
    let (mean, wall) = (a - truck.axles.tube_wall, truck.axles.tube_wall);
    deck.card(
        "PBAR",
        fields![
            AXLE_TUBE,
            MASSLESS,
            a * a - b * b,
            inertia,
            inertia,
            mean.powi(3) * wall,
            "",
            "",
            // Stress recovery points at the gauges: on top of, below, behind and in front of the tube.
            a / 2.0,
            0.0,
            -a / 2.0,
            0.0,
            0.0,
            a / 2.0,
            0.0,
            -a / 2.0
        ],
    );
    // Leaf, simply supported: rate = 48 E I / L^3; a width of 90 mm gives the weak axis.
    let length = (truck.front_spring.rear_hanger_in - truck.front_spring.front_hanger_in) * INCH;
    let i1 = truck.front_spring.rate * length.powi(3) / 48.0 / m.youngs_modulus;
    leaf(deck, FRONT_LEAF, i1, 90.0);
    // Cantilever from the pivot: rate = 3 E I / l^3.
    let arm = (truck.axles.rear_in - truck.axles.pivot_in) * INCH;
    let i1 = truck.rear_spring.end_rate * arm.powi(3) / 3.0 / m.youngs_modulus;
    leaf(deck, REAR_LEAF, i1, truck.rear_spring.width);
    deck.card("PROD", fields![ROD, MASSLESS, truck.rear_spring.rod_area]);
    let (f, r) = (&truck.front_spring, &truck.rear_spring);
    let bush = |deck: &mut DeckText, id: u32, k: [f64; 6]| {
        let mut fields = fields![id, "K"];
        fields.extend(k.map(Field::Real));
        deck.card("PBUSH", fields);
    };
    bush(
        deck,
        HANGER,
        [
            f.bush_stiff,
            f.bush_stiff,
            f.bush_stiff,
            f.bush_rotation,
            0.0,
            f.bush_rotation,
        ],
    );
    bush(
        deck,
        SHACKLE,
        [
            f.shackle_longitudinal,
            f.bush_stiff,
            f.bush_stiff,
            f.bush_rotation,
            0.0,
            f.bush_rotation,
        ],
    );
    bush(
        deck,
        TRUNNION,
        [
            r.bush_stiff,
            r.bush_stiff,
            r.bush_stiff,
            r.bush_rotation,
            0.0,
            r.bush_rotation,
        ],
    );
    bush(
        deck,
        LEAF_END,
        [
            r.end_slider,
            r.bush_stiff,
            r.bush_stiff,
            1.0e6,
            1.0e6,
            1.0e6,
        ],
    );
}

/// Writes a leaf pack as one bar, with its bending inertia, and a width that gives the weak axis of an equal solid section.
fn leaf(deck: &mut DeckText, pid: u32, i1: f64, width: f64) {
    let height = (12.0 * i1 / width).cbrt();
    let i2 = height * width.powi(3) / 12.0;
    deck.card(
        "PBAR",
        fields![pid, MASSLESS, width * height, i1, i2, i1.min(i2) * 2.0],
    );
}

fn axle(
    truck: &Truck,
    deck: &mut DeckText,
    first_wheel: usize,
    station_in: f64,
    half_track: f64,
    mass: f64,
) -> Axle {
    let (x, z, seat) = (
        station_in * INCH,
        truck.axles.hub_above_ground,
        seat_y(truck),
    );
    let wheels = [0, 1].map(|i| WHEEL_BASE + (first_wheel + i) as u32);
    for (i, id) in wheels.iter().enumerate() {
        deck.comment(&format!(
            "Component: wheel {}, grid {id}",
            WHEELS[first_wheel + i]
        ));
        deck.grid_with_id(*id, [x, if i == 0 { -half_track } else { half_track }, z]);
    }
    let seats = [-seat, seat].map(|y| deck.grid([x, y, z]));
    let centre = deck.grid([x, 0.0, z]);
    for (a, b) in [
        (wheels[0], seats[0]),
        (seats[0], centre),
        (centre, seats[1]),
        (seats[1], wheels[1]),
    ] {
        let id = deck.element();
        deck.card("CBAR", fields![id, AXLE_TUBE, a, b, 0.0, 0.0, 1.0]);
    }
    for wheel in wheels {
        let id = deck.element();
        deck.card("CONM2", fields![id, wheel, "", mass / 2.0]);
    }
    Axle { x, seats, centre }
}

fn bush(deck: &mut DeckText, pid: u32, a: u32, b: u32) {
    let id = deck.element();
    deck.card("CBUSH", fields![id, pid, a, b, "", "", "", 0_u32]);
}

/// Ties a mount to rail grids: on shells by a rigid spider; on a line of bars the mount follows the bar's grid.
fn tie(deck: &mut DeckText, mount: u32, rail: &[u32]) {
    match rail {
        [single] => deck.rbe2(*single, &[mount]),
        many => deck.rbe2(mount, many),
    }
}

/// Writes a bracket: a grid at `x` tied rigidly to the lower flange of a rail.
fn lower_bracket(
    truck: &Truck,
    frame: &Frame,
    deck: &mut DeckText,
    side: Side,
    x: [f64; 3],
    reach: f64,
) -> u32 {
    let id = deck.grid(x);
    let low = truck.rails.z()[0];
    tie(
        deck,
        id,
        &frame.rail_grids_near(side, x[0], reach, [low - 1.0, low + 1.0]),
    );
    id
}

fn front_spring(truck: &Truck, frame: &Frame, deck: &mut DeckText, side: Side, axle: &Axle) {
    let f = &truck.front_spring;
    let (y, z) = (
        side.sign() * seat_y(truck),
        truck.axles.hub_above_ground + f.above_hub,
    );
    let seat = deck.grid([axle.x, y, z]);
    deck.rbe2(axle.seats[(side == Side::Right) as usize], &[seat]);
    for (station, pid) in [(f.front_hanger_in, HANGER), (f.rear_hanger_in, SHACKLE)] {
        let at = [station * INCH, y, z];
        let (eye, bracket) = (
            deck.grid(at),
            lower_bracket(truck, frame, deck, side, at, 80.0),
        );
        bush(deck, pid, eye, bracket);
        let id = deck.element();
        deck.card("CBAR", fields![id, FRONT_LEAF, eye, seat, 0.0, 0.0, 1.0]);
    }
}

fn rear_spring(
    truck: &Truck,
    frame: &Frame,
    deck: &mut DeckText,
    side: Side,
    middle: &Axle,
    rear: &Axle,
) {
    let r = &truck.rear_spring;
    let (y, z) = (
        side.sign() * seat_y(truck),
        truck.axles.hub_above_ground + r.above_hub,
    );
    let at = [truck.axles.pivot_in * INCH, y, z];
    let (saddle, bracket) = (
        deck.grid(at),
        lower_bracket(truck, frame, deck, side, at, 120.0),
    );
    bush(deck, TRUNNION, saddle, bracket);
    for axle in [middle, rear] {
        let (end, seat) = (deck.grid([axle.x, y, z]), deck.grid([axle.x, y, z]));
        deck.rbe2(axle.seats[(side == Side::Right) as usize], &[seat]);
        bush(deck, LEAF_END, end, seat);
        let id = deck.element();
        deck.card("CBAR", fields![id, REAR_LEAF, saddle, end, 0.0, 0.0, 1.0]);
    }
}

/// Writes a longitudinal rod to the bogey cross member and a lateral rod to the left rail.
fn torque_rods(truck: &Truck, frame: &Frame, deck: &mut DeckText, axle: &Axle) {
    let z = truck.rails.z_mid();
    let [top, side_lug] = [0.0, 300.0].map(|y| deck.grid([axle.x, y, z]));
    deck.rbe2(axle.centre, &[top, side_lug]);
    if let Some((_, web)) = frame.member_centres.iter().find(|m| m.0 == "bogey") {
        let bogey = truck
            .cross_member
            .iter()
            .find(|m| m.name == "bogey")
            .map_or(0.0, |m| m.station_in * INCH);
        let anchor = deck.grid([bogey, 0.0, z]);
        // Both axles share the anchor's cross member; an RBE3 lets two rods end on the same web grids.
        if web.len() >= 3 {
            deck.rbe3(anchor, web)
        } else {
            deck.rbe2(web[0], &[anchor])
        }
        let id = deck.element();
        deck.card("CROD", fields![id, ROD, top, anchor]);
    }
    let at = [axle.x, -truck.rails.web_y(), z];
    let anchor = deck.grid(at);
    let high = truck.rails.z()[1];
    let near = frame.rail_grids_near(Side::Left, axle.x, 70.0, [z, high - 1.0]);
    tie(deck, anchor, &near);
    let id = deck.element();
    deck.card("CROD", fields![id, ROD, side_lug, anchor]);
}

fn add_mass(truck: &Truck, frame: &Frame, deck: &mut DeckText, grid: u32, mass: &Mass) {
    let [low, high] = truck.rails.z();
    deck.comment(&format!("Component: {}, grid {grid}", mass.name));
    deck.grid_with_id(
        grid,
        [mass.station_in * INCH, mass.y, high + mass.above_rail],
    );
    let sides: &[Side] = match mass.side.as_deref() {
        Some("left") => &[Side::Left],
        Some("right") => &[Side::Right],
        _ => &[Side::Left, Side::Right],
    };
    let mut arms: Vec<u32> = Vec::new();
    for side in sides {
        for foot in &mass.feet_in {
            arms.extend(frame.rail_grids_near(*side, foot * INCH, 60.0, [low - 1.0, high + 1.0]));
        }
    }
    arms.sort_unstable();
    arms.dedup();
    match arms.as_slice() {
        // The translations of feet on one line of bars cannot support a mass, so the mass is tied rigidly.
        [first, ..] if sides.len() == 1 && arms.len() < 4 => deck.rbe2(*first, &[grid]),
        many => deck.rbe3(grid, many),
    }
    let id = deck.element();
    deck.card("CONM2", fields![id, grid, "", mass.tonnes]);
}
