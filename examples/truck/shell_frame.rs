//! Rails, cross members and their end brackets as shells, joined by bolts: a bar between two rigid spiders (thesis 3.4).

use crate::deck::DeckText;
use crate::fields;
use crate::parameters::{INCH, Truck};
use crate::running_gear::{Frame, RailPoint, Side};
use std::collections::HashMap;

/// Property ids: rails 11..15 left and 21..25 right, cross members 31.., brackets 41.., bolts 51.
const LEFT: u32 = 11;
const RIGHT: u32 = 21;
const MEMBER: u32 = 31;
const BRACKET: u32 = 41;
const BOLT: u32 = 51;

/// Shares grids inside one part by position.
#[derive(Default)]
struct Part(HashMap<[i64; 3], (u32, [f64; 3])>);

impl Part {
    fn grid(&mut self, deck: &mut DeckText, x: [f64; 3]) -> u32 {
        let key = x.map(|v| (v * 1e4).round() as i64);
        self.0.entry(key).or_insert_with(|| (deck.grid(x), x)).0
    }

    /// Writes quads over the product of two lists of coordinates.
    fn patch(
        &mut self,
        deck: &mut DeckText,
        us: &[f64],
        vs: &[f64],
        at: impl Fn(f64, f64) -> [f64; 3],
        pid: impl Fn(f64) -> u32,
    ) {
        for u in us.windows(2) {
            for v in vs.windows(2) {
                let corners = [(u[0], v[0]), (u[1], v[0]), (u[1], v[1]), (u[0], v[1])]
                    .map(|(a, b)| self.grid(deck, at(a, b)));
                let id = deck.element();
                let [a, b, c, d] = corners;
                deck.card("CQUAD4", fields![id, pid((u[0] + u[1]) / 2.0), a, b, c, d]);
            }
        }
    }

    /// Returns the four grids nearest to a point: the corners of the element that a bolt goes through.
    fn nearest4(&self, x: [f64; 3]) -> Vec<u32> {
        let mut all: Vec<(f64, u32)> = self
            .0
            .values()
            .map(|(id, p)| ((0..3).map(|i| (p[i] - x[i]).powi(2)).sum::<f64>(), *id))
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.iter().take(4).map(|a| a.1).collect()
    }
}

/// Returns points from `a` to `b` with steps of at most `size`.
fn steps(a: f64, b: f64, size: f64) -> Vec<f64> {
    let n = ((b - a).abs() / size).ceil().max(1.0) as usize;
    (0..=n).map(|i| a + (b - a) * i as f64 / n as f64).collect()
}

/// Returns steps through given break points.
fn steps_through(breaks: &[f64], size: f64) -> Vec<f64> {
    let mut out = vec![breaks[0]];
    for pair in breaks.windows(2) {
        out.extend(steps(pair[0], pair[1], size).into_iter().skip(1));
    }
    out
}

