//! Rails and cross members as bars through their web planes' mid-height, joined by rigid elements.

use crate::deck::DeckText;
use crate::fields;
use crate::parameters::{INCH, Truck};
use crate::running_gear::{Frame, RailPoint, Side};

const LEFT: u32 = 11;
const RIGHT: u32 = 21;
const MEMBER: u32 = 31;

/// Returns area, inertia about the strong and the weak axis, torsion constant and centroid distance from the web of a thin channel.
fn channel(height: f64, flange: f64, t: f64) -> [f64; 5] {
    let (web, leg) = (height - t, flange - t / 2.0);
    let area = web * t + 2.0 * leg * t;
    let strong = t * web.powi(3) / 12.0 + 2.0 * leg * t * (web / 2.0).powi(2);
    let centroid = 2.0 * leg * t * leg / 2.0 / area;
    let weak = web * t * centroid.powi(2)
        + 2.0 * (t * leg.powi(3) / 12.0 + leg * t * (leg / 2.0 - centroid).powi(2));
    [
        area,
        strong,
        weak,
        (web + 2.0 * leg) * t.powi(3) / 3.0,
        centroid,
    ]
}

/// Writes the frame and returns the rail grids for the parts that are mounted on them.
pub fn build(truck: &Truck, deck: &mut DeckText) -> Frame {
    let rails = &truck.rails;
    let section = channel(rails.height, rails.flange, rails.thickness);
    let (h, c, f) = (
        rails.height / 2.0,
        section[4],
        rails.flange - rails.thickness / 2.0 - section[4],
    );
    let mut stations = vec![rails.start_in * INCH, rails.end_in * INCH];
    stations.extend(truck.cross_member.iter().map(|m| m.station_in * INCH));
    stations.extend(rails.zone_bounds_in.iter().map(|b| b * INCH));
    stations.sort_by(f64::total_cmp);
    stations.dedup_by(|a, b| (*a - *b).abs() < 1.0);
    let mut xs = vec![stations[0]];
    for pair in stations.windows(2) {
        let n = ((pair[1] - pair[0]) / 100.0).ceil();
        xs.extend((1..=n as usize).map(|i| pair[0] + (pair[1] - pair[0]) * i as f64 / n));
    }
    let mut points = Vec::new();
    for (side, sign, pid) in [(Side::Left, -1.0, LEFT), (Side::Right, 1.0, RIGHT)] {
        // The bar's z axis points to the left. C and D are the corners at the web; E and F are the tips of the lower and upper flange.
        for zone in 0..=rails.zone_bounds_in.len() as u32 {
            deck.card(
                "PBAR",
                fields![
                    pid + zone,
                    1_u32,
                    section[0],
                    section[1],
                    section[2],
                    section[3],
                    "",
                    "",
                    h,
                    -sign * c,
                    -h,
                    -sign * c,
                    -h,
                    sign * f,
                    h,
                    sign * f
                ],
            );
        }
        let y = sign * (rails.web_y() - c);
        let ids: Vec<u32> = xs
            .iter()
            .map(|x| deck.grid([*x, y, rails.z_mid()]))
            .collect();
        for (i, pair) in ids.windows(2).enumerate() {
            let id = deck.element();
            deck.card(
                "CBAR",
                fields![
                    id,
                    pid + rails.zone((xs[i] + xs[i + 1]) / 2.0),
                    pair[0],
                    pair[1],
                    0.0,
                    0.0,
                    1.0
                ],
            );
        }
        points.extend(ids.iter().zip(&xs).map(|(id, x)| RailPoint {
            id: *id,
            x: [*x, y, rails.z_mid()],
            side,
        }));
    }
    let mut member_centres = Vec::new();
    for (i, member) in truck.cross_member.iter().enumerate() {
        let (x, pid) = (member.station_in * INCH, MEMBER + i as u32);
        let s = channel(member.height, member.flange, member.thickness);
        deck.card("PBAR", fields![pid, 1_u32, s[0], s[1], s[2], s[3]]);
        let end = rails.web_y() - truck.bracket.gap;
        let ids: Vec<u32> = (0..=8)
            .map(|k| deck.grid([x + s[4], end * (k as f64 / 4.0 - 1.0), rails.z_mid()]))
            .collect();
        for pair in ids.windows(2) {
            let id = deck.element();
            deck.card("CBAR", fields![id, pid, pair[0], pair[1], 0.0, 0.0, 1.0]);
        }
        for (end_grid, side) in [(ids[0], Side::Left), (ids[8], Side::Right)] {
            if let Some(p) = points
                .iter()
                .find(|p| p.side == side && (p.x[0] - x).abs() < 0.5)
            {
                deck.rbe2(p.id, &[end_grid]);
            }
        }
        member_centres.push((member.name.clone(), vec![ids[4]]));
    }
    Frame {
        rail_points: points,
        member_centres,
    }
}