/// Writes the frame and returns the rail grids for the parts that are mounted on them.
pub fn build(truck: &Truck, deck: &mut DeckText) -> Frame {
    let (rails, size, half) = (&truck.rails, truck.mesh.size, truck.bracket.length / 2.0);
    let mut breaks = vec![rails.start_in * INCH, rails.end_in * INCH];
    for member in &truck.cross_member {
        let x = member.station_in * INCH;
        breaks.extend([x - half, x, x + member.flange, x + half]);
    }
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|a, b| (*a - *b).abs() < 1.0);
    let xs = steps_through(&breaks, size);
    properties(truck, deck);

    let [low, high] = rails.z();
    let zs = steps(low, high, size);
    let inward = rails.flange - rails.thickness / 2.0;
    let mut parts = Vec::new();
    for (side, sign, pid) in [(Side::Left, -1.0, LEFT), (Side::Right, 1.0, RIGHT)] {
        let (mut rail, web) = (Part::default(), sign * rails.web_y());
        let zone = |x: f64| pid + rails.zone(x);
        rail.patch(deck, &xs, &zs, |x, z| [x, web, z], zone);
        let ys = steps(0.0, inward, size);
        for z in [low, high] {
            rail.patch(deck, &xs, &ys, |x, y| [x, web - sign * y, z], zone);
        }
        parts.push((side, sign, rail));
    }
    let mut member_centres = Vec::new();
    for (i, member) in truck.cross_member.iter().enumerate() {
        let (x0, z0, i) = (member.station_in * INCH, rails.z_mid(), i as u32);
        let end = rails.web_y() - truck.bracket.gap;
        let (ys, zs) = (
            steps(-end, end, size),
            steps(z0 - member.height / 2.0, z0 + member.height / 2.0, size),
        );
        let local: Vec<f64> = xs
            .iter()
            .copied()
            .filter(|x| (x - x0).abs() < half + 0.5)
            .collect();
        let flange: Vec<f64> = local
            .iter()
            .copied()
            .filter(|x| *x > x0 - 0.5 && *x < x0 + member.flange + 0.5)
            .collect();
        let mut part = Part::default();
        deck.comment(&format!("Property: cross member {}", member.name));
        part.patch(deck, &ys, &zs, |y, z| [x0, y, z], |_| MEMBER + i);
        for z in [zs[0], zs[zs.len() - 1]] {
            part.patch(deck, &flange, &ys, |x, y| [x, y, z], |_| MEMBER + i);
        }
        for (_, sign, rail) in &parts {
            part.patch(
                deck,
                &local,
                &zs,
                |x, z| [x, sign * end, z],
                |_| BRACKET + i,
            );
            for (dx, dz) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let (x, z) = (
                    x0 + dx * (half - 30.0),
                    z0 + dz * (member.height / 2.0 - 35.0),
                );
                let heads =
                    [[x, sign * rails.web_y(), z], [x, sign * end, z]].map(|p| (deck.grid(p), p));
                deck.rbe2(heads[0].0, &rail.nearest4(heads[0].1));
                deck.rbe2(heads[1].0, &part.nearest4(heads[1].1));
                let id = deck.element();
                deck.card(
                    "CBAR",
                    fields![id, BOLT, heads[0].0, heads[1].0, 0.0, 0.0, 1.0],
                );
            }
        }
        let web: Vec<u32> = part
            .0
            .values()
            .filter(|(_, p)| (p[0] - x0).abs() < 0.5 && p[1].abs() < 80.0)
            .map(|(id, _)| *id)
            .collect();
        member_centres.push((member.name.clone(), web));
    }
    Frame {
        rail_points: parts
            .iter()
            .flat_map(|(side, _, rail)| {
                rail.0.values().map(|(id, x)| RailPoint {
                    id: *id,
                    x: *x,
                    side: *side,
                })
            })
            .collect(),
        member_centres,
    }
    .sort_by_id()
}

fn properties(truck: &Truck, deck: &mut DeckText) {
    for (name, first) in [("left", LEFT), ("right", RIGHT)] {
        for zone in 0..=truck.rails.zone_bounds_in.len() as u32 {
            deck.comment(&format!("Property: rail {name} zone {}", zone + 1));
            deck.card(
                "PSHELL",
                fields![first + zone, 1_u32, truck.rails.thickness, 1_u32, "", 1_u32],
            );
        }
    }
    for (i, member) in truck.cross_member.iter().enumerate() {
        deck.card(
            "PSHELL",
            fields![MEMBER + i as u32, 1_u32, member.thickness, 1_u32, "", 1_u32],
        );
        deck.card(
            "PSHELL",
            fields![
                BRACKET + i as u32,
                1_u32,
                truck.bracket.thickness,
                1_u32,
                "",
                1_u32
            ],
        );
    }
    let d = truck.bracket.bolt_diameter;
    let inertia = std::f64::consts::PI * d.powi(4) / 64.0;
    deck.card(
        "PBAR",
        fields![
            BOLT,
            1_u32,
            std::f64::consts::PI * d * d / 4.0,
            inertia,
            inertia,
            2.0 * inertia
        ],
    );
}
